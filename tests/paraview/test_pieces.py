# SPDX-License-Identifier: BSD-3-Clause
"""Bodies in several pieces: a piece that nothing holds is named on every road, at once; and pieces
that touch without sharing points are told, and merged where that is asked for."""

import numpy
from paraview.simple import (AssignMaterial, BuildReducedModel, PrecomputeStateSpace, SetBoundary,
                             SolveDynamics, SolveEquilibrium)
from support import (Messages, box_body, cell_array, expect_error, expect_silence, fetch, field,
                     grid_of, places, point_array, produce)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA



def cells(grid):
    return vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(grid.GetNumberOfCells(), -1)


def two_boxes(shift, quadratic=False):
    """A box and a copy of it that is moved."""
    box = box_body(quadratic=quadratic)
    points = places(box)
    return grid_of(numpy.vstack([points, points + shift]),
                   numpy.vstack([cells(box), cells(box) + len(points)]),
                   VTK_QUADRATIC_TETRA if quadratic else VTK_TETRA)


def boundary_of(grid, normal, **settings):
    """Held where the coordinate along the normal is 0."""
    material = AssignMaterial(Input=produce(grid), YoungsModulus=5000, Density=1000)
    boundary = SetBoundary(Input=material, FixedRegion="Plane", **settings)
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = normal
    return boundary


def nearest(grid, place):
    return int(numpy.argmin(numpy.linalg.norm(places(grid) - place, axis=1)))


def test_a_loose_piece_is_named_on_every_road():
    grid = two_boxes([0, 0, 0.3])
    boundary = boundary_of(grid, [0, 0, 1])
    node = nearest(grid, [0.2, 0.1, 0.1])
    ball = dict(Tool="Sphere", ToolRadius=0.03)
    above = [0.1, 0.05, 0.12]
    roads = (
        SolveEquilibrium(Input=boundary, ActiveNodes=[node], Displacement=[0, 0, 0.005]),
        SolveEquilibrium(Input=boundary, ToolPosition=above, **ball),
        SolveEquilibrium(Input=boundary, ToolPosition=above, LinearSolver="Conjugate gradients",
                         **ball),
        SolveEquilibrium(Input=boundary, ActiveNodes=[node], BodyForce=[0, 0, -9.81]),
        PrecomputeStateSpace(Input=boundary, ActiveNodes=[node], Resolution=3),
        PrecomputeStateSpace(Input=boundary, Depth=0.01, **ball),
        PrecomputeStateSpace(Input=boundary, Depth=0.01, BodyForce=[0, 0, -9.81], **ball),
        SolveDynamics(Input=boundary, EndTime=0.01, BodyForce=[0, 0, -9.81]),
        BuildReducedModel(Input=boundary, ActiveNodes=[node]))
    for road in roads:
        print(road.GetXMLName(), flush=True)
        expect_error(road.UpdatePipeline, "2 pieces", "one of them is not held",
                     "96 cells, 0.002 m³, around (0.1, 0.05, 0.35) m", "Set Boundary")


def test_a_tip_holds_a_piece():
    """It follows the tool, which feels nothing of it."""
    grid = two_boxes([0, 0, 0.3])
    boundary = boundary_of(grid, [0, 0, 1])
    solve = SolveEquilibrium(Input=boundary, ActiveNodes=[nearest(grid, [0.1, 0.05, 0.4])],
                             TipRadius=0.06, Displacement=[0, 0, 0.005])
    held = expect_silence(lambda: fetch(solve))
    assert field(held, "Outcome")[0] == 0
    assert numpy.abs(field(held, "ReactionForce")).max() < 1e-8


def solve(boundary):
    """Pulled at the middle of its far end."""
    grid = fetch(boundary)
    return fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[nearest(grid, [0.2, 0.05, 0.2])],
                                  Displacement=[0, 0.002, 0.01]))


def merged_by_hand(grid):
    """Points whose places are the same to a micrometre are one."""
    points = places(grid)
    _, first, number = numpy.unique(numpy.round(points, 6), axis=0, return_index=True,
                                    return_inverse=True)
    return grid_of(points[first], number.ravel()[cells(grid)], grid.GetCellType(0))


def test_halves_that_touch():
    for quadratic in (False, True):
        grid = two_boxes([0, 0, 0.1], quadratic)
        shared = 9 * 5 if quadratic else 5 * 3
        whole = merged_by_hand(grid)
        assert whole.GetNumberOfPoints() == grid.GetNumberOfPoints() - shared
        expected = solve(boundary_of(whole, [1, 0, 0]))

        apart = boundary_of(grid, [1, 0, 0])
        with Messages() as messages:
            fetch(apart)
        assert messages.errors == 0 and messages.warnings == 1
        assert "2 of the 2 pieces of the body touch" in messages.text
        assert f"{shared} points coincide" in messages.text and "Merge" in messages.text
        # Each half bends by itself.
        assert field(solve(apart), "Energy")[0] < 0.7 * field(expected, "Energy")[0]

        joined = boundary_of(grid, [1, 0, 0], Merge=1)
        found = expect_silence(lambda: fetch(joined))
        assert field(found, "MergedPoints")[0] == shared
        assert found.GetNumberOfPoints() == whole.GetNumberOfPoints()
        state = expect_silence(lambda: solve(joined))
        for name in ("Energy", "ReactionForce"):
            assert numpy.allclose(field(state, name), field(expected, name), rtol=1e-7), name
        # Held by its lower half, the upper one is held too.
        expect_silence(lambda: solve(boundary_of(grid, [0, 0, 1], Merge=1)))


def add_numbers(data, name, count):
    array = vtkDoubleArray()
    array.SetName(name)
    for i in range(count):
        array.InsertNextValue(i)
    data.AddArray(array)


def test_merging_keeps_the_data():
    grid = two_boxes([0, 0, 0.1])
    # Of the upper half's points alone are those chosen where the halves meet.
    held = vtkUnsignedCharArray()
    held.SetName("Held")
    half = grid.GetNumberOfPoints() // 2
    for point, place in enumerate(places(grid)):
        held.InsertNextValue(1 if point >= half and place[2] < 0.15 else 0)
    grid.GetPointData().AddArray(held)
    add_numbers(grid.GetPointData(), "PointNumber", grid.GetNumberOfPoints())
    add_numbers(grid.GetCellData(), "CellNumber", grid.GetNumberOfCells())
    material = AssignMaterial(Input=produce(grid), YoungsModulus=5000)
    boundary = SetBoundary(Input=material, FixedBy="Array", FixedArray="Held", Merge=1)
    found = expect_silence(lambda: fetch(boundary))
    before = point_array(found, "PointNumber").astype(int)
    assert numpy.array_equal(places(found), places(grid)[before])
    assert numpy.array_equal(cell_array(found, "CellNumber"), range(grid.GetNumberOfCells()))
    assert numpy.array_equal(places(found)[cells(found)], places(grid)[cells(grid)])
    meets = numpy.abs(places(found)[:, 2] - 0.1) < 1e-9
    assert point_array(found, "Fixed")[meets].all()
    # Two points of a half that was merged are inside the body, and not touched.
    assert not point_array(found, "Touchable")[meets].any()


def test_a_slit_is_left():
    """A body that is cut: its points are there twice along the cut."""
    grid = two_boxes([0, 0, 0.1])
    points, corners = places(grid), cells(grid)
    # The halves hold together at x = 0.
    first = {tuple(numpy.round(p, 6)): i for i, p in reversed(list(enumerate(points)))}
    joined = numpy.array([first[tuple(numpy.round(p, 6))] if p[0] < 1e-9 else i
                          for i, p in enumerate(points)])
    slit = grid_of(points, joined[corners], VTK_TETRA)
    found = expect_silence(lambda: fetch(boundary_of(slit, [1, 0, 0], Merge=1)))
    assert field(found, "MergedPoints")[0] == 0
    assert numpy.array_equal(cells(found), joined[corners])


def test_faces_that_are_divided_otherwise():
    lower, upper = box_body(quadratic=False), box_body((3, 3, 2), quadratic=False)
    count = lower.GetNumberOfPoints()
    grid = grid_of(numpy.vstack([places(lower), places(upper) + [0, 0, 0.1]]),
                   numpy.vstack([cells(lower), cells(upper) + count]), VTK_TETRA)
    for merge in (0, 1):
        with Messages() as messages:
            fetch(boundary_of(grid, [1, 0, 0], Merge=merge))
        assert messages.errors == 0 and messages.warnings == 1
        # Those of the lower side and those of the upper one.
        assert "34 faces lie on faces" in messages.text


def test_what_is_there_twice():
    grid = two_boxes([0, 0, 0])
    expect_error(lambda: fetch(boundary_of(grid, [1, 0, 0], Merge=1)), "overlap")


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)

# SPDX-License-Identifier: BSD-3-Clause
"""Refine Mesh: the tolerance is reached, the body stays the same, and what cannot be is told."""

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, Calculator, PrecomputeStateSpace, RefineMesh,
                             SetBoundary, SolveEquilibrium, Threshold)
from support import (box_body, cell_array, expect_error, expect_silence, expect_warning, fetch,
                     field, node_at, places, point_array, scene, source)
from vtkmodules.util.numpy_support import vtk_to_numpy

LENGTHS = (0.2, 0.1, 0.1)
RADIUS, DEPTH = 0.025, 0.008


def ball(proxy):
    proxy.Tool = "Sphere"
    proxy.Tool.Radius = RADIUS
    return proxy


def corners(grid):
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 10)
    return places(grid)[cells[:, :4]]


def volume(grid):
    edges = corners(grid)[:, 1:] - corners(grid)[:, :1]
    return abs(numpy.linalg.det(edges)).sum() / 6


def table(refined):
    rows = servermanager.Fetch(refined, idx=1)
    return {rows.GetColumnName(i): vtk_to_numpy(rows.GetColumn(i))
            for i in range(rows.GetNumberOfColumns())}


def mesh_error(body, place):
    """The estimate where the ball presses the place, from above."""
    solve = ball(SolveEquilibrium(Input=body, EstimateMeshError=1,
                                  ToolPosition=[*place[:2], place[2] + RADIUS - DEPTH]))
    grid = fetch(solve)
    assert field(grid, "Outcome")[0] == 0
    return numpy.linalg.norm(field(grid, "MeshError")) / numpy.linalg.norm(
        field(grid, "ReactionForce"))


def check_tolerance():
    """Two places on a body that has arrays of the user's own."""
    grid = box_body(lengths=LENGTHS)
    kinds = Calculator(Input=source(grid, "body"), AttributeType="Cell Data",
                       ResultArrayName="Region", Function="3")
    known = Calculator(Input=kinds, AttributeType="Point Data", ResultArrayName="Height",
                       Function="coordsZ")
    boundary = SetBoundary(Input=AssignMaterial(Input=known, Law="Neo-Hookean"),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    coarse = fetch(boundary)
    nodes = [node_at(boundary, place) for place in ([0.1, 0.05, 0.1], [0.2, 0.05, 0.05])]
    refined = ball(RefineMesh(Input=boundary, ActiveNodes=nodes, Depth=DEPTH, MeshTolerance=0.1))
    expect_silence(refined.UpdatePipeline)
    fine = fetch(refined)

    rows = table(refined)
    assert len(rows["Cells"]) > 1 and (numpy.diff(rows["Cells"]) > 0).all()
    assert rows["Cells"][0] == coarse.GetNumberOfCells()
    assert rows["Cells"][-1] == fine.GetNumberOfCells()
    assert (rows["Unknowns"] > 0).all() and (rows["Seconds"] > 0).all()
    assert rows["MeshError"].shape == (len(rows["Cells"]), 2)
    assert 1.5 * rows["LargestMeshError"][0] > 0.1 >= 1.5 * rows["LargestMeshError"][-1]
    assert numpy.isnan(rows["Change"][0]).all() and (rows["Change"][-1] <= 0.1).all()
    assert (rows["MeshError"][-1] == field(fine, "MeshError")).all()
    for component, node in ((0, nodes[0]), (3, nodes[1])):
        force = rows["Force"][-1, component:component + 3]
        error = force - rows["CorrectedForce"][-1, component:component + 3]
        share = rows["MeshError"][-1, component // 3]
        assert abs(numpy.linalg.norm(error) / numpy.linalg.norm(force) / share - 1) < 1e-9, node
    assert (field(fine, "MeshErrorKnown") == 1).all()

    # The points of before are there, with what they have; new ones are held on the same plane.
    number = coarse.GetNumberOfPoints()
    assert (places(fine)[:number] == places(coarse)).all()
    assert abs(volume(fine) / volume(coarse) - 1) < 1e-12
    assert ((point_array(fine, "Fixed") != 0) == (places(fine)[:, 0] < 1e-12)).all()
    assert (point_array(fine, "BoundaryKind") == 2).sum() == (point_array(fine, "Fixed") != 0).sum()
    on_top = point_array(fine, "Touchable") != 0
    assert on_top.sum() > (point_array(coarse, "Touchable") != 0).sum()
    assert numpy.allclose(point_array(fine, "Height"), places(fine)[:, 2], atol=1e-12)
    for name in ("Law", "YoungsModulus", "PoissonsRatio", "Region"):
        assert (cell_array(fine, name) == cell_array(coarse, name)[0]).all(), name
    middles = corners(fine).mean(axis=1)
    pressed = numpy.linalg.norm(middles - [0.1, 0.05, 0.1], axis=1) < 0.03
    far = numpy.linalg.norm(middles - [0.1, 0.05, 0], axis=1) < 0.03
    assert pressed.sum() > 3 * far.sum(), (pressed.sum(), far.sum())

    # What Solve Equilibrium finds there is what was told.
    place = places(coarse)[nodes[0]]
    assert abs(mesh_error(refined, place) - field(fine, "MeshError")[0]) < 1e-6
    assert mesh_error(boundary, place) > 2 * mesh_error(refined, place)
    # Such a body is a scene like another: its points are the same places in a space.
    space = PrecomputeStateSpace(Input=refined, ActiveNodes=nodes[:1], TipRadius=0.02,
                                 FileName="refined.palpate", Resolution=3, HalfWidth=0.002)
    expect_silence(space.UpdatePipeline)

    # A mesh that is fine enough stays as it is.
    again = ball(RefineMesh(Input=refined, ActiveNodes=nodes, Depth=DEPTH, MeshTolerance=0.1))
    assert fetch(again).GetNumberOfCells() == fine.GetNumberOfCells()


def check_all_cells():
    """Each cell is divided into eight, whatever touches the body; linear cells too."""
    for name, quadratic in (("all", True), ("all_linear", False)):
        boundary = scene(name, quadratic=quadratic)
        number = fetch(boundary).GetNumberOfCells()
        divided = RefineMesh(Input=boundary, Divide="All Cells", ActiveNodes=[], TipRadius=0)
        expect_silence(divided.UpdatePipeline)
        assert fetch(divided).GetNumberOfCells() == 8 * number
        assert list(table(divided)["Cells"]) == [number, 8 * number]
        held = places(fetch(divided))[point_array(fetch(divided), "Fixed") != 0]
        assert abs(held[:, 0]).max() < 1e-12
        divided.MaximumCells = 8 * number - 1
        expect_error(divided.UpdatePipeline, f"{8 * number} cells", "MaximumCells", "Raise it")


def check_supports_and_weight():
    """Springs and a held direction go over; the body is pressed as it lies."""
    body = source(box_body(lengths=LENGTHS), "held")
    material = AssignMaterial(Input=body, Law="Neo-Hookean", Density=1000)

    def held(body, normal, **settings):
        boundary = SetBoundary(Input=body, FixedRegion="Plane", **settings)
        boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], normal
        return boundary

    below = held(material, [0, 0, 1], Support="Springs", SupportStiffness=2e5)
    beside = held(below, [0, 1, 0], Support="Direction", HeldDirection=[0, 1, 0])
    boundary = held(beside, [1, 0, 0])
    node = node_at(boundary, [0.15, 0.05, 0.1])
    refined = ball(RefineMesh(Input=boundary, ActiveNodes=[node], Depth=DEPTH, MeshTolerance=0.15,
                              BodyForce=[0, 0, -9.81]))
    fine = fetch(refined)
    assert fine.GetNumberOfCells() > fetch(boundary).GetNumberOfCells()
    x, y, z = places(fine).T
    springs = point_array(fine, "SupportStiffness")
    assert ((springs == 2e5) == (z < 1e-12)).all()
    direction = point_array(fine, "HeldDirection")
    expected = (y < 1e-12) & (x > 1e-12)
    assert (abs(direction[:, 1]) == expected).all() and (direction[:, [0, 2]] == 0).all()
    assert (cell_array(fine, "Density") == 1000).all()


def check_tip():
    """A bonded tip, and the end where there would be too many cells."""
    boundary = scene("tip")
    node = node_at(boundary, [0.1, 0.05, 0.1])
    refined = RefineMesh(Input=boundary, ActiveNodes=[node], Depth=0.004, TipRadius=0.03,
                         MeshTolerance=0.2)
    expect_silence(refined.UpdatePipeline)
    fine = fetch(refined)
    assert 1.5 * field(fine, "MeshError")[0] <= 0.2
    refined.MeshTolerance, refined.MaximumCells = 0.01, 400
    expect_warning(refined.UpdatePipeline, "more than MaximumCells, 400", "up to",
                   f"active node {node}", "Raise MaximumCells or MeshTolerance")
    assert 96 < fetch(refined).GetNumberOfCells() <= 400
    # So deep that small cells at the rim would be turned inside out: the meshes that have them are
    # left.
    refined.MaximumCells, refined.MeshTolerance = 6000, 0.3
    refined.Depth, refined.MaximumSeconds = 0.06, 1
    expect_warning(refined.UpdatePipeline, f"active node {node}, and not known on the finer meshes",
                   "smaller Depth")
    assert field(fetch(refined), "MeshErrorKnown")[0] == 1


def check_bad_input():
    boundary = scene("bad")
    node = node_at(boundary, [0.1, 0.05, 0.1])
    inside = node_at(boundary, [0.1, 0.05, 0.05])
    good = {"Input": boundary, "ActiveNodes": [node], "TipRadius": 0.02}

    def fails(*words, **settings):
        expect_error(RefineMesh(**{**good, **settings}).UpdatePipeline, *words)

    fails("Depth is 0 m", "above 0", Depth=0)
    fails("MeshTolerance is 0", "0.05 is 5 %", MeshTolerance=0)
    fails("TipRadius is 0 m", "rigid Tool", TipRadius=0)
    fails("MaximumCells is 5", "96 cells", MaximumCells=5)
    fails("linear cells", "ElementOrder", Input=scene("linear", quadratic=False))
    fails(f"Active node {inside} is not on the surface", ActiveNodes=[inside])
    fails("Active node 5000 is not on the surface", ActiveNodes=[5000])
    fails("Active node -1", ActiveNodes=[-1])
    fails("no place to press", ActiveNodes=[])
    fails("No point of the body is fixed", Input=AssignMaterial(Input=source(box_body(), "free")))
    nothing = Threshold(Input=boundary, Scalars=["CELLS", "Law"], LowerThreshold=50,
                        UpperThreshold=60)
    fails("no cells", Input=nothing)


check_tolerance()
check_all_cells()
check_supports_and_weight()
check_tip()
check_bad_input()

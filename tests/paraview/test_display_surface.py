# SPDX-License-Identifier: BSD-3-Clause
"""An organ's own fine surface in place of that of its body, on one rank and on two."""

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, BuildReducedModel, CarrySurface, CSVReader,
                             Delete, PrecomputeStateSpace, SetBoundary, SolveDynamics,
                             SolveEquilibrium, TouchReducedModel, TouchStateSpace, Transform,
                             XMLPolyDataReader)
from state_space_support import fetch_space
from support import box_body, expect_error, expect_silence, expect_warning, field, node_at, source
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

SIZE = numpy.array((0.2, 0.1, 0.1))
DIVISIONS = (4, 2, 2)
FINER = 4  # squares of the surface along the edge of a cell of the body
CORNER = (0.2, 0.1, 0.1)
DISPLACEMENT = [0.004, -0.006, -0.008]


def side(axis, at_end):
    """The points of a side of the box on a grid, and the places of its squares."""
    axes = [a for a in range(3) if a != axis]
    counts = [FINER * DIVISIONS[a] + 1 for a in axes]
    points = []
    for i in range(counts[0]):
        for j in range(counts[1]):
            point = numpy.zeros(3)
            point[axis] = SIZE[axis] * at_end
            point[axes[0]] = SIZE[axes[0]] * i / (counts[0] - 1)
            point[axes[1]] = SIZE[axes[1]] * j / (counts[1] - 1)
            points.append(point)
    squares = [[i * counts[1] + j, i * counts[1] + j + 1, (i + 1) * counts[1] + j + 1,
                (i + 1) * counts[1] + j]
               for i in range(counts[0] - 1) for j in range(counts[1] - 1)]
    outward = bool(at_end) == (axis != 1)
    return points, [square[::-1] if outward else square for square in squares]


def write_surface(name, far=0.0):
    """Squares of the six sides, each with points of its own, as other programs write them: with
    texture coordinates, colours of points, a number of each cell, and a line besides."""
    points, cells = [], []
    for axis in range(3):
        for at_end in (0, 1):
            more, squares = side(axis, at_end)
            cells += [[len(points) + p for p in square] for square in squares]
            points += more
    points = numpy.array(points)
    points[0] -= far
    surface = vtkPolyData()
    places = vtkPoints()
    places.SetDataTypeToDouble()
    places.SetData(numpy_to_vtk(points, deep=True))
    surface.SetPoints(places)
    polys, lines = vtkCellArray(), vtkCellArray()
    for cell in cells:
        polys.InsertNextCell(len(cell), cell)
    lines.InsertNextCell(2, [0, 1])
    surface.SetPolys(polys)
    surface.SetLines(lines)
    texture = numpy_to_vtk(points[:, :2].astype(numpy.float32) / 0.2, deep=True)
    texture.SetName("Texture")
    surface.GetPointData().SetTCoords(texture)
    colour = numpy_to_vtk((255 * points / SIZE).clip(0, 255).astype(numpy.uint8), deep=True)
    colour.SetName("Colour")
    surface.GetPointData().AddArray(colour)
    number = vtkFloatArray()
    number.SetName("Number")
    for cell in range(len(cells) + 1):
        number.InsertNextValue(cell)
    surface.GetCellData().AddArray(number)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(name + ".vtp")
    writer.SetInputData(surface)
    writer.SetDataModeToBinary()
    assert writer.Write() == 1
    return XMLPolyDataReader(FileName=[name + ".vtp"]), points


def held(name, **material):
    body = source(box_body(DIVISIONS, SIZE), name)
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Neo-Hookean", **material),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def fetch(proxy, time=None, port=0):
    proxy.UpdatePipeline(time)
    return servermanager.Fetch(proxy, idx=port)


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def places(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def at_common_points(points, body_points):
    """For each point of the body that the surface has too, one place in each of them."""
    place = {tuple(numpy.round(1e6 * point).astype(int)): i for i, point in enumerate(points)}
    keys = [tuple(numpy.round(1e6 * point).astype(int)) for point in body_points]
    common = [(place[key], i) for i, key in enumerate(keys) if key in place]
    assert len(common) > 100
    return numpy.array(common).T


def check_shown(shown, points, body_points, displacement):
    """It is the surface, displaced as the body is where both have a point."""
    assert shown.GetNumberOfPoints() == len(points)
    squares = 2 * FINER**2 * (DIVISIONS[0] * DIVISIONS[1] + DIVISIONS[1] * DIVISIONS[2]
                              + DIVISIONS[0] * DIVISIONS[2])
    assert shown.GetNumberOfCells() == shown.GetNumberOfPolys() == 2 * squares
    u = array(shown, "Displacement")
    assert numpy.abs(places(shown) - points - u).max() < 1e-6
    of_surface, of_body = at_common_points(points, body_points)
    assert numpy.abs(u[of_surface] - displacement[of_body]).max() < 1e-6
    assert numpy.abs(displacement).max() > 1e-3
    # What it came with is still there.
    data = shown.GetPointData()
    assert numpy.allclose(vtk_to_numpy(data.GetTCoords()), points[:, :2] / 0.2, atol=1e-6)
    assert (array(shown, "Colour") == (255 * points / SIZE).clip(0, 255).astype(numpy.uint8)).all()
    assert shown.GetCellData().HasArray("Number")
    # Sides have points and normals of their own, which are one where the surface is not sharp.
    assert numpy.allclose(numpy.linalg.norm(array(shown, "Normals"), axis=1), 1, atol=1e-5)


def test_carry_surface():
    boundary = held("carried")
    surface, points = write_surface("carried_surface")
    node = node_at(boundary, CORNER)
    solve = SolveEquilibrium(Input=boundary, ActiveNodes=[node], TipRadius=0.03,
                             Displacement=DISPLACEMENT, Stress=1)
    carry = CarrySurface(Input=solve, Surface=surface)
    shown = expect_silence(lambda: fetch(carry))
    body = fetch(solve)
    displacement = array(body, "Displacement")
    check_shown(shown, points, places(body), displacement)
    stress, of_body = array(shown, "VonMisesStress"), array(body, "VonMisesStress")
    surfaces, bodies = at_common_points(points, places(body))
    assert numpy.allclose(stress[surfaces], of_body[bodies], rtol=1e-6)
    assert (field(shown, "ReactionForce") == field(body, "ReactionForce")).all()
    # At all other points it is near what the cells say: the displacement is smooth.
    u = array(shown, "Displacement")
    assert numpy.linalg.norm(u, axis=1).max() < 1.05 * numpy.linalg.norm(displacement, axis=1).max()
    # Another body, with the same surface.
    solve.Displacement = [0, 0, 0.005]
    check_shown(fetch(carry), points, places(body), array(fetch(solve), "Displacement"))
    expect_error(CarrySurface(Input=boundary, Surface=surface).UpdatePipeline,
                 "no point array Displacement", "Solve Equilibrium")


def test_motion():
    boundary = held("moving", Density=1000)
    surface, points = write_surface("moving_surface")
    node = node_at(boundary, CORNER)
    numpy.savetxt("display_path.csv", numpy.column_stack([[0, 0.05, 0.1], 0.01 * numpy.eye(3)]),
                  delimiter=",", header="Time,Tool0_X,Tool0_Y,Tool0_Z", comments="")
    moved = SolveDynamics(Input=boundary, ActiveNodes=[node], TipRadius=0.03,
                          ToolPaths=CSVReader(FileName=["display_path.csv"]),
                          EndTime=0.1, FrameRate=20)
    carry = CarrySurface(Input=moved, Surface=surface)
    for time in (0.05, 0.1):
        body = fetch(moved, time)
        check_shown(fetch(carry, time), points, places(body), array(body, "Displacement"))


def touched(space, surface, **settings):
    """What a touch shows by the surface, and without it."""
    touch = TouchStateSpace(Input=space, **settings)
    plain = fetch(touch)
    touch.DisplaySurface = surface
    return expect_silence(lambda: fetch(touch)), plain


def test_state_spaces():
    boundary = held("display_space")
    surface, points = write_surface("display_surface")
    node = node_at(boundary, CORNER)
    bonded = PrecomputeStateSpace(Input=boundary, ActiveNodes=[node], TipRadius=0.03, Resolution=3,
                                  HalfWidth=0.01)
    shown, plain = touched(bonded, surface, Displacement=DISPLACEMENT)
    u = array(plain, "Displacement")
    check_shown(shown, points, places(plain) - u, u)
    for name in ("Force", "Found", "Outcome"):
        assert (field(shown, name) == field(plain, name)).all()

    rigid = PrecomputeStateSpace(Input=boundary, Tool="Sphere", ToolRadius=0.03, Depth=0.006,
                                 Spacing=0.03, UseToolRegion=1, ToolRegion="Sphere",
                                 FileName="display.palpate")
    rigid.ToolRegion.Center, rigid.ToolRegion.Radius = [0.15, 0.05, 0.1], 0.02
    configurations = fetch_space(rigid)["Configurations"]
    deepest = numpy.linalg.norm(array(configurations, "Force"), axis=1).argmax()
    shown, plain = touched(rigid, surface,
                           ToolPosition=list(array(configurations, "Displacement")[deepest]))
    u = array(plain, "Displacement")
    check_shown(shown, points, places(plain) - u, u)
    pressure = array(shown, "ContactPressure")
    assert pressure.min() >= 0 and 0 < pressure.max() <= array(plain, "ContactPressure").max()


def test_a_body_that_sags():
    boundary = held("sagging", Density=400)
    surface, points = write_surface("sagging_surface")
    node = node_at(boundary, CORNER)
    gravity = [0, 0, -9.81]
    space = PrecomputeStateSpace(Input=boundary, ActiveNodes=[node], TipRadius=0.03, Resolution=3,
                                 HalfWidth=0.004, BodyForce=gravity)
    shown, plain = touched(space, surface)
    sag = places(shown) - points
    assert sag[:, 2].min() < -0.003 and numpy.abs(array(shown, "Displacement")).max() == 0
    rest = fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[node], TipRadius=0.03,
                                  Displacement=[0, 0, 0], BodyForce=gravity))
    surfaces, bodies = at_common_points(points, places(rest))
    assert numpy.abs(sag[surfaces] - array(rest, "Displacement")[bodies]).max() < 1e-6


def test_reduced_model():
    boundary = held("display_reduced", Density=1000)
    surface, points = write_surface("reduced_surface")
    node = node_at(boundary, CORNER)
    model = BuildReducedModel(Input=boundary, ActiveNodes=[node], TipRadius=0.03, Reach=0.01,
                              TrainingPaths=2, Modes=20)
    touch = TouchReducedModel(Input=model, Coordinates=[0.0] * 20 + DISPLACEMENT)
    plain = fetch(touch)
    touch.DisplaySurface = surface
    shown = expect_silence(lambda: fetch(touch))
    u = array(plain, "Displacement")
    check_shown(shown, points, places(plain) - u, u)


def test_bad_input():
    boundary = held("display_bad")
    surface, _ = write_surface("bad_surface")
    node = node_at(boundary, CORNER)
    solve = SolveEquilibrium(Input=boundary, ActiveNodes=[node], TipRadius=0.03,
                             Displacement=DISPLACEMENT)
    in_millimetres = Transform(Input=surface)
    in_millimetres.Transform.Scale = [1000, 1000, 1000]
    elsewhere = Transform(Input=surface)
    elsewhere.Transform.Translate = [0, 0.3, 0]
    for wrong, words in ((in_millimetres, ("display surface does not lie on the body", "in mm",
                                           "0.001")),
                         (elsewhere, ("display surface does not lie on the body", "same axes"))):
        carry = CarrySurface(Input=solve, Surface=wrong)
        expect_error(carry.UpdatePipeline, *words)
        Delete(carry)
    far, points = write_surface("far_surface", far=0.1)
    carry = CarrySurface(Input=solve, Surface=far)
    expect_warning(carry.UpdatePipeline, "points of the display surface", "0.17", "off the body")
    assert fetch(carry).GetNumberOfPoints() == len(points)


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name, "passed", flush=True)

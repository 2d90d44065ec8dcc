# SPDX-License-Identifier: BSD-3-Clause
"""PrecomputeStateSpace with a rigid tool that presses anywhere, on one rank and on several."""

import glob
import os

import numpy
from contact_space_support import ABOVE, DEPTH, LAYER, MIDDLE_OF_TOP, RADIUS, scene, space_of
from paraview import servermanager
from paraview.simple import (EstimateError, SaveData, SolveEquilibrium, Sphere, StateSpaceReader,
                             TouchStateSpace, XMLPartitionedDatasetCollectionReader)
from support import Messages, expect_error, expect_silence, field
from vtkmodules.util.numpy_support import vtk_to_numpy

TOUCHES_NOTHING = 64
# Of Outcome.
TOOL_INSIDE = 7
# Of Found.
INSIDE, EXTRAPOLATED = 1, 2


def configurations(proxy):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy, 0).GetPartition(2, 0)


def array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def rows(data):
    """What was found, in the order of the check-points."""
    names = ("CheckPoint", "Force", "Energy", "Stiffness", "Outcome", "Flags")
    columns = [array(data, name).reshape(data.GetNumberOfPoints(), -1) for name in names]
    table = numpy.hstack([vtk_to_numpy(data.GetPoints().GetData()), *columns])
    return table[numpy.lexsort(array(data, "CheckPoint").T)]


def pressed(boundary, place, **settings):
    """The equilibrium with the tool there."""
    solve = SolveEquilibrium(Input=boundary, Tool="Sphere", ToolRadius=RADIUS, ToolPosition=place,
                             **settings)
    solve.UpdatePipeline()
    return servermanager.Fetch(solve)


def found_depths(found):
    """How deep the tool is in the top at each check-point, m."""
    return MIDDLE_OF_TOP[2] + RADIUS - vtk_to_numpy(found.GetPoints().GetData())[:, 2]


def test_output():
    boundary = scene("contact_space")
    space = space_of(boundary)
    found = expect_silence(lambda: configurations(space))
    flags = array(found, "Flags")
    free = flags & TOUCHES_NOTHING != 0
    forces = numpy.linalg.norm(array(found, "Force"), axis=1)
    assert 0 < free.sum() < len(free)
    assert (forces[free] == 0).all() and (forces[~free] > 0).all()
    assert (array(found, "Outcome") == 0).all()
    assert field(found, "ToolRadius")[0] == RADIUS
    assert field(found, "ContactThickness")[0] == LAYER
    assert field(found, "Depth")[0] == DEPTH
    assert (array(found, "ActiveNode") == -1).all()
    # The force at one of them is that of Solve Equilibrium there.
    i = numpy.argmax(numpy.where(found_depths(found) <= DEPTH, forces, 0))
    place = found.GetPoint(i)
    force = field(pressed(boundary, place, ContactThickness=LAYER), "ReactionForce")[0]
    assert numpy.linalg.norm(force - array(found, "Force")[i]) < 1e-6 * forces[i]


def test_default_layer():
    """It is calibrated: drawn back into the tool. The file and what is saved keep that."""
    boundary = scene("contact_space_default")
    given = expect_silence(lambda: configurations(space_of(boundary)))
    assert field(given, "ContactOffset")[0] == 0
    space = space_of(boundary, ContactThickness=0, FileName="contact_default.palpate", Keep="All")
    found = expect_silence(lambda: configurations(space))
    assert field(found, "ContactThickness")[0] == 0.2 * RADIUS
    offset = field(found, "ContactOffset")[0]
    assert 0.18 * RADIUS < offset < 0.2 * RADIUS
    # At each check-point it is what Solve Equilibrium finds by default.
    forces = array(found, "Force")
    i = numpy.argmax(numpy.where(found_depths(found) <= DEPTH, -forces[:, 2], 0))
    exact = pressed(boundary, found.GetPoint(i))
    force = field(exact, "ReactionForce")[0]
    assert numpy.linalg.norm(force - forces[i]) < 1e-6 * numpy.linalg.norm(force)
    reader = expect_silence(lambda: configurations(
        StateSpaceReader(FileName="contact_default.palpate")))
    assert field(reader, "ContactOffset")[0] == offset
    assert (rows(reader) == rows(found)).all()
    space.UpdatePipeline()
    SaveData("contact_default.vtpc", proxy=space, DataMode="Binary")
    saved = XMLPartitionedDatasetCollectionReader(FileName=["contact_default.vtpc"])
    for of in (space, StateSpaceReader(FileName="contact_default.palpate"), saved):
        touch = TouchStateSpace(Input=of, ToolPosition=found.GetPoint(i))
        touch.UpdatePipeline()
        felt = servermanager.Fetch(touch, 0)
        assert numpy.linalg.norm(field(felt, "Force")[0] - force) < 1e-6 * numpy.linalg.norm(force)
        # What the layer of contact and the cells do to the force is told.
        told, right = (field(data, "ContactLayerForce")[0] for data in (felt, exact))
        assert abs(told - right) < 0.02 * numpy.linalg.norm(force), (told, right, force)
        told, right = (field(data, "ContactMeshError")[0] for data in (felt, exact))
        assert right > 0 and abs(told / right - 1) < 0.05, (told, right)


def test_file():
    boundary = scene("contact_space_file")
    for name in glob.glob("contact_space.palpate*"):
        os.remove(name)
    in_memory = rows(expect_silence(lambda: configurations(space_of(boundary))))
    space = space_of(boundary, FileName="contact_space.palpate")
    assert (rows(expect_silence(lambda: configurations(space))) == in_memory).all()
    reader = StateSpaceReader(FileName="contact_space.palpate")
    found = expect_silence(lambda: configurations(reader))
    assert (rows(found) == in_memory).all()
    assert field(found, "Complete")[0] == 1
    # What touches nothing takes hardly any room.
    num_points = 9 * 5 * 5
    num_solved = (in_memory[:, -1].astype(int) & TOUCHES_NOTHING == 0).sum()
    assert os.path.getsize("contact_space.palpate") < 1.5 * 48 * num_points * num_solved + 4e5
    # Another region and a tolerance go on from there.
    wider = space_of(boundary, FileName="contact_space.palpate", RegionRadius=0.045)
    found = expect_silence(lambda: configurations(wider))
    assert field(found, "Reused")[0] == len(in_memory)
    assert field(found, "Solved")[0] > 0
    finer = space_of(boundary, FileName="contact_space.palpate", Tolerance=0.005)
    found = expect_silence(lambda: configurations(finer))
    assert field(found, "Rounds")[0] > 0


def test_around_the_hand():
    """One configuration is found, and a run of the whole space goes on with it."""
    boundary = scene("contact_space_around")
    for name in glob.glob("contact_around.palpate*"):
        os.remove(name)
    around = {"Exploration": "Around The Hand", "FileName": "contact_around.palpate"}
    space = space_of(boundary, **around)
    found = expect_silence(lambda: configurations(space))
    assert found.GetNumberOfPoints() == 1 and field(found, "Complete")[0] == 0
    touch = TouchStateSpace(Input=space, ToolPosition=ABOVE)
    expect_silence(touch.UpdatePipeline)
    space.InvokeCommand("UpdateEstimate")
    space.UpdatePropertyInformation()
    estimate = str(space.GetPropertyValue("Estimate"))
    assert "One configuration is solved for now" in estimate, estimate
    # The second time nothing is solved for.
    space.LogInterval = 1
    assert (rows(expect_silence(lambda: configurations(space))) == rows(found)).all()
    whole = space_of(boundary, FileName="contact_around.palpate")
    complete = expect_silence(lambda: configurations(whole))
    assert field(complete, "Reused")[0] == 1 and field(complete, "Complete")[0] == 1
    in_memory = rows(expect_silence(lambda: configurations(space_of(boundary))))
    assert numpy.abs(rows(complete) - in_memory)[:, :9].max() < 1e-6
    for words, settings in (("FileName", {"FileName": ""}),
                            ("MeshTolerance", {"MeshTolerance": 0.1}),
                            ("Graspable", {"Graspable": 1, "ActiveNodes": [0]})):
        expect_error(space_of(boundary, **(around | settings)).UpdatePipeline, words,
                     "set Exploration to Whole Space")


def test_touch():
    boundary = scene("contact_space_touch")
    space = space_of(boundary, FileName="contact_touch.palpate", ThirdDerivatives=1,
                     Keep="All")
    touch = TouchStateSpace(Input=space, ToolPosition=ABOVE, WholeBody=1)
    touched = expect_silence(lambda: touch.UpdatePipeline() or servermanager.Fetch(touch, 0))
    solved = pressed(boundary, ABOVE, ContactThickness=LAYER)
    force = field(solved, "ReactionForce")[0]
    assert numpy.linalg.norm(field(touched, "Force")[0] - force) < 0.03 * numpy.linalg.norm(force)
    assert (field(touched, "ToolPosition") == ABOVE).all()
    assert abs(field(touched, "ContactArea")[0] / field(solved, "ContactArea")[0] - 1) < 0.1
    assert array(touched, "ContactPressure").max() > 0
    assert touched.GetFieldData().GetArray("ActiveNode") is None
    body = servermanager.Fetch(touch, 0, idx=1)
    found, right = (array(grid, "Displacement") for grid in (body, solved))
    assert numpy.abs(found - right).max() < 0.05 * numpy.abs(right).max()
    # Away from the body it feels nothing, and the body is at rest.
    touch.ToolPosition = [0.12, 0.05, 0.1 + 2 * RADIUS]
    away = expect_silence(lambda: touch.UpdatePipeline() or servermanager.Fetch(touch, 0))
    assert (field(away, "Force") == 0).all() and (array(away, "Displacement") == 0).all()
    assert (array(away, "ContactPressure") == 0).all()


def test_a_tool_inside_is_told():
    """A ball that is small beside the cells goes through the surface: no answer is taken from
    there, and none is without a force."""
    boundary = scene("contact_space_inside")
    space = space_of(boundary, ToolRadius=0.003, Depth=0.03, Spacing=0.003, RegionRadius=0.0015,
                     ContactThickness=0.0012, FileName="contact_inside.palpate")
    space.ToolRegion.Center = [0.117, 0.055, 0.1]
    with Messages() as messages:
        found = configurations(space)
    assert "tool inside the body" in messages.text and messages.errors == 0, messages.text
    inside = array(found, "Outcome") == TOOL_INSIDE
    assert 0 < inside.sum() < len(inside)
    for of in (space, StateSpaceReader(FileName="contact_inside.palpate")):
        touch = TouchStateSpace(Input=of)
        for i in numpy.flatnonzero(inside)[::3]:
            touch.ToolPosition = found.GetPoint(i)
            touch.UpdatePipeline()
            felt = servermanager.Fetch(touch, 0)
            assert field(felt, "Found")[0] == EXTRAPOLATED, field(felt, "Found")
            assert field(felt, "Outcome")[0] == TOOL_INSIDE
            assert numpy.linalg.norm(field(felt, "Force")[0]) > 0
    touch.ToolPosition = [0.117, 0.055, 0.1 + 0.003 - 0.002]
    touch.UpdatePipeline()
    felt = servermanager.Fetch(touch, 0)
    assert field(felt, "Found")[0] == INSIDE and field(felt, "Outcome")[0] == 0
    touch.ToolPosition = [0.117, 0.055, 0.1 + 0.003 + 0.01]
    touch.UpdatePipeline()
    assert field(servermanager.Fetch(touch, 0), "Outcome")[0] == 0


def test_error_estimate():
    space = space_of(scene("contact_space_error"))
    found = expect_silence(lambda: configurations(EstimateError(Input=space)))
    errors = array(found, "EstimatedError")
    assert numpy.isfinite(errors).any() and (errors[numpy.isfinite(errors)] >= 0).all()


def test_surface():
    # Each rank has a piece of it.
    sphere = Sphere(Radius=RADIUS, ThetaResolution=48, PhiResolution=24)
    boundary = scene("contact_space_surface")
    of_sphere = rows(configurations(space_of(boundary)))
    space = space_of(boundary, Tool="Surface", ToolSurface=sphere,
                     FileName="contact_surface.palpate")
    # Near the triangles that stand for the sphere it may be near a fold, which it says.
    found = configurations(space)
    largest = numpy.abs(of_sphere[:, 6:9]).max()
    compared = 0
    of_surface = {tuple(row[3:6]): row for row in rows(found)}
    for row in of_sphere:
        other = of_surface.get(tuple(row[3:6]))
        if other is not None and numpy.allclose(row[:3], other[:3]):
            compared += 1
            assert numpy.abs(row[6:9] - other[6:9]).max() < 0.05 * largest
    reader = StateSpaceReader(FileName="contact_surface.palpate")
    again = configurations(reader)
    assert again.GetFieldData().GetArray("ToolTriangles").GetNumberOfTuples() > 1000


def test_bad_input():
    boundary = scene("contact_space_bad")
    for settings, words in (
            ({"MaximumConfigurations": 3}, "at most 3 are allowed"),
            ({"Spacing": 0.1}, "larger than the tool"),
            ({"ToolRadius": 0.0}, "larger than 0"),
            ({"Depth": 0.0}, "Neither a depth nor a force limit"),
            ({"Tool": "Surface"}, "none is given"),
            ({"Spacing": -1.0}, "The spacing")):
        expect_error(space_of(boundary, **settings).UpdatePipeline, words)
    # What is felt is there without a file; what is seen is not.
    touch = TouchStateSpace(Input=space_of(boundary), ToolPosition=ABOVE)
    expect_error(touch.UpdatePipeline, "FileName")
    assert numpy.linalg.norm(field(servermanager.Fetch(touch, 0), "Force")[0]) > 0


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)

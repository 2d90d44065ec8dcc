# SPDX-License-Identifier: BSD-3-Clause
"""A plate that gives way to either side: TouchStateSpace tells which, by the way of the tool."""

import csv

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, PrecomputeStateSpace, ReplayTouch, SaveData,
                             SetBoundary, StateSpaceReader, TouchStateSpace,
                             XMLPartitionedDatasetCollectionReader)
from support import box_body, expect_error, expect_silence, field, source
from vtkmodules.util.numpy_support import vtk_to_numpy

THICKNESS = 0.004
RADIUS = 0.01
# The ball presses the free edge, whose middle is at x = 0.06 m, where no side ends nearby.
AT_EDGE = [0.061, 0.02, THICKNESS / 2]
# Of Found.
INSIDE, MARKED = 1, 3


def plate():
    body = source(box_body(divisions=(5, 3, 1), lengths=(0.06, 0.04, THICKNESS)), "plate")
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=3000,
                                                PoissonsRatio=0.35), FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    return boundary


def space_of(boundary, **settings):
    space = PrecomputeStateSpace(Input=boundary, Tool="Sphere", ToolRadius=RADIUS, Depth=0.008,
                                 Spacing=0.004, UseToolRegion=1, ToolRegion="Sphere",
                                 LogInterval=0, **settings)
    space.ToolRegion.Center = [0.06, 0.02, THICKNESS / 2]
    space.ToolRegion.Radius = 0.012
    return space


def touched(touch):
    """Force, how far the edge is displaced in the mean, branch and Found."""
    touch.UpdatePipeline()
    surface = servermanager.Fetch(touch)
    u = vtk_to_numpy(surface.GetPointData().GetArray("Displacement"))
    x = vtk_to_numpy(surface.GetPoints().GetData()) - u
    return (field(surface, "Force")[0], u[x[:, 0] > 0.0599].mean(axis=0),
            int(field(surface, "Branch")[0]), int(field(surface, "Found")[0]))


def check(space):
    touch = TouchStateSpace(Input=space, ToolPosition=AT_EDGE, FromStart=1)
    sides = []
    for way in (0.03, -0.03):
        touch.StartToolPosition = [AT_EDGE[0], AT_EDGE[1], AT_EDGE[2] + way]
        sides.append(expect_silence(lambda: touched(touch)))
    (above, down, of_above, found_above), (below, up, of_below, found_below) = sides
    assert found_above == found_below == INSIDE, sides
    assert of_above != of_below
    # The one mirrors the other, but for the tetrahedra.
    mirrored = above * [1, 1, -1]
    assert numpy.linalg.norm(mirrored - below) < 0.05 * numpy.linalg.norm(above), (above, below)
    assert down[2] < -0.001 and up[2] > 0.001, (down, up)
    # Without a way it comes along the normal, which here leads to one of the two.
    touch.FromStart = 0
    force, _, branch, _ = touched(touch)
    assert min(numpy.linalg.norm(force - above), numpy.linalg.norm(force - below)) == 0
    # A branch may be given, and the body goes on from a place where it is on one.
    for number, force in ((of_above, above), (of_below, below)):
        touch.Branch = number
        assert (touched(touch)[0] == force).all()
    touch.Branch = -1
    touch.FromStart = 1
    touch.StartToolPosition = AT_EDGE
    touch.StartBranch = of_below
    touch.ToolPosition = [AT_EDGE[0], AT_EDGE[1], AT_EDGE[2] - 0.002]
    force, _, branch, _ = touched(touch)
    assert force[2] > 0 and branch == of_below
    touch.Branch = 99
    expect_error(touch.UpdatePipeline, "There is no branch 99", "counted from 0")
    return above


def check_replay(space):
    """A recording says by its force on which side the body was."""
    touch = TouchStateSpace(Input=space, ToolPosition=AT_EDGE, FromStart=1)
    rows, shapes = [], []
    for number, way in enumerate((0.03, -0.03)):
        touch.StartToolPosition = [AT_EDGE[0], AT_EDGE[1], AT_EDGE[2] + way]
        force, edge, _, found = touched(touch)
        shapes.append(edge)
        row = {"time_s": 0.1 * number, "contact": 4, "found": found}
        row.update({f"node_{k}": -1 for k in range(3)})
        row.update({f"weight_{k}": 0 for k in range(3)})
        for axis, place, of_hand in zip("xyz", AT_EDGE, force):
            row.update({f"anchor_{axis}_m": place, f"displacement_{axis}_m": 0,
                        f"position_{axis}_m": place,
                        # With some noise, and the other way round: that of the body on the tool.
                        f"body_force_{axis}_N": -1.02 * of_hand})
        rows.append(row)
    with open("sides.csv", "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)
    replay = ReplayTouch(Input=space, FileName="sides.csv", FrameRate=0)
    for row, edge in zip(rows, shapes):
        expect_silence(lambda time=row["time_s"]: replay.UpdatePipeline(time))
        surface = replay.GetClientSideObject().GetOutputDataObject(0)
        u = vtk_to_numpy(surface.GetPointData().GetArray("Displacement"))
        x = vtk_to_numpy(surface.GetPoints().GetData()) - u
        shown = u[x[:, 0] > 0.0599].mean(axis=0)
        assert numpy.allclose(shown, edge, atol=1e-5), (shown, edge)


def test_levels():
    space = space_of(plate(), FileName="plate.palpate")
    space.UpdatePipeline()
    data = servermanager.Fetch(space, 0).GetPartition(2, 0)
    levels = vtk_to_numpy(data.GetPointData().GetArray("Level"))
    assert (levels > 0).sum() > 40 and field(data, "History")[0] == 1
    above = check(space)
    check_replay(space)
    assert (check(StateSpaceReader(FileName="plate.palpate")) == above).all()
    SaveData("plate.vtpc", proxy=space)
    check(XMLPartitionedDatasetCollectionReader(FileName=["plate.vtpc"]))


def test_flat():
    space = space_of(plate(), History="Flat", FileName="flat.palpate")
    space.UpdatePipeline()
    data = servermanager.Fetch(space, 0).GetPartition(2, 0)
    assert (vtk_to_numpy(data.GetPointData().GetArray("Level")) == 0).all()
    touch = TouchStateSpace(Input=space, ToolPosition=AT_EDGE)
    assert touched(touch)[2] == 0


if __name__ == "__main__":
    test_levels()
    test_flat()

# SPDX-License-Identifier: BSD-3-Clause
"""A space of regions with meshes of their own: its force is closer to that of a very fine mesh than
the mesh that is given could make it, passes smoothly from region to region, and is read, saved and
resumed as any other.
"""

import os

import numpy
from paraview import servermanager
from paraview.simple import (ExtractBlock, MergeBlocks, OpenDataFile, PrecomputeStateSpace,
                             RefineMesh, SaveData, SolveEquilibrium, StateSpaceReader,
                             TouchStateSpace)
from state_space_support import fetch_space
from support import (expect_error, expect_silence, fetch, field, node_at, places, point_array,
                     scene)

RADIUS, DEPTH, TOP, TOLERANCE = 0.03, 0.006, 0.1, 0.06
RANKS = servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()


def ball(proxy):
    proxy.Tool = "Sphere"
    proxy.Tool.Radius = RADIUS
    return proxy


def space_of(body, **others):
    settings = {"FileName": "regions.palpate", "Keep": "Touch", "Spacing": 0.015, "Depth": DEPTH,
                "MeshTolerance": TOLERANCE, "RegionSize": 0.06, **others}
    space = ball(PrecomputeStateSpace(Input=body, UseToolRegion=1, ToolRegion="Box", **settings))
    space.ToolRegion.Position, space.ToolRegion.Length = [0.08, 0.035, 0.09], [0.08, 0.03, 0.02]
    return space


def above(x):
    """The ball's centre where it presses the upper side by a part of the depth."""
    return [x, 0.05, TOP + RADIUS - 0.7 * DEPTH]


def touched(space, x, **others):
    touch = TouchStateSpace(Input=space, ToolPosition=above(x), **others)
    expect_silence(touch.UpdatePipeline)
    return fetch(touch)


def check_blocks(space):
    blocks = fetch_space(space)
    configurations = blocks["Configurations"]
    bodies = field(configurations, "BodyNumbers")
    assert len(bodies) >= 2 and (bodies > 1).all(), "each region has a mesh of its own"
    assert [name for name in blocks if name.startswith("Body")] == ["Body"] + [
        f"Body{number}" for number in range(2, 2 + len(bodies))]
    given = fetch(space.Input).GetNumberOfCells()
    for number in bodies:
        assert blocks[f"Body{number}"].GetNumberOfCells() > given
    assert (field(configurations, "RegionTolerance") == TOLERANCE).all()
    assert len(set(field(configurations, "RegionBand"))) == 1
    assert field(configurations, "RegionCentre").shape == (len(bodies), 3)
    assert numpy.isfinite(point_array(configurations, "MeshErrorEnergy")).all()
    return field(configurations, "RegionCentre"), bodies


def check_force(body, space):
    """Against a mesh that is refined until its error is a small part of the tolerance."""
    x = 0.115
    fine = ball(RefineMesh(Input=body, ActiveNodes=[node_at(body, [0.1, 0.05, TOP])], Depth=DEPTH,
                           MeshTolerance=0.04, MaximumCells=20000))
    exact = fetch(ball(SolveEquilibrium(Input=fine, ToolPosition=above(x), EstimateMeshError=1)))
    right = field(exact, "ReactionForce")[0] - field(exact, "MeshError")[0]
    given = field(fetch(ball(SolveEquilibrium(Input=body, ToolPosition=above(x)))),
                  "ReactionForce")[0]
    corrected = touched(space, x)
    assert field(corrected, "MeshErrorCorrected")[0] == 1
    assert field(corrected, "Found")[0] == 1
    plain = touched(space, x, CorrectMeshError=0)
    largest = numpy.linalg.norm(right)
    error, of_plain, of_given = (
        numpy.linalg.norm(force - right) / largest
        for force in (field(corrected, "Force")[0], field(plain, "Force")[0], given))
    print(f"error of the force: {error:.3f} corrected, {of_plain:.3f} not, {of_given:.3f} given")
    # The cells of 0.5 of the radius between the check-points have an error of their own.
    assert error < TOLERANCE and error < 0.5 * of_given


def check_transition(space, centres):
    """The force is the gradient of the energy while the tool passes from region to region."""
    assert len(centres) >= 2
    way = numpy.arange(0.088, 0.152, 0.002)
    touches = [touched(space, x) for x in way]
    energies = numpy.array([field(touch, "Energy")[0] for touch in touches])
    forces = numpy.array([field(touch, "Force")[0] for touch in touches])
    largest = numpy.linalg.norm(forces, axis=1).max()
    assert numpy.linalg.norm(numpy.diff(forces, axis=0), axis=1).max() < 0.15 * largest
    # Simpson's rule over two steps.
    work = (way[1] - way[0]) / 3 * (forces[:-2:2, 0] + 4 * forces[1:-1:2, 0] + forces[2::2, 0])
    assert numpy.abs(numpy.diff(energies[::2])[:len(work)] - work).max() < 5e-3 * energies.max()
    for touch in touches[::4]:
        moved = point_array(touch, "Displacement")
        # The dent is as deep as the ball is in the body, but for the layer between them.
        assert 0.4 * DEPTH < numpy.abs(moved[:, 2]).max() < DEPTH
        assert point_array(touch, "ContactPressure").max() > 0
        assert field(touch, "ContactArea")[0] > 0


def main():
    body = scene()
    space = space_of(body)
    expect_silence(space.UpdatePipeline)
    centres, bodies = check_blocks(space)
    if RANKS == 1:  # others show that any number of ranks finds the same
        check_force(body, space)
        check_transition(space, centres)
    whole = TouchStateSpace(Input=space, ToolPosition=above(0.11), WholeBody=1)
    expect_error(whole.UpdatePipeline, "Keep")
    stress = TouchStateSpace(Input=space, ToolPosition=above(0.11), Stress=1)
    expect_error(stress.UpdatePipeline, "Stress off")

    # The file and the saved data are the same space.
    expected = field(touched(space, 0.12), "Force")
    read = StateSpaceReader(FileName="regions.palpate")
    assert (field(touched(read, 0.12), "Force") == expected).all()
    SaveData("regions.vtpc", proxy=space)
    saved = OpenDataFile("regions.vtpc")
    assert (field(touched(saved, 0.12), "Force") == expected).all()
    again = space_of(body)
    assert field(fetch_space(again)["Configurations"], "Solved")[0] == 0
    assert field(fetch_space(again)["Configurations"], "MeshSeconds")[0] < 10

    expect_error(space_of(body, MeshTolerance=0).UpdatePipeline, "another scene")
    expect_error(space_of(body, FileName="", Depth=0, ForceLimit=5).UpdatePipeline, "Depth",
                 "MeshTolerance")
    block = MergeBlocks(Input=ExtractBlock(Input=space, Selectors=[f"/Root/Body{bodies[0]}"]),
                        MergePoints=0)
    assert places(servermanager.Fetch(block)).shape[1] == 3
    assert os.path.getsize("regions.palpate") > 0


if __name__ == "__main__":
    main()

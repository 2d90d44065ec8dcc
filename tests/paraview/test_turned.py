# SPDX-License-Identifier: BSD-3-Clause
"""A tool that is turned freely: force and torque."""

import numpy
from paraview.simple import (PrecomputeStateSpace, SolveEquilibrium, StateSpaceReader,
                             TouchStateSpace)
from support import expect_error, fetch, field, point_array
from test_trocar import LENGTH, LENGTHS, RADIUS, held

PLACE = numpy.array([0.055, 0.03, 0.062])


def quaternion(degrees, about):
    """w, x, y, z of a turn about an axis."""
    half = numpy.radians(degrees) / 2
    about = numpy.asarray(about) / numpy.linalg.norm(about)
    return [numpy.cos(half), *(numpy.sin(half) * about)]


def rotated(turn, vector):
    w, axis = turn[0], numpy.asarray(turn[1:])
    return vector + 2 * numpy.cross(axis, numpy.cross(axis, vector) + w * numpy.asarray(vector))


def turning(solve, reference=0.5 * LENGTH, axis=(0, 0, 1), **motion):
    """Gives a filter the rod, upright as it is made; its reference point is in its middle."""
    solve.Tool = "Capsule"
    solve.Tool.Radius, solve.Tool.Length, solve.Tool.Axis = RADIUS, LENGTH, list(axis)
    solve.Tool.Motion = "Turned"
    solve.Tool.Motion.ReferenceDistance = reference
    for name, value in motion.items():
        setattr(solve.Tool.Motion, name, value)
    return solve


def test_presses_as_the_rod_that_lies_there():
    body = held("there")
    turn = quaternion(80, [1, 0.3, 0.1])
    found = fetch(turning(SolveEquilibrium(Input=body, ToolPosition=list(PLACE),
                                           ToolOrientation=[3 * x for x in turn])))
    assert field(found, "Outcome")[0] == 0
    force = field(found, "ReactionForce").ravel()
    torque = field(found, "ReactionTorque").ravel()
    assert numpy.linalg.norm(force) > 0.02 and field(found, "HapticStiffness").size == 9
    straight = SolveEquilibrium(Input=body, ToolPosition=list(PLACE))
    straight.Tool = "Capsule"
    straight.Tool.Radius, straight.Tool.Length = RADIUS, LENGTH
    straight.Tool.Axis = list(rotated(turn, [0, 0, 1]))
    lies = fetch(straight)
    assert numpy.isclose(field(found, "Energy")[0], field(lies, "Energy")[0], rtol=1e-6)
    assert numpy.allclose(force, field(lies, "ReactionForce").ravel(), rtol=1e-5)
    u, expected = (point_array(grid, "Displacement") for grid in (found, lies))
    assert abs(u - expected).max() < 1e-6 * abs(expected).max()
    # The rod is round: no torque turns it about its axis.
    axis = rotated(turn, [0, 0, 1])
    assert numpy.linalg.norm(torque) > 1e-5
    assert abs(torque @ axis) < 1e-8 * numpy.linalg.norm(torque)
    # About another point the same forces have another torque.
    tip = fetch(turning(SolveEquilibrium(Input=body, ToolOrientation=turn,
                                         ToolPosition=list(PLACE - 0.5 * LENGTH * axis)), 0))
    moved = torque + numpy.cross(0.5 * LENGTH * axis, force)
    assert numpy.allclose(field(tip, "ReactionTorque").ravel(), moved, rtol=1e-4, atol=1e-8)


def test_refused():
    body = held("refused")
    for message, properties, motion in (
            ("MaximumTurn", {"ToolOrientation": quaternion(50, [1, 0, 0])}, {"MaximumTurn": 40}),
            ("quaternion", {"ToolOrientation": [0, 0, 0, 0]}, {}),
            ("quaternion", {}, {"MiddleOrientation": [0, 0, 0, 0]}),
            ("below 180", {}, {"MaximumTurn": 180})):
        solve = turning(SolveEquilibrium(Input=body, ToolPosition=list(PLACE), **properties),
                        **motion)
        expect_error(solve.UpdatePipeline, message)
    still = SolveEquilibrium(Input=body, ToolPosition=list(PLACE), Tool="Sphere",
                             ToolOrientation=quaternion(10, [1, 0, 0]))
    expect_error(still.UpdatePipeline, "Motion Turned")


def test_space():
    """Force and torque between the places and orientations that were solved for."""
    body = held("space")
    space = turning(PrecomputeStateSpace(Input=body, Spacing=0.008, Depth=0.003, LogInterval=0,
                                         TurnSpacing=15, UseToolRegion=1, ToolRegion="Sphere",
                                         FileName="turned.palpate"),
                    reference=0, MaximumTurn=15)
    space.ToolRegion.Center, space.ToolRegion.Radius = [PLACE[0], PLACE[1], LENGTHS[2]], 0.004
    space.UpdatePipeline()
    read = StateSpaceReader(FileName="turned.palpate")
    touches = [TouchStateSpace(Input=source) for source in (space, read)]
    error, of_torque, largest = [], [], 0
    random = numpy.random.default_rng(5)
    for _ in range(4):
        place = PLACE + random.uniform(-1, 1, 3) * [0.002, 0.002, 0.0005]
        turn = quaternion(random.uniform(0, 14), [*random.uniform(-1, 1, 2), 0])
        exact = fetch(turning(SolveEquilibrium(Input=body, ToolPosition=list(place),
                                               ToolOrientation=turn), 0))
        right = field(exact, "ReactionForce").ravel()
        felt = []
        for touch in touches:
            touch.ToolPosition, touch.ToolOrientation = list(place), turn
            felt.append(fetch(touch))
        for touch in felt:
            assert field(touch, "Found")[0] == 1, (place, turn)
            error.append(numpy.linalg.norm(field(touch, "Force").ravel() - right))
            of_torque.append(numpy.linalg.norm(field(touch, "Torque").ravel() -
                                               field(exact, "ReactionTorque").ravel()))
        assert numpy.allclose(field(felt[0], "Force"), field(felt[1], "Force"), rtol=1e-9)
        shapes = [point_array(touch, "Displacement") for touch in felt]
        assert abs(shapes[1] - shapes[0]).max() < 1e-6 * abs(shapes[0]).max()
        largest = max(largest, numpy.linalg.norm(right))
    assert max(error) < 0.05 * largest, (error, largest)
    assert max(of_torque) < 0.02 * largest * RADIUS, (of_torque, largest)
    # Beyond the largest turn the force is not known.
    touches[1].ToolPosition = list(PLACE)
    touches[1].ToolOrientation = quaternion(25, [1, 0, 0])
    assert field(fetch(touches[1]), "Found")[0] == 2
    # Its file is not for other orientations.
    space.TurnSpacing = 8
    expect_error(space.UpdatePipeline, "here by")
    space.Exploration = "Around The Hand"
    space.FileName = "around.palpate"
    expect_error(space.UpdatePipeline, "turned freely")


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)

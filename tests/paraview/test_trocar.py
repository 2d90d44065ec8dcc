# SPDX-License-Identifier: BSD-3-Clause
"""An instrument that goes through a trocar."""

import numpy
from paraview.simple import (AssignMaterial, PrecomputeStateSpace, SetBoundary, SolveEquilibrium,
                             StateSpaceReader, TouchStateSpace)
from support import box_body, expect_error, fetch, field, point_array, source

LENGTHS = (0.1, 0.06, 0.05)
TIP = numpy.array([0.055, 0.03, 0.062])
TROCAR = numpy.array([0.09, 0.05, 0.16])
RADIUS, LENGTH = 0.015, 0.03


def held(name="block"):
    boundary = SetBoundary(Input=AssignMaterial(Input=source(box_body((8, 5, 4), LENGTHS), name),
                                                Law="Neo-Hookean", YoungsModulus=3000),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 1e-6], [0, 0, 1]
    return boundary


def through(solve, trocar=TROCAR, axis=(0, 0, 1)):
    """Gives a filter the rod that goes through the trocar."""
    solve.Tool = "Capsule"
    solve.Tool.Radius, solve.Tool.Length, solve.Tool.Axis = RADIUS, LENGTH, list(axis)
    solve.Tool.Motion = "Trocar"
    solve.Tool.Motion.TrocarPoint = list(trocar)
    return solve


def test_presses_as_the_rod_that_lies_there():
    """The body is as if the rod lay there."""
    body = held()
    turned = through(SolveEquilibrium(Input=body, ToolPosition=list(TIP)))
    found = fetch(turned)
    assert field(found, "Outcome")[0] == 0
    force = field(found, "ReactionForce").ravel()
    torque = field(found, "ReactionTorque").ravel()
    assert numpy.linalg.norm(force) > 0.02
    assert numpy.allclose(torque, numpy.cross(TIP - TROCAR, force), rtol=1e-12)
    axis = (TROCAR - TIP) / numpy.linalg.norm(TROCAR - TIP)
    straight = SolveEquilibrium(Input=body, ToolPosition=list(TIP + 0.5 * LENGTH * axis))
    straight.Tool = "Capsule"
    straight.Tool.Radius, straight.Tool.Length = RADIUS, LENGTH
    straight.Tool.Axis = list(axis)
    lies = fetch(straight)
    assert not lies.GetFieldData().HasArray("ReactionTorque")
    assert numpy.isclose(field(found, "Energy")[0], field(lies, "Energy")[0], rtol=1e-6)
    u, expected = (point_array(grid, "Displacement") for grid in (found, lies))
    assert abs(u - expected).max() < 1e-6 * abs(expected).max()
    # Along the axis the rod slides alone. About the centre of its cap hardly a torque acts.
    moved = field(lies, "ReactionForce").ravel()
    assert numpy.isclose(force @ axis, moved @ axis, rtol=1e-5)
    assert numpy.linalg.norm(force - moved) < 1e-3 * numpy.linalg.norm(force)
    # Whatever way the rod pointed when it was made.
    other = through(SolveEquilibrium(Input=body, ToolPosition=list(TIP)), axis=(1, 0.2, -0.3))
    assert numpy.allclose(field(fetch(other), "ReactionForce").ravel(), force, rtol=1e-5)


def test_refused():
    body = held("refused")
    behind = through(SolveEquilibrium(Input=body, ToolPosition=list(TIP)), [0.05, 0.03, -5])
    # The body lies between the tip and that trocar: the tool would come from below.
    behind.ToolPosition = [0.05, 0.03, -6]
    expect_error(behind.UpdatePipeline, "TrocarPoint")
    for limit, value, message in (("MaximumTilt", 1, "MaximumTilt"),
                                  ("MaximumDepth", 0.1, "MaximumDepth"),
                                  ("MaximumTilt", 100, "at most 90"),
                                  ("MaximumDepth", -1, "but must be a length")):
        bounded = through(SolveEquilibrium(Input=body, ToolPosition=list(TIP)))
        setattr(bounded.Tool.Motion, limit, value)
        expect_error(bounded.UpdatePipeline, message)


def space_of(body, **properties):
    """The space of the rod on a small part of the top."""
    space = through(PrecomputeStateSpace(Input=body, Spacing=0.006, Depth=0.004, LogInterval=0,
                                         ThirdDerivatives=1, UseToolRegion=1, ToolRegion="Sphere",
                                         **properties))
    space.ToolRegion.Center, space.ToolRegion.Radius = [TIP[0], TIP[1], LENGTHS[2]], 0.008
    return space


def test_space():
    """Force and torque between the places that were solved for, also from a file."""
    body = held("space")
    space = space_of(body, FileName="trocar.palpate")
    space.UpdatePipeline()
    read = StateSpaceReader(FileName="trocar.palpate")
    error, largest = [], 0
    random = numpy.random.default_rng(5)
    for _ in range(6):
        tip = TIP + random.uniform(-1, 1, 3) * [0.004, 0.004, 0.0015]
        exact = fetch(through(SolveEquilibrium(Input=body, ToolPosition=list(tip))))
        right = field(exact, "ReactionForce").ravel()
        felt = [fetch(TouchStateSpace(Input=source, ToolPosition=list(tip)))
                for source in (space, read)]
        for touch in felt:
            assert field(touch, "Found")[0] == 1, tip
            force = field(touch, "Force").ravel()
            assert numpy.allclose(field(touch, "Torque").ravel(),
                                  numpy.cross(tip - TROCAR, force), rtol=1e-12)
            error.append(numpy.linalg.norm(force - right))
        shapes = [point_array(touch, "Displacement") for touch in felt]
        assert abs(shapes[1] - shapes[0]).max() < 1e-6 * abs(shapes[0]).max()
        largest = max(largest, numpy.linalg.norm(right))
    assert max(error) < 0.03 * largest, (error, largest)


def test_space_is_bounded():
    """There is nothing where the cone or the depth of the operation ends."""
    body = held("bounded")
    for limit, value in (("MaximumTilt", 1), ("MaximumDepth", 0.08)):
        space = space_of(body)
        setattr(space.Tool.Motion, limit, value)
        expect_error(space.UpdatePipeline, "nothing to press")


def test_another_trocar():
    """A space in memory is computed anew."""
    space = space_of(held("anew"))
    touch = TouchStateSpace(Input=space, ToolPosition=list(TIP))
    before = field(fetch(touch), "Torque").ravel()
    space.Tool.Motion.TrocarPoint = [0.02, 0.05, 0.16]
    assert numpy.linalg.norm(field(fetch(touch), "Torque").ravel() - before) > 1e-4


def test_file_of_another_trocar():
    body = held("other")
    space_of(body, FileName="moved.palpate").UpdatePipeline()
    other = space_of(body, FileName="moved.palpate")
    other.Tool.Motion.TrocarPoint = [0.09, 0.05, 0.17]
    expect_error(other.UpdatePipeline, "through the trocar at")


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)

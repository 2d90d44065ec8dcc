# SPDX-License-Identifier: BSD-3-Clause
"""A shape and a motion of a tool that a plugin of its own brings, each with one class and one file
of XML: they are in the lists of the filters, give the right force, and stay in a state.

Argument: the plugin.
"""

import sys

import numpy
from paraview.simple import (AssignMaterial, GetSources, LoadPlugin, LoadState,
                             PrecomputeStateSpace, ResetSession, SaveState, SetBoundary,
                             SolveDynamics, SolveEquilibrium, StateSpaceReader, TouchStateSpace)
from support import box_body, expect_silence, fetch, field, source

RADIUS = 0.04
# Of the box of support.py, whose top is at z = 0.1 m, the middle of the top, and above.
POSITION = [0.11, 0.05, 0.1 + RADIUS - 0.01]


def fine_scene():
    body = source(box_body(divisions=(8, 4, 4)), "new_tool")
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Neo-Hookean"),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def press(boundary, tool, motion=None, position=POSITION, **numbers):
    solve = SolveEquilibrium(Input=boundary, Tool=tool, ToolPosition=position)
    for name, value in {"Radius": RADIUS, **numbers}.items():
        setattr(solve.Tool, name, value)
    if motion:
        solve.Tool.Motion = motion[0]
        solve.Tool.Motion.Angle = motion[1]
    return solve


def solved(*args, **keywords):
    proxy = press(*args, **keywords)
    return expect_silence(lambda: fetch(proxy))


def force(*args, **keywords):
    return field(solved(*args, **keywords), "ReactionForce")[0]


def expect_same(a, b):
    assert numpy.linalg.norm(a) > 0.1, a
    assert numpy.linalg.norm(a - b) < 1e-7 * numpy.linalg.norm(a), (a, b)


def test_lists(boundary):
    for proxy, none in ((SolveEquilibrium(Input=boundary), "Bonded node"),
                        (PrecomputeStateSpace(Input=boundary), "Bonded node"),
                        (SolveDynamics(Input=boundary), "None")):
        tools = list(proxy.GetProperty("Tool").Available)
        # Later versions of ParaView leave out the spaces for Python.
        assert tools[0] in (none, none.replace(" ", "")), tools
        assert sorted(tools[1:]) == ["Capsule", "Ring", "Sphere", "Surface"], tools
        proxy.Tool = "Ring"
        assert proxy.Tool.RingRadius == 0.02
        assert proxy.Tool.Motion.GetXMLName() == "Translated"
        motions = proxy.Tool.GetProperty("Motion").Available
        assert sorted(motions) == ["Tilted", "Translated", "Trocar", "Turned"], motions


def test_forces(boundary):
    # A ring of no width is a sphere.
    expect_same(force(boundary, "Ring", RingRadius=0), force(boundary, "Sphere"))
    # A rod that is turned by the motion is one that lies so.
    angle = numpy.radians(50)
    rod = {"Length": 0.03}
    expect_same(force(boundary, "Capsule", ("Tilted", 50), Axis=[1, 0, 0], **rod),
                force(boundary, "Capsule", Axis=[numpy.cos(angle), numpy.sin(angle), 0], **rod))
    # Of the ring's own the force is the derivative of the energy; it is turned and leans.
    step = 1e-4
    ring = {"Axis": [0.3, 0, 1], "RingRadius": 0.02, "motion": ("Tilted", 30)}
    up, down = (field(solved(boundary, "Ring", position=numpy.add(POSITION, [0, 0, s]).tolist(),
                             **ring), "Energy")[0] for s in (step, -step))
    middle = force(boundary, "Ring", **ring)
    assert abs((up - down) / (2 * step) / middle[2] - 1) < 1e-3, (up, down, middle)
    assert abs(middle[2] / force(boundary, "Sphere")[2] - 1) > 0.1


def test_a_change_is_heard_of(boundary):
    solve = press(boundary, "Capsule", ("Tilted", 0), Length=0.05)
    before = field(fetch(solve), "ReactionForce")[0]
    solve.Tool.Motion.Angle = 90
    after = field(fetch(solve), "ReactionForce")[0]
    assert abs(after[2] / before[2] - 1) > 1e-3, (before, after)


def test_a_state_keeps_it(boundary):
    solve = press(boundary, "Ring", ("Tilted", 30), RingRadius=0.02)
    expected = field(fetch(solve), "ReactionForce")[0]
    SaveState("new_tool.pvsm")
    ResetSession()
    LoadState("new_tool.pvsm")
    solve, = (proxy for proxy in GetSources().values()
              if proxy.GetXMLName() == "SolveEquilibrium" and proxy.Tool.GetXMLName() == "Ring"
              and proxy.Tool.Motion.GetXMLName() == "Tilted" and proxy.Tool.RingRadius == 0.02
              and list(proxy.Tool.Axis) == [0, 0, 1])
    assert solve.Tool.Motion.Angle == 30
    assert (field(fetch(solve), "ReactionForce")[0] == expected).all()


def test_a_space_has_the_motion(boundary):
    place = [0.11, 0.05, 0.139]
    solve = press(boundary, "Capsule", ("Tilted", 30), place, Length=0.02)
    right = field(fetch(solve), "ReactionForce")[0]
    space = PrecomputeStateSpace(Input=boundary, Tool="Capsule", LogInterval=0, Spacing=0.006,
                                 Depth=0.009, ThirdDerivatives=1, UseToolRegion=1,
                                 ToolRegion="Sphere", FileName="tilted.palpate")
    space.ToolRegion.Center, space.ToolRegion.Radius = [0.11, 0.05, 0.1], 0.02
    for name in ("Radius", "Length", "Axis"):
        setattr(space.Tool, name, getattr(solve.Tool, name))
    space.Tool.Motion = "Tilted"
    space.Tool.Motion.Angle = 30
    for source_of_space in (space, StateSpaceReader(FileName="tilted.palpate")):
        source_of_space.UpdatePipeline()
        touch = fetch(TouchStateSpace(Input=source_of_space, ToolPosition=place))
        force = field(touch, "Force")[0]
        assert abs(force - right).max() < 0.05 * abs(right).max(), (force, right)


def main():
    SolveEquilibrium()  # connects, and so loads Palpate
    LoadPlugin(sys.argv[1], remote=False, ns=globals())
    boundary = fine_scene()
    test_lists(boundary)
    test_forces(boundary)
    test_a_change_is_heard_of(boundary)
    test_a_space_has_the_motion(boundary)
    test_a_state_keeps_it(boundary)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""Properties of a tool by the names that they had when they were those of a filter: in a state of
an earlier version (tests/data/old_tools.pvsm), and in scripts."""

import os

import numpy
from paraview.simple import (AssignMaterial, FindSource, LoadState, PrecomputeStateSpace,
                             ResetSession, SaveState, SetBoundary, SolveDynamics, SolveEquilibrium,
                             servermanager)
from support import box_body, fetch, field, source

STATE = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "data", "old_tools.pvsm")
# What the version that has written the state had found for its rod, N.
FORCE = [-0.18596395116510847, 0.0873786899389643, -1.6014955045869559]
POSITION = [0.11, 0.05, 0.12]


def held_body():
    boundary = SetBoundary(Input=AssignMaterial(Input=source(box_body(divisions=(8, 4, 4)),
                                                             "old_tools"), Law="Neo-Hookean"),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def numbers(tool):
    """The numbers of a tool, by name."""
    return {name: list(value) if hasattr(value, "__len__") else value
            for name, value in ((name, tool.GetPropertyValue(name))
                                for name in tool.ListProperties() if name != "Motion")}


def kind(proxy):
    return proxy.Tool.SMProxy.GetXMLLabel()


def expect_loaded():
    rod, node, motion, space = map(FindSource, ("Rod", "Node", "Motion", "Space"))
    assert list(map(kind, (rod, node, motion, space))) == [
        "Capsule", "Bonded node", "Surface", "Sphere"]
    assert numbers(rod.Tool) == {"Radius": 0.03, "Axis": [0, 1, 0.2], "Length": 0.05,
                                 "ContactThickness": 0.006, "ContactStiffness": 5e3}
    assert numbers(motion.Tool) == {"ContactThickness": 0.005, "ContactStiffness": 0}
    assert motion.ToolSurface is not None and list(node.ActiveNodes) == [5]
    assert numbers(space.Tool) == {"Radius": 0.025, "ContactThickness": 0, "ContactStiffness": 0}
    for proxy in (rod, node, motion, space):
        assert proxy.Tool.SMProxy is not None
        tools = proxy.GetProperty("Tool").Available
        assert tools[1:] == ["Capsule", "Sphere", "Surface"], tools
        # Of those that are not chosen the numbers are kept too.
        before = kind(proxy)
        proxy.Tool = "Capsule"
        assert proxy.Tool.Motion.GetXMLName() == "Translated"
        if proxy is space:
            assert (proxy.Tool.Radius, proxy.Tool.Length) == (0.025, 0.07)
        proxy.Tool = before
    force = field(fetch(rod), "ReactionForce")[0]
    assert numpy.allclose(force, FORCE, rtol=1e-9, atol=1e-9), force
    return force


def test_states():
    held_body()
    ResetSession()
    LoadState(STATE)
    force = expect_loaded()
    # What is newer counts, and is what is saved.
    SaveState("again.pvsm")
    ResetSession()
    LoadState("again.pvsm")
    assert (expect_loaded() == force).all()
    rod = FindSource("Rod")
    rod.Tool.Radius = 0.035
    SaveState("changed.pvsm")
    with open("changed.pvsm", encoding="utf-8") as file:
        assert "ToolRadius" not in file.read()
    ResetSession()
    LoadState("changed.pvsm")
    assert FindSource("Rod").Tool.Radius == 0.035
    assert (field(fetch(FindSource("Rod")), "ReactionForce")[0] != force).any()
    ResetSession()


def test_scripts():
    boundary = held_body()
    old = {"ToolRadius": 0.03, "ToolAxis": [0, 1, 0.2], "ToolLength": 0.05,
           "ContactThickness": 0.006, "ContactStiffness": 5e3}
    # In whatever order.
    first = SolveEquilibrium(Input=boundary, Tool="Capsule", ToolPosition=POSITION, **old)
    last = SolveEquilibrium(Input=boundary, **old, ToolPosition=POSITION, Tool="Capsule")
    new = SolveEquilibrium(Input=boundary, Tool="Capsule", ToolPosition=POSITION)
    new.Tool.Radius, new.Tool.Axis, new.Tool.Length = 0.03, [0, 1, 0.2], 0.05
    new.Tool.ContactThickness, new.Tool.ContactStiffness = 0.006, 5e3
    forces = [field(fetch(proxy), "ReactionForce")[0] for proxy in (first, last, new)]
    assert (forces[0] == forces[1]).all() and (forces[0] == forces[2]).all(), forces
    # A change by either name is heard of, and read by both.
    first.ToolRadius = 0.035
    assert first.Tool.Radius == 0.035
    assert (field(fetch(first), "ReactionForce")[0] != forces[0]).any()
    first.Tool.Radius = 0.03
    assert first.ToolRadius == 0.03
    assert (field(fetch(first), "ReactionForce")[0] == forces[0]).all()
    # The numbers are those of each tool, as they were when it was chosen by a number.
    first.Tool = "Sphere"
    assert first.Tool.Radius == 0.035 and first.ToolRadius == 0.035
    for filtered in (SolveEquilibrium, PrecomputeStateSpace, SolveDynamics):
        proxy = filtered(Input=boundary)
        assert (proxy.ToolRadius, list(proxy.ToolAxis), proxy.ToolLength, proxy.ContactThickness,
                proxy.ContactStiffness) == (0.01, [1, 0, 0], 0.03, 0, 0)


def test_defaults_can_be_had_again():
    solve = SolveEquilibrium(Input=held_body(), Tool="Sphere", ToolRadius=0.02)
    solve.SMProxy.ResetPropertiesToDefault()
    assert kind(solve) == "Bonded node", kind(solve)
    assert solve.ToolPosition is not None and isinstance(solve.Tool, servermanager.Proxy)


test_scripts()
test_defaults_can_be_had_again()
test_states()

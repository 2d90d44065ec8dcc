# SPDX-License-Identifier: BSD-3-Clause
"""State spaces of a body whose parts touch each other."""

import os

import numpy
from paraview.simple import (PrecomputeStateSpace, SolveEquilibrium, StateSpaceReader,
                             TouchStateSpace)
from state_space_support import fetch_space
from support import expect_error, expect_silence, fetch, field, node_at, point_array
from test_parts import MIDDLE, RADIUS, TOP, held, parts


def test_a_space_of_a_tool():
    boundary = held(parts("space"), Contact="Between Parts")
    space = PrecomputeStateSpace(Input=boundary, Tool="Sphere", ToolRadius=RADIUS, Depth=0.004,
                                 Spacing=0.006, UseToolRegion=1, ToolRegion="Sphere",
                                 LogInterval=0, FileName="parts.palpate")
    space.ToolRegion.Center = [*MIDDLE, TOP]
    space.ToolRegion.Radius = 0.003
    expect_silence(space.UpdatePipeline)
    read = StateSpaceReader(FileName="parts.palpate")
    place = [MIDDLE[0] + 0.001, MIDDLE[1], TOP + RADIUS - 0.0035]
    touched = fetch(TouchStateSpace(Input=read, ToolPosition=place))
    exact = fetch(SolveEquilibrium(Input=boundary, Tool="Sphere", ToolRadius=RADIUS,
                                   ToolPosition=place, Increments=2))
    force = field(exact, "ReactionForce")[0]
    difference = numpy.linalg.norm(field(touched, "Force")[0] - force)
    assert difference < 0.03 * numpy.linalg.norm(force), (field(touched, "Force")[0], force)


def test_a_space_of_a_bonded_tool():
    boundary = held(parts("bonded"), Contact="Between Parts")
    node = node_at(boundary, [*MIDDLE, TOP])
    tip = {"ActiveNodes": [node], "TipRadius": 0.012}
    settings = {**tip, "HalfWidth": 0.0015, "Resolution": 3, "FileName": "bonded.palpate",
                "LogInterval": 0}
    if os.path.exists("bonded.palpate"):
        os.remove("bonded.palpate")

    def solved(boundary):
        space = PrecomputeStateSpace(Input=boundary, **settings)
        return field(fetch_space(space)["Configurations"], "Solved")[0]

    assert solved(boundary) == 27
    # It goes on where it was, and is not that of another layer.
    assert solved(boundary) == 0
    other = held(parts("bonded_other"), Contact="Between Parts", ContactThickness=0.001)
    expect_error(PrecomputeStateSpace(Input=other, **settings).UpdatePipeline, "bonded.palpate")
    read = StateSpaceReader(FileName="bonded.palpate")
    # At a check-point, and between check-points.
    for displacement, allowed in (([0.0015, 0, -0.0015], 1e-5), ([0.0005, 0.001, -0.001], 0.02)):
        touched = field(fetch(TouchStateSpace(Input=read, Displacement=displacement)), "Force")[0]
        exact = field(fetch(SolveEquilibrium(Input=boundary, Displacement=displacement, **tip)),
                      "ReactionForce")[0]
        difference = numpy.linalg.norm(touched - exact)
        assert difference < allowed * numpy.linalg.norm(exact), (touched, exact)


def test_a_space_to_a_tolerance():
    boundary = held(parts("tolerance"), Contact="Between Parts")
    tip = {"ActiveNodes": [node_at(boundary, [*MIDDLE, TOP])], "TipRadius": 0.012}
    space = PrecomputeStateSpace(Input=boundary, HalfWidth=0.0015, Tolerance=0.005, LogInterval=0,
                                 **tip)
    places = numpy.random.default_rng(3).uniform(-0.0014, 0.0014, (4, 3))
    touched, exact = [], []
    for place in places:
        touched.append(field(fetch(TouchStateSpace(Input=space, Displacement=list(place))),
                             "Force")[0])
        exact.append(field(fetch(SolveEquilibrium(Input=boundary, Displacement=list(place), **tip)),
                           "ReactionForce")[0])
    difference = numpy.linalg.norm(numpy.subtract(touched, exact), axis=1)
    forces = point_array(fetch_space(space)["Configurations"], "Force")
    assert difference.max() < 0.005 * numpy.linalg.norm(forces, axis=1).max(), difference


if __name__ == "__main__":
    for test_name, test in list(globals().items()):
        if test_name.startswith("test_"):
            test()
            print(test_name, "passed", flush=True)

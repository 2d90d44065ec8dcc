# SPDX-License-Identifier: BSD-3-Clause
"""A state space whose tool spaces stand on two meshes of one organ: it is read, told, touched on
both, and stored as data.

  test_bodies.py <palpate_test_make_space>
"""

import subprocess
import sys

import numpy
from paraview import servermanager
from paraview.simple import (AccuracyReport, EstimateError, ExtractBlock, MergeBlocks,
                             OpenDataFile, PrecomputeStateSpace, SaveData, SolveEquilibrium,
                             StateSpaceReader, TouchStateSpace)
from state_space_support import fetch_space
from support import expect_error, expect_silence, field, places, point_array
from vtkmodules.util.numpy_support import vtk_to_numpy

# Beyond the solver's tolerance, at check-points.
ROUNDING = 1e-6


def fetch(proxy, port=0):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy, 0, idx=port)


def body_of(space, name):
    return MergeBlocks(Input=ExtractBlock(Input=space, Selectors=[f"/Root/{name}"]),
                       MergePoints=0)


def expect_touched(space, name, number, node):
    """At a check-point, the force and the shape are those of an equilibrium of the body's mesh."""
    body = body_of(space, name)
    mesh = places(fetch(body))
    for displacement in ([0.01, 0, 0], [-0.01, 0.01, -0.01]):
        solve = SolveEquilibrium(Input=body, ActiveNodes=[node], Displacement=displacement)
        exact = fetch(solve)
        touch = TouchStateSpace(Input=space, ActiveNode=node, BodyNumber=number,
                                Displacement=displacement, WholeBody=1)
        surface, whole = expect_silence(lambda: (fetch(touch), fetch(touch, 1)))
        assert field(surface, "Found")[0] == 1
        force = field(exact, "ReactionForce")
        assert numpy.abs(field(surface, "Force") - force).max() < 1e-4 * numpy.abs(force).max()
        assert len(places(whole)) == len(mesh)
        u = point_array(exact, "Displacement")
        assert numpy.abs(places(whole) - mesh - u).max() < 1e-3 * numpy.abs(u).max()
        assert numpy.abs(places(surface) - places(fetch_space(space)["Surface"])).max() > 0.005


def main():
    make_space, = sys.argv[1:]
    names = subprocess.run([make_space, "both.palpate", "bodies"], check=True, text=True,
                           capture_output=True).stdout.split()
    corner, middle, of_second = map(int, names)
    space = StateSpaceReader(FileName="both.palpate")
    blocks = expect_silence(lambda: fetch_space(space))
    assert list(blocks) == ["Body", "Surface", "Configurations", "Body2"], list(blocks)
    assert len(places(blocks["Body"])) < len(places(blocks["Body2"]))
    configurations = blocks["Configurations"]
    assert list(field(configurations, "ActiveNodes")) == sorted([corner, middle]) + [of_second]
    assert list(field(configurations, "BodyNumbers")) == [1, 1, 2]
    numbers = point_array(configurations, "BodyNumber")
    assert (numpy.bincount(numbers.astype(int)) == [0, 54, 27]).all()

    expect_touched(space, "Body", 1, corner)
    expect_touched(space, "Body2", 2, of_second)
    stress = TouchStateSpace(Input=space, ActiveNode=of_second, BodyNumber=2, Stress=1)
    expect_error(stress.UpdatePipeline, "BodyNumber")
    nowhere = TouchStateSpace(Input=space, ActiveNode=corner, BodyNumber=2)
    expect_error(nowhere.UpdatePipeline, f"on body 2 of the state space, which has 1: {of_second}")
    report = AccuracyReport(Input=space, TestPoints=40, Methods=["Energy Hermite"])
    expect_silence(report.UpdatePipeline)
    rows = servermanager.Fetch(report, idx=2)
    names = [rows.GetColumnByName("Tool").GetValue(i) for i in range(rows.GetNumberOfRows())]
    assert any("body 2" in name for name in names), names
    assert vtk_to_numpy(rows.GetColumnByName("MeanError")).max() < 20  # per cent, of 27 places
    points = servermanager.Fetch(report, idx=1)
    assert set(point_array(points, "BodyNumber")) == {1, 2}

    # The rigid tool of a second body is not shown; a node is found where none is named.
    touch = TouchStateSpace(Input=space, BodyNumber=2, Displacement=[0.001, 0, 0])
    assert field(fetch(touch), "ActiveNode")[0] == of_second
    estimated = fetch_space(EstimateError(Input=space))["Configurations"]
    estimates = point_array(estimated, "EstimatedError")
    of_body = point_array(estimated, "BodyNumber")
    assert set(estimates[of_body == 1]).isdisjoint(estimates[of_body == 2] + 0)

    # A run on the first mesh alone shows what the file has of both.
    again = PrecomputeStateSpace(Input=body_of(space, "Body"), FileName="both.palpate", Keep="All",
                                 ActiveNodes=[corner, middle], HalfWidth=0.01, Resolution=3,
                                 SolverTolerance=1e-10, ThirdDerivatives=0)
    blocks = expect_silence(lambda: fetch_space(again))
    assert list(blocks) == ["Body", "Surface", "Configurations", "Body2"], list(blocks)
    assert field(blocks["Configurations"], "Solved")[0] == 0
    expect_touched(again, "Body2", 2, of_second)

    SaveData("both.vtpc", proxy=space)
    again = OpenDataFile("both.vtpc")
    for number, node in ((1, middle), (2, of_second)):
        settings = {"ActiveNode": node, "BodyNumber": number,
                    "Displacement": [0.003, -0.002, 0.004]}
        first, second = (fetch(TouchStateSpace(Input=of, **settings)) for of in (space, again))
        assert (places(first) == places(second)).all()
        assert (field(first, "Force") == field(second, "Force")).all()


if __name__ == "__main__":
    main()

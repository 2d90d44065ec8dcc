# SPDX-License-Identifier: BSD-3-Clause
"""A recorded touch as a time series: of an active node, and of a rigid tool.

  test_replay.py <palpate-servo> <palpate_test_make_space>
"""

import csv
import glob
import math
import os
import re
import subprocess
import sys

import numpy
from paraview import servermanager
from paraview.simple import (BuildReducedModel, CSVReader, ReplayTouch, SaveData, SimulateTouch,
                             StateSpaceReader, TouchStateSpace, XMLPolyDataReader)
from support import (expect_error, expect_silence, fetch, field, node_at, places, point_array,
                     scene)
from vtkmodules.util.numpy_support import vtk_to_numpy

RATE = 20  # frames a second
FAR = [1.0, 1.0, 1.0]  # where a rigid tool touches nothing
PRESSES, ATTACHED = 4, 3


def record(servo, make_space, name, *kind):
    """The space and the ticks of a recording. The tool does not let go where a busy machine stops
    the loop for a moment."""
    subprocess.run([make_space, f"{name}.palpate", *kind], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([servo, f"{name}.palpate", "--seconds", "1.5", "--no-realtime",
                    "--release-after", "10", "--record", f"{name}.csv"], check=True,
                   stdout=subprocess.DEVNULL)
    with open(f"{name}.csv", newline="", encoding="utf-8") as file:
        ticks = list(csv.DictReader(file))
    return StateSpaceReader(FileName=f"{name}.palpate"), ticks


def vector(tick, what, unit):
    return numpy.array([float(tick[f"{what}_{axis}_{unit}"]) for axis in "xyz"])


def at(replay, time, port=0):
    replay.UpdatePipeline(time)
    return replay.GetClientSideObject().GetOutputDataObject(port)


def check(name, space, ticks, contact):
    """The frames are those of the ticks."""
    replay = ReplayTouch(Input=space, FileName=f"{name}.csv", FrameRate=RATE)
    expect_silence(replay.UpdatePipelineInformation)
    times = list(replay.TimestepValues)
    start = float(ticks[0]["time_s"])
    duration = float(ticks[-1]["time_s"]) - start
    assert len(times) == int(duration * RATE) + 1 and numpy.allclose(numpy.diff(times), 1 / RATE)

    touch = TouchStateSpace(Input=space)
    # The surface at rest as a display surface changes nothing.
    followed = ReplayTouch(Input=space, FileName=f"{name}.csv", FrameRate=RATE,
                           DisplaySurface=TouchStateSpace(Input=space, ToolPosition=FAR))
    rest = None
    found = most = 0
    for time in times:
        tick = [t for t in ticks if float(t["time_s"]) - start <= time + 1e-7][-1]
        surface = expect_silence(lambda t=time: at(replay, t))
        assert field(surface, "Contact")[0] == int(tick["contact"])
        force = at(replay, time, 2)
        assert numpy.allclose(point_array(force, "Force"), [vector(tick, "body_force", "N")])
        moved = point_array(surface, "Displacement")
        carried = point_array(expect_silence(lambda t=time: at(followed, t)), "Displacement")
        assert numpy.allclose(carried, moved, atol=1e-6)
        if int(tick["contact"]) != contact:
            assert (moved == 0).all()
            rest = places(surface)
            assert numpy.allclose(places(force), [vector(tick, "position", "m")])
            continue
        found += 1
        place = vector(tick, "anchor", "m") + vector(tick, "displacement", "m")
        assert numpy.allclose(places(force), [place])
        tool = places(at(replay, time, 1))
        assert numpy.allclose((tool.min(axis=0) + tool.max(axis=0)) / 2, place, atol=1e-4)
        # As the loop felt it: the mean of the nodes.
        expected = numpy.zeros_like(moved)
        nodes = [(int(tick[f"node_{k}"]), float(tick[f"weight_{k}"])) for k in range(3)]
        for node, weight in ([(-1, 1.0)] if contact == PRESSES else nodes):
            if weight == 0:
                continue
            touch.ActiveNode = node
            touch.Displacement = list(vector(tick, "displacement", "m"))
            touch.ToolPosition = list(place)
            expected += weight * point_array(fetch(touch), "Displacement")
        assert numpy.allclose(moved, expected, atol=1e-7), abs(moved - expected).max()
        assert rest is None or numpy.allclose(places(surface), rest + moved, atol=1e-6)
        if contact == PRESSES:
            pressure = point_array(surface, "ContactPressure")
            assert (pressure == point_array(fetch(touch), "ContactPressure")).all()
            most = max(most, pressure.max())
    assert found > 3 and rest is not None, found
    assert most > 0 or contact != PRESSES

    # Every tick is a time step where that is asked for; and a file is made of each frame.
    replay.FrameRate = 0
    replay.UpdatePipelineInformation()
    assert len(replay.TimestepValues) == len(ticks)
    replay.FrameRate = 2
    SaveData(f"{name}.pvd", proxy=replay, WriteTimeSteps=1, DataMode="Binary")
    files = glob.glob(f"{name}/*.vtp")
    replay.UpdatePipelineInformation()
    assert len(files) == len(replay.TimestepValues) > 1, files
    read = fetch(XMLPolyDataReader(FileName=[sorted(files)[-1]]))
    assert read.GetNumberOfPoints() == surface.GetNumberOfPoints()
    return replay


def check_bad_input(space):
    """What makes no time steps, or too many, and what is no number of a recording."""
    def fails(*words, rate=RATE, last=None):
        with open("node.csv", newline="", encoding="utf-8") as file:
            ticks = list(csv.DictReader(file))
        ticks[-1].update(last or {})
        with open("bad.csv", "w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, ticks[0].keys())
            writer.writeheader()
            writer.writerows(ticks)
        replay = ReplayTouch(Input=space, FileName="bad.csv", FrameRate=rate)
        expect_silence(replay.UpdatePipelineInformation)
        expect_error(lambda: replay.UpdatePipeline(1e300), *words)

    for rate in (1e9, 1e15):
        fails("FrameRate", "there may be a million", rate=rate)
    for rate in (math.inf, math.nan, -1):
        fails("FrameRate", rate=rate)
    for time in ("1e12", "1e300"):
        fails("there may be a million", last={"time_s": time})
    fails("time_s", last={"time_s": "inf"})
    fails("time_s", last={"time_s": "nan"})
    fails("time_s", "earlier", last={"time_s": "-5"})
    fails("node_0", "no whole number", last={"node_0": "1e300"})
    fails("contact", last={"contact": "nan"})
    fails("displacement_x_m", last={"displacement_x_m": "inf"})


def check_reduced(servo, space):
    """The body of a reduced model goes along a recording as the page of Simulate Touch says, and
    Replay Touch says so. Without inertia its force follows from where the tools are alone."""
    boundary = scene()
    nodes = [node_at(boundary, [0.2, y, 0.1]) for y in (0, 0.1)]
    model = BuildReducedModel(Input=boundary, ActiveNodes=nodes, TipRadius=0.02, Modes=12,
                              FileName="model.palpate")
    model.UpdatePipeline()
    subprocess.run([servo, "model.palpate", "--device", "simulated", "--device", "simulated",
                    "--seconds", "1", "--no-realtime", "--record", "run.csv"], check=True,
                   stdout=subprocess.DEVNULL)
    page = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "plugin", "help", "SimulateTouch.md")
    with open(page, encoding="utf-8") as file:
        code, = re.findall("```python\n(.*?)```", file.read(), re.S)
    names = {"model": model, "SimulateTouch": SimulateTouch, "CSVReader": CSVReader}
    exec(code, names)  # pylint: disable=exec-used
    touch = names["touch"]
    touch.UpdatePipeline()
    steps = servermanager.Fetch(touch, idx=1)
    found = 0
    times = names["table"]["Time"]
    for tool in (0, 1):
        moved = numpy.transpose([names["table"][f"Tool{tool}_{axis}"] for axis in "XYZ"])
        with open(f"run-tool{tool}.csv", newline="", encoding="utf-8") as file:
            recorded = [vector(tick, "displacement", "m") for tick in csv.DictReader(file)]
        assert tool == 1 or (moved == recorded).all()
        of_steps = [vtk_to_numpy(steps.GetColumnByName(name))
                    for name in ("Time", f"Position{tool}", f"Force{tool}")]
        for time, place, force in list(zip(*of_steps))[1:]:
            # Between two ticks the tool goes beyond neither.
            after = min(numpy.searchsorted(times, time), len(times) - 1)
            ends = moved[after - 1:after + 1]
            assert (place >= ends.min(axis=0) - 1e-9).all(), (time, place, ends)
            assert (place <= ends.max(axis=0) + 1e-9).all(), (time, place, ends)
            found += numpy.linalg.norm(force) > 0.01
    assert found > 100, found
    replay = ReplayTouch(Input=space, FileName="run-tool0.csv")
    expect_error(replay.UpdatePipeline, "a reduced model was touched", "Simulate Touch")


def main():
    servo, make_space = sys.argv[1:]
    bonded, ticks = record(servo, make_space, "node")
    replay = check("node", bonded, ticks, ATTACHED)
    rigid, ticks = record(servo, make_space, "tool", "whole")
    check("tool", rigid, ticks, PRESSES)
    check_reduced(servo, bonded)

    check_bad_input(bonded)

    with open("node.csv", encoding="utf-8") as file:
        of_another = file.read().replace("scene=", "scene=0")
    with open("another.csv", "w", encoding="utf-8") as file:
        file.write(of_another)
    replay.FileName = "another.csv"
    expect_error(replay.UpdatePipeline, "is a recording of another body")
    replay.FileName = "missing.csv"
    expect_error(replay.UpdatePipeline, "'missing.csv' cannot be opened: No such file")
    if not os.path.exists("pipe.csv"):
        os.mkfifo("pipe.csv")
    replay.FileName = "pipe.csv"
    expect_error(replay.UpdatePipeline, "'pipe.csv' is a pipe")
    with open("other.csv", "w", encoding="ascii") as file:
        file.write("time_s,b\n1,2\n")
    replay.FileName = "other.csv"
    expect_error(replay.UpdatePipeline, "is no recording of the haptic loop", "contact")
    replay.FileName = ""
    expect_error(replay.UpdatePipeline, "No recording is named")


if __name__ == "__main__":
    main()

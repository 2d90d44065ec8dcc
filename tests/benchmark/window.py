# SPDX-License-Identifier: BSD-3-Clause
"""Frames a second of ParaView's window and the pace of the servo loop, in one run: the example's
liver is pressed by the simulated hand, while nothing else is drawn. Sample run:

  plugins=$(echo $PWD/build/lib/paraview-*/plugins)
  PALPATE_SOURCE_DIR=$PWD PV_PLUGIN_PATH=$plugins/Palpate:$plugins/PalpateInteractor \\
    xvfb-run -a -s "-noreset -screen 0 1280x1024x24" \\
    paraview --disable-registry --script tests/benchmark/window.py

Prints a row of a table for the dock without its graph, and one with it: frames a second (mean and
least of the seconds), ticks a second, how late they began (half, 99 %, all, µs), and the share of
a core that ParaView's process took. Then comes the floor: how often ParaView draws the same view in
the same window, as fast as it can, with no loop beside it and nothing that moves. The last row is
of a space that is explored around the hand meanwhile, from the beginning.
"""

import os
import re
import sys
import tempfile
import time
import traceback

from paraview.simple import *

source = os.environ["PALPATE_SOURCE_DIR"]
sys.path.append(os.path.join(source, "tests", "paraview"))
from qt import QtCore, application, part, wait

SECONDS = 20
SETTLING = 3  # s, in which edges are smoothed no more where that takes too long


def numbers(label):
    return [float(number) for number in re.findall(r"[\d.]+", label.text())]


def measure(name):
    part("device").setCurrentText("Simulated hand")
    part("start").click()
    wait(SETTLING)
    frames = []
    begin, cpu = time.monotonic(), time.process_time()
    for _ in range(SECONDS):
        wait(1)
        frames.append(numbers(part("rates"))[1])
    share = (time.process_time() - cpu) / (time.monotonic() - begin)
    ticks, late, missed = (numbers(part(name)) for name in ("rates", "lateness", "missed"))
    part("start").click()
    print(f"| {name} | {sum(frames) / len(frames):.1f} | {min(frames):.0f} | {ticks[0]:.1f} |"
          f" {late[0]:.0f} / {late[1]:.0f} / {late[2]:.0f} | {missed[0]:.0f} of {missed[1]:.0f} |"
          f" {share:.2f} |", flush=True)


def measure_floor():
    """The picture as it is, again and again."""
    view = GetActiveView()
    view.UseFXAA = 0  # as while it touches, where frames are late
    frames = 0
    begin, cpu = time.monotonic(), time.process_time()
    while time.monotonic() - begin < SECONDS:
        view.SMProxy.StillRender()
        application.processEvents()
        frames += 1
    seconds = time.monotonic() - begin
    share = (time.process_time() - cpu) / seconds
    print(f"| floor | {frames / seconds:.1f} | | | | | {share:.2f} |", flush=True)


def load(example, state):
    liver = os.path.join(source, "examples", "liver")
    LoadState(os.path.join(source, "examples", example, state), data_directory=liver)
    wait(1)


def main():
    try:
        load("liver", "liver.pvsm")
        print("view", *GetActiveView().ViewSize)
        measure("dock")
        part("graph").setChecked(True)
        part("area").ensureWidgetVisible(part("forceGraph"))
        measure("with the graph")
        measure_floor()
        part("graph").setChecked(False)
        ResetSession()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            load("online", "online.pvsm")
            measure("explored around the hand")
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, main)

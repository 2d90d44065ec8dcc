# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window and quits; test_pictures.py reads what it prints."""

import os
import sys
import traceback

from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from qt import QtCore, application, display, wait


def select(view, place):
    """Points of what is seen there, as with a small rectangle of the mouse."""
    x, y = display(view, place)
    SelectSurfacePoints(Rectangle=[x - 2, y - 2, x + 2, y + 2], View=view)
    wait(0.3)


def touch_what_is_selected():
    space = OpenDataFile(os.path.abspath("pictures.palpate"))
    view = GetActiveViewOrCreate("RenderView")
    Show(space, view)
    touch = TouchStateSpace(Input=space)
    touch.UpdatePipeline()
    rest = [touch.FieldData["ActivePosition"].GetRange(axis)[0] for axis in range(3)]
    # Within the body, seen through its near side.
    view.CameraPosition, view.CameraFocalPoint = [rest[0], rest[1], rest[2] - 0.5], rest
    view.CameraViewUp = [0, 1, 0]
    Render(view)
    wait(0.3)
    inside = [-0.01, -0.01, -0.02]
    select(view, [x + u for x, u in zip(rest, inside)])
    print("touched", touch.ActiveNode, *touch.Displacement)
    select(view, [rest[0] - 0.08, rest[1] - 0.05, rest[2]])  # the body alone
    print("still", touch.ActiveNode, *touch.Displacement, flush=True)
    Delete(touch)
    return space


def chart(space):
    report = AccuracyReport(Input=space, TestPoints=5, Methods=["Energy Hermite", "Trilinear"])
    view = CreateView("XYChartView")
    shown = Show(OutputPort(report, 3), view)
    wait(0.2)
    print("log", view.LeftAxisLogScale, view.BottomAxisLogScale)
    print("time", "ns" in view.BottomAxisTitle)
    shown.XArrayName = "Bytes"
    print("bytes", "bytes" in view.BottomAxisTitle, flush=True)


def main():
    try:
        chart(touch_what_is_selected())
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, main)

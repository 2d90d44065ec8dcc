# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, touches a reduced body with the mouse and the simulated hand as
PALPATE_INTERACTOR_RUN says, and quits; test_hands.py reads what it prints. What a person clicks is
clicked."""

import os
import re
import sys

from paraview import servermanager
from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from dock_support import measure_frames, run_in_turn, runs, said, unfold, wait_for
from qt import (Button, Event, QtCore, QTest, QtWidgets, application, part, pixel_of, press_escape,
                send, wait, window)
from support import box_body, node_at, source
from test_interactor import HOST

LENGTH, WIDTH = 0.2, 0.1
REACH = 0.01
CORNERS = [[LENGTH, y, WIDTH] for y in (0, WIDTH)]
# Of the top, between the tools, that neither holds.
BETWEEN = [LENGTH, WIDTH / 2, WIDTH]
IMAGE = [600, 450]
# A place that is touched moves by more than this, m.
MOVED = 0.0005
TOOL, DEVICE, FORCE, STATE = range(4)


def model_of_block(**settings):
    body = source(box_body((4, 2, 2), (LENGTH, WIDTH, WIDTH)), "box")
    material = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=5000,
                              PoissonsRatio=0.4, Density=1000, ViscousTime=0.01)
    boundary = SetBoundary(Input=material, FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    nodes = [node_at(boundary, place) for place in CORNERS]
    model = BuildReducedModel(Input=boundary, ActiveNodes=nodes, TipRadius=0.02, Reach=REACH,
                              Modes=30, TrainingPaths=2, PathDuration=0.5, TestPaths=0,
                              **settings)
    view = GetActiveViewOrCreate("RenderView")
    Show(model, view)
    model.UpdatePipeline()
    view.OrientationAxesVisibility = 0
    view.CameraPosition = [0.5, -0.15, 0.5]
    view.CameraFocalPoint = [0.1, 0.05, 0.05]
    view.CameraViewUp = [0, 0, 1]
    view.ResetCamera()
    Render()
    wait(0.3)
    return model, view, nodes


def cell(tool, column):
    return part("tools").item(tool, column).text()


def force(tool):
    """At the device, N."""
    found = re.match(r"[\d.]+", cell(tool, FORCE))
    return float(found[0]) if found else 0


def holds(tool):
    return cell(tool, STATE) == "running, held"


def choose_device(tool, name):
    part(f"deviceOfTool{tool}").setCurrentText(name)


def start(*devices):
    assert not runs() and part("toolsGroup").isVisible() and not part("device").isVisible()
    for tool, device in enumerate(devices):
        choose_device(tool, device)
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert runs(), part("message").text()


def stop():
    assert runs()
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert not runs()


def shown_at(place):
    """The displacement of a point of the shown surface, m."""
    shown = servermanager.Fetch(FindSource("TouchReducedModel1"))
    moved = shown.GetPointData().GetArray("Displacement")
    for i in range(shown.GetNumberOfPoints()):
        at = [x - u for x, u in zip(shown.GetPoint(i), moved.GetTuple(i))]
        if max(abs(a - b) for a, b in zip(at, place)) < 1e-5:
            return moved.GetTuple(i)
    raise AssertionError(f"no point at {place}")


def largest_at(place, seconds):
    """Of the displacement of a point in some time, m; not longer than until it has moved."""
    largest = 0
    for _ in range(round(seconds / 0.1)):
        wait(0.1)
        largest = max(largest, max(abs(u) for u in shown_at(place)))
        if largest > MOVED:
            break
    return largest


def press_and_drag(view, distance=20, place=CORNERS[0]):
    """Tool 0 is held by the mouse, and moved upwards by some pixels."""
    step = 5
    at = pixel_of(view, place)
    send(Event.MouseButtonPress, at)
    for way in range(step, distance + 1, step):
        send(Event.MouseMove, at + QtCore.QPoint(0, -way), Button.NoButton)
        wait(0.02)
    wait_for(lambda: holds(0) and force(0) > 0.05, "the mouse holds tool 0")
    return at + QtCore.QPoint(0, -distance)


def let_go(at):
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
    wait_for(lambda: not holds(0), "the mouse lets go")


def both():
    """Two tools of one body, in a window of two sizes; one stops and the other goes on; a picture
    of the body at rest afterwards."""
    _, view, nodes = model_of_block()
    for size in ((1000, 700), (1500, 1010)):
        window.resize(*size)
        wait(0.5)
        Render()
        start("Mouse", "Simulated hand")
        wait_for(lambda: "blue dot" in said(view), "the view says what to do")
        wait_for(lambda: holds(1) and force(1) > 0.05, "the hand holds tool 1")
        end = press_and_drag(view)
        assert cell(0, TOOL) == f"0 ({nodes[0]})" and cell(1, TOOL) == f"1 ({nodes[1]})"
        print(f"between_{size[0]}", largest_at(BETWEEN, 2))
        # The hand goes deeper and comes back once in four seconds.
        wait_for(lambda: min(force(0), force(1)) > 0.05, "both feel the body")
        print(f"forces_{size[0]}", force(0), force(1))
        assert re.match(r"[\d.]+$", part("trust").text()), part("trust").text()
        unfold("pace")
        assert "steps/s" in part("rates").text() and part("stepTime").isVisible()
        assert not part("energy").isVisible() and not part("forceScale").isEnabled()
        window.grab().save(f"both_{size[0]}.png")
        SaveScreenshot(f"touched_{size[0]}.png", view, ImageResolution=IMAGE)
        if size[0] == 1000:
            measure_frames(view, 5)
        let_go(end)
        stop()
        assert shown_at(BETWEEN) == (0, 0, 0)
        # Its letters have the size that fits the window.
        shown = GetDisplayProperties(FindSource("TouchReducedModel1"), view)
        shown.SetScalarBarVisibility(view, False)
        SaveScreenshot(f"rest_{size[0]}.png", view, ImageResolution=IMAGE)


def sagging():
    """Under gravity the hands find the tools where these hang."""
    _, view, _ = model_of_block(BodyForce=[0, 0, -1])
    start("Mouse", "None")
    hung = [shown_at(place) for place in (BETWEEN, CORNERS[0])]
    assert max(u[2] for u in hung) < -0.03, hung
    place = [x + u for x, u in zip(CORNERS[0], hung[1])]
    end = press_and_drag(view, place=place)
    print("sagging", force(0))
    let_go(end)
    choose_device(1, "Simulated hand")
    wait_for(lambda: holds(1) and force(1) > 0.05, "the hand holds tool 1")
    stop()
    assert [shown_at(place) for place in (BETWEEN, CORNERS[0])] == hung


def apart():
    """What becomes of one tool is none of the other's; all of it ends together."""
    model, view, _ = model_of_block()
    part("records").click()
    part("recordingFile").findChild(QtWidgets.QLineEdit).setText(os.path.abspath("touch.csv"))
    # One mouse has one tool.
    choose_device(0, "Mouse")
    choose_device(1, "Mouse")
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert not runs() and "one device has one tool" in part("message").text()
    start("Mouse", "Simulated hand")
    wait_for(lambda: holds(1), "the hand holds tool 1")
    # Farther than the model was made for it is told.
    end = press_and_drag(view, 150)
    wait_for(lambda: "not to be trusted" in part("trust").text() and
             "not to be trusted" in said(view), "trust is told")
    window.grab().save("untrusted.png")
    # The hand's tool is taken from it: the mouse goes on.
    choose_device(1, "None")
    wait_for(lambda: cell(1, STATE) == "free", "tool 1 is free")
    assert os.path.exists("touch-tool1.csv")
    assert runs() and holds(0) and force(0) > 0.05
    moved = max(abs(u) for u in shown_at(CORNERS[1]))
    # And back.
    let_go(end)
    choose_device(1, "Simulated hand")
    wait_for(lambda: holds(1) and force(1) > 0.05, "the hand holds tool 1 again")
    choose_device(0, "None")
    wait_for(lambda: cell(0, STATE) == "free", "tool 0 is free")
    assert runs() and holds(1)
    print("free", moved, largest_at(CORNERS[0], 2))
    # As long as it runs a device that another tool has is not taken from that.
    choose_device(0, "Mouse")
    choose_device(1, "Mouse")
    assert "one device has one tool" in part("message").text()
    assert part("deviceOfTool1").currentText() == "Simulated hand"
    window.activateWindow()
    wait(0.2)
    press_escape(window)
    assert not runs() and shown_at(BETWEEN) == (0, 0, 0)
    assert os.path.exists("touch-tool0.csv") and os.path.exists("touch-tool1-2.csv")
    part("records").click()
    threads = len(os.listdir("/proc/self/task"))
    for _ in range(20):
        start("Mouse", "Simulated hand")
        application.processEvents()
        stop()
        application.processEvents()
    print("threads", len(os.listdir("/proc/self/task")) - threads)
    # Without the source all is over.
    start("Mouse", "Simulated hand")
    wait_for(lambda: holds(1), "the hand holds tool 1")
    Delete(FindSource("TouchReducedModel1"))
    wait_for(lambda: not runs(), "it has ended")
    assert "was deleted" in part("message").text(), part("message").text()
    Delete(model)
    wait_for(lambda: not part("toolsGroup").isVisible(), "there are no tools")
    assert part("device").isVisible() and part("energy").isVisibleTo(part("pace"))


def remote():
    """The model is built on a server, and shown by it; the body is stepped here."""
    Connect(HOST, int(os.environ["PALPATE_INTERACTOR_PORT"]))
    wait(0.5)
    model, view, _ = model_of_block()
    start("Mouse", "Simulated hand")
    wait_for(lambda: holds(1) and force(1) > 0.05, "the hand holds tool 1")
    end = press_and_drag(view)
    print("between", largest_at(BETWEEN, 2))
    wait_for(lambda: min(force(0), force(1)) > 0.05, "both feel the body")
    print("forces", force(0), force(1))
    print("ranks", servermanager.ActiveConnection.GetNumberOfDataPartitions())
    let_go(end)
    stop()
    assert shown_at(BETWEEN) == (0, 0, 0)
    # Another model is another run.
    start("None", "Simulated hand")
    wait_for(lambda: holds(1), "the hand holds tool 1 again")
    model.Modes = 20
    model.UpdatePipeline()
    wait_for(lambda: not runs(), "the model is another one")
    assert "Start again" in part("message").text(), part("message").text()
    assert shown_at(BETWEEN) == (0, 0, 0)
    start("None", "Simulated hand")
    wait_for(lambda: holds(1) and force(1) > 0.05, "the hand holds tool 1 of the new model")
    Disconnect()
    wait_for(lambda: not runs(), "disconnected")
    print("ended 1")


if __name__ != "hands_script":  # Else another script uses what is here.
    # In the loop of events, as what a person does.
    QtCore.QTimer.singleShot(300, lambda: run_in_turn(
        {"both": both, "apart": apart, "sagging": sagging, "remote": remote}))

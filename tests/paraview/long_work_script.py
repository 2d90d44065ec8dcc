# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, does what PALPATE_INTERACTOR_RUN says with a space that takes
long, and quits; test_long_work.py reads what it prints."""

import os
import sys
import traceback

from paraview import servermanager
from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from qt import (Button, Modifier, QtCore, QTest, QtWidgets, application, drag, part,
                pixel_of_node, press_escape, wait_until, window)
from support import box_body, node_at, source

ABORTED = 4


def figure(space, name):
    return space.FieldData[name].GetRange(0)[0]


def found(space):
    return figure(space, "Solved") + figure(space, "Reused")


def precompute(**settings):
    reader = StateSpaceReader(FileName=os.path.abspath("block.palpate"))
    reader.UpdatePipeline()
    body = MergeBlocks(Input=ExtractBlock(Input=reader, Selectors=["/Root/Body"]))
    node = int(figure(reader, "ActiveNodes"))
    return PrecomputeStateSpace(Input=body, ActiveNodes=[node], HalfWidth=0.01, **settings)


def aborting():
    """The bar tells how far it is and how long it takes, its button ends it, and what was found is
    there, to be seen and touched. Escape stops what touches another space; nothing else is heard
    meanwhile."""
    view = GetActiveViewOrCreate("RenderView")
    other = OpenDataFile(os.path.abspath("block.palpate"))
    Show(other, view)
    wait_until(lambda: part("space").count() > 0, "the dock knows of it")
    part("device").setCurrentText("Simulated hand")
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert part("start").text() == "Stop", part("message").text()
    space = precompute(Resolution=41, FileName=os.path.abspath("long.palpate"))
    bar = next(w for w in window.findChildren(QtWidgets.QWidget)
               if w.metaObject().className() == "pqProgressWidget")
    button = bar.findChild(QtWidgets.QToolButton)
    enabled = [button.isEnabled()]
    texts, escaped, closed = [], [], []

    def look():
        text = bar.findChild(QtWidgets.QLabel).text()
        if "configurations" in text and "left" in text and text not in texts:
            texts.append(text)
        if texts and not escaped:
            press_escape(window)
            escaped.append(part("start").text() == "Start")
        if len(texts) >= 3 and not closed:
            closed.append(window.close())
            enabled.append(button.isEnabled())
            window.grab().save("working.png")
            place = button.mapTo(window, button.rect().center())
            QTest.mouseClick(window.windowHandle(), Button.LeftButton, Modifier.NoModifier,
                             place)

    timer = QtCore.QTimer()
    timer.timeout.connect(look)
    timer.start(20)
    space.UpdatePipeline()
    timer.stop()
    enabled.append(button.isEnabled())
    print(texts)
    print("texts", len(texts))
    print("escaped", *map(int, escaped))
    print("closed", *map(int, closed))
    Delete(FindSource("TouchStateSpace1"))
    Delete(other)
    print("enabled", *map(int, enabled))
    print("aborted", found(space), 41 ** 3, figure(space, "Complete"))
    view.ResetCamera()
    SaveScreenshot("empty.png", view, ImageResolution=[600, 450])
    Show(space, view)
    view.ResetCamera()
    touch = TouchStateSpace(Input=space, Displacement=[0.0004, 0, 0])
    touch.UpdatePipeline()
    print("touched", figure(touch, "Found"))
    Render()
    SaveScreenshot("partial.png", view, ImageResolution=[600, 450])
    Delete(touch)
    Delete(space)


def press_abort_in(work):
    """Presses the button of ParaView's bar as soon as it may be, while the filter works."""
    bar = next(w for w in window.findChildren(QtWidgets.QWidget)
               if w.metaObject().className() == "pqProgressWidget")
    button = bar.findChild(QtWidgets.QToolButton)
    pressed = []

    def look():
        if button.isEnabled() and button.isVisible():
            pressed.append(1)
            QTest.mouseClick(window.windowHandle(), Button.LeftButton, Modifier.NoModifier,
                             button.mapTo(window, button.rect().center()))

    timer = QtCore.QTimer()
    timer.timeout.connect(look)
    timer.start(20)
    work.UpdatePipeline()
    timer.stop()
    assert pressed, f"{work.GetXMLName()} hears no button"


def hearing():
    """Each filter that works for long hears the button: motions that would take minutes, and a
    model that would, end at once, with what there is."""
    body = source(box_body((4, 2, 2), (0.2, 0.1, 0.1)), "box")
    material = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=5000,
                              PoissonsRatio=0.4, Density=1000, ViscousTime=0.01)
    boundary = SetBoundary(Input=material, FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    tool = {"ActiveNodes": [node_at(boundary, [0.2, 0, 0.1])], "TipRadius": 0.02}
    model = {"Reach": 0.01, "Modes": 10, "TestPaths": 0, "PathDuration": 0.2} | tool
    with open("path.csv", "w", encoding="ascii") as table:
        table.write("Time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,0\n1,0.005,0,0\n")
    motion = {"ToolPaths": CSVReader(FileName=["path.csv"])}
    reduced = BuildReducedModel(Input=boundary, TrainingPaths=1, **model)
    reduced.UpdatePipeline()
    touch = SimulateTouch(Input=reduced, EndTime=400, **motion)
    press_abort_in(touch)
    assert figure(touch, "Complete") == 0
    whole = SolveDynamics(Input=boundary, EndTime=100, **motion, **tool)
    press_abort_in(whole)
    assert figure(whole, "Outcome") == ABORTED
    press_abort_in(BuildReducedModel(Input=boundary, TrainingPaths=200, **model))
    print("heard 1")


def touches():
    return part("state").text().endswith(", touching")


def growing(touched=True):
    """What is found is shown again and again, while it is touched."""
    view = GetActiveViewOrCreate("RenderView")
    # Of the 343 some are found each time, on a fast machine too.
    space = precompute(UpdateInterval=0.001,
                       FileName=os.path.abspath(f"growing_{touched}.palpate"))
    Show(space, view)
    view.CameraPosition = [0.5, 0.25, 0.4]
    view.CameraFocalPoint = [0.05, 0.03, 0.03]
    view.CameraViewUp = [0, 1, 0]
    view.ResetCamera()
    Render()
    counts = [found(space)]
    if touched:
        wait_until(lambda: part("space").count() > 0, "the dock knows of it")
        part("space").setCurrentIndex(part("space").count() - 1)
        part("device").setCurrentText("Mouse")
        QTest.mouseClick(part("start"), Button.LeftButton)
        assert part("start").text() == "Stop", part("message").text()
        drag(pixel_of_node(view, FindSource("TouchStateSpace1")), QtCore.QPoint(8, 0), 1)
        wait_until(touches, "the drag takes hold")

    def has_grown():
        assert not touched or touches(), "what is held is let go of"
        if found(space) != counts[-1]:
            counts.append(found(space))
        return len(counts) == 4

    wait_until(has_grown, "it grows")
    print("counts", *counts)
    space.UpdateInterval = 0
    space.UpdatePipeline()
    print("found", found(space))
    print("complete", figure(space, "Complete"))
    if touched:
        assert touches(), part("message").text()
        QTest.mouseClick(part("start"), Button.LeftButton)


def here():
    aborting()
    hearing()
    growing()


def remote():
    """It grows on a server with two ranks, too."""
    Connect("127.0.0.1", int(os.environ["PALPATE_INTERACTOR_PORT"]))
    growing(touched=False)
    print("ranks", servermanager.ActiveConnection.GetNumberOfDataPartitions())
    Disconnect()  # ParaView 5.13 that quits before says that a pipe is broken.


def main():
    try:
        {"here": here, "remote": remote}[os.environ["PALPATE_INTERACTOR_RUN"]]()
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, main)

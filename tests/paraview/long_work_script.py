# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, does what PALPATE_INTERACTOR_RUN says with a space that takes long,
and quits; test_long_work.py reads what it prints."""

import os
import time
import traceback

from paraview import servermanager
from paraview.simple import *
from PyQt5 import QtCore, QtWidgets
from PyQt5.QtTest import QTest

TIME_OUT = 60  # s, of anything that is waited for
application = QtWidgets.QApplication.instance()
window = next(w for w in application.topLevelWidgets() if w.objectName() == "pqClientMainWindow")
dock = window.findChild(QtWidgets.QDockWidget, "pqPalpateInteractorDock")


def part(name):
    return dock.findChild(QtWidgets.QWidget, name)


def wait_until(condition, what):
    end = time.monotonic() + TIME_OUT
    while not condition():
        assert time.monotonic() < end, f"waited in vain: {what}"
        application.processEvents(QtCore.QEventLoop.AllEvents, 5)
        time.sleep(0.01)


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
    there, to be seen and touched. Nothing else is heard meanwhile."""
    view = GetActiveViewOrCreate("RenderView")
    space = precompute(Resolution=41, FileName=os.path.abspath("long.palpate"))
    bar = next(w for w in window.findChildren(QtWidgets.QWidget)
               if w.metaObject().className() == "pqProgressWidget")
    button = bar.findChild(QtWidgets.QToolButton)
    enabled = [button.isEnabled()]
    texts, closed = [], []

    def look():
        text = bar.findChild(QtWidgets.QLabel).text()
        if "configurations" in text and "left" in text and text not in texts:
            texts.append(text)
        if len(texts) >= 3 and not closed:
            closed.append(window.close())
            enabled.append(button.isEnabled())
            window.grab().save("working.png")
            place = button.mapTo(window, button.rect().center())
            QTest.mouseClick(window.windowHandle(), QtCore.Qt.LeftButton, QtCore.Qt.NoModifier,
                             place)

    timer = QtCore.QTimer()
    timer.timeout.connect(look)
    timer.start(20)
    space.UpdatePipeline()
    timer.stop()
    enabled.append(button.isEnabled())
    print(texts)
    print("texts", len(texts))
    print("closed", *map(int, closed))
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


def growing(touched=True):
    """What is found is shown again and again, while it is touched."""
    view = GetActiveViewOrCreate("RenderView")
    # Of the 343 some are found each time, on a fast machine too.
    space = precompute(UpdateInterval=0.001,
                       FileName=os.path.abspath(f"growing_{touched}.palpate"))
    Show(space, view)
    Render()
    view.ResetCamera()
    counts = [found(space)]
    if touched:
        wait_until(lambda: part("space").count() > 0, "the dock knows of it")
        part("space").setCurrentIndex(part("space").count() - 1)
        part("device").setCurrentText("Simulated hand")
        QTest.mouseClick(part("start"), QtCore.Qt.LeftButton)
        assert part("start").text() == "Stop", part("message").text()

    def has_grown():
        if found(space) != counts[-1]:
            counts.append(found(space))
        return len(counts) == 4

    wait_until(has_grown, "it grows")
    print("counts", *counts)
    if touched:
        assert part("start").text() == "Stop", part("message").text()
        wait_until(lambda: part("state").text().endswith(", touching"), "it is touched")
    space.UpdateInterval = 0
    space.UpdatePipeline()
    print("found", found(space))
    print("complete", figure(space, "Complete"))
    if touched:
        assert part("start").text() == "Stop", part("message").text()
        wait_until(lambda: part("state").text().endswith(", touching"), "it is touched again")
        QTest.mouseClick(part("start"), QtCore.Qt.LeftButton)


def here():
    aborting()
    growing()


def remote():
    """It grows on a server with two ranks, too."""
    Connect("localhost", int(os.environ["PALPATE_INTERACTOR_PORT"]))
    growing(touched=False)
    print("ranks", servermanager.ActiveConnection.GetNumberOfDataPartitions())


def main():
    try:
        {"here": here, "remote": remote}[os.environ["PALPATE_INTERACTOR_RUN"]]()
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, main)

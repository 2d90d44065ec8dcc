# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, does what PALPATE_INTERACTOR_RUN says with the dock Palpate, and
quits; test_interactor.py reads what it prints. What a person clicks is clicked."""

import os
import re
import subprocess
import sys
import time
import traceback

from paraview import servermanager
from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from qt import (Button, Event, Modifier, QtCore, QtGui, QTest, QtWidgets, apply, application,
                canvas, choose, dock, in_dialog, menu, open_file, part, property_widget, wait,
                wait_until, window, write)


def wait_for(condition, what):
    wait_until(condition, lambda: f"{what}; {part('state').text()}")


def number(name):
    """The first number of a label."""
    return float(re.search(r"-?[\d.]+", part(name).text()).group())


def runs():
    return part("start").text() == "Stop"


def click_start(device="Simulated hand"):
    assert not runs()
    part("device").setCurrentText(device)
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert runs(), part("message").text()


def click_stop():
    assert runs()
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert not runs()


def touches():
    return part("state").text().endswith(", touching")


def touch_filter():
    return FindSource("TouchStateSpace1")


def shown():
    """How far the node is displaced in the view, m; the view is a frame behind the loop."""
    return max(abs(c) for c in touch_filter().Displacement)


def ended(why):
    wait_for(lambda: not runs(), why)
    assert why in part("message").text(), part("message").text()
    assert part("state").text() == "closed"


def open_space():
    space = OpenDataFile(os.path.abspath("block.palpate"))
    view = GetActiveViewOrCreate("RenderView")
    Show(space, view)
    view.CameraPosition = [0.5, 0.25, 0.4]
    view.CameraFocalPoint = [0.05, 0.03, 0.03]
    view.CameraViewUp = [0, 1, 0]
    view.ResetCamera()
    Render()
    wait(0.2)
    assert part("space").count() == 1
    return space, view


def touching():
    """With the simulated hand, by the toolbar and by keys: the loop, the view, the graph, the
    recording, and the body at rest afterwards."""
    _, view = open_space()
    part("device").setCurrentText("Simulated hand")
    part("records").click()
    part("recordingFile").findChild(QtWidgets.QLineEdit).setText(os.path.abspath("touch.csv"))
    part("graph").setChecked(True)
    toolbar = window.findChild(QtWidgets.QToolBar, "PalpateToolbar")
    toolbar.widgetForAction(toolbar.actions()[0]).click()
    assert runs(), part("message").text()
    wait(2)
    wait_for(lambda: touches() and number("force") > 0.1 and shown() > 0.002, "the hand presses")
    assert number("node") >= 0
    # Frames that come late do without smooth edges.
    slow = QtCore.QTimer()
    slow.timeout.connect(lambda: time.sleep(0.06))
    slow.start(1)
    body = GetDisplayProperties(touch_filter(), view)
    wait_for(lambda: view.UseFXAA == 0, "edges are smoothed no more")
    assert body.BackfaceRepresentation == "Cull Backface"
    slow.stop()
    wait_for(lambda: touches() and number("force") > 0.1 and shown() > 0.002,
             "the hand presses again")
    print("force", number("force"))
    # What ParaView tells of the body is told anew when somebody asks.
    largest = touch_filter().PointData["Displacement"].GetRange(-1)[1]
    assert largest > 0.5 * shown() > 0.001, (largest, shown())
    window.grab().save("window.png")
    SaveScreenshot("touched.png", view, ImageResolution=[600, 450])
    print("rate", number("rates"))
    print("frames", float(re.search(r"view (\d+)", part("rates").text()).group(1)))
    print("late", *re.findall(r"\d+", part("lateness").text()))
    print("ticks", *re.findall(r"\d+", part("missed").text()))
    part("forceGraph").grabFramebuffer().save("graph.png")
    # Without a window manager nobody else does.
    window.activateWindow()
    wait(0.2)
    QTest.keyClick(window, QtCore.Qt.Key.Key_Escape)
    assert not runs()
    assert list(touch_filter().Displacement) == [0, 0, 0]
    wait_for(lambda: touch_filter().PointData["Displacement"].GetRange(-1)[1] == 0, "all at rest")
    assert view.UseFXAA == 1
    assert body.BackfaceRepresentation == "Follow Frontface"
    SaveScreenshot("rest.png", view, ImageResolution=[600, 450])
    print("recorded", number("recorded"))
    # Another one goes beside the first.
    QTest.keyClick(window, QtCore.Qt.Key.Key_T,
                   Modifier.ControlModifier | Modifier.ShiftModifier)
    assert runs(), part("message").text()
    wait(0.3)
    click_stop()
    SaveScreenshot("rest_again.png", view, ImageResolution=[600, 450])
    assert os.path.exists("touch-2.csv")
    assert part("recorded").text().endswith("touch-2.csv"), part("recorded").text()


def pixel_of_node(view):
    """Where the active node is seen."""
    renderer = view.GetRenderer()
    values = touch_filter().FieldData["ActivePosition"]
    renderer.SetWorldPoint(*(values.GetRange(axis)[0] for axis in range(3)), 1)
    renderer.WorldToDisplay()
    x, y, _ = renderer.GetDisplayPoint()
    return QtCore.QPoint(round(x), canvas().height() - 1 - round(y))


def send(kind, at, button=Button.LeftButton, buttons=Button.LeftButton):
    """An event of the mouse in the view."""
    application.sendEvent(canvas(), QtGui.QMouseEvent(
        kind, QtCore.QPointF(at), QtCore.QPointF(canvas().mapToGlobal(at)), button, buttons,
        Modifier.NoModifier))


def drag(start, step, count):
    """@returns where the button is still pressed."""
    send(Event.MouseButtonPress, start)
    wait(0.3)
    for i in range(1, count + 1):
        send(Event.MouseMove, start + i * step, Button.NoButton)
        wait(0.02)
    return start + count * step


def let_go(at):
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
    wait_for(lambda: not touches(), "the node is let go of")
    wait_for(lambda: list(touch_filter().Displacement) == [0, 0, 0], "the body is at rest")


def mouse():
    """A press beside the body is the camera's; one on it holds the node, which follows the drag."""
    space, view = open_space()
    # A filter that somebody has left where it was shows the body at rest from the start on.
    left = TouchStateSpace(Input=space, Displacement=[0, 0, 0.008])
    ColorBy(Show(left, view), ("POINTS", "Displacement"))
    Hide(space, view)
    Render()
    wait(0.3)
    canvas().grabFramebuffer().save("left.png")
    click_start("Mouse")
    wait(0.5)
    canvas().grabFramebuffer().save("started.png")
    node = pixel_of_node(view)
    before = list(view.CameraPosition)
    end = drag(QtCore.QPoint(15, 15), QtCore.QPoint(4, 2), 5)
    send(Event.MouseButtonRelease, end, buttons=Button.NoButton)
    wait(0.1)
    assert list(view.CameraPosition) != before
    assert not touches()
    view.CameraPosition = before
    view.CameraViewUp = [0, 1, 0]
    Render()

    end = drag(node, QtCore.QPoint(1, -1), 25)
    wait_for(touches, "the press takes hold")
    wait_for(lambda: number("force") > 0.05, "the drag is felt")
    SaveScreenshot("dragged.png", view, ImageResolution=[600, 450])
    dragged = list(touch_filter().Displacement)
    application.sendEvent(canvas(), QtGui.QWheelEvent(
        QtCore.QPointF(end), QtCore.QPointF(canvas().mapToGlobal(end)), QtCore.QPoint(),
        QtCore.QPoint(0, 120), Button.LeftButton, Modifier.NoModifier,
        QtCore.Qt.ScrollPhase.NoScrollPhase, False))
    direction = view.GetActiveCamera().GetDirectionOfProjection()
    wait_for(lambda: sum((now - then) * along for now, then, along in zip(
        touch_filter().Displacement, dragged, direction)) > 1e-4, "the wheel pushes the node in")
    print("dragged", max(abs(c) for c in dragged))
    assert list(view.CameraPosition) == before
    let_go(end)
    click_stop()


def road():
    """From a surface to touching it, as the quick start says, by menus, panels and the mouse."""
    open_file(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples", "liver", "liver.vtp"))
    apply()
    menu("Filters", "Palpate", "Tetrahedralize Surface")
    choose("ElementOrder", "Quadratic")
    property_widget("PreserveSurface", QtWidgets.QCheckBox).click()
    apply()
    menu("Filters", "Palpate", "Assign Material")
    choose("Law", "Neo-Hookean")
    write("YoungsModulus", "5000")
    apply()
    menu("Filters", "Palpate", "Set Boundary")
    region = property_widget("FixedRegion", QtWidgets.QComboBox)
    region.setCurrentText("Sphere")
    wait(0.1)
    for name, text in (("centerX", "-0.03"), ("centerY", "0.06"), ("centerZ", "-0.05"),
                       ("radius", "0.04")):
        line = property_widget("FixedRegion", QtWidgets.QWidget).parent().findChild(
            QtWidgets.QLineEdit, name)
        line.setText(text)
        line.editingFinished.emit()
    apply()
    menu("Filters", "Palpate", "Precompute State Space")
    nodes = property_widget("ActiveNodes", QtWidgets.QTableView)
    property_widget("ActiveNodes", QtWidgets.QToolButton).click()
    nodes.model().setData(nodes.model().index(0, 0), "107")
    write("HalfWidth", "0.004")
    write("Resolution", "3")
    write("FileName", os.path.abspath("road.palpate"))
    apply()
    view = GetActiveView()
    SaveScreenshot("road.png", view, ImageResolution=[320, 240])
    click_start("Mouse")
    wait(0.3)
    node = pixel_of_node(view)
    end = drag(node, QtCore.QPoint(1, -1), 20)
    wait_for(lambda: touches() and number("force") > 0.05, "the liver is felt")
    assert number("node") == 107
    SaveScreenshot("road_touched.png", view, ImageResolution=[320, 240])
    window.grab().save("road_window.png")
    print("felt", number("force"))
    let_go(end)
    click_stop()
    SaveScreenshot("road_rest.png", view, ImageResolution=[320, 240])


def compute_space(**settings):
    """A space of the body of the file, that is computed here."""
    reader = StateSpaceReader(FileName=os.path.abspath("block.palpate"))
    reader.UpdatePipeline()
    body = MergeBlocks(Input=ExtractBlock(Input=reader, Selectors=["/Root/Body"]))
    space = PrecomputeStateSpace(
        Input=body, ActiveNodes=[int(reader.FieldData["ActiveNodes"].GetRange(0)[0])],
        Resolution=5, **settings)
    Show(space, GetActiveViewOrCreate("RenderView"))
    Render()
    wait(0.2)
    part("space").setCurrentText("PrecomputeStateSpace1")
    return space


def change(space):
    """Makes it smaller than the hand presses, which is felt."""
    wait_for(lambda: "inside the space" in part("node").text(), "the whole space is touched")
    space.HalfWidth = 0.001
    space.UpdatePipeline()
    wait_for(lambda: "beyond the space" in part("node").text(), "the smaller space is touched")


def ends():
    """A hundred starts and stops, and each thing that may go while it runs."""
    space, view = open_space()

    def run():
        click_start()
        wait_for(touches, "the hand touches")

    click_start()
    wait(0.2)
    click_stop()
    threads = len(os.listdir("/proc/self/task"))
    for _ in range(100):
        click_start()
        application.processEvents()
        click_stop()
        application.processEvents()
    print("threads", len(os.listdir("/proc/self/task")) - threads)

    computed = compute_space(HalfWidth=0.01)
    run()
    change(computed)
    click_stop()
    for source in (touch_filter(), computed, computed.Input, computed.Input.Input,
                   computed.Input.Input.Input):
        Delete(source)
    part("space").setCurrentIndex(0)
    run()
    Delete(touch_filter())
    ended("deleted")
    run()
    Delete(space)
    ended("deleted")
    Delete(touch_filter())
    assert part("space").count() == 0
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert "no state space" in part("message").text()

    open_space()
    run()
    Delete(view)
    ended("view was closed")
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert "render view" in part("message").text()

    SetActiveView(CreateRenderView())
    wait(0.2)
    run()
    dock.close()
    assert not runs()
    dock.show()
    run()
    yes = QtWidgets.QMessageBox.StandardButton.Yes
    in_dialog(lambda question: question.button(yes).click())
    menu("Edit", "Reset Session")
    wait_for(lambda: not runs(), "reset")
    open_space()
    run()
    Disconnect()
    wait_for(lambda: not runs(), "disconnected")
    print("ended 1")


def remote():
    """The space is computed on a server, and anew while it is touched; the loop has a copy here."""
    Connect("localhost", int(os.environ["PALPATE_INTERACTOR_PORT"]))
    wait(0.5)
    space = compute_space(HalfWidth=0.01)
    click_start()
    wait_for(lambda: touches() and number("force") > 0.1 and shown() > 0.002, "the hand presses")
    change(space)
    print("ranks", servermanager.ActiveConnection.GetNumberOfDataPartitions())
    Disconnect()
    wait_for(lambda: not runs(), "disconnected")
    print("ended 1")


def lost():
    """The server is killed while its space is touched."""
    port = os.environ["PALPATE_INTERACTOR_PORT"]
    Connect("localhost", int(port))
    wait(0.5)
    open_space()
    click_start()
    wait_for(touches, "the hand presses")

    # ParaView can do no more than end: 5.11 asks before, 5.13 does not.
    in_dialog(lambda question: question.accept())
    subprocess.run(["pkill", "-KILL", "-f", f"server-port={port}"], check=True)
    wait(20)
    print("not lost", flush=True)


def goes_on(leave):
    """Starts, and leaves it running."""
    open_space()
    click_start()
    wait_for(touches, "the hand touches")
    print("left 1", flush=True)
    leave()


def main():
    try:
        {"touching": touching, "mouse": mouse, "road": road, "ends": ends, "remote": remote, "lost": lost,
         "quit": lambda: goes_on(application.quit),
         "close": lambda: goes_on(window.close)}[os.environ["PALPATE_INTERACTOR_RUN"]]()
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, main)

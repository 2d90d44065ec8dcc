# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, does what PALPATE_INTERACTOR_RUN says with the dock Palpate, and
quits; test_interactor.py reads what it prints. What a person clicks is clicked."""

import os
import re
import signal
import subprocess
import sys
import time

from paraview import servermanager
from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from dock_support import (click_start, click_stop, measure_frames, number, presses, run_in_turn,
                          runs, said, touch_filter, touches, wait_for)
from test_cut import DEPTH, HEIGHT, LENGTHS, held_block, space_of_stages, two_stages
from qt import (Button, Event, Modifier, QtCore, QtGui, QTest, QtWidgets, action, apply,
                application, canvas, choose, click, dialogs, dock, drag, in_dialog, is_shown, menu,
                open_file, part, pixel_of, pixel_of_node, press_escape, property_widget, send,
                turn_wheel, wait, wait_until, window, write)

HOST = "127.0.0.1"  # A bare system knows no name for it.
# The block's active nodes are at the end of large x: a place far from them that is seen from there,
# a camera at the other end, and a place that is seen from that.
FAR = [0.01, 0.03, 0.05]
BEHIND = [-0.4, 0.25, -0.3]
FAR_BEHIND = [0, 0.03, 0.02]


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
    # ParaView 6 draws these in the size that the picture before had, and pictures are compared.
    view.OrientationAxesVisibility = 0
    part("device").setCurrentText("Simulated hand")
    part("records").click()
    part("recordingFile").findChild(QtWidgets.QLineEdit).setText(os.path.abspath("touch.csv"))
    part("graph").setChecked(True)
    toolbar = window.findChild(QtWidgets.QToolBar, "PalpateToolbar")
    toolbar.widgetForAction(toolbar.actions()[0]).click()
    assert runs(), part("message").text()
    wait(2)
    wait_for(lambda: touches() and number("force") > 0.1 and shown() > 0.002, "the hand presses")
    assert number("place") >= 0
    # Beside the tool, too: newtons, and how far the node is moved.
    assert re.search(r"\d\.\d+ N.*\n \d+\.\d mm moved", said(view)), said(view)
    assert re.fullmatch(r"\d+\.\d mm moved", part("depth").text()), part("depth").text()
    assert not part("refresh").isEnabled()  # It would open other devices.
    # The hand has no button, and a tool that does not pull lets go by itself.
    assert not part("needsButton").isEnabled() and not part("releaseForce").isEnabled()
    assert part("releaseForce").value() == 3
    part("bonded").click()
    assert part("releaseForce").isEnabled()
    part("bonded").click()
    measure_frames(view, 4)
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
    assert re.search(r"view \d+ /s", part("rates").text()), part("rates").text()
    print("late", *re.findall(r"\d+", part("lateness").text()))
    print("ticks", *re.findall(r"\d+", part("missed").text()))
    part("forceGraph").grabFramebuffer().save("graph.png")
    # Without a window manager nobody else does.
    window.activateWindow()
    wait(0.2)
    press_escape(window)
    assert not runs() and part("refresh").isEnabled()
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
    part("records").click()
    part("graph").setChecked(False)


def let_go(at):
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
    wait_for(lambda: not touches(), "the node is let go of")
    wait_for(lambda: list(touch_filter().Displacement) == [0, 0, 0], "the body is at rest")


def pixels_of_dot(at):
    """How many around a pixel are black, and white."""
    image = canvas().grabFramebuffer()
    colours = [image.pixelColor(at.x() + i, at.y() + j)
               for i in range(-12, 13) for j in range(-12, 13)]
    least = [min(colour.getRgb()[:3]) for colour in colours]
    most = [max(colour.getRgb()[:3]) for colour in colours]
    return sum(c < 30 for c in most), sum(c > 225 for c in least)


def dots():
    """The active nodes are seen in a window of any size."""
    _, view = open_space()
    click_start("Mouse")
    for size in ((1000, 700), (1270, 1010)):
        window.resize(*size)
        wait(0.5)
        Render()
        wait(0.2)
        window.grab().save(f"dots_{size[0]}.png")
        print(f"dot_{size[0]}", *pixels_of_dot(pixel_of_node(view, touch_filter())))
    click_stop()


def escape():
    """Stops whatever mode ParaView's window is in, and under a dialog."""
    open_space()

    def expect_stop(where):
        assert runs(), where
        press_escape(window)
        assert not runs(), where

    def expect_stop_in(dialog):
        assert runs(), dialog.windowTitle()
        press_escape(dialog)
        assert not runs(), dialog.windowTitle()
        dialog.close()

    for mode in ("actionSelectSurfacePoints", "actionPolygonSelectionPoints",
                 "actionInteractiveSelectSurfacePoints", "actionHoveringSurfacePoints"):
        # ParaView tells of some modes when they begin.
        told = QtCore.QTimer()
        told.timeout.connect(lambda: [dialog.accept() for dialog in dialogs()])
        told.start(100)
        action(mode).trigger()
        told.stop()
        assert action(mode).isChecked(), mode
        click_start()
        expect_stop(mode)
        if action(mode).isChecked():
            action(mode).trigger()
    click_start()
    in_dialog(expect_stop_in)
    QtWidgets.QMessageBox.about(window, "A question", "that waits")
    assert not runs()
    print("escaped 1")


def busy():
    """The key stops the loop while ParaView handles no event."""
    open_space()
    part("records").click()
    part("recordingFile").findChild(QtWidgets.QLineEdit).setText(os.path.abspath("busy.csv"))
    click_start()
    wait_for(touches, "the hand presses")
    before = number("recorded")
    with subprocess.Popen(["sh", "-c", "sleep 1; xdotool keydown Escape; sleep 0.2; "
                                       "xdotool keyup Escape"]) as key:
        time.sleep(4)  # as a filter does that works for long
        assert key.poll() == 0, key.poll()
    wait_for(lambda: not runs(), "it has ended")
    part("records").click()
    print("busy", number("recorded") - before)


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
    SetActiveSource(left)
    wait(0.3)
    property_widget("Displacement", QtWidgets.QWidget)
    assert not is_shown("ToolPosition"), "of a rigid tool, which there is none"
    click_start("Mouse")
    wait(0.5)
    canvas().grabFramebuffer().save("started.png")
    assert "near a black dot, and drag" in said(view), said(view)
    node = pixel_of_node(view, touch_filter())
    before = list(view.CameraPosition)
    end = drag(QtCore.QPoint(15, 15), QtCore.QPoint(4, 2), 5)
    send(Event.MouseButtonRelease, end, buttons=Button.NoButton)
    wait(0.1)
    assert list(view.CameraPosition) != before
    assert not touches()
    view.CameraPosition = before
    view.CameraViewUp = [0, 1, 0]
    Render()

    click(pixel_of(view, FAR))
    wait_for(lambda: "mm away." in said(view), "it says where to press")
    assert not touches()
    view.CameraPosition = BEHIND
    Render()
    click(pixel_of(view, FAR_BEHIND))
    wait_for(lambda: "other side" in said(view), "it says that the body has to be turned")
    view.CameraPosition = before
    Render()

    end = drag(node, QtCore.QPoint(5, -5), 5)
    wait_for(touches, "the press takes hold")
    assert "dot" not in said(view), said(view)
    wait_for(lambda: number("force") > 0.05, "the drag is felt")
    SaveScreenshot("dragged.png", view, ImageResolution=[600, 450])
    dragged = list(touch_filter().Displacement)
    turn_wheel(end)
    direction = view.GetActiveCamera().GetDirectionOfProjection()
    wait_for(lambda: sum((now - then) * along for now, then, along in zip(
        touch_filter().Displacement, dragged, direction)) > 1e-4, "the wheel pushes the node in")
    print("dragged", max(abs(c) for c in dragged))
    assert list(view.CameraPosition) == before
    let_go(end)
    click_stop()


def look_at_block(space):
    """From the side on which its cut has its mouth."""
    view = GetActiveViewOrCreate("RenderView")
    Show(space, view)
    view.CameraPosition, view.CameraFocalPoint = [-0.3, -0.1, 0.25], [0.05, 0.03, 0.03]
    view.CameraViewUp = [0, 0, 1]
    view.ResetCamera()
    Render()
    wait(0.3)
    return view


def tears():
    """The mouse pulls a body with a cut until that tears; what is torn stays so, and where the work
    of the hand has gone is told."""
    boundary = two_stages("tearing")
    space = space_of_stages(boundary)
    view = look_at_block(space)
    toughness = part("fractureToughness")
    wait_for(toughness.isEnabled, "the space has a cut")
    toughness.setValue(0.05)
    click_start("Mouse")
    wait(0.5)
    end = drag(pixel_of_node(view, touch_filter()), QtCore.QPoint(0, -4), 6)
    wait_for(lambda: touches() and number("tear") > 0, "it tears")
    wait(0.5)
    torn = number("tear")
    SaveScreenshot("torn.png", view, ImageResolution=[600, 450])
    figures = [float(x) for x in re.findall(r"-?[\d.]+(?= (?:mJ|stored|torn|rubbed|lost))",
                                            part("tear").text())]
    work, *parts = figures
    assert len(parts) == 4 and abs(work - sum(parts)) < 0.02 and min(parts) > -0.02, figures
    assert touch_filter().TornArea > 0
    let_go(end)
    wait(0.3)
    assert number("tear") == torn
    SaveScreenshot("let_go.png", view, ImageResolution=[600, 450])
    click_stop()
    print("torn", torn, *figures)


def blade():
    """The mouse draws a blade through the cut while the body stays held where the mouse has pulled
    it; what is cut stays cut, and the body is let go of when the tool is no blade any more."""
    space = space_of_stages(two_stages("cutting"))
    view = look_at_block(space)
    wait_for(part("blade").isEnabled, "the space has a cut")
    click_start("Mouse")
    wait(0.5)
    end = drag(pixel_of_node(view, touch_filter()), QtCore.QPoint(0, -4), 6)
    wait_for(lambda: touches() and number("force") > 0.05, "the mouse pulls")
    send(Event.MouseButtonRelease, end, buttons=Button.NoButton, modifiers=Modifier.ControlModifier)
    wait(0.5)
    held = list(touch_filter().Displacement)
    assert touches() and max(abs(c) for c in held) > 1e-3, held
    part("bladeToughness").setValue(30)
    part("bladeFriction").setValue(0.2)
    part("blade").click()
    wait(0.5)
    assert not touches() and list(touch_filter().Displacement) == held
    assert "dark line" in said(view), said(view)
    view.CameraPosition, view.CameraFocalPoint = [0.05, -0.4, 0.09], [0.05, 0.03, 0.03]
    view.ResetCamera()
    Render()
    wait(0.3)
    click(pixel_of(view, [0.09, 0, 0.05]))
    wait_for(lambda: "mm away" in said(view), "it says where the cut is")
    mouth = pixel_of(view, [0.001, 0, HEIGHT])
    far = pixel_of(view, [0.02, 0, HEIGHT])
    end = drag(mouth, QtCore.QPoint((far.x() - mouth.x()) // 8, 0), 8)
    wait_for(lambda: number("tear") > 0, "it cuts")
    wait(0.5)
    assert part("state").text().endswith("cutting"), part("state").text()
    cut, force = number("tear"), number("force")
    figures = [float(x) for x in
               re.findall(r"-?[\d.]+(?= (?:mJ|stored|torn|rubbed|lost))", part("tear").text())]
    work, *parts = figures
    assert len(parts) == 4 and abs(work - sum(parts)) < 0.02 and min(parts) > -0.02, figures
    assert list(touch_filter().Displacement) == held and touch_filter().TornArea > 0
    SaveScreenshot("blade.png", view, ImageResolution=[600, 450])
    send(Event.MouseButtonRelease, end, buttons=Button.NoButton)
    wait_for(lambda: not touches(), "the blade is outside")
    part("blade").click()
    wait_for(lambda: list(touch_filter().Displacement) == [0, 0, 0], "the body is let go of")
    assert number("tear") == cut
    SaveScreenshot("cut_open.png", view, ImageResolution=[600, 450])
    click_stop()
    print("bladed", cut, force, *figures)


def cut_in_view(boundary, make_space):
    """A block that is touched by mouse is cut along a plane that nobody has foreseen."""
    space = make_space(boundary)
    plane_to(DEPTH)
    view = look_at_block(space)
    choose_last_sheet()
    return space, view


def plane_to(depth):
    plane = Plane(Origin=[-0.02, -0.02, HEIGHT], Point1=[depth, -0.02, HEIGHT],
                  Point2=[-0.02, 0.08, HEIGHT])
    plane.UpdatePipeline()
    return plane


def choose_last_sheet():
    assert part("sheet").count() > 0
    part("sheet").setCurrentIndex(part("sheet").count() - 1)


def has_cut(space):
    return servermanager.Fetch(space.Input).GetFieldData().HasArray("StageArea")


def refuse_to_sever(space):
    """A plane through the whole block falls a part off: the touch goes on without it."""
    input_, file_name = space.Input, space.FileName
    sources = list(GetSources())
    severing = plane_to(0.2)
    wait_for(lambda: part("sheet").count() == 2, "a sheet that is made meanwhile is listed")
    choose_last_sheet()
    QTest.mouseClick(part("cutNow"), Button.LeftButton)
    message = part("message").text()
    assert runs() and "cannot be cut there" in message, message
    assert space.Input == input_ and space.FileName == file_name
    Delete(severing)
    assert list(GetSources()) == sources, GetSources()
    choose_last_sheet()


def cuts():
    """A body that the mouse holds up is cut: it is held on, and pulls less."""
    boundary = held_block("uncut", quadratic=False)
    space, view = cut_in_view(boundary, lambda body: space_of_stages(body, FileName="cuts.palpate"))
    click_start("Mouse")
    wait(0.5)
    end = drag(pixel_of_node(view, touch_filter()), QtCore.QPoint(0, -4), 6)
    wait_for(lambda: touches() and number("force") > 0.05, "the mouse pulls")
    wait(0.5)
    before, node = number("force"), list(space.ActiveNodes)[0]
    refuse_to_sever(space)
    assert touches() and number("force") == before, "what could not be cut is held as it was"
    begun = time.monotonic()
    QTest.mouseClick(part("cutNow"), Button.LeftButton)
    print("cut", time.monotonic() - begun)
    assert runs() and "is cut" in part("message").text(), part("message").text()
    assert has_cut(space) and re.fullmatch(r"cuts_cut_[\d_-]+\.palpate", space.FileName)
    wait_for(lambda: touches() and number("force") < 0.97 * before, "the force has fallen")
    wait(0.5)
    print("forces", before, number("force"), node, list(space.ActiveNodes)[0])
    # What is felt is what a solve of the cut body says.
    solved = SolveEquilibrium(Input=space.Input, ActiveNodes=space.ActiveNodes, TipRadius=0.012,
                              Displacement=list(touch_filter().Displacement))
    right = servermanager.Fetch(solved).GetFieldData().GetArray("ReactionForce").GetTuple3(0)
    size = sum(x * x for x in right) ** 0.5
    assert abs(number("force") - size) < 0.1 * size, (number("force"), right)
    Delete(solved)
    SaveScreenshot("cut.png", view, ImageResolution=[600, 450])
    let_go(end)
    click_stop()


def cuts_pressed():
    """A body that a ball presses while its space follows the hand is cut: the press goes on."""
    boundary = held_block("uncut_too", quadratic=False)

    def around_the_hand(body):
        return PrecomputeStateSpace(Input=body, Tool="Sphere", ActiveNodes=[],
                                    Exploration="Around The Hand", LogInterval=0,
                                    FileName="pressed.palpate")

    space, view = cut_in_view(boundary, around_the_hand)
    click_start("Mouse")
    wait(0.5)
    middle = pixel_of(view, [0.03, 0.03, LENGTHS[2]])
    send(Event.MouseMove, middle)
    send(Event.MouseButtonPress, middle)
    end = drag(middle, QtCore.QPoint(0, 3), 6)
    wait_for(lambda: presses() and number("force") > 0.01, "the ball presses")
    wait(1)
    before = number("force")
    begun = time.monotonic()
    QTest.mouseClick(part("cutNow"), Button.LeftButton)
    print("cut", time.monotonic() - begun)
    assert runs() and has_cut(space), part("message").text()
    wait_for(lambda: presses() and number("force") != before and touch_filter() is not None,
             "the cut body is felt", time_out=180)  # its one explorer may share a processor
    wait(1)
    print("since", time.monotonic() - begun, "forces", before, number("force"))
    SaveScreenshot("cut_pressed.png", view, ImageResolution=[600, 450])
    let_go(end)
    click_stop()


def pick_nodes():
    """Clicks the point 107 of the liver, another one and that again, and drags: none by that."""
    view = GetActiveView()
    body = servermanager.Fetch(GetActiveSource().Input)
    nodes = property_widget("ActiveNodes", QtWidgets.QTableView).model()

    def chosen():
        values = [nodes.data(nodes.index(row, 0)) for row in range(nodes.rowCount())]
        return [int(value) for value in values]

    def told():
        return window.findChild(QtWidgets.QLabel, "pickMessage").text()

    button = property_widget("ActiveNodes", QtWidgets.QPushButton)
    button.click()
    before = list(view.CameraPosition), list(view.CameraFocalPoint)
    # The point is in the middle of what is seen.
    place, centre = body.GetPoint(107), body.GetCenter()
    view.CameraFocalPoint = place
    view.CameraPosition = [p + 6 * (p - c) for p, c in zip(place, centre)]
    Render()
    wait(0.3)
    towards = list(view.CameraPosition)
    end = drag(pixel_of(view, place), QtCore.QPoint(5, 0), 4)
    send(Event.MouseButtonRelease, end, buttons=Button.NoButton)
    wait(0.3)
    assert list(view.CameraPosition) != towards and chosen() == [], chosen()
    click(pixel_of(view, place))
    assert chosen() == [107], chosen()
    other = pixel_of(view, place) + QtCore.QPoint(15, 8)
    click(other)
    assert len(chosen()) == 2 and chosen()[0] == 107, (chosen(), told())
    wait(0.3)
    window.grab().save("picked.png")
    click(other)
    assert chosen() == [107], chosen()
    button.click()
    view.CameraPosition, view.CameraFocalPoint = before
    Render()


def fill_in_materials():
    """The same material by a table of regions, after others have been chosen in it."""
    choose("RegionType", "Table")
    choose("RegionArray", "Region")
    wait(0.3)
    table = property_widget("Regions", QtWidgets.QTableWidget)
    buttons = {button.text(): button
               for button in table.parent().findChildren(QtWidgets.QPushButton)}
    buttons["Values of the Body"].click()
    buttons["Add"].click()
    assert table.rowCount() == 2, table.rowCount()
    buttons["Remove"].click()
    law = table.cellWidget(0, 1)
    law.setCurrentText("Ogden")
    assert "OgdenExponent1 2" in table.item(0, 2).text(), table.item(0, 2).text()
    law.setCurrentText("Neo-Hookean")
    table.item(0, 2).setText("YoungsModulus 5000 PoissonsRatio 0.45")
    wait(0.2)
    window.grab().save("materials.png")
    apply()
    material = GetActiveSource()
    expected = ["0", "Neo-Hookean", "YoungsModulus 5000 PoissonsRatio 0.45"]
    assert list(material.Regions) == expected, list(material.Regions)
    modulus = material.GetCellDataInformation()["YoungsModulus"].GetRange()
    assert modulus == (5000, 5000), modulus


def estimate_with(*words):
    """Waits until the panel's estimate has them, before anything is applied."""
    def text():
        return property_widget("UpdateEstimate", QtWidgets.QLabel).text()
    wait_until(lambda: all(word in text() for word in words), text)


def road():
    """From a surface to touching it, as the quick start says, by menus, panels and the mouse."""
    open_file(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples", "liver", "liver.vtp"))
    apply()
    menu("Filters", "Palpate", "Tetrahedralize Surface")
    choose("ElementOrder", "Quadratic")
    estimate_with("tetrahedra")
    write("MaximumVolume", "1e-16")
    estimate_with("MaximumVolume", "more than 2e+07 tetrahedra")
    write("MaximumVolume", "0")
    property_widget("PreserveSurface", QtWidgets.QCheckBox).click()
    estimate_with("About 1\u00a0500 tetrahedra")
    apply()
    menu("Filters", "Palpate", "Assign Material")
    choose("Law", "Neo-Hookean")
    write("YoungsModulus", "5000")
    apply()
    fill_in_materials()
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
    pick_nodes()
    estimate_with("About 340 configurations")
    write("HalfWidth", "0.004")
    write("Resolution", "3")
    estimate_with("About 27 configurations")
    write("FileName", os.path.abspath("road.palpate"))
    apply()
    view = GetActiveView()
    SaveScreenshot("road.png", view, ImageResolution=[320, 240])
    click_start("Mouse")
    wait(0.3)
    node = pixel_of_node(view, touch_filter())
    end = drag(node, QtCore.QPoint(4, -4), 5)
    wait_for(lambda: touches() and number("force") > 0.05, "the liver is felt")
    assert number("place") == 107
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
    wait_for(lambda: "inside the space" in part("place").text(), "the whole space is touched")
    space.HalfWidth = 0.001
    space.UpdatePipeline()
    wait_for(lambda: "beyond the space" in part("place").text(), "the smaller space is touched")


def ends():
    """Twenty starts and stops, and each thing that may go while it runs."""
    space, view = open_space()

    def run():
        click_start()
        wait_for(touches, "the hand touches")

    click_start()
    wait(0.2)
    click_stop()
    threads = len(os.listdir("/proc/self/task"))
    for _ in range(20):
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
    Connect(HOST, int(os.environ["PALPATE_INTERACTOR_PORT"]))
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
    Connect(HOST, int(os.environ["PALPATE_INTERACTOR_PORT"]))
    wait(0.5)
    open_space()
    click_start()
    wait_for(touches, "the hand presses")

    # ParaView can do no more than end: 5.11 asks before, 5.13 does not.
    in_dialog(lambda question: question.accept())
    for process in os.environ["PALPATE_INTERACTOR_SERVER"].split():
        os.kill(int(process), signal.SIGKILL)
    wait(20)
    print("not lost", flush=True)


def goes_on(leave):
    """Starts, and leaves it running."""
    open_space()
    click_start()
    wait_for(touches, "the hand touches")
    print("left 1", flush=True)
    leave()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, lambda: run_in_turn(
    {"touching": touching, "dots": dots, "escape": escape, "busy": busy, "mouse": mouse,
     "tears": tears, "blade": blade, "cuts": cuts, "cuts_pressed": cuts_pressed, "road": road,
     "ends": ends, "remote": remote, "lost": lost,
     "quit": lambda: goes_on(application.quit), "close": lambda: goes_on(window.close)}))

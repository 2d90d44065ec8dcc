# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, presses a block with a rigid sphere as PALPATE_INTERACTOR_RUN
says, and quits; test_press.py reads what it prints. What a person clicks is clicked."""

import os
import sys
import time

from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from dock_support import (click_start, click_stop, number, presses, run_in_turn, said,
                          touch_filter, touches, unfold, wait_for)
from qt import (Button, Event, Modifier, QtCore, QTest, QtWidgets, application, canvas, drag, part,
                pixel_of, property_widget, send, turn_wheel, wait, window)

# The block is held at x = 0; its top is at z = 0.05.
MIDDLE = [0.07, 0.03, 0.05]
BEHIND = [-0.1, 0.03, -0.4]
# Of the bottom, which the space does not reach, and seen from there.
BELOW = [0.07, 0.03, 0]
IMAGE = [600, 450]


def is_free():
    return part("state").text().endswith(", free")


def look_from(view, place):
    view.CameraPosition = place
    view.CameraFocalPoint = [0.05, 0.03, 0.025]
    view.CameraViewUp = [0, 1, 0]
    Render()
    wait(0.2)


def open_space(name="whole.palpate"):
    space = OpenDataFile(os.path.abspath(name))
    view = GetActiveViewOrCreate("RenderView")
    Show(space, view)
    look_from(view, [0.12, 0.08, 0.35])
    view.OrientationAxesVisibility = 0
    return space, view


def hover(at):
    send(Event.MouseMove, at, Button.NoButton, Button.NoButton)
    wait(0.2)


def let_go(at):
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
    wait_for(is_free, "the tool leaves the body")


def hold_ctrl(kind):
    """Ctrl goes down, or up."""
    (QTest.keyPress if kind == "down" else QTest.keyRelease)(canvas(), QtCore.Qt.Key.Key_Control)
    wait(0.1)


def place():
    return list(touch_filter().ToolPosition)


def press():
    """With the mouse in a window of two sizes: the tool hovers, presses, goes deeper, glides, and
    leaves the body as it was."""
    _, view = open_space()
    # Where frames are late the dock leaves this out by itself: the pictures that are compared are
    # plain from the start.
    view.UseFXAA = 0
    click_start("Mouse")
    wait_for(lambda: "drag" in said(view), "it says what to do")
    SetActiveSource(touch_filter())
    wait(0.3)
    # This space has both: what it is of is shown.
    for name in ("ToolPosition", "ActiveNode"):
        property_widget(name, QtWidgets.QWidget)
    for size in ((1000, 700), (1270, 1010)):
        window.resize(*size)
        wait(0.5)
        Render()
        SaveScreenshot(f"before_{size[0]}.png", view, ImageResolution=IMAGE)
        at = pixel_of(view, MIDDLE)
        before = canvas().grabFramebuffer()
        hover(at)
        assert is_free(), part("state").text()
        wait(0.2)
        hovering = canvas().grabFramebuffer()
        assert hovering != before, "the tool is not seen"
        send(Event.MouseButtonPress, at)
        wait_for(presses, "the press is felt")
        assert "Press" not in said(view), said(view)
        wait_for(lambda: "mm left" in part("place").text(), "it says how deep it can go")
        wait(0.3)
        first = number("force")
        turn_wheel(at, 4)
        wait_for(lambda: number("force") > 1.2 * first, "the wheel presses deeper")
        turn_wheel(at, -4)
        wait(0.3)
        window.grab().save(f"pressed_{size[0]}.png")
        pressed = place()
        for i in range(1, 26, 3):
            send(Event.MouseMove, at + QtCore.QPoint(i, 0), Button.NoButton)
            wait(0.02)
        wait(0.3)
        assert presses(), part("state").text()
        glided = sum((a - b) ** 2 for a, b in zip(place(), pressed)) ** 0.5
        SaveScreenshot(f"glided_{size[0]}.png", view, ImageResolution=IMAGE)
        let_go(at + QtCore.QPoint(25, 0))
        hover(QtCore.QPoint(3, 3))
        wait(0.3)
        SaveScreenshot(f"rest_{size[0]}.png", view, ImageResolution=IMAGE)
        print(f"size_{size[0]}", first, glided)
    click_stop()


def colour_at(at):
    return canvas().grabFramebuffer().pixelColor(at).getRgb()[:3]


def looks():
    """On a dark and a light background the body at rest has the colour of tissue, and the legend
    and the numbers beside the tool are seen; one box gives ParaView's colours; nothing of the dock
    is cut off in a narrow window."""
    _, view = open_space()
    view.UseColorPaletteForBackground = 0
    for shade in (0.1, 1):
        view.Background = 3 * [shade]
        Render()
        click_start("Mouse")
        wait(0.5)
        at = pixel_of(view, MIDDLE)
        red, green, blue = colour_at(at)
        assert red > 120 and red > green > blue, (shade, red, green, blue)
        legend = GetScalarBar(GetColorTransferFunction("ContactPressure"), view)
        for letters in (legend.TitleColor, legend.LabelColor):
            assert max(letters) < 0.2, letters
        assert legend.DrawBackground and min(legend.BackgroundColor) > 0.8, legend.BackgroundColor
        assert legend.Title == "Pressure (Pa)"
        hover(at)
        send(Event.MouseButtonPress, at)
        wait_for(presses, "the press is felt")
        wait_for(lambda: " mm deep" in said(view) and " N" in said(view), "it is told")
        assert part("depth").text().endswith(" mm deep"), part("depth").text()
        window.grab().save(f"looks_{shade}.png")
        let_go(at)
        wait_for(lambda: " mm deep" not in said(view), "it is told no more")
        click_stop()
    # A person's colours stay, until the box is changed.
    colours = GetColorTransferFunction("ContactPressure")
    colours.RGBPoints = [0, 0, 1, 0, 1000, 0, 0.5, 0]
    click_start("Mouse")
    wait(0.5)
    red, green, blue = colour_at(pixel_of(view, MIDDLE))
    assert green > max(red, blue), (red, green, blue)
    part("inTissue").click()
    wait(0.5)
    red, green, blue = colour_at(pixel_of(view, MIDDLE))
    assert blue > max(red, green), (red, green, blue)
    part("inTissue").click()
    wait(0.5)
    red, green, blue = colour_at(pixel_of(view, MIDDLE))
    assert red > green > blue, (red, green, blue)
    click_stop()
    window.resize(1050, 700)
    for name in ("settings", "recording", "pace"):
        assert not part(name).isVisible()
        unfold(name)
    wait(0.5)
    window.grab().save("unfolded.png")
    assert part("content").minimumSizeHint().width() <= part("area").viewport().width()
    print("looks 1")


def rub():
    """Friction holds the tool back, and only as long as it is set."""
    _, view = open_space()
    click_start("Mouse")
    at = pixel_of(view, MIDDLE)

    def glide():
        hover(at)
        send(Event.MouseButtonPress, at)
        wait_for(presses, "it presses")
        wait(0.3)
        pressed = number("force")
        for i in range(4, 41, 4):
            send(Event.MouseMove, at + QtCore.QPoint(i, 0), Button.NoButton)
            wait(0.02)
        wait(0.3)
        felt = number("force")
        let_go(at + QtCore.QPoint(40, 0))
        return felt / pressed

    free = glide()
    part("friction").setValue(1)
    rubbed = glide()
    part("friction").setValue(0)
    print("rubbed", free, rubbed, glide())
    click_stop()


def grasp():
    """Ctrl takes hold of the node that is near, pulls it, and lets go."""
    space, view = open_space()
    click_start("Mouse")
    corner = [0.1, 0.06, 0.05]
    near = pixel_of(view, [0.094, 0.054, 0.05])
    hover(near)
    send(Event.MouseButtonPress, near)
    wait_for(presses, "it presses")
    hold_ctrl("down")
    wait_for(touches, f"the node at {corner} is held")
    assert "node" in part("place").text(), part("place").text()
    for i in range(3, 31, 3):
        send(Event.MouseMove, near + QtCore.QPoint(i, -i), Button.NoButton,
             modifiers=Modifier.ControlModifier)
        wait(0.02)
    wait(0.3)
    assert touches() and "node" in part("place").text(), part("state").text()
    # The colour of the surface stays.
    assert touch_filter().PointData["ContactPressure"].GetRange() == (0, 0)
    pulled = max(abs(c) for c in touch_filter().Displacement)
    window.grab().save("grasped.png")
    hold_ctrl("up")
    wait_for(lambda: not touches(), "it lets go")
    let_go(near)
    # Far from any node there is nothing to hold.
    at = pixel_of(view, [0.05, 0.03, 0.05])
    hover(at)
    send(Event.MouseButtonPress, at)
    wait_for(presses, "it presses")
    hold_ctrl("down")
    wait_for(lambda: "nothing to hold" in said(view), "it says so")
    assert presses()
    hold_ctrl("up")
    let_go(at)
    print("pulled", pulled)
    click_stop()


def edge():
    """Where the space ends, beside the body and on its far side."""
    _, view = open_space()
    click_start("Mouse")
    at = pixel_of(view, MIDDLE)
    hover(at)
    send(Event.MouseButtonPress, at)
    wait_for(presses, "it presses")
    # Off the body the tool stays where it was last seen.
    for i in range(1, 16):
        send(Event.MouseMove, at + QtCore.QPoint(32 * i, 0), Button.NoButton)
        wait(0.01)
    wait(0.3)
    assert presses() or "space ends" in said(view), (part("state").text(), said(view))
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
    wait_for(is_free, "it leaves")
    # Towards the end that is held the space is over.
    hover(at)
    send(Event.MouseButtonPress, at)
    wait_for(presses, "it presses anew")
    towards = pixel_of(view, [0.002, 0.03, 0.05])
    for i in range(1, 21):
        send(Event.MouseMove, at + (towards - at) * i / 20, Button.NoButton)
        wait(0.02)
    wait_for(lambda: "space ends" in said(view), "it says that the space ends")
    assert number("force") == 0
    send(Event.MouseButtonRelease, towards, buttons=Button.NoButton)
    wait_for(is_free, "it leaves")

    look_from(view, BEHIND)
    below = pixel_of(view, BELOW)
    before = list(view.CameraPosition)
    end = drag(below, QtCore.QPoint(4, 2), 5)
    assert "does not reach" in said(view), said(view)
    send(Event.MouseButtonRelease, end, buttons=Button.NoButton)
    wait(0.1)
    assert list(view.CameraPosition) != before, "the drag moves the camera"
    window.grab().save("veiled.png")
    click_stop()
    print("edge 1")


def grow():
    """A space that grows is touched further, without letting go; twenty starts and stops."""
    space, view = open_space("part.palpate")
    click_start("Mouse")
    at = pixel_of(view, MIDDLE)
    hover(at)
    send(Event.MouseButtonPress, at)
    wait_for(presses, "the part is pressed")
    wait(0.6)
    before = number("force")
    space.FileName = os.path.abspath("whole.palpate")
    space.UpdatePipeline()
    wait(0.6)
    assert presses(), part("state").text()
    assert abs(number("force") - before) < 0.02 * before, (number("force"), before)
    farther = pixel_of(view, [0.035, 0.03, 0.05])
    for i in range(1, 21):
        send(Event.MouseMove, at + (farther - at) * i / 20, Button.NoButton)
        wait(0.02)
    wait(0.3)
    assert presses(), (part("state").text(), said(view))
    print("grown", place()[0])
    let_go(farther)
    click_stop()
    threads = len(os.listdir("/proc/self/task"))
    for _ in range(20):
        click_start("Mouse")
        application.processEvents()
        click_stop()
        application.processEvents()
    print("threads", len(os.listdir("/proc/self/task")) - threads)
    click_start("Simulated hand")
    wait_for(presses, "the simulated hand presses")
    click_stop()


def explore():
    """A space of which nothing is known is explored around the tool while it presses; what was
    found stays in the file, and is there at once the next time."""
    reader = StateSpaceReader(FileName=os.path.abspath("whole.palpate"))
    reader.UpdatePipeline()
    body = MergeBlocks(Input=ExtractBlock(Input=reader, Selectors=["/Root/Body"]))
    space = PrecomputeStateSpace(Input=body, Tool="Sphere", Depth=0.006, Spacing=0.006,
                                 Exploration="Around The Hand", LogInterval=0,
                                 FileName=os.path.abspath("explored.palpate"))
    space.Tool.Radius = 0.01
    view = GetActiveViewOrCreate("RenderView")
    Show(space, view)
    look_from(view, [0.12, 0.08, 0.35])
    begun = number_of_states(space)
    wait_for(lambda: part("space").findText("PrecomputeStateSpace1") >= 0, "it is listed")
    part("space").setCurrentText("PrecomputeStateSpace1")
    at = pixel_of(view, MIDDLE)

    def press_until_felt():
        click_start("Mouse")
        hover(at)
        send(Event.MouseButtonPress, at)
        start = time.monotonic()
        wait_for(lambda: presses() and number("force") > 0.03, "it is felt")
        return time.monotonic() - start

    waited = press_until_felt()
    wait_for(lambda: "inside the space" in part("place").text(), "the cell is complete")
    assert part("explored").isVisible() and " explorers busy" in part("explored").text()
    # The body is seen to be pressed, by the fields that were found meanwhile.
    wait_for(lambda: touch_filter().PointData["ContactPressure"].GetRange()[1] > 0, "the pressure")
    wait(1)  # the tool comes to where it is to press
    window.grab().save("explored.png")
    force = number("force")
    let_go(at)
    click_stop()
    assert not part("explored").isVisible()
    space.UpdatePipeline()
    print("explored", waited, begun, number_of_states(space))
    again = press_until_felt()
    wait(1)
    assert abs(number("force") - force) < 0.02 * force, (number("force"), force)
    let_go(at)
    click_stop()
    print("explored_again", again)


def number_of_states(space):
    block = ExtractBlock(Input=space, Selectors=["/Root/Configurations"])
    block.UpdatePipeline()
    number = block.GetDataInformation().GetNumberOfPoints()
    Delete(block)
    return number


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, lambda: run_in_turn(
    {"press": press, "looks": looks, "rub": rub, "grasp": grasp, "edge": edge, "grow": grow,
     "explore": explore}))

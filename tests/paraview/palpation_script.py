# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, touches what examples/touch opens while it is explored, and quits;
test_palpation.py reads what it prints."""

import os
import sys
import time
import traceback

from paraview.simple import *

SOURCE = os.environ["PALPATE_SOURCE_DIR"]
sys.path += [os.path.join(SOURCE, "tests", "paraview"), os.environ["PALPATE_ORGAN_FOLDER"]]
from dock_support import click_start, click_stop, number, part, wait_for
from qt import Button, Event, QtCore, application, pixel_of, send, wait


def is_felt():
    return part("state").text().endswith(", pressing") and number("force") > 0.01


def source_of(kind):
    found, = (proxy for proxy in GetSources().values() if proxy.GetXMLName() == kind)
    return found


def check_a_change():
    """The organ becomes stiffer in the hand: it is felt as it was until the stiffer one is known
    where the hand is, and there is no moment without a force."""
    wait(0.5)
    before = number("force")
    space, material = source_of("PrecomputeStateSpace"), source_of("AssignMaterial")
    material.YoungsModulus = 2 * material.YoungsModulus
    # The file is that of the organ as it was.
    space.FileName = space.FileName.replace("space.palpate", "stiffer.palpate")
    space.UpdatePipeline()
    least = before

    def is_stiffer():
        nonlocal least
        least = min(least, number("force"))
        return number("force") > 1.5 * before

    wait_for(is_stiffer, "the stiffer organ is felt")
    assert least > 0.5 * before and is_felt(), (least, before)
    print("stiffer", number("force") / before)

    # A deeper space, in the same file.
    wait(0.5)
    before = number("force")
    space.Depth = 1.1 * space.Depth
    space.UpdatePipeline()
    wait(1.5)
    assert is_felt() and abs(number("force") / before - 1) < 0.05, (number("force"), before)


def main():
    # As the window does with a script: without its __file__.
    with open(os.path.join(SOURCE, "examples", "common", "touch.py"), encoding="utf-8") as script:
        exec(script.read(), {"__name__": "__main__"})
    view = GetActiveView()
    at = pixel_of(view, view.CameraFocalPoint)
    click_start("Mouse")
    begin = time.monotonic()
    send(Event.MouseMove, at, Button.NoButton, Button.NoButton)
    send(Event.MouseButtonPress, at)
    wait_for(is_felt, "the middle of the view is pressed")
    print("seconds", time.monotonic() - begin)
    wait(0.5)
    middle = number("force")
    # It glides to where nothing is known yet.
    for i in range(1, 41):
        send(Event.MouseMove, at + QtCore.QPoint(2 * i, 0), Button.NoButton)
        wait(0.02)
    wait_for(is_felt, "it is felt there")
    wait_for(lambda: "inside the space" in part("place").text(), "the cell there is complete")
    print("force", middle, number("force"))
    if source_of("AssignMaterial").RegionType != "Table":  # of one tissue
        check_a_change()
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
    click_stop()


def run():
    try:
        main()
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, run)

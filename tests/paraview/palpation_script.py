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

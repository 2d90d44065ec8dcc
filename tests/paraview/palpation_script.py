# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, touches what examples/touch hands out while it grows, and quits;
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
LATER = 2  # s


def presses():
    return part("state").text().endswith(", pressing")


def num_found():
    return FindSource("Organ").GetDataInformation().GetNumberOfPoints()


def main():
    begin = time.monotonic()
    # As the window does with a script: without its __file__.
    with open(os.path.join(SOURCE, "examples", "common", "touch.py"), encoding="utf-8") as script:
        exec(script.read(), {"__name__": "__main__"})
    view = GetActiveView()
    click_start("Mouse")
    at = pixel_of(view, view.CameraFocalPoint)
    send(Event.MouseMove, at, Button.NoButton, Button.NoButton)

    def is_pressed():
        """As a person does where the body is still grey: once more, some time later. While the
        button is held the view does not take in what was found."""
        send(Event.MouseButtonPress, at)
        wait(0.5)
        if not presses():
            send(Event.MouseButtonRelease, at, buttons=Button.NoButton)
            wait(LATER)
        return presses()

    wait_for(is_pressed, "the middle of the view is pressed")
    print("seconds", time.monotonic() - begin)
    found = num_found()
    wait_for(lambda: num_found() > found, "it grows")
    assert presses(), part("state").text()
    print("grown", found, num_found())
    print("force", number("force"))
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

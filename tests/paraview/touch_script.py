# SPDX-License-Identifier: BSD-3-Clause
"""Inside the window of examples/touch: no dialog stands before it, the example's liver can be
touched, and gives a force."""

import os
import re
import sys
import traceback

from paraview.simple import LoadState

source = os.environ["PALPATE_SOURCE_DIR"]
LIVER = os.path.join(source, "examples", "liver")
sys.path.append(os.path.join(source, "tests", "paraview"))
from qt import QtCore, dialogs, dock, part, wait, wait_until


WELCOME = 1.0  # s after the window is there


def main():
    wait(2 * WELCOME)
    assert not dialogs(), dialogs()
    LoadState(os.path.join(LIVER, "liver.pvsm"), data_directory=LIVER)
    wait_until(lambda: part("space").count() == 1, "a state space")
    assert dock.isVisible()
    part("device").setCurrentText("Simulated hand")
    part("start").click()
    wait_until(lambda: part("state").text() == "running, touching" and
               float(re.match(r"[\d.]+", part("force").text())[0]) > 0.1, "a force")
    part("start").click()


def run():
    try:
        main()
    except BaseException:
        traceback.print_exc()
        os._exit(1)
    os._exit(0)


QtCore.QTimer.singleShot(0, run)

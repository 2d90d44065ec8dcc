# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, says whether both plugins are there, and quits; test_register.py
reads what it prints."""

import os
import sys
import traceback

from paraview import simple

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from qt import QtCore, application, dock


def main():
    try:
        print("dock", int(dock is not None))
        print("filter", int(hasattr(simple, "PrecomputeStateSpace")))
    except BaseException:
        traceback.print_exc()
    application.quit()


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, main)

# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window and quits; test_gui.py reads what it prints."""

import os
import sys
import time

from paraview.simple import *

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from qt import QtCore, QtWidgets, application, window

HELP_SECONDS = 10  # in which the Help window has its contents


def wait_for_pages(contents):
    """The pages under the heading Palpate in the contents of the Help window."""
    end = time.monotonic() + HELP_SECONDS
    while time.monotonic() < end:
        application.processEvents(QtCore.QEventLoop.ProcessEventsFlag.AllEvents, 50)
        model = contents.model()
        for row in range(model.rowCount()):
            index = model.index(row, 0)
            if index.data() == "Palpate":
                return model.rowCount(index)
    return 0


if os.environ["PALPATE_GUI_HELP"] == "1":
    window.findChild(QtCore.QObject, "actionHelp").trigger()
    help_window = next(w for w in application.topLevelWidgets()
                       if w.metaObject().className() == "pqHelpWindow")
    print("state: pages", wait_for_pages(help_window.findChild(QtWidgets.QTreeView)), flush=True)
    help_window.close()

liver = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples", "liver")
LoadState(os.path.join(liver, "liver.pvsm"), data_directory=liver)
SaveScreenshot("gui.png", GetActiveView(), ImageResolution=[800, 600])
touch = FindSource("Touch State Space")
print("state: points", touch.GetDataInformation().GetNumberOfPoints(), flush=True)
print("state: force", touch.FieldData["Force"].GetRange(-1)[1], flush=True)

picture = GetActiveView()
report = AccuracyReport(Input=touch.Input, TestPoints=20)
table = CreateView("SpreadSheetView")
AssignViewToLayout(view=table)
Show(report, table)
Render(table)
print("state: report", report.GetDataInformation().GetNumberOfRows(), flush=True)
HideAll(picture)
points = Show(OutputPort(report, 1), picture)
points.PointSize = 12
ColorBy(points, ("POINTS", "Error (Energy Hermite)"))
ResetCamera(picture)
SaveScreenshot("report.png", picture, ImageResolution=[800, 600])

# In the loop of events, which has not begun.
QtCore.QTimer.singleShot(300, application.quit)

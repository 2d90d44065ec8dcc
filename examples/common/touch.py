# SPDX-License-Identifier: BSD-3-Clause
"""Makes the body of an organ.py in ParaView's window, to be touched while its space is explored
around the hand.

Sample run, with both plugins loaded (PV_PLUGIN_PATH), the folder of an organ.py first in
PYTHONPATH, and a folder for the space; examples/touch does it:
    PYTHONPATH=../palpation PALPATE_SPACE_FOLDER=folder paraview --script=touch.py
"""
import os

from paraview.simple import *

# ParaView's window does not tell a script where it lies.
from organ import FRONT, OUT, PRESSED, UP, make_scene

AWAY = 0.35  # of OUT, from the eye to the middle of the view
# Of the largest force: where the hand slows down, cells are halved until the force is as exact.
TOLERANCE = 0.02

view = GetActiveViewOrCreate("RenderView")
scene = make_scene(*os.environ.get("PALPATE_ORGAN_ARGUMENTS", "").split())
# Cells as deep as the tool presses: the fewer there are under the hand, the sooner they are known.
pressed = dict(PRESSED, Spacing=max(PRESSED["Spacing"], PRESSED["Depth"]))
space = PrecomputeStateSpace(registrationName="Organ", Input=scene, Tool="Sphere", BeginAt=FRONT,
                             Exploration="Around The Hand", Tolerance=TOLERANCE,
                             FileName=os.path.join(os.environ["PALPATE_SPACE_FOLDER"],
                                                   "space.palpate"), **pressed)
Show(space, view)
Render(view)  # The first time it moves the camera.
view.CameraFocalPoint, view.CameraViewUp = FRONT, UP
view.CameraPosition = [place + AWAY * out for place, out in zip(FRONT, OUT)]
Render(view)

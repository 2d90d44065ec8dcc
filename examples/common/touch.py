# SPDX-License-Identifier: BSD-3-Clause
"""Shows in ParaView's window the state space that grow.py hands out, while it grows.

Sample run, with the folder of an organ.py first in PYTHONPATH; examples/touch does it, with grow.py
beside it. The folder that is named is that of grow.py, which has handed out something:
    PYTHONPATH=../palpation PALPATE_SPACE_FOLDER=folder paraview --script=touch.py
"""
import os

from paraview.simple import *

# ParaView's window does not tell a script where it lies.
from organ import FRONT, OUT, UP

AWAY = 0.35  # of OUT, from the eye to the middle of the view

view = GetActiveViewOrCreate("RenderView")
space = StateSpaceReader(registrationName="Organ",
                         FileName=os.path.join(os.environ["PALPATE_SPACE_FOLDER"], "space.palpate"))
Show(space, view)
Render(view)  # The first time it moves the camera.
view.CameraFocalPoint, view.CameraViewUp = FRONT, UP
view.CameraPosition = [place + AWAY * out for place, out in zip(FRONT, OUT)]
Render(view)

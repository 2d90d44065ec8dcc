# SPDX-License-Identifier: BSD-3-Clause
"""Computes the state space of a liver that is pressed with a sphere, and hands it out as it grows.

Sample run, with the plugin loaded (PV_PLUGIN_PATH); the argument is a folder, which is there:
    mpiexec -n 2 pvbatch grow.py folder

What was found so far is folder/liver.palpate, which another one takes the place of each time.
touch.py shows it in ParaView's window.
"""
import os
import shutil
import sys
import time

from paraview.simple import *

from organ import FRONT, make_scene

sys.path.append(os.path.join(sys.path[0], "..", "liver"))
from pipeline import update

# Until it is handed out for the first time, and then, s. The view stands still while it is taken
# in, and that takes longer as the space becomes larger: so it is at least a share of the time so
# far.
FIRST, LATER, SHARE = 2, 5, 0.2


def hand_out(file, name):
    """Whole or not at all: it has its name last."""
    shutil.copyfile(file, name + ".part")
    os.replace(name + ".part", name)


def main(folder):
    start = time.monotonic()
    space = PrecomputeStateSpace(Input=make_scene(), Tool="Sphere", ToolRadius=0.01, Depth=0.008,
                                 Spacing=0.005, BeginAt=FRONT,
                                 FileName=os.path.join(folder, "growing.palpate"))
    space.UpdateInterval = FIRST
    complete = False
    while not complete:
        update(space)
        complete = space.FieldData["Complete"].GetRange(0)[0] == 1
        hand_out(space.FileName, os.path.join(folder, "liver.palpate"))
        space.UpdateInterval = LATER + SHARE * (time.monotonic() - start)


main(*sys.argv[1:])

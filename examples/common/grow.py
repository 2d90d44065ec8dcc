# SPDX-License-Identifier: BSD-3-Clause
"""Computes the state space of an organ that is pressed with a sphere, and hands it out as it grows.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH); the arguments are a folder with an organ.py,
one for the space, which is there, and what the organ's make_scene() takes:
    mpiexec -n 2 pvbatch grow.py ../palpation folder
    mpiexec -n 2 pvbatch grow.py ../nodule folder 3
    mpiexec -n 2 pvbatch grow.py ../brain folder

What was found so far is folder/space.palpate, which another one takes the place of each time.
touch.py shows it in ParaView's window.
"""
import os
import shutil
import sys
import time

from paraview.simple import *

sys.path[:0] = [sys.argv[1], os.path.join(sys.path[0], "..", "liver")]
from organ import FRONT, PRESSED, make_scene
from pipeline import update

# Until it is handed out for the first time, and then, s. The view stands still while it is taken
# in, and that takes longer as the space becomes larger: so it is at least a share of the time so
# far.
FIRST, LATER, SHARE = 2, 5, 0.2


def hand_out(file, name):
    """Whole or not at all: it has its name last."""
    shutil.copyfile(file, name + ".part")
    os.replace(name + ".part", name)


def main(folder, *of_scene):
    start = time.monotonic()
    space = PrecomputeStateSpace(Input=make_scene(*of_scene), Tool="Sphere", BeginAt=FRONT,
                                 FileName=os.path.join(folder, "growing.palpate"), **PRESSED)
    space.UpdateInterval = FIRST
    complete = False
    while not complete:
        update(space)
        complete = space.FieldData["Complete"].GetRange(0)[0] == 1
        hand_out(space.FileName, os.path.join(folder, "space.palpate"))
        space.UpdateInterval = LATER + SHARE * (time.monotonic() - start)


main(*sys.argv[2:])

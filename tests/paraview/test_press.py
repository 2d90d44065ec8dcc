# SPDX-License-Identifier: BSD-3-Clause
"""A rigid sphere in ParaView's window, with the mouse: it hovers, presses, glides, rubs, grasps,
and says where it cannot; its space grows meanwhile.

  test_press.py <palpate_test_make_space> <folder of the plugin PalpateInteractor>
"""

import shutil
import subprocess
import sys

from image_support import share_different
from support import SKIPPED
from test_interactor import run


def main():
    make_space, folder = sys.argv[1:]
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    for extent in ("whole", "part"):
        subprocess.run([make_space, f"{extent}.palpate", extent], check=True,
                       stdout=subprocess.DEVNULL)

    # What depends on how large the window is comes first.
    found = run("press,rub,grasp,edge,grow,explore,looks", folder, script="press_script.py")
    for size in ("size_1000", "size_1270"):
        force, glided = found[size]
        assert 0.02 < force < 3 and glided > 0.004, (size, found)
    assert share_different("rest_1000.png", "glided_1000.png") > 0.005
    # The first of them says what to do before.
    assert share_different("before_1270.png", "rest_1270.png") == 0

    free, rubbed, again = found["rubbed"]
    # Coulomb's law at a coefficient of 1: √2 times as much, on a surface that is not quite flat.
    assert 1.2 < rubbed / free < 1.6 and abs(again - free) < 0.05, (free, rubbed, again)

    assert found["looks"] == [1]
    assert found["pulled"][0] > 0.001
    assert found["edge"] == [1]
    waited, begun, states = found["explored"]
    assert waited < 20 and begun <= 2 and states > 8, found
    assert found["explored_again"][0] < waited + 3, found
    assert found["grown"][0] < 0.045 and found["threads"][0] <= 0, found


if __name__ == "__main__":
    main()

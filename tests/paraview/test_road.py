# SPDX-License-Identifier: BSD-3-Clause
"""The quick start: in ParaView's window from a surface to touching it, by menus, panels and the
mouse.

  test_road.py <folder of the plugin PalpateInteractor>
"""

import shutil
import sys

from image_support import compare_with_baseline, share_different
from support import SKIPPED
from test_interactor import run

if shutil.which("paraview") is None:
    sys.exit(SKIPPED)
road = run("road", sys.argv[1])
assert 0.05 < road["felt"][0] < 5, road
for name in ("road", "road_rest"):
    compare_with_baseline(name)
assert share_different("road_rest.png", "road_touched.png") > 0.01

# SPDX-License-Identifier: BSD-3-Clause
"""The plugin in ParaView's window: the example's state loads and is drawn, and so is its report.
The Help window has the pages.

Argument: 1 where the plugin has pages for the Help window, else 0
"""

import os
import shutil
import subprocess
import sys

from image_support import share_drawn
from support import SKIPPED

HERE = os.path.dirname(os.path.abspath(__file__))
TIME_OUT = 400  # s; a dialog that nobody answers would last for ever


paraview = shutil.which("paraview")
if paraview is None:
    sys.exit(SKIPPED)
command = [paraview, "--disable-registry", "--script", os.path.join(HERE, "gui_script.py")]
run = subprocess.run(command, env={**os.environ, "PALPATE_GUI_HELP": sys.argv[1]},
                     stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                     errors="replace", timeout=TIME_OUT, check=False)
print(run.stdout)
assert run.returncode == 0, run.returncode
lines = run.stdout.splitlines()
assert not any("ERR|" in line or "Traceback" in line for line in lines)

values = {key: float(value) for key, value in
          (line[len("state: "):].split() for line in lines if line.startswith("state: "))}
assert values["points"] > 500, values
assert 0.1 < values["force"] < 100, values
assert 0.1 < share_drawn("gui.png") < 0.7, share_drawn("gui.png")
assert values["report"] > 10, values
assert sys.argv[1] == "0" or values["pages"] > 15, values
assert 0.001 < share_drawn("report.png") < 0.2, share_drawn("report.png")

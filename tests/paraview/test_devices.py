# SPDX-License-Identifier: BSD-3-Clause
"""Two haptic devices on a reduced body in ParaView's window, one without a button: what they are
sent where forces are wanted only while a button is held, when a frame fails, and when the window
crashes without ending.

  test_devices.py <folder of the plugin PalpateInteractor> <palpate_test_make_space>
                  <the library of fake_hid.cpp> <that of thrower.cpp>
"""

import os
import shutil
import subprocess
import sys
import time

import numpy
from support import SKIPPED
from test_interactor import HERE, TIME_OUT, run

REPORT = 10  # bytes; the force is in those from 3 to 8


def expect_rest_after_crash(folder, environment):
    environment = dict(os.environ, PALPATE_INTERACTOR_RUN="crash", **environment)
    environment["PV_PLUGIN_PATH"] += os.pathsep + folder
    command = ["paraview", "--disable-registry", "--script",
               os.path.join(HERE, "devices_script.py")]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          errors="replace", env=environment) as window:
        try:
            for line in window.stdout:
                print(line, end="", flush=True)
                if line.startswith("reports"):
                    break
            # Long enough for a loop that goes on to send hundreds.
            time.sleep(1)
            assert window.poll() is None, "the program has not ended"
            path = os.path.join(environment["PALPATE_FAKE_HID"], "plain.sent")
            sizes = []
            for _ in range(2):
                sizes.append(os.path.getsize(path) // REPORT)
                time.sleep(0.5)
            sent = numpy.fromfile(path, dtype=numpy.uint8)[:sizes[1] * REPORT].reshape(-1, REPORT)
            assert sizes[1] > sizes[0] + 50, "its loop lives"
            assert (sent[:sizes[0], 3:9] != 0).any(), "there was a force"
            assert not (sent[sizes[0]:, 3:9] != 0).any(), "and there is none any more"
        finally:
            window.kill()
            window.wait(timeout=TIME_OUT)


def main():
    folder, make_space, library, thrower = sys.argv[1:]
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    subprocess.run([make_space, "block.palpate"], check=True, stdout=subprocess.DEVNULL)
    environment = {"LD_PRELOAD": library, "PALPATE_FAKE_HID": os.path.abspath("devices"),
                   "PALPATE_THROWER": thrower}
    os.mkdir("devices")
    figures = run("dead_man,failing", folder, script="devices_script.py", **environment)
    assert figures["dead_man"] == figures["failing"] == [1], figures
    shutil.rmtree("devices")
    os.mkdir("devices")
    expect_rest_after_crash(folder, environment)


if __name__ == "__main__":
    main()

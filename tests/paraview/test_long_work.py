# SPDX-License-Identifier: BSD-3-Clause
"""Long work in ParaView's window: the bar says how far it is, its button aborts, and a space is
seen and touched while it grows; it grows on a server with two ranks, too.

  test_long_work.py <palpate_test_make_space> <folder of the plugin PalpateInteractor> <server>…

where <server> is the command that starts pvserver.
"""

import shutil
import subprocess
import sys

from image_support import share_different
from support import SKIPPED
from test_interactor import run, served

SCRIPT = "long_work_script.py"


def expect_growth(figures):
    assert figures["counts"] == sorted(set(figures["counts"])), figures
    assert figures["counts"][-1] < figures["found"][0] == 7 ** 3, figures
    assert figures["complete"] == [1], figures


def main():
    make_space, folder, *server = sys.argv[1:]
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    subprocess.run([make_space, "block.palpate"], check=True, stdout=subprocess.DEVNULL)

    here = run("here", folder, script=SCRIPT)
    assert here["texts"][0] >= 3, here
    assert here["escaped"] == [1], here
    assert here["closed"] == [0] and here["enabled"] == [0, 1, 0], here
    found, expected, complete = here["aborted"]
    assert 1 < found < expected and complete == 0 and here["touched"][0] >= 1, here
    assert here["heard"] == [1], here
    assert share_different("empty.png", "partial.png") > 0.001
    expect_growth(here)

    with served(server) as running:
        remote = run("remote", folder, running, SCRIPT)
    expect_growth(remote)
    assert remote["ranks"] == [server.count("-n") + 1], remote


if __name__ == "__main__":
    main()

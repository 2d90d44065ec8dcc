# SPDX-License-Identifier: BSD-3-Clause
"""Long work in ParaView's window: the bar says how far it is, its button aborts, and a space is seen
and touched while it grows; it grows on a server with two ranks, too.

  test_long_work.py <palpate_test_make_space> <folder of the plugin PalpateInteractor> <server>…

where <server> is the command that starts pvserver.
"""

import shutil
import subprocess
import sys

from support import SKIPPED
from test_interactor import pixels, run, served

SCRIPT = "long_work_script.py"


def main():
    make_space, folder, *server = sys.argv[1:]
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    subprocess.run([make_space, "block.palpate"], check=True, stdout=subprocess.DEVNULL)

    aborting = run("aborting", folder, script=SCRIPT)
    assert aborting["texts"][0] >= 3, aborting
    assert aborting["closed"] == [0] and aborting["enabled"] == [0, 1, 0], aborting
    assert 10 < aborting["found"][0] < aborting["found"][1], aborting
    assert aborting["complete"] == [0] and aborting["touched"][0] >= 1, aborting
    assert (pixels("partial.png").min(axis=1) < 240).mean() > 0.01

    growing = run("growing", folder, script=SCRIPT)
    assert len(growing["counts"]) >= 3 and growing["counts"][-1] == 15 ** 3, growing
    assert growing["frames"][0] > 0, growing

    with served(server) as port:
        remote = run("remote", folder, port, SCRIPT)
    assert len(remote["counts"]) >= 3 and remote["counts"][-1] == 15 ** 3, remote
    assert remote["ranks"] == [server.count("-n") + 1], remote


if __name__ == "__main__":
    main()

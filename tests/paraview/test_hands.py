# SPDX-License-Identifier: BSD-3-Clause
"""A reduced body in ParaView's window that two tools move, one with the mouse and one with the
simulated hand: both are felt, the body moves between them, and what becomes of one is none of the
other's. On a server, too.

  test_hands.py <folder of the plugin PalpateInteractor> <server>…

where <server> is the command that starts pvserver.
"""

import shutil
import sys

from image_support import difference, share_different
from support import SKIPPED
from test_interactor import run, served


def main():
    folder, *server = sys.argv[1:]
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)

    alone = run("both,sagging,apart", folder, script="hands_script.py")
    for size in (1000, 1500):
        assert min(alone[f"forces_{size}"]) > 0.02, alone
        assert max(alone[f"forces_{size}"]) < 10, alone
        assert alone[f"between_{size}"][0] > 0.0005, alone
        assert share_different(f"rest_{size}.png", f"touched_{size}.png") > 0.005
    # But for edges, which a window of another size draws a pixel farther.
    assert difference("rest_1000.png", "rest_1500.png") == 0
    # As in test_interactor.py.
    cost, waited, frames = alone["frame"]
    is_quiet = waited < 0.05
    assert frames > 20 if is_quiet else cost < 0.13, alone

    assert 0.02 < alone["sagging"][0] < 10, alone

    # Neither tool stands still while the other one moves the body.
    assert min(alone["free"]) > 0.0005 and alone["threads"][0] <= 0, alone

    with served(server) as running:
        remote = run("remote", folder, running, script="hands_script.py")
    assert min(remote["forces"]) > 0.02 and max(remote["forces"]) < 10, remote
    assert remote["between"][0] > 0.0005 and remote["ended"] == [1], remote
    assert remote["ranks"] == [server.count("-n") + 1], remote


if __name__ == "__main__":
    main()

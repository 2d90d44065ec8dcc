# SPDX-License-Identifier: BSD-3-Clause
"""What examples/touch opens: a liver is pressed in the middle of ParaView's window soon after it is
there, while its space is computed beside it.

  test_palpation.py <folder of the plugin PalpateInteractor> <pvbatch> [<mpiexec>…]
"""

import os
import shutil
import subprocess
import sys
import tempfile
import time

from support import SKIPPED
from test_interactor import run

FIRST = 120  # s; until something is handed out
GROW = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples", "palpation", "grow.py")


def main(folder, *command):
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    pvbatch, *mpiexec = command
    ranks = [*mpiexec, "-n", "2"] if mpiexec else []
    # This process is an MPI program of its own, and mpiexec would take over what it is told of it.
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(("OMPI_", "PMIX_"))}
    with tempfile.TemporaryDirectory() as space:
        with subprocess.Popen([*ranks, pvbatch, GROW, space], env=environment) as growing:
            try:
                end = time.monotonic() + FIRST
                while not os.path.exists(os.path.join(space, "liver.palpate")):
                    assert growing.poll() is None and time.monotonic() < end
                    time.sleep(0.2)
                touched = run("touch", folder, script="palpation_script.py",
                              PALPATE_SPACE_FOLDER=space)
            finally:
                growing.terminate()
    assert 0.01 < touched["force"][0] < 1, touched
    before, after = touched["grown"]
    assert before < after, touched


if __name__ == "__main__":
    main(*sys.argv[1:])

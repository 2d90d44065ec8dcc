# SPDX-License-Identifier: BSD-3-Clause
"""What examples/touch opens: a liver, and one with a nodule, is pressed in the middle of ParaView's
window soon after it is there, while its space is computed beside it.

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
EXAMPLES = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples")


def main(folder, *command):
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    pvbatch, *mpiexec = command
    ranks = [*mpiexec, "-n", "2"] if mpiexec else []
    # This process is an MPI program of its own, and mpiexec would take over what it is told of it.
    environment = {name: value for name, value in os.environ.items()
                   if not name.startswith(("OMPI_", "PMIX_"))}
    for organ in (["palpation"], ["nodule", "3"]):
        check(folder, organ, [*ranks, pvbatch], environment)


def check(folder, organ, command, environment):
    of_organ = os.path.join(EXAMPLES, organ[0])
    with tempfile.TemporaryDirectory() as space:
        # As examples/touch does: the window has precedence.
        grow = ["nice", "-n", "5", *command, os.path.join(EXAMPLES, "common", "grow.py"), of_organ,
                space, *organ[1:]]
        with subprocess.Popen(grow, env=environment) as growing:
            try:
                end = time.monotonic() + FIRST
                while not os.path.exists(os.path.join(space, "space.palpate")):
                    assert growing.poll() is None and time.monotonic() < end
                    time.sleep(0.2)
                touched = run("touch", folder, script="palpation_script.py",
                              PALPATE_SPACE_FOLDER=space, PALPATE_ORGAN_FOLDER=of_organ)
            finally:
                growing.terminate()
    assert 0.01 < touched["force"][0] < 1, (organ, touched)
    before, after = touched["grown"]
    assert before < after, (organ, touched)


if __name__ == "__main__":
    main(*sys.argv[1:])

# SPDX-License-Identifier: BSD-3-Clause
"""What examples/touch opens: a liver, and one with a nodule, is pressed anywhere in ParaView's
window soon after it is there, while its space is explored around the hand.

  test_palpation.py <folder of the plugin PalpateInteractor>
"""

import os
import shutil
import sys
import tempfile

from support import SKIPPED
from test_interactor import run

EXAMPLES = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples")
LATEST = 30  # s; on a busy machine, until there is a force


def main(folder):
    if shutil.which("paraview") is None:
        sys.exit(SKIPPED)
    for organ in (["palpation"], ["nodule", "3"]):
        with tempfile.TemporaryDirectory() as space:
            touched = run("touch", folder, script="palpation_script.py",
                          PALPATE_SPACE_FOLDER=space, PALPATE_ORGAN_ARGUMENTS=" ".join(organ[1:]),
                          PALPATE_ORGAN_FOLDER=os.path.join(EXAMPLES, organ[0]))
        assert touched["seconds"][0] < LATEST, (organ, touched)
        for force in touched["force"]:
            assert 0.01 < force < 1, (organ, touched)


if __name__ == "__main__":
    main(*sys.argv[1:])

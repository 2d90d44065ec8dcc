# SPDX-License-Identifier: BSD-3-Clause
"""For tests of the examples: to run one of them, and what it has left.

Arguments of such a test: pvbatch and, where there is MPI, mpiexec with its options.
"""

import csv
import os
import subprocess
import sys

from image_support import pixels

PVBATCH, MPIEXEC = sys.argv[1], sys.argv[2:]
EXAMPLES = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples")


def environment_of(ranks):
    # This process is an MPI program of its own, and mpiexec would take over what it is told of it.
    return {name: value for name, value in os.environ.items()
            if ranks == 1 or not name.startswith(("OMPI_", "PMIX_"))}


def run(ranks, *arguments, example="liver", script=None):
    launcher = [*MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    path = os.path.join(EXAMPLES, example, (script or example) + ".py")
    return subprocess.run([*launcher, PVBATCH, path, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=500, check=False,
                          env=environment_of(ranks))


def rows_of(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def expect_pictures(folder, *names):
    for name in names:
        drawn = (pixels(os.path.join(folder, name + ".png")).min(axis=1) < 240).mean()
        assert 0.003 < drawn < 0.9, (name, drawn)

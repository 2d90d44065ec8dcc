# SPDX-License-Identifier: BSD-3-Clause
"""examples/online at a reduced size: a slow hand is followed by one explorer, and its force is near
that of solves from outside. What is missing or wrong is one line.

Arguments: pvbatch, and the folder of palpate-follow.
"""

import os
import subprocess
import sys

from examples_support import expect_pictures, rows_of, run

PROGRAMS = sys.argv[2]
SMALL = ["--elements", "150", "--region", "0.012", "--programs", PROGRAMS, "--output", "online"]


def check_a_slow_hand():
    done = run(1, *SMALL, "--speeds", "5", "--seconds", "3", "--explorers", "1", example="online")
    assert done.returncode == 0, done.stderr
    with open("online/table.md", encoding="utf-8") as file:
        text = file.read()
    assert text.strip() in done.stdout, done.stdout
    row, = rows_of("online/table.csv")
    assert float(row["in computed cells (%)"]) > 20, row
    assert 0 < float(row["median error (%)"]) < 10, row
    assert 0 < float(row["state (ms)"]) < 1000, row
    shares = {float(row["cores"]): float(row["in computed cells (%)"])
              for row in rows_of("online/simulated.csv")}
    assert len(shares) == 7 and shares[1024] == max(shares.values()) > 50, shares
    expect_pictures("online", "followed", "error_speed")


def check_what_is_wrong():
    for wrong, message in ((["--programs", "nowhere"], "there is no nowhere/palpate-follow"),
                           (["--speeds", "0"], "must be more than 0")):
        done = run(1, *SMALL, *wrong, example="online")
        assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
        assert done.stderr.startswith("online.py: ") and message in done.stderr, done.stderr
    program = os.path.join(PROGRAMS, "palpate-follow")
    for file in ("nowhere.palpate", "online/scene.vtu"):
        done = subprocess.run([program, file], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True, check=False)
        assert done.returncode != 0 and not done.stdout and file in done.stderr, done.stderr


check_a_slow_hand()
check_what_is_wrong()

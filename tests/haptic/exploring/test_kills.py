# SPDX-License-Identifier: BSD-3-Clause
"""Who touches a body while its space is explored is killed at any instant, twenty times: its
explorers end, what was in the file stays there, and the exploration goes on with it to its end.

  test_kills.py <palpate_test_explore_hand> <palpate-explore>
"""

import os
import random
import subprocess
import sys
import tempfile
import time

from processes import children, runs
from spaces import configurations

KILLS = 20
# Long enough on a busy machine, s.
PATIENCE = 120


def start(programs, file):
    return subprocess.Popen([programs[0], file, programs[1]], stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, text=True,
                            env=os.environ | {"TMPDIR": os.path.dirname(file)})


def finish(job):
    out, error = job.communicate(timeout=PATIENCE)
    assert job.returncode == 0, error
    assert out.endswith("complete\n"), out
    return [int(line) for line in out.split()[:-1]]


def main():
    programs = sys.argv[1:3]
    rng = random.Random(2009)
    with tempfile.TemporaryDirectory() as folder:
        whole = os.path.join(folder, "whole.palpate")
        finish(start(programs, whole))
        file = os.path.join(folder, "killed.palpate")
        grown = 0
        for _ in range(KILLS):
            before = configurations(file)
            job = start(programs, file)
            explorers = []
            # Some are killed while they begin, and the others once they have found something.
            if rng.random() < 0.75:
                for line in job.stdout:
                    if line == "complete\n" or int(line) >= rng.randint(1, 4):
                        break
                explorers = children(job.pid)
                time.sleep(rng.uniform(0, 0.1))
            else:
                time.sleep(rng.uniform(0, 0.3))
            job.kill()
            job.communicate()
            begin = time.monotonic()
            while any(runs(pid) for pid in explorers):
                assert time.monotonic() < begin + PATIENCE, "an explorer outlives its session"
                time.sleep(0.01)
            after = configurations(file)
            for key, found in before.items():
                assert after[key] == found, key
            grown += len(after) > len(before)
        # Not only the last run finds something.
        assert grown > KILLS / 4, grown
        finish(start(programs, file))
        found, expected = configurations(file), configurations(whole)
        assert found.keys() == expected.keys(), (len(found), len(expected))
        print(f"{KILLS} kills, {grown} of them after something was found, of {len(found)}")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""A run that is killed at any instant goes on, on any number of ranks, to the same space.

  test_kills.py <tolerance> <tool> <all | surface> <kills> <palpate_test_explore>
    <mpiexec and its options …>

Kills one rank or the whole job at a random instant, again and again until a run comes to its end,
and counts: what was in the files is not computed again, and the space is that of a run that nobody
disturbed.
"""

import glob
import os
import random
import subprocess
import sys
import tempfile
import time

from processes import runs
from spaces import compare, configurations, solved_and_reused


def start(program, mpiexec, ranks, file, how):
    job = subprocess.Popen([*mpiexec, "-n", str(ranks), program, file, *how],
                           stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                           start_new_session=True)
    pids = []
    while len(pids) < ranks:
        line = job.stdout.readline()
        assert line, job.stderr.read()
        if line.startswith("pid "):
            pids.append(int(line.split()[1]))
    return job, pids


def finish(job):
    """(solved, reused) of a run that nobody disturbs."""
    out, error = job.communicate(timeout=200)
    assert job.returncode == 0, error
    return solved_and_reused(out)


def main():
    tolerance, tool, keep, kills, program, *mpiexec = sys.argv[1:]
    how = (tolerance, tool, keep)
    rng = random.Random(2007)
    with tempfile.TemporaryDirectory() as folder:
        whole = os.path.join(folder, "whole.palpate")
        begin = time.monotonic()
        solved, _ = finish(start(program, mpiexec, 1, whole, how)[0])
        length = time.monotonic() - begin
        expected = configurations(whole)
        left = int(kills)
        num_runs = 0
        while left > 0:
            num_runs += 1
            file = os.path.join(folder, f"{num_runs}.palpate")
            total = 0
            # Three kills a run on average: it is killed on the way again.
            while left > 0 and rng.random() < 0.75:
                before = configurations(file)
                ranks = rng.randint(1, 3)
                job, pids = start(program, mpiexec, ranks, file, how)
                time.sleep(rng.uniform(0, 0.5 * length))
                try:
                    if rng.random() < 0.5:
                        os.kill(rng.choice(pids), 9)
                    else:
                        os.killpg(job.pid, 9)
                        for pid in pids:
                            os.kill(pid, 9)
                except ProcessLookupError:
                    pass
                job.communicate()
                for pid in pids:  # no rank outlives its job
                    while runs(pid):
                        time.sleep(0.01)
                left -= 1
                after = configurations(file)
                assert before.keys() <= after.keys(), "something that was found is lost"
                total = len(after)
            process, *_ = start(program, mpiexec, rng.randint(1, 3), file, how)
            solved_now, reused = finish(process)
            assert reused >= total, (reused, total)
            assert solved_now + reused == solved, (solved_now, reused, solved)
            compare(configurations(file), expected, keep == "all")
            assert sorted(glob.glob(file + "*")) == [file]
        print(f"{kills} kills in {num_runs} runs of {len(expected)} configurations")


if __name__ == "__main__":
    main()

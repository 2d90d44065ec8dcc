# SPDX-License-Identifier: BSD-3-Clause
"""A run that has not enough memory on one of its ranks ends with one clear error on all, one that
loses a rank ends too, and each goes on where it was.

  test_memory.py <all | surface> <palpate_test_explore> <mpiexec and its options …>

Lets an allocation fail on a rank, anywhere from the first to the last one, also while the files
are reduced and merged; kills a rank there, where a kill at a random instant hardly comes; and sets
a limit to the address space of a rank. In the end the space is that of an undisturbed run.
"""

import glob
import os
import random
import subprocess
import sys
import tempfile

from spaces import compare, configurations, solved_and_reused

# Of each kind: anywhere, and in the last share of the allocations, in which the fields are reduced.
FAILURES = 3
END = 0.1
# MB of address space beside what a process has at the start: from too little for the BLAS to more
# than is needed.
LIMITS = (64, 142, 512)
MOST_RANKS = 3
# A run that hangs shows in this time, s; others take less than one.
TIMEOUT = 60


def explore(program, mpiexec, ranks, file, keep, *how):
    return subprocess.run([*mpiexec, "-n", str(ranks), program, file, "0", "bonded", keep, *how],
                          capture_output=True, text=True, timeout=TIMEOUT, check=False)


def expect_clear_error(done):
    told = [line for line in done.stderr.splitlines() if "There is not enough memory" in line]
    assert len(told) == 1 and "This process has" in told[0], done.stderr
    for word in ("terminate called", "Segmentation", "Aborted", "signal"):
        assert word not in done.stderr, done.stderr


def main():
    keep, program, *mpiexec = sys.argv[1:]
    rng = random.Random(2011)
    with tempfile.TemporaryDirectory() as folder:
        num_allocations = {}
        for ranks in range(MOST_RANKS, 0, -1):
            whole = os.path.join(folder, f"{ranks}.palpate")
            done = explore(program, mpiexec, ranks, whole, keep)
            assert done.returncode == 0, done.stderr
            told = next(line for line in done.stdout.splitlines() if "allocations" in line)
            num_allocations[ranks] = [int(number) for number in told.split()[1:]]
        num_solved, _ = solved_and_reused(done.stdout)
        expected = configurations(whole)

        at_end = [1 - END * rng.uniform(0.1, 1) for _ in range(2 * FAILURES)]
        limits = [(share, "") for share in at_end[:FAILURES]]
        limits += [(share, "K") for share in at_end[FAILURES:]]
        limits += [(rng.random(), "") for _ in range(FAILURES)]
        rng.shuffle(limits)
        limits += [(limit, "M") for limit in LIMITS]
        file = os.path.join(folder, "a.palpate")
        num_failed = num_killed = 0
        for limit, kind in limits:
            # What was found is not found again, which takes fewer allocations than were counted.
            if kind == "K":
                for left in glob.glob(file + "*"):
                    os.remove(left)
            before = configurations(file)
            # Ranks share the work in one way and another, and may not come to the allocation; one
            # that is alone does.
            is_alone = kind == "K" and num_killed == 0
            ranks = 1 if is_alone else rng.randint(1, MOST_RANKS)
            rank = rng.randrange(ranks)
            if kind != "M":
                limit = int(limit * num_allocations[ranks][rank])
            how = f"{limit}{kind}"
            done = explore(program, mpiexec, ranks, file, keep, str(rank), how)
            print(f"{how} on rank {rank} of {ranks}: exit code {done.returncode}", flush=True)
            after = configurations(file)
            assert before.keys() <= after.keys(), "something that was found is lost"
            if done.returncode != 0:
                if kind == "K":
                    num_killed += 1
                else:
                    expect_clear_error(done)
                    num_failed += 1
                # Some files see several failures.
                if rng.random() < 0.5:
                    continue
                done = explore(program, mpiexec, rng.randint(1, MOST_RANKS), file, keep)
                assert done.returncode == 0, done.stderr
            solved_now, reused = solved_and_reused(done.stdout)
            assert reused >= len(before) and solved_now + reused == num_solved, (solved_now, reused)
            compare(configurations(file), expected, keep == "all")
            assert glob.glob(file + "*") == [file]
            os.remove(file)
        print(f"{num_failed} of {len(limits)} runs failed, {num_killed} were killed")
        assert num_failed >= FAILURES and num_killed > 0


if __name__ == "__main__":
    main()

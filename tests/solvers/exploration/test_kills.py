# SPDX-License-Identifier: BSD-3-Clause
"""A run that is killed at any instant goes on, on any number of ranks, to the same space.

  test_kills.py <tolerance> <kills> <palpate_test_explore> <mpiexec and its options …>

Kills one rank or the whole job at a random instant, again and again until a run comes to its end,
and counts: what was in the files is not computed again, and the space is that of a run that nobody
disturbed.
"""

import glob
import os
import random
import shutil
import sqlite3
import struct
import subprocess
import sys
import tempfile
import time

# Two runs that reach a configuration from the same start find the same numbers but for rounding.
AGREEMENT = 1e-7


def start(program, mpiexec, ranks, file, tolerance):
    job = subprocess.Popen([*mpiexec, "-n", str(ranks), program, file, tolerance],
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
    words = out.split()
    return int(words[words.index("solved") + 1]), int(words[words.index("reused") + 1])


def configurations(file):
    """{(node, i, j, k): (outcome, energy, force, u)} of a file and those of the ranks beside it."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        # Copies: what a killed run has left is taken up by whoever opens it.
        for name in glob.glob(file + "*"):
            shutil.copy(name, folder)
        for name in glob.glob(os.path.join(folder, "*")):
            if name.endswith(("-wal", "-shm", "-journal")) or os.path.getsize(name) == 0:
                continue
            with sqlite3.connect(name) as database:
                tables = database.execute("SELECT name FROM sqlite_master").fetchall()
                if ("configuration",) not in tables:
                    continue
                for row in database.execute(
                        "SELECT active_node, i, j, k, outcome, energy, force_x, force_y, force_z, u"
                        " FROM configuration"):
                    if row[4] == 0:
                        found[row[:4]] = (row[5], row[6:9], row[9])
    return found


def numbers(blob):
    return struct.unpack(f"<{len(blob) // 8}d", blob)


def compare(found, expected):
    assert found.keys() == expected.keys(), (len(found), len(expected))
    largest = max(abs(x) for _, force, _ in expected.values() for x in force)
    for key, (energy, force, u) in found.items():
        right_energy, right_force, right_u = expected[key]
        assert abs(energy - right_energy) <= AGREEMENT * max(abs(right_energy), 1e-9), key
        for a, b in zip(force, right_force):
            assert abs(a - b) <= AGREEMENT * largest, (key, a, b)
        scale = max((abs(x) for x in numbers(right_u)), default=0)
        assert all(abs(a - b) <= AGREEMENT * scale
                   for a, b in zip(numbers(u), numbers(right_u))), key


def main():
    tolerance, kills, program, *mpiexec = sys.argv[1:]
    rng = random.Random(2007)
    with tempfile.TemporaryDirectory() as folder:
        whole = os.path.join(folder, "whole.palpate")
        begin = time.monotonic()
        solved, _ = finish(start(program, mpiexec, 1, whole, tolerance)[0])
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
                job, pids = start(program, mpiexec, ranks, file, tolerance)
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
                    while os.path.exists(f"/proc/{pid}"):
                        time.sleep(0.01)
                left -= 1
                after = configurations(file)
                assert before.keys() <= after.keys(), "something that was found is lost"
                total = len(after)
            solved_now, reused = finish(start(program, mpiexec, rng.randint(1, 3), file, tolerance)[0])
            assert reused >= total, (reused, total)
            assert solved_now + reused == solved, (solved_now, reused, solved)
            compare(configurations(file), expected)
            assert sorted(glob.glob(file + "*")) == [file]
        print(f"{kills} kills in {num_runs} runs of {len(expected)} configurations")


if __name__ == "__main__":
    main()

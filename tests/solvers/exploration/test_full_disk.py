# SPDX-License-Identifier: BSD-3-Clause
"""A run that fills the disk ends with one clear error, and with more room goes on where it was.

  test_full_disk.py <all | surface> <palpate_test_explore> <mpiexec and its options …>

The disk is a file system in memory, which becomes larger from run to run: too small for an empty
file, for the configurations, for the files of the ranks beside the merged one, and at last large
enough. With fields that are reduced at the end, it is also too small for that alone. Where mounting
is not permitted the test is skipped, and fails if the environment has PALPATE_SKIP_NOTHING.
"""

import glob
import os
import subprocess
import sys
import tempfile

from spaces import compare, configurations, solved_and_reused

SKIPPED = 77  # exit code
RANKS = 2
# kB. The last is enough for the whole space twice, with the logs.
SIZES = (16, 200, 900, 2400, 8000, 64000)
# kB, of a disk for a new file: from too small for all configurations to enough, in steps so small
# that one of them is enough for the configurations and not for what is made of them at the end.
FIRST_SIZE, STEP = 16000, 1.03


def mount(folder, options):
    return subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder],
                          capture_output=True, text=True, check=False)


def explore(program, mpiexec, ranks, file, keep):
    return subprocess.run([*mpiexec, "-n", str(ranks), program, file, "0", "bonded", keep],
                          capture_output=True, text=True, timeout=200, check=False)


def fill_at_the_end(disk, run, expected):
    """Nothing of what was found is lost where the disk is full when the fields are reduced."""
    file = os.path.join(disk, "b.palpate")
    os.remove(os.path.join(disk, "a.palpate"))
    size = FIRST_SIZE
    num_at_end = 0
    while True:
        size = int(STEP * size)
        grown = mount(disk, f"remount,size={size}k")
        assert grown.returncode == 0, grown.stderr
        done = run(file)
        if done.returncode == 0:
            break
        told = [line for line in done.stderr.splitlines() if disk in line]
        assert len(told) == 1 and "There is no space left to write" in told[0], done.stderr
        num_at_end += configurations(file).keys() == expected.keys()
        print(f"{size} kB: exit code {done.returncode}, full at the end {num_at_end} times")
        for left in glob.glob(file + "*"):
            os.remove(left)
    assert num_at_end > 0, "the disk was never full at the end"
    compare(configurations(file), expected, False)
    assert glob.glob(os.path.join(disk, "*")) == [file]


def main():
    keep, program, *mpiexec = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        whole = os.path.join(folder, "whole.palpate")
        done = explore(program, mpiexec, 1, whole, keep)
        assert done.returncode == 0, done.stderr
        num_solved, _ = solved_and_reused(done.stdout)
        expected = configurations(whole)

        disk = os.path.join(folder, "disk")
        os.mkdir(disk)
        mounted = mount(disk, f"size={SIZES[0]}k")
        if mounted.returncode != 0:
            print("A file system cannot be mounted here:", mounted.stderr.strip())
            sys.exit(1 if os.environ.get("PALPATE_SKIP_NOTHING") else SKIPPED)
        try:
            file = os.path.join(disk, "a.palpate")
            num_failures = num_found = 0
            for size in SIZES:
                grown = mount(disk, f"remount,size={size}k")
                assert grown.returncode == 0, grown.stderr
                before = configurations(file)
                done = explore(program, mpiexec, RANKS, file, keep)
                after = configurations(file)
                assert before.keys() <= after.keys(), "something that was found is lost"
                print(f"{size} kB: {len(after)} configurations, exit code {done.returncode}")
                if done.returncode == 0:
                    break
                num_failures += 1
                told = [line for line in done.stderr.splitlines() if disk in line]
                assert len(told) == 1 and "There is no space left to write" in told[0], done.stderr
                num_found += len(after) > len(before)
            assert done.returncode == 0, done.stderr
            # It ended in several ways, and not only before the first configuration.
            assert num_failures >= 3 and num_found >= 2, (num_failures, num_found)
            solved_now, reused = solved_and_reused(done.stdout)
            assert reused >= len(before) and solved_now + reused == num_solved, (solved_now, reused)
            compare(after, expected, keep == "all")
            assert glob.glob(os.path.join(disk, "*")) == [file]
            if keep == "surface":
                fill_at_the_end(disk, lambda file: explore(program, mpiexec, RANKS, file, keep),
                                expected)
        finally:
            subprocess.run(["umount", disk], check=True)


if __name__ == "__main__":
    main()

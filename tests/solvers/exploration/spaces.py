# SPDX-License-Identifier: BSD-3-Clause
"""State-space files as numbers, for tests that disturb the runs that write them."""

import glob
import os
import shutil
import sqlite3
import struct
import tempfile

# Two runs that reach a configuration from the same start find the same numbers but for rounding.
AGREEMENT = 1e-7
# The number of a rigid tool's space, whose fields are of single precision, and what that rounds.
CONTACT = -1
SINGLE = 2 ** -23


def solved_and_reused(output):
    """What palpate_test_explore has printed."""
    words = output.split()
    return int(words[words.index("solved") + 1]), int(words[words.index("reused") + 1])


def configurations(file):
    """{(node, i, j, k, level): (energy, force, u)} of a file and those of the ranks beside it,
    without candidates for a level. None of them is without the intermediate states on the way to
    it, nor the other way round."""
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        # Copies: what a killed run has left is taken up by whoever opens it.
        for name in glob.glob(file + "*"):
            shutil.copy(name, folder)
        for name in glob.glob(os.path.join(folder, "*")):
            # What was killed while it made a file has left a part of it, which nobody reads.
            if (name.endswith(("-wal", "-shm", "-journal", ".part"))
                    or os.path.getsize(name) == 0):
                continue
            with sqlite3.connect(name) as database:
                tables = database.execute("SELECT name FROM sqlite_master").fetchall()
                if ("configuration",) not in tables:
                    continue
                ways = {}
                states_of = dict(database.execute(
                    "SELECT tool_space_id, intermediate_states FROM tool_space"))
                for row in database.execute(
                        "SELECT tool_space_id, i, j, k, level, outcome, energy, force_x, force_y,"
                        " force_z, u FROM configuration WHERE level >= 0"):
                    if row[5] != 0:
                        continue
                    found[row[:5]] = (row[6], row[7:10], row[10])
                    if row[4] == 0:
                        ways[row[:4]] = 0 if row[1:4] == (0, 0, 0) else states_of[row[0]]
                num_states = dict.fromkeys(ways, 0)
                for *key, count in database.execute(
                        "SELECT tool_space_id, i, j, k, count(*) FROM intermediate"
                        " GROUP BY tool_space_id, i, j, k"):
                    num_states[tuple(key)] = count
                assert num_states == ways, name
    return found


def numbers(blob, single):
    """Those of a field, in single precision or double. It is not stored where the tool touches
    nothing."""
    if blob is None:
        return ()
    return struct.unpack(f"<{len(blob) // 4}f" if single else f"<{len(blob) // 8}d", blob)


def compare(found, expected, with_fields=True):
    assert found.keys() == expected.keys(), (len(found), len(expected))
    largest = max(abs(x) for _, force, _ in expected.values() for x in force)
    for key, (energy, force, u) in found.items():
        right_energy, right_force, right_u = expected[key]
        assert abs(energy - right_energy) <= AGREEMENT * max(abs(right_energy), 1e-9), key
        for a, b in zip(force, right_force):
            assert abs(a - b) <= AGREEMENT * largest, (key, a, b)
        if not with_fields:
            continue
        single = key[0] == CONTACT
        ours, theirs = numbers(u, single), numbers(right_u, single)
        assert len(ours) == len(theirs), key
        scale = max((abs(x) for x in theirs), default=0)
        agreement = AGREEMENT + (SINGLE if single else 0)
        assert all(abs(a - b) <= agreement * scale for a, b in zip(ours, theirs)), key

# SPDX-License-Identifier: BSD-3-Clause
"""Processes that tests kill, and those that these have started."""

import glob


def runs(pid):
    """Whether a process does. One that has ended may stay for seconds until init takes note."""
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
            state = stat.read().rpartition(")")[2].split()[0]
    except (FileNotFoundError, ProcessLookupError):
        return False
    return state not in "XZ"


def children(pid):
    """The processes that a process has started and that have not ended."""
    found = []
    for name in glob.glob(f"/proc/{pid}/task/*/children"):
        with open(name, encoding="ascii") as text:
            found += [int(word) for word in text.read().split()]
    return found

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The device test: runs the guest's program in a virtual machine and checks what it has recorded.

    device_test.py <program> <palpate-guardian> <folder>

The environment variable PALPATE_DEVICE_TRIALS says how often each way in which the host's program
can end or stop is tried; 4 times without it. The folder keeps the kernel, and of the last run
console.log, what the guest's kernel said, and records.log. Ends with 77 where there is no QEMU or
no kernel to be had; with 1 where the
environment has PALPATE_SKIP_NOTHING.
"""

import os
import sys
from pathlib import Path

import check_records
import virtual_machine


def timeout_s(trials):
    """For where something in the guest hangs."""
    return 180 + 20 * trials



def main():
    program, guardian, folder = map(Path, sys.argv[1:])
    trials = int(os.environ.get("PALPATE_DEVICE_TRIALS", 4))
    try:
        virtual_machine.fetch_kernel(folder)
    except virtual_machine.Unavailable as reason:
        print("not run:", reason)
        return 1 if os.environ.get("PALPATE_SKIP_NOTHING") else 77
    records = folder / "records.log"
    try:
        virtual_machine.run(program, [guardian], {"trials": trials}, folder, records,
                            timeout_s(trials))
        return check_records.check(records)
    finally:
        print((folder / "console.log").read_text(errors="replace"))


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The device test: runs the guest's program in a virtual machine and checks what it has recorded.

    device_test.py <program> <folder>

The folder keeps the kernel, and of the last run console.log, what the guest's kernel said, and
records.log. Ends with 77 where there is no QEMU or no kernel to be had; with 1 where the
environment has PALPATE_SKIP_NOTHING.
"""

import os
import sys
from pathlib import Path

import check_records
import virtual_machine

# Where something in the guest hangs.
TIMEOUT_S = 240


def main():
    program, folder = Path(sys.argv[1]), Path(sys.argv[2])
    try:
        virtual_machine.fetch_kernel(folder)
    except virtual_machine.Unavailable as reason:
        print("not run:", reason)
        return 1 if os.environ.get("PALPATE_SKIP_NOTHING") else 77
    records = folder / "records.log"
    try:
        virtual_machine.run(program, folder, records, TIMEOUT_S)
        return check_records.check(check_records.Records(records))
    finally:
        print((folder / "console.log").read_text(errors="replace"))


if __name__ == "__main__":
    sys.exit(main())

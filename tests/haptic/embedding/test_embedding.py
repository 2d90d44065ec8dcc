# SPDX-License-Identifier: BSD-3-Clause
"""The example for other programs touches a body, and so does the loop that its page shows.

  test_embedding.py <palpate_touch> <palpate_test_make_space> <palpate_test_embedding_page>
"""

import os
import re
import subprocess
import sys
import tempfile

LINE = re.compile(r"(running|stale): (\S+) m deep, (\S+) N")


def main():
    program, make_space, page = sys.argv[1:]
    with tempfile.TemporaryDirectory() as folder:
        spaces = {"block": [], "pressed": ["whole"]}
        for name, extent in spaces.items():
            space = os.path.join(folder, f"{name}.palpate")
            subprocess.run([make_space, space, *extent], check=True, stdout=subprocess.DEVNULL)
            done = subprocess.run([program, space], capture_output=True, text=True, timeout=60,
                                  check=False)
            assert done.returncode == 0, done.stderr
            lines = [LINE.fullmatch(line) for line in done.stdout.splitlines()]
            assert len(lines) == 10 and all(lines), done.stdout
            # The hand presses three times in two seconds: once at least the loop is in time.
            pressed = [line for line in lines[5:] if line.group(1) == "running"]
            assert any(0.003 < float(line.group(2)) < 0.006 and float(line.group(3)) > 0.04
                       for line in pressed), done.stdout

        space = os.path.join(folder, "block.palpate")
        done = subprocess.run([page, space], capture_output=True, text=True, timeout=60,
                              check=False)
        assert done.returncode == 0, done.stdout + done.stderr

        for arguments, word in (([], "palpate file"), ([os.path.join(folder, "none")], "none"),
                                ([space, "ffff:ffff"], "ffff:ffff")):
            done = subprocess.run([program, *arguments], capture_output=True, text=True, timeout=60,
                                  check=False)
            assert done.returncode == 1 and word in done.stderr, done.stderr


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Sources are formatted by clang-format, and lines of other texts are short.

    check_format.py <root of the sources>

Prints one line a violation, and ends with 1 if there is any. The C++ sources are what clang-format
14 makes of them by the nearest .clang-format; other versions format differently, so that without
this one the check ends with 77, which is "skipped" to CTest. In Debian 12, which has it, that is a
fault where the environment has PALPATE_SKIP_NOTHING. Lines of scripts, CMake files and XML have at
most 100 characters. Pages are free: a row of a table is one line.
"""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

from check_includes import TOP_FOLDERS

VERSION = 14
SOURCES = {".h", ".cpp", ".cxx"}
TEXTS = {".py", ".sh", ".cmake", ".xml", ".slurm"}
LONGEST = 100
SKIPPED = 77
FILES_AT_ONCE = 40


def files(root):
    """All files of the folders that hold sources, and those beside them."""
    folders = [root / name for name in TOP_FOLDERS if (root / name).is_dir()]
    found = [path for folder in folders for path in folder.rglob("*")]
    return sorted(path for path in [*found, *root.glob("*")]
                  if path.is_file() and "__pycache__" not in path.parts)


def is_text(path):
    if path.suffix in TEXTS or path.name == "CMakeLists.txt":
        return True
    if path.suffix:
        return False
    with open(path, "rb") as file:
        return file.read(2) == b"#!"


def long_lines(root):
    for path in filter(is_text, files(root)):
        lines = path.read_text(encoding="utf-8").split("\n")
        for number, line in enumerate(lines, 1):
            if len(line) > LONGEST:
                yield (f"{path.relative_to(root)}:{number}: the line has {len(line)} characters, "
                       f"{LONGEST} are allowed")


def clang_format():
    """The program of the right version, or None."""
    for name in (f"clang-format-{VERSION}", "clang-format"):
        program = shutil.which(name)
        if program is None:
            continue
        said = subprocess.run([program, "--version"], capture_output=True, text=True, check=True)
        if re.search(rf"version {VERSION}\.", said.stdout):
            return program
    return None


def unformatted(root, program):
    """Of each source that is not formatted the first place."""
    sources = [path for path in files(root) if path.suffix in SOURCES]
    for first in range(0, len(sources), FILES_AT_ONCE):
        run = subprocess.run([program, "--dry-run", "--ferror-limit=0",
                              *sources[first:first + FILES_AT_ONCE]],
                             capture_output=True, text=True, check=True)
        places = {}
        for path, line in re.findall(r"^(.+?):(\d+):\d+: warning: code should be", run.stderr,
                                     flags=re.MULTILINE):
            places.setdefault(Path(path), line)
        for path, line in places.items():
            path = path.relative_to(root)
            yield f"{path}:{line}: it is not formatted; run clang-format-{VERSION} -i {path}"


def is_debian_12():
    try:
        release = Path("/etc/os-release").read_text(encoding="utf-8")
    except OSError:
        return False
    return "VERSION_CODENAME=bookworm" in release


def main(root):
    root = Path(root).resolve()
    faults = list(long_lines(root))
    program = clang_format()
    if program is not None:
        faults += unformatted(root, program)
    print("\n".join(faults) or "No violation.")
    if faults:
        return 1
    if program is None:
        print(f"The C++ sources were not checked: clang-format {VERSION} is missing, and others "
              "format differently. Debian 12 has it in the package clang-format-14.")
        return 1 if is_debian_12() and os.environ.get("PALPATE_SKIP_NOTHING") else SKIPPED
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))

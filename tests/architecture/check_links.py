# SPDX-License-Identifier: BSD-3-Clause
"""Every link and picture of every page of the repository leads somewhere, heading included, and
every picture of the Help window is small enough for what it shows.

Argument: the root of the repository.
"""
import glob
import os
import re
import sys

LARGEST_PICTURE = 60_000  # bytes; of the window


def headings(path):
    """The places in a page, as GitHub names them."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"^```.*?^```", "", file.read(), flags=re.DOTALL | re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
            for heading in re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)}


def faults_of(page):
    with open(page, encoding="utf-8") as file:
        text = re.sub(r"^```.*?^```", "", file.read(), flags=re.DOTALL | re.MULTILINE)
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if target.startswith("http"):
            continue
        path, _, place = target.partition("#")
        path = os.path.join(os.path.dirname(page), path) if path else page
        if not os.path.exists(path):
            yield f"{page}: there is no {target}"
        elif place and place not in headings(path):
            yield f"{page}: {target} names no heading"


def main(root):
    os.chdir(root)
    pages = [path for path in glob.glob("**/*.md", recursive=True) + glob.glob(".github/*.md")
             if not path.startswith(("build", "out"))]
    assert len(pages) > 20, pages
    faults = [fault for page in sorted(pages) for fault in faults_of(page)]
    faults += [f"{path}: {os.path.getsize(path)} bytes, more than {LARGEST_PICTURE}"
               for path in sorted(glob.glob("plugin/help/*.png"))
               if os.path.getsize(path) > LARGEST_PICTURE]
    sys.exit("\n".join(faults) or None)


main(sys.argv[1])

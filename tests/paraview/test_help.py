# SPDX-License-Identifier: BSD-3-Clause
"""What the plugin brings for ParaView's Help window: all pages, those of the properties of every
proxy too, with every link and picture leading to something that is there.

Argument: the help in the form of Qt (.qch), an SQLite database
"""

import os
import posixpath
import re
import sqlite3
import sys
import zlib

PROXIES = ["filters.TetrahedralizeSurface", "filters.TetrahedralizeLabelMap",
           "filters.AssignMaterial", "filters.SetBoundary", "filters.RefineMesh",
           "filters.SolveEquilibrium", "filters.SolveDynamics", "filters.CarrySurface",
           "filters.BuildReducedModel", "filters.SimulateTouch", "filters.TouchReducedModel",
           "filters.PrecomputeStateSpace", "filters.TouchStateSpace",
           "filters.AccuracyReport", "filters.EstimateError", "filters.ReplayTouch",
           "sources.StateSpaceReader", "sources.FEBioReader", "writers.FEBioWriter"]
# Both on one page.
PAGES = {"FEBioReader": "FEBio", "FEBioWriter": "FEBio"}
SIZE_BYTES = 4  # before what zlib has packed

help_file = sqlite3.connect(f"file:{os.path.abspath(sys.argv[1])}?mode=ro", uri=True)
files = {name: zlib.decompress(data[SIZE_BYTES:]) for name, data in help_file.execute(
    "SELECT Name, Data FROM FileNameTable JOIN FileDataTable ON FileId = FileDataTable.Id "
    "WHERE Data NOT NULL")}
pages = {name: data.decode("utf-8") for name, data in files.items() if name.endswith(".html")}

for proxy in PROXIES:
    name = proxy.partition(".")[2]
    assert "Description" in pages[f"{proxy}.html"], proxy
    own = pages[f"plugin/help/{PAGES.get(name, name)}.html"]
    assert f'href="../../{proxy}.html"' in own, f"{name}: no link to its properties"
    assert "<img" in own, f"{name}: no picture"
for page in ("README", "plugin/help/quick_start", "plugin/help/dock", "plugin/help/accuracy",
             "plugin/help/stability", "plugin/help/estimates", "haptic/README",
             "examples/cluster/README",
             "examples/embedding/README"):
    assert "<img" in pages[page + ".html"], f"{page}: no picture"

contents, = help_file.execute("SELECT Data FROM ContentsTable").fetchone()
text = contents.decode("utf-16-be", errors="replace")
for name in pages:
    if name.startswith("plugin/help/"):
        assert name in text, f"{name} is not in the contents"

links = 0
for name, page in pages.items():
    for target in re.findall(r'(?:href|src)="([^"]+)"', page):
        if target.startswith(("http:", "https:")):
            continue
        path, _, place = target.partition("#")
        path = posixpath.normpath(posixpath.join(posixpath.dirname(name), path)) if path else name
        assert path in files, f"{name}: there is no {target}"
        assert not place or f'id="{place}"' in pages[path], f"{name}: {target} names no heading"
        links += 1
assert links > 100, links

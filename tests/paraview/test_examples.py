# SPDX-License-Identifier: BSD-3-Clause
"""examples/liver at a reduced size: on one rank and on two, with the same table and pictures.

Arguments: pvbatch and, where there is MPI, mpiexec with its options.
"""

import csv
import math
import os
import subprocess
import sys

from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

PVBATCH, MPIEXEC = sys.argv[1], sys.argv[2:]
SCRIPT = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "examples", "liver", "liver.py")
SMALL = ["--resolution", "3", "--elements", "400"]
PICTURES = ["rest.png", "deformed_push.png", "deformed_pull.png", "deformed_sideways.png"]
# What another number of ranks may change; the times follow it.
OF_THE_RUN = ("meshing", "ranks", "solved in this run", "taken from the file", "size of the file")
# The figures of the table have four digits.
ROUNDING = 2e-3
# The ranks blend the border of shapes in another order.
PIXEL_TOLERANCE = 60
SHARE_OF_PIXELS = 1e-3


def run(ranks, *arguments):
    launcher = [*MPIEXEC, "-n", str(ranks)] if ranks > 1 else []
    # This process is an MPI program of its own, and mpiexec would take over what it is told of it.
    environment = {name: value for name, value in os.environ.items()
                   if ranks == 1 or not name.startswith(("OMPI_", "PMIX_"))}
    return subprocess.run([*launcher, PVBATCH, SCRIPT, *arguments], stdout=subprocess.PIPE,
                          stderr=subprocess.PIPE, text=True, timeout=500, check=False,
                          env=environment)


def table_of(folder):
    with open(os.path.join(folder, "table.csv"), encoding="utf-8", newline="") as file:
        return {row["quantity"]: row["value"] for row in csv.DictReader(file)}


def pixels_of(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


def number_of(text):
    try:
        return float(text)
    except ValueError:
        return None


def check_one_rank():
    done = run(1, *SMALL, "--output", "one")
    assert done.returncode == 0, done.stderr
    table = table_of("one")
    assert table["configurations"] == table["… converged"] == table["solved in this run"] == "27"
    assert abs(float(table["tetrahedra (quadratic)"]) / 400 - 1) < 0.3, table
    assert math.isclose(float(table["volume of the body"]), float(table["volume of the surface"]),
                        rel_tol=0.02)
    assert 0.1 < float(table["pull: force, solved for (converged)"]) < 100, table
    # The printed table is the saved one.
    with open("one/table.md", encoding="utf-8") as file:
        assert file.read().strip() in done.stdout
    assert os.path.getsize("one/liver_st-venant-kirchhoff_3.palpate") > 10000
    for name in PICTURES:
        drawn = (pixels_of(os.path.join("one", name)).min(axis=1) < 240).mean()
        assert 0.1 < drawn < 0.8, (name, drawn)


def check_that_the_file_is_used_again():
    done = run(1, *SMALL, "--output", "one")
    assert done.returncode == 0, done.stderr
    table = table_of("one")
    assert table["solved in this run"] == "0" and table["taken from the file"] == "27", table


def check_two_ranks():
    done = run(2, *SMALL, "--output", "two")
    assert done.returncode == 0, done.stderr
    one, two = table_of("one"), table_of("two")
    assert two["ranks"] == "2" and two["configurations"] == "27", two
    for quantity in set(one) - set(OF_THE_RUN):
        a, b = number_of(one[quantity]), number_of(two[quantity])
        if a is None or "difference" in quantity:
            continue
        assert math.isclose(a, b, rel_tol=ROUNDING, abs_tol=1e-12), (quantity, a, b)
    for name in PICTURES:
        a, b = pixels_of(os.path.join("one", name)), pixels_of(os.path.join("two", name))
        different = (abs(a - b).max(axis=1) > PIXEL_TOLERANCE).mean()
        assert different < SHARE_OF_PIXELS, (name, different)


def check_failures():
    for arguments, message in (
            (["--output", "bad", "missing.stl"], "there is no file missing.stl"),
            (["--output", "bad", "--nonsense"], "unrecognized arguments: --nonsense"),
            (["--output", "one", *SMALL, "--half-width", "0.01"], "--fresh")):
        done = run(1, *arguments)
        lines = [line for line in done.stderr.splitlines() if line]
        assert done.returncode == 1, (arguments, done.returncode)
        assert len(lines) == 1 and lines[0].startswith("liver.py: ") and message in lines[0], lines


def check_a_surface_that_crosses_itself():
    path = os.path.join(os.environ["PALPATE_SHARED_DATA"], "liver.stl")
    done = run(1, path, *SMALL, "--output", "stl")
    assert done.returncode == 1 and "7 pairs of triangles that cross" in done.stderr, done.stderr
    done = run(1, path, *SMALL, "--repair", "--output", "stl")
    assert done.returncode == 0, done.stderr
    table = table_of("stl")
    assert math.isclose(float(table["volume of the body"]), float(table["volume of the surface"]),
                        rel_tol=0.02), table
    assert all(os.path.exists(os.path.join("stl", name)) for name in PICTURES)


check_one_rank()
check_that_the_file_is_used_again()
if MPIEXEC:
    check_two_ranks()
check_failures()
if os.environ.get("PALPATE_SHARED_DATA"):
    check_a_surface_that_crosses_itself()

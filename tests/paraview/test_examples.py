# SPDX-License-Identifier: BSD-3-Clause
"""The examples that several ranks run together, at a reduced size: examples/liver on one rank and
on two, with the same table and pictures, reports, and examples/cluster with the batch job. Those of
one rank: test_examples_alone.py.

Arguments: pvbatch and, where there is MPI, mpiexec with its options.
"""

import concurrent.futures
import csv
import glob
import math
import os
import re
import signal
import sqlite3
import subprocess
import time

import numpy as np
from examples_support import (EXAMPLES, MPIEXEC, PVBATCH, environment_of, expect_pictures, rows_of,
                              run)
from image_support import pixels
from paraview.simple import SaveData, XMLImageDataReader, XMLUnstructuredGridReader
from support import cell_array, fetch, places, point_array, scene
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkIOImage import vtkNIFTIImageWriter

SMALL = ["--resolution", "3", "--elements", "400"]
OF_ACCURACY = ["--points", "20", "--output", "accuracy"]
OF_BRAIN = ["--grey", "grey.nii.gz", "--white", "white.nii", "--voxel", "6", "--edge", "0.04",
            "--region", "0.004", "--output", "brain"]
OF_CLUSTER = ["scene.vtu", "--resolution", "3", "--at-most", "2", "--tip-radius", "0.03"]
# To read it takes no time; what the examples make without a surface takes seconds.
SURFACE = os.path.join(EXAMPLES, "liver", "liver.vtp")
PICTURES = ["rest.png", "deformed_push.png", "deformed_pull.png", "deformed_sideways.png"]
# What another number of ranks may change; the times follow it.
OF_THE_RUN = ("meshing", "ranks", "solved in this run", "taken from the file", "size of the file")
# The figures of the table have four digits.
ROUNDING = 2e-3
# Of the maps of a head that is two eggs: the voxels (mm), middle and half axes of both (mm), and
# how far the volume of a tissue may be off, by the joining of voxels and the labels that they get.
VOXEL = 3.0
HEAD, CORE = ((0, -5, 5), (60, 70, 55)), ((12, 4, -3), (35, 42, 32))
OF_VOXELS = 0.03
# How far the middle of a body of such large cells may lie off, mm: a fourth of an edge.
OF_WALLS = 10
# Of the largest force, %: how far a space with check-points at two fifths of the tool's radius may
# be off between them.
OF_SPACE = 1
# The ranks blend the border of shapes in another order.
PIXEL_TOLERANCE = 60
SHARE_OF_PIXELS = 1e-3


def table_of(folder):
    with open(os.path.join(folder, "table.csv"), encoding="utf-8", newline="") as file:
        return {row["quantity"]: row["value"] for row in csv.DictReader(file)}


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
    # The first thing that a person sees is sound, up to the corners of the box.
    assert table["… inverted (det F ≤ 0 somewhere)"] == table["… near a fold"] == "0", table
    assert "push: force, interpolated (inside the space)" in table, table
    assert abs(float(table["tetrahedra (quadratic)"]) / 400 - 1) < 0.3, table
    assert math.isclose(float(table["volume of the body"]), float(table["volume of the surface"]),
                        rel_tol=0.02)
    assert 0.1 < float(table["pull: force, solved for (converged)"]) < 100, table
    # The printed table is the saved one.
    with open("one/table.md", encoding="utf-8") as file:
        assert file.read().strip() in done.stdout
    assert os.path.getsize("one/liver_neo-hookean_3.palpate") > 10000
    for name in PICTURES:
        drawn = (pixels(os.path.join("one", name)).min(axis=1) < 240).mean()
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
        a, b = pixels(os.path.join("one", name)), pixels(os.path.join("two", name))
        different = (abs(a - b).max(axis=1) > PIXEL_TOLERANCE).mean()
        assert different < SHARE_OF_PIXELS, (name, different)


def check_failures():
    for arguments, message in (
            (["--output", "bad", "missing.stl"], "there is no file missing.stl"),
            (["--output", "bad", "--nonsense"], "unrecognized arguments: --nonsense"),
            (["--output", "one", *SMALL, "--half-width", "0.01"], "--fresh")):
        done = run(1, *arguments)
        # A machine that is busy may be told that the space takes a while.
        lines = [line for line in done.stderr.splitlines() if line and ": About " not in line]
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


def elements(ranks, *arguments):
    """The rows of the report, and its force by element and tip on the coarsest mesh."""
    folder = f"elements_{ranks}"
    done = run(ranks, *arguments, "--finer-linear", "--fine-tip", "0.12", "--tip-radius", "0.018",
               "--output", folder, example="discretisation", script="elements")
    assert done.returncode == 0, done.stderr
    rows = rows_of(os.path.join(folder, "table.csv"))
    assert {row["outcome"] for row in rows} == {"converged"}, rows
    with open(os.path.join(folder, "table.md"), encoding="utf-8") as file:
        text = file.read().strip()
    assert text in done.stdout and "- Neo-Hookean: " in text, text
    expect_pictures(folder, "error_seconds", "error_unknowns", "displacement_seconds", "force_edge")
    return rows, {(row["element"], row["tip (mm)"]): float(row["force (N)"]) for row in rows
                  if row["law"] == "Neo-Hookean" and row["edge (mm)"].startswith("25")}


def check_elements():
    """@returns the forces, as elements()."""
    rows, force = elements(1, "--edges", "0.12", "0.09", "--laws", "Neo-Hookean",
                                 "Mooney-Rivlin incompressible")
    # Five meshes, with a tip for both laws and as a point for the first.
    assert len(rows) == 15, rows
    for law in ("Neo-Hookean", "Mooney-Rivlin incompressible"):
        error = {(row["element"], row["edge (mm)"][:2]): float(row["force error (%)"])
                 for row in rows if row["law"] == law and row["tip (mm)"] == "18"
                 and row["element"] != "Tet10, fine tip"}
        assert all(error["Tet10", edge] < error["Tet4", edge] / 2 for edge in ("18", "25")), error
    # Smaller cells at the place: the force of the point falls with them, the other hardly.
    assert force["Tet10, fine tip", "0"] < 0.6 * force["Tet10", "0"], force
    assert 0.7 < force["Tet10, fine tip", "18"] / force["Tet10", "18"] < 1.05, force
    for row in rows:
        assert float(row["seconds"]) > 0 and float(row["memory (MB)"]) >= 0, row
    return force


def check_elements_on_two_ranks(force):
    _, together = elements(2, "--edges", "0.12", "--laws", "Neo-Hookean")
    assert together.keys() == force.keys()
    assert all(math.isclose(force[key], together[key], rel_tol=1e-6) for key in force), together


def cluster(ranks, *arguments):
    return run(ranks, *arguments, example="cluster", script="precompute")


def check_cluster():
    """A scene as Set Boundary makes it, on two ranks, each for itself and together."""
    SaveData("scene.vtu", proxy=scene("cluster"), DataMode="Binary")
    ranks = 2 if MPIEXEC else 1
    done = cluster(ranks, *OF_CLUSTER, "--output", "cluster.palpate")
    assert done.returncode == 0, done.stderr
    assert "54 configurations solved and 0 taken from cluster.palpate" in done.stdout, done.stdout
    done = cluster(ranks, *OF_CLUSTER, "--output", "cluster.palpate", "--ranks-per-solve",
                   str(ranks))
    assert "0 configurations solved and 54 taken from cluster.palpate" in done.stdout, done.stdout


def check_failures_of_cluster():
    for arguments, message in (([], "name a scene"),
                               (["missing.vtu"], "there is no file missing.vtu"),
                               ([*OF_CLUSTER, "--part", "2", "2"], "no part 2 of 2"),
                               ([*OF_CLUSTER, "--ranks-per-solve", "2"], "number of ranks, 1")):
        done = cluster(1, *arguments)
        # A machine that is busy may be told that the space takes a while.
        lines = [line for line in done.stderr.splitlines() if line and ": About " not in line]
        assert done.returncode == 1 and len(lines) == 1, lines
        assert lines[0].startswith("precompute.py: ") and message in lines[0], lines


def check_options_of_the_job():
    """The batch job and its page name no option that the script does not have."""
    known = set(re.findall(r"--[a-z-]+", run(1, "--help", example="cluster",
                                             script="precompute").stdout))
    folder = os.path.join(EXAMPLES, "cluster")
    job = os.path.join(folder, "precompute.slurm")
    assert subprocess.run(["bash", "-n", job], check=False).returncode == 0
    with open(job, encoding="utf-8") as file:
        command = re.search(r"pvbatch (?:.*\\\n)*.*", file.read()).group()
    used = re.findall(r"--[a-z-]+", command)
    with open(os.path.join(folder, "README.md"), encoding="utf-8") as file:
        table = re.findall(r"^\| `(--[a-z-]+)", file.read(), flags=re.MULTILINE)
    assert {"--output", "--ranks-per-solve"} <= set(used) <= known, (used, known)
    assert set(table) == known - {"--help"}, set(table) ^ known


def num_configurations(path):
    """Of a space and what ranks have left beside it."""
    number = 0
    for name in [path, *glob.glob(path + ".rank*")]:
        if not name.endswith("-wal"):
            with sqlite3.connect(name) as space:
                number += space.execute("SELECT count(*) FROM configuration").fetchone()[0]
    return number


def check_the_job():
    """As on a node, with the file on its disk; then its time is up."""
    for folder in ("node", "again", "programs"):
        os.makedirs(folder)
    with open("programs/scontrol", "w", encoding="ascii") as file:
        file.write("#!/bin/sh\necho \"$@\" > scontrol.txt\n")
    os.chmod("programs/scontrol", 0o755)
    path = ":".join((os.path.abspath("programs"), os.path.dirname(PVBATCH), os.environ["PATH"]))
    environment = {**environment_of(2), "PATH": path, "SLURM_JOB_ID": "17", "LOCAL": "node",
                   "LAUNCHER": " ".join([*MPIEXEC, "-n", "2"])}
    job = ["bash", os.path.join(EXAMPLES, "cluster", "precompute.slurm"), "scene.vtu"]
    small = ["--at-most", "2", "--resolution"]
    done = subprocess.run([*job, "job.palpate", *small, "3"], env=environment, text=True,
                          capture_output=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert "54 configurations solved" in done.stdout, done.stdout
    assert glob.glob("job.palpate*") == ["job.palpate"] and num_configurations("job.palpate") == 54

    # One of an array of jobs: the other point of the two.
    environment["LOCAL"] = ""
    done = subprocess.run([*job, "job.palpate", *small, "3"], text=True, capture_output=True,
                          env={**environment, "SLURM_ARRAY_TASK_ID": "1",
                               "SLURM_ARRAY_TASK_COUNT": "2"}, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert "27 configurations solved and 0 taken from job_1.palpate" in done.stdout, done.stdout

    environment["LOCAL"] = "again"
    with subprocess.Popen([*job, "long.palpate", *small, "21"], env=environment) as batch:
        deadline = time.monotonic() + 200
        while not any(os.path.getsize(log) > 1e6 for log in glob.glob("again/*-wal")):
            assert batch.poll() is None and time.monotonic() < deadline
            time.sleep(0.1)
        batch.send_signal(signal.SIGUSR1)
        assert batch.wait(timeout=100) == 0
    with open("scontrol.txt", encoding="ascii") as file:
        assert file.read() == "requeue 17\n"
    kept = num_configurations("long.palpate")
    assert 0 < kept < 2 * 21 ** 3, kept


def check_roof():
    """Both branches of a coarse roof, and the jumps between them where the paths end."""
    done = run(2 if MPIEXEC else 1, "--cells", "1", "--resolution", "11", "--force-limit", "2500",
               "--steps", "30", "--output", "roof", example="roof")
    assert done.returncode == 0, done.stderr
    figures = [float(x) for x in re.findall(r"([0-9.]+) mm", done.stdout)]
    turns_back, down, up = figures
    spacing = 6
    assert turns_back - spacing <= down <= turns_back + spacing, done.stdout
    rows = [{name: float(x) for name, x in row.items()}
            for row in rows_of(os.path.join("roof", "table.csv"))]
    for row in rows:
        between = up < row["deflection (mm)"] < down
        assert (row["branch"], row["branch then"]) == ((0, 1) if between else
                                                       (row["branch then"],) * 2), row
        if between:
            assert row["pressed (N)"] > row["let go (N)"] + 50, row
    assert sum(up < row["deflection (mm)"] < down for row in rows) > 10
    # Without levels the same scene says that it has folds, where they are and in its status.
    assert any(row["found"] == 3 for row in rows) and "near a fold" in done.stderr
    expect_pictures("roof", "loop", "branches")


def check_accuracy():
    done = run(2 if MPIEXEC else 1, SURFACE, *OF_ACCURACY, "--elements", "150", "--resolutions",
               "3", "5", "--intermediate-states", "1", example="accuracy")
    assert done.returncode == 0, done.stderr
    with open("accuracy/report.md", encoding="utf-8") as file:
        text = file.read()
    assert text.strip() in done.stdout and "Energy Hermite has the least mean error" in text, text
    rows = rows_of("accuracy/table.csv")
    error = {(row["method"], row["grid"]): float(row["mean (%)"]) for row in rows}
    assert len(rows) == len(error) == 22, rows
    assert error["Energy Hermite", "5³"] < 0.1 * error["RBF cubic", "5³"], error
    assert error["Energy Hermite", "5³"] < 0.5 * error["Energy Hermite", "3³"], error
    assert all(float(row["TestPoints"]) == 20 for row in rows), rows
    pictures = re.findall(r"\((\w[^)]*)\.png\)", text)
    assert len(pictures) == 7, pictures
    expect_pictures("accuracy", *pictures)


def check_accuracy_of_a_file():
    """On one rank, with what was solved for before."""
    done = run(1, "accuracy/space_neo-hookean_5.palpate", *OF_ACCURACY, example="accuracy")
    assert done.returncode == 0, done.stderr
    # The space contains the coarser one.
    assert {row["grid"] for row in rows_of("accuracy/table.csv")} == {"3³", "5³"}
    done = run(1, *OF_ACCURACY, "--resolutions", "4", example="accuracy")
    assert done.returncode == 1 and done.stderr.startswith("accuracy.py: "), done.stderr


def check_palpation():
    """A part of a coarse liver, on two ranks."""
    done = run(2 if MPIEXEC else 1, SURFACE, "--elements", "150", "--points", "20", "--spacings",
               "0.008", "0.006", "--region", "0.012", "--tolerance", "1", "--output", "palpation",
               example="palpation")
    assert done.returncode == 0, done.stderr
    with open("palpation/table.md", encoding="utf-8") as file:
        text = file.read()
    assert text.strip() in done.stdout, done.stdout
    rows = rows_of("palpation/table.csv")
    error = {(row["space"], row["method"]): float(row["mean (%)"]) for row in rows}
    assert len(rows) == len(error) == 9, rows
    coarse, fine, refined = ("8 mm", "6 mm", "6 mm, 1 %")
    assert 0 < error[fine, "Energy Hermite"] < error[coarse, "Energy Hermite"], error
    assert error[refined, "Energy Hermite"] < 2 and error[refined, "Trilinear"] > 0, error
    configurations = {row["space"]: float(row["configurations"]) for row in rows}
    assert configurations[coarse] < configurations[fine] < configurations[refined], configurations
    off = re.search(r"on the slide the force is off by ([0-9.e-]+) %", text)
    assert off and float(off.group(1)) < 5, text
    slide = rows_of("palpation/slide.csv")
    felt = [float(row["normal (N)"]) for row in slide if row["inside"] == "1"]
    assert len(felt) > 100 and max(felt) > 0.05, (len(felt), max(felt, default=0))
    expect_pictures("palpation", "pressed", "slide", "error_seconds", "error_bytes")


def check_palpation_without_a_law():
    done = run(1, "palpation/scene.vtu", "--laws", "Own", "--output", "palpation",
               example="palpation")
    assert done.returncode == 1 and done.stderr.count("\n") == 1, done.stderr
    assert done.stderr.startswith("palpation.py: the scene has no material"), done.stderr


def check_nodule():
    """A larger nodule in a coarser mesh, on two ranks: its map, and what is noticed."""
    done = run(2 if MPIEXEC else 1, "--output", "nodule", "--size", "0.025", "--below", "0.003",
               "--tool-radius", "0.02", "--region", "0.014", "--spacing", "0.012", "--sizes",
               "0.015", "0.025", "--depths", "0.003", "0.015", example="nodule")
    assert done.returncode == 0, done.stderr
    with open("nodule/table.md", encoding="utf-8") as file:
        text = file.read()
    assert text.strip() in done.stdout, done.stdout
    more = {(float(row["size (mm)"]), float(row["below (mm)"])): float(row["more (%)"])
            for row in rows_of("nodule/table.csv")}
    assert more[25, 3] > 10 > more[25, 15] > more[15, 15] > 0 and more[25, 3] > more[15, 3], more
    where = re.search(r"adds ([0-9.]+) % to the stiffness at the most, ([0-9.]+) mm from", text)
    assert float(where.group(1)) > 8 and float(where.group(2)) < 10, text
    off = re.search(r"the spaces are off by ([0-9.]+) mN of ([0-9.]+) N", text)
    assert float(off.group(1)) < 20 * float(off.group(2)), text
    assert len(rows_of("nodule/slide.csv")) == 200
    expect_pictures("nodule", "slide", "noticed")
    for name in ("map", "of_the_nodule"):
        coloured = (np.ptp(pixels(f"nodule/{name}.png"), axis=1) > 40).mean()
        assert 0.1 < coloured < 0.9, (name, coloured)


def check_a_nodule_too_large():
    done = run(1, "--output", "nodule", "--size", "0.2", example="nodule")
    assert done.returncode == 1 and "nodule.py: " in done.stderr, done.stderr


def save_map(name, shares, kind, matrix):
    """A map (x, y, z) between 0 and 1 as NIfTI: as bytes, or as numbers in which nothing is nan."""
    image = vtkImageData()
    image.SetDimensions(shares.shape)
    image.SetSpacing(VOXEL, VOXEL, VOXEL)
    if kind == "bytes":
        values = np.rint(255 * shares).astype(np.uint8)
    else:
        values = np.where(shares > 0, shares, np.nan).astype(np.float32)
    image.GetPointData().SetScalars(numpy_to_vtk(values.ravel(order="F"), deep=True))
    writer = vtkNIFTIImageWriter()
    writer.SetFileName(name)
    writer.SetInputData(image)
    rows = vtkMatrix4x4()
    rows.DeepCopy(np.ravel(matrix))
    writer.SetSFormMatrix(rows)
    writer.Write()


def save_head():
    """Maps of an egg of grey matter with white matter in it, off its middle to the right, in front
    and below; the first axis of the image points to the left, as that of many scanners does. Gives
    their volumes, m³, and the middles, m."""
    axes = [VOXEL * np.arange(number) for number in (52, 58, 48)]  # mm
    corner = np.array((80.0, -90.0, -60.0))  # of the first voxel in the head, mm
    x, y, z = np.meshgrid(*axes, indexing="ij")
    places = np.stack((corner[0] - x, corner[1] + y, corner[2] + z), axis=-1)

    def within(centre, radii):
        """1 in an ellipsoid, and less and less within a few mm around its surface."""
        away = np.linalg.norm((places - centre) / radii, axis=-1)
        return np.clip(0.5 - (away - 1) * min(radii) / 6, 0, 1)

    (whole, of_whole), (core, of_core) = ((within(*egg), 4e-9 / 3 * math.pi * np.prod(egg[1]))
                                          for egg in (HEAD, CORE))
    matrix = np.diag((-1.0, 1, 1, 1))
    matrix[:3, 3] = corner
    save_map("grey.nii.gz", np.maximum(whole - core, 0), "bytes", matrix)
    save_map("white.nii", core, "numbers", matrix)
    return of_whole - of_core, of_core


def check_brain():
    """Eggs in place of a brain, on two ranks: where they are, how large, and how they are felt."""
    grey, white = save_head()
    done = run(2 if MPIEXEC else 1, *OF_BRAIN, example="brain")
    assert done.returncode == 0, done.stderr
    with open("brain/table.md", encoding="utf-8") as file:
        text = file.read()
    assert text.strip() in done.stdout, done.stdout
    labels = fetch(XMLImageDataReader(FileName=["brain/labels.vti"]))
    core = np.flatnonzero(point_array(labels, "Label") == 2)
    middle = np.mean([labels.GetPoint(i) for i in core], axis=0)
    assert np.allclose(middle, CORE[0], rtol=0, atol=0.2 * VOXEL), middle
    body = fetch(XMLUnstructuredGridReader(FileName=["brain/body.vtu"]))
    cells = vtk_to_numpy(body.GetCells().GetConnectivityArray()).reshape(-1, 10)
    region, corners = cell_array(body, "RegionId"), places(body)[cells[:, :4]]
    volumes = abs(np.linalg.det(corners[:, 1:] - corners[:, :1])) / 6
    for label, volume in ((1, grey), (2, white)):
        of_label = volumes[region == label].sum()
        assert math.isclose(of_label, volume, rel_tol=OF_VOXELS), (label, of_label)
    middle = volumes @ corners.mean(axis=1) / volumes.sum()
    assert np.allclose(1e3 * middle, HEAD[0], rtol=0, atol=OF_WALLS), middle
    rows = [{name: float(value) for name, value in row.items()}
            for row in rows_of("brain/table.csv")]
    assert len(rows) == 5 and all(row["off (% of the largest)"] < OF_SPACE for row in rows), rows
    for row in rows:
        assert row["white alone (N)"] < row["grey and white (N)"] < row["grey alone (N)"], row
    memory = re.search(r"took [0-9]+ s and, rank by rank, ([0-9 and]+) MB", text)
    assert len(memory.group(1).split(" and ")) == (2 if MPIEXEC else 1), text
    expect_pictures("brain", "tissues", "pressed", "slide")


def check_failures_of_brain():
    with open("grey.nii.gz", "rb") as file, open("cut.nii.gz", "wb") as cut:
        cut.write(file.read()[:-1000])
    for arguments, message in (
            (["--grey", "cut.nii.gz", "--white", "white.nii"], "cut.nii.gz cannot be read"),
            (["--grey", "brain/table.md", "--white", "white.nii"], "is no NIfTI image"),
            (["--grey", "grey.nii.gz"], "--grey and --white go together"),
            (["--certain", "100", *OF_BRAIN], "which value stands for certain?")):
        done = run(1, *arguments, example="brain")
        # A machine that is busy may be told that the space takes a while.
        lines = [line for line in done.stderr.splitlines() if line and ": About " not in line]
        assert done.returncode == 1 and lines[-1].startswith("brain.py: "), (arguments, lines)
        assert message in lines[-1], lines


def check_liver_alone():
    check_one_rank()
    check_that_the_file_is_used_again()
    check_failures()


def side_by_side(*checks):
    """Those of one rank each, which leave a core idle alone.
    @returns what they return."""
    with concurrent.futures.ThreadPoolExecutor(2) as cores:
        return [check.result() for check in [cores.submit(check) for check in checks]]


alone = [check_elements, check_liver_alone]
if os.environ.get("PALPATE_SHARED_DATA"):
    alone.append(check_a_surface_that_crosses_itself)
force, *_ = side_by_side(*alone)
if MPIEXEC:
    check_two_ranks()
    check_elements_on_two_ranks(force)
check_roof()
check_accuracy()
check_palpation()
check_nodule()
check_brain()
check_cluster()
side_by_side(check_accuracy_of_a_file, check_palpation_without_a_law, check_a_nodule_too_large,
             check_failures_of_brain, check_failures_of_cluster, check_options_of_the_job)
if MPIEXEC:
    check_the_job()

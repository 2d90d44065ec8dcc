# SPDX-License-Identifier: BSD-3-Clause
"""The accuracy report of a rigid tool's space, on one rank or two: its outputs and its file."""

import glob
import os

import numpy
from accuracy_support import columns, fetch_report, row
from contact_space_support import RADIUS, SPACING, scene, space_of
from paraview import servermanager
from paraview.simple import AccuracyReport, Delete, TouchStateSpace
from support import expect_error, expect_silence, field, places, point_array

RANKS = servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
# m; half of what the other tests have
CELLS = SPACING / 2
WITHOUT_THIRD = "Energy Hermite, no third derivatives"

if RANKS == 1:
    for name in glob.glob("contact_accuracy*.palpate*"):
        os.remove(name)
boundary = scene("contact_accuracy")
space_file = f"contact_accuracy_{RANKS}.palpate"
space = space_of(boundary, FileName=space_file, ThirdDerivatives=1, Spacing=CELLS,
                 SolverTolerance=1e-9)
# The file of the space has room for the test points.
report = AccuracyReport(Input=space, TestPoints=40, Seed=3, FileName=space_file,
                        SolverTolerance=1e-9, LogInterval=0)
methods, points, of_tools = expect_silence(lambda: fetch_report(report))
assert field(methods, "Ranks")[0] == RANKS and field(methods, "Complete")[0] == 1
assert field(methods, "Solved")[0] + field(methods, "Reused")[0] == 40

# Methods that need a box of check-points are left out.
table = columns(methods)
assert set(table["Method"]) == {"Trilinear", "Energy Hermite", WITHOUT_THIRD}, table["Method"]
assert (table["TestPoints"] == 40).all()
assert (table["Counted"] + table["Marked"] + table["Extrapolated"] + table["Irregular"]
        + table["Failed"] == 40).all()
assert numpy.allclose(table["Spacing"], CELLS)
best = row(table, "Energy Hermite", table["Resolution"].max())
assert best["Counted"] > 30 and best["LargestForce"] > 0, best
assert 0 < best["MeanErrorN"] < 0.01 * best["LargestForce"], best
assert best["LoopWork"] < 1e-12 and best["ForceJump"] < 1e-9, best
assert 0 < best["MeanDisplacementError"] <= best["LargestDisplacementError"] < 20, best
trilinear = row(table, "Trilinear", table["Resolution"].max())
assert best["MeanErrorN"] < 0.5 * trilinear["MeanErrorN"]
assert best["Bytes"] > 0 and best["PrecomputeSeconds"] > 0

of_tools = columns(of_tools)
assert (of_tools["ActiveNode"] == -1).all()
assert (of_tools["Tool"] == f"the sphere of radius {RADIUS:g} m").all(), of_tools["Tool"]
chart = columns(servermanager.Fetch(report, idx=3))
assert numpy.nanmin(chart["Energy Hermite"]) == best["MeanError"]

# A point is at the place of the tool. What the space gives there is what is compared.
assert points.GetNumberOfPoints() == 40
assert (places(points) == point_array(points, "Displacement")).all()
assert sorted(set(point_array(points, "Kind"))) == [0, 1, 2]
forces = point_array(points, "Force")
errors = point_array(points, "Error (Energy Hermite)")
counted = point_array(points, "Class") == 0
i = numpy.argmax(numpy.where(counted, numpy.linalg.norm(forces, axis=1), 0))
touch = TouchStateSpace(Input=space, ToolPosition=places(points)[i])
touch.UpdatePipeline()
force = field(servermanager.Fetch(touch, 0), "Force")[0]
error = numpy.linalg.norm(force - forces[i]) / numpy.linalg.norm(forces[i])
assert numpy.isclose(100 * error, errors[i]), (error, errors[i])
# Where the tool begins to touch there is a figure of its own.
begins = point_array(points, "Kind") == 2
assert numpy.isclose(errors[counted & ~begins].mean(), best["MeanError"])
assert numpy.isclose(errors[begins].max(), best["NearRestError"])

if RANKS == 1:
    report.TestPoints = 50
    more = fetch_report(report)[0]
    assert field(more, "Reused")[0] >= 40 - 8 and field(more, "Solved")[0] >= 10
    Delete(report)
    bad = AccuracyReport(Input=space, TestPoints=5, Methods=["Tricubic", "Linear"])
    expect_error(bad.UpdatePipeline, "None of the chosen methods", "'Energy Hermite'")
    Delete(bad)
    # The error of the mesh, against a finer one.
    finer = AccuracyReport(Input=space, TestPoints=6, Methods=["Energy Hermite"],
                           MeasureMeshError=1, LogInterval=0)
    table, tried, _ = expect_silence(lambda: fetch_report(finer))
    found = row(columns(table), "Energy Hermite", best["Resolution"])
    assert 0 < found["MeanMeasuredMeshErrorN"] <= found["LargestMeasuredMeshErrorN"], found
    error = numpy.linalg.norm(point_array(tried, "MeasuredMeshError"), axis=1)
    counted = point_array(tried, "Class") == 0
    assert numpy.isclose(error[counted].max(), found["LargestMeasuredMeshErrorN"])
    assert numpy.isnan(best["MeanMeasuredMeshErrorN"])
    assert points.GetPointData().GetArray("MeasuredMeshError") is None
    Delete(finer)
    # Without a file there are no fields to be shown.
    in_memory = AccuracyReport(Input=space_of(boundary), TestPoints=10, LogInterval=0)
    table = columns(expect_silence(lambda: fetch_report(in_memory))[0])
    assert numpy.isnan(table["MeanDisplacementError"]).all()
else:
    in_memory = AccuracyReport(Input=space, TestPoints=40, Seed=3, SolverTolerance=1e-9)
    again = fetch_report(in_memory)[1]
    assert (point_array(again, "Force") == forces).all()
print("accuracy of a rigid tool's space reported on", RANKS, "ranks")

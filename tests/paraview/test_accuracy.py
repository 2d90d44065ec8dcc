# SPDX-License-Identifier: BSD-3-Clause
"""The accuracy report, on one rank or two: its three outputs, its file, and bad input."""

import numpy
from accuracy_support import TIMES, columns, fetch_report, row
from paraview import servermanager
from paraview.simple import AccuracyReport, Delete, GroupDatasets, Sphere
from state_space_support import precompute
from support import Messages, expect_error, expect_silence, field, node_at, point_array, scene

RANKS = servermanager.vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
METHODS = {"Trilinear", "Tricubic", "RBF linear", "RBF cubic", "Energy Hermite", "Linear"}
VARIANTS = {f"RBF {kind}, no {what}" for kind in ("linear", "cubic")
            for what in ("polynomial", "intermediate states")}
WITHOUT_THIRD = "Energy Hermite, no third derivatives"

boundary = scene("accuracy", quadratic=False)
nodes = sorted((node_at(boundary, [0.2, 0.1, 0.1]), node_at(boundary, [0.2, 0.05, 0.1])))
space = precompute(boundary, nodes, IntermediateStates=1)
report = AccuracyReport(Input=space, TestPoints=40, Seed=2, FileName="points.palpate",
                        SolverTolerance=1e-9, LogInterval=3)
assert (report.TestPoints, report.Seed, report.FileName) == (40, 2, "points.palpate")
assert (report.SolverTolerance, report.LogInterval) == (1e-9, 3)
methods, points, of_nodes = expect_silence(lambda: fetch_report(report))
assert field(methods, "Ranks")[0] == RANKS and field(methods, "Complete")[0] == 1
solved = field(methods, "Solved")[0]
assert solved + field(methods, "Reused")[0] == 80

table = columns(methods)
assert set(table["Method"][table["Resolution"] == 5]) == METHODS | VARIANTS | {WITHOUT_THIRD}
# A coarser grid has no intermediate states.
of_coarser = {f"{method}, no intermediate states" if method.startswith("RBF") else method
              for method in METHODS - {"Linear"}}
assert set(table["Method"][table["Resolution"] == 3]) == of_coarser | {WITHOUT_THIRD}
assert (table["TestPoints"] == 80).all()
assert (table["Counted"] + table["Marked"] + table["Extrapolated"] + table["Irregular"]
        + table["Failed"] == 80).all()
best = row(table, "Energy Hermite", 5)
assert best["Counted"] == 80 and best["Samples"] == 125, best
assert 0 < best["MeanError"] < 0.1 and best["NearRestError"] < 0.1, best
assert best["LoopWork"] <= 1e-12 and best["ForceJump"] <= 1e-12, best
assert 0 < best["EvaluationP50"] <= best["EvaluationP999"], best
assert best["MeanError"] < row(table, WITHOUT_THIRD, 5)["MeanError"]
assert best["MeanError"] < 0.5 * row(table, "Tricubic", 5)["MeanError"]
assert row(table, "Trilinear", 5)["LoopWork"] > 1e-6
assert row(table, "RBF cubic", 5)["Samples"] == 125 + 124
assert row(table, "RBF cubic, no intermediate states", 5)["Samples"] == 125

table_of_nodes = columns(of_nodes)
assert set(table_of_nodes["ActiveNode"]) == set(nodes)
assert set(table_of_nodes["Tool"]) == {f"active node {node}" for node in nodes}
assert len(table_of_nodes["Method"]) == 2 * len(table["Method"])

# The chart: the errors of a method in its own rows, which follow each other.
chart = columns(servermanager.Fetch(report, idx=3))
for method in set(table["Method"]):
    mine = numpy.flatnonzero(~numpy.isnan(chart[method]))
    assert (numpy.diff(mine) == 1).all(), (method, mine)
    for column, name in ((method, "MeanError"), ("Bytes", "Bytes"), ("Time", "EvaluationP50"),
                         ("PrecomputeSeconds", "PrecomputeSeconds")):
        of_table = table[name][table["Method"] == method]
        assert (chart[column][mine] == of_table).all(), (method, column)

assert points.GetNumberOfPoints() == points.GetNumberOfCells() == 80
errors = point_array(points, "Error (Energy Hermite)")
assert numpy.isclose(errors.mean(), best["MeanError"]) and numpy.isclose(
    errors.max(), best["LargestError"])
assert (point_array(points, "Outcome") == 0).all() and (point_array(points, "Class") == 0).all()
assert sorted(set(point_array(points, "Kind"))) == [0, 1, 2]

if RANKS == 1:
    # Some methods alone; the equilibria are in the file.
    assert solved == 80
    report.Methods = ["Energy Hermite", "Trilinear"]
    some = fetch_report(report)[0]
    assert field(some, "Solved")[0] == 0 and field(some, "Reused")[0] == 80
    chosen = columns(some)
    assert set(chosen["Method"]) == {"Energy Hermite", WITHOUT_THIRD, "Trilinear"}
    again = row(chosen, "Energy Hermite", 5)
    for name in best.keys() - TIMES - {"Method"}:
        numpy.testing.assert_equal(again[name], best[name], name)
    Delete(report)

    for settings, words in (({"TestPoints": 0}, ["test points is 0", "at least 1"]),
                            ({"FileName": "no/such/a.palpate"}, ["no/such"]),
                            ({"SolverTolerance": 2}, ["tolerance"]),
                            ({"FileName": "points.palpate", "SolverTolerance": 1e-8},
                             ["points.palpate", "1e-08"])):
        bad = AccuracyReport(Input=space, **{"TestPoints": 5, **settings})
        expect_error(bad.UpdatePipeline, *words)
        Delete(bad)
    # What went wrong before is not said again.
    wrong = precompute(boundary, nodes, Resolution=4)
    with Messages() as messages:
        fetch_report(AccuracyReport(Input=wrong))
    assert messages.errors == 1 and "odd" in messages.text, messages.text
else:
    in_memory = fetch_report(AccuracyReport(Input=space, TestPoints=40, Seed=2))[1]
    assert (point_array(in_memory, "Force") == point_array(points, "Force")).all()
# No rank waits for one that has met an error.
group = GroupDatasets(Input=[Sphere()])
group.OutputType = "vtkPartitionedDataSetCollection"
with Messages() as messages:
    AccuracyReport(Input=group).UpdatePipeline()
# On several ranks ParaView runs a filter again for each of its outputs.
assert 1 <= messages.errors <= (1 if RANKS == 1 else 3), messages.text
assert "no state space" in messages.text, messages.text
print("accuracy reported on", RANKS, "ranks")

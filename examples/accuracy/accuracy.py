# SPDX-License-Identifier: BSD-3-Clause
"""Error against run time: of every way to interpolate a state space, on your scene.

State spaces of several sizes are computed, or one is read. At random places the equilibrium is
solved for exactly, and what each method gives there is compared with it: how wrong, and what it
takes to precompute, to hold and to evaluate.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch accuracy.py
    pvbatch accuracy.py liver.palpate
    pvbatch accuracy.py organ.stl --scale 0.001 --touched 0.01 0.05 0.08 --tip-radius 0.01
    mpiexec -n 4 pvbatch accuracy.py scene.vtu --laws Own --half-width 0.012 --points 2000

A .vtu scene keeps its points `Fixed`; its materials are replaced, but for the law Own. The results
go to the folder `out`: report.md, table.csv, nodes.csv, points_*.vtp, charts and views (.png). What
was solved for is kept in .palpate files there and is not solved for again.
"""
import os
import re
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import (SLACK, add_box_arguments, add_scene_arguments, corners_of, on_surface, places,
                    read_scene, save_body)
from charts import Curve, chart
from materials import OWN, add_law_arguments, check_laws, scene_of
from pipeline import Failure, field, output, save_surface, update
from script import Arguments, run
from tables import markdown, save_csv, vtk_table
from vtkmodules.util.numpy_support import vtk_to_numpy
from where import Where

COUNTED = 0
# What a hand notices, % (just noticeable difference of forces).
NOTICED = 10
COLUMNS = {"law": "s", "method": "s", "grid": "s", "states": ".0f", "precompute (s)": ".3g",
           "evaluate (ns)": ".0f", "99.9 % (ns)": ".0f", "kB": ".3g", "mean (%)": ".2g",
           "99 % (%)": ".2g", "largest (%)": ".2g", "largest (N)": ".2g", "noticed (%)": ".2g",
           "near rest (%)": ".2g", "stiffness (%)": ".2g", "surface (%)": ".2g",
           "marked (%)": ".2g", "loop work": ".0e", "force jump": ".0e", "stiffness jump": ".0e",
           "set up (s)": ".2g"}
# Of the columns of Accuracy Report.
SAME = {"states": "Samples", "precompute (s)": "PrecomputeSeconds", 
        "evaluate (ns)": "EvaluationP50", "99.9 % (ns)": "EvaluationP999", "mean (%)": "MeanError",
        "99 % (%)": "P99Error",
        "largest (%)": "LargestError", "largest (N)": "LargestErrorN", "noticed (%)": "Noticeable",
        "near rest (%)": "NearRestError", "stiffness (%)": "MeanStiffnessError",
        "surface (%)": "MeanDisplacementError", "marked (%)": "MeanMarkedError",
        "loop work": "LoopWork", "force jump": "ForceJump", "stiffness jump": "StiffnessJump",
        "set up (s)": "SetupSeconds"}
POINTS = ("TestPoints", "Counted", "Marked", "Extrapolated", "Irregular", "Failed")


def arguments():
    parser = Arguments("accuracy.py", __doc__.splitlines()[0])
    add_scene_arguments(parser)
    add_law_arguments(parser, ["Neo-Hookean"])
    add_box_arguments(parser)
    parser.add_argument("--resolutions", type=int, nargs="+", default=[3, 5, 7],
                        help="points along an axis, of each space")
    parser.add_argument("--intermediate-states", type=int, default=5,
                        help="on the way to each configuration, for the RBF methods")
    parser.add_argument("--no-third-derivatives", action="store_true",
                        help="leave them out of the configurations")
    parser.add_argument("--active-nodes", type=int, nargs="+", help="points that are touched; by "
                        "default the one nearest to --touched")
    parser.add_argument("--nodes", type=int, help="touch as many points instead, spread over the "
                        "surface away from where it is held")
    parser.add_argument("--points", type=int, default=500, help="test points a touched point")
    parser.add_argument("--seed", type=int, default=1, help="of the test points")
    return parser


def spread(grid, count, away):
    """As many touchable corners on the surface as far from each other as they can be, no nearer to
    what is held than `away` m."""
    points = places(grid)
    held = vtk_to_numpy(grid.GetPointData().GetArray("Fixed")) != 0
    candidate = np.zeros(len(points), bool)
    candidate[corners_of(grid)] = True
    candidate &= on_surface(grid) & ~held
    if grid.GetPointData().HasArray("Touchable"):
        candidate &= vtk_to_numpy(grid.GetPointData().GetArray("Touchable")) != 0
    for point in np.flatnonzero(candidate):
        candidate[point] = np.linalg.norm(points[held] - points[point], axis=1).min() > away
    candidates = np.flatnonzero(candidate)
    if len(candidates) < count:
        raise Failure(f"only {len(candidates)} points are free and no nearer than {away:g} m to "
                      "what is held.")
    chosen = [candidates[np.linalg.norm(points[candidates] - points[held].mean(axis=0),
                                        axis=1).argmax()]]
    while len(chosen) < count:
        apart = np.min([np.linalg.norm(points[candidates] - points[c], axis=1) for c in chosen],
                       axis=0)
        chosen.append(candidates[apart.argmax()])
    return sorted(map(int, chosen))


class Report:
    """The figures of one space: rows of the table and of the active nodes, and the test points."""

    def __init__(self, law, space, whole_grid_only, args):
        report = AccuracyReport(Input=space, TestPoints=args.points, Seed=args.seed,
                                FileName=os.path.join(args.output, f"exact_{slug(law)}.palpate"))
        update(report)
        self.table = servermanager.Fetch(report)
        self.points = servermanager.Fetch(report, idx=1)
        self.nodes = servermanager.Fetch(report, idx=2)
        self.law = law
        self.rows = self.rows_of(self.table)
        self.rows_of_nodes = self.rows_of(self.nodes)
        resolution = max(row["points an axis"] for row in self.rows)
        if whole_grid_only:
            self.rows, self.rows_of_nodes = (
                [row for row in rows if row["points an axis"] == resolution]
                for rows in (self.rows, self.rows_of_nodes))
        seconds = {name: field(self.table, name)[0]
                   for name in ("ExactSeconds", "MeasureSeconds", "SolveSeconds", "Reused")}
        row = self.rows[0]
        counts = {name: int(row[name]) for name in POINTS}
        self.line = (f"{law}, {row['grid']}: {counts['TestPoints']} test points, of which "
                     f"{counts['Counted']} count, {counts['Marked']} are in marked regions, "
                     f"{counts['Extrapolated']} beyond the configurations, {counts['Irregular']} "
                     f"not regular and {counts['Failed']} not found; {seconds['Reused']:.0f} were "
                     f"known, the others took {seconds['ExactSeconds']:.3g} s "
                     f"({1e3 * seconds['SolveSeconds']:.3g} ms each on one core), the measurements "
                     f"{seconds['MeasureSeconds']:.3g} s")
        Delete(report)

    def rows_of(self, table):
        rows = []
        for i in range(table.GetNumberOfRows()):
            def value(name, row=i):
                return table.GetColumnByName(name).GetValue(row)

            resolution = value("Resolution")
            row = {"law": self.law, "method": value("Method"), "grid": f"{resolution}³",
                   "points an axis": resolution, "kB": value("Bytes") / 1e3,
                   **{name: value(of) for name, of in SAME.items()},
                   **{name: value(name) for name in POINTS}}
            if table.GetColumnByName("ActiveNode"):
                row["active node"] = value("ActiveNode")
            rows.append(row)
        return rows

    def errors(self, method):
        """Relative errors at the points that count, %."""
        array = self.points.GetPointData().GetArray(f"Error ({method})")
        counted = vtk_to_numpy(self.points.GetPointData().GetArray("Class")) == COUNTED
        return vtk_to_numpy(array)[counted]


def slug(law):
    return re.sub(r"[^a-z]+", "-", law.lower()).strip("-")


def spaces_of(args):
    """Tuples: the law, the scene, a state space, and whether it is one of several sizes."""
    if args.scene and args.scene.endswith(".palpate"):
        os.makedirs(args.output, exist_ok=True)
        space = update(StateSpaceReader(FileName=args.scene))
        yield OWN, space, False
        return
    grid, node, organ = read_scene(args)
    check_laws(grid, args)
    half_width = args.half_width or 0.06 * organ.size
    nodes = args.active_nodes or [node]
    if args.nodes:
        nodes = spread(grid, args.nodes, 1.1 * organ.tip_radius)
    body = save_body(grid, os.path.join(args.output, "scene.vtu"))
    for law in args.laws:
        scene = scene_of(body, law, args)
        for resolution in sorted(args.resolutions):
            space = update(PrecomputeStateSpace(
                Input=scene, ActiveNodes=nodes, HalfWidth=half_width, Resolution=resolution,
                ForceLimit=args.force_limit, TipRadius=organ.tip_radius * SLACK,
                IntermediateStates=args.intermediate_states,
                ThirdDerivatives=int(not args.no_third_derivatives),
                FileName=os.path.join(args.output, f"space_{slug(law)}_{resolution}.palpate")))
            yield law, space, True
            Delete(space)
        if law != OWN:
            Delete(scene)


def remarks(rows):
    """In lines: what a hand notices, and what the best method is better by."""
    lines = []
    for law in dict.fromkeys(row["law"] for row in rows):
        finest = max(row["points an axis"] for row in rows if row["law"] == law)
        of_law = [row for row in rows if row["law"] == law and row["points an axis"] == finest
                  and row["mean (%)"] == row["mean (%)"]]
        if not of_law:
            lines.append(f"{law}: no test point counts, the whole box is marked.")
            continue
        noticed = [f"{row['method']} {row['noticed (%)']:.2g} %" for row in of_law
                   if row["noticed (%)"] > 0]
        told = ("Share of the test points that are off by more: " + ", ".join(noticed) + "."
                if noticed else "No method is off by more at any test point that counts.")
        lines.append(f"{law}, {finest}³: a hand notices a difference of forces of about "
                     f"{NOTICED} %. {told}")
        best = min(of_law, key=lambda row: row["mean (%)"])
        others = [row for row in of_law
                  if row["method"].split(",")[0] != best["method"].split(",")[0]]
        if others:
            second = min(others, key=lambda row: row["mean (%)"])
            lines.append(f"{law}, {finest}³: {best['method']} has the least mean error, "
                         f"{best['mean (%)']:.2g} %, {second['mean (%)'] / best['mean (%)']:.3g} "
                         f"times less than {second['method']} ({second['mean (%)']:.2g} %).")
    return lines


def draw(rows, reports, args):
    """Charts of each law, and where the errors of the finest space sit; their names and titles."""
    pictures = []

    def add(name, title):
        pictures.append((name, title))
        return os.path.join(args.output, name + ".png")

    for law in dict.fromkeys(row["law"] for row in rows):
        finest = [report for report in reports if report.law == law][-1]
        points = finest.points
        names = [points.GetPointData().GetArrayName(i)[len("Error ("):-1]
                 for i in range(points.GetPointData().GetNumberOfArrays())
                 if points.GetPointData().GetArrayName(i).startswith("Error (")]
        where = Where(finest.space_body, points)
        for method in ("Energy Hermite", "RBF cubic", "Trilinear"):
            if method in names:
                path = add(f"where_{slug(law)}_{slug(method)}", f"{law}, {method}: error, %")
                where.save(f"Error ({method})", path)
        where.end()
        for x, title, name in (("precompute (s)", "precomputation on one core (s)", "seconds"),
                               ("evaluate (ns)", "one evaluation (ns)", "nanoseconds"),
                               ("kB", "memory (kB)", "bytes")):
            curves = []
            for number, method in enumerate(names):
                found = [(row[x], row["mean (%)"]) for row in rows if row["law"] == law
                         and row["method"] == method and row[x] > 0 and row["mean (%)"] > 0]
                # The stiffness at rest does not depend on the grid.
                found = found[-1:] if method == "Linear" else found
                if found:
                    curves.append(Curve(method, found, number, 1))
            if curves:
                ends = [point[0] for curve in curves for point in curve.points]
                curves.append(Curve("what a hand notices",
                                    [(np.min(ends), NOTICED), (np.max(ends), NOTICED)], 7, 0))
                chart(f"{law}: mean error of the force", title, "relative error (%)", curves,
                      add(f"error_{name}_{slug(law)}", f"{law}: error against {title}"))
        curves = []
        for number, method in enumerate(names):
            errors = np.sort(finest.errors(method))
            shown = (np.unique(np.linspace(0, len(errors) - 1, 60).astype(int))
                     if len(errors) else [])
            found = [(errors[i], 100 * (1 - i / len(errors))) for i in shown if errors[i] > 0]
            if found:
                curves.append(Curve(method, found, number, 1))
        if curves:
            chart(f"{law}: distribution of the error", "relative error (%)",
                  "share of test points that are worse (%)", curves,
                  add(f"distribution_{slug(law)}", f"{law}: distribution of the error"))
    return pictures


def main():
    args = arguments().read()
    if args is None:
        return
    if args.points < 1 or any(count < 3 or count % 2 == 0 for count in args.resolutions):
        raise Failure("--points must be at least 1, and --resolutions odd numbers from 3.")
    reports = []
    for law, space, one_of_several in spaces_of(args):
        report = Report(law, space, one_of_several, args)
        report.space_body = servermanager.Fetch(space, 0).GetPartition(1, 0)
        print(report.line, flush=True)
        per_axis = report.rows[0]["points an axis"]
        path = os.path.join(args.output, f"points_{slug(law)}_{per_axis}.vtp")
        save_surface(report.points, path)
        reports.append(report)
    rows = [row for report in reports for row in report.rows]
    nodes = [row for report in reports for row in report.rows_of_nodes]
    extra = {name: "g" for name in POINTS}
    save_csv(vtk_table(rows, {**COLUMNS, **extra}), os.path.join(args.output, "table.csv"))
    save_csv(vtk_table(nodes, {"active node": "g", **COLUMNS, **extra}),
             os.path.join(args.output, "nodes.csv"))
    lines = [*remarks(rows), *(report.line for report in reports)]
    pictures = []
    if os.environ.get("DISPLAY"):
        pictures = draw(rows, reports, args)
    else:
        print("accuracy.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
    text = "\n\n".join(["# Error against run time", markdown(rows, COLUMNS),
                        "\n".join(f"- {line}" for line in lines),
                        *(f"![{title}]({name}.png)" for name, title in pictures)])
    with open(os.path.join(args.output, "report.md"), "w", encoding="utf-8") as file:
        file.write(text + "\n")
    print(text, flush=True)


if __name__ == "__main__":
    run("accuracy.py", main)

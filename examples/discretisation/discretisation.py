# SPDX-License-Identifier: BSD-3-Clause
"""Error against run time, with the error of the mesh: divided everywhere, divided where it is
needed, and corrected by the estimate of its error.

A ball presses each organ. The force on coarse and on finer meshes is compared with that on a mesh
that is much finer where the ball presses. Which order of cells to choose: elements.py.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvpython discretisation.py
    pvpython discretisation.py organ.stl --scale 0.001 --touched 0.01 0.05 0.08 --tip-radius 0.01
    pvpython discretisation.py liver.vtu brain.vtu --tolerances 0.1 0.05 --reference 0.02

The results go to the folder `out`: table.csv, table.md, and a chart for each organ (.png).
"""
import argparse
import os
import sys
import time

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import add_scene_arguments, places, read_scene, save_body
from charts import Curve, chart
from materials import assign
from pipeline import Failure, field, output, update
from pressing import outwards
from script import Arguments, run
from tables import OUTCOMES, markdown, save_table

EVERYWHERE, NEEDED, COARSE = "everywhere", "where needed", "nowhere"
COLUMNS = {"organ": "s", "divided": "s", "cells": ".0f", "unknowns": ".0f", "mesh (s)": ".2g",
           "solve (s)": ".2g", "estimate (s)": ".2g", "force (N)": ".4g", "error (mN)": ".2g",
           "told (mN)": ".2g", "left (mN)": ".2g", "error (%)": ".2g", "left (%)": ".2g"}
# The curves of a chart: their name, which meshes, and the column of their error.
CURVES = (("divided everywhere", EVERYWHERE, "error"),
          ("divided everywhere, corrected", EVERYWHERE, "left"),
          ("divided where needed", NEEDED, "error"),
          ("divided where needed, corrected", NEEDED, "left"))
MOST_CELLS = 10 ** 6


def arguments():
    parser = Arguments("discretisation.py", __doc__.splitlines()[0])
    add_scene_arguments(parser)
    parser.add_argument("organs", nargs="*", help="more scenes or surfaces like the first")
    parser.set_defaults(elements=1000)
    parser.add_argument("--young", type=float, default=5e3,
                        help="Young's modulus of a scene without a material, Pa")
    parser.add_argument("--poisson", type=float, default=0.4, help="its Poisson's ratio")
    parser.add_argument("--depth", type=float, default=0.8,
                        help="how deep it presses, as a share of its radius")
    parser.add_argument("--tolerances", type=float, nargs="+", default=[0.1, 0.05, 0.025, 0.012],
                        help="of the meshes that are divided where it is needed, largest first")
    parser.add_argument("--divisions", type=int, default=2,
                        help="how often all cells are divided")
    parser.add_argument("--reference", type=float, default=0.006,
                        help="tolerance of the mesh whose corrected force is the reference")
    parser.add_argument("--wanted", type=float, nargs="+", default=[5, 2, 1],
                        help="errors to reach, %% of the force")
    return parser


class Press:
    """A ball that presses an organ at one place."""

    def __init__(self, path, args):
        """path: a scene or a surface; None: a liver."""
        of_organ = argparse.Namespace(**{**vars(args), "scene": path})
        grid, self.node, organ = read_scene(of_organ)
        self.name = os.path.splitext(os.path.basename(path))[0] if path else "liver"
        self.radius = organ.tip_radius
        self.depth = args.depth * self.radius
        self.place = places(grid)[self.node] + (self.radius - self.depth) * outwards(organ)
        body = save_body(grid, os.path.join(args.output, f"organ_{self.name}.vtu"))
        self.scene = (body if grid.GetCellData().HasArray("Law") else
                      assign(body, "Neo-Hookean", args.young, args.poisson))

    def refined(self, tolerance):
        """The scene on a mesh that is divided where it is needed, and the seconds for it."""
        refine = RefineMesh(Input=self.scene, ActiveNodes=[self.node], Tool="Sphere",
                            Depth=self.depth, MeshTolerance=tolerance, MaximumCells=MOST_CELLS)
        refine.Tool.Radius = self.radius
        return timed(refine)

    def solved(self, scene, estimate):
        """The equilibrium and its seconds."""
        solve = SolveEquilibrium(Input=scene, Tool="Sphere", ToolPosition=list(self.place),
                                 EstimateMeshError=int(estimate))
        solve.Tool.Radius = self.radius
        solve, seconds = timed(solve)
        grid = output(solve)
        outcome = field(grid, "Outcome")[0]
        if outcome != 0:
            raise Failure(f"{self.name}: {OUTCOMES[outcome]} on a mesh of "
                          f"{grid.GetNumberOfCells()} cells. Press less (--depth).")
        return solve, grid, seconds

    def row(self, scene, divided, mesh_seconds):
        plain, _, seconds = self.solved(scene, False)
        Delete(plain)
        solve, grid, with_estimate = self.solved(scene, True)
        force, error = (np.array(field(grid, name)) for name in ("ReactionForce", "MeshError"))
        # Palpate takes an estimate off a force only where it can be trusted.
        is_reliable = field(grid, "MeshErrorReliable")[0] == 1
        row = {"organ": self.name, "divided": divided, "cells": grid.GetNumberOfCells(),
               "unknowns": field(grid, "Unknowns")[0], "mesh (s)": mesh_seconds,
               "solve (s)": seconds, "estimate (s)": max(0, with_estimate - seconds),
               "force": force, "corrected": force - is_reliable * error,
               "is reliable": is_reliable,
               "force (N)": np.linalg.norm(force), "told (mN)": 1e3 * np.linalg.norm(error)}
        print(f"{self.name}, {row['cells']} cells, divided {divided}: {row['force (N)']:.4g} N, "
              f"{with_estimate:.2g} s", flush=True)
        Delete(solve)
        return row


def timed(proxy):
    start = time.process_time()
    update(proxy)
    return proxy, time.process_time() - start


def measure(press, args):
    """The rows of an organ, and a line about the reference."""
    rows = [press.row(press.scene, COARSE, 0.0)]
    scene, made = press.scene, []
    for _ in range(args.divisions):
        scene, seconds = timed(RefineMesh(Input=scene, Divide="All Cells",
                                          MaximumCells=MOST_CELLS))
        made.append(scene)
        rows.append(press.row(scene, EVERYWHERE, seconds))
    for tolerance in args.tolerances:
        scene, seconds = press.refined(tolerance)
        made.append(scene)
        rows.append(press.row(scene, NEEDED, seconds))
    scene, _ = press.refined(args.reference)
    made.append(scene)
    reference = press.row(scene, NEEDED, 0.0)
    for proxy in made[::-1]:
        Delete(proxy)
    size = np.linalg.norm(reference["corrected"])
    for row in rows:
        for name, of in (("error", "force"), ("left", "corrected")):
            error = np.linalg.norm(row[of] - reference["corrected"])
            row[f"{name} (mN)"], row[f"{name} (%)"] = 1e3 * error, 100 * error / size
    told = 0.1 * reference["told (mN)"] / size
    return rows, size, (
        f"{press.name}: the reference has {reference['cells']} cells and a force of {size:.4g} N, "
        f"with an estimated error of {told:.2g} % "
        f"{'taken off' if reference['is reliable'] else 'that is not reliable, and not taken off'}"
        f". The ball has {1e3 * press.radius:.3g} mm and presses by {1e3 * press.depth:.3g} mm.")


def of_curve(rows, divided, name):
    """The rows of a curve, the finest first; and their seconds and errors, %."""
    chosen = sorted((row for row in rows if row["divided"] in (divided, COARSE)),
                    key=lambda row: -row["cells"])
    return [(row, row["solve (s)"] + (row["estimate (s)"] if name == "left" else 0),
             row[f"{name} (%)"]) for row in chosen]


def seconds_to(rows, size, wanted):
    """A row for each wanted error (%), with the seconds of the cheapest mesh that has it, as all
    finer ones of its kind have, so that it has it not by chance."""
    table = []
    for error in wanted:
        table.append({"organ": rows[0]["organ"], "error (%)": error,
                      "error (mN)": 10 * error * size})
        for title, divided, name in CURVES:
            best = None
            for row, seconds, has in of_curve(rows, divided, name):
                if has > error:
                    break
                best = f"{seconds:.2g} s ({row['unknowns']:.0f})"
            table[-1][title] = best or "not reached"
    return table


def draw(rows, path):
    curves = []
    for number, (title, divided, name) in enumerate(CURVES):
        points = [(seconds, error) for _, seconds, error in of_curve(rows, divided, name)]
        curves.append(Curve(title, points, number // 2, 1 if name == "error" else 0))
    chart(f"{rows[0]['organ']}: error of the force", "seconds of an equilibrium", "error (%)",
          curves, path)


def main():
    args = arguments().read()
    if args is None:
        return
    if args.touched and args.organs:
        raise Failure("--touched is a place of one organ: give one.")
    rows, remarks, found = [], [], []
    for path in [args.scene, *args.organs]:
        of_organ, size, remark = measure(Press(path, args), args)
        rows += of_organ
        remarks.append(remark)
        found += seconds_to(of_organ, size, args.wanted)
        if os.environ.get("DISPLAY"):
            name = of_organ[0]["organ"]
            draw(of_organ, os.path.join(args.output, f"error_seconds_{name}.png"))
    if not os.environ.get("DISPLAY"):
        print("discretisation.py: no charts, there is no display (xvfb-run -a gives one).",
              flush=True)
    columns = {"organ": "s", "error (%)": ".2g", "error (mN)": ".3g",
               **{title: "s" for title, _, _ in CURVES}}
    reached = ("Seconds of an equilibrium (and its unknowns) until the error is as small:\n\n"
               + markdown(found, columns))
    save_table(rows, COLUMNS, remarks, args.output, reached)


if __name__ == "__main__":
    run("discretisation.py", main)

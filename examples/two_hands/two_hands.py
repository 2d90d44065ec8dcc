# SPDX-License-Identifier: BSD-3-Clause
"""Two hands: two tools grasp a lobe, pull it and let it go, by reduced models of several sizes.

Each model is beside the whole body at places and on paths that it was not made from, on the grasp
within what it has learnt, and on one that goes beyond: error against run time.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch two_hands.py
    pvbatch two_hands.py --modes 40 90 --elements 1000
    pvbatch two_hands.py organ.stl --scale 0.001 --viscous-time 0.03

A .vtu scene keeps its points `Fixed`; with --laws Own it keeps its material, density and viscosity
too. The results go to the folder `out`: table.md, table.csv, the path and the pictures (.png).
"""
import os
import sys
import time

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import places, read_scene
from charts import LINE, MARKS, Curve, chart
from moving import (CASES, add_motion_arguments, check_motion, columns_of, draw_motion, model_of,
                    moving_body, off, path_of, second_node, step_times)
from pictures import Stage
from pipeline import update
from script import Arguments, run
from tables import save_table

COLUMNS = {"modes": ".0f", "points": ".0f", "build (s)": ".0f", "step (ms)": ".2f",
           "99.9 % (ms)": ".2f", **{title: ".2g" for title in CASES}, "grasp, rms (%)": ".2g",
           "grasp (%)": ".2g", "beyond (%)": ".2g", "trust, beyond": ".1f"}
# Of the grasp, s: the tools have come together, have pulled, let go, and the end.
TOGETHER, PULLED, RELEASE, END = 0.15, 0.4, 0.6, 1.2
# Ways along the line between the tools and outwards, as shares of the reach.
SQUEEZE, PULL = 0.3, 0.8
# How much farther the tools go where they leave what the models have learnt.
BEYOND = 2.5
# In the chart of the forces every so many steps have a mark.
MARKED = 20


def arguments():
    parser = Arguments("two_hands.py", __doc__.splitlines()[0])
    add_motion_arguments(parser)
    parser.add_argument("--modes", type=int, nargs="+", default=[30, 60, 90],
                        help="of a model each")
    parser.add_argument("--apart", type=float, help="of the tools, m; by default a quarter of the "
                        "longest side")
    return parser


def grasp(grid, nodes, organ, factor, name, args):
    """The path of the two tools, `factor` times as far as the models have learnt."""
    between = places(grid)[nodes[1]] - places(grid)[nodes[0]]
    between /= np.linalg.norm(between)
    squeeze = SQUEEZE * factor * args.reach * between
    pull = PULL * factor * args.reach * organ.normal
    times = np.array([0, TOGETHER, PULLED, RELEASE, END])
    held = np.array([1, 1, 1, 0, 0])
    ways = [np.array([0 * pull] + [sign * squeeze] + 3 * [sign * squeeze + pull])
            for sign in (1, -1)]
    return path_of(name, times, ways, (held, held), args)


def main():
    args = arguments().read()
    if args is None:
        return
    grid, node, organ = read_scene(args)
    check_motion(args, grid, organ)
    body = moving_body(grid, args)
    nodes = [node, second_node(grid, node, organ, args.apart or 0.25 * organ.size)]
    motion = {"EndTime": END, "TimeStep": args.time_step}
    paths, whole = {}, {}
    for name, factor in (("grasp", 1), ("beyond", BEYOND)):
        paths[name] = grasp(grid, nodes, organ, factor, name, args)
        start = time.perf_counter()
        solved = update(SolveDynamics(Input=body, ToolPaths=paths[name], ActiveNodes=nodes,
                                      TipRadius=organ.tip_radius, **motion))
        whole[name] = columns_of(solved, 1)
        seconds = time.perf_counter() - start
        steps = len(whole[name]["Time"]) - 1
        print(f"{name}: the whole body takes {1e3 * seconds / steps:.3g} ms a step", flush=True)
        Delete(solved)
    rows = []
    for modes in sorted(args.modes):
        start = time.perf_counter()
        model, row = model_of(body, nodes, modes, organ, args)
        row["build (s)"] = time.perf_counter() - start
        for name in paths:
            touch = update(SimulateTouch(Input=model, ToolPaths=paths[name], **motion))
            touched = columns_of(touch, 1)
            rms, largest = off(touched, whole[name])
            if name == "grasp":
                row["step (ms)"], row["99.9 % (ms)"] = step_times(touched)
                row["grasp, rms (%)"], row["grasp (%)"] = rms, largest
                shown, felt = touch, touched
            else:
                row["beyond (%)"], row["trust, beyond"] = largest, touched["Trust"].max()
        rows.append(row)
        print(", ".join(f"{title} {row[title]:{form}}" for title, form in COLUMNS.items()
                        if title in row), flush=True)
    largest = np.linalg.norm(whole["grasp"]["Force0"], axis=1).max()
    save_table(rows, COLUMNS, [f"The tools are {1e3 * args.reach:.3g} mm from rest at the most in "
                               f"training; the largest force of the grasp is {largest:.3g} N; a "
                               f"step of the whole body takes {1e3 * seconds / steps:.3g} ms."],
               args.output)
    if not os.environ.get("DISPLAY"):
        print("two_hands.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return

    def path(name):
        return os.path.join(args.output, name + ".png")

    stage = Stage(body)
    for name, moment, what in (("grasped", TOGETHER, "Grasped"), ("pulled", PULLED, "Pulled"),
                               ("let_go", RELEASE + 0.15, "0.15 s after it was let go")):
        draw_motion(stage, shown, nodes, moment, what, path(name))
    curves = []
    for colour, title in enumerate((*CASES, "grasp (%)", "beyond (%)")):
        found = [(row["step (ms)"], row[title]) for row in rows if row.get(title, 0) > 0]
        if found:
            curves.append(Curve(title[:-4], found, colour, 1))
    chart("Error of the force against what a step takes", "half of the steps (ms)",
          "% of the largest force", curves, path("error_steps"))
    curves = []
    for tool in (0, 1):
        for name, history, style, every in (("whole body", whole["grasp"], MARKS, MARKED),
                                            ("reduced", felt, LINE, 1)):
            force = np.linalg.norm(history[f"Force{tool}"], axis=1)
            curves.append(Curve(f"tool {tool}, {name}",
                                list(zip(history["Time"][::every], force[::every])), tool, style))
    chart("Grasp, pull, let go", "time (s)", "force on the tool (N)", curves, path("forces"),
          logarithmic=(False, False))


if __name__ == "__main__":
    run("two_hands.py", main)

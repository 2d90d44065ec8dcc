# SPDX-License-Identifier: BSD-3-Clause
"""Wobble: an organ that is tapped, pulled and let go, with more and less viscosity.

For each viscosity a reduced model is beside the whole body on the same path, and the swinging after
the tool has let go is told: how often, and how soon it is gone.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch wobble.py
    pvbatch wobble.py --viscous-times 0.002 0.02 --elements 1000
    pvbatch wobble.py organ.stl --scale 0.001 --young 3000

A .vtu scene keeps its points `Fixed`. The results go to the folder `out`: table.md, table.csv,
motion.csv, the path and the pictures (.png).
"""
import os
import sys
import time

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import read_scene
from charts import LINE, MARKS, Curve, chart
from moving import (CASES, add_motion_arguments, check_motion, columns_of, draw_motion, model_of,
                    moving_body, off, path_of, step_times)
from pictures import Stage
from pipeline import Failure, update
from script import Arguments, run
from tables import save_csv, save_table, vtk_table

COLUMNS = {"viscous time (ms)": ".3g", "swings (1/s)": ".2g", "gone after (s)": ".2g",
           "modes": ".0f", "points": ".0f", "build (s)": ".0f", "step (ms)": ".2f",
           "99.9 % (ms)": ".2f", **{title: ".2g" for title in CASES if title != "all tools (%)"},
           "this path, rms (%)": ".2g", "this path (%)": ".2g"}
# Of the path, s: how long a tap takes, when the pull begins, is complete and is let go, the end.
TAP, BEGIN, PULLED, RELEASE, END = 0.05, 0.3, 0.5, 0.7, 2.5
# Of the reach: depth of the tap, and how far it is pulled.
DEPTH, PULL = 0.4, 0.8
# What counts as gone, of the place where it was let go.
GONE = 0.05
# In the chart every so many steps have a mark.
MARKED = 25


def arguments():
    parser = Arguments("wobble.py", __doc__.splitlines()[0])
    add_motion_arguments(parser)
    parser.add_argument("--viscous-times", type=float, nargs="+", default=[0.003, 0.01, 0.03],
                        help="s, of a body each")
    parser.add_argument("--modes", type=int, default=60, help="of each model")
    return parser


def tapped_and_pulled(organ, args):
    """A tap into the body, a pull out of it, and the tool lets go."""
    times = np.array([0, TAP / 2, TAP, BEGIN, PULLED, RELEASE, END])
    along = args.reach * np.array([0, -DEPTH, 0, 0, PULL, PULL, PULL])
    return path_of("path", times, [along[:, None] * organ.normal],
                   [np.array([1, 1, 1, 1, 1, 0, 0])], args)


def swinging(history, normal):
    """Swings in a second, and how long it takes until they are gone, s, after the release."""
    after = history["Time"] > RELEASE
    time, place = history["Time"][after] - RELEASE, history["Position0"][after] @ normal
    through = np.flatnonzero(np.diff(np.sign(place)))
    half = np.diff(time[through]).mean() if len(through) > 1 else np.nan
    far = np.flatnonzero(np.abs(place) > GONE * np.abs(place[0]))
    gone = time[far[-1]] if len(far) and far[-1] + 1 < len(time) else np.nan
    return 1 / (2 * half), gone


def main():
    args = arguments().read()
    if args is None:
        return
    grid, node, organ = read_scene(args)
    check_motion(args, grid, organ)
    if args.laws == ["Own"]:
        raise Failure("the viscosity is what this example changes: --laws takes no Own here.")
    paths = tapped_and_pulled(organ, args)
    motion = {"ToolPaths": paths, "EndTime": END, "TimeStep": args.time_step}
    rows, histories = [], {}
    for viscous in sorted(args.viscous_times):
        body = moving_body(grid, args, viscous)
        whole = columns_of(update(SolveDynamics(Input=body, ActiveNodes=[node],
                                                TipRadius=organ.tip_radius, **motion)), 1)
        start = time.perf_counter()
        model, row = model_of(body, [node], args.modes, organ, args)
        row["build (s)"] = time.perf_counter() - start
        touch = update(SimulateTouch(Input=model, **motion))
        felt = columns_of(touch, 1)
        row["step (ms)"], row["99.9 % (ms)"] = step_times(felt)
        row["this path, rms (%)"], row["this path (%)"] = off(felt, whole)
        row["viscous time (ms)"] = 1e3 * viscous
        row["swings (1/s)"], row["gone after (s)"] = swinging(whole, organ.normal)
        rows.append(row)
        histories[viscous] = (whole, felt, touch)
        print(", ".join(f"{title} {row[title]:{form}}" for title, form in COLUMNS.items()
                        if title in row), flush=True)
    save_table(rows, COLUMNS, [], args.output)
    save_csv(vtk_table([{"viscous time (s)": viscous, "time (s)": moment, "way (mm)": 1e3 * way}
                        for viscous, (_, felt, _) in histories.items()
                        for moment, way in zip(felt["Time"], felt["Position0"] @ organ.normal)],
                       ("viscous time (s)", "time (s)", "way (mm)")),
             os.path.join(args.output, "motion.csv"))
    if not os.environ.get("DISPLAY"):
        print("wobble.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return

    def path(name):
        return os.path.join(args.output, name + ".png")

    curves = []
    for number, (viscous, (whole, felt, _)) in enumerate(histories.items()):
        for name, history, style, every in (("whole body", whole, MARKS, MARKED),
                                            ("reduced", felt, LINE, 1)):
            way = 1e3 * (history["Position0"] @ organ.normal)
            curves.append(Curve(f"{1e3 * viscous:g} ms, {name}",
                                list(zip(history["Time"][::every], way[::every])), number, style))
    chart("Tapped, pulled and let go", "time (s)", "way of the touched place (mm)", curves,
          path("motion"), logarithmic=(False, False))
    stage = Stage(body)
    touch = histories[min(histories)][2]
    for name, moment, what in (("pulled", PULLED, "Pulled"),
                               ("swung", RELEASE + 0.2, "0.2 s after it was let go")):
        draw_motion(stage, touch, [node], moment, what, path(name))


if __name__ == "__main__":
    run("wobble.py", main)

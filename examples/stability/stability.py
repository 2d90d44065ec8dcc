# SPDX-License-Identifier: BSD-3-Clause
"""Stability on a scene of your own: what happens when it is stiff, soft or moved very far?

One body is given each law, several Poisson's ratios and a region that is stiffer by several
factors, and is moved by several distances, in one step and in many. Every solve ends converged or
says why not; the matrix shows where the scene is sound.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvpython stability.py
    pvpython stability.py organ.stl --scale 0.001 --elements 600
    pvpython stability.py scene.vtu --touched 0.06 0.12 0.05 --laws Neo-Hookean Fung
    pvpython stability.py --stiff 0 0.02 0 0.03 --contrasts 1 1e6 --distances 0.1 0.5 -0.2

A .vtu scene keeps its points `Fixed`; its materials are replaced. The results go to the folder
`out`: stability.csv (all figures of all cells), stability.md and stability.png.
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

import heat_map
from bodies import (SLACK, add_cell_array, add_scene_arguments, corners_of, places, read_scene,
                    save_body)
from materials import LAWS, assign, is_incompressible
from measure import Measured
from pipeline import Failure
from script import Arguments, run
from tables import OUTCOMES, flag_names, markdown, save_csv, vtk_table

# Flags that the matrix marks; that an inertia is not known is no fault.
MARKED = 1 | 2 | 8
COLUMNS = {"law": "s", "Poisson's ratio": "s", "contrast": "g", "distance": "s",
           "increments": ".0f", "outcome": "s", "flags": "s", "iterations": ".0f",
           "residual": ".1e", "least det F": ".3g", "condition": ".1e", "seconds": ".2g",
           "message": "s"}
SHORT = {0: "ok", 1: "stop", 2: "singular", 3: "budget", 4: "aborted", 5: "refused"}


def arguments():
    parser = Arguments("stability.py", __doc__.splitlines()[0])
    add_scene_arguments(parser)
    parser.add_argument("--laws", nargs="+", choices=LAWS, metavar="LAW", default=list(LAWS),
                        help="of: " + ", ".join(LAWS))
    parser.add_argument("--poissons", type=float, nargs="+", default=[0.3, 0.4999],
                        help="Poisson's ratios")
    parser.add_argument("--young", type=float, default=1e4, help="Young's modulus, Pa")
    parser.add_argument("--contrasts", type=float, nargs="+", default=[1, 1e3, 1e6],
                        help="how much stiffer the stiff region is")
    parser.add_argument("--stiff", type=float, nargs=4, metavar=("X", "Y", "Z", "RADIUS"),
                        help="sphere whose cells are stiffer, m; by default one in the middle")
    parser.add_argument("--stiff-array", metavar="NAME", help="instead: cell array of the scene, "
                        "not 0 where it is stiffer, as a Calculator makes it")
    parser.add_argument("--distances", type=float, nargs="+", default=[0.02, 0.1, 2.0, -0.1],
                        help="how far it is pulled along the normal (pushed: negative), in longest "
                        "sides of the body; 1e-12 m is always among them")
    parser.add_argument("--increments", type=int, nargs="+", default=[1, 10],
                        help="the way is gone in so many parts")
    parser.add_argument("--seconds", type=float, default=5.0, help="bound of time for an increment")
    return parser


def read_body(args):
    """A reader of the body with `Fixed` and `Stiff`, the node that is touched, and the organ."""
    grid, node, organ = read_scene(args)
    middles = places(grid)[corners_of(grid)].mean(axis=1)
    if args.stiff_array:
        array = grid.GetCellData().GetArray(args.stiff_array)
        if array is None:
            raise Failure(f"{args.scene} has no cell array {args.stiff_array}.")
        stiff = np.array([array.GetTuple1(i) != 0 for i in range(grid.GetNumberOfCells())])
    else:
        x, y, z, radius = args.stiff or (*middles.mean(axis=0), 0.17 * organ.size)
        stiff = np.linalg.norm(middles - (x, y, z), axis=1) < radius
    if not stiff.any() or stiff.all():
        raise Failure("the stiff region is empty, or the whole body: choose --stiff.")
    add_cell_array(grid, "Stiff", stiff.astype(np.int32))
    return save_body(grid, os.path.join(args.output, "scene.vtu")), node, organ


def materials(args):
    """Law and Poisson's ratio of each column of the matrix."""
    for law in args.laws:
        for ratio in [0.5] if is_incompressible(law) else args.poissons:
            yield law, ratio


def measure(args):
    body, node, organ = read_body(args)
    touch = {"ActiveNodes": [node], "TipRadius": organ.tip_radius * SLACK}
    ways = [("1e-12 m", 1e-12)] + [(f"{share:g} x size", share * organ.size)
                                   for share in args.distances]
    rows = []
    for law, ratio in materials(args):
        for contrast in args.contrasts:
            soft = assign(body, law, args.young, ratio)
            scene = assign(soft, law, args.young * contrast, ratio, RegionArray="Stiff",
                           RegionValue=1)
            for name, distance in ways:
                for increments in args.increments:
                    rows.append({"law": law, "Poisson's ratio": f"{ratio:g}", "contrast": contrast,
                                 "distance": name, "increments": increments,
                                 **solve(scene, distance * organ.normal, Increments=increments,
                                         MaximumSeconds=args.seconds, **touch)})
            Delete(scene)
            Delete(soft)
        print(f"{law}, {ratio:g}: {tally(rows, law, f'{ratio:g}')}", flush=True)
    return rows


def solve(scene, displacement, **settings):
    try:
        solved = Measured(scene, displacement, EstimateCondition=1, **settings)
    except Failure as failure:
        return {"number": 5, "outcome": OUTCOMES[5], "message": str(failure)}
    number = int(solved.figure("Outcome"))
    row = {"number": number, "outcome": OUTCOMES[number],
           "bits": int(solved.figure("Flags")), "flags": flag_names(solved.figure("Flags")),
           "iterations": solved.figure("Iterations"), "residual": solved.figure("Residual"),
           "least det F": solved.figure("MinimumDetF"), "condition": solved.figure("Condition"),
           "seconds": solved.seconds, "message": solved.figure("Message"),
           "force": solved.force}
    solved.forget()
    return row


def tally(rows, law, ratio):
    """How many cells of a column ended in which way."""
    counts = {}
    for row in rows:
        if (row["law"], row["Poisson's ratio"]) == (law, ratio):
            name = ", ".join(filter(None, (row["outcome"], row.get("flags"))))
            counts[name] = counts.get(name, 0) + 1
    return "; ".join(f"{count} {name}" for name, count in sorted(counts.items()))


def differences(rows):
    """Cells that converged to another force in many increments than in one."""
    first, lines = {}, []
    for row in rows:
        key = tuple(row[name] for name in ("law", "Poisson's ratio", "contrast", "distance"))
        one = first.setdefault(key, row)
        if row["number"] or one["number"] or row is one:
            continue
        change = np.linalg.norm(row["force"] - one["force"]) / np.linalg.norm(one["force"])
        if change > 1e-6:
            lines.append(f"- {key[0]}, Poisson's ratio {key[1]}, contrast {key[2]:g}, {key[3]}: "
                         f"{np.linalg.norm(one['force']):.4g} N in {one['increments']}, "
                         f"{np.linalg.norm(row['force']):.4g} N in {row['increments']} increments")
    return lines


def cell_text(row):
    marks = "".join(mark for bit, mark in ((1, "i"), (2, "u"), (8, "f"))
                    if row.get("bits", 0) & bit)
    return SHORT[row["number"]] + (f" ({marks})" if marks else "")


def matrix(rows):
    """A row a material and contrast, a column a distance and number of increments."""
    lines, columns = {}, {"law": "s", "ν": "s", "contrast": "s"}
    for row in rows:
        key = (row["law"], row["Poisson's ratio"], f"{row['contrast']:g}")
        line = lines.setdefault(key, dict(zip(columns, key)))
        column = f"{row['distance']}, {row['increments']}"
        line[column] = cell_text(row)
    names = list(columns) + [name for name in next(iter(lines.values())) if name not in columns]
    return markdown(list(lines.values()), dict.fromkeys(names, "s"))


def main():
    args = arguments().read()
    if args is None:
        return
    rows = measure(args)
    save_csv(vtk_table(rows, COLUMNS), os.path.join(args.output, "stability.csv"))
    different = differences(rows)
    told = ("Another equilibrium in many increments than in one:\n\n" + "\n".join(different)
            if different else "The same equilibrium in one increment and in many, everywhere.")
    text = matrix(rows) + "\n\n" + told
    text += (f"\n\n{len(rows)} cells; the longest took "
             f"{max(row.get('seconds', 0) for row in rows):.2g} s.")
    with open(os.path.join(args.output, "stability.md"), "w", encoding="utf-8") as file:
        file.write(text + "\n")
    print(text, flush=True)
    if os.environ.get("DISPLAY"):
        heat_map.draw(rows, MARKED, os.path.join(args.output, "stability.png"))
    else:
        print("stability.py: no picture, there is no display (xvfb-run -a gives one).", flush=True)


if __name__ == "__main__":
    run("stability.py", main)

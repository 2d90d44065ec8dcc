# SPDX-License-Identifier: BSD-3-Clause
"""Error asked for and error reached: does a state space keep its tolerance on your scene?

For each law and each tolerance a space is made that refines itself, and beside them some uniform
grids. The force of each is compared at random places with that of a solve from rest.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch tolerance.py
    pvbatch tolerance.py organ.stl --scale 0.001 --touched 0.01 0.05 0.08 --tip-radius 0.01
    pvbatch tolerance.py scene.vtu --laws Own --half-width 0.012 --tolerances 1 --points 2000
    mpiexec -n 4 pvbatch tolerance.py --laws Fung --exponent 5 --half-width 0.03

A .vtu scene keeps its points `Fixed`; its materials are replaced, but for the law Own. The results
go to the folder `out`: table.csv, table.md and charts (.png).
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import time

import numpy as np
from paraview.simple import *

from bodies import SLACK, add_box_arguments, add_scene_arguments, read_scene, save_body
from charts import Curve, chart
from materials import OWN, add_law_arguments, check_laws, scene_of
from pipeline import Failure, field, output, update
from script import Arguments, run
from tables import save_table
from vtkmodules.util.numpy_support import vtk_to_numpy

INSIDE = 1
BEYOND_FORCE_LIMIT = 4
COLUMNS = {"law": "s", "space": "s", "asked (%)": "g", "reached (%)": ".2g", "mean (%)": ".2g",
           "surface (%)": ".2g", "marked (%)": ".2g", "error there (%)": ".2g",
           "irregular (%)": ".2g", "error there, too (%)": ".2g", "configurations": ".0f",
           "seconds": ".3g", "MB": ".2f"}


def arguments():
    parser = Arguments("tolerance.py", __doc__.splitlines()[0])
    add_scene_arguments(parser)
    add_law_arguments(parser, ["Neo-Hookean", "St. Venant-Kirchhoff", "Fung"])
    add_box_arguments(parser)
    parser.add_argument("--tolerances", type=float, nargs="+", default=[5, 2, 1, 0.5, 0.2],
                        help="of the force, %% of the largest")
    parser.add_argument("--uniform", type=int, nargs="*", default=[5, 7, 9],
                        help="points along an axis of uniform grids to put beside them")
    parser.add_argument("--points", type=int, default=200, help="places at which the force is "
                        "solved for and compared")
    return parser


class Exact:
    """Solutions at random places of the box, each from rest."""

    def __init__(self, scene, half_width, count, settings):
        self.places = np.random.default_rng(2008).uniform(-half_width, half_width, (count, 3))
        self.forces, self.fields, regular = np.full((count, 3), np.nan), [], []
        solve = SolveEquilibrium(Input=scene, **settings)
        for place, force in zip(self.places, self.forces):
            solve.Displacement = list(place)
            solved = output(update(solve))
            converged = field(solved, "Outcome")[0] == 0
            if converged:
                force[:] = field(solved, "ReactionForce")
            self.fields.append(point_array(solved, "Displacement").astype(np.float32))
            # On the way from rest no fold, and neither inverted nor unstable at its end.
            regular.append(converged and field(solved, "Flags")[0] == 0)
        self.regular = np.array(regular)
        Delete(solve)


def space_of(scene, **settings):
    """A state space, with the seconds of the processor that it took."""
    start = time.process_time()
    space = update(PrecomputeStateSpace(Input=scene, **settings))
    return space, time.process_time() - start


def point_array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def megabytes(data):
    """Of a data set or an array."""
    return data.GetActualMemorySize() * 1024 / 1e6


def compare(space, exact):
    """The figures of a space."""
    surface, found = (output(space).GetPartitionAsDataObject(block, 0) for block in (1, 2))
    limited = (point_array(found, "Outcome") == 0) & (
        point_array(found, "Flags") & BEYOND_FORCE_LIMIT == 0)
    largest = np.linalg.norm(point_array(found, "Force")[limited], axis=1).max()
    touch = TouchStateSpace(Input=space)
    forces, inside, surface_errors = np.empty_like(exact.forces), [], []
    points = point_array(surface, "MeshPoint")
    for place, force, moved in zip(exact.places, forces, exact.fields):
        touch.Displacement = list(place)
        touched = output(update(touch))
        force[:] = field(touched, "Force")
        inside.append(field(touched, "Found")[0] == INSIDE)
        off = point_array(touched, "Displacement") - moved[points]
        surface_errors.append(np.linalg.norm(off, axis=1).max())
    Delete(touch)
    inside = np.array(inside)
    errors = 100 * np.linalg.norm(forces - exact.forces, axis=1) / largest
    surface_errors = 100 * np.array(surface_errors) / field(found, "LargestDisplacement")[0]

    def worst(of, values=errors):
        of = of & ~np.isnan(errors)
        return values[of].max() if of.any() else None

    good = inside & exact.regular
    return {"reached (%)": worst(good), "mean (%)": errors[good].mean() if good.any() else None,
            "surface (%)": worst(good, surface_errors), "marked (%)": 100 * (~inside).mean(),
            "error there (%)": worst(~inside & exact.regular),
            "irregular (%)": 100 * (inside & ~exact.regular).mean(),
            "error there, too (%)": worst(inside & ~exact.regular),
            "configurations": found.GetNumberOfPoints(),
            "MB": megabytes(found) + megabytes(surface.GetPointData().GetArray("Modes"))}


def measure(args):
    grid, node, organ = read_scene(args)
    check_laws(grid, args)
    half_width = args.half_width or 0.06 * organ.size
    body = save_body(grid, os.path.join(args.output, "scene.vtu"))
    tip = {"TipRadius": organ.tip_radius * SLACK}
    spaces = [(f"{percent:g} %", {"Tolerance": 0.01 * percent}, percent)
              for percent in sorted(args.tolerances, reverse=True)]
    spaces += [(f"uniform, {count}³", {"Resolution": count}, None) for count in args.uniform]
    rows = []
    for law in args.laws:
        scene = scene_of(body, law, args)
        exact = Exact(scene, half_width, args.points, {"ActiveNodes": [node], **tip})
        print(f"{law}: {exact.regular.sum()} of {args.points} places are reached from rest by a "
              "regular way", flush=True)
        for name, settings, asked in spaces:
            space, seconds = space_of(scene, ActiveNodes=[node], HalfWidth=half_width,
                                      ForceLimit=args.force_limit, **tip, **settings)
            rows.append({"law": law, "space": name, "asked (%)": asked, "seconds": seconds,
                         **compare(space, exact)})
            print(f"{law}, {name}: {rows[-1]['configurations']} configurations, {seconds:.3g} s",
                  flush=True)
            Delete(space)
        if law != OWN:
            Delete(scene)
    return rows


def verdict(rows):
    """In a line a law: whether all tolerances are kept."""
    lines = []
    for law in dict.fromkeys(row["law"] for row in rows):
        known = [row for row in rows if row["law"] == law and row["asked (%)"] is not None
                 and row["reached (%)"] is not None]
        missed = [row for row in known if row["reached (%)"] > row["asked (%)"]]
        if not known:
            lines.append(f"{law}: the whole box is marked, or no way there is regular.")
        elif missed:
            lines.append(f"{law}: not kept for " + ", ".join(
                f"{row['space']} ({row['reached (%)']:.2g} % reached)" for row in missed) + ".")
        else:
            lines.append(f"{law}: every tolerance is kept where the space is not marked.")
    return lines


def draw(rows, args):
    laws = list(dict.fromkeys(row["law"] for row in rows))

    def curves(x, y, adaptive, label, style):
        found = []
        for number, law in enumerate(laws):
            points = [(row[x], row[y]) for row in rows if row["law"] == law
                      and (row["asked (%)"] is not None) == adaptive and row[x] and row[y]]
            if points:
                found.append(Curve(label.format(law=law), points, number, style))
        return found

    def path(name):
        return os.path.join(args.output, name + ".png")

    asked = sorted({row["asked (%)"] for row in rows if row["asked (%)"]})
    reached = curves("asked (%)", "reached (%)", True, "{law}", 1)
    if reached:
        diagonal = Curve("as asked for", [(x, x) for x in asked], 4, 0)
        chart("Largest error of the force outside marked regions", "asked for (%)", "reached (%)",
              [diagonal, *reached], path("reached_asked"))
    both = (curves("configurations", "reached (%)", False, "{law}, uniform grid", 0)
            + curves("configurations", "reached (%)", True, "{law}, to a tolerance", 1))
    if both:
        chart("Largest error against configurations", "configurations", "error (%)", both,
              path("error_configurations"))


def main():
    args = arguments().read()
    if args is None:
        return
    if args.points < 1 or any(not 0 < percent < 100 for percent in args.tolerances):
        raise Failure("--points must be at least 1, and --tolerances between 0 and 100.")
    rows = measure(args)
    save_table(rows, COLUMNS, verdict(rows), args.output)
    if os.environ.get("DISPLAY"):
        draw(rows, args)
    else:
        print("tolerance.py: no charts, there is no display (xvfb-run -a gives one).", flush=True)


if __name__ == "__main__":
    run("tolerance.py", main)

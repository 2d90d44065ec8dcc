# SPDX-License-Identifier: BSD-3-Clause
"""Palpation: the state space of a whole organ that a sphere presses anywhere, and what it is worth.

Spaces of several spacings and one to a tolerance are computed and compared with exact presses and
slides that they never saw: error against run time and memory. Then the sphere slides over the organ
once.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    mpiexec -n 2 pvbatch palpation.py
    pvbatch palpation.py --region 0.03 --points 100
    mpiexec -n 8 pvbatch palpation.py organ.stl --scale 0.001 --tool-radius 0.006 --depth 0.003
    pvbatch palpation.py scene.vtu --laws Own --tolerance 5

A .vtu scene keeps its points `Fixed`; its materials are replaced, but for the law Own. The results
go to the folder `out`: table.md, table.csv, slide.csv and pictures (.png). What was solved for is
kept in .palpate files there and is not solved for again.
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import add_scene_arguments, read_scene, save_body
from charts import LINE, MARKS, Curve, chart
from materials import add_law_arguments, check_laws, scene_of
from pictures import PALE, TISSUE, Stage, show_arrow
from pipeline import Failure, field, output, update
from pressing import INSIDE, SHARE, outwards, sphere
from script import Arguments, run
from tables import save_csv, save_table, vtk_table
from vtkmodules.util.numpy_support import vtk_to_numpy

# Of the columns of Accuracy Report; of those in m, B and N what they are multiplied by.
COLUMNS = {"space": (None, "s", 1), "method": ("Method", "s", 1),
           "configurations": ("Samples", ".0f", 1),
           "precompute (s)": ("PrecomputeSeconds", ".3g", 1),
           "carried (MB)": ("Bytes", ".3g", 1e-6), "evaluate (ns)": ("EvaluationP50", ".0f", 1),
           "99.9 % (ns)": ("EvaluationP999", ".0f", 1), "mean (%)": ("MeanErrorN", ".2g", 100),
           "99 % (%)": ("P99ErrorN", ".2g", 100), "largest (%)": ("LargestErrorN", ".2g", 100),
           "noticed (%)": ("Noticeable", ".2g", 1),
           "surface (%)": ("MeanDisplacementError", ".2g", 1)}
OF_LARGEST = ("MeanErrorN", "P99ErrorN", "LargestErrorN")
COUNTS = ("TestPoints", "Counted", "Marked", "Extrapolated", "Irregular", "Failed")
# Of the slide: how far to both sides of the place that is touched, in radii of the tool, and how
# many places are drawn and solved for.
REACH, DRAWN, SOLVED = 4, 400, 33


def arguments():
    parser = Arguments("palpation.py", __doc__.splitlines()[0])
    add_scene_arguments(parser)
    add_law_arguments(parser, ["Neo-Hookean"])
    parser.set_defaults(elements=1000, poisson=0.4, young=5e3)
    parser.add_argument("--tool-radius", type=float, default=0.01, help="of the sphere, m")
    parser.add_argument("--depth", type=float, default=0.005,
                        help="how deep the sphere goes into the body at rest, m")
    parser.add_argument("--spacings", type=float, nargs="+", help="of the check-points, m, of a "
                        "space each; by default four fifths and two fifths of the radius")
    parser.add_argument("--tolerance", type=float, default=1.0,
                        help="of the force, %% of the largest, to which the finest of them is "
                        "refined; 0: it is not")
    parser.add_argument("--region", type=float, default=0.0, metavar="RADIUS",
                        help="only around the place that is touched, m; 0 for the whole organ")
    parser.add_argument("--most", type=int, default=200000, help="configurations that are allowed")
    parser.add_argument("--points", type=int, default=500, help="test points of the report")
    return parser


def spaces_of(scene, organ, args):
    """Names and spaces, the coarsest first."""
    spacings = sorted(args.spacings or (0.8 * args.tool_radius, 0.4 * args.tool_radius))
    kinds = [(spacing, 0) for spacing in reversed(spacings)]
    if args.tolerance > 0:
        kinds.append((spacings[0], args.tolerance))
    for spacing, tolerance in kinds:
        name = f"{1e3 * spacing:.3g} mm"
        space = PrecomputeStateSpace(
            Input=scene, Depth=args.depth, Spacing=spacing, Tolerance=0.01 * tolerance,
            MaximumConfigurations=args.most, BeginAt=list(organ.place),
            FileName=os.path.join(args.output, name.replace(" ", "_") + ".palpate"),
            **sphere(args.tool_radius))
        if args.region > 0:
            space.UseToolRegion, space.ToolRegion = 1, "Sphere"
            space.ToolRegion.Center, space.ToolRegion.Radius = list(organ.place), args.region
        yield name + (f", {tolerance:g} %" if tolerance > 0 else ""), update(space)


def table_of(name, space, args):
    """Rows of figures, one a method, and a line of what they are of."""
    report = update(AccuracyReport(Input=space, TestPoints=args.points,
                                   FileName=os.path.join(args.output, "exact.palpate")))
    table = servermanager.Fetch(report)

    def value(name, row):
        return table.GetColumnByName(name).GetValue(row)

    count = table.GetNumberOfRows()
    finest = min(value("Spacing", i) for i in range(count))
    rows = []
    for i in range(count):
        # Those of the coarser grid are the rows of another space.
        if value("Spacing", i) > finest:
            continue
        row = {"space": name}
        for title, (column, form, factor) in COLUMNS.items():
            if column is not None:
                found = value(column, i)
                if column in OF_LARGEST:
                    found /= value("LargestForce", i)
                row[title] = found if form == "s" else factor * found
        rows.append(row)
    counts = {name: value(name, 0) for name in COUNTS}
    data = output(space)
    line = (f"{name}: {field(data, 'NumberOfConfigurations')[0]:.0f} configurations, of which "
            f"{field(data, 'Reused')[0]:.0f} were known; the others took "
            f"{field(data, 'ExplorationSeconds')[0]:.3g} s (ranks: {field(data, 'Ranks')[0]:.0f}); "
            f"the file has {os.path.getsize(space.FileName) / 1e6:.0f} MB. "
            f"{counts['TestPoints']} presses and slides, of which {counts['Counted']} count, "
            f"{counts['Marked']} are in marked cells, {counts['Extrapolated']} beyond the "
            f"configurations, {counts['Irregular']} not regular and {counts['Failed']} not found; "
            f"the largest force is {value('LargestForce', 0):.3g} N")
    Delete(report)
    return rows, line


class Slide:
    """The sphere on a straight line across the place that is touched, along the surface there."""

    def __init__(self, organ, args):
        # Deep at that place, less where the organ is convex.
        self.normal = outwards(organ)
        across = np.cross(self.normal, np.eye(3)[np.argmin(np.abs(self.normal))])
        self.along = across / np.linalg.norm(across)
        self.middle = organ.place + (args.tool_radius - SHARE * args.depth) * self.normal
        self.reach = REACH * args.tool_radius

    def places(self, number):
        """Ways (m) from the middle, and the places of the tool there."""
        ways = np.linspace(-self.reach, self.reach, number)
        return ways, self.middle + ways[:, None] * self.along

    def parts(self, forces):
        """The force against the tool: along the normal of the middle, and along the way."""
        return -forces @ self.normal, -forces @ self.along

    def felt(self, space):
        """Ways and forces of the space, and where it tells them to be right."""
        touch = TouchStateSpace(Input=space)
        ways, places = self.places(DRAWN)
        forces, inside = np.empty((DRAWN, 3)), np.empty(DRAWN, bool)
        for i, place in enumerate(places):
            touch.ToolPosition = list(place)
            touched = output(update(touch))
            forces[i], inside[i] = field(touched, "Force"), field(touched, "Found")[0] == INSIDE
        Delete(touch)
        return ways, forces, inside

    def exact(self, scene, args):
        """Ways and forces, each solved for from outside."""
        solve = SolveEquilibrium(Input=scene, **sphere(args.tool_radius))
        ways, places = self.places(SOLVED)
        forces = np.full((SOLVED, 3), np.nan)
        for place, force in zip(places, forces):
            solve.ToolPosition = list(place)
            solved = output(update(solve))
            if field(solved, "Outcome")[0] == 0:
                force[:] = field(solved, "ReactionForce")
        Delete(solve)
        return ways, forces


class Comparison:
    """What the space gives on the slide beside what is exact there."""

    def __init__(self, slide, scene, space, args):
        self.slide = slide
        self.ways, self.forces, self.inside = slide.felt(space)
        self.exact_ways, self.exact = slide.exact(scene, args)

    def save(self, path):
        rows = [{"way (mm)": 1e3 * way, "normal (N)": normal, "along (N)": along,
                 "inside": float(inside)}
                for way, normal, along, inside in zip(self.ways, *self.slide.parts(self.forces),
                                                      self.inside)]
        save_csv(vtk_table(rows, rows[0]), path)

    def line(self):
        """How far the space is off."""
        felt = np.array([np.interp(self.exact_ways, self.ways, self.forces[:, k])
                         for k in range(3)]).T
        known = (np.isfinite(self.exact[:, 0])
                 & (np.interp(self.exact_ways, self.ways, self.inside) == 1))
        if not known.any():
            return "the slide does not meet the space"
        largest = np.linalg.norm(self.exact[known], axis=1).max()
        off = np.linalg.norm(felt - self.exact, axis=1)[known].max()
        return (f"on the slide the force is off by {100 * off / largest:.2g} % of its largest one, "
                f"{largest:.3g} N, at the most ({known.sum()} places)")

    def draw(self, path):
        middle = len(self.ways) // 2
        if not self.inside[middle]:
            return
        # As far to both sides as the space reaches.
        gaps = np.flatnonzero(~self.inside)
        first = max(gaps[gaps < middle], default=-1) + 1
        end = min(gaps[gaps > middle], default=len(self.ways))
        ways, forces = 1e3 * self.ways[first:end], self.forces[first:end]
        near = (1e3 * self.exact_ways >= ways[0]) & (1e3 * self.exact_ways <= ways[-1])
        near &= np.isfinite(self.exact[:, 0])
        curves = []
        for colour, (name, felt, exact) in enumerate(zip(
                ("along the normal", "along the way"), self.slide.parts(forces),
                self.slide.parts(self.exact[near]))):
            curves.append(Curve(name, list(zip(ways, felt)), colour, LINE))
            curves.append(Curve(name + ", exact", list(zip(1e3 * self.exact_ways[near], exact)),
                                colour, MARKS))
        chart("The sphere slides over the organ", "way (mm)", "force on the hand (N)", curves, path,
              logarithmic=(False, False))


def draw_pressed(slide, scene, space, path, args):
    """The organ with the sphere in it, and the force on the hand."""
    touch = update(TouchStateSpace(Input=space, ToolPosition=list(slide.middle)))
    force = np.array(field(output(touch), "Force"))
    pressure = vtk_to_numpy(output(touch).GetPointData().GetArray("ContactPressure"))
    stage = Stage(scene)
    stage.clear()
    stage.show_held()
    stage.colour(stage.show(touch), ("POINTS", "ContactPressure"), "Pressure (Pa)",
                 (0, max(pressure.max(), 1)))
    stage.show(Sphere(Center=list(slide.middle), Radius=args.tool_radius, ThetaResolution=32,
                      PhiResolution=32), PALE)
    size = np.linalg.norm(force)
    if size > 0:
        show_arrow(stage, slide.middle, -0.25 * stage.size * force / size)
    stage.write(f"{1e3 * SHARE * args.depth:.1f} mm deep: {size:.2f} N")
    stage.save(path)


def draw_errors(rows, path):
    """The error against what it takes; `path` is that of a picture by its name."""
    for x, title, name in (("precompute (s)", "precomputation on one core (s)", "error_seconds"),
                           ("carried (MB)", "memory (MB)", "error_bytes")):
        curves = []
        for number, method in enumerate(dict.fromkeys(row["method"] for row in rows)):
            found = [(row[x], row["mean (%)"]) for row in rows if row["method"] == method
                     and row[x] > 0 and row["mean (%)"] > 0]
            if found:
                curves.append(Curve(method, found, number, 1))
        if curves:
            chart("Mean error of the force", title, "% of the largest force", curves, path(name))


def main():
    args = arguments().read()
    if args is None:
        return
    if args.points < 1 or not 0 <= args.tolerance < 100:
        raise Failure("--points must be at least 1, and --tolerance at least 0 and below 100.")
    if len(args.laws) != 1:
        raise Failure("one law at a time: --laws takes one here.")
    grid, _, organ = read_scene(args)
    check_laws(grid, args)
    body = save_body(grid, os.path.join(args.output, "scene.vtu"))
    scene = scene_of(body, args.laws[0], args)
    rows, lines = [], []
    for name, space in spaces_of(scene, organ, args):
        of_space, line = table_of(name, space, args)
        rows += of_space
        lines.append(line)
        print(line, flush=True)
    # The last space is the finest.
    slide = Slide(organ, args)
    comparison = Comparison(slide, scene, space, args)
    lines.append(comparison.line())
    comparison.save(os.path.join(args.output, "slide.csv"))
    save_table(rows, {name: form for name, (_, form, _) in COLUMNS.items()},
               [f"{line}." for line in lines], args.output)
    if not os.environ.get("DISPLAY"):
        print("palpation.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return

    def path(name):
        return os.path.join(args.output, name + ".png")

    draw_pressed(slide, scene, space, path("pressed"), args)
    comparison.draw(path("slide"))
    draw_errors(rows, path)


if __name__ == "__main__":
    run("palpation.py", main)

# SPDX-License-Identifier: BSD-3-Clause
"""Parts that touch: a liver on a soft bed, with a stomach beside it, under gravity.

The three lie on each other by contact. A sphere presses the front of the liver, and with it the bed
behind it; beside this, the same liver without its neighbours.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch bed.py
    pvbatch bed.py --edge 0.016 --depths 0.005 0.02
    pvbatch bed.py --young 3000 30000 8000 --thickness 0.00225

The results go to the folder `out`: table.md, table.csv, parts.csv, surface.vtp, pressed.vtu and
pictures (.png).
"""
import os
import sys
import time

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import corners_of, on_surface, places, save_body
from charts import Curve, chart
from pictures import HAND, TISSUE, Stage
from pipeline import Failure, field, output, save_surface, update
from script import Arguments, run
from surfaces import BED, BED_LOW, LIVER, STOMACH, make_surfaces
from tables import markdown, save_csv, save_table, vtk_table

NAMES = {LIVER: "liver", BED: "bed", STOMACH: "stomach"}
YOUNG = [5e3, 15e3, 8e3]  # of liver, bed and stomach, Pa
GRAVITY, DENSITY, POISSON = 9.81, 1060, 0.4  # m/s², kg/m³, no unit
WEIGHT = [0, 0, -GRAVITY]  # m/s²
# Where springs hold the liver and the stomach, as ligaments do: centre, radius, m.
LIGAMENTS = ((-0.03, 0.075, 0.01), 0.038), ((0.11, -0.07, 0.0), 0.035)
SPRINGS = 5e4  # N/m³
CONVERGED = 0
COLOURS = {LIVER: TISSUE, BED: (0.80, 0.80, 0.78), STOMACH: (0.93, 0.80, 0.55)}
SLICED = 0.002  # how far beside the tool's middle a picture is cut, m


def arguments():
    parser = Arguments("bed.py", __doc__.splitlines()[0])
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--edge", type=float, default=0.02, help="of the tetrahedra, m")
    parser.add_argument("--young", type=float, nargs=3, default=YOUNG,
                        metavar=tuple(name.upper() for name in NAMES.values()),
                        help="moduli, Pa")
    parser.add_argument("--tool-radius", type=float, default=0.012, help="of the sphere, m")
    parser.add_argument("--depths", type=float, nargs="+", default=[0.005, 0.01, 0.02, 0.03],
                        help="how deep the sphere is pressed, m")
    parser.add_argument("--thickness", type=float, default=0.0,
                        help="of the layer in which the parts press each other, m; 0: a fifth of "
                        "the mean edge")
    return parser


def make_scene(body, young=YOUNG, contact="Between Parts", thickness=0.0):
    """The parts, each with its tissue, and how they are held: the bed at its bottom, the liver and
    the stomach by ligaments, and otherwise by what they touch."""
    material = AssignMaterial(
        Input=body, RegionType="Table", RegionArray="Region", Density=DENSITY,
        Regions=[text for region, modulus in enumerate(young) for text in (
            str(region), "Neo-Hookean", f"YoungsModulus {modulus:g} PoissonsRatio {POISSON:g}")])
    scene = SetBoundary(Input=material, FixedRegion="Plane", Contact=contact, PartsBy="Array",
                        PartArray="Region", ContactThickness=thickness)
    scene.FixedRegion.Origin = [0, 0, float(BED_LOW[2]) + 0.002]
    scene.FixedRegion.Normal = [0, 0, 1]
    for centre, radius in LIGAMENTS:
        scene = SetBoundary(Input=scene, Support="Springs", SupportStiffness=SPRINGS,
                            FixedRegion="Sphere")
        scene.FixedRegion.Center, scene.FixedRegion.Radius = list(centre), radius
    return update(scene)


class Parts:
    """Which cells and points are whose, and the volumes of the cells."""

    def __init__(self, grid):
        self.corners = corners_of(grid)
        self.region = np.array(grid.GetCellData().GetArray("Region"))
        a, b, c, d = (places(grid)[self.corners[:, k]] for k in range(4))
        self.volumes = np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)) / 6

    def mean(self, values, region):
        """The mean of values at points over a part."""
        own = self.region == region
        return np.average(values[self.corners[own]].mean(axis=1), axis=0, weights=self.volumes[own])

    def volume(self, region):
        return self.volumes[self.region == region].sum()

    def touched(self, grid, place):
        """The point of the liver's surface that is nearest to a place."""
        distance = np.linalg.norm(places(grid) - place, axis=1)
        mine = np.zeros(len(distance), bool)
        mine[self.corners[self.region == LIVER]] = True
        distance[~(mine & on_surface(grid))] = np.inf
        return int(distance.argmin())


def array(data, name):
    return np.array(data.GetPointData().GetArray(name))


def solve(scene, **settings):
    """A solved filter and how long it took, s."""
    start = time.perf_counter()
    solved = update(SolveEquilibrium(Input=scene, **settings))
    seconds = time.perf_counter() - start
    if field(output(solved), "Outcome")[0] != CONVERGED:
        raise Failure("a solve found no equilibrium: " + field(output(solved), "Message")[0])
    return solved, seconds


def part_forces(data):
    return np.reshape(field(data, "PartForce"), (-1, 3))


PART_COLUMNS = {"part": "s", "modulus (kPa)": ".3g", "weight (N)": ".2f", "sinks (mm)": ".1f",
                "at the most (mm)": ".1f", "borne by the others (N)": ".2f"}


def describe_parts(parts, lying, young):
    """How far each part sinks under gravity, and which force the others exert on it."""
    down = -array(lying, "Displacement")[:, 2]
    return [{"part": name, "modulus (kPa)": 1e-3 * young[region],
             "weight (N)": DENSITY * GRAVITY * parts.volume(region),
             "sinks (mm)": 1e3 * parts.mean(down, region),
             "at the most (mm)": 1e3 * down[parts.corners[parts.region == region]].max(),
             "borne by the others (N)": part_forces(lying)[region, 2]}
            for region, name in NAMES.items()]


COLUMNS = {"depth (mm)": ".3g", "force (N)": ".3f", "of the layer (N)": ".3f",
           "on the bed (N)": ".3f", "pressure (Pa)": ".0f", "solve (s)": ".0f",
           "alone (N)": ".3f", "alone (s)": ".1f"}


def press(scene, start, depth, args, **settings):
    """A sphere that presses down from a place of the surface at rest."""
    place = start + [0, 0, args.tool_radius - depth]
    return (*solve(scene, Tool="Sphere", ToolRadius=args.tool_radius, ToolPosition=list(place),
                   Increments=2, **settings), place)


def measure(scene, alone, starts, lying, args):
    """Rows of the table, and the filter and the place of the sphere of the deepest press."""
    rows = []
    before = part_forces(lying)
    for depth in sorted(args.depths):
        solved, seconds, place = press(scene, starts[0], depth, args, BodyForce=WEIGHT)
        without, seconds_alone, _ = press(alone, starts[1], depth, args)
        data = output(solved)
        rows.append({"depth (mm)": 1e3 * depth, "force (N)": -field(data, "ReactionForce")[2],
                     "of the layer (N)": -field(data, "PartLayerForce")[2],
                     "on the bed (N)": before[BED, 2] - part_forces(data)[BED, 2],
                     "pressure (Pa)": array(data, "PartPressure").max(), "solve (s)": seconds,
                     "alone (s)": seconds_alone,
                     "alone (N)": -field(output(without), "ReactionForce")[2]})
        print(", ".join(f"{title} {rows[-1][title]:{form}}" for title, form in COLUMNS.items()),
              flush=True)
    return rows, solved, place


def deformed(source):
    return WarpByVector(Input=source, Vectors=["POINTS", "Displacement"])


def region_of(source, region):
    part = Threshold(Input=source, Scalars=["CELLS", "Region"])
    part.LowerThreshold = part.UpperThreshold = region
    return update(part)


def draw_cut(stage, source, place, radius, text, path):
    """What is behind a plane across the patient, seen from the feet; radius: of the sphere."""
    stage.clear()
    cut = Clip(Input=source, ClipType="Plane", Invert=0)
    cut.ClipType.Origin, cut.ClipType.Normal = [0, float(place[1]) - SLICED, 0], [0, 1, 0]
    for region, colour in COLOURS.items():
        stage.show(region_of(cut, region), colour, Representation="Surface With Edges",
                   EdgeColor=[0.75 * x for x in colour])
    if radius:
        stage.show(Sphere(Center=list(place), Radius=radius, ThetaResolution=48, PhiResolution=48),
                   HAND)
    stage.write(text)
    stage.save(path)


def draw_pressure(stage, source, largest, text, path):
    """What presses the bed and the stomach, without the liver."""
    stage.clear()
    for region in (BED, STOMACH):
        stage.colour(stage.show(region_of(source, region)), ("POINTS", "PartPressure"),
                     "Pressure (Pa)", (0, largest))
    GetScalarBar(GetColorTransferFunction("PartPressure"), stage.view).RangeLabelFormat = "%.0f"
    stage.write(text)
    stage.save(path)


def draw(scene, lying, pressed, place, args):
    def path(name):
        return os.path.join(args.output, name + ".png")

    stage = Stage(scene)
    view = stage.view
    view.CameraViewUp = [0, 0, 1]
    view.CameraFocalPoint = [0.01, 0.0, -0.03]
    view.CameraPosition = list(np.add(view.CameraFocalPoint, (-0.15, -1.0, 0.45)))
    view.CameraParallelScale = 0.13
    text = f"pressed by {1e3 * max(args.depths):.3g} mm"
    lying, moved = deformed(lying), deformed(pressed)
    draw_cut(stage, scene, place, None, "Before gravity", path("rest"))
    draw_cut(stage, lying, place, None, "Under gravity", path("lying"))
    draw_cut(stage, moved, place, args.tool_radius, text.capitalize(), path("pressed"))
    # From the head, where the stomach faces the liver.
    view.CameraFocalPoint = [-0.01, 0.0, -0.04]
    view.CameraPosition = list(np.add(view.CameraFocalPoint, (0.15, 0.8, 0.8)))
    view.CameraParallelScale = 0.155
    largest = float(f"{array(output(pressed), 'PartPressure').max():.2g}")
    draw_pressure(stage, lying, largest, "On the bed and the stomach, under gravity",
                  path("pressure_lying"))
    draw_pressure(stage, moved, largest, f"On the bed and the stomach, {text}",
                  path("pressure_pressed"))


def draw_chart(rows, path):
    def curve(title, column, colour, style):
        return Curve(title, [(0, 0)] + [(row["depth (mm)"], row[column]) for row in rows], colour,
                     style)

    chart("A sphere presses the front of the liver", "depth (mm)", "force (N)",
          [curve("on the bed, beside the stomach", "force (N)", 0, 1),
           curve("on its ligaments alone", "alone (N)", 1, 0),
           curve("what the bed bears more", "on the bed (N)", 2, 2)], path,
          logarithmic=(False, False))


def main():
    args = arguments().read()
    if args is None:
        return
    if min(args.edge, args.tool_radius, *args.young, *args.depths) <= 0 or args.thickness < 0:
        raise Failure("all lengths and moduli must be larger than 0.")
    os.makedirs(args.output, exist_ok=True)
    organ, surfaces = make_surfaces(args.edge, args.tool_radius)
    surface = save_surface(surfaces, os.path.join(args.output, "surface.vtp"))
    body = update(TetrahedralizeSurface(Input=surface, ElementOrder="Quadratic",
                                        PreserveSurface=1))
    scene = make_scene(body, args.young, thickness=args.thickness)
    alone = make_scene(body, args.young, contact="None")
    grid = output(scene)
    parts = Parts(grid)
    node = parts.touched(grid, organ.place)
    lying, seconds = solve(scene, BodyForce=WEIGHT)
    data = output(lying)
    part_rows = describe_parts(parts, data, args.young)
    save_csv(vtk_table(part_rows, PART_COLUMNS), os.path.join(args.output, "parts.csv"))
    start = places(grid)[node]
    starts = start + array(data, "Displacement")[node], start
    rows, pressed, place = measure(scene, alone, starts, data, args)
    save_table(rows, COLUMNS, [
        f"{grid.GetNumberOfCells()} quadratic tetrahedra, {grid.GetNumberOfPoints()} points; "
        f"the layer of contact is {1e3 * field(data, 'PartContact')[1]:.2g} mm thick.",
        f"Gravity took {seconds:.0f} s; the forces between the parts add up to "
        f"{np.linalg.norm(part_forces(data).sum(axis=0)):.1g} N."],
        args.output, markdown(part_rows, PART_COLUMNS))
    save_body(output(pressed), os.path.join(args.output, "pressed.vtu"))
    if not os.environ.get("DISPLAY"):
        print("bed.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return
    draw(scene, lying, pressed, place, args)
    draw_chart(rows, os.path.join(args.output, "force.png"))


if __name__ == "__main__":
    run("bed.py", main)

# SPDX-License-Identifier: BSD-3-Clause
"""A nodule that only touch finds: a stiffer ball under the surface of an organ.

A sphere presses the organ anywhere around the nodule, and the stiffness that the hand feels is
drawn on the surface. The same body without the nodule is beside it, so that what differs is the
nodule's. Then nodules of several sizes at several depths are slid over: which of them does a hand
notice?

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    mpiexec -n 2 pvbatch nodule.py
    pvbatch nodule.py --below 0.003 --times 10 --sizes 0.012 --depths 0.002 0.004
    pvbatch nodule.py organ.stl --scale 0.001 --size 0.02

The results go to the folder `out`: table.md, table.csv, slide.csv, map.vtp and pictures (.png). The
.palpate files there can be touched, and what was solved for is not solved for again.
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import Organ, add_point_array, read_surface
from charts import LINE, MARKS, Curve, chart
from organ import BELOW, POISSON, SIZE, TIMES, YOUNG, fill, materials
from pictures import INK, PALE, Stage
from pipeline import Failure, field, output, save_surface, update
from pressing import INSIDE, SHARE, Slide, outwards, touch_of
from remesh import arrays, vertex_normals, volume
from script import Arguments, run
from tables import save_csv, save_table, vtk_table

NOTICED = 10  # %; a smaller difference of force is not noticed (Allin, Matsuoka, Klatzky 2002)
KINDS = ("with the nodule", "without it")
# Lengths in those of the tool's radius: edges of the surface there, and far from there; how far
# to both sides the tool slides; where it is put in the study of sizes and depths.
NEAR, FAR, REACH, STUDIED = 0.5, 2.0, 1.8, (-0.5, 0.0, 0.5)
DRAWN_EDGE = 0.25  # of the surface that is coloured
RIM = 0.9  # of the region: what lies farther out is not coloured
DRAWN, SOLVED = 200, 17  # places of a slide


def arguments():
    parser = Arguments("nodule.py", __doc__.splitlines()[0])
    parser.add_argument("surface", nargs="?", help="a closed surface (.stl .ply .obj .vtp); "
                        "without it, one like a liver")
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--scale", type=float, default=1.0, help="factor from its unit to m")
    parser.add_argument("--touched", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="over the nodule (the nearest point of the surface), m")
    parser.add_argument("--size", type=float, default=SIZE, help="diameter of the nodule, m")
    parser.add_argument("--below", type=float, default=BELOW, help="of its top, m")
    parser.add_argument("--times", type=float, default=TIMES, help="as stiff as the organ it is")
    parser.add_argument("--young", type=float, default=YOUNG, help="modulus of the organ, Pa")
    parser.add_argument("--poisson", type=float, default=POISSON, help="ratio of both")
    parser.add_argument("--tool-radius", type=float, default=0.01, help="of the sphere, m")
    parser.add_argument("--depth", type=float, default=0.006,
                        help="how deep the sphere goes into the body at rest, m")
    parser.add_argument("--spacing", type=float, default=0.005, help="of the check-points, m")
    parser.add_argument("--region", type=float, default=0.022, metavar="RADIUS",
                        help="of the part of the surface that can be pressed, m")
    parser.add_argument("--sizes", type=float, nargs="+", default=(0.006, 0.012, 0.02),
                        help="of the nodules that are slid over, m")
    parser.add_argument("--depths", type=float, nargs="+", default=(0.002, 0.004, 0.008, 0.012,
                                                                    0.016),
                        help="of the tops of these, m")
    return parser


def read(args):
    if min(args.size, args.below, args.times, args.young, args.tool_radius, args.depth,
           args.spacing, args.region, *args.sizes, *args.depths) <= 0:
        raise Failure("all lengths, --times and --young must be larger than 0.")
    os.makedirs(args.output, exist_ok=True)
    return Organ(read_surface(args.surface, args.scale), args.touched, tip_radius=args.region)


class Body:
    """An organ with a nodule of `size` (diameter) with its top `below` the place that is touched,
    m, as two scenes of one mesh: with the nodule, and with the organ's own tissue in its place."""

    def __init__(self, organ, size, below, args):
        surface = save_surface(organ.refined(FAR * args.tool_radius, NEAR / FAR),
                               os.path.join(args.output, "surface.vtp"))
        out = outwards(organ)
        self.centre = organ.place - (below + size / 2) * out
        body = update(fill(surface, self.centre, size, min(0.35 * args.tool_radius, size / 3)))
        if np.ptp(output(body).GetCellData().GetArray("Region").GetRange()) != 1:
            raise Failure(f"the nodule of {size:g} m, {below:g} m below the surface, is not within "
                          "the organ.")
        self.cells = output(body).GetNumberOfCells()
        self.scenes = [self.scene(body, organ, times, args) for times in (args.times, 1)]

    @staticmethod
    def scene(body, organ, times, args):
        scene = SetBoundary(Input=AssignMaterial(
            Input=body, RegionType="Table", RegionArray="Region",
            Regions=materials(args.young, args.poisson, times)), FixedRegion="Sphere")
        scene.FixedRegion.Center = list(organ.held_centre)
        scene.FixedRegion.Radius = organ.held_radius
        return update(scene)


def map_stiffness(touches, organ, args):
    """The surface with the stiffness along its normal (N/m) where the sphere is pressed in, and how
    much of it is the nodule's (%)."""
    surface = organ.refined(FAR * args.tool_radius, DRAWN_EDGE / FAR)
    points, corners = arrays(surface)
    normals = vertex_normals(points, corners)
    normals /= np.sign(volume(points, corners)) * np.linalg.norm(normals, axis=1, keepdims=True)
    stiffness = np.full((2, len(points)), np.nan)
    for i in np.flatnonzero(np.linalg.norm(points - organ.place, axis=1) < RIM * args.region):
        place = points[i] + (args.tool_radius - SHARE * args.depth) * normals[i]
        for touch, found in zip(touches, stiffness):
            touch.ToolPosition = list(place)
            touched = output(update(touch))
            if field(touched, "Found")[0] == INSIDE:
                found[i] = normals[i] @ np.reshape(field(touched, "Stiffness"), (3, 3)) @ normals[i]
    add_point_array(surface, "Stiffness", stiffness[0])
    add_point_array(surface, "OfTheNodule", 100 * (stiffness[0] / stiffness[1] - 1))
    return surface


def line_of_map(surface, organ):
    points, _ = arrays(surface)
    values = {name: np.array(surface.GetPointData().GetArray(name))
              for name in ("Stiffness", "OfTheNodule")}
    if not np.isfinite(values["OfTheNodule"]).any():
        raise Failure("the space reaches no place of the surface: a larger --region or --depth.")
    place = points[np.nanargmax(values["OfTheNodule"])]
    stiffness = values["Stiffness"]
    return (f"the nodule adds {np.nanmax(values['OfTheNodule']):.3g} % to the stiffness at the "
            f"most, {1e3 * np.linalg.norm(place - organ.place):.2g} mm from the place over it; the "
            f"stiffness lies between {np.nanmin(stiffness):.0f} and {np.nanmax(stiffness):.0f} N/m")


def study(organ, slide, args):
    """How much of the force is the nodule's, by size and depth of its top; rows of a table."""
    rows = []
    ways = np.array(STUDIED) * args.tool_radius
    for size in args.sizes:
        for below in args.depths:
            body = Body(organ, size, below, args)
            forces = [slide.exact(scene, ways, args) for scene in body.scenes]
            shares = 100 * (forces[0] / forces[1] - 1)
            share = np.nanmax(shares) if np.isfinite(shares).any() else np.nan
            rows.append({"size (mm)": 1e3 * size, "below (mm)": 1e3 * below,
                         "tetrahedra": body.cells, "without (N)": forces[1][len(ways) // 2],
                         "with (N)": forces[0][len(ways) // 2], "more (%)": share,
                         "noticed": "yes" if share > NOTICED else "no"})
            print(f"{1e3 * size:g} mm, {1e3 * below:g} mm below: {share:.3g} % more", flush=True)
    return rows


COLUMNS = {"size (mm)": ".3g", "below (mm)": ".3g", "tetrahedra": ".0f", "without (N)": ".3f",
           "with (N)": ".3f", "more (%)": ".2g", "noticed": "s"}


def draw_study(rows, path):
    curves = []
    for number, size in enumerate(dict.fromkeys(row["size (mm)"] for row in rows)):
        curves.append(Curve(f"{size:.3g} mm", [(row["below (mm)"], row["more (%)"]) for row in rows
                                               if row["size (mm)"] == size
                                               and row["more (%)"] > 0], number, 1))
    depths = [row["below (mm)"] for row in rows]
    curves.append(Curve("what a hand notices", [(min(depths), NOTICED), (max(depths), NOTICED)],
                        4, LINE))
    chart("Force on a sphere over a nodule", "how deep its top is (mm)", "% more than without it",
          [curve for curve in curves if curve.points], path, logarithmic=(False, True))


def draw_slide(ways, felt, exact_ways, exact, path):
    curves = []
    for colour, kind in enumerate(KINDS):
        known = np.isfinite(felt[colour])
        curves.append(Curve(kind, list(zip(1e3 * ways[known], felt[colour][known])), colour, LINE))
        curves.append(Curve(kind + ", exact", [
            point for point in zip(1e3 * exact_ways, exact[colour]) if np.isfinite(point[1])],
            colour, MARKS))
    chart("The sphere slides over the nodule", "way (mm)", "force along the normal (N)",
          [curve for curve in curves if curve.points], path, logarithmic=(False, False))


def draw_map(reader, array, title, organ, args, path):
    """The part of the surface that can be pressed, and as a ring where the nodule is below it."""
    values = np.array(output(reader).GetPointData().GetArray(array))
    stage = Stage(reader)
    stage.clear()
    stage.colour(stage.show(reader, Ambient=0.6, Diffuse=0.4), ("POINTS", array), title,
                 (np.nanmin(values), np.nanmax(values)))
    GetColorTransferFunction(array).NanColor = PALE
    normal = outwards(organ)
    across = np.cross(normal, [0, 1, 0])
    across /= np.linalg.norm(across)
    angles = np.linspace(0, 2 * np.pi, 65)
    ring = [x for a in angles for x in organ.closest(
        organ.place + args.size / 2 * (np.cos(a) * across + np.sin(a) * np.cross(normal, across)))
        + 0.0005 * normal]
    stage.show(Tube(Input=PolyLineSource(Points=ring, Closed=1), Radius=0.0005), INK)
    view = stage.view
    view.CameraFocalPoint = list(organ.place)
    view.CameraPosition = list(organ.place + 5 * args.region * normal)
    view.CameraViewUp = [0, 1, 0]
    view.CameraParallelScale = 1.1 * args.region
    stage.save(path)


def main():
    args = arguments().read()
    if args is None:
        return
    organ = read(args)
    slide = Slide(organ, args)
    body = Body(organ, args.size, args.below, args)
    touches, lines = zip(*(touch_of(scene, organ, name, args)
                           for scene, name in zip(body.scenes, ("nodule", "without"))))
    lines = [f"the body has {body.cells} tetrahedra", *lines]
    print(*lines, sep="\n", flush=True)
    map_reader = save_surface(map_stiffness(touches, organ, args),
                              os.path.join(args.output, "map.vtp"))
    lines.append(line_of_map(output(map_reader), organ))
    ways, exact_ways = (np.linspace(-1, 1, count) * REACH * args.tool_radius
                        for count in (DRAWN, SOLVED))
    felt = [slide.felt(touch, ways) for touch in touches]
    exact = [slide.exact(scene, exact_ways, args) for scene in body.scenes]
    off = np.nanmax([np.abs(np.interp(exact_ways, ways, a) - b) for a, b in zip(felt, exact)])
    lines.append(f"on the slide the nodule adds {100 * np.nanmax(exact[0] / exact[1] - 1):.3g} % "
                 f"to the force at the most, and the spaces are off by {1e3 * off:.2g} mN of "
                 f"{np.nanmax(exact):.3g} N")
    print(*lines[-2:], sep="\n", flush=True)
    save_csv(vtk_table([{"way (mm)": 1e3 * way, **dict(zip(KINDS, both))}
                        for way, both in zip(ways, zip(*felt))], ("way (mm)", *KINDS)),
             os.path.join(args.output, "slide.csv"))
    rows = study(organ, slide, args)
    save_table(rows, COLUMNS, [f"{line}." for line in lines], args.output)
    if not os.environ.get("DISPLAY"):
        print("nodule.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return

    def path(name):
        return os.path.join(args.output, name + ".png")

    draw_map(map_reader, "Stiffness", "Stiffness (N/m)", organ, args, path("map"))
    draw_map(map_reader, "OfTheNodule", "Of the nodule (%)", organ, args, path("of_the_nodule"))
    draw_slide(ways, felt, exact_ways, exact, path("slide"))
    draw_study(rows, path("noticed"))


if __name__ == "__main__":
    run("nodule.py", main)

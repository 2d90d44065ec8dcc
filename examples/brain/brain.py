# SPDX-License-Identifier: BSD-3-Clause
"""A brain of grey and white matter, from maps of how probable they are to a body that is touched.

The maps (NIfTI) become labels, the labels a body of two tissues, and a sphere presses its cortex.
What the state space gives is compared with what is exact at places that it has never seen, and with
the same body of one tissue.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them);
./fetch_maps gets the maps that are read without --grey and --white:
    mpiexec -n 2 pvbatch brain.py
    pvbatch brain.py --grey gm.nii.gz --white wm.nii.gz --touched 0.04 -0.02 0.07
    mpiexec -n 8 pvbatch brain.py --voxel 4 --edge 0.014 --region 0.03

The results go to the folder `out`: labels.vti, body.vtu, table.md, table.csv, slide.csv and
pictures (.png). The .palpate file there can be touched, and what was solved for is not solved for
again.
"""
import os
import sys
import time

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import Organ, save_body
from charts import LINE, MARKS, Curve, chart
from maps import Map, save_labels
from measure import peak_memory
from organ import GREY, HELD, LEAST, TISSUES, WHITE, fill, hold
from pictures import INK, Stage, show_arrow
from pipeline import Failure, boundary, field, output, update
from pressing import SHARE, Slide, touch_of
from script import Arguments, run
from tables import save_csv, save_table, vtk_table

# What the body is made of: as it is, and of one tissue.
KINDS = {"grey and white": TISSUES, "grey alone": (TISSUES[0],) * 2,
         "white alone": (TISSUES[1],) * 2}
COLOURS = ((0.72, 0.55, 0.55), (0.95, 0.93, 0.86))  # of grey and white matter
REACH = 0.6  # how far the sphere slides to both sides, in those of the region
DRAWN, SOLVED = 200, 5  # places of a slide
FROM = np.array((-0.75, 0.55, 0.45))  # where the eye is: to the left, in front and above


def arguments():
    parser = Arguments("brain.py", __doc__.splitlines()[0])
    parser.add_argument("--grey", help="map of grey matter (.nii, .nii.gz); without it, that "
                        "of the MNI template")
    parser.add_argument("--white", help="map of white matter, with the same voxels")
    parser.add_argument("--certain", type=float, help="value of the maps that stands for certain; "
                        "by default 255 in maps of bytes, and otherwise 1")
    parser.add_argument("--least", type=float, default=LEAST,
                        help="probability of both together from which on there is brain")
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--voxel", type=float, default=5.0,
                        help="of the labels, mm: the maps' voxels are joined to such")
    parser.add_argument("--edge", type=float, default=0.018, help="of the tetrahedra, m")
    parser.add_argument("--held", type=float, default=HELD,
                        help="share of the height that is held, from below")
    parser.add_argument("--touched", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="where it is pressed (the nearest point of the surface), m; by "
                        "default on the left frontal lobe")
    parser.add_argument("--tool-radius", type=float, default=0.015, help="of the sphere, m")
    parser.add_argument("--depth", type=float, default=0.005,
                        help="how deep the sphere goes into the body at rest, m")
    parser.add_argument("--spacing", type=float, default=0.006, help="of the check-points, m")
    parser.add_argument("--region", type=float, default=0.008, metavar="RADIUS",
                        help="of the part of the cortex that can be pressed, m")
    return parser


def read(args):
    """The image of labels, and a line of what is in it."""
    if min(args.voxel, args.edge, args.tool_radius, args.depth, args.spacing, args.region) <= 0:
        raise Failure("all lengths must be larger than 0.")
    if not (0 < args.least < 1 and 0 < args.held < 1):
        raise Failure("--least and --held must be between 0 and 1.")
    if (args.grey is None) != (args.white is None):
        raise Failure("--grey and --white go together.")
    if args.grey is None and not os.path.isfile(GREY):
        raise Failure("the maps of the template are not there: examples/brain/fetch_maps gets "
                      "them; or give --grey and --white.")
    os.makedirs(args.output, exist_ok=True)
    paths = (args.grey, args.white) if args.grey else (GREY, WHITE)
    maps = [Map(path, args.certain) for path in paths]
    of_maps = " × ".join(f"{number}" for number in maps[0].values.shape[::-1])
    labels, volumes = save_labels(*maps, os.path.join(args.output, "labels.vti"), args.voxel,
                                  args.least)
    return labels, (f"the maps have {of_maps} voxels; of the labels {1e6 * volumes[0]:.0f} cm³ are "
                    f"grey and {1e6 * volumes[1]:.0f} cm³ white")


def make_body(labels, args):
    """The body, and a line of what became of the image."""
    filled = update(fill(labels, args.edge))
    data = output(filled)
    off = 100 * np.abs(np.divide(field(data, "MeshVolume"), field(data, "ImageVolume")) - 1).max()
    lines = field(data, "Report")[0].splitlines()
    line = (f"the body has {data.GetNumberOfCells()} quadratic tetrahedra and "
            f"{data.GetNumberOfPoints()} points; the volume of a tissue is off by {off:.2g} % at "
            "the most; " + " ".join(line for line in lines if "island" in line or "holes" in line))
    return save_body(data, os.path.join(args.output, "body.vtu")), line.rstrip(".; ")


def compare(slide, touch, scenes, args):
    """Ways and forces of the space, and those that are exact of each body, by its name."""
    reach = REACH * args.region
    ways, exact_ways = (np.linspace(-reach, reach, count) for count in (DRAWN, SOLVED))
    felt = slide.felt(touch, ways)
    exact = {}
    for kind, scene in scenes.items():
        exact[kind] = slide.exact(scene, exact_ways, args)
        print(f"{kind}: {np.nanmax(exact[kind]):.3g} N on the slide at the most", flush=True)
    return ways, felt, exact_ways, exact


def rows_of(ways, felt, exact_ways, exact):
    """A row a place that was solved for: the exact forces, and what the space gives there."""
    of_space = np.interp(exact_ways, ways, felt)
    both = exact[next(iter(KINDS))]
    largest = np.nanmax(both)
    return [{"way (mm)": 1e3 * exact_ways[i], "space (N)": of_space[i],
             "off (% of the largest)": 100 * abs(of_space[i] - both[i]) / largest,
             **{f"{kind} (N)": forces[i] for kind, forces in exact.items()}}
            for i in range(len(exact_ways))]


COLUMNS = {"way (mm)": ".2g", "space (N)": ".4f", "off (% of the largest)": ".2g",
           **{f"{kind} (N)": ".4f" for kind in KINDS}}


def lines_of(rows):
    both, *alone = [np.array([row[f"{kind} (N)"] for row in rows]) for kind in KINDS]
    off = np.array([row["off (% of the largest)"] for row in rows])
    if not np.isfinite(off).any():
        raise Failure("the space reaches no place of the slide: a larger --region or --depth.")
    lines = [f"at {np.isfinite(off).sum()} places that it has never seen the space is off by "
             f"{np.nanmean(off):.2g} % of the largest force, {np.nanmax(both):.3g} N, in the mean, "
             f"and by {np.nanmax(off):.2g} % at the most"]
    for kind, forces in zip(list(KINDS)[1:], alone):
        more = 100 * (forces / both - 1)
        lines.append(f"of {kind} it takes another force than of grey and white: "
                     f"{np.nanmin(more):+.3g} to {np.nanmax(more):+.3g} %")
    return lines


def draw_slide(ways, felt, exact_ways, exact, path):
    known = np.isfinite(felt)
    curves = [Curve("grey and white, space", list(zip(1e3 * ways[known], felt[known])), 0, LINE)]
    for colour, (kind, forces) in enumerate(exact.items()):
        points = [point for point in zip(1e3 * exact_ways, forces) if np.isfinite(point[1])]
        curves.append(Curve(kind + ", exact", points, colour, MARKS if colour == 0 else 1))
    chart("The sphere slides over the cortex", "way (mm)", "force along the normal (N)",
          [curve for curve in curves if curve.points], path, logarithmic=(False, False))


def stage_of(scene, eye):
    """As Stage, seen by the eye in that direction, with z up."""
    stage = Stage(scene)
    stage.view.CameraViewUp = [0, 0, 1]
    stage.view.CameraPosition = list(np.array(stage.view.CameraFocalPoint) + eye)
    ResetCamera(stage.view)
    stage.view.CameraParallelScale *= 0.8
    stage.clear()
    return stage


def draw_tissues(scene, place, path):
    """The body cut open across, through the place that is pressed."""
    cut = Clip(Input=scene, ClipType="Plane")
    cut.ClipType.Origin, cut.ClipType.Normal = list(place), [0, 1, 0]
    stage = stage_of(scene, np.array((-0.3, 0.9, 0.35)))
    for region, colour in enumerate(COLOURS, 1):
        stage.show(Threshold(Input=cut, Scalars=["CELLS", "RegionId"], LowerThreshold=region,
                             UpperThreshold=region), colour)
    stage.save(path)


def draw_pressed(slide, scene, touch, path, args):
    """The cortex with the sphere in it, and the force on the hand."""
    touch.ToolPosition = slide.at(0)
    force = np.array(field(output(update(touch)), "Force"))
    size = np.linalg.norm(force)
    pressure = touch.PointData["ContactPressure"].GetRange()
    stage = stage_of(scene, FROM)
    stage.show_held()
    stage.colour(stage.show(touch), ("POINTS", "ContactPressure"), "Pressure (Pa)",
                 (0, max(pressure[1], 1)))
    # Not translucent: several ranks would exchange it, which recent releases of Expat prevent.
    stage.show(Sphere(Center=slide.at(0), Radius=args.tool_radius, ThetaResolution=24,
                      PhiResolution=16), INK, Representation="Wireframe")
    if size > 0:
        show_arrow(stage, slide.middle, -0.3 * stage.size * force / size)
    stage.write(f"{1e3 * SHARE * args.depth:.1f} mm deep: {size:.2f} N")
    stage.save(path)


def main():
    start = time.monotonic()
    args = arguments().read()
    if args is None:
        return
    labels, line = read(args)
    lines = [line]
    print(line, flush=True)
    body, line = make_body(labels, args)
    lines.append(line)
    print(line, flush=True)
    scenes = {kind: update(hold(body, tissues, args.held)) for kind, tissues in KINDS.items()}
    both = scenes[next(iter(KINDS))]
    organ = Organ(boundary(output(body)), args.touched)
    touch, line = touch_of(both, organ, "brain", args)
    lines.append(line)
    print(line, flush=True)
    slide = Slide(organ, args)
    compared = compare(slide, touch, scenes, args)
    rows = rows_of(*compared)
    lines += lines_of(rows)
    ways, felt, _, _ = compared
    save_csv(vtk_table([{"way (mm)": 1e3 * way, "force (N)": force}
                        for way, force in zip(ways, felt)], ("way (mm)", "force (N)")),
             os.path.join(args.output, "slide.csv"))
    memory = " and ".join(f"{megabytes:.0f}" for megabytes in peak_memory())
    lines.append(f"all of it took {time.monotonic() - start:.0f} s and, rank by rank, {memory} MB "
                 "of memory")
    save_table(rows, COLUMNS, [f"{line}." for line in lines], args.output)
    if not os.environ.get("DISPLAY"):
        print("brain.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return

    def path(name):
        return os.path.join(args.output, name + ".png")

    draw_tissues(body, organ.place, path("tissues"))
    draw_pressed(slide, both, touch, path("pressed"), args)
    draw_slide(*compared, path("slide"))


if __name__ == "__main__":
    run("brain.py", main)

# SPDX-License-Identifier: BSD-3-Clause
"""A lobe of a liver that is torn: topology as a dimension of the state space.

A sheet is put into the left lobe, from its tip inwards. All stages of the cut along it are explored
into one space. Then a tool that is bonded to the lower half of the lobe pulls it down and back, and
the lobe tears from a notch on, as far as the energy that it releases pays for the toughness of the
tissue.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch tear.py
    pvbatch tear.py --toughness 3 --notch 0.02
    pvbatch tear.py --stage-spacing 0.02 --resolution 3 --element-order Linear

The results go to the folder `out`: table.md, table.csv (the pull), stages.csv (each stage beside
solves that the space never saw), tear.palpate and pictures (.png).
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from bodies import on_surface, places
from charts import Curve, chart
from pictures import HAND, Stage, show_arrow
from pipeline import Failure, field, output, update
from script import Arguments, run
from tables import markdown, save_csv, save_table, vtk_table

SURFACE = os.path.join(sys.path[0], "..", "liver", "liver.vtp")
YOUNG, POISSON = 5e3, 0.45  # Pa, no unit
HELD = 0.02  # the liver is held from here to the patient's right, m
# The sheet comes to the tip of the left lobe from outside, and goes inwards between its halves, m.
TIP, INNER, HEIGHT, WIDTH = 0.13, 0.05, 0.034, 0.1
PULLED = (0.1, 0.018, 0.01)  # near the point that is pulled, on the lower half, m
DIRECTION = np.array([0.3, -0.95, 0.0]) / np.hypot(0.3, 0.95)
TIP_RADIUS = 0.012  # of what holds the lobe, m
FROM = np.array((0.6, 0.1, 1.1))  # whence it is seen
CONVERGED = 0
# Places of the tool that the space has no configuration at, in half-widths of its box.
UNSEEN = ((0.3, -0.7, 0.1), (0.6, -0.4, -0.3), (-0.2, -0.8, 0.3), (0.2, -0.3, 0.6))


def arguments():
    parser = Arguments("tear.py", __doc__.splitlines()[0])
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--element-order", choices=("Linear", "Quadratic"), default="Quadratic",
                        help="of the tetrahedra")
    parser.add_argument("--stage-spacing", type=float, default=0.015, help="of the fronts, m")
    parser.add_argument("--half-width", type=float, default=0.02, help="of the space, m")
    parser.add_argument("--resolution", type=int, default=5, help="check-points along an axis")
    parser.add_argument("--toughness", type=float, default=1.5, help="of the tissue, J/m²")
    parser.add_argument("--notch", type=float, default=0.02,
                        help="how far the cut is open before it is pulled, m")
    parser.add_argument("--steps", type=int, default=40, help="of the pull, and of the way back")
    return parser


def make_scene(body, spacing, stage=0):
    sheet = Plane(Origin=[TIP, HEIGHT, -WIDTH], Point1=[INNER, HEIGHT, -WIDTH],
                  Point2=[TIP, HEIGHT, WIDTH], XResolution=20, YResolution=20)
    cut = PlaceCut(Input=body, Sheet=sheet, CutDirection=[-1, 0, 0], StageSpacing=spacing,
                   Stage=stage)
    material = AssignMaterial(Input=cut, Law="Neo-Hookean", YoungsModulus=YOUNG,
                              PoissonsRatio=POISSON)
    scene = SetBoundary(Input=material, FixedRegion="Plane")
    scene.FixedRegion.Origin, scene.FixedRegion.Normal = [HELD, 0, 0], [1, 0, 0]
    return update(scene)


def pulled_node(scene):
    """The point of the surface that is nearest to where the lobe is pulled."""
    grid = output(scene)
    distance = np.linalg.norm(places(grid) - PULLED, axis=1)
    distance[~on_surface(grid)] = np.inf
    return int(distance.argmin())


def touched(touch, way, area, toughness):
    """Force, energy, area and release rate where the tool is moved by `way`, m."""
    touch.Displacement, touch.TornArea, touch.FractureToughness = list(way), area, toughness
    data = output(update(touch))
    return (np.array(field(data, "Force")), field(data, "Energy")[0], field(data, "TornArea")[0],
            field(data, "ReleaseRate")[0])


STAGE_COLUMNS = {"stage": "d", "front (mm)": ".0f", "area (cm²)": ".2f", "cells": "d",
                 "force (N)": ".3f", "off (%)": ".2f", "energy (mJ)": ".2f",
                 "energy off (%)": ".2f", "G (J/m²)": ".2f", "G off (%)": ".1f"}


def compare_stages(body, touch, node, args):
    """Each stage beside direct solves at places that the space never saw."""
    closed = output(touch.Input.Input)
    areas = field(closed, "StageArea")
    fronts = np.array(field(closed, "StageFront")) - field(closed, "StageFront")[0]
    ways = [args.half_width * np.array(place) for place in UNSEEN]
    rows, before = [], None
    for stage, area in enumerate(areas):
        scene = make_scene(body, args.stage_spacing, stage)
        forces, energies = [], []
        for way in ways:
            solved = output(update(SolveEquilibrium(Input=scene, ActiveNodes=[node],
                                                    TipRadius=TIP_RADIUS,
                                                    Displacement=list(way))))
            if field(solved, "Outcome")[0] != CONVERGED:
                raise Failure("a solve found no equilibrium: " + field(solved, "Message")[0])
            forces.append(field(solved, "ReactionForce"))
            energies.append(field(solved, "Energy")[0])
        found = [touched(touch, way, area, 0) for way in ways]
        forces, energies = np.array(forces), np.array(energies)
        off = np.linalg.norm([one[0] for one in found] - forces, axis=1)
        largest = np.linalg.norm(forces, axis=1).max()
        of_space = np.array([one[1] for one in found])
        row = {"stage": stage, "front (mm)": 1e3 * fronts[stage], "area (cm²)": 1e4 * area,
               "cells": output(scene).GetNumberOfCells(), "force (N)": largest,
               "off (%)": 100 * off.max() / largest, "energy (mJ)": 1e3 * energies[0],
               "energy off (%)": 100 * (np.abs(of_space - energies) / energies).max(),
               "G (J/m²)": np.nan, "G off (%)": np.nan}
        if before is not None:
            step = area - areas[stage - 1]
            right, wrong = ((now - then)[0] / -step for now, then in
                            ((energies, before[0]), (of_space, before[1])))
            row["G (J/m²)"], row["G off (%)"] = right, 100 * (wrong / right - 1)
        before = energies, of_space
        rows.append(row)
        print(", ".join(f"{title} {row[title]:{form}}" for title, form in STAGE_COLUMNS.items()),
              flush=True)
    return rows, areas, fronts


COLUMNS = {"way (mm)": ".2f", "force (N)": ".4f", "torn (cm²)": ".3f", "G (J/m²)": ".3f",
           "work (mJ)": ".3f", "stored (mJ)": ".3f", "tearing (mJ)": ".3f", "lost (mJ)": ".3f"}


def pull(touch, begin, args):
    """The way of the tool there and back: what it takes, and where its work goes. Within a step the
    area stays as it is, so that the work is the change of the energy; then it tears."""
    ways = np.linspace(0, args.half_width, args.steps + 1)
    rows, area, work, stored = [], begin, 0.0, 0.0
    for way in [*ways, *ways[-2::-1]]:
        place = way * DIRECTION
        _, energy, _, _ = touched(touch, place, area, 0)
        work += energy - stored
        force, stored, area, rate = touched(touch, place, area, args.toughness)
        torn = args.toughness * (area - begin)
        rows.append({"way (mm)": 1e3 * way, "force (N)": force @ DIRECTION,
                     "torn (cm²)": 1e4 * area, "G (J/m²)": rate, "work (mJ)": 1e3 * work,
                     "stored (mJ)": 1e3 * stored, "tearing (mJ)": 1e3 * torn,
                     "lost (mJ)": 1e3 * (work - stored - torn)})
    return rows


def draw(scene, touch, node, rows, begin, args):
    def path(name):
        return os.path.join(args.output, name + ".png")

    stage = Stage(scene)
    view = stage.view
    view.CameraPosition = list(np.array(view.CameraFocalPoint) + FROM)
    farthest = rows[args.steps]
    for name, way, area, text in (
            ("rest", 0.0, begin, "At rest, with a notch. The arrow is where it is pulled."),
            ("notched", args.half_width, begin, "Pulled, if it did not tear"),
            ("torn", args.half_width, 1e-4 * farthest["torn (cm²)"], "Pulled and torn")):
        touched(touch, way * DIRECTION, area, 0)
        stage.clear()
        stage.show_touched(touch, args.half_width)
        place = np.array(places(output(scene))[node]) + way * DIRECTION
        stage.show(Sphere(Center=list(place), Radius=0.012 * stage.size), HAND)
        show_arrow(stage, place, 0.03 * DIRECTION)
        stage.write(text)
        stage.save(path(name))
    there, back = rows[:args.steps + 1], rows[args.steps:]

    def curve(title, column, part, colour, style):
        return Curve(title, [(row["way (mm)"], row[column]) for row in part], colour, style)

    flat = {"logarithmic": (False, False)}
    chart("A lobe that is pulled and tears", "way of the tool (mm)", "force along the way (N)",
          [curve("there", "force (N)", there, 1, 3), curve("back", "force (N)", back, 0, 3)],
          path("force"), **flat)
    chart("Where the work goes", "way of the tool (mm)", "energy (mJ)",
          [curve("work of the hand", "work (mJ)", there, 4, 3),
           curve("stored", "stored (mJ)", there, 0, 3),
           curve("into tearing", "tearing (mJ)", there, 1, 3),
           curve("lost where it snaps", "lost (mJ)", there, 2, 3)], path("energy"), **flat)


def main():
    args = arguments().read()
    if args is None:
        return
    if min(args.stage_spacing, args.half_width, args.toughness, args.steps) <= 0 or args.notch < 0:
        raise Failure("lengths, the toughness and the number of steps must be larger than 0.")
    os.makedirs(args.output, exist_ok=True)
    body = update(TetrahedralizeSurface(Input=update(OpenDataFile(SURFACE)),
                                        ElementOrder=args.element_order, PreserveSurface=1))
    scene = make_scene(body, args.stage_spacing)
    node = pulled_node(scene)
    space = update(PrecomputeStateSpace(
        Input=scene, ActiveNodes=[node], TipRadius=TIP_RADIUS, HalfWidth=args.half_width,
        Resolution=args.resolution, FileName=os.path.join(args.output, "tear.palpate")))
    touch = TouchStateSpace(Input=space, ActiveNode=node)
    stages, areas, fronts = compare_stages(body, touch, node, args)
    save_csv(vtk_table(stages, STAGE_COLUMNS), os.path.join(args.output, "stages.csv"))
    begin = float(np.interp(args.notch, fronts, areas))
    rows = pull(touch, begin, args)
    end = rows[args.steps]
    save_table(rows, COLUMNS, [
        f"Pulled by {end['way (mm)']:.0f} mm, it tears from {1e4 * begin:.2f} to "
        f"{end['torn (cm²)']:.2f} cm² of {1e4 * areas[-1]:.2f}; the hand does "
        f"{end['work (mJ)']:.2f} mJ, of which {end['stored (mJ)']:.2f} are stored, "
        f"{end['tearing (mJ)']:.2f} went into tearing and {end['lost (mJ)']:.2f} are lost."],
        args.output, markdown(stages, STAGE_COLUMNS))
    if not os.environ.get("DISPLAY"):
        print("tear.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return
    draw(scene, touch, node, rows, begin, args)


if __name__ == "__main__":
    run("tear.py", main)

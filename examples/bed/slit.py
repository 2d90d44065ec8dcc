# SPDX-License-Identifier: BSD-3-Clause
"""A slit that a tool opens and closes, beside the same block without it.

The slit runs along the middle of a block, from its top to half of its height: on both sides it has
points of its own at the same places. Two tools beside it pull its lips apart, so that it opens, and
squeeze them, so that it is closed and the lips press each other. A sphere presses the block beside
the slit, and on it.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvbatch slit.py
    pvbatch slit.py --cells 16 10 10

The results go to the folder `out/slit`: table.md, table.csv and pictures (.png).
"""
import itertools
import os
import sys
import time

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, vtkCellArray, vtkUnstructuredGrid

from bodies import corners_of, places, save_body
from charts import LINE, MARKS, Curve, chart
from pictures import HAND, TISSUE, Stage
from pipeline import Failure, field, output, update
from script import Arguments, run
from tables import save_table

LOW, HIGH = np.array([[-0.03, 0.0, 0.0], [0.03, 0.04, 0.03]])  # corners of the block, m
MIDDLE, TOP = 0.02, 0.03  # along the slit, and upwards, m
BOTTOM = 0.5 * TOP  # of the slit, m
YOUNG, POISSON = 5e3, 0.45  # Pa, no unit
BESIDE = 0.012  # how far from the slit the tools are, m
# Midside nodes of a tetrahedron, in VTK's order.
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
BALL = 0.0015  # radius of what shows a tool, m
THIN = 0.25  # of the layer of contact that is taken by default
CONVERGED = 0


def arguments():
    parser = Arguments("slit.py", __doc__.splitlines()[0])
    parser.add_argument("--output", default=os.path.join("out", "slit"),
                        help="folder of the results")
    parser.add_argument("--cells", type=int, nargs=3, default=[10, 6, 6], metavar=("X", "Y", "Z"),
                        help="bricks of six tetrahedra along each side; X and Z even")
    parser.add_argument("--ways", type=float, nargs="+",
                        default=[-0.002, -0.001, 0.001, 0.002, 0.003],
                        help="of the two tools, by which they pull the lips apart or, below 0, "
                        "squeeze them, m")
    parser.add_argument("--tip-radius", type=float, default=0.006, help="of these two, m")
    parser.add_argument("--tool-radius", type=float, default=0.01, help="of the sphere, m")
    parser.add_argument("--depth", type=float, default=0.005, help="of the sphere, m")
    return parser


def corners_of_block(cells):
    """The points of a grid of bricks, and the corners of six tetrahedra in each."""
    numbers = np.array(cells) + 1
    index = np.stack(np.meshgrid(*map(np.arange, numbers), indexing="ij"), axis=-1).reshape(-1, 3)
    points = LOW + index / (numbers - 1) * (HIGH - LOW)
    strides = np.array([numbers[1] * numbers[2], numbers[2], 1])
    first = np.flatnonzero((index < numbers - 1).all(axis=1))
    tetrahedra = []
    for order in itertools.permutations(range(3)):
        # From the first corner of a brick along the three axes, one after the other, to the last.
        steps = np.concatenate([[0], np.cumsum(strides[list(order)])])
        if np.linalg.det(np.eye(3)[list(order)]) < 0:
            steps = steps[[0, 2, 1, 3]]
        tetrahedra.append(first[:, None] + steps)
    return points, np.concatenate(tetrahedra)


def block(cells, cut):
    """Quadratic tetrahedra; with the slit points on it are there twice."""
    points, corners = corners_of_block(cells)
    if cut:
        slack = 1e-9
        twice = np.flatnonzero((np.abs(points[:, 0]) < slack) & (points[:, 2] > BOTTOM + slack))
        other = np.arange(len(points))
        other[twice] = len(points) + np.arange(len(twice))
        right = points[corners].mean(axis=1)[:, 0] > 0
        corners[right] = other[corners[right]]
        points = np.concatenate([points, points[twice]])
    pairs = np.sort(corners[:, EDGES].reshape(-1, 2), axis=1)
    edges, which = np.unique(pairs, axis=0, return_inverse=True)
    nodes = np.hstack([corners, len(points) + which.reshape(-1, len(EDGES))])
    points = np.concatenate([points, points[edges].mean(axis=1)])
    grid, vtk_points, array = vtkUnstructuredGrid(), vtkPoints(), vtkCellArray()
    vtk_points.SetData(numpy_to_vtk(points, deep=True))
    array.SetData(nodes.shape[1], numpy_to_vtkIdTypeArray(nodes.ravel(), deep=True))
    grid.SetPoints(vtk_points)
    grid.SetCells(VTK_QUADRATIC_TETRA, array)
    return grid


def lips(grid):
    """The points of the slit on its left side, and those of its right side at the same places."""
    order = np.lexsort(np.round(places(grid), 9).T)
    same = np.flatnonzero((np.abs(np.diff(places(grid)[order], axis=0)) < 1e-9).all(axis=1))
    pairs = np.stack([order[same], order[same + 1]])
    # The points of a cell to the right of the slit are not in the cells to its left.
    nodes = np.array(grid.GetCells().GetConnectivityArray()).reshape(-1, 10)
    right = np.unique(nodes[places(grid)[nodes].mean(axis=1)[:, 0] > 0])
    first_is_right = np.isin(pairs[0], right)
    return np.where(first_is_right, pairs[::-1], pairs)


def make_scene(body, contact="None", thickness=0.0):
    material = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=YOUNG,
                              PoissonsRatio=POISSON)
    scene = SetBoundary(Input=material, FixedRegion="Plane", Contact=contact,
                        ContactThickness=thickness)
    scene.FixedRegion.Origin, scene.FixedRegion.Normal = [0, 0, 1e-6], [0, 0, 1]
    return update(scene)


def title_of(way):
    return f"{'pulled apart' if way > 0 else 'squeezed'}, {1e3 * abs(way):g} mm each"


def held_nodes(grid):
    """The corners on both sides of the slit that the two tools hold. With the slit and without it
    they have the same ids, for the points that are there twice follow after the others."""
    corners = np.unique(corners_of(grid))
    return [int(corners[np.linalg.norm(places(grid)[corners] - [x, MIDDLE, TOP], axis=1).argmin()])
            for x in (-BESIDE, BESIDE)]


def touches(grid, args):
    """What the tools do: a title, how far lips are moved apart, m, the direction in which the force
    of the first tool is counted, and the settings of the solve."""
    nodes = held_nodes(grid)
    for way in sorted(args.ways):
        yield (title_of(way), way,
               np.array([-np.sign(way), 0, 0]),
               {"ActiveNodes": nodes, "TipRadius": args.tip_radius,
                "Displacement": [-way, 0, 0, way, 0, 0]})
    for title, x in (("a sphere beside the slit", BESIDE), ("a sphere on the slit", 0.0)):
        yield (title, None, np.array([0, 0, -1]),
               {"Tool": "Sphere", "ToolRadius": args.tool_radius, "Increments": 2,
                "ToolPosition": [x, MIDDLE, TOP + args.tool_radius - args.depth]})


COLUMNS = {"tool": "s", "uncut (N)": ".3f", "cut (%)": ".1f", "less the layer (%)": ".1f",
           "thin (%)": ".1f", "no contact (%)": ".1f", "opens (mm)": ".2f",
           "gap (mm)": ".2f", "cut, inside (mm)": ".2f", "thin, inside (mm)": ".2f",
           "no contact, inside (mm)": ".2f", "uncut (s)": ".1f", "cut (s)": ".1f",
           "thin (s)": ".1f"}


def apart(data):
    """How far the lips have come apart across the slit, at each of its points, m."""
    left, right = lips(data)
    displacement = np.array(data.GetPointData().GetArray("Displacement"))
    return (displacement[right] - displacement[left])[:, 0]


def measure(scenes, args):
    """Rows of the table, and the filters of the block with the slit."""
    rows, solved = [], {}
    for title, way, direction, settings in touches(output(scenes["cut"]), args):
        row = {"tool": title, "way (mm)": None if way is None else 1e3 * way}
        for name, scene in scenes.items():
            start = time.perf_counter()
            found = update(SolveEquilibrium(Input=scene, **settings))
            row[f"{name} (s)"] = time.perf_counter() - start
            data = output(found)
            if field(data, "Outcome")[0] != CONVERGED:
                raise Failure(f"{title}, {name}: {field(data, 'Message')[0]}")
            force = row[f"{name} (N)"] = direction @ field(data, "ReactionForce")[:3]
            row[f"{name} (%)"] = 100 * (force / row["uncut (N)"] - 1)
            if name in ("cut", "thin"):
                row[f"{name}, inside (mm)"] = 1e3 * field(data, "PartPenetration")[0]
            if name == "cut":
                solved[title] = found
                row["opens (mm)"] = 1e3 * max(0, apart(data).max())
                gap = np.array(data.GetPointData().GetArray("PartGap"))
                row["gap (mm)"] = 1e3 * np.nanmean(gap[lips(data)])
                hard = force - direction @ field(data, "PartLayerForce")[:3]
                row["less the layer (%)"] = 100 * (hard / row["uncut (N)"] - 1)
            if name == "no contact":
                row["no contact, inside (mm)"] = 1e3 * max(0, -apart(data).min())
        rows.append(row)
        print(", ".join(f"{column} {row[column]:{form}}" for column, form in COLUMNS.items()),
              flush=True)
    return rows, solved


def draw(found, balls, radius, text, path):
    """The block behind a plane through the tools, with a ball at each."""
    stage = Stage(found)
    view = stage.view
    view.CameraViewUp = [0, 0, 1]
    view.CameraFocalPoint = [0, MIDDLE, 0.6 * TOP]
    view.CameraPosition = list(np.add(view.CameraFocalPoint, (0.06, -0.5, 0.2)))
    view.CameraParallelScale = 0.9 * TOP
    stage.clear()
    cut = Clip(Input=WarpByVector(Input=found, Vectors=["POINTS", "Displacement"]),
               ClipType="Plane", Invert=0)
    cut.ClipType.Origin, cut.ClipType.Normal = [0, MIDDLE, 0], [0, 1, 0]
    stage.show(update(cut), TISSUE, Representation="Surface With Edges",
               EdgeColor=[0.7 * x for x in TISSUE])
    for ball in balls:
        stage.show(Sphere(Center=list(ball), Radius=radius, ThetaResolution=48,
                          PhiResolution=48), HAND)
    stage.write(text)
    stage.save(path)


def draw_chart(rows, path):
    rows = [row for row in rows if row["way (mm)"] is not None]
    for row in rows:
        row["less the layer (N)"] = row["uncut (N)"] * (1 + row["less the layer (%)"] / 100)

    def curve(title, name, colour, style):
        return Curve(title, [(0, 0)] + [
            (row["way (mm)"], np.sign(row["way (mm)"]) * row[f"{name} (N)"]) for row in rows],
            colour, style)

    chart("Two tools beside a slit", "each pulls its lip away by (mm); below 0: squeezes",
          "force on each (N)",
          [curve("without the slit", "uncut", 4, LINE), curve("with the slit", "cut", 0, 1),
           curve("… less the error of the layer", "less the layer", 2, MARKS),
           curve("with the slit, without contact", "no contact", 1, 2)], path,
          logarithmic=(False, False))


def main():
    args = arguments().read()
    if args is None:
        return
    if min(args.cells) < 4 or args.cells[0] % 2 or args.cells[2] % 2:
        raise Failure("--cells takes three numbers from 4 on, the first and the last of them even.")
    if not min(args.ways) < 0 < max(args.ways) or 0 in args.ways:
        raise Failure("--ways takes numbers below 0 and above 0.")
    if min(args.tool_radius, args.depth) <= 0 or args.tip_radius < 0:
        raise Failure("--tool-radius and --depth must be larger than 0.")
    os.makedirs(args.output, exist_ok=True)
    uncut, cut = (save_body(block(args.cells, slit), os.path.join(args.output, name + ".vtu"))
                  for slit, name in ((False, "uncut"), (True, "cut")))
    scenes = {"uncut": make_scene(uncut), "cut": make_scene(cut, "Also With Themselves")}
    thickness = field(output(scenes["cut"]), "PartContact")[1]
    scenes["thin"] = make_scene(cut, "Also With Themselves", THIN * thickness)
    scenes["no contact"] = make_scene(cut)
    rows, solved = measure(scenes, args)
    grid = output(scenes["cut"])
    save_table(rows, COLUMNS, [f"{grid.GetNumberOfCells()} quadratic tetrahedra, "
                               f"{grid.GetNumberOfPoints()} points."], args.output)
    if not os.environ.get("DISPLAY"):
        print("slit.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)
        return

    def path(name):
        return os.path.join(args.output, name + ".png")

    for name, way in (("opened", max(args.ways)), ("squeezed", min(args.ways))):
        title = title_of(way)
        balls = [places(grid)[node] + [sign * way, 0, 0]
                 for sign, node in zip((-1, 1), held_nodes(grid))]
        draw(solved[title], balls, BALL, title.capitalize(), path(name))
    title = "a sphere on the slit"
    draw(solved[title], [(0, MIDDLE, TOP + args.tool_radius - args.depth)], args.tool_radius,
         title.capitalize(), path("pressed"))
    draw_chart(rows, path("force"))


if __name__ == "__main__":
    run("slit.py", main)

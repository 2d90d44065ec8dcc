# SPDX-License-Identifier: BSD-3-Clause
"""A body that snaps through: the hinged cylindrical roof, with levels and without.

The roof (R = 2540 mm, half angle 0.1 rad, length 508 mm, 6.35 mm thick, E = 3102.75 MPa, nu = 0.3)
is hinged along its straight edges and pressed at the middle of a free one, with a tool of 4 cm. It
has two branches: pressed down it jumps at one deflection, let go it jumps back at another.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvpython roof.py
    mpiexec -n 4 pvbatch roof.py --resolution 61 --cells 6

The results go to the folder `out`: table.csv, table.md, and pictures (.png).
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, vtkCellArray, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from charts import Curve, chart
from pipeline import Failure, field, update
from pipeline import output as data_of  # the sources of charts remove a global named output
from script import Arguments, run
from tables import markdown, save_csv, vtk_table

RADIUS, HALF_ANGLE, LENGTH, THICKNESS = 2.54, 0.1, 0.508, 0.00635
YOUNG, POISSON = 3102.75e6, 0.3
TIP = 0.04
# A brick as six tetrahedra: the ways from one corner to the opposite one along its edges.
WAYS = ((0, 1, 2), (0, 2, 1), (1, 0, 2), (1, 2, 0), (2, 0, 1), (2, 1, 0))
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
COLUMNS = {"deflection (mm)": ".1f", "pressed (N)": ".1f", "branch": ".0f", "let go (N)": ".1f",
           "branch then": ".0f", "without levels (N)": ".1f", "found": ".0f"}


def arguments():
    parser = Arguments("roof.py", __doc__.splitlines()[0])
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--cells", type=int, default=4, help="bricks along half of an edge")
    parser.add_argument("--half-width", type=float, default=0.03, help="deepest deflection, m")
    parser.add_argument("--resolution", type=int, default=31, help="check-points along an axis")
    parser.add_argument("--force-limit", type=float, default=5000, help="N")
    parser.add_argument("--steps", type=int, default=120, help="of the loop, one way")
    return parser


def make_roof(cells):
    """Tet10 with the point array Fixed, and the id of the point that is pressed."""
    # Places of points in halves of a brick: along the arc, along the length, through the thickness.
    size = np.array([4 * cells + 1, 4 * cells + 1, 3])
    s = np.stack(np.meshgrid(*map(np.arange, size), indexing="ij"), axis=-1).reshape(-1, 3)
    angle = HALF_ANGLE * (s[:, 0] / (2 * cells) - 1)
    radius = RADIUS + THICKNESS / 2 * (s[:, 2] - 1)
    points = np.stack([radius * np.sin(angle), LENGTH / 2 * (s[:, 1] / (2 * cells) - 1),
                       radius * np.cos(angle)], axis=-1)
    hinge = ((s[:, 0] == 0) | (s[:, 0] == 4 * cells)) & (s[:, 2] == 1)

    tetrahedra = []
    for i in range(2 * cells):
        for j in range(2 * cells):
            # Mirror images in both planes of symmetry.
            signs = np.array([1 if i >= cells else -1, 1 if j >= cells else -1, 1])
            first = np.array([2 * i, 2 * j, 0]) + np.where(signs < 0, 2, 0)
            for way in WAYS:
                corners = [first]
                for axis in way:
                    corners.append(corners[-1] + 2 * signs[axis] * np.eye(3, dtype=int)[axis])
                a, b, c = (corners[k] - corners[0] for k in (1, 2, 3))
                if np.dot(np.cross(a * [1, 1, 1], b), c) < 0:
                    corners[1], corners[2] = corners[2], corners[1]
                nodes = corners + [(corners[p] + corners[q]) // 2 for p, q in EDGES]
                tetrahedra.append([int(np.dot(n, [size[1] * size[2], size[2], 1])) for n in nodes])
    used = np.unique(tetrahedra)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))

    places = vtkPoints()
    places.SetData(numpy_to_vtk(points[used], deep=True))
    grid = vtkUnstructuredGrid()
    grid.SetPoints(places)
    cell_array = vtkCellArray()
    for nodes in number[np.array(tetrahedra)]:
        cell_array.InsertNextCell(10, nodes.tolist())
    grid.SetCells(VTK_QUADRATIC_TETRA, cell_array)
    fixed = numpy_to_vtk(hinge[used].astype(np.int8), deep=True)
    fixed.SetName("Fixed")
    grid.GetPointData().AddArray(fixed)
    pressed = np.array([0, LENGTH / 2, RADIUS + THICKNESS / 2])
    return grid, int(np.argmin(np.linalg.norm(points[used] - pressed, axis=1)))


def save_grid(grid, path):
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()
    writer.SetFileName(path)
    if not writer.Write():
        raise Failure(f"cannot write {path}.")
    return update(OpenDataFile(path))


def loop(space, node, args):
    """Deflection, force and branch on the way down and back, m and N, and what was found."""
    touch = TouchStateSpace(Input=space, ActiveNode=node)
    rows = []
    for start in (0, args.half_width):
        touch.StartDisplacement = [0, 0, -start]
        rows.append([])
        for deflection in np.linspace(0, args.half_width, args.steps + 1):
            touch.Displacement = [0, 0, -deflection]
            data = data_of(update(touch))
            rows[-1].append((deflection, -field(data, "Force")[2], field(data, "Branch")[0],
                             field(data, "Found")[0]))
    return rows


def jump(rows):
    """The first deflection on another branch than the one before it, or None."""
    for before, after in zip(rows, rows[1:]):
        if before[2] != after[2]:
            return after[0]
    return None


def picture(space, node, ways, path):
    """One body beside the other, each moved from one deflection to another, four times as high."""
    view = CreateView("RenderView")
    view.ViewSize, view.Background, view.UseColorPaletteForBackground = [1200, 500], [1, 1, 1], 0
    view.OrientationAxesVisibility = 0
    for number, (start, deflection) in enumerate(ways):
        touch = update(TouchStateSpace(Input=space, ActiveNode=node,
                                       StartDisplacement=[0, 0, -start],
                                       Displacement=[0, 0, -deflection]))
        shown = Transform(Input=touch)
        shown.Transform.Translate = [0.62 * number, 0, 0]
        shown.Transform.Scale = [1, 1, 4]
        display = Show(shown, view)
        ColorBy(display, ("POINTS", "Displacement", "Z"))
        display.SetScalarBarVisibility(view, number == 0)
    view.ResetCamera()
    view.CameraPosition = [0.62, -2.6, 11.1]
    view.CameraFocalPoint = [0.62, 0.0, 10.13]
    view.CameraViewUp = [0, 0, 1]
    view.CameraViewAngle = 18
    SaveScreenshot(path, view)
    Delete(view)


def main():
    args = arguments().read()
    if args is None:
        return
    os.makedirs(args.output, exist_ok=True)
    grid, node = make_roof(args.cells)
    body = save_grid(grid, os.path.join(args.output, "roof.vtu"))
    scene = AssignMaterial(Input=body, Law="St. Venant-Kirchhoff", YoungsModulus=YOUNG,
                           PoissonsRatio=POISSON)
    spaces = {history: PrecomputeStateSpace(
        Input=scene, ActiveNodes=[node], TipRadius=TIP, HalfWidth=args.half_width,
        Resolution=args.resolution, ForceLimit=args.force_limit, History=history)
        for history in ("Automatic", "Flat")}
    figures = {}
    for history, space in spaces.items():
        data = data_of(update(space))
        figures[history] = {name: int(field(data, name)[0]) for name in
                            ("Solved", "Levels", "LevelTransitions", "ExplorationSeconds")}
        print(history, figures[history])
    down, up = loop(spaces["Automatic"], node, args)
    flat, _ = loop(spaces["Flat"], node, args)

    # The solver's own path: where it turns back.
    solution = SolveEquilibrium(Input=scene, ActiveNodes=[node], TipRadius=TIP,
                                Displacement=[0, 0, -args.half_width])
    folds = data_of(update(solution)).GetFieldData().GetArray("Folds")
    table = [dict(zip(COLUMNS, (1e3 * d[0], d[1], d[2], u[1], u[2], f[1], f[3])))
            for d, u, f in zip(down, up, flat)]
    save_csv(vtk_table(table, COLUMNS), os.path.join(args.output, "table.csv"))
    with open(os.path.join(args.output, "table.md"), "w") as file:
        file.write(markdown(table[::max(1, args.steps // 30)], COLUMNS))
    if folds is not None:
        turn = 1e3 * args.half_width * folds.GetComponent(0, 0)
        print(f"the solver's own path turns back at {turn:.2f} mm")
    jumps = [jump(down), jump(up[::-1])]
    if all(jumps):
        print("touch jumps at {:.2f} mm, and back at {:.2f} mm".format(*(1e3 * j for j in jumps)))
    # At one deflection on both branches: on the way down, and coming back.
    between = sum(jumps) / 2 if all(jumps) else args.half_width / 2
    picture(spaces["Automatic"], node,
            [(0, between), (0, args.half_width), (args.half_width, between)],
            os.path.join(args.output, "branches.png"))
    chart("A roof that snaps through", "deflection (mm)", "force (N)", [
        Curve("pressed", [(1e3 * r[0], r[1]) for r in down], 0, 1),
        Curve("let go", [(1e3 * r[0], r[1]) for r in up], 1, 1),
        Curve("without levels", [(1e3 * r[0], r[1]) for r in flat], 4, 2)],
        os.path.join(args.output, "loop.png"), logarithmic=(False, False))


if __name__ == "__main__":
    run("roof.py", main)

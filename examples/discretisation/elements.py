# SPDX-License-Identifier: BSD-3-Clause
"""Error against run time of the order and size of cells, and of the tip that touches them.

One organ is filled with tetrahedra of several sizes, linear and quadratic, and touched at the same
place in the same way. The finest quadratic mesh is the reference for the force and the displacement
of the others.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvpython elements.py
    pvpython elements.py organ.stl --scale 0.001 --touched 0.01 0.05 0.08 --tip-radius 0.01
    pvpython elements.py --laws Neo-Hookean --edges 0.09 0.07 0.055
    pvpython elements.py --locking scene.vtu --node 197 --pull -0.55 0.835 0 0.01

The results go to the folder `out`: table.csv, table.md, and charts (.png). On several ranks
(mpiexec -n 4 pvbatch elements.py) large meshes are solved by all of them together.
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

import locking
from bodies import LARGEST_EDGE, SLACK, Organ, corners_of, places, read_surface
from charts import Curve, chart
from materials import LAWS, assign
from measure import Measured
from pipeline import Failure, output
from script import Arguments, run
from tables import OUTCOMES, flag_names, save_table
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersCore import vtkProbeFilter

# Order of the elements, and how much smaller they are at the tip.
MESHES = {"Tet4": ("Linear", 1), "Tet10": ("Quadratic", 1), "Tet10, fine tip": ("Quadratic", 1 / 4)}
COLUMNS = {"law": "s", "element": "s", "tip (mm)": ".3g", "edge (mm)": ".3g", "cells": ".0f",
           "unknowns": ".0f", "force (N)": ".4g", "force error (%)": ".2g",
           "displacement error (%)": ".2g", "seconds": ".2g", "memory (MB)": ".0f",
           "outcome": "s", "flags": "s"}


def arguments():
    parser = Arguments("elements.py", __doc__.splitlines()[0])
    parser.add_argument("surface", nargs="?", help="closed surface (.stl .ply .obj .vtp); without "
                        "it, one like a liver is made")
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--scale", type=float, default=1.0, help="factor from its unit to m")
    parser.add_argument("--edges", type=float, nargs="+", default=[0.09, 0.07, 0.055, 0.043],
                        help="edges of the cells, as shares of the longest side of the organ")
    parser.add_argument("--finer-linear", type=float, nargs="*", default=[0.034, 0.027],
                        help="edges for linear cells alone, which are cheaper")
    parser.add_argument("--fine-tip", type=float, nargs="+",
                        default=[0.12, 0.09, 0.07, 0.055, 0.043],
                        help="edges of the quadratic cells that are smaller, by a factor of 4, at "
                        "the tip; the least one is the reference's")
    parser.add_argument("--laws", nargs="+", choices=LAWS, metavar="LAW",
                        default=["Linear", "Neo-Hookean", "Mooney-Rivlin incompressible"],
                        help="of: " + ", ".join(LAWS))
    parser.add_argument("--young", type=float, default=1e4, help="Young's modulus, Pa")
    parser.add_argument("--poisson", type=float, default=0.45, help="Poisson's ratio")
    parser.add_argument("--touched", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="where it is touched (the nearest point of the surface), m")
    parser.add_argument("--held", type=float, nargs=4, metavar=("X", "Y", "Z", "RADIUS"),
                        help="sphere within which its surface is held, m")
    parser.add_argument("--tip-radius", type=float, help="of the tool, m; by default 7 %% of the "
                        "longest side")
    parser.add_argument("--displacement", type=float, default=0.02,
                        help="how far the place is pulled along the normal (pushed: negative), as "
                        "a share of the longest side")
    parser.add_argument("--wanted", type=float, default=1.0, help="the error to reach, %%")
    parser.add_argument("--locking", metavar="SCENE", help="instead: the table of locking, of this "
                        "scene (.vtu with the point array Fixed, quadratic)")
    parser.add_argument("--node", type=int, default=197, help="the point of SCENE that is pulled")
    parser.add_argument("--pull", type=float, nargs=4, metavar=("X", "Y", "Z", "M"),
                        default=[-0.55, 0.835, 0.0, 0.01], help="direction and distance, m")
    return parser


def sizes_of(args, organ):
    """Name of the element and edge (m) of each mesh; the reference comes first."""
    families = {"Tet10, fine tip": args.fine_tip, "Tet10": args.edges,
                "Tet4": args.edges + args.finer_linear}
    return [(element, share * organ.size) for element, shares in families.items()
            for share in sorted(shares)]


def samples_of(grid):
    """The middles of the cells as points."""
    middles = places(grid)[corners_of(grid)].mean(axis=1)
    points, samples = vtkPoints(), vtkPolyData()
    points.SetData(numpy_to_vtk(middles, deep=True))
    samples.SetPoints(points)
    return samples


def displacement_at(samples, grid):
    """Of the body at places at rest [n × 3], and where there is a body [n]."""
    probe = vtkProbeFilter()
    probe.SetInputData(samples)
    probe.SetSourceData(grid)
    probe.Update()
    data = probe.GetOutput().GetPointData()
    return (vtk_to_numpy(data.GetArray("Displacement")).copy(),
            vtk_to_numpy(data.GetArray("vtkValidPointMask")) != 0)


def measure(args, organ, samples):
    """A row for each law, mesh and tip; with the displacement at the samples."""
    displacement = args.displacement * organ.size * organ.normal
    rows = []
    for element, edge in sizes_of(args, organ):
        order, at_tip = MESHES[element]
        body = organ.body(edge, order, args.output, at_tip)
        node = organ.node(output(body))
        for law in args.laws:
            scene = assign(body, law, args.young, args.poisson)
            for radius in (organ.tip_radius, 0):
                # The point alone is a matter of one law.
                if radius == 0 and law != args.laws[0]:
                    continue
                solved = Measured(scene, displacement, ActiveNodes=[node],
                                  TipRadius=radius * SLACK)
                outcome = solved.figure("Outcome")
                row = {"law": law, "element": element, "tip (mm)": 1e3 * radius,
                       "edge (mm)": 1e3 * edge, "cells": solved.grid.GetNumberOfCells(),
                       "unknowns": solved.figure("Unknowns"), "seconds": solved.seconds,
                       "memory (MB)": solved.megabytes, "outcome": OUTCOMES[outcome],
                       "flags": flag_names(solved.figure("Flags"))}
                if outcome == 0:
                    row["reaction"] = solved.force
                    row["force (N)"] = np.linalg.norm(solved.force)
                    row["field"] = displacement_at(samples, solved.grid)
                rows.append(row)
                print(f"{law}, {element}, {1e3 * edge:.3g} mm, tip {1e3 * radius:.3g} mm: "
                      f"{row['outcome']}, {row['seconds']:.2g} s", flush=True)
                solved.forget()
            Delete(scene)
        Delete(body)
    return rows


def compare(rows):
    """Adds the errors: against the first row of the same law and tip, the finest."""
    reference = {}
    for row in rows:
        best = reference.setdefault((row["law"], row["tip (mm)"]), row)
        if "reaction" not in best:
            raise Failure(f"the reference of {row['law']} did not converge: displace less.")
        if row is best or "reaction" not in row or row["tip (mm)"] == 0:
            continue
        row["force error (%)"] = 100 * (np.linalg.norm(row["reaction"] - best["reaction"])
                                        / np.linalg.norm(best["reaction"]))
        (mine, inside), (exact, also) = row["field"], best["field"]
        both = inside & also
        row["displacement error (%)"] = 100 * (np.linalg.norm((mine - exact)[both])
                                               / np.linalg.norm(exact[both]))


def advice(rows, args):
    """Which mesh to choose, in a line a law: the cheapest that is within the wanted error, as all
    finer ones of its kind are, so that it is not so by chance."""
    lines = []
    for law in args.laws:
        known = [row for row in rows if row["law"] == law and "force error (%)" in row]
        good = []
        for element in MESHES:
            for row in (row for row in known if row["element"] == element):
                if max(row["force error (%)"], row["displacement error (%)"]) > args.wanted:
                    break
                good.append(row)
        if not known:
            continue
        best = min(good or known, key=lambda row: row["seconds" if good else "force error (%)"])
        mesh = f"{best['element']} with edges of {best['edge (mm)']:.3g} mm"
        lines.append(f"{law}: for {args.wanted:g} % of force and displacement take {mesh} "
                     f"({best['unknowns']} unknowns, {best['seconds']:.2g} s)." if good else
                     f"{law}: no mesh is within {args.wanted:g} % of force and displacement; the "
                     f"nearest is {mesh}: {best['force error (%)']:.2g} % of the force.")
        lines[-1] += (f" The force of the reference differs from that of the next mesh by "
                      f"{known[0]['force error (%)']:.2g} %.")
    return lines


def curves(rows, laws, x, y, label="{law}, {element}"):
    found = []
    for number, law in enumerate(laws):
        for element in MESHES:
            points = [(row[x], row[y]) for row in rows
                      if row["law"] == law and row["element"] == element and row.get(y)]
            if points:
                found.append(Curve(label.format(law=law, element=element), points, number,
                                   list(MESHES).index(element)))
    return found


def draw(rows, args):
    tip = [row for row in rows if row["tip (mm)"] > 0]

    def path(name):
        return os.path.join(args.output, name + ".png")

    for x, x_title, name in (("seconds", "seconds", "error_seconds"),
                             ("unknowns", "unknowns", "error_unknowns")):
        chart("Error of the force", x_title, "error (%)",
              curves(tip, args.laws, x, "force error (%)"), path(name))
    chart("Error of the displacement", "seconds", "error (%)",
          curves(tip, args.laws, "seconds", "displacement error (%)"),
          path("displacement_seconds"))
    law = args.laws[0]
    found = []
    for number, radius in enumerate(sorted({row["tip (mm)"] for row in rows})):
        tips = [row for row in rows if row["tip (mm)"] == radius]
        of = curves(tips, [law], "edge (mm)", "force (N)",
                    (f"tip of {radius:.3g} mm" if radius else "a single point") + ", {element}")
        for curve in of:
            curve.colour = number
        found += of
    chart(f"Force against the size of the cells ({law})", "edge of the cells (mm)", "force (N)",
          found, path("force_edge"), logarithmic=(False, False))


def main():
    args = arguments().read()
    if args is None:
        return
    os.makedirs(args.output, exist_ok=True)
    if args.locking:
        locking.report(args)
        return
    organ = Organ(read_surface(args.surface, args.scale), args.touched, args.held,
                  args.tip_radius)
    at_tip = [share * MESHES["Tet10, fine tip"][1] for share in args.fine_tip]
    if max(args.edges + at_tip) * organ.size > LARGEST_EDGE * organ.tip_radius:
        raise Failure("the largest of --edges and --fine-tip make cells that are larger "
                      "than the tip.")
    coarsest = organ.body(max(args.edges) * organ.size, "Linear", args.output)
    rows = measure(args, organ, samples_of(output(coarsest)))
    compare(rows)
    save_table(rows, COLUMNS, advice(rows, args), args.output)
    if os.environ.get("DISPLAY"):
        draw(rows, args)
    else:
        print("elements.py: no charts, there is no display (xvfb-run -a gives one).",
              flush=True)


if __name__ == "__main__":
    run("elements.py", main)

# SPDX-License-Identifier: BSD-3-Clause
"""From the surface of an organ to a state space that can be touched.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH) and a display (or xvfb-run -a before them):
    pvpython liver.py
    pvpython liver.py organ.stl --scale 0.001 --repair --law Neo-Hookean
    mpiexec -n 4 pvbatch liver.py --resolution 9

The results go to the folder `out`: the state space (.palpate), table.md and table.csv, and
pictures.
"""
import argparse
import glob
import os
import sys
import time

import numpy as np
from paraview import servermanager
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

import pictures
import report
from make_surface import make_surface
from pipeline import Failure, boundary, field, output, save_surface, update
from remesh import arrays, remesh, triangle_normals, vertex_normals

LAWS = ("Linear", "St. Venant-Kirchhoff", "Neo-Hookean", "Mooney-Rivlin",
        "Mooney-Rivlin polynomial", "Fung", "Neo-Hookean incompressible",
        "Mooney-Rivlin incompressible", "Ogden")
# Where a doctor palpates: y is up, z to the front, the right lobe at x < 0.
IN_FRONT = np.array((-0.4, 0.4, 1.0))
LARGEST = 5.0  # m; a surface that is wider is not in m


class Arguments(argparse.ArgumentParser):
    """Does not exit by itself: under mpiexec it would leave without the other ranks."""

    def error(self, message):
        raise Failure(f"{message} (see --help)")


def node_ids(text):
    return None if text == "auto" else [int(node) for node in text.split(",")]


def parser():
    parser = Arguments(prog="liver.py", description=__doc__.splitlines()[0], add_help=False)
    parser.add_argument("-h", "--help", action="store_true", help="show this and end")
    parser.add_argument("surface", nargs="?", help="closed surface (.stl .ply .obj .vtp), in m; "
                        "without it, one like a liver is made")
    parser.add_argument("--output", default="out", help="folder of the results (%(default)s)")
    parser.add_argument("--scale", type=float, default=1.0,
                        help="factor from the unit of the surface to m: 0.001 for mm")
    parser.add_argument("--repair", action="store_true", help="mend the surface first")
    parser.add_argument("--elements", type=int, default=1000,
                        help="about as many tetrahedra (%(default)s); 0 keeps the triangles of the "
                        "surface as they are")
    parser.add_argument("--max-volume", type=float, default=0.0, metavar="M3",
                        help="largest volume of a tetrahedron, m³; 0 is no bound")
    parser.add_argument("--law", choices=LAWS, default="Neo-Hookean",
                        help="what the organ is made of (%(default)s)")
    parser.add_argument("--fixed", type=float, nargs=4, metavar=("X", "Y", "Z", "RADIUS"),
                        help="sphere in which the organ is held, m; by default one around its "
                        "upper back")
    parser.add_argument("--active-nodes", type=node_ids, metavar="ID,ID",
                        help="points that are touched; by default (auto) the one farthest in "
                        "front")
    parser.add_argument("--half-width", type=float, metavar="M",
                        help="how far they are moved along each axis, m; by default 4 %% of the "
                        "size of the organ")
    parser.add_argument("--resolution", type=int, default=7,
                        help="check-points along an axis, odd (%(default)s)")
    parser.add_argument("--fresh", action="store_true",
                        help="remove an earlier state space of that name; else it is continued")
    return parser


def read_surface(args):
    """1. The surface in m, from a file that all ranks can read."""
    if args.surface is None:
        return save_surface(make_surface(), os.path.join(args.output, "liver.vtp"))
    if not os.path.isfile(args.surface):
        raise Failure(f"there is no file {args.surface}.")
    try:
        reader = update(OpenDataFile(args.surface))
    except RuntimeError:
        raise Failure(f"ParaView cannot read {args.surface}.")
    if not output(reader).IsA("vtkPolyData"):
        raise Failure(f"{args.surface} holds no surface (vtkPolyData), but a "
                      f"{output(reader).GetClassName()}.")
    if args.scale != 1.0:
        reader = Transform(Input=reader)
        reader.Transform.Scale = [args.scale] * 3
        update(reader)
    size = np.ptp(np.reshape(reader.GetDataInformation().GetBounds(), (3, 2)), axis=1).max()
    if size > LARGEST:
        raise Failure(f"{args.surface} is {size:.3g} m wide. If it is in mm, add --scale 0.001.")
    return reader


def make_body(surface, args):
    """2. Quadratic tetrahedra, about as many as asked for."""
    # The surface as it is at first: fewer triangles would hide its faults.
    whole = update(TetrahedralizeSurface(Input=surface, PreserveSurface=1,
                                         RepairSurface=args.repair))
    clean = boundary(output(whole))
    path = os.path.join(args.output, "surface.vtp")
    if args.elements == 0:
        return tetrahedralize(save_surface(clean, path), args)
    area = np.linalg.norm(triangle_normals(*arrays(clean)), axis=1).sum()
    # A first guess from organs, then corrected by what comes out.
    length = (3.4 * area / args.elements) ** 0.5
    for last in (False, False, False, False, True):
        try:
            body = tetrahedralize(save_surface(remesh(clean, length), path), args)
        except Failure as failure:
            if last:
                raise Failure(f"with triangles of {length:.2g} m: {failure} Or ask for more "
                              "--elements.")
            # Triangles that are too large for a thin part of the organ cross each other there.
            length *= 0.8
            continue
        excess = output(body).GetNumberOfCells() / args.elements
        if last or 0.9 < excess < 1.1:
            return body
        # Between a square and a cube: most of the tetrahedra stand on the surface.
        length *= excess ** 0.4


def tetrahedralize(surface, args):
    return update(TetrahedralizeSurface(Input=surface, ElementOrder="Quadratic", PreserveSurface=1,
                                        MaximumVolume=args.max_volume, RepairSurface=args.repair))


def make_scene(body, args):
    """3. What it is made of, where it is held, where it may be touched."""
    material = AssignMaterial(Input=body, Law=args.law)
    scene = SetBoundary(Input=material, FixedBy="Region", FixedRegion="Sphere",
                        TouchableBy="Surface")
    points = vtk_to_numpy(output(body).GetPoints().GetData())
    # Where ligaments tie a liver to the diaphragm: y is up, z to the front.
    upper_back = points[np.argmax(points @ (0.0, 1.0, -1.0))]
    x, y, z, radius = args.fixed or (*upper_back, 0.17 * np.ptp(points, axis=0).max())
    scene.FixedRegion.Center = [x, y, z]
    scene.FixedRegion.Radius = radius
    return update(scene)


def choose_active_nodes(scene, args):
    """4. The points that are touched, and how far they are moved."""
    data = output(scene)
    points = vtk_to_numpy(data.GetPoints().GetData())
    touchable = np.flatnonzero(vtk_to_numpy(data.GetPointData().GetArray("Touchable")))
    nodes = args.active_nodes or [int(touchable[np.argmax(points[touchable] @ IN_FRONT)])]
    half_width = args.half_width or float(f"{0.04 * np.ptp(points, axis=0).max():.2g}")
    return nodes, half_width


def precompute(scene, nodes, half_width, args):
    """5. The state space, on all ranks."""
    organ = os.path.basename(args.surface) if args.surface else "liver"
    law = args.law.lower().replace(". ", "-").replace(" ", "-")
    file_name = os.path.join(args.output, f"{organ}_{law}_{args.resolution}.palpate")
    if args.fresh:
        # With what a run that was killed has left beside it.
        for path in glob.glob(glob.escape(file_name) + "*"):
            os.remove(path)
    try:
        return update(PrecomputeStateSpace(Input=scene, ActiveNodes=nodes, HalfWidth=half_width,
                                           Resolution=args.resolution, FileName=file_name))
    except Failure as failure:
        if file_name in str(failure):
            raise Failure(f"{failure} (--fresh removes it; --output takes another folder.)")
        raise


def touches(space, node, half_width):
    """6. Three displacements (m) of the active node, by name: along the normal and across."""
    surface = output(space).GetPartitionAsDataObject(1, 0)
    place = vtk_to_numpy(surface.GetPointData().GetArray("MeshPoint")).tolist().index(node)
    normal = vertex_normals(*arrays(surface))[place]
    normal /= np.linalg.norm(normal)
    across = np.cross(normal, np.eye(3)[np.argmin(np.abs(normal))])
    across /= np.linalg.norm(across)
    reach = 0.9 * half_width
    return {"push": -reach * normal, "pull": reach * normal, "sideways": reach * across}


def draw(scene, touch, displacements, half_width, folder):
    """7. Pictures of the organ at rest and touched."""
    def force_of(displacement):
        touch.Displacement = list(displacement)
        return np.array(field(output(update(touch)), "Force"))

    stage = pictures.Stage(scene)
    force_of((0, 0, 0))
    rest = np.array(field(output(touch), "ActivePosition"))
    pictures.picture_rest(stage, rest, half_width, os.path.join(folder, "rest.png"))
    forces = {name: force_of(displacement) for name, displacement in displacements.items()}
    scale = 0.35 * stage.size / max(map(np.linalg.norm, forces.values()))
    for name, displacement in displacements.items():
        force = force_of(displacement)
        # An arrow into the body ends at the node: else it would be hidden.
        inwards = force @ displacements["push"] > 0
        position = rest + displacement
        arrow = (position - scale * force if inwards else position, scale * force)
        pictures.picture_touch(stage, touch, name, position, displacement, force, arrow,
                               os.path.join(folder, f"deformed_{name}.png"))


def main():
    if not hasattr(servermanager.filters, "PrecomputeStateSpace"):
        raise Failure("the plugin Palpate is not loaded: set PV_PLUGIN_PATH to its folder.")
    args = parser().parse_args()
    if args.help:
        parser().print_help()
        return
    os.makedirs(args.output, exist_ok=True)
    table = report.Table()

    surface = read_surface(args)
    start = time.monotonic()
    body = make_body(surface, args)
    meshing_seconds = time.monotonic() - start
    scene = make_scene(body, args)
    nodes, half_width = choose_active_nodes(scene, args)
    space = precompute(scene, nodes, half_width, args)
    table.describe_body(servermanager.Fetch(surface), output(scene), args.law, meshing_seconds)
    table.describe_space(output(space))

    touch = TouchStateSpace(Input=space, ActiveNode=nodes[0])
    solve = SolveEquilibrium(Input=scene, ActiveNodes=nodes[:1])
    displacements = touches(space, nodes[0], half_width)
    for name, displacement in displacements.items():
        touch.Displacement = solve.Displacement = list(displacement)
        table.describe_touch(name, output(update(touch)), output(update(solve)))
    table.save(args.output)
    print(table.markdown(), flush=True)
    if os.environ.get("DISPLAY"):
        draw(scene, touch, displacements, half_width, args.output)
    else:
        print("liver.py: no pictures, there is no display (xvfb-run -a gives one).", flush=True)


def print_failure(kind, error, traceback):
    if issubclass(kind, Failure):
        print(f"liver.py: {error}", file=sys.stderr)
    else:
        sys.__excepthook__(kind, error, traceback)


if __name__ == "__main__":
    # Not sys.exit(1): under mpiexec it would leave without the other ranks.
    sys.excepthook = print_failure
    main()

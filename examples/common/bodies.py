# SPDX-License-Identifier: BSD-3-Clause
"""Bodies to measure on: meshes of one organ with cells of different size, but with the same place
to touch and the same place where they are held.
"""
import math
import os

import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA, vtkStaticCellLocator
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

from make_surface import make_surface
from pipeline import Failure, boundary, output, save_surface, update
from remesh import arrays, poly_data, remesh, vertex_normals

# Where a doctor palpates a liver, and where ligaments hold it: y is up, z to the front.
IN_FRONT, UPPER_BACK = (-0.4, 0.4, 1.0), (0.0, 1.0, -1.0)
# A point counts as within a radius that it misses by rounding.
SLACK = 1 + 1e-6
# Volume of a regular tetrahedron with edges of length 1 is 0.118; some are larger.
LARGEST_CELL = 0.2
# How far the smaller cells reach around a tip, in its radii, and how fast they grow from there on.
FINE_PART, GROWTH = 1.25, 0.5
# Of cells at a rim, in its radii.
LARGEST_EDGE = 1.5
# Corners and midside nodes of the faces of a tetrahedron, in VTK's order.
FACES = ([0, 1, 2, 4, 5, 6], [0, 1, 3, 4, 8, 7], [0, 2, 3, 6, 9, 7], [1, 2, 3, 5, 9, 8])


def read_surface(path, scale=1.0):
    """A closed surface as vtkPolyData of triangles, m; without a path one like a liver."""
    if path is None:
        return make_surface()
    if not os.path.isfile(path):
        raise Failure(f"there is no file {path}.")
    reader = update(OpenDataFile(path))
    if not output(reader).IsA("vtkPolyData"):
        raise Failure(f"{path} holds no surface.")
    if scale != 1.0:
        reader = Transform(Input=reader)
        reader.Transform.Scale = [scale] * 3
        update(reader)
    return boundary(output(reader))


class Organ:
    """A surface (m) with a place to touch it and a sphere within which the surface is held."""

    def __init__(self, surface, touched=None, held=None, tip_radius=None):
        """touched: a point near the place, m; held: centre and radius, m."""
        self.surface = surface
        self.nearest = vtkStaticCellLocator()
        self.nearest.SetDataSet(surface)
        self.nearest.BuildLocator()
        points, corners = arrays(surface)
        self.size = np.ptp(points, axis=0).max()
        self.place = self.closest(points[np.argmax(points @ IN_FRONT)] if touched is None
                                  else touched)
        vertex = np.argmin(np.linalg.norm(points - self.place, axis=1))
        self.normal = vertex_normals(points, corners)[vertex]
        self.normal /= np.linalg.norm(self.normal)
        self.tip_radius = (float(f"{0.07 * self.size:.2g}") if tip_radius is None
                           else tip_radius)
        if held is None:
            held = (*points[np.argmax(points @ UPPER_BACK)], 0.25 * self.size)
        self.held_centre, self.held_radius = np.array(held[:3]), held[3]

    def closest(self, point):
        found, cell, part, distance = [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
        self.nearest.FindClosestPoint(tuple(point), found, cell, part, distance)
        return np.array(found)

    def refined(self, length, at_tip):
        """The surface with edges of about `length` m, and `at_tip` times that around the tip."""
        def finer(point):
            away = math.dist(point, self.place) - FINE_PART * self.tip_radius
            return 1 / min(1, at_tip + GROWTH * max(away, 0) / length)

        return remesh(self.surface, length, finer if at_tip != 1 else None)

    def with_edges(self, length, at_tip):
        """The same with a vertex at the place that is touched, and no edge across the rims of the
        tip and of the part that is held."""
        points, corners = arrays(self.refined(length, at_tip))
        points[np.argmin(np.linalg.norm(points - self.place, axis=1))] = self.place
        for centre, radius, edge in ((self.place, self.tip_radius, at_tip * length),
                                     (self.held_centre, self.held_radius, length)):
            if edge <= LARGEST_EDGE * radius:
                self.bring_to_rim(points, corners, centre, radius)
        return poly_data(points, corners)

    def bring_to_rim(self, points, corners, centre, radius):
        """Moves one end of each edge that crosses a sphere onto it: the nearer one."""
        edges = np.unique(np.sort(corners[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        off = np.linalg.norm(points - centre, axis=1) - radius
        across = edges[off[edges[:, 0]] * off[edges[:, 1]] < 0]
        # The nearest first: an end that is on the sphere serves all its edges.
        for a, b in across[np.argsort(np.abs(off[across]).min(axis=1))]:
            if off[a] * off[b] < 0:
                end = a if abs(off[a]) < abs(off[b]) else b
                for _ in range(5):
                    along = points[end] - centre
                    points[end] = self.closest(centre + along * radius / np.linalg.norm(along))
                along = points[end] - centre
                points[end] = centre + along * radius / np.linalg.norm(along)
                off[end] = 0

    def body(self, length, order, folder, at_tip=1.0):
        """A reader of the body with cells of that size (m), order 'Linear' or 'Quadratic', held.
        at_tip: how much smaller the cells are around the place that is touched."""
        name = f"{1e3 * length:.3g}mm_{at_tip:.2g}"
        surface = save_surface(self.with_edges(length, at_tip),
                               os.path.join(folder, f"surface_{name}.vtp"))
        filled = TetrahedralizeSurface(Input=surface, ElementOrder=order, PreserveSurface=1,
                                       MaximumVolume=LARGEST_CELL * length ** 3)
        if at_tip != 1:
            filled.RefineVolume = LARGEST_CELL * (at_tip * length) ** 3
            filled.RefineRegion = "Sphere"
            filled.RefineRegion.Center = list(self.place)
            filled.RefineRegion.Radius = FINE_PART * self.tip_radius
        grid = output(update(filled))
        near = np.linalg.norm(places(grid) - self.held_centre, axis=1) <= self.held_radius * SLACK
        add_point_array(grid, "Fixed", (near & on_surface(grid)).astype(np.uint8))
        reader = save_body(grid, os.path.join(folder, f"body_{name}_{order.lower()}.vtu"))
        Delete(filled)
        Delete(surface)
        return reader

    def node(self, grid):
        """The point of a body that is touched."""
        distance = np.linalg.norm(places(grid) - self.place, axis=1)
        distance[~on_surface(grid)] = np.inf
        return int(distance.argmin())


def add_scene_arguments(parser):
    """The arguments that read_scene takes."""
    parser.add_argument("scene", nargs="?", help="a scene (.vtu, tetrahedra, point array Fixed) or "
                        "a closed surface (.stl .ply .obj .vtp); without it, one like a liver")
    parser.add_argument("--output", default="out", help="folder of the results")
    parser.add_argument("--scale", type=float, default=1.0, help="factor from its unit to m")
    parser.add_argument("--elements", type=int, default=300,
                        help="about as many tetrahedra in a surface")
    parser.add_argument("--order", choices=("Linear", "Quadratic"), default="Quadratic",
                        help="of the tetrahedra in a surface")
    parser.add_argument("--touched", type=float, nargs=3, metavar=("X", "Y", "Z"),
                        help="where it is touched (the nearest point of the surface), m")
    parser.add_argument("--tip-radius", type=float, help="of the tool, m; 0 for a single point; by "
                        "default 7 %% of the longest side")


def add_box_arguments(parser):
    """Where a state space is computed."""
    parser.add_argument("--half-width", type=float, help="of the box of displacements, m; by "
                        "default 6 %% of the longest side")
    parser.add_argument("--force-limit", type=float, default=0.0, help="N; 0 for none")


def read_scene(args):
    """The body with `Fixed` (vtkUnstructuredGrid), the node that is touched, a corner on the
    surface that is not held, and the organ."""
    os.makedirs(args.output, exist_ok=True)
    if args.scene and args.scene.endswith(".vtu"):
        if not os.path.isfile(args.scene):
            raise Failure(f"there is no file {args.scene}.")
        grid = output(update(XMLUnstructuredGridReader(FileName=[args.scene])))
        if not grid.GetPointData().HasArray("Fixed"):
            raise Failure(f"{args.scene} has no point array Fixed (Set Boundary makes it).")
        if grid.GetCellType(0) not in (VTK_TETRA, VTK_QUADRATIC_TETRA):
            raise Failure(f"{args.scene} is not made of tetrahedra.")
        organ = Organ(boundary(grid), args.touched, tip_radius=args.tip_radius)
    else:
        organ = Organ(read_surface(args.scene, args.scale), args.touched,
                      tip_radius=args.tip_radius)
        # About 13 tetrahedra of that edge fill its cube, less where the body is thin.
        points = places(organ.surface)
        length = (np.prod(np.ptp(points, axis=0)) * 3.5 / args.elements) ** (1 / 3)
        grid = output(organ.body(length, args.order, args.output))
    distance = np.linalg.norm(places(grid) - organ.place, axis=1)
    corner = np.zeros(len(distance), bool)
    corner[corners_of(grid)] = True
    held = vtk_to_numpy(grid.GetPointData().GetArray("Fixed")) != 0
    distance[~(corner & on_surface(grid)) | held] = np.inf
    return grid, int(distance.argmin()), organ


def places(grid):
    return vtk_to_numpy(grid.GetPoints().GetData())


def corners_of(grid):
    """The corners of the tetrahedra (n × 4)."""
    nodes = grid.GetCell(0).GetNumberOfPoints()
    return vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, nodes)[:, :4]


def on_surface(grid):
    """True where a point is on the surface (midside nodes included)."""
    nodes = grid.GetCell(0).GetNumberOfPoints()
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, nodes)
    faces = np.concatenate([cells[:, face[:3 if nodes == 4 else 6]] for face in FACES])
    _, first, count = np.unique(np.sort(faces[:, :3], axis=1), axis=0, return_index=True,
                                return_counts=True)
    chosen = np.zeros(grid.GetNumberOfPoints(), bool)
    chosen[faces[first[count == 1]]] = True
    return chosen


def add_point_array(grid, name, values):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    grid.GetPointData().AddArray(array)


def add_cell_array(grid, name, values):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    grid.GetCellData().AddArray(array)


def save_body(grid, path):
    """Writes it, so that the readers of all ranks find it, and answers with a reader."""
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(path)
    writer.SetDataModeToBinary()  # recent releases of Expat make readers refuse appended data
    if not writer.Write():
        raise Failure(f"cannot write {path}.")
    return update(XMLUnstructuredGridReader(FileName=[path]))

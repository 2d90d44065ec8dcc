# SPDX-License-Identifier: BSD-3-Clause
"""A closed surface of other triangles: about equilateral, all about as large.

A surface that comes from a scan has far more triangles than a body for touching needs, and a
decimated one has slivers, which TetGen can only mend with many small tetrahedra. So edges are split
where long and collapsed where short, flipped where that brings the vertices nearer to six
neighbours, and the vertices spread evenly over the surface as it was (Botsch & Kobbelt, A Remeshing
Approach to Multiresolution Modeling, SGP 2004). No step changes the topology. Sharp edges are
rounded off; the volume is kept.
"""
import math

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData, vtkStaticCellLocator

ROUNDS = 10


def remesh(surface, length, finer=None):
    """A copy of a closed triangulated vtkPolyData with edges of about `length` m; `finer` tells how
    many times shorter they are at a point (x, y, z).
    """
    nearest = vtkStaticCellLocator()
    nearest.SetDataSet(surface)
    nearest.BuildLocator()
    mesh = _Mesh(*arrays(surface), finer)
    wanted_volume = volume(*arrays(surface))
    for _ in range(ROUNDS):
        mesh.split_edges(4 / 3 * length)
        mesh.collapse_edges(4 / 5 * length, 4 / 3 * length)
        mesh.flip_edges()
        mesh.spread_vertices(nearest)
    points, corners = mesh.arrays()
    # The vertices lie on the surface and so the triangles within it where it bulges: move them out.
    for _ in range(3):
        normals = vertex_normals(points, corners)
        area = np.linalg.norm(normals, axis=1).sum()
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        points = points + (wanted_volume - volume(points, corners)) / area * normals
    return poly_data(points, corners)


def arrays(surface):
    """The points (n × 3) and the corners of the triangles (m × 3) of a vtkPolyData."""
    return (vtk_to_numpy(surface.GetPoints().GetData()).astype(float),
            vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3))


def poly_data(points, corners):
    surface, vtk_points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    vtk_points.SetData(numpy_to_vtk(np.ascontiguousarray(points), deep=True))
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(corners).ravel(), deep=True))
    surface.SetPoints(vtk_points)
    surface.SetPolys(cells)
    return surface


def triangle_normals(points, corners):
    """Normals as long as the triangles' areas."""
    a, b, c = (points[corners[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def vertex_normals(points, corners):
    """Normals as long as a third of the area around each vertex."""
    normals = np.zeros_like(points)
    for k in range(3):
        np.add.at(normals, corners[:, k], triangle_normals(points, corners) / 3)
    return normals


def volume(points, corners):
    return np.einsum("ij,ij->", points[corners[:, 0]], triangle_normals(points, corners)) / 3


def dot(u, v):
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


class _Mesh:
    """Triangles that can be changed one by one. `around[v]` are the triangles at the vertex v."""

    def __init__(self, points, corners, finer):
        self.finer = finer
        # Tuples of numbers: for three of them arrays are slow.
        self.points = [tuple(point) for point in points.tolist()]
        self.triangles = {}
        self.around = [set() for _ in self.points]
        self.next = 0
        for triangle in corners.tolist():
            self.add(*triangle)

    def arrays(self):
        """Points and corners, without the vertices that are not used any more."""
        corners = np.array(list(self.triangles.values()))
        used, corners = np.unique(corners, return_inverse=True)
        return np.array(self.points)[used], corners.reshape(-1, 3)

    def add(self, a, b, c):
        self.triangles[self.next] = (a, b, c)
        for vertex in (a, b, c):
            self.around[vertex].add(self.next)
        self.next += 1

    def remove(self, triangle):
        for vertex in self.triangles.pop(triangle):
            self.around[vertex].remove(triangle)

    def edges(self):
        """All edges (a, b) with a < b, in an order that is the same in each run."""
        return sorted({(min(pair), max(pair)) for a, b, c in self.triangles.values()
                       for pair in ((a, b), (b, c), (c, a))})

    def neighbours(self, vertex):
        return {v for t in self.around[vertex] for v in self.triangles[t]} - {vertex}

    def middle(self, a, b):
        return tuple((p + q) / 2 for p, q in zip(self.points[a], self.points[b]))

    def length(self, a, b):
        """Of an edge, or what it would be if edges were as long everywhere."""
        length = math.dist(self.points[a], self.points[b])
        return length * self.finer(self.middle(a, b)) if self.finer else length

    def normal(self, a, b, c):
        """The direction of a triangle; zero where it has no area."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self.points[a], self.points[b], self.points[c]
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        x, y, z = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        size = math.sqrt(x * x + y * y + z * z)
        return (x / size, y / size, z / size) if size > 0 else (0.0, 0.0, 0.0)

    def beside(self, a, b):
        """The two triangles at an edge, each with its third corner: the one that runs from a to b,
        then the other."""
        found = []
        for t in self.around[a] & self.around[b]:
            third = next(v for v in self.triangles[t] if v not in (a, b))
            i = self.triangles[t].index(a)
            found.append((self.triangles[t][(i + 1) % 3] != b, t, third))
        (_, t0, c), (_, t1, d) = sorted(found)
        return t0, c, t1, d

    def split_edges(self, longest):
        for a, b in self.edges():
            if self.length(a, b) > longest:
                t0, c, t1, d = self.beside(a, b)
                middle = len(self.points)
                self.points.append(self.middle(a, b))
                self.around.append(set())
                self.remove(t0)
                self.remove(t1)
                for triangle in ((a, middle, c), (middle, b, c), (b, middle, d), (middle, a, d)):
                    self.add(*triangle)

    def collapse_edges(self, shortest, longest):
        """Joins the ends of short edges where that makes none too long and folds nothing."""
        for a, b in self.edges():
            if self.around[a] & self.around[b] and self.length(a, b) < shortest:
                self.collapse(a, b, longest)

    def collapse(self, a, b, longest):
        # More than two common neighbours: the two sides of a neck or a pocket would touch.
        ring_a, ring_b = self.neighbours(a), self.neighbours(b)
        if len(ring_a & ring_b) != 2:
            return
        old_a, old_b = self.points[a], self.points[b]
        changed = self.around[a] ^ self.around[b]
        before = [self.normal(*self.triangles[t]) for t in changed]
        self.points[a] = self.points[b] = self.middle(a, b)
        folds = any(dot(n, self.normal(*self.triangles[t])) < 0.5 for n, t in zip(before, changed))
        if folds or any(self.length(a, v) > longest for v in (ring_a | ring_b) - {a, b}):
            self.points[a], self.points[b] = old_a, old_b
            return
        for t in self.around[a] & self.around[b]:
            self.remove(t)
        for t in sorted(self.around[b]):
            triangle = tuple(a if v == b else v for v in self.triangles[t])
            self.remove(t)
            self.add(*triangle)

    def flip_edges(self):
        """Turns an edge whose ends have too many neighbours and the corners opposite too few."""
        for a, b in self.edges():
            if not self.around[a] & self.around[b]:
                continue
            t0, c, t1, d = self.beside(a, b)
            counts = [len(self.around[v]) for v in (a, b, c, d)]
            now = sum((n - 6) ** 2 for n in counts)
            then = sum((n + change - 6) ** 2 for n, change in zip(counts, (-1, -1, 1, 1)))
            if then >= now or min(counts[:2]) <= 3 or self.around[c] & self.around[d]:
                continue
            old = [self.normal(a, b, c), self.normal(b, a, d)]
            new = ((c, a, d), (d, b, c))
            if all(sum(dot(n, self.normal(*triangle)) for n in old) > 1 for triangle in new):
                self.remove(t0)
                self.remove(t1)
                for triangle in new:
                    self.add(*triangle)

    def spread_vertices(self, nearest):
        """Each vertex to the middle of its neighbours, then back onto the surface as it was."""
        points, corners = np.array(self.points), np.array(list(self.triangles.values()))
        # In a closed surface each neighbour of a vertex follows it in exactly one triangle.
        total, count = np.zeros_like(points), np.zeros((len(points), 1))
        for k in range(3):
            np.add.at(total, corners[:, k], points[corners[:, (k + 1) % 3]])
            np.add.at(count, corners[:, k], 1)
        normals = vertex_normals(points, corners)
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
        middles = total / np.maximum(count, 1)
        across = np.einsum("ij,ij->i", normals, points - middles)
        wanted = (middles + across[:, None] * normals).tolist()
        closest, cell, part, distance = [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
        for v, triangles in enumerate(self.around):
            if triangles:
                nearest.FindClosestPoint(wanted[v], closest, cell, part, distance)
                self.points[v] = tuple(closest)

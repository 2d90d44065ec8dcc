#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""The seed's problem in GetFEM 5.4 (Debian: python3-getfem): how long its state space takes there.

Sample run, on one core:
  OPENBLAS_NUM_THREADS=1 tests/benchmark/getfem_seed_problem.py path/to/liver_seed.vtu --every 7

The best script that we know how to write: the finite-strain brick (its tangent is faster than that
of an energy in the assembly language), fixed nodes and those of the tool held by multipliers, which
are the reaction (to leave the fixed ones out, by a partial MeshFem, makes the assembly three times
as long; by simplification, the same), the solver that 'auto' picks (MUMPS, symmetric), the line
search 'basic' (the default one takes four times the iterations and more), one increment from the
neighbouring check-point of the layer before. The seed's way is the same in --increments 6, as the
papers have it. Neither computes the sensitivity or the stiffness.
"""

import argparse
import base64
import itertools
import json
import sys
import time
import xml.etree.ElementTree
import zlib

import getfem as gf
import numpy as np

LAWS = {
    # E 10 kPa, nu 0.45; C10, C01 and half the bulk modulus
    "St. Venant-Kirchhoff": ("SaintVenant Kirchhoff", [31034.4827586207, 3448.2758620689656]),
    "Mooney-Rivlin": ("Compressible Mooney Rivlin",
                      [1293.103448275862, 431.0344827586207, 33333.33333333334 / 2]),
}
FACES = ((0, 1, 2, 4, 5, 6), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 2, 3, 6, 9, 7))
STEPS = 3  # from the centre of the grid to its border: 7 x 7 x 7 points
MAX_ITERATIONS = 100


def read_arrays(path):
    """The arrays of a .vtu file of one piece, zlib-compressed and inline, by name."""
    types = {"Float64": np.float64, "Int64": np.int64, "Int32": np.int32, "UInt8": np.uint8}
    root = xml.etree.ElementTree.parse(path).getroot()
    assert root.get("compressor") == "vtkZLibDataCompressor" and root.get("header_type") == "UInt32"
    arrays = {}
    for array in root.iter("DataArray"):
        text = array.text.strip()
        num_blocks = int.from_bytes(base64.b64decode(text[:8])[:4], "little")
        header_text = 4 * ((4 * (3 + num_blocks) + 2) // 3)
        sizes = np.frombuffer(base64.b64decode(text[:header_text]), np.uint32)[3:3 + num_blocks]
        packed = base64.b64decode(text[header_text:])
        starts = np.concatenate(([0], np.cumsum(sizes, dtype=np.int64)))
        data = b"".join(zlib.decompress(packed[a:b]) for a, b in itertools.pairwise(starts))
        arrays[array.get("Name")] = np.frombuffer(data, types[array.get("type")])
    return arrays


def surface_points(cells):
    """Points of the faces that belong to one cell."""
    count = {}
    for cell in cells:
        for face in FACES:
            nodes = cell[list(face)]
            count.setdefault(tuple(sorted(nodes[:3])), []).append(nodes)
    return sorted({node for faces in count.values() if len(faces) == 1 for node in faces[0]})


class Body:
    """The body with a tool that holds all surface points within a radius of a node."""

    def __init__(self, path, law, node, radius):
        arrays = read_arrays(path)
        points = arrays["Points"].reshape(-1, 3)
        cells = arrays["connectivity"].reshape(-1, 10)
        mesh = gf.Mesh("empty", 3)
        for cell in cells:
            mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), points[cell[:4]].T)
        mf = gf.MeshFem(mesh, 3)
        mf.set_fem(gf.Fem("FEM_PK(3,2)"))
        self.tool = [point for point in surface_points(cells)
                     if np.linalg.norm(points[point] - points[node]) <= radius]
        held = [point for point, fixed in enumerate(arrays["Fixed"]) if fixed] + self.tool
        row_of = {point: 3 * i for i, point in enumerate(held)}
        pick = gf.Spmat("empty", 3 * len(held), mf.nbdof())
        for i, place in enumerate(mf.basic_dof_nodes()[:, ::3].T):
            point = int(np.linalg.norm(points - place, axis=1).argmin())
            for c in range(3):
                if point in row_of:
                    pick.add(row_of[point] + c, 3 * i + c, 1.0)

        self.model = gf.Model("real")
        self.model.add_fem_variable("u", mf)
        name, parameters = LAWS[law]
        self.model.add_initialized_data("parameters", parameters)
        mim = gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(2)"))  # 4 points
        self.model.add_finite_strain_elasticity_brick(mim, name, "u", "parameters")
        self.model.add_variable("h", 3 * len(held))
        self.held_at = np.zeros(3 * len(held))
        self.brick = self.model.add_constraint_with_multipliers("u", "h", pick, self.held_at)
        self.num_unknowns = mf.nbdof() - 3 * len(held)
        self.kept = (mesh, mf, mim)  # the model only refers to them

    def solve(self, start, end, state, increments):
        """From the state at `start` to `end`: the new state or None, and the iterations."""
        self.model.set_variable("u", state[0])
        self.model.set_variable("h", state[1])
        total = 0
        for i in range(1, increments + 1):
            t = start + (end - start) * i / increments
            self.held_at[-3 * len(self.tool):] = np.tile(t, len(self.tool))
            self.model.set_private_rhs(self.brick, self.held_at)
            iterations, converged = self.model.solve(
                "max_iter", MAX_ITERATIONS, "max_res", 1e-8, "lsolver", "auto", "lsearch", "basic")
            total += iterations
            if not converged or not np.isfinite(self.model.variable("u")).all():
                return None, total
        return (self.model.variable("u").copy(), self.model.variable("h").copy()), total

    def reaction(self):
        return -self.model.variable("h").reshape(-1, 3)[-len(self.tool):].sum(axis=0)


def parent_of(point):
    """The neighbour in the layer before."""
    layer = max(abs(i) for i in point)
    return tuple(i - (i > 0) + (i < 0) if abs(i) == layer else i for i in point)


def run(body, half_width, increments, every):
    """Seconds, iterations and failures by layer. Each configuration starts from its parent."""
    layers = [[] for _ in range(STEPS + 1)]
    for point in itertools.product(range(-STEPS, STEPS + 1), repeat=3):
        layers[max(abs(i) for i in point)].append(point)
    states = {(0, 0, 0): (np.zeros(len(body.model.variable("u"))),
                          np.zeros(len(body.model.variable("h"))))}
    wanted = set(layers[STEPS][::every])
    for layer in range(STEPS - 1, 0, -1):  # and what they start from
        wanted |= {parent_of(point) for point in wanted if max(map(abs, point)) == layer + 1}
    result = []
    for layer in range(STEPS + 1):
        chosen = [point for point in layers[layer] if point in wanted or layer == 0]
        seconds, iterations, failures = 0.0, 0, 0
        for point in chosen:
            parent = parent_of(point)
            spacing = half_width / STEPS
            begin = time.perf_counter()
            state, count = body.solve(spacing * np.array(parent), spacing * np.array(point),
                                      states[parent], increments)
            seconds += time.perf_counter() - begin
            iterations += count
            failures += state is None
            states[point] = states[parent] if state is None else state
        result.append({"points": len(layers[layer]), "solved": len(chosen), "seconds": seconds,
                       "iterations": iterations, "failures": failures})
    return result


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("body", help="the .vtu file with the point array Fixed")
    parser.add_argument("--law", choices=LAWS, default="St. Venant-Kirchhoff")
    parser.add_argument("--node", type=int, default=197)
    parser.add_argument("--tip-radius", type=float, default=0.0, help="m")
    parser.add_argument("--half-width", type=float, default=0.012, help="m")
    parser.add_argument("--increments", type=int, default=1)
    parser.add_argument("--every", type=int, default=1,
                        help="of the border's points, with those that they start from: a sample; "
                             "the total is that of the layers in proportion")
    parser.add_argument("--check", action="store_true",
                        help="print the reaction at (-2.2, 3.34, 0) mm and stop")
    parser.add_argument("--json", action="store_true")
    arguments = parser.parse_args()
    gf.util_trace_level(0)
    body = Body(arguments.body, arguments.law, arguments.node, arguments.tip_radius)
    if arguments.check:
        state = (body.model.variable("u"), body.model.variable("h"))
        _, iterations = body.solve(np.zeros(3), np.array((-0.0022, 0.00334, 0)), state, 1)
        print(body.num_unknowns, len(body.tool), body.reaction(), iterations)
        return
    layers = run(body, arguments.half_width, arguments.increments, arguments.every)
    solved = sum(layer["solved"] for layer in layers)
    total = sum(layer["seconds"] * layer["points"] / layer["solved"] for layer in layers)
    figures = {
        "unknowns": body.num_unknowns, "held_nodes": len(body.tool), "solved": solved,
        "seconds": total, "seconds_each": total / sum(layer["points"] for layer in layers),
        "iterations_each": sum(layer["iterations"] for layer in layers) / solved,
        "failures": sum(layer["failures"] for layer in layers)}
    if arguments.json:
        json.dump(figures, sys.stdout)
        return
    print("\n".join(f"{name:18}{value:.6g}" for name, value in figures.items()))


if __name__ == "__main__":
    main()

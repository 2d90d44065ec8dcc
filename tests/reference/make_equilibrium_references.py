#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/equilibria.json: a small mesh and equilibria on it, computed by GetFEM.

    make_equilibrium_references.py <equilibria.json>

Another code, which knows nothing of ours: the energies are written out in GetFEM's assembly
language, which derives force and tangent itself. The same mesh (Tet10, and Tet4 of its corners) and
the same quadrature (4 points, 1 point). Needs GetFEM 5.4 (Debian: python3-getfem).

The figures: `reaction` is the force that holds the active node (N), `energy` the strain energy (J),
`displacements` those of some points (m). Each solve ends with a residual of 1e-12 of the reaction.
"""

import json
import sys

import getfem as gf
import numpy as np

LENGTH = 0.1
SIZE = LENGTH * np.array([1.0, 0.6, 0.5])
BRICKS = (3, 2, 2)
EDGES = [(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)]  # VTK's order of midside nodes
# Six tetrahedra a brick, along its diagonal.
ORDERS = [(0, 1, 2), (1, 2, 0), (2, 0, 1), (1, 0, 2), (0, 2, 1), (2, 1, 0)]

YOUNG = 3000.0
POISSON = 0.35
LAMBDA = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
MU = YOUNG / (2 * (1 + POISSON))
# Mooney-Rivlin of the same moduli at rest.
C10, C01, KAPPA = MU / 3, MU / 6, LAMBDA + 2 * MU / 3
# In a scene of two materials, the cells at the far end are stiffer.
STIFFER = 4.0

KINEMATICS = ("Def F:=(Id(3)+Grad_u); Def EE:=(Sym(Grad_u)+0.5*(Grad_u'*Grad_u));"
              " Def CC:=(Id(3)+2*EE); Def JJ:=Det(F); ")
I2 = "(0.5*(sqr(Trace(CC))-Trace(CC*CC)))"
ENERGIES = {
    "Linear": "s*(0.5*la*sqr(Trace(Grad_u))+mu*Norm_sqr(Sym(Grad_u)))",
    "St. Venant-Kirchhoff": KINEMATICS + "s*(0.5*la*sqr(Trace(EE))+mu*Norm_sqr(EE))",
    "Neo-Hookean": KINEMATICS + "s*(0.5*mu*(Trace(CC)-3)-mu*log(JJ)+0.5*la*sqr(log(JJ)))",
    "Mooney-Rivlin": KINEMATICS + "s*(c10*(pow(JJ,-2/3)*Trace(CC)-3)+c01*(pow(JJ,-4/3)*" + I2
                     + "-3)+0.5*kappa*sqr(JJ-1))",
}
PARAMETERS = {law: [YOUNG, POISSON, 0.0] for law in ENERGIES}
PARAMETERS["Mooney-Rivlin"] = [C10, C01, KAPPA]

# Of the active nodes, m: a push, a pull and a sideways push, all with det F > 0.
DISPLACEMENTS = [(-0.008, 0.003, -0.004), (0.02, 0.01, 0.004), (0.002, 0.018, -0.012)]
INCREMENTS = 5


def make_mesh():
    """Corners and midside nodes of a warped block; cells in VTK's order; which points are fixed."""
    axes = [np.arange(n + 1) / n for n in BRICKS]
    points = [SIZE * np.array((x, y, z)) for z in axes[2] for y in axes[1] for x in axes[0]]
    fixed = [p[0] == 0 for p in points]
    stride = (1, BRICKS[0] + 1, (BRICKS[0] + 1) * (BRICKS[1] + 1))
    corners = []
    for k in range(BRICKS[2]):
        for j in range(BRICKS[1]):
            for i in range(BRICKS[0]):
                for n, order in enumerate(ORDERS):
                    cell = [i * stride[0] + j * stride[1] + k * stride[2]]
                    for axis in order:
                        cell.append(cell[-1] + stride[axis])
                    if n >= 3:
                        cell[1], cell[2] = cell[2], cell[1]
                    corners.append(cell)

    def warp(p):
        x, y, z = p / SIZE
        return p + 0.002 * np.array((np.sin(3 * y + 2 * z + 1), np.sin(2 * z - 3 * x),
                                     np.cos(2 * x + 3 * y - 1)))

    points = [warp(p) for p in points]
    middle = {}
    cells = []
    for cell in corners:
        nodes = list(cell)
        for a, b in EDGES:
            key = tuple(sorted((cell[a], cell[b])))
            if key not in middle:
                middle[key] = len(points)
                points.append((points[key[0]] + points[key[1]]) / 2)
                fixed.append(fixed[key[0]] and fixed[key[1]])
            nodes.append(middle[key])
        cells.append(nodes)
    return np.array(points), cells, fixed


class Body:
    """The mesh in GetFEM, with elements of degree 1 or 2."""

    def __init__(self, points, cells, fixed, degree):
        self.mesh = gf.Mesh("empty", 3)
        for cell in cells:
            self.mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), points[cell[:4]].T)
        self.mf = gf.MeshFem(self.mesh, 3)
        self.mf.set_fem(gf.Fem(f"FEM_PK(3,{degree})"))
        self.mim = gf.MeshIm(self.mesh, gf.Integ(f"IM_TETRAHEDRON({degree})"))
        self.mf0 = gf.MeshFem(self.mesh, 1)
        self.mf0.set_fem(gf.Fem("FEM_PK(3,0)"))
        # Every third dof is the x component of a node; the nodes are found by their place.
        places = self.mf.basic_dof_nodes()[:, ::3].T
        self.dof_of_point = {}
        for i, place in enumerate(places):
            distance = np.linalg.norm(points - place, axis=1)
            assert distance.min() < 1e-12
            self.dof_of_point[int(distance.argmin())] = 3 * i
        self.fixed_dofs = [d + c for p, d in self.dof_of_point.items() if fixed[p]
                           for c in range(3)]
        self.stiffness_of_cell = np.ones(self.mf0.nbdof())

    def make_stiffer(self, is_stiffer):
        dofs, first = self.mf0.basic_dof_from_cvid()
        for cell in range(len(first) - 1):
            self.stiffness_of_cell[dofs[first[cell]]] = STIFFER if is_stiffer[cell] else 1.0

    def solve(self, law, node, displacement):
        model = gf.Model("real")
        model.add_fem_variable("u", self.mf)
        model.add_initialized_fem_data("s", self.mf0, self.stiffness_of_cell)
        for name, value in (("la", LAMBDA), ("mu", MU), ("c10", C10), ("c01", C01),
                            ("kappa", KAPPA)):
            model.add_initialized_data(name, value)
        model.add_nonlinear_term(self.mim, ENERGIES[law])
        held = self.fixed_dofs + [self.dof_of_point[node] + c for c in range(3)]
        pick = gf.Spmat("empty", len(held), self.mf.nbdof())
        for row, dof in enumerate(held):
            pick.add(row, dof, 1.0)
        model.add_variable("h", len(held))
        values = np.zeros(len(held))
        brick = model.add_constraint_with_multipliers("u", "h", pick, values)
        for step in range(1, INCREMENTS + 1):
            values[-3:] = np.array(displacement) * step / INCREMENTS
            model.set_private_rhs(brick, values)
            _, converged = model.solve("max_res", 1e-13, "max_iter", 60, "lsearch", "basic")
            u = model.variable("u")
            assert np.isfinite(u).all()
        first, count = model.interval_of_variable("u")
        force = gf.asm_generic(self.mim, 1, ENERGIES[law], -1, model)[first:first + count]
        energy = gf.asm_generic(self.mim, 0, ENERGIES[law], -1, model)
        reaction = force[held[-3:]]
        free = np.ones(self.mf.nbdof(), bool)
        free[held] = False
        residual = abs(force[free]).max() / np.linalg.norm(reaction)
        assert residual < 1e-12, residual
        assert np.allclose(reaction, -model.variable("h")[-3:], rtol=1e-9, atol=0)
        return reaction, float(energy), u


def main():
    gf.util_trace_level(0)
    points, cells, fixed = make_mesh()
    num_corners = 1 + max(max(cell[:4]) for cell in cells)
    # A corner of the far end, and the middle of its upper edge; both are points of Tet4 too.
    active_nodes = [num_corners - 1, num_corners - 1 - (BRICKS[0] + 1)]
    is_stiffer = [bool(points[cell[:4], 0].mean() > 0.6 * LENGTH) for cell in cells]
    samples = [p for p in range(num_corners) if not fixed[p]][::5]
    equilibria = []
    for degree in (1, 2):
        body = Body(points, cells, fixed, degree)
        for two_materials in (False, True):
            if two_materials:
                body.make_stiffer(is_stiffer)
            for law in ENERGIES:
                for number, displacement in enumerate(DISPLACEMENTS):
                    if two_materials and number > 0:
                        continue
                    node = active_nodes[number % 2]
                    reaction, energy, u = body.solve(law, node, displacement)
                    equilibria.append({
                        "law": law, "nodes_per_cell": 4 if degree == 1 else 10,
                        "two_materials": two_materials, "active_node": node,
                        "displacement": list(displacement), "reaction": list(reaction),
                        "energy": energy,
                        "displacements": [list(u[body.dof_of_point[p]:body.dof_of_point[p] + 3])
                                          for p in samples]})
                    print(degree, two_materials, law, displacement, reaction, energy)
    mesh = {"points": points.tolist(), "num_corners": num_corners, "cells": cells,
            "fixed": [int(f) for f in fixed], "stiffer_cells": [int(s) for s in is_stiffer]}
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write('{\n"code": "GetFEM 5.4.2",\n')
        out.write(f'"parameters": {json.dumps(PARAMETERS)},\n"stiffer": {STIFFER},\n')
        for name, value in mesh.items():
            out.write(f'"{name}": {json.dumps(value)},\n')
        out.write(f'"samples": {json.dumps(samples)},\n"equilibria": [\n')
        out.write(",\n".join(json.dumps(e) for e in equilibria) + "\n]\n}\n")


if __name__ == "__main__":
    main()

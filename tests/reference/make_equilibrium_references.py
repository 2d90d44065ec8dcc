#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/equilibria.json: a small mesh and equilibria on it, computed by GetFEM.

    make_equilibrium_references.py <equilibria.json>

Another code, which knows nothing of ours: the energies are written out in GetFEM's assembly
language, which derives force and tangent itself. The same mesh (Tet10, and Tet4 of its corners) and
the same quadrature (4 points, 1 point). Incompressible and nearly incompressible bodies are mixed,
Tet10 with a continuous linear pressure (Taylor-Hood). Needs GetFEM 5.4 (Debian: python3-getfem).

The figures: `reaction` is the force that holds the active node (N), `energy` the energy (J; with p
its stationary value), `displacements` those of some points (m). Each solve ends with a residual of
1e-12 of the reaction.
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
NEARLY_INCOMPRESSIBLE = 0.4999
# In a scene of two materials, the cells at the far end are stiffer.
STIFFER = 4.0


def lame(young, poisson):
    return {"la": young * poisson / ((1 + poisson) * (1 - 2 * poisson)),
            "mu": young / (2 * (1 + poisson))}


# Name of each law, and the constants in its energy from its parameters, as the program takes them.
CONSTANTS = {
    "Linear": lame,
    "St. Venant-Kirchhoff": lame,
    "Neo-Hookean": lame,
    "Mooney-Rivlin": lambda c10, c01, kappa: {"c10": c10, "c01": c01, "kappa": kappa},
    "Mooney-Rivlin polynomial": lambda kappa, *c: {"kappa": kappa, **{
        f"c{name}": value for name, value in zip(POLYNOMIAL, c)}},
    "Fung": lambda young, poisson, b: {"mu": young / (2 * (1 + poisson)), "b": b,
                                       "kappa": young / (3 * (1 - 2 * poisson))},
    "Neo-Hookean incompressible": lambda young: {"c10": young / 6},
    "Mooney-Rivlin incompressible": lambda c10, c01: {"c10": c10, "c01": c01},
    "Ogden": lambda kappa, *terms: {"kappa": kappa, **{
        f"w{i}": 2 * mu / alpha**2 for i, (mu, alpha) in enumerate(zip(terms[::2], terms[1::2]))}},
}
POLYNOMIAL = ("10", "01", "20", "11", "02", "30", "21", "12", "03")

KINEMATICS = ("Def F:=(Id(3)+Grad_u); Def EE:=(Sym(Grad_u)+0.5*(Grad_u'*Grad_u));"
              " Def CC:=(Id(3)+2*EE); Def JJ:=Det(F); "
              " Def X1:=(pow(JJ,-2/3)*Trace(CC)-3);"
              " Def X2:=(pow(JJ,-4/3)*0.5*(sqr(Trace(CC))-Trace(CC*CC))-3); ")
# A constant is in braces: it gets the number of its region.
ENERGIES = {
    "Linear": "0.5*{la}*sqr(Trace(Grad_u))+{mu}*Norm_sqr(Sym(Grad_u))",
    "St. Venant-Kirchhoff": "0.5*{la}*sqr(Trace(EE))+{mu}*Norm_sqr(EE)",
    "Neo-Hookean": "0.5*{mu}*(Trace(CC)-3)-{mu}*log(JJ)+0.5*{la}*sqr(log(JJ))",
    "Mooney-Rivlin": "{c10}*X1+{c01}*X2+0.5*{kappa}*sqr(JJ-1)",
    "Mooney-Rivlin polynomial": "{c10}*X1+{c01}*X2+{c20}*sqr(X1)+{c11}*X1*X2+0.5*{kappa}*sqr(JJ-1)",
    "Fung": "{mu}/(2*{b})*(exp({b}*X1)-1)+0.5*{kappa}*sqr(JJ-1)",
    # Of its exponents -4, -2 and 4, whose sums of powers are those of invariants.
    "Ogden": "{w0}*(sqr(X2+3)-2*(X1+3)-3)+{w1}*X2+{w2}*(sqr(X1+3)-2*(X2+3)-3)"
             "+0.5*{kappa}*sqr(JJ-1)",
}
# With the pressure-like unknown p: P1 where the displacement is P2.
MIXED_ENERGIES = {
    "Neo-Hookean": "0.5*{mu}*(Trace(CC)-3)-{mu}*log(JJ)+p*log(JJ)-sqr(p)/(2*{la})",
    "Neo-Hookean incompressible": "{c10}*X1+p*(JJ-1)",
    "Mooney-Rivlin incompressible": "{c10}*X1+{c01}*X2+p*(JJ-1)",
}

MATERIALS = {
    "linear": ("Linear", [YOUNG, POISSON]),
    "St. Venant-Kirchhoff": ("St. Venant-Kirchhoff", [YOUNG, POISSON]),
    "neo-Hookean": ("Neo-Hookean", [YOUNG, POISSON]),
    "Mooney-Rivlin": ("Mooney-Rivlin", [C10, C01, KAPPA]),
    "polynomial": ("Mooney-Rivlin polynomial", [KAPPA, C10, C01, 0.4 * MU, 0.3 * MU]),
    "Fung": ("Fung", [YOUNG, POISSON, 3.0]),
    "Ogden": ("Ogden", [KAPPA, 0.2 * MU, -4.0, 0.3 * MU, -2.0, 0.5 * MU, 4.0]),
    "neo-Hookean incompressible": ("Neo-Hookean incompressible", [YOUNG]),
    "Mooney-Rivlin incompressible": ("Mooney-Rivlin incompressible", [C10, C01]),
    "neo-Hookean nearly incompressible": ("Neo-Hookean", [YOUNG, NEARLY_INCOMPRESSIBLE]),
}
MIXED = ("neo-Hookean incompressible", "Mooney-Rivlin incompressible",
         "neo-Hookean nearly incompressible")
# Which of the parameters are moduli.
STIFFENED = {"linear": [0], "St. Venant-Kirchhoff": [0], "neo-Hookean": [0],
             "Mooney-Rivlin": range(3), "polynomial": range(10), "Fung": [0],
             "Ogden": [0, 1, 3, 5]}
for body, moduli in STIFFENED.items():
    of_law, values_of_law = MATERIALS[body]
    MATERIALS[f"{body}, stiffer"] = (of_law, [STIFFER * value if i in moduli else value
                                              for i, value in enumerate(values_of_law)])

# What the regions of each body are made of: throughout, or near and far.
BODIES = [(body,) for body in (*STIFFENED, *MIXED)]
BODIES += [(body, f"{body}, stiffer") for body in STIFFENED]
BODIES += [("Mooney-Rivlin incompressible", "St. Venant-Kirchhoff, stiffer"),
           ("neo-Hookean", "neo-Hookean nearly incompressible")]

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

    def __init__(self, points, cells, fixed, degree, region_of_cell, samples):
        self.points = points
        self.region_of_cell = region_of_cell
        self.samples = samples
        self.mesh = gf.Mesh("empty", 3)
        for cell in cells:
            self.mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), points[cell[:4]].T)
        self.mf = gf.MeshFem(self.mesh, 3)
        self.mf.set_fem(gf.Fem(f"FEM_PK(3,{degree})"))
        self.mim = gf.MeshIm(self.mesh, gf.Integ(f"IM_TETRAHEDRON({degree})"))
        for region in (0, 1):
            of_region = [c for c, of_cell in enumerate(region_of_cell) if of_cell == region]
            self.mesh.set_region(region + 1, [of_region, [-1] * len(of_region)])
        # Every third dof is the x component of a node; the nodes are found by their place.
        places = self.mf.basic_dof_nodes()[:, ::3].T
        self.dof_of_point = {}
        for i, place in enumerate(places):
            distance = np.linalg.norm(points - place, axis=1)
            assert distance.min() < 1e-12
            self.dof_of_point[int(distance.argmin())] = 3 * i
        self.fixed_dofs = [d + c for p, d in self.dof_of_point.items() if fixed[p]
                           for c in range(3)]

    def solve(self, materials, node, displacement):
        model = gf.Model("real")
        model.add_fem_variable("u", self.mf)
        mixed = [cell for cell, region in enumerate(self.region_of_cell)
                 if materials[region % len(materials)] in MIXED]
        pressure = gf.MeshFem(self.mesh, 1)
        if mixed:
            pressure.set_fem(gf.Fem("FEM_PK(3,1)"), mixed)
            model.add_fem_variable("p", pressure)
        terms = []
        for region, material in enumerate(materials):
            law, parameters = MATERIALS[material]
            constants = CONSTANTS[law](*parameters)
            for name, value in constants.items():
                model.add_initialized_data(f"{name}_{region}", value)
            energy = (MIXED_ENERGIES if material in MIXED else ENERGIES)[law]
            energy = energy.format(**{name: f"{name}_{region}" for name in constants})
            terms.append((("" if law == "Linear" else KINEMATICS) + energy,
                          -1 if len(materials) == 1 else region + 1))
            model.add_nonlinear_term(self.mim, *terms[-1])
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
        assembled = sum(gf.asm_generic(self.mim, 1, energy, region, model)
                        for energy, region in terms)
        energy = sum(float(gf.asm_generic(self.mim, 0, energy, region, model))
                     for energy, region in terms)
        first, count = model.interval_of_variable("u")
        force = assembled[first:first + count]
        reaction = force[held[-3:]]
        free = np.ones(self.mf.nbdof(), bool)
        free[held] = False
        residual = abs(force[free]).max() / np.linalg.norm(reaction)
        assert residual < 1e-12, residual
        assert np.allclose(reaction, -model.variable("h")[-3:], rtol=1e-9, atol=0)
        result = {"reaction": list(reaction), "energy": energy}
        if mixed:
            first, count = model.interval_of_variable("p")
            assert abs(assembled[first:first + count]).max() < 1e-14 * np.prod(SIZE)
        result["displacements"] = [list(u[self.dof_of_point[p]:self.dof_of_point[p] + 3])
                                   for p in self.samples]
        return result


def main():
    gf.util_trace_level(0)
    points, cells, fixed = make_mesh()
    num_corners = 1 + max(max(cell[:4]) for cell in cells)
    # A corner of the far end, and the middle of its upper edge; both are points of Tet4 too.
    active_nodes = [num_corners - 1, num_corners - 1 - (BRICKS[0] + 1)]
    region_of_cell = [int(points[cell[:4], 0].mean() > 0.6 * LENGTH) for cell in cells]
    samples = [p for p in range(num_corners) if not fixed[p]][::5]
    equilibria = []
    for degree in (1, 2):
        body = Body(points, cells, fixed, degree, region_of_cell, samples)
        for materials in BODIES:
            # Our mixed element of degree 1 has no counterpart.
            if degree == 1 and any(material in MIXED for material in materials):
                continue
            for number, displacement in enumerate(DISPLACEMENTS):
                if len(materials) > 1 and number > 0:
                    continue
                node = active_nodes[number % 2]
                equilibrium = {"materials": materials, "nodes_per_cell": 4 if degree == 1 else 10,
                               "active_node": node, "displacement": displacement}
                equilibrium.update(body.solve(materials, node, displacement))
                equilibria.append(equilibrium)
                print(degree, materials, displacement, equilibrium["reaction"],
                      equilibrium["energy"])
    mesh = {"points": points.tolist(), "num_corners": num_corners, "cells": cells,
            "fixed": [int(f) for f in fixed], "region_of_cell": region_of_cell}
    materials = {name: {"law": law, "parameters": parameters,
                        "formulation": "mixed" if name in MIXED else "displacement"}
                 for name, (law, parameters) in MATERIALS.items()}
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write('{\n"code": "GetFEM 5.4.2",\n')
        out.write(f'"materials": {json.dumps(materials)},\n')
        for name, value in mesh.items():
            out.write(f'"{name}": {json.dumps(value)},\n')
        out.write(f'"samples": {json.dumps(samples)},\n"equilibria": [\n')
        out.write(",\n".join(json.dumps(e) for e in equilibria) + "\n]\n}\n")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/motion.json: a coarse liver in motion, computed by GetFEM.

    pvpython make_motion_reference.py <motion.json>

Another code, which knows nothing of ours: Newmark's method of the average acceleration, as GetFEM
has it; the energy of the law and the power of the viscosity are written out in its assembly
language, which derives force and tangent itself. The liver is neo-Hookean and viscous (as Kelvin
and Voigt say, in the reference configuration), begins at rest under gravity, and is pulled at a
patch of its front, from where that is then, and let go back. Needs GetFEM 5.4 (Debian:
python3-getfem), and ParaView with the plugin (PV_PLUGIN_PATH) for the mesh.

The figures, of each step: `force` holds the patch (N), and `displacements` are those of some points
(m), from the mesh. Each step ends with a residual of 1e-10 of the force.
"""

import json
import os
import sys

import getfem as gf
import numpy as np
from make_equilibrium_references import Body, ENERGIES, KINEMATICS, lame
from paraview.simple import TetrahedralizeSurface, servermanager

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.append(os.path.join(HERE, "..", "..", "examples", "liver"))
from make_surface import make_surface
from pipeline import save_surface

EDGE = 0.03  # of the surface, m
YOUNG, POISSON = 12000.0, 0.4
DENSITY, VISCOUS_TIME = 1060.0, 0.004  # kg/m3, s
GRAVITY = (0.0, -9.81, 0.0)
FIXED_CENTRE, FIXED_RADIUS = np.array((-0.03, 0.06, -0.05)), 0.045
PATCH_RADIUS = 0.02
PULL = np.array((0.006, -0.004, 0.018))
TIME_STEP, NUM_STEPS, PULLED_STEPS = 0.001, 240, 160
PRINTED = 20


def make_mesh():
    surface = save_surface(make_surface(edge_length=EDGE), "motion.vtp")
    body = TetrahedralizeSurface(Input=surface, ElementOrder="Quadratic", PreserveSurface=1)
    grid = servermanager.Fetch(body)
    points = np.array([grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())]).round(9)
    cells = np.array([[grid.GetCell(c).GetPointId(i) for i in range(10)]
                      for c in range(grid.GetNumberOfCells())])
    # In the middle of the edges, of corners that are rounded.
    for place, (a, b) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
        points[cells[:, 4 + place]] = (points[cells[:, a]] + points[cells[:, b]]) / 2
    return points, cells.tolist()


def surface_points(cells):
    count = {}
    for cell in cells:
        for face in ((0, 1, 2, 4, 5, 6), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8),
                     (0, 2, 3, 6, 9, 7)):
            nodes = [cell[i] for i in face]
            count.setdefault(tuple(sorted(nodes[:3])), []).append(nodes)
    return sorted({node for faces in count.values() if len(faces) == 1 for node in faces[0]})


def way(step):
    """Of the patch: it starts and ends smoothly."""
    if step >= PULLED_STEPS:
        return np.zeros(3)
    return PULL * np.sin(np.pi * step / PULLED_STEPS)**4


class Motion:
    def __init__(self, body, patch):
        self.body = body
        self.patch = [body.dof_of_point[p] + c for p in patch for c in range(3)]

    def model(self):
        model = gf.Model("real")
        model.add_fem_variable("u", self.body.mf)
        for name, value in {**lame(YOUNG, POISSON), "rho": DENSITY, "tau": VISCOUS_TIME,
                            "grav": GRAVITY}.items():
            model.add_initialized_data(name, value)
        energy = ENERGIES["Neo-Hookean"].format(la="la", mu="mu")
        model.add_nonlinear_term(self.body.mim, KINEMATICS + energy)
        exact = gf.MeshIm(self.body.mesh, gf.Integ("IM_TETRAHEDRON(5)"))
        model.add_linear_term(exact, "-rho*grav.Test_u")
        return model, exact

    def hold(self, model, dofs):
        pick = gf.Spmat("empty", len(dofs), self.body.mf.nbdof())
        for row, dof in enumerate(dofs):
            pick.add(row, dof, 1.0)
        model.add_variable("h", len(dofs))
        values = np.zeros(len(dofs))
        return model.add_constraint_with_multipliers("u", "h", pick, values), values

    def at_rest(self):
        model, _ = self.model()
        self.hold(model, self.body.fixed_dofs)
        gravity = np.array(GRAVITY)
        for share in np.linspace(0.25, 1, 4):
            model.set_variable("grav", share * gravity)
            solve(model)
        return model.variable("u").copy()

    def figures(self, model):
        u = model.variable("u")
        force = -model.variable("h")[-len(self.patch):].reshape(-1, 3).sum(axis=0)
        places = [u[self.body.dof_of_point[p]:self.body.dof_of_point[p] + 3]
                  for p in self.body.samples]
        return {"force": list(force), "displacements": [list(place) for place in places]}

    def run(self):
        u = self.at_rest()
        model, exact = self.model()
        model.add_Newmark_scheme("u", 0.25, 0.5)
        model.add_mass_brick(exact, "Dot2_u", "rho")
        rate = "Sym((Id(3)+Grad_u)'*Grad_Dot_u)"
        model.add_nonlinear_term(
            self.body.mim, f"tau*(la*Trace({rate})*Id(3)+2*mu*{rate})"
                           ":((Id(3)+Grad_u)'*Grad_Test_u)")
        brick, values = self.hold(model, self.body.fixed_dofs + self.patch)
        model.set_time_step(TIME_STEP)
        model.set_variable("u", u)
        model.set_variable("Previous_u", u)
        model.set_variable("Previous_Dot_u", 0 * u)
        model.set_variable("Previous_Dot2_u", 0 * u)
        steps = [self.figures(model)]
        for step in range(1, NUM_STEPS + 1):
            values[-len(self.patch):] = u[self.patch] + np.tile(way(step), len(self.patch) // 3)
            model.set_private_rhs(brick, values)
            solve(model)
            steps.append(self.figures(model))
            if step % PRINTED == 0:
                print(step, steps[-1]["force"], steps[-1]["displacements"][0], flush=True)
            model.shift_variables_for_time_integration()
        return steps


def solve(model):
    _, converged = model.solve("max_res", 1e-10, "max_iter", 40, "lsearch", "basic", "lsolver",
                               "auto")
    assert converged and np.isfinite(model.variable("u")).all()


def main():
    gf.util_trace_level(0)
    points, cells = make_mesh()
    fixed = np.linalg.norm(points - FIXED_CENTRE, axis=1) < FIXED_RADIUS
    outside = [p for p in surface_points(cells) if not fixed[p]]
    front = outside[int(np.argmax(points[outside, 2]))]
    patch = [p for p in outside if np.linalg.norm(points[p] - points[front]) < PATCH_RADIUS]
    samples = [outside[int(np.argmax(points[outside] @ np.array(axis)))]
               for axis in ((1, 0, 0), (-1, 0, 0), (0, -1, 0))]
    print(len(points), "points,", fixed.sum(), "fixed,", len(patch), "in the patch")
    body = Body(points, cells, fixed, 2, [0] * len(cells), samples)
    steps = Motion(body, patch).run()
    data = {
        "code": "GetFEM 5.4.2",
        "law": "Neo-Hookean", "parameters": [YOUNG, POISSON], "density": DENSITY,
        "viscous_time": VISCOUS_TIME, "gravity": GRAVITY, "time_step": TIME_STEP,
        "points": points.round(12).tolist(), "cells": cells, "fixed": [int(f) for f in fixed],
        "patch": patch, "samples": samples,
        "way": [list(way(step).round(12)) for step in range(NUM_STEPS + 1)],
    }
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write("{\n")
        for name, value in data.items():
            out.write(f'"{name}": {json.dumps(value)},\n')
        out.write('"steps": [\n' + ",\n".join(
            json.dumps({name: np.array(value).round(9).tolist() for name, value in step.items()})
            for step in steps) + "\n]\n}\n")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/half_ball.json: an incompressible half ball under its weight, by GetFEM.

    pvpython make_half_ball_reference.py <half_ball.json>
    pvpython make_half_ball_reference.py table

Another code, which knows nothing of ours: the energy is written out in GetFEM's assembly language,
which derives force and tangent itself; Taylor-Hood elements on the same mesh with a rule of degree
5 (15 points, where ours has 4 by default); Newton's method of our own here, with a share of the
load that grows as long as it converges. The half ball (radius 60 mm, 1000 kg/m3) is held at its
base; gravity acts along the base ("standing", as on a wall), away from it ("hanging"), or onto it
("lying").

The figures: `share` is how much of the load was reached, 1 where there is a rest, and `tip` the
displacement of the top there (m), on one coarse mesh. With `table` finer meshes are computed too,
by GetFEM and by Solve Equilibrium with both rules of quadrature, and printed beside each other.
Needs GetFEM 5.4 (Debian: python3-getfem), and ParaView with the plugin (PV_PLUGIN_PATH).
"""

import json
import sys

import getfem as gf
import numpy as np
from paraview.simple import (AssignMaterial, Clip, ExtractSurface, SetBoundary, SolveEquilibrium,
                             Sphere, TetrahedralizeSurface, servermanager)
from vtkmodules.util.numpy_support import vtk_to_numpy

RADIUS, DENSITY, GRAVITY = 0.06, 1000.0, 9.81
BASE = 1e-4  # points below this height are held, m
LOADS = {"standing": (0, -1, 0), "hanging": (0, 0, 1), "lying": (0, 0, -1)}
ENERGY = ("Def F:=(Id(3)+Grad_u); Def J:=Det(F);"
          " c10*(pow(J,-2/3)*Norm_sqr(F)-3)+p*(J-1)-share*(load.u)")
LEAST_INCREMENT = 1.0 / 256
MOST_ITERATIONS = 30
# Of the largest component of the residual at the start of an increment without a displacement.
TOLERANCE = 1e-9
# Resolution and largest volume of the mesher, and Young's moduli (Pa).
COARSE = ((8, 8, 16, 1e-4), (300.0, 500.0, 1000.0))
TABLE = (COARSE,
         ((12, 12, 24, 2e-5), (300.0, 500.0, 1000.0, 2000.0)),
         ((12, 12, 24, 1e-6), (300.0, 500.0, 1000.0, 2000.0)),
         ((16, 16, 32, 1e-6), (300.0, 1000.0)))


def make_body(theta, phi, resolution, volume):
    ball = Sphere(Radius=RADIUS, ThetaResolution=theta, PhiResolution=phi)
    half = Clip(Input=ball, ClipType="Plane", Invert=0)
    half.ClipType.Origin, half.ClipType.Normal = [0, 0, 0], [0, 0, 1]
    return TetrahedralizeSurface(Input=ExtractSurface(Input=half), RepairSurface=1,
                                 RepairResolution=resolution, ElementOrder="Quadratic",
                                 MaximumVolume=volume)


def mesh_of(body):
    grid = servermanager.Fetch(body)
    points = np.array([grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())]).round(9)
    cells = np.array([[grid.GetCell(c).GetPointId(i) for i in range(10)]
                      for c in range(grid.GetNumberOfCells())])
    # In the middle of the edges, of corners that are rounded.
    for place, (a, b) in enumerate(((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))):
        points[cells[:, 4 + place]] = (points[cells[:, a]] + points[cells[:, b]]) / 2
    return points, cells


class HalfBall:
    def __init__(self, points, cells, fixed, degree):
        mesh = gf.Mesh("empty", 3)
        for cell in cells:
            mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), points[cell[:4]].T)
        whole = gf.MeshFem(mesh, 3)
        whole.set_fem(gf.Fem("FEM_PK(3,2)"))
        places = whole.basic_dof_nodes()[:, ::3].T
        point_of_node = [int(np.linalg.norm(points - place, axis=1).argmin()) for place in places]
        self.node_of_point = {point: node for node, point in enumerate(point_of_node)}
        self.free = [3 * node + c for node, point in enumerate(point_of_node)
                     if not fixed[point] for c in range(3)]
        self.num_dofs = whole.nbdof()
        self.mf = gf.MeshFem("partial", whole, self.free)
        self.pressure = gf.MeshFem(mesh, 1)
        self.pressure.set_fem(gf.Fem("FEM_PK(3,1)"))
        self.mim = gf.MeshIm(mesh, gf.Integ(f"IM_TETRAHEDRON({degree})"))

    def residual(self, x, share, tangent=False):
        self.model.set_variable("share", [share])
        self.model.to_variables(x)
        self.model.assembly("build_all" if tangent else "build_rhs")
        return self.model.rhs()

    def newton(self, x, share, scale):
        """The equilibrium near x; None where there is none."""
        r = self.residual(x, share, True)
        for _ in range(MOST_ITERATIONS):
            if not np.isfinite(r).all():
                return None
            if abs(r).max() <= TOLERANCE * scale:
                return x
            step = np.ravel(gf.linsolve_mumps(self.model.tangent_matrix(), r))
            if not np.isfinite(step).all():
                return None
            length = 1.0
            while length > 1e-3:
                trial = self.residual(x + length * step, share)
                if np.isfinite(trial).all() and (length < 0.1 or
                                                 np.linalg.norm(trial) < 2 * np.linalg.norm(r)):
                    break
                length /= 2
            else:
                return None
            x = x + length * step
            r = self.residual(x, share, True)
        return None

    def settle(self, young, direction, tip):
        self.model = gf.Model("real")
        self.model.add_fem_variable("u", self.mf)
        self.model.add_fem_variable("p", self.pressure)
        self.model.add_initialized_data("c10", [young / 6])
        self.model.add_initialized_data("share", [0.0])
        self.model.add_initialized_data("load", list(DENSITY * GRAVITY * np.array(direction)))
        self.model.add_nonlinear_term(self.mim, ENERGY)
        x = np.zeros(self.model.nbdof())
        scale = abs(self.residual(x, 1.0)).max()
        before, share, increment = None, 0.0, 0.125
        while share < 1 and increment >= LEAST_INCREMENT:
            target = min(1.0, share + increment)
            start = x if before is None else x + (x - before[0]) * (target - share) / (
                share - before[1])
            found = self.newton(start, target, scale)
            if found is None:
                increment /= 2
                continue
            before, x, share = (x, share), found, target
            increment = min(2 * increment, 0.125)
        first, count = self.model.interval_of_variable("u")
        whole = np.zeros(self.num_dofs)
        whole[self.free] = x[first:first + count]
        node = self.node_of_point[tip]
        return {"share": share, "tip": list(whole[3 * node:3 * node + 3])}


def settle_here(body, young, direction, tip, quadrature):
    """What Solve Equilibrium says: the tip (m), and how many cells are inverted; None: no rest."""
    material = AssignMaterial(Input=body, Law="Neo-Hookean incompressible", YoungsModulus=young,
                              Density=DENSITY, Quadrature=quadrature)
    scene = SetBoundary(Input=material, FixedRegion="Box")
    scene.FixedRegion.Position = [-2 * RADIUS, -2 * RADIUS, -RADIUS]
    scene.FixedRegion.Length = [4 * RADIUS, 4 * RADIUS, RADIUS + BASE]
    rest = servermanager.Fetch(SolveEquilibrium(
        Input=scene, ActiveNodes=[tip], BodyForce=[GRAVITY * d for d in direction]))
    if rest.GetFieldData().GetArray("Outcome").GetTuple1(0) != 0:
        return None
    displacement = rest.GetPointData().GetArray("Displacement").GetTuple(tip)
    least = vtk_to_numpy(rest.GetCellData().GetArray("MinimumDetF"))
    return np.array(displacement), int((least <= 0).sum())


def print_table():
    print("| cells | Pa | | GetFEM, mm | Standard: % off, inverted | Fine: % off, inverted |")
    print("|---|---|---|---|---|---|")
    for mesher, moduli in TABLE:
        body = make_body(*mesher)
        points, cells = mesh_of(body)
        tip = int(np.argmax(points[:, 2]))
        half_ball = HalfBall(points, cells, points[:, 2] < BASE, 5)
        for young in moduli:
            for load, direction in LOADS.items():
                theirs = half_ball.settle(young, direction, tip)
                size = np.linalg.norm(theirs["tip"])
                row = [len(cells), f"{young:g}", load,
                       f"{1e3 * size:.2f}" if theirs["share"] == 1 else "no rest"]
                for quadrature in ("Standard", "Fine"):
                    ours = settle_here(body, young, direction, tip, quadrature)
                    row.append("no rest" if ours is None else
                               f"{100 * np.linalg.norm(ours[0] - theirs['tip']) / size:.2g}, "
                               f"{ours[1]}")
                print("| " + " | ".join(map(str, row)) + " |", flush=True)


def main():
    gf.util_trace_level(0)
    if sys.argv[1] == "table":
        print_table()
        return
    mesher, moduli = COARSE
    points, cells = mesh_of(make_body(*mesher))
    fixed = points[:, 2] < BASE
    tip = int(np.argmax(points[:, 2]))
    body = HalfBall(points, cells, fixed, 5)
    cases = []
    for young in moduli:
        for load, direction in LOADS.items():
            case = {"young": young, "load": load, "direction": direction}
            case.update(body.settle(young, direction, tip))
            cases.append(case)
            print(len(cells), young, load, case["share"], case["tip"], flush=True)
    mesh = {"tip": tip, "points": points.tolist(), "cells": cells.tolist(),
            "fixed": [int(f) for f in fixed]}
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(f'{{\n"code": "GetFEM 5.4.2",\n"density": {DENSITY}, "gravity": {GRAVITY},\n')
        for name, value in mesh.items():
            out.write(f'"{name}": {json.dumps(value)},\n')
        out.write('"cases": [\n' + ",\n".join(json.dumps(case) for case in cases) + '\n]\n}\n')


if __name__ == "__main__":
    main()

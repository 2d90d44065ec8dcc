# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/half_ball.json: an incompressible half ball under its weight, by GetFEM.

    pvpython make_half_ball_reference.py <half_ball.json> [all]

Another code, which knows nothing of ours: the energy is written out in GetFEM's assembly language,
which derives force and tangent itself; Taylor-Hood elements on the same mesh with a rule of degree
5 (15 points, where ours has 4 by default); Newton's method of our own here, with a share of the
load that grows as long as it converges. The half ball (radius 60 mm, 1000 kg/m3) is held at its
base; gravity acts along the base ("standing", as on a wall), away from it ("hanging"), or onto it
("lying").

The figures: `share` is how much of the load was reached, 1 where there is a rest, and `tip` the
displacement of the top there (m); `fine` is the number of quadrature points. With `all` the meshes
and stiffnesses of the whole table are computed, and written without their meshes; else one coarse
mesh for the tests. Needs GetFEM 5.4 (Debian: python3-getfem), and ParaView with the plugin
(PV_PLUGIN_PATH) for the mesh.
"""

import json
import sys

import getfem as gf
import numpy as np
from paraview.simple import Clip, ExtractSurface, Sphere, TetrahedralizeSurface, servermanager

RADIUS, DENSITY, GRAVITY = 0.06, 1000.0, 9.81
LOADS = {"standing": (0, -1, 0), "hanging": (0, 0, 1), "lying": (0, 0, -1)}
ENERGY = ("Def F:=(Id(3)+Grad_u); Def J:=Det(F);"
          " c10*(pow(J,-2/3)*Norm_sqr(F)-3)+p*(J-1)-share*(load.u)")
LEAST_INCREMENT = 1.0 / 256
MOST_ITERATIONS = 30
# Of the largest component of the residual at the start of an increment without a displacement.
TOLERANCE = 1e-9
# Resolution and largest volume of the mesher, and Young's moduli (Pa).
COARSE = ((8, 8, 16, 1e-4), (300.0, 500.0, 1000.0))
ALL = (((12, 12, 24, 2e-5), (300.0, 500.0, 1000.0, 2000.0)),
       ((12, 12, 24, 5e-6), (300.0, 500.0, 1000.0, 2000.0)),
       ((16, 16, 32, 1e-6), (300.0, 1000.0)))


def make_mesh(theta, phi, resolution, volume):
    ball = Sphere(Radius=RADIUS, ThetaResolution=theta, PhiResolution=phi)
    half = Clip(Input=ball, ClipType="Plane", Invert=0)
    half.ClipType.Origin, half.ClipType.Normal = [0, 0, 0], [0, 0, 1]
    body = TetrahedralizeSurface(Input=ExtractSurface(Input=half), RepairSurface=1,
                                 RepairResolution=resolution, ElementOrder="Quadratic",
                                 MaximumVolume=volume)
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


def main():
    gf.util_trace_level(0)
    whole_table = len(sys.argv) > 2 and sys.argv[2] == "all"
    meshes, cases = [], []
    for number, (mesher, moduli) in enumerate(ALL if whole_table else [COARSE]):
        points, cells = make_mesh(*mesher)
        fixed = [bool(p[2] < 1e-4) for p in points]
        tip = int(np.argmax(points[:, 2]))
        meshes.append({"mesher": mesher, "num_cells": len(cells), "tip": tip})
        if not whole_table:
            meshes[-1].update({"points": points.tolist(), "cells": cells.tolist(),
                               "fixed": [int(f) for f in fixed]})
        body = HalfBall(points, cells, fixed, 5)
        for young in moduli:
            for load, direction in LOADS.items():
                case = {"mesh": number, "young": young, "load": load, "direction": direction}
                case.update(body.settle(young, direction, tip))
                cases.append(case)
                print(len(cells), young, load, case["share"], case["tip"], flush=True)
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write(f'{{\n"code": "GetFEM 5.4.2",\n"density": {DENSITY}, "gravity": {GRAVITY},\n')
        out.write('"meshes": [\n' + ",\n".join(json.dumps(mesh) for mesh in meshes) + '\n],\n')
        out.write('"cases": [\n' + ",\n".join(json.dumps(case) for case in cases) + '\n]\n}\n')


if __name__ == "__main__":
    main()

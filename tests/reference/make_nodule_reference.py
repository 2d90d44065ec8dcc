# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/nodule.json: a ball with a nodule four times as stiff, meshed by
TetrahedralizeSurface, and equilibria of it, computed by GetFEM.

    pvpython make_nodule_reference.py <nodule.json>

As make_equilibrium_references.py, which does the work, but for the mesh. Needs ParaView with the
plugin (PV_PLUGIN_PATH) besides, of the Python that GetFEM is for.
"""

import json
import sys

import getfem as gf
import numpy as np
from make_equilibrium_references import Body, MATERIALS
from paraview.simple import AppendGeometry, Sphere, TetrahedralizeSurface, servermanager

RADIUS, NODULE, DEPTH = 0.03, 0.006, 0.008  # m; the depth is that of the nodule's top
LAWS = [("neo-Hookean", "neo-Hookean, stiffer"), ("Ogden", "Ogden, stiffer")]
DISPLACEMENTS = [(0.001, 0, -0.004), (-0.002, 0.002, 0.003)]


def make_mesh():
    ball = Sphere(Radius=RADIUS, ThetaResolution=10, PhiResolution=8)
    nodule = Sphere(Radius=NODULE, Center=[0, 0, RADIUS - DEPTH - NODULE], ThetaResolution=8,
                    PhiResolution=6)
    body = TetrahedralizeSurface(Input=AppendGeometry(Input=[ball, nodule]),
                                 ElementOrder="Quadratic", PreserveSurface=1,
                                 MaximumRadiusEdgeRatio=2)
    grid = servermanager.Fetch(body)
    points = np.array([grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())])
    cells = [[grid.GetCell(c).GetPointId(i) for i in range(10)]
             for c in range(grid.GetNumberOfCells())]
    region = grid.GetCellData().GetArray("Region")
    region = [int(region.GetTuple1(c)) for c in range(len(cells))]
    return points, cells, region


def main():
    gf.util_trace_level(0)
    points, cells, region = make_mesh()
    fixed = [bool(p[2] < -0.6 * RADIUS) for p in points]
    node = int(np.argmax(points[:, 2]))
    corners = {p for cell in cells for p in cell[:4]}
    samples = [p for p in sorted(corners) if not fixed[p]][::10]
    body = Body(points, cells, fixed, 2, region, samples)
    equilibria = []
    for materials in LAWS:
        for displacement in DISPLACEMENTS:
            equilibrium = {"materials": materials, "nodes_per_cell": 10, "active_node": node,
                           "displacement": displacement}
            equilibrium.update(body.solve(materials, node, displacement))
            equilibria.append(equilibrium)
            print(materials, displacement, equilibrium["reaction"], equilibrium["energy"])
    used = {name for materials in LAWS for name in materials}
    data = {
        "code": "GetFEM 5.4.2",
        "materials": {name: {"law": MATERIALS[name][0], "parameters": MATERIALS[name][1],
                             "formulation": "displacement"} for name in sorted(used)},
        "points": points.tolist(), "cells": cells, "fixed": [int(f) for f in fixed],
        "region_of_cell": region, "samples": samples, "equilibria": equilibria}
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write("{\n" + ",\n".join(f'"{name}": {json.dumps(value)}'
                                     for name, value in data.items()) + "\n}\n")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""The state space of a scene, on all ranks, as a job of a cluster.

Sample runs, with the plugin loaded (PV_PLUGIN_PATH):
    mpiexec -n 64 pvbatch precompute.py scene.vtu --output liver.palpate
    mpiexec -n 64 pvbatch precompute.py scene.vtu --output liver.palpate --at-most 100 \\
        --half-width 0.012 --tip-radius 0.005 --force-limit 3

The scene is what Set Boundary makes, saved with Save Data. A run that was killed goes on where it
was when it is started again in the same way.
"""
import os
import sys

sys.path += [os.path.join(sys.path[0], "..", folder) for folder in ("common", "liver")]

import numpy as np
from paraview.simple import *

from materials import LAWS, assign
from pipeline import Failure, field, output, update
from script import Arguments, run
from vtkmodules.util.numpy_support import vtk_to_numpy


def arguments():
    parser = Arguments("precompute.py", __doc__.splitlines()[0])
    parser.add_argument("scene", nargs="?", help="the body with the point arrays Fixed and "
                        "Touchable (.vtu), in m")
    parser.add_argument("--output", default="space.palpate", metavar="FILE",
                        help="the state space, which is continued if it is there")
    parser.add_argument("--law", choices=LAWS, metavar="LAW",
                        help="give the body this material, instead of what the scene says")
    parser.add_argument("--youngs-modulus", type=float, default=10e3, metavar="PA",
                        help="of that law")
    parser.add_argument("--poissons-ratio", type=float, default=0.45, help="of that law")
    parser.add_argument("--active-nodes", type=int, nargs="+", metavar="ID",
                        help="points that are touched (default: all touchable ones)")
    parser.add_argument("--at-most", type=int, default=0, metavar="N",
                        help="of the touchable points so many, spread evenly; 0: all")
    parser.add_argument("--part", type=int, nargs=2, default=[0, 1], metavar=("I", "N"),
                        help="of these points each N-th, from the I-th: one of N jobs, each with a "
                        "file of its own")
    parser.add_argument("--tip-radius", type=float, default=0.0, metavar="M",
                        help="of the tool; 0: the point alone")
    parser.add_argument("--half-width", type=float, default=0.01, metavar="M",
                        help="how far they are moved along each axis")
    parser.add_argument("--resolution", type=int, default=7, help="places along an axis, odd")
    parser.add_argument("--tolerance", type=float, default=0.0,
                        help="error of the force, as a share of the largest; 0: a uniform grid")
    parser.add_argument("--force-limit", type=float, default=0.0, metavar="N",
                        help="force beyond which nothing is explored; 0: none")
    parser.add_argument("--ranks-per-solve", type=int, default=1, metavar="R",
                        help="neighbouring ranks that solve together")
    parser.add_argument("--log-interval", type=float, default=60.0, metavar="S",
                        help="between two lines that say how far the run is; 0: none")
    return parser


def read_scene(args):
    """1. The body, where it is held and touched, and what it is made of."""
    if args.scene is None:
        raise Failure("name a scene, a .vtu file (see --help).")
    if not os.path.isfile(args.scene):
        raise Failure(f"there is no file {args.scene}.")
    scene = update(OpenDataFile(args.scene))
    if not output(scene).IsA("vtkUnstructuredGrid"):
        raise Failure(f"{args.scene} holds no body (vtkUnstructuredGrid), but a "
                      f"{output(scene).GetClassName()}.")
    if args.law:
        scene = update(assign(scene, args.law, args.youngs_modulus, args.poissons_ratio))
    return scene


def spread(points, most):
    """Indices of so many points: the first, and each time the one farthest from the others."""
    chosen = [0]
    distance = np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < min(most, len(points)):
        chosen.append(int(distance.argmax()))
        distance = np.minimum(distance, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen


def choose_active_nodes(scene, args):
    """2. The points that are touched in this job."""
    part, num_parts = args.part
    if not 0 <= part < num_parts:
        raise Failure(f"there is no part {part} of {num_parts}: parts are counted from 0.")
    nodes = args.active_nodes or touchable_points(scene, args)
    if part >= len(nodes):
        raise Failure(f"{len(nodes)} active nodes are too few for {num_parts} parts.")
    return nodes[part::num_parts]


def touchable_points(scene, args):
    """Those that are not held, or --at-most so many of them."""
    data = output(scene)
    touchable = data.GetPointData().GetArray("Touchable")
    if not touchable:
        raise Failure(f"{args.scene} has no point array Touchable: name --active-nodes, or use Set "
                      "Boundary.")
    # A point that is held is not touched.
    candidates = np.flatnonzero(vtk_to_numpy(touchable))
    fixed = data.GetPointData().GetArray("Fixed")
    if fixed:
        candidates = candidates[vtk_to_numpy(fixed)[candidates] == 0]
    if len(candidates) == 0:
        raise Failure(f"no point of {args.scene} is touchable: name --active-nodes, or use Set "
                      "Boundary.")
    if args.at_most > 0:
        points = vtk_to_numpy(data.GetPoints().GetData())[candidates]
        candidates = candidates[spread(points, args.at_most)]
    return [int(node) for node in candidates]


def precompute(scene, nodes, args):
    """3. The state space."""
    return update(PrecomputeStateSpace(
        Input=scene, ActiveNodes=nodes, TipRadius=args.tip_radius, HalfWidth=args.half_width,
        Resolution=args.resolution, Tolerance=args.tolerance, ForceLimit=args.force_limit,
        RanksPerSolve=args.ranks_per_solve, LogInterval=args.log_interval, FileName=args.output))


def summary(space, args):
    """4. What it took, in one line."""
    def figure(name):
        return field(output(space), name)[0]

    explored, finished = figure("ExplorationSeconds"), figure("FinishingSeconds")
    core_hours = figure("Ranks") * (explored + finished) / 3600
    return (f"{figure('Solved'):.0f} configurations solved and {figure('Reused'):.0f} taken from "
            f"{args.output} on {figure('Ranks'):.0f} ranks in {explored:.1f} s and "
            f"{finished:.1f} s for the file: {core_hours:.3g} core hours, "
            f"{os.path.getsize(args.output) / 1e9:.3g} GB")


def main():
    args = arguments().read()
    if args is None:
        return
    scene = read_scene(args)
    space = precompute(scene, choose_active_nodes(scene, args), args)
    print(summary(space, args), flush=True)


if __name__ == "__main__":
    run("precompute.py", main)

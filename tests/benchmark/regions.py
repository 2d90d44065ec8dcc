# SPDX-License-Identifier: BSD-3-Clause
"""The error of the whole, mesh and interpolation, of a space of regions with meshes of their own,
beside the time that it took.

Sample run:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) OPENBLAS_NUM_THREADS=1 \\
    mpiexec -n 2 pvbatch --sym tests/benchmark/regions.py liver.vtu --file liver.palpate

A ball presses places that are drawn at random, which the space never saw. What is right comes from
a mesh that is refined for each place until the estimate of its error is below --truth, with that
estimate taken off.
"""

import argparse
import time

import numpy
from paraview import servermanager
from paraview.simple import (Delete, PrecomputeStateSpace, RefineMesh, SolveEquilibrium,
                             TouchStateSpace)
from random_places import add_arguments, ball, draw, fetch, field, scene_of
from vtkmodules.vtkParallelCore import vtkMultiProcessController

parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
add_arguments(parser)
parser.add_argument("--file", default="", help="the .palpate file of the space")
parser.add_argument("--spacing", type=float, default=0.006, help="m")
parser.add_argument("--mesh-tolerance", type=float, default=0.05)
parser.add_argument("--region-size", type=float, default=0.0, help="m")
parser.add_argument("--maximum-cells", type=int, default=6000)
parser.add_argument("--force-limit", type=float, default=0.0, help="N; 0 for none")
parser.add_argument("--maximum-seconds", type=float, default=0.0, help="for one solve")
parser.add_argument("--truth", type=float, default=0.02)
arguments = parser.parse_args()
is_first = vtkMultiProcessController.GetGlobalController().GetLocalProcessId() == 0


def tell(text):
    if is_first:
        print(text, flush=True)


def tell_space(space, seconds):
    configurations = space.GetPartition(2, 0)
    tell(f"space: {seconds:.0f} s, meshes {field(configurations, 'MeshSeconds')[0]:.0f} s of it, "
         f"{field(configurations, 'Solved')[0]:.0f} solved, "
         f"{field(configurations, 'Reused')[0]:.0f} from the file, "
         f"{len(field(configurations, 'RegionBand'))} regions")
    cells = [space.GetPartition(block, 0).GetNumberOfCells()
             for block in range(3, space.GetNumberOfPartitionedDataSets())]
    tell(f"cells of the regions: {min(cells)} to {max(cells)}, median {numpy.median(cells):.0f}")


def tell_errors(rows):
    table = numpy.array(rows, dtype=float)
    error, force, _, found, is_reliable = table.T
    for name, good in (("all", error >= 0), ("unmarked", (found == 1) & (is_reliable == 1))):
        for what, shares in (("the force there", error[good] / force[good]),
                             ("the largest force", error[good] / force.max())):
            tell(f"{name}, {good.sum()} places, % of {what}: "
                 f"median {100 * numpy.median(shares):.2f}, "
                 f"90 % {100 * numpy.quantile(shares, 0.9):.2f}, largest {100 * shares.max():.2f}")


scene = scene_of(arguments)
space = ball(PrecomputeStateSpace(
    Input=scene, FileName=arguments.file, Keep="Touch", Depth=arguments.depth,
    Spacing=arguments.spacing, MeshTolerance=arguments.mesh_tolerance, LogInterval=60,
    RegionSize=arguments.region_size, MaximumCells=arguments.maximum_cells,
    MaximumConfigurations=1000000, EstimateMeshError=1, MaximumSeconds=arguments.maximum_seconds,
    ForceLimit=arguments.force_limit), arguments)
start = time.time()
space.UpdatePipeline()
output = servermanager.Fetch(space, 0)
if is_first:
    tell_space(output, time.time() - start)

measured = []
for node, depth, place in draw(scene, arguments):
    touch = TouchStateSpace(Input=space, ToolPosition=list(place))
    shown = fetch(touch)
    fine = ball(RefineMesh(Input=scene, ActiveNodes=[node], Depth=depth,
                           MeshTolerance=arguments.truth, MaximumCells=30000), arguments)
    solve = ball(SolveEquilibrium(Input=fine, ToolPosition=list(place), EstimateMeshError=1),
                 arguments)
    exact = fetch(solve)
    if is_first:
        right = field(exact, "ReactionForce")[0] - field(exact, "MeshError")[0]
        size = numpy.linalg.norm(right)
        measured.append((numpy.linalg.norm(field(shown, "Force")[0] - right), size,
                         field(shown, "MeshErrorBound")[0], field(shown, "Found")[0],
                         field(shown, "MeshErrorReliable")[0]))
        tell(f"node {node}, {1000 * depth:.1f} mm: {size:.4f} N, error "
             f"{100 * measured[-1][0] / size:.2f} %, bound of the mesh "
             f"{100 * measured[-1][2] / size:.2f} %, Found {measured[-1][3]}")
    for proxy in (touch, solve, fine):
        Delete(proxy)
if is_first:
    tell_errors(measured)

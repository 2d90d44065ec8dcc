# SPDX-License-Identifier: BSD-3-Clause
"""Whether Refine Mesh reaches a Mesh Tolerance, with how many unknowns, and how exact a force is
once the estimate of its error is taken off.

Sample run:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) OPENBLAS_NUM_THREADS=1 \\
    pvbatch tests/benchmark/mesh_tolerance.py liver.vtu --places 30 --least-depth 1

A ball presses places that are drawn at random. Each is refined to one tolerance after the other.
What is right is the force on the last mesh, of --truth, with the estimate of its error taken off.
"""

import argparse
import time

import numpy
from paraview.simple import Delete, RefineMesh, SolveEquilibrium
from random_places import add_arguments, ball, draw, fetch, field, scene_of

parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
add_arguments(parser)
parser.add_argument("--tolerances", type=float, nargs="*", default=[0.05, 0.02, 0.01])
parser.add_argument("--truth", type=float, default=0.007)
parser.add_argument("--cells", type=int, default=4000, help="of the mesh whose force is corrected")
arguments = parser.parse_args()


class Meshes:
    """Meshes for one touch, each refined from the one before."""

    def __init__(self, scene, node, depth, place):
        self.last, self.node, self.depth, self.place = scene, node, depth, place
        self.proxies = []

    def refine(self, tolerance, cells):
        """Cells, the force (N) and its error (N) as estimated, on a mesh of this tolerance."""
        mesh = ball(RefineMesh(Input=self.last, ActiveNodes=[self.node], Depth=self.depth,
                               MeshTolerance=tolerance, MaximumCells=cells), arguments)
        solve = ball(SolveEquilibrium(Input=mesh, ToolPosition=list(self.place),
                                      EstimateMeshError=1), arguments)
        solved = fetch(solve)
        self.last = mesh
        self.proxies = [solve, mesh] + self.proxies
        return (solved.GetNumberOfCells(), field(solved, "ReactionForce")[0],
                field(solved, "MeshError")[0], field(solved, "MeshErrorReliable")[0])

    def drop(self):
        for proxy in self.proxies:
            Delete(proxy)


def quantiles(values):
    return (f"median {numpy.median(values):.2f}, 90 % {numpy.quantile(values, 0.9):.2f}, "
            f"largest {max(values):.2f}")


scene = scene_of(arguments)
errors = {tolerance: [] for tolerance in arguments.tolerances}
cells_of = {tolerance: [] for tolerance in arguments.tolerances}
corrected = []
for node, depth, place in draw(scene, arguments):
    start = time.time()
    of_few = Meshes(scene, node, depth, place)
    few = of_few.refine(1e-3, arguments.cells)
    meshes = Meshes(scene, node, depth, place)
    found = {tolerance: meshes.refine(tolerance, 60000) for tolerance in arguments.tolerances}
    cells, force, error, is_reliable = meshes.refine(arguments.truth, 60000)
    right = force - error
    size = numpy.linalg.norm(right)
    line = f"node {node}, {1000 * depth:.1f} mm, {size:.4f} N:"
    for tolerance, (cells_there, force_there, _, _) in found.items():
        errors[tolerance].append(100 * numpy.linalg.norm(force_there - right) / size)
        cells_of[tolerance].append(cells_there)
        line += f" {100 * tolerance:g} % {cells_there} cells {errors[tolerance][-1]:.2f} %,"
    corrected.append(100 * numpy.linalg.norm(few[1] - few[2] - right) / size)
    print(f"{line} corrected on {few[0]} cells {corrected[-1]:.2f} %, truth {cells} cells, "
          f"reliable {few[3]} {is_reliable}, {time.time() - start:.0f} s", flush=True)
    meshes.drop()
    of_few.drop()
for tolerance in arguments.tolerances:
    reached = sum(error <= 100 * tolerance for error in errors[tolerance])
    print(f"{100 * tolerance:g} %: reached at {reached} of {len(errors[tolerance])} places, error "
          f"{quantiles(errors[tolerance])} %, cells {quantiles(cells_of[tolerance])}")
print(f"corrected on at most {arguments.cells} cells: {quantiles(corrected)} %, within 1.5 % at "
      f"{sum(error <= 1.5 for error in corrected)}, within 1 % at "
      f"{sum(error <= 1 for error in corrected)} places")

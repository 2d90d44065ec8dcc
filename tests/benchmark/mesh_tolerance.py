# SPDX-License-Identifier: BSD-3-Clause
"""Whether Refine Mesh reaches a Mesh Tolerance, with how many unknowns, and how exact a force is
once the estimate of its error is taken off.

Sample run:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) OPENBLAS_NUM_THREADS=1 \\
    pvbatch tests/benchmark/mesh_tolerance.py liver.vtu --places 30 --least-depth 1

A ball presses places that are drawn at random. A mesh is made for each of the tolerances.
What is right is the force on the last mesh, of --truth, with the estimate of its error taken off.
"""

import argparse
import time

import numpy
from paraview import servermanager
from paraview.simple import Delete, RefineMesh
from random_places import add_arguments, ball, draw, fetch, field, scene_of
from vtkmodules.util.numpy_support import vtk_to_numpy

parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
add_arguments(parser)
parser.add_argument("--tolerances", type=float, nargs="*", default=[0.05, 0.02, 0.01])
parser.add_argument("--truth", type=float, default=0.007)
parser.add_argument("--cells", type=int, default=4000, help="of the mesh whose force is corrected")
parser.add_argument("--seconds", type=float, default=120, help="that a solve may take, s")
arguments = parser.parse_args()


def refine(node, depth, tolerance, cells):
    """Cells, the force (N), the same less its estimated error, and whether that is known, on a
    mesh of this tolerance."""
    refined = ball(RefineMesh(Input=scene, ActiveNodes=[node], Depth=depth,
                              MeshTolerance=tolerance, MaximumCells=cells,
                              MaximumSeconds=arguments.seconds), arguments)
    mesh = fetch(refined)
    rounds = servermanager.Fetch(refined, idx=1)
    last = [vtk_to_numpy(rounds.GetColumnByName(name))[-1]
            for name in ("Cells", "Force", "CorrectedForce")]
    Delete(refined)
    return int(last[0]), last[1], last[2], bool(field(mesh, "MeshErrorKnown")[0])


def quantiles(values):
    return (f"median {numpy.median(values):.2f}, 90 % {numpy.quantile(values, 0.9):.2f}, "
            f"largest {max(values):.2f}")


scene = scene_of(arguments)
errors = {tolerance: [] for tolerance in arguments.tolerances}
cells_of = {tolerance: [] for tolerance in arguments.tolerances}
corrected = []
for node, depth, _ in draw(scene, arguments):
    start = time.time()
    few = refine(node, depth, 1e-3, arguments.cells)
    found = {tolerance: refine(node, depth, tolerance, 60000)
             for tolerance in arguments.tolerances}
    cells, _, right, is_known = refine(node, depth, arguments.truth, 60000)
    size = numpy.linalg.norm(right)
    line = f"node {node}, {1000 * depth:.1f} mm, {size:.4f} N:"
    for tolerance, (cells_there, force_there, _, _) in found.items():
        errors[tolerance].append(100 * numpy.linalg.norm(force_there - right) / size)
        cells_of[tolerance].append(cells_there)
        line += f" {100 * tolerance:g} % {cells_there} cells {errors[tolerance][-1]:.2f} %,"
    corrected.append(100 * numpy.linalg.norm(few[2] - right) / size)
    print(f"{line} corrected on {few[0]} cells {corrected[-1]:.2f} %, truth {cells} cells, "
          f"known {few[3]} {is_known}, {time.time() - start:.0f} s", flush=True)
for tolerance in arguments.tolerances:
    reached = sum(error <= 100 * tolerance for error in errors[tolerance])
    print(f"{100 * tolerance:g} %: reached at {reached} of {len(errors[tolerance])} places, error "
          f"{quantiles(errors[tolerance])} %, cells {quantiles(cells_of[tolerance])}")
print(f"corrected on at most {arguments.cells} cells: {quantiles(corrected)} %, within 1.5 % at "
      f"{sum(error <= 1.5 for error in corrected)}, within 1 % at "
      f"{sum(error <= 1 for error in corrected)} places")

# SPDX-License-Identifier: BSD-3-Clause
"""The seed's problem: how long its state space takes, beside the least it could take.

Sample run, on one core:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) OPENBLAS_NUM_THREADS=1 \\
    xvfb-run -a pvbatch tests/benchmark/seed_problem.py path/to/liver_seed.vtu

A liver of 978 Tet10 with 5094 unknowns, node 197 (or others) on 7 x 7 x 7 check-points of
half-width 12 mm. The floor is one assembly, one factorisation and three solves a configuration, as
measured in the same run. compare.py puts other programs beside it.
"""

import argparse
import json
import sys

from paraview import servermanager
from paraview.simple import AssignMaterial, PrecomputeStateSpace, XMLUnstructuredGridReader
from vtkmodules.util.numpy_support import vtk_to_numpy

LAWS = {
    "St. Venant-Kirchhoff": {"YoungsModulus": 10e3, "PoissonsRatio": 0.45},
    "Neo-Hookean": {"YoungsModulus": 10e3, "PoissonsRatio": 0.45},
    "Fung": {"YoungsModulus": 10e3, "PoissonsRatio": 0.45},
    "Mooney-Rivlin": {"C10": 1293.103448275862, "C01": 431.0344827586207,
                      "BulkModulus": 33333.33333333334},
}
OUTCOMES = ("converged", "not converged", "no tangent factor", "budget used up")

parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
parser.add_argument("body", help="the .vtu file with the point arrays Fixed and Touchable")
parser.add_argument("--active-nodes", type=int, nargs="+", default=[197])
parser.add_argument("--half-width", type=float, default=0.012, help="m")
parser.add_argument("--law", choices=LAWS, default="St. Venant-Kirchhoff")
parser.add_argument("--resolution", type=int, default=7, help="check-points along an axis")
parser.add_argument("--exponent", type=float, default=1.0, help="of the law Fung")
parser.add_argument("--tip-radius", type=float, default=0.0, help="m")
parser.add_argument("--file", default="", help=".palpate file; none: in memory")
parser.add_argument("--third-derivatives", action="store_true",
                    help="of the energy, which the floor has not")
parser.add_argument("--json", default="", help="a file for the figures")
arguments = parser.parse_args()

body = XMLUnstructuredGridReader(FileName=[arguments.body])
scene = AssignMaterial(Input=body, Law=arguments.law, Exponent=arguments.exponent,
                       **LAWS[arguments.law])
space = PrecomputeStateSpace(Input=scene, ActiveNodes=arguments.active_nodes,
                             HalfWidth=arguments.half_width, TipRadius=arguments.tip_radius,
                             Resolution=arguments.resolution, FileName=arguments.file, Keep="All",
                             ThirdDerivatives=int(arguments.third_derivatives))
# The floor is that of full precision: of a few configurations.
few = PrecomputeStateSpace(Input=scene, ActiveNodes=arguments.active_nodes[:1],
                           HalfWidth=arguments.half_width, TipRadius=arguments.tip_radius,
                           Resolution=3, SinglePrecisionFactors=0, ThirdDerivatives=0)
few.UpdatePipeline()
space.UpdatePipeline()
configurations = servermanager.Fetch(space, 0).GetPartition(2, 0)
configurations_of_few = servermanager.Fetch(few, 0).GetPartition(2, 0)


def figure(name, of=configurations):
    return of.GetFieldData().GetArray(name).GetValue(0)


def count(name, value):
    return (vtk_to_numpy(configurations.GetPointData().GetArray(name)) & value == value).sum()


outcomes = vtk_to_numpy(configurations.GetPointData().GetArray("Outcome"))
solved = figure("Solved")
floor = figure("FloorSeconds", configurations_of_few)
each = figure("ExplorationSeconds") * figure("Ranks") / solved
inverted = count("Flags", 1)
if arguments.json:
    with open(arguments.json, "w", encoding="utf-8") as out:
        json.dump({"unknowns": figure("Unknowns"), "solved": solved, "seconds_each": each,
                   "floor_each": floor, "failures": int((outcomes != 0).sum()),
                   "inverted": int(inverted)}, out)
    sys.exit()
print(f"unknowns                {figure('Unknowns'):.0f}")
print(f"configurations          {solved:.0f}")
for outcome, name in enumerate(OUTCOMES):
    print(f"  {name:22}{(outcomes == outcome).sum()}")
print(f"  inverted              {inverted}")
print(f"ranks                   {figure('Ranks'):.0f}")
print(f"exploration             {figure('ExplorationSeconds'):.2f} s")
print(f"modes and output        {figure('FinishingSeconds'):.2f} s")
print(f"a configuration         {1e3 * each:.1f} ms")
print(f"floor of one            {1e3 * floor:.1f} ms"
      f" = {1e3 * figure('AssemblySeconds', configurations_of_few):.2f} assembly"
      f" + {1e3 * figure('FactorisationSeconds', configurations_of_few):.2f} factorisation"
      f" + 3 x {1e3 * figure('SolveSeconds', configurations_of_few):.2f} solve")
print(f"ratio                   {each / floor:.2f}")

#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The seed's problem, side by side: this program, its floor, and GetFEM twice.

Sample run, on a machine that does nothing else:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) tests/benchmark/compare.py \\
    path/to/liver_seed.vtu

Two laws, the tool a point and 11 mm wide (seven nodes), 343 configurations each, one core. Ours is
PrecomputeStateSpace, all that it does; the floor is one assembly, one factorisation and three
solves a configuration; GetFEM is getfem_seed_problem.py, in one increment and in the seed's six. Of
GetFEM a sample is solved, --getfem-every 1 solves all. Needs pvbatch, xvfb-run and python3-getfem.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
SCENES = [(law, radius) for radius in (0.0, 0.011)
          for law in ("St. Venant-Kirchhoff", "Mooney-Rivlin")]
CONFIGURATIONS = 343


def run(command):
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(command, env=environment, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}\nended with {done.returncode}\n{done.stdout}")
    return done.stdout


def ours(body, scene):
    with tempfile.TemporaryDirectory() as folder:
        figures = Path(folder, "figures.json")
        run(["xvfb-run", "-a", "pvbatch", HERE / "seed_problem.py", body, *scene,
             "--json", figures])
        return json.loads(figures.read_text(encoding="utf-8"))


def getfem(body, scene, increments, every):
    return json.loads(run(["/usr/bin/python3", HERE / "getfem_seed_problem.py", body, *scene,
                           "--increments", str(increments), "--every", str(every), "--json"]))


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("body", help="liver_seed.vtu")
    parser.add_argument("--getfem-every", type=int, default=10,
                        help="share of the configurations that GetFEM solves: one in so many")
    arguments = parser.parse_args()
    print("| law | tip radius | unknowns | not converged | ours | floor | ours / floor | GetFEM | "
          "/ ours | GetFEM, 6 increments | / ours |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for law, radius in SCENES:
        scene = ["--law", law, "--tip-radius", str(radius)]
        us = ours(arguments.body, scene)
        best, seed = (getfem(arguments.body, scene, increments, arguments.getfem_every)
                      for increments in (1, 6))
        own = CONFIGURATIONS * us["seconds_each"]
        floor = CONFIGURATIONS * us["floor_each"]
        failed = f"{us['failures']} of {us['solved']:.0f}"
        row = [law, f"{1e3 * radius:.0f} mm", f"{us['unknowns']:.0f}", failed, f"{own:.1f} s",
               f"{floor:.1f} s", f"{own / floor:.2f}"]
        for other in (best, seed):
            lost = f" ({other['failures']} of {other['solved']} lost)" if other["failures"] else ""
            row += [f"{other['seconds']:.0f} s{lost}", f"{other['seconds'] / own:.1f}"]
        print("| " + " | ".join(row) + " |", flush=True)


if __name__ == "__main__":
    main()

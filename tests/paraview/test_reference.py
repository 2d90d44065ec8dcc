# SPDX-License-Identifier: BSD-3-Clause
"""Reaction, energy and displacement against another code, on the same mesh with the same laws."""

import json
import os
import sys

import numpy
from paraview.simple import AssignMaterial, SolveEquilibrium, XMLUnstructuredGridReader
from support import SKIPPED, expect_silence, fetch, field, point_array

# What is asked for. Where both codes have converged, rounding alone is between them.
TOLERANCE = 1e-6


def error(value, reference):
    value, reference = numpy.array(value), numpy.array(reference)
    return numpy.abs(value - reference).max() / numpy.abs(reference).max()


def main():
    folder = os.environ.get("PALPATE_SHARED_DATA", "")
    name = os.path.join(folder, "liver_seed_reference.json")
    if not folder or not os.path.exists(name):
        print("There is no reference data here.")
        sys.exit(SKIPPED)
    with open(name) as file:
        reference = json.load(file)
    # The file has Fixed: no boundary needs to be set.
    body = XMLUnstructuredGridReader(FileName=[os.path.join(folder, reference["mesh"])])
    parameters = ("YoungsModulus", "PoissonsRatio", "C10", "C01", "BulkModulus")
    materials = {
        law: AssignMaterial(Input=body, Law=law,
                            **{name: values[name] for name in parameters if name in values})
        for law, values in reference["materials"].items()}

    # Tetrahedra are integrated with four points here.
    cases = [case for case in reference["cases"] if case["quadrature_points"] == 4]
    assert len(cases) >= 20
    worst = dict.fromkeys(("reaction", "energy", "displacement", "det F"), 0.0)
    for case in cases:
        grid = expect_silence(lambda: fetch(SolveEquilibrium(
            Input=materials[case["law"]], ActiveNodes=[case["active_node"]],
            Displacement=case["displacement_m"])))
        assert field(grid, "Outcome")[0] == 0
        displacement = point_array(grid, "Displacement")
        nodes = case["displacement_at_nodes_m"]
        errors = {
            "reaction": error(field(grid, "ReactionForce")[0], case["reaction_N"]),
            "energy": error(field(grid, "Energy"), [case["energy_J"]]),
            "displacement": error([displacement[int(node)] for node in nodes],
                                  list(nodes.values())),
            "det F": error(field(grid, "MinimumDetF"), [case["minimum_det_F"]])}
        for name, value in errors.items():
            worst[name] = max(worst[name], value)
    print(len(cases), "cases, largest relative errors:", worst)
    for name, value in worst.items():
        assert value < TOLERANCE, (name, value)


if __name__ == "__main__":
    main()

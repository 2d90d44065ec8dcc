#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/interpolation.json: radial basis functions r and r³ through random values at
random centres, with and without the linear polynomial, by SciPy.

    make_interpolation_references.py <interpolation.json>

Of the centres 27 are the check-points of a grid of three an axis, the others lie anywhere in its
box; values are three of a force and an energy. Needs SciPy (Debian: python3-scipy; made with 1.10).
"""

import json
import sys
import warnings

import numpy
from scipy.interpolate import RBFInterpolator

HALF_WIDTH = 0.012
CENTRES = 60
POINTS = 20
KERNELS = {"RBF linear": "linear", "RBF cubic": "cubic"}


def main():
    random = numpy.random.default_rng(1)
    axis = (-HALF_WIDTH, 0.0, HALF_WIDTH)
    grid = [[x, y, z] for x in axis for y in axis for z in axis]
    others = random.uniform(-HALF_WIDTH, HALF_WIDTH, (CENTRES - len(grid), 3))
    centres = numpy.vstack([grid, others])
    values = random.uniform(-1, 1, (CENTRES, 4))
    points = random.uniform(-HALF_WIDTH, HALF_WIDTH, (POINTS, 3))
    results = []
    for method, kernel in KERNELS.items():
        for degree in (-1, 1):
            with warnings.catch_warnings():
                # r³ is not sure to be solvable without the polynomial. Here it is.
                warnings.simplefilter("ignore", UserWarning)
                # In spacings, so that numbers are of the order of 1.
                rbf = RBFInterpolator(centres / HALF_WIDTH, values, kernel=kernel, degree=degree)
            results.append({"method": method, "linear_polynomial": degree == 1,
                            "values": rbf(points / HALF_WIDTH).tolist()})
    references = {"half_width": HALF_WIDTH, "centres": centres.tolist(),
                  "values": values.tolist(), "points": points.tolist(), "results": results}
    lines = (f"{json.dumps(key)}: {json.dumps(value)}" for key, value in references.items())
    with open(sys.argv[1], "w", encoding="utf-8") as file:
        file.write("{\n" + ",\n".join(lines) + "\n}\n")


if __name__ == "__main__":
    main()

#!/usr/bin/python3
# SPDX-License-Identifier: BSD-3-Clause
"""Makes tests/data/laws.json: energy, stress and tangent of each law at chosen displacement
gradients, and the law's measure g of the change of volume with its derivatives.

    make_law_references.py <laws.json>

Straight from the definitions of W and g in solvers/materials/material.h, in numbers of 120 digits,
where cancellation does no harm and derivatives by finite differences keep 40 digits. Needs mpmath
(Debian: python3-mpmath).
"""

import json
import random
import sys

import mpmath
from mpmath import mpf

mpmath.mp.dps = 120
STEP = mpf(10) ** -30  # leaves errors of about 1e-60 (truncation) and 1e-60 (rounding)

COMPONENTS = [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]
# Of each law the constants of one or more materials, Pa and Fung's exponent without unit:
# λ and μ; C10, C01 and κ (0 where the volume is left to a pressure); κ and C10, C01, C20, C11, C02,
# C30, C21, C12, C03; μ, b and κ; κ and the μ_i and α_i of Ogden.
CONSTANTS = {
    "Linear": [[2500.0, 1100.0]],
    "St. Venant-Kirchhoff": [[2500.0, 1100.0]],
    "Neo-Hookean": [[2500.0, 1100.0]],
    "Mooney-Rivlin": [[370.0, 180.0, 3200.0], [370.0, 180.0, 0.0]],
    "Mooney-Rivlin polynomial": [
        [3200.0, 370.0, 180.0, 90.0, 55.0, 35.0, 21.0, 17.0, 14.0, 11.0]],
    "Fung": [[1100.0, 1.75, 3200.0], [1100.0, 1e-6, 0.0]],
    "Ogden": [[3200.0, 700.0, 1.3, 300.0, 5.0, 250.0, -4.7],
              [0.0, 1100.0, -21.5, 0.0, 0.0, 0.0, 0.0]],
}
POWERS = [(1, 0), (0, 1), (2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3)]


def invariants(strain):
    """J, I1 and I2 of C = I + 2E."""
    c = mpmath.eye(3) + 2 * strain
    i1 = c[0, 0] + c[1, 1] + c[2, 2]
    i2 = (i1**2 - sum(c[i, j] ** 2 for i in range(3) for j in range(3))) / 2
    det = (c[0, 0] * (c[1, 1] * c[2, 2] - c[1, 2] * c[2, 1])
           - c[0, 1] * (c[1, 0] * c[2, 2] - c[1, 2] * c[2, 0])
           + c[0, 2] * (c[1, 0] * c[2, 1] - c[1, 1] * c[2, 0]))
    return mpmath.sqrt(det), i1, i2


def energy(law, strain, constants):
    """W as a function of the Green-Lagrange strain, or of sym H for the linear law."""
    if law in ("Linear", "St. Venant-Kirchhoff"):
        trace = strain[0, 0] + strain[1, 1] + strain[2, 2]
        square = sum(strain[i, j] ** 2 for i in range(3) for j in range(3))
        lam, mu = constants
        return lam / 2 * trace**2 + mu * square
    j, i1, i2 = invariants(strain)
    if law == "Neo-Hookean":
        lam, mu = constants
        return mu / 2 * (i1 - 3) - mu * mpmath.log(j) + lam / 2 * mpmath.log(j) ** 2
    if law == "Ogden":
        kappa = constants[0]
        squares = mpmath.eigsy(mpmath.eye(3) + 2 * strain, eigvals_only=True)
        stretches = [mpmath.sqrt(square) / mpmath.cbrt(j) for square in squares]
        distortion = sum(2 * mu / alpha**2 * (sum(stretch**alpha for stretch in stretches) - 3)
                         for mu, alpha in zip(constants[1::2], constants[2::2]) if mu)
        return distortion + kappa / 2 * (j - 1) ** 2
    x = j ** (-mpf(2) / 3) * i1 - 3
    y = j ** (-mpf(4) / 3) * i2 - 3
    if law == "Mooney-Rivlin":
        c10, c01, kappa = constants
        distortion = c10 * x + c01 * y
    elif law == "Mooney-Rivlin polynomial":
        kappa = constants[0]
        distortion = sum(c * x**r * y**s for c, (r, s) in zip(constants[1:], POWERS))
    else:
        mu, b, kappa = constants
        distortion = mu / (2 * b) * (mpmath.exp(b * x) - 1)
    return distortion + kappa / 2 * (j - 1) ** 2


def volume(law, strain):
    """g as a function of the Green-Lagrange strain, or of sym H for the linear law."""
    if law in ("Linear", "St. Venant-Kirchhoff"):
        return strain[0, 0] + strain[1, 1] + strain[2, 2]
    j = invariants(strain)[0]
    return mpmath.log(j) if law == "Neo-Hookean" else j - 1


def direction(m):
    """Change of a symmetric tensor with its component m."""
    i, j = COMPONENTS[m]
    change = mpmath.zeros(3)
    change[i, j] = change[j, i] = 1
    return change


def factor(m):
    """A shear component stands in two places: a derivative along it counts twice."""
    return mpf(1) if m < 3 else mpf(1) / 2


def response(function, law, h):
    """A function of the strain and its first and second derivatives."""
    h = mpmath.matrix(h)
    strain = (h + h.T + (mpmath.zeros(3) if law == "Linear" else h.T * h)) / 2

    def w(change):
        return function(strain + change)

    stress = [factor(m) * (w(STEP * direction(m)) - w(-STEP * direction(m))) / (2 * STEP)
              for m in range(6)]
    tangent = []
    for m in range(6):
        for n in range(m + 1):
            a, b = STEP * direction(m), STEP * direction(n)
            tangent.append(factor(m) * factor(n)
                           * (w(a + b) - w(a - b) - w(b - a) + w(-a - b)) / (4 * STEP**2))
    return {"energy": float(w(mpmath.zeros(3))), "stress": [number(s) for s in stress],
            "tangent": [number(d) for d in tangent]}


def number(x):
    """As a double; what differences leave of a zero is zero."""
    return float(mpmath.chop(x, tol=mpf(10) ** -40))


def gradients():
    """Displacement gradients from tiny to large, all of det F between 0.3 and 2."""
    rng = random.Random(3)
    for size in (1e-12, 1e-8, 1e-6, 1e-4, 1e-2, 0.3):
        for _ in range(2):
            yield size, [[rng.uniform(-size, size) for _ in range(3)] for _ in range(3)]
    for det in (0.3, 0.6, 1.0, 1.4, 2.0):
        while True:
            h = [[rng.uniform(-0.8, 0.8) for _ in range(3)] for _ in range(3)]
            f = mpmath.eye(3) + mpmath.matrix(h)
            if abs(mpmath.det(f) - det) < 0.05:
                yield 1.0, h
                break


def main():
    cases = []
    for size, h in gradients():
        for law, materials in CONSTANTS.items():
            for constants in materials:
                exact = [mpf(p) for p in constants]
                cases.append({
                    "law": law, "size": size, "gradient": h, "constants": constants,
                    **response(lambda strain: energy(law, strain, exact), law, h),
                    "volume": response(lambda strain: volume(law, strain), law, h)})
    with open(sys.argv[1], "w", encoding="utf-8") as out:
        out.write("[\n" + ",\n".join(json.dumps(case) for case in cases) + "\n]\n")


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""Each law with the stiffness at rest of one Young's modulus and Poisson's ratio."""
from paraview.simple import *

LAWS = ("Linear", "St. Venant-Kirchhoff", "Neo-Hookean", "Mooney-Rivlin",
        "Mooney-Rivlin polynomial", "Fung", "Neo-Hookean incompressible",
        "Mooney-Rivlin incompressible")
# Share of the first invariant in the shear modulus of the Mooney-Rivlin laws.
FIRST = 0.75


def is_incompressible(law):
    return law.endswith("incompressible")


def parameters(law, youngs_modulus, poissons_ratio):
    """The settings of Assign Material; incompressible laws have Poisson's ratio 0.5."""
    if is_incompressible(law):
        poissons_ratio = 0.5
    half_shear = youngs_modulus / (4 * (1 + poissons_ratio))
    c10, c01 = FIRST * half_shear, (1 - FIRST) * half_shear
    if law == "Neo-Hookean incompressible":
        return {"YoungsModulus": youngs_modulus}
    if law == "Mooney-Rivlin incompressible":
        return {"C10": c10, "C01": c01}
    if law.startswith("Mooney-Rivlin"):
        bulk = youngs_modulus / (3 * (1 - 2 * poissons_ratio))
        if law == "Mooney-Rivlin":
            return {"C10": c10, "C01": c01, "BulkModulus": bulk}
        return {"Coefficients": [1, 0, c10, 0, 1, c01, 2, 0, c10], "BulkModulus": bulk}
    return {"YoungsModulus": youngs_modulus, "PoissonsRatio": poissons_ratio}


def assign(body, law, youngs_modulus, poissons_ratio, **settings):
    return AssignMaterial(Input=body, Law=law, **parameters(law, youngs_modulus, poissons_ratio),
                          **settings)

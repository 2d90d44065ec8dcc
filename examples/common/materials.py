# SPDX-License-Identifier: BSD-3-Clause
"""Each law with the stiffness at rest of one Young's modulus and Poisson's ratio."""
from paraview.simple import *

from pipeline import Failure

LAWS = ("Linear", "St. Venant-Kirchhoff", "Neo-Hookean", "Mooney-Rivlin",
        "Mooney-Rivlin polynomial", "Fung", "Neo-Hookean incompressible",
        "Mooney-Rivlin incompressible", "Ogden")
OWN = "Own"  # that of the scene
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
    if law == "Ogden":
        return {"OgdenModuli": [2 * c10, 2 * c01, 0], "OgdenExponents": [4, -4, 0],
                "BulkModulus": youngs_modulus / (3 * (1 - 2 * poissons_ratio))}
    return {"YoungsModulus": youngs_modulus, "PoissonsRatio": poissons_ratio}


def assign(body, law, youngs_modulus, poissons_ratio, **settings):
    return AssignMaterial(Input=body, Law=law, **parameters(law, youngs_modulus, poissons_ratio),
                          **settings)


def add_law_arguments(parser, laws):
    """The arguments that check_laws and scene_of take, with the laws of their default."""
    parser.add_argument("--laws", nargs="+", choices=(*LAWS, OWN), metavar="LAW", default=laws,
                        help="of: " + ", ".join(LAWS) + f"; or {OWN}, that of the scene")
    parser.add_argument("--young", type=float, default=1e4, help="Young's modulus, Pa")
    parser.add_argument("--poisson", type=float, default=0.45, help="Poisson's ratio")
    parser.add_argument("--exponent", type=float, default=1.0, help="of the law Fung")


def check_laws(grid, args):
    if OWN in args.laws and not grid.GetCellData().HasArray("Law"):
        raise Failure("the scene has no material of its own (Assign Material gives it one).")


def scene_of(body, law, args):
    """The body with the law, which may be its own."""
    if law == OWN:
        return body
    more = {"Exponent": args.exponent} if law == "Fung" else {}
    return assign(body, law, args.young, args.poisson, **more)

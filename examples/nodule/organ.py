# SPDX-License-Identifier: BSD-3-Clause
"""What is palpated: a liver with a nodule in it, which is stiffer and cannot be seen."""
import os

from paraview.simple import *

# The liver of ../liver, with smaller triangles in front; ../common/make_states.py made it.
SURFACE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "surface.vtp")
# The point that is farthest in front, and the way out of the body there: y is up, z to the front.
FRONT, OUT, UP = [-0.0492, 0.0357, 0.0509], [-0.326, 0.380, 0.866], [0, 1, 0]  # m, no unit
PRESSED = {"ToolRadius": 0.01, "Depth": 0.008, "Spacing": 0.005}  # of the sphere, m
HELD = [-0.03, 0.06, -0.05], 0.04  # a sphere: middle and radius, m
SIZE, BELOW = 0.012, 0.008  # of the nodule: its diameter, and how deep its top is, m
YOUNG, POISSON, TIMES = 5000, 0.4, 4  # of the liver, Pa, no unit; how much stiffer the nodule is


def fill(surface, centre, size, cells=0.0035):
    """A body with a nodule of that diameter (m) in it, a region of its own; cells: edges, m."""
    around = max(8, round(3.14 * size / cells))
    nodule = Sphere(Center=[float(x) for x in centre], Radius=size / 2, ThetaResolution=around,
                    PhiResolution=around // 2 + 1)
    return TetrahedralizeSurface(Input=AppendGeometry(Input=[surface, nodule]),
                                 ElementOrder="Quadratic", PreserveSurface=1)


def materials(young=YOUNG, poisson=POISSON, times=TIMES):
    """The rows of Assign Material: Neo-Hookean, the nodule `times` as stiff; young: Pa."""
    return [text for region, factor in (("0", 1), ("1", times)) for text in (
        region, "Neo-Hookean", f"YoungsModulus {factor * young:g} PoissonsRatio {poisson:g}")]


def make_scene(below=1e3 * BELOW):
    """The body with its materials, held at its upper back; below: of the nodule, mm."""
    deep = 1e-3 * float(below) + SIZE / 2
    body = fill(OpenDataFile(SURFACE), [at - deep * out for at, out in zip(FRONT, OUT)], SIZE)
    material = AssignMaterial(Input=body, RegionType="Table", RegionArray="Region",
                              Regions=materials())
    scene = SetBoundary(Input=material, FixedRegion="Sphere")
    scene.FixedRegion.Center, scene.FixedRegion.Radius = HELD
    return scene

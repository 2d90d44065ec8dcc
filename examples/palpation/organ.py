# SPDX-License-Identifier: BSD-3-Clause
"""What is palpated: the liver of ../liver."""
import os

from paraview.simple import *

SURFACE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "liver", "liver.vtp")
# The point that is farthest in front, and the way out of the body there: y is up, z to the front.
FRONT, OUT, UP = [-0.0543, 0.0360, 0.0491], [-0.4, 0.4, 1.0], [0, 1, 0]  # m, no unit
PRESSED = {"ToolRadius": 0.01, "Depth": 0.008, "Spacing": 0.005}  # of the sphere, m


def make_scene():
    """The body with its material, held at its upper back."""
    surface = OpenDataFile(SURFACE)
    body = TetrahedralizeSurface(Input=surface, ElementOrder="Quadratic", PreserveSurface=1)
    material = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=5000)
    scene = SetBoundary(Input=material, FixedRegion="Sphere")
    scene.FixedRegion.Center, scene.FixedRegion.Radius = [-0.03, 0.06, -0.05], 0.04
    return scene

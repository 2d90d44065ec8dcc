# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of a rigid tool's space share: a box, and the space of a sphere on its top."""

from paraview.simple import AssignMaterial, PrecomputeStateSpace, SetBoundary
from support import box_body, source

RADIUS = 0.04
DEPTH = 0.01
SPACING = 0.02
# Of contact. One that is given is smooth, so that few check-points do; by default more are needed.
LAYER = 0.2 * RADIUS
# The box of support.py is 0.2 m long, 0.1 m wide and high, and is held at x = 0.
MIDDLE_OF_TOP = [0.12, 0.05, 0.1]
# Where the tool is 7 mm deep.
ABOVE = [0.12, 0.05, 0.1 + RADIUS - 0.007]


def scene(name):
    body = source(box_body(divisions=(8, 4, 4), quadratic=False), name)
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law="Neo-Hookean"),
                           FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    return boundary


def space_of(boundary, **settings):
    settings = {"Tool": "Sphere", "ToolRadius": RADIUS, "Depth": DEPTH, "Spacing": SPACING,
                "ContactThickness": LAYER,
                "UseToolRegion": 1, "ToolRegion": "Sphere", "LogInterval": 0} | settings
    radius = settings.pop("RegionRadius", 0.03)
    space = PrecomputeStateSpace(Input=boundary, **settings)
    space.ToolRegion.Center = MIDDLE_OF_TOP
    space.ToolRegion.Radius = radius
    return space

# SPDX-License-Identifier: BSD-3-Clause
"""A sphere that presses an organ: its state space around a place, and what it feels as it slides.

What is said of the sphere and its space is in `args`: tool_radius, depth, spacing, region (m) and
output, the folder of the files.
"""
import os

import numpy as np
from paraview.simple import *

from pipeline import field, output, update
from remesh import arrays, volume

INSIDE, CONVERGED = 1, 0
SHARE = 0.8  # of the space's depth, in which the tool slides


def sphere(radius):
    """The tool. Its layer of contact is given, a fifth of the radius: the one by default is nearer
    to a hard sphere, and takes smaller cells of the space where it begins to touch."""
    return {"Tool": "Sphere", "ToolRadius": radius, "ContactThickness": 0.2 * radius}


def outwards(organ):
    # A surface may be inside out.
    return np.sign(volume(*arrays(organ.surface))) * organ.normal


def touch_of(scene, organ, name, args):
    """A state space around the place that is touched, and a filter that touches it; and a line of
    what it took."""
    space = PrecomputeStateSpace(
        Input=scene, **sphere(args.tool_radius), Depth=args.depth,
        Spacing=args.spacing, BeginAt=list(organ.place), UseToolRegion=1, ToolRegion="Sphere",
        FileName=os.path.join(args.output, name + ".palpate"))
    space.ToolRegion.Center, space.ToolRegion.Radius = list(organ.place), args.region
    data = output(update(space))
    line = (f"{name}: {field(data, 'NumberOfConfigurations')[0]:.0f} configurations, of which "
            f"{field(data, 'Reused')[0]:.0f} were known; the others took "
            f"{field(data, 'ExplorationSeconds')[0]:.3g} s (ranks: {field(data, 'Ranks')[0]:.0f}); "
            f"the file has {os.path.getsize(space.FileName) / 1e6:.0f} MB")
    return TouchStateSpace(Input=space), line


class Slide:
    """The sphere at the place that is touched, along the surface there; its places are ways from
    there, m."""

    def __init__(self, organ, args):
        self.normal = outwards(organ)
        across = np.cross(self.normal, np.eye(3)[np.argmin(np.abs(self.normal))])
        self.along = across / np.linalg.norm(across)
        self.middle = organ.place + (args.tool_radius - SHARE * args.depth) * self.normal

    def at(self, way):
        return list(self.middle + way * self.along)

    def exact(self, scene, ways, args):
        """The force along the normal (N) at each, solved for from outside."""
        solve = SolveEquilibrium(Input=scene, **sphere(args.tool_radius))
        forces = []
        for way in ways:
            solve.ToolPosition = self.at(way)
            solved = output(update(solve))
            found = field(solved, "Outcome")[0] == CONVERGED
            forces.append(self.normal @ field(solved, "ReactionForce") if found else np.nan)
        Delete(solve)
        return -np.array(forces)

    def felt(self, touch, ways):
        """The same by a state space that is touched; NaN where it does not reach."""
        forces = []
        for way in ways:
            touch.ToolPosition = self.at(way)
            touched = output(update(touch))
            inside = field(touched, "Found")[0] == INSIDE
            forces.append(self.normal @ field(touched, "Force") if inside else np.nan)
        return -np.array(forces)

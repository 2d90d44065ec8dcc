# SPDX-License-Identifier: BSD-3-Clause
"""What is palpated: the brain of the MNI template, of grey and white matter."""
import os
import sys

from paraview.simple import *

# Where ./fetch_maps puts them.
FOLDER = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "build", "brain")
GREY, WHITE = (os.path.join(FOLDER, f"mni_icbm152_{tissue}_tal_nlin_sym_09a_converted.nii.gz")
               for tissue in ("gm", "wm"))
TISSUES = ("Brain grey matter", "Brain white matter")
LEAST = 0.5  # probability of both tissues together, from which on there is brain
ISLAND = 2e-6  # m³; smaller parts of a tissue are noise of the maps
# How much of the height is held: what lies in the base of the skull. Above that the brain floats in
# water, and gives way to a finger.
HELD = 0.3
# The place farthest in front, to the left and above: of the frontal lobe; and the way out there.
FRONT, OUT, UP = [-0.0360, 0.0330, 0.0680], [-0.57, 0.32, 0.76], [0, 0, 1]  # m, no unit
# Brain stiffens as it is pressed, so not as deep as the liver; m.
PRESSED = {"ToolRadius": 0.015, "Depth": 0.005, "Spacing": 0.006}


def fill(labels, edge):
    """A body of the image of labels (mm); edge: m."""
    return TetrahedralizeLabelMap(Input=labels, Unit="mm", FillHoles=1, SmallestIsland=ISLAND,
                                  ElementSize=edge, ElementOrder="Quadratic")


def hold(body, tissues=TISSUES, held=HELD):
    """The body with what grey and white matter are made of, held below that share of its height."""
    rows = [text for region, tissue in zip("12", tissues) for text in (region, tissue, "")]
    scene = SetBoundary(Input=AssignMaterial(Input=body, RegionType="Table", RegionArray="RegionId",
                                             Regions=rows), FixedRegion="Plane")
    bounds = body.GetDataInformation().GetBounds()
    low, high = bounds[4:]
    scene.FixedRegion.Origin = [0, 0, low + held * (high - low)]
    scene.FixedRegion.Normal = [0, 0, 1]
    return scene


def make_scene(voxel=6, edge=35):
    """A coarse body, of which the first places are found soon; voxel, edge: mm."""
    # Not above: the window, which takes FRONT from here, does not know where pipeline.py is.
    from maps import Map, save_labels
    labels, _ = save_labels(Map(GREY), Map(WHITE), os.path.join(FOLDER, "labels.vti"),
                            float(voxel), LEAST)
    body = fill(labels, 1e-3 * float(edge))
    body.UpdatePipeline()
    return hold(body)

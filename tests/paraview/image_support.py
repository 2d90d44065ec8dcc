# SPDX-License-Identifier: BSD-3-Clause
"""Pictures that tests have made, and those of the folder baselines, which show what was looked at.

With PALPATE_NEW_BASELINES=1 the baselines are made anew: look at them."""

import os
import shutil

from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkImagingCore import vtkImageDifference
from vtkmodules.vtkIOImage import vtkPNGReader

SIZE = (320, 240)  # of a baseline
# Of vtkImageDifference, at a picture of this size: a camera moved by a hundredth or edges that are
# smoothed otherwise make less than 1, other colours of the check-points alone 200.
THRESHOLD = 16
LARGEST_DIFFERENCE = 20
VISIBLE = 30  # of 255, between the colours of a pixel
NEARLY_WHITE = 240
# ParaView 6 has colours, a background and a distance of the camera of its own.
BASELINES = os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "baselines",
    "paraview_6" if servermanager.vtkSMProxyManager.GetVersionMajor() >= 6 else "paraview_5")


def image(path):
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    return reader.GetOutput()


def pixels(path):
    """The colours, a row a pixel."""
    return vtk_to_numpy(image(path).GetPointData().GetScalars()).astype(int)


def share_drawn(path):
    """The share of the pixels that are not white."""
    return (pixels(path).min(axis=1) < NEARLY_WHITE).mean()


def share_different(one, other):
    """The share of the pixels that differ visibly."""
    return (abs(pixels(one) - pixels(other)).max(axis=1) > VISIBLE).mean()


def difference(one, other):
    measure = vtkImageDifference()
    measure.SetInputData(image(one))
    measure.SetImageData(image(other))
    measure.SetThreshold(THRESHOLD)
    measure.Update()
    return measure.GetThresholdedError()


def compare_with_baseline(name):
    """The picture <name>.png with the baseline of that name."""
    baseline = os.path.join(BASELINES, name + ".png")
    if os.environ.get("PALPATE_NEW_BASELINES"):
        shutil.copy(name + ".png", baseline)
    differs = difference(name + ".png", baseline)
    print("baseline", name, differs)
    assert differs < LARGEST_DIFFERENCE, (name, differs)

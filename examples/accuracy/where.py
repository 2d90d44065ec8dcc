# SPDX-License-Identifier: BSD-3-Clause
"""Where the error sits: test points as balls in front of the organ."""
import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import vtk_to_numpy

from pictures import INK, SIZE, VIEW_FROM
from sources import source_of

MESH = (0.6,) * 3
# Of a ball, in sides of the box of test points.
BALL = 0.02
SCALE = ((0.05, 0.19, 0.42), (0.28, 0.58, 0.72), (0.96, 0.87, 0.60), (0.88, 0.42, 0.16),
         (0.55, 0.02, 0.12))  # from small to large
# Of the points, %: better ones have the first colour. And how far the colours reach at the most.
BETTER, REACH = 5, 1e-4


class Where:
    """A view of the surface and the test points that a method can be shown in."""

    def __init__(self, surface, points):
        self.view = CreateRenderView()
        self.view.ViewSize = SIZE
        self.view.UseColorPaletteForBackground = 0
        self.view.Background = [1, 1, 1]
        self.view.OrientationAxesVisibility = 0
        body = source_of(surface)
        display = Show(body, self.view)
        display.Representation = "Wireframe"
        display.ColorArrayName = ["POINTS", ""]
        display.AmbientColor = display.DiffuseColor = MESH
        bounds = points.GetBounds()
        side = max(bounds[2 * k + 1] - bounds[2 * k] for k in range(3))
        centre = [0.5 * (bounds[2 * k] + bounds[2 * k + 1]) for k in range(3)]
        self.points = points.GetPointData()
        self.balls = Glyph(Input=source_of(points), GlyphType="Sphere", GlyphMode="All Points",
                           OrientationArray=["POINTS", "No orientation array"],
                           ScaleArray=["POINTS", "No scale array"], ScaleFactor=BALL * side)
        self.display = Show(self.balls, self.view)
        self.view.CameraFocalPoint = centre
        self.view.CameraPosition = [c + v for c, v in zip(centre, VIEW_FROM)]
        self.view.CameraViewUp = [0, 1, 0]
        self.view.CameraParallelProjection = 1
        self.view.CameraParallelScale = 0.95 * side

    def save(self, array, path):
        ColorBy(self.display, ("POINTS", array))
        colours = GetColorTransferFunction(array)
        colours.ColorSpace = "Lab"
        colours.NanColor = [0, 0, 0]
        errors = vtk_to_numpy(self.points.GetArray(array))
        errors = errors[errors > 0]
        most = np.nanmax(errors) if len(errors) else 1
        least = np.maximum(np.nanpercentile(errors, BETTER), REACH * most) if len(errors) else REACH
        least = np.minimum(least, 0.5 * most)
        steps = len(SCALE) - 1
        colours.RGBPoints = [value for i, colour in enumerate(SCALE)
                             for value in (least * (most / least) ** (i / steps), *colour)]
        colours.UseLogScale = 1
        bar = GetScalarBar(colours, self.view)
        bar.Title, bar.ComponentTitle = array[len("Error ("):-1] + ", error in %", ""
        bar.TitleColor = bar.LabelColor = INK
        bar.WindowLocation, bar.ScalarBarLength = "Lower Right Corner", 0.3
        self.display.SetScalarBarVisibility(self.view, True)
        SaveScreenshot(path, self.view, ImageResolution=SIZE)
        self.display.SetScalarBarVisibility(self.view, False)

    def end(self):
        Delete(self.view)

# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of the organ at rest and touched."""
import numpy as np
from paraview.simple import *

SIZE = [1200, 900]  # pixels
# The viewer stands in front of the organ, to its right and above.
VIEW_FROM = np.array((-0.55, 1.05, 0.75))
TISSUE, HELD, HAND = (0.80, 0.52, 0.46), (0.20, 0.33, 0.55), (0.05, 0.55, 0.25)
INK, PALE = (0.1,) * 3, (0.75,) * 3
SCALE = ((0.95, 0.87, 0.80), (0.93, 0.55, 0.32), (0.60, 0.05, 0.20))  # from none to most


class Stage:
    """A view of an organ that stays the same from picture to picture."""

    def __init__(self, scene):
        self.scene = scene
        self.view = CreateRenderView()
        self.view.ViewSize = SIZE
        self.view.UseColorPaletteForBackground = 0
        self.view.Background = [1, 1, 1]
        self.view.OrientationAxesVisibility = 0
        self.view.FillLightKFRatio = 1.3
        bounds = np.reshape(scene.GetDataInformation().GetBounds(), (3, 2))
        self.size = np.ptp(bounds, axis=1).max()
        centre = bounds.mean(axis=1)
        self.view.CameraFocalPoint = list(centre)
        self.view.CameraPosition = list(centre + VIEW_FROM)
        self.view.CameraViewUp = [0, 1, 0]
        self.show(scene)
        ResetCamera(self.view)
        self.view.CameraParallelScale *= 0.8
        self.view.CameraParallelProjection = 1

    def show(self, source, colour=None, **properties):
        display = Show(source, self.view)
        if colour is not None:
            display.ColorArrayName = ["POINTS", ""]
            display.AmbientColor = display.DiffuseColor = colour
        for name, value in properties.items():
            setattr(display, name, value)
        return display

    def clear(self):
        HideAll(self.view)

    def show_held(self):
        """A ball at each fixed point; those at the others have the size 0."""
        balls = Glyph(Input=self.scene, GlyphType="Sphere", GlyphMode="All Points",
                      OrientationArray=["POINTS", "No orientation array"],
                      ScaleArray=["POINTS", "Fixed"], ScaleFactor=0.02 * self.size)
        self.show(balls, HELD)

    def show_touched(self, touch, largest):
        """The deformed surface, coloured by its displacement from 0 to `largest` m."""
        self.colour(self.show(touch), ("POINTS", "Displacement", "Magnitude"),
                    "Displacement (m)", (0, largest))

    def colour(self, display, array, title, span):
        """Colours by an array from one value to another, with a bar."""
        ColorBy(display, array)
        colours = GetColorTransferFunction(array[1])
        colours.ColorSpace = "Lab"
        colours.RGBPoints = [value for x, colour in zip((0, 0.5, 1), SCALE)
                             for value in (span[0] + x * (span[1] - span[0]), *colour)]
        bar = GetScalarBar(colours, self.view)
        bar.Title, bar.ComponentTitle = title, ""
        bar.TitleColor = bar.LabelColor = INK
        bar.RangeLabelFormat = "%.4f"
        bar.WindowLocation, bar.ScalarBarLength = "Lower Right Corner", 0.3
        display.SetScalarBarVisibility(self.view, True)

    def write(self, text):
        self.show(Text(Text=text), Color=INK, FontSize=24, WindowLocation="Upper Left Corner")

    def save(self, path):
        SaveScreenshot(path, self.view, ImageResolution=SIZE)


def picture_rest(stage, position, half_width, path):
    """The mesh, where it is held, the active node and the box of its check-points."""
    stage.clear()
    stage.show(stage.scene, TISSUE, Representation="Surface With Edges", EdgeColor=(0.5, 0.3, 0.27))
    stage.show_held()
    stage.show(Sphere(Center=position, Radius=0.012 * stage.size), HAND)
    side = 2 * half_width
    stage.show(Box(Center=position, XLength=side, YLength=side, ZLength=side), INK,
               Representation="Wireframe", LineWidth=2)
    stage.write("At rest. Blue: held. Green: the active node, in the box of its check-points.")
    stage.save(path)


def picture_touch(stage, touch, name, position, displacement, force, arrow, path):
    """The deformed surface, coloured by its displacement, with the force as an arrow.

    position: of the displaced node, m
    force: that holds the node there, N
    arrow: where it starts and how far it goes, m
    """
    stage.clear()
    # Pale, not translucent: several ranks would exchange it, which recent releases of Expat
    # prevent.
    stage.show(stage.scene, PALE, Representation="Wireframe")
    stage.show_held()
    stage.show_touched(touch, np.linalg.norm(displacement))
    stage.show(Sphere(Center=position, Radius=0.012 * stage.size), HAND)
    show_arrow(stage, *arrow)
    stage.write(f"{name}: {1e3 * np.linalg.norm(displacement):.1f} mm, "
                f"{np.linalg.norm(force):.2f} N")
    stage.save(path)


def show_arrow(stage, start, along):
    length = np.linalg.norm(along)
    x, y, z = along / length
    thick = 0.007 * stage.size / length
    arrow = Transform(Input=Arrow(ShaftRadius=thick, TipRadius=2.5 * thick,
                                  TipLength=min(6 * thick, 0.5), TipResolution=24,
                                  ShaftResolution=24))
    # Not the position and the like of the display: several ranks that draw together miss them.
    arrow.Transform.Translate = list(start)
    arrow.Transform.Scale = [length] * 3
    # About y, then about z: brings the x axis, along which an arrow lies, into the direction.
    arrow.Transform.Rotate = [0, -np.degrees(np.arcsin(z)), np.degrees(np.arctan2(y, x))]
    stage.show(arrow, HAND)

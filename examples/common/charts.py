# SPDX-License-Identifier: BSD-3-Clause
"""Line charts of ParaView as pictures."""
from paraview.simple import *

from sources import source_of
from tables import vtk_table

SIZE = [1100, 750]  # pixels
ROOM = 6  # over the curves, for the legend
COLOURS = ((0.12, 0.33, 0.60), (0.80, 0.33, 0.10), (0.20, 0.55, 0.25), (0.55, 0.25, 0.60),
           (0.45, 0.45, 0.45), (0.75, 0.60, 0.05), (0.10, 0.60, 0.65), (0.70, 0.15, 0.35))
# Marker and line of each style: square, dashed; circle, solid; diamond, dotted; solid; square.
STYLES = ((3, 2), (4, 1), (5, 3), (0, 1), (3, 0))
LINE, MARKS = 3, 4


class Curve:
    """Points (x, y) with a line through them; numbers of its colour and of its style."""

    def __init__(self, label, points, colour, style):
        self.label, self.points, self.colour, self.style = label, sorted(points), colour, style


def chart(title, x_title, y_title, curves, path, logarithmic=(True, True)):
    view = CreateView("XYChartView")
    view.ViewSize = SIZE
    view.ChartTitle, view.ChartTitleFontSize = title, 18
    view.BottomAxisTitle, view.LeftAxisTitle = x_title, y_title
    view.BottomAxisLogScale, view.LeftAxisLogScale = map(int, logarithmic)
    view.BottomAxisTitleFontSize = view.LeftAxisTitleFontSize = 16
    view.BottomAxisLabelFontSize = view.LeftAxisLabelFontSize = 14
    view.LegendFontSize = 13
    values = [[point[axis] for curve in curves for point in curve.points] for axis in (0, 1)]
    for axis, name in enumerate(("Bottom", "Left")):
        low, high = min(values[axis]), max(values[axis])
        if logarithmic[axis]:
            low, high = low / 1.3, high * (1.3 if name == "Bottom" else ROOM)
        else:
            low, high = min(0, 1.1 * low), high * (1.08 if name == "Bottom" else 1.3)
        setattr(view, f"{name}AxisUseCustomRange", 1)
        setattr(view, f"{name}AxisRangeMinimum", low)
        setattr(view, f"{name}AxisRangeMaximum", high)
    for number, curve in enumerate(curves):
        # A name of its own: the series of a chart are told apart by it.
        name = f"y{number}"
        # A single point twice: the chart complains of a line of one.
        points = curve.points * (2 if len(curve.points) == 1 else 1)
        source = source_of(vtk_table([{"x": x, name: y} for x, y in points], ("x", name)))
        display = Show(source, view, "XYChartRepresentation")
        display.AttributeType = "Row Data"
        display.UseIndexForXAxis = 0
        display.XArrayName = "x"
        display.SeriesVisibility = [name]
        display.SeriesLabel = [name, curve.label]
        display.SeriesColor = [name, *map(str, COLOURS[curve.colour % len(COLOURS)])]
        marker, line = STYLES[curve.style]
        if len(curve.points) == 1:
            line = 0  # none
        display.SeriesLineStyle = [name, str(line)]
        display.SeriesLineThickness = [name, "2"]
        display.SeriesMarkerStyle = [name, str(marker)]
        display.SeriesMarkerSize = [name, "9"]
    SaveScreenshot(path, view, ImageResolution=SIZE)
    Delete(view)

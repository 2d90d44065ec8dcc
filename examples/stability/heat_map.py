# SPDX-License-Identifier: BSD-3-Clause
"""The matrix as a picture: a square a cell, its colour how the solve ended."""
import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import VTK_QUAD, vtkPolyData

from sources import source_of

# What a square says, and its colour; the worst comes last.
ENDS = (("converged", (0.36, 0.68, 0.42)),
        ("converged, unstable or near a fold", (0.75, 0.82, 0.35)),
        ("converged, inverted", (0.96, 0.72, 0.28)),
        ("stopped, with the reason", (0.80, 0.40, 0.32)),
        ("budget used up", (0.60, 0.45, 0.70)), ("not factorised", (0.35, 0.35, 0.40)),
        ("refused", (0.75, 0.75, 0.75)))
INK = (0.1,) * 3
TEXT = 15
# Height of a row, pixels; room to its left and between the squares, in rows.
ROW, LEFT, GAP = 22, 19, 0.04


def end_of(row, marked):
    bits = row.get("bits", 0) & marked
    if row["number"] == 0:
        return 2 if bits & 1 else 1 if bits else 0
    return {1: 3, 2: 5, 3: 4, 4: 3, 5: 6}[row["number"]]


def draw(rows, marked, path):
    across = list(dict.fromkeys((row["distance"], row["increments"]) for row in rows))
    down = list(dict.fromkeys((row["law"], row["Poisson's ratio"], row["contrast"])
                              for row in rows))
    squares = [(across.index((row["distance"], row["increments"])),
                down.index((row["law"], row["Poisson's ratio"], row["contrast"])),
                end_of(row, marked)) for row in rows]
    used = sorted({end for *_, end in squares})
    # In rows: where the lines of the legend end, and how high everything is.
    bottom = -len(down) - 1.5 - 1.4 * ((len(used) + 2) // 3)
    view = CreateRenderView()
    view.ViewSize = [1200, int(ROW * (3.5 - bottom))]
    view.UseColorPaletteForBackground, view.Background = 0, [1, 1, 1]
    view.OrientationAxesVisibility = 0
    right = 1200 / ROW - LEFT
    wide = (right - 0.5) / len(across)

    for number, (_, colour) in enumerate(ENDS):
        chosen = [(wide * x, -y, wide) for x, y, end in squares if end == number]
        if chosen:
            show(view, quads(chosen), colour)
    before = None
    for y, (law, ratio, contrast) in enumerate(down):
        if (law, ratio) != before:
            write(view, f"{law}, {ratio}", (-3.2, 0.25 - y), "Right")
            before = law, ratio
        write(view, f"x {contrast:g}", (-0.4, 0.25 - y), "Right")
    for x, (distance, increments) in enumerate(across):
        alike = [i for i, (name, _) in enumerate(across) if name == distance]
        if x == alike[0]:
            write(view, distance, (wide * (np.mean(alike) + 0.5), 2.3), "Center")
        write(view, f"in {increments}", (wide * (x + 0.5), 1.25), "Center")
    for place, number in enumerate(used):
        x, y = -LEFT + 1 + (LEFT + right) / 3 * (place % 3), -len(down) - 0.6 - 1.4 * (place // 3)
        show(view, quads([(x, y, 1.0)]), ENDS[number][1])
        write(view, ENDS[number][0], (x + 1.4, y + 0.25), "Left")
    frame(view, (-LEFT, right), (bottom, 3.5))
    SaveScreenshot(path, view, ImageResolution=view.ViewSize)
    Delete(view)


def quads(corners):
    """Rectangles of height 1 with their lower left corners and widths."""
    points, surface = vtkPoints(), vtkPolyData()
    places = [(px, py, 0.0) for x, y, width in corners
              for px, py in ((x + GAP, y + GAP), (x + width - GAP, y + GAP),
                             (x + width - GAP, y + 1 - GAP), (x + GAP, y + 1 - GAP))]
    points.SetData(numpy_to_vtk(np.array(places), deep=True))
    surface.SetPoints(points)
    surface.AllocateEstimate(len(corners), 4)
    for number in range(len(corners)):
        surface.InsertNextCell(VTK_QUAD, 4, [4 * number + k for k in range(4)])
    return source_of(surface)


def show(view, source, colour):
    display = Show(source, view)
    display.ColorArrayName = ["POINTS", ""]
    display.AmbientColor = display.DiffuseColor = colour
    display.Ambient, display.Diffuse = 1, 0


def write(view, text, place, side):
    Show(Text(Text=text), view, TextPropMode="Billboard 3D Text", Color=INK, FontSize=TEXT,
         BillboardPosition=[*place, 0.01], Justification=side)


def frame(view, across, down):
    """Looks at a rectangle from the front."""
    centre = [np.mean(across), np.mean(down)]
    view.CameraFocalPoint, view.CameraPosition = [*centre, 0], [*centre, 100]
    view.CameraViewUp, view.CameraParallelProjection = [0, 1, 0], 1
    aspect = view.ViewSize[0] / view.ViewSize[1]
    view.CameraParallelScale = max(np.ptp(down), np.ptp(across) / aspect) / 2

# SPDX-License-Identifier: BSD-3-Clause
"""What is seen at first, without a setting: representations, colour maps, names of kinds, and
pictures like those of the folder baselines. With the folder of the plugin PalpateInteractor also in
ParaView's window: a selected check-point is where the body is shown, a chart has its axes.

  test_pictures.py [folder of the plugin PalpateInteractor]
"""

import os
import shutil
import subprocess
import sys

from image_support import LARGEST_DIFFERENCE, SIZE, compare_with_baseline, difference
from paraview.simple import (AccuracyReport, ColorBy, Cone, CreateView, EstimateError,
                             GetColorTransferFunction, OutputPort, Render, ResetCamera,
                             SaveScreenshot, Show, SolveEquilibrium, StateSpaceReader,
                             TetrahedralizeSurface, TouchStateSpace)
from state_space_support import fetch_space, precompute
from support import fetch, node_at, point_array, scene

# Mesa's other software renderer, llvmpipe, makes code for the processor: on some of them spheres
# that are coloured by names are hardly seen. This one is the same everywhere, and slow.
os.environ["GALLIUM_DRIVER"] = "softpipe"
HERE = os.path.dirname(os.path.abspath(__file__))
TIME_OUT = 180  # s


def draw(name, *outputs, colour=None):
    """Shows them as they come in a view of their own, and compares.
    @returns their representations."""
    view = CreateView("RenderView")
    view.ViewSize = SIZE
    view.UseColorPaletteForBackground = 0
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    shown = [Show(output, view) for output in outputs]
    if colour:
        ColorBy(shown[0], ("POINTS", colour))
    view.CameraPosition, view.CameraFocalPoint = [1.1, 0.8, 1], [0.1, 0.05, 0.05]
    ResetCamera(view)
    Render(view)
    SaveScreenshot(name + ".png", view, ImageResolution=SIZE)
    compare_with_baseline(name)
    return shown


def names(array):
    """What the values of an array are called in the scalar bar."""
    function = GetColorTransferFunction(array)
    assert function.InterpretValuesAsCategories == 1, array
    return dict(zip(function.Annotations[::2], function.Annotations[1::2]))


def is_coloured_by(shown, array, association="POINTS"):
    return list(shown.ColorArrayName) == [association, array]


boundary = scene("body")
node = node_at(boundary, [0.2, 0.1, 0.1])
body, = draw("boundary", boundary)
assert is_coloured_by(body, "BoundaryKind") and body.Representation == "Surface With Edges"
assert names("BoundaryKind") == {"0": "free", "1": "touchable", "2": "fixed", "3": "held",
                                  "4": "loaded"}
kinds, fixed, touchable = (point_array(fetch(boundary), name)
                           for name in ("BoundaryKind", "Fixed", "Touchable"))
assert (kinds == 2 * fixed + touchable).all() and set(kinds) == {0, 1, 2}

solved = SolveEquilibrium(Input=boundary, ActiveNodes=[node], Displacement=[0, 0, 0.02])
assert is_coloured_by(Show(solved, CreateView("RenderView")), "Displacement")

faulty = TetrahedralizeSurface(Input=Cone(Capping=0), RepairSurface=1)
faults = Show(OutputPort(faulty, 1), CreateView("RenderView"))
assert is_coloured_by(faults, "SurfaceFault", "CELLS") and faults.LineWidth == 4
assert names("SurfaceFault")["0"] == "open edge"

space = precompute(boundary, [node], ForceLimit=0.5, FileName="pictures.palpate")
configurations = fetch_space(space)["Configurations"]
flags = point_array(configurations, "Flags")
status = point_array(configurations, "SolveStatus")
assert (status == 2 * (flags & 4 != 0)).all() and set(status) == {0, 2}
drawn, = draw("force", space)
assert is_coloured_by(drawn, "Force") and drawn.RenderPointsAsSpheres == 1
assert list(drawn.BlockSelectors) == ["/Root/Surface", "/Root/Configurations"]
draw("status", space, colour="SolveStatus")
assert names("SolveStatus")["2"] == "beyond the force limit"

read = StateSpaceReader(FileName="pictures.palpate")
touch = TouchStateSpace(Input=read, Displacement=[0, 0.01, 0.01])
read_space, touched = draw("touched", read, touch)
assert is_coloured_by(read_space, "Force") and is_coloured_by(touched, "Displacement")
# The comparison sees what is to be seen.
assert difference("status.png", "force.png") > 5 * LARGEST_DIFFERENCE

estimate = EstimateError(Input=precompute(boundary, [node]))
drawn, = draw("error", estimate)
assert is_coloured_by(drawn, "EstimatedError")
errors = point_array(fetch_space(estimate)["Configurations"], "EstimatedError")
forces = point_array(fetch_space(estimate)["Configurations"], "Force")
assert 0 < errors.max() < 0.1 * abs(forces).max(), errors.max()

report = AccuracyReport(Input=estimate.Input, TestPoints=10)
points = Show(OutputPort(report, 1), CreateView("RenderView"))
assert is_coloured_by(points, "Error (Energy Hermite)") and points.PointSize == 10
chart = Show(OutputPort(report, 3), CreateView("XYChartView"))
assert (chart.UseIndexForXAxis, chart.XArrayName) == (0, "Time")
assert list(chart.SeriesVisibility) == [
    "Energy Hermite", "Energy Hermite, no third derivatives", "Linear", "RBF cubic", "RBF linear",
    "Tricubic", "Trilinear"], list(chart.SeriesVisibility)

if len(sys.argv) > 1 and shutil.which("paraview"):
    environment = dict(os.environ)
    environment["PV_PLUGIN_PATH"] += os.pathsep + sys.argv[1]
    del environment["GALLIUM_DRIVER"]
    run = subprocess.run(["paraview", "--disable-registry", "--script",
                          os.path.join(HERE, "pictures_script.py")],
                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                         errors="replace", timeout=TIME_OUT, check=False, env=environment)
    print(run.stdout)
    assert run.returncode == 0, run.returncode
    said = dict(line.split(maxsplit=1) for line in run.stdout.splitlines() if " " in line)
    picked = f"{node} -0.01 -0.01 -0.02"
    assert said["touched"] == picked and said["still"] == picked, said
    assert said["log"] == "1 1" and said["time"] == "True" and said["bytes"] == "True", said

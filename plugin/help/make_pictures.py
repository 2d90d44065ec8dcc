# SPDX-License-Identifier: BSD-3-Clause
"""Makes the pictures of the pages here: the quick start, done in ParaView's window.

Sample run, in this folder, with both plugins in PV_PLUGIN_PATH and PALPATE_SOURCE_DIR set:
    xvfb-run -a -s "-noreset -screen 0 1280x1024x24" paraview --disable-registry \
        --script make_pictures.py
"""
import os
import sys
import traceback

import numpy as np
from paraview.simple import *
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
from vtkmodules.vtkImagingColor import vtkImageQuantizeRGBToIndex
from vtkmodules.vtkIOImage import vtkMetaImageWriter
from vtkmodules.vtkIOXML import vtkXMLPolyDataReader

source_folder = os.environ["PALPATE_SOURCE_DIR"]
sys.path.append(os.path.join(source_folder, "tests", "paraview"))
import qt
from qt import QtCore, QtGui, QtWidgets, wait, window

SIZE = QtCore.QSize(1120, 760)
COLOURS = (96, 48, 32)  # the first that makes the picture small enough
LARGEST = 60_000  # bytes
SURFACE = os.path.join(source_folder, "examples", "liver", "liver.vtp")
NODE = 107  # in front, in the middle
SECOND_HAND = np.array((-0.05, 0.02, 0.0))  # from there
NODULE, NODULE_RADIUS = np.array((-0.04, 0.02, 0.0)), 0.015
# The viewer stands in front of the organ, to its right and above.
VIEW_FROM = np.array((-0.55, 1.05, 0.75))


def part(name, kind=QtWidgets.QWidget):
    return window.findChild(kind, name)


def save(picture, name):
    """With a palette, so that it is small."""
    picture = picture.toImage().convertToFormat(QtGui.QImage.Format.Format_RGB888)
    width, height = picture.width(), picture.height()
    pixels = np.frombuffer(picture.bits().asstring(picture.sizeInBytes()), np.uint8)
    pixels = pixels.reshape(height, -1)[:, :3 * width].reshape(-1, 3)
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels, deep=True))
    quantize = vtkImageQuantizeRGBToIndex()
    quantize.SetInputData(image)
    for colours in COLOURS:
        quantize.SetNumberOfColors(colours)
        quantize.Update()
        table = quantize.GetLookupTable()
        index = vtk_to_numpy(quantize.GetOutput().GetPointData().GetScalars()).astype(np.uint8)
        indexed = QtGui.QImage(index.tobytes(), width, height, width,
                               QtGui.QImage.Format.Format_Indexed8)
        indexed.setColorTable([QtGui.qRgb(*(round(255 * c) for c in table.GetTableValue(i)[:3]))
                               for i in range(colours)])
        indexed.save(name + ".png")
        if os.path.getsize(name + ".png") <= LARGEST:
            return


def picture(name):
    for view in GetRenderViews():
        HideUnusedScalarBars(view)
        Render(view)
    wait(0.5)
    save(window.grab(), name)


def add(filter_name):
    qt.menu("Filters", "Palpate", filter_name)
    wait(0.3)
    return GetActiveSource()


def apply():
    qt.apply()
    wait(0.5)


def look(source):
    """From the same place at every picture."""
    view = GetActiveView()
    ResetCamera(view)
    centre = np.reshape(source.GetDataInformation().GetBounds(), (3, 2)).mean(axis=1)
    view.CameraFocalPoint, view.CameraPosition = list(centre), list(centre + VIEW_FROM)
    view.CameraViewUp = [0, 1, 0]
    ResetCamera(view)
    view.GetActiveCamera().Zoom(1.3)
    Render()


def save_label_map(name, voxel=4.0):
    """The liver as an image of labels, in mm: 1, and 2 for a nodule in its right lobe."""
    distance = vtkImplicitPolyDataDistance()
    reader = vtkXMLPolyDataReader()
    reader.SetFileName(SURFACE)
    reader.Update()
    distance.SetInput(reader.GetOutput())
    bounds = np.reshape(reader.GetOutput().GetBounds(), (3, 2)) * 1e3
    size = np.ceil((bounds[:, 1] - bounds[:, 0]) / voxel).astype(int) + 2
    image = vtkImageData()
    image.SetDimensions([int(n) for n in size])
    image.SetSpacing(voxel, voxel, voxel)
    image.SetOrigin(bounds[:, 0] - voxel / 2)
    places = [np.array(image.GetPoint(i)) for i in range(image.GetNumberOfPoints())]
    distances = np.array([distance.EvaluateFunction(place * 1e-3) for place in places])
    inside = distances * distances[0] < 0  # the first voxel is outside
    nodule = np.linalg.norm(places - 1e3 * NODULE, axis=1) < 1e3 * NODULE_RADIUS
    labels = (inside * (1 + nodule)).astype(np.uint8)
    image.GetPointData().SetScalars(numpy_to_vtk(labels, deep=True))
    writer = vtkMetaImageWriter()
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()


def show_motion(material, scene):
    """The liver, pulled to the front and back within 0.2 s, and how it swings then."""
    material.Density, material.ViscousTime = 1060, 0.005
    with open("pull.csv", "w") as file:
        file.write("Time,Tool0_X,Tool0_Y,Tool0_Z\n0,0,0,0\n0.1,0,0,0.02\n0.2,0,0,0\n")
    paths = CSVReader(FileName=["pull.csv"])
    SetActiveSource(scene)
    motion = add("Solve Dynamics")
    motion.ToolPaths, motion.ActiveNodes, motion.EndTime = paths, [NODE], 0.8
    motion.TimeStep, motion.TipRadius = 0.005, 0.012
    apply()
    warp = WarpByVector(Input=motion, Vectors=["POINTS", "Displacement"])
    body_view = GetRenderViews()[0]
    SetActiveView(body_view)
    Show(warp)
    Hide(motion)
    GetAnimationScene().AnimationTime = 0.12
    look(warp)
    SetActiveSource(motion)
    picture("SolveDynamics")
    chart, = (view for view in GetViews() if view.GetXMLName() == "XYChartView")
    Delete(chart)
    for proxy in (warp, motion, paths):
        Delete(proxy)
    material.Density = material.ViscousTime = 0
    GetAnimationScene().AnimationTime = 0


def show_two_hands(material, scene):
    """A model of the liver that two tools hold; they pull it apart within 0.3 s, and wait."""
    material.Density, material.ViscousTime = 1060, 0.01
    with open("hands.csv", "w") as file:
        file.write("Time,Tool0_X,Tool0_Y,Tool0_Z,Tool1_X,Tool1_Y,Tool1_Z\n"
                   "0,0,0,0,0,0,0\n0.3,0.01,0,0.01,-0.01,0.005,0.01\n")
    paths = CSVReader(FileName=["hands.csv"])
    SetActiveSource(scene)
    model = add("Build Reduced Model")
    places = vtk_to_numpy(servermanager.Fetch(scene).GetPoints().GetData())
    other = np.linalg.norm(places - places[NODE] - SECOND_HAND, axis=1).argmin()
    model.ActiveNodes, model.TipRadius = [NODE, int(other)], 0.012
    model.TrainingPaths, model.MaximumPoints = 2, 500
    apply()
    sheet, = (view for view in GetViews() if view.GetXMLName() == "SpreadSheetView")
    body_view = GetRenderViews()[0]
    SetActiveView(body_view)
    Show(model)
    look(model)
    SetActiveSource(model)
    picture("BuildReducedModel")
    Delete(sheet)
    SetActiveView(body_view)
    # What the dock does with it in each frame: both tools pull.
    touched = add("Touch Reduced Model")
    modes = model.PointData["ReducedBasis"].GetNumberOfComponents() // 3 - 6
    touched.Coordinates = [0] * modes + [0.01, 0, 0.01, -0.01, 0.005, 0.01]
    apply()
    Hide(model)
    look(touched)
    picture("TouchReducedModel")
    Delete(touched)
    Show(model)
    SetActiveSource(model)
    touch = add("Simulate Touch")
    touch.ToolPaths = paths
    apply()
    warp = WarpByVector(Input=touch, Vectors=["POINTS", "Displacement"])
    SetActiveView(body_view)
    shown = Show(warp)
    Hide(touch)
    Hide(model)
    GetAnimationScene().AnimationTime = 0.3
    look(warp)
    # Not that of the body at rest.
    shown.RescaleTransferFunctionToDataRangeOverTime()
    SetActiveSource(touch)
    picture("SimulateTouch")
    chart, = (view for view in GetViews() if view.GetXMLName() == "XYChartView")
    Delete(chart)
    for proxy in (warp, touch, model, paths):
        Delete(proxy)
    material.Density = material.ViscousTime = 0
    GetAnimationScene().AnimationTime = 0


def show_carried_surface(surface, solve, body):
    """The deformed body, and beside it a fine surface that it carries."""
    fine = LoopSubdivision(Input=Triangulate(Input=surface))
    fine.NumberofSubdivisions = 4
    solve.TipRadius, solve.Displacement = 0.015, [0, 0, 0.015]
    left = GetActiveView()
    right = CreateView("RenderView")
    AssignViewToLayout(view=right, layout=GetLayout(left), hint=0)
    SetActiveView(right)
    carried = CarrySurface(Input=solve, Surface=fine)
    display = Show(carried, right)
    ColorBy(display, None)
    SetActiveView(left)
    display = Show(body, left)
    display.SetRepresentationType("Surface With Edges")
    ColorBy(display, None)
    for view in (left, right):
        SetActiveView(view)
        view.OrientationAxesVisibility = 0
        look(body if view == left else carried)
    SetActiveSource(carried)
    wait(0.5)
    picture("CarrySurface")
    Delete(right)
    SetActiveView(left)
    left.OrientationAxesVisibility = 1
    for source in (carried, fine):
        Delete(source)


def main():
    window.resize(SIZE)
    dock = part("pqPalpateInteractorDock", QtWidgets.QDockWidget)
    dock.hide()
    for name in ("informationDock", "timeInspectorDock", "colorMapEditorDock"):
        if part(name):
            part(name).hide()
    wait(0.5)
    window.resizeDocks([part("propertiesDock")], [380], QtCore.Qt.Orientation.Horizontal)
    window.resizeDocks([part("pipelineBrowserDock"), part("propertiesDock")], [210, 500],
                       QtCore.Qt.Orientation.Vertical)

    surface = OpenDataFile(SURFACE)
    Show(surface)
    look(surface)
    picture("surface")

    body = add("Tetrahedralize Surface")
    body.ElementOrder, body.PreserveSurface = "Quadratic", 1
    apply()
    picture("TetrahedralizeSurface")

    material = add("Assign Material")
    material.Law, material.YoungsModulus = "Neo-Hookean", 5000
    apply()
    picture("AssignMaterial")

    scene = add("Set Boundary")
    scene.FixedRegion = "Sphere"
    scene.FixedRegion.Center, scene.FixedRegion.Radius = [-0.03, 0.06, -0.05], 0.04
    apply()
    picture("SetBoundary")

    refined = add("Refine Mesh")
    refined.ActiveNodes, refined.Depth, refined.MeshTolerance = [NODE], 0.008, 0.15
    refined.Tool = "Sphere"
    refined.Tool.Radius = 0.01
    apply()
    sheet, = (view for view in GetViews() if view.GetXMLName() == "SpreadSheetView")
    Show(OutputPort(refined, 1), sheet)
    Hide(scene)
    SetActiveView(GetRenderViews()[0])
    display = Show(refined)
    display.SetRepresentationType("Surface With Edges")
    ColorBy(display, None)
    SetActiveSource(refined)
    wait(0.3)
    picture("RefineMesh")
    Delete(sheet)
    Delete(refined)
    SetActiveSource(scene)
    Show(scene)

    SaveData("liver.feb", proxy=scene)
    model = OpenDataFile("liver.feb")
    Hide(scene)
    Show(model)
    SetActiveSource(model)
    picture("FEBio")
    Delete(model)
    SetActiveSource(scene)
    Show(scene)

    solve = add("Solve Equilibrium")
    solve.ActiveNodes, solve.Displacement = [NODE], [0, 0, 0.02]
    apply()
    warp = WarpByVector(Input=solve, Vectors=["POINTS", "Displacement"])
    Show(warp)
    Hide(solve)
    SetActiveSource(solve)
    picture("SolveEquilibrium")
    show_carried_surface(surface, solve, warp)
    Delete(warp)
    Delete(solve)

    for show in (show_motion, show_two_hands):
        show(material, scene)
        SetActiveSource(scene)
        Show(scene)
        wait(0.3)

    space = add("Precompute State Space")
    space.ActiveNodes = [NODE]
    space.FileName = "liver.palpate"
    wait(1)
    picture("estimates")
    apply()
    wait(1)
    look(space)
    picture("PrecomputeStateSpace")

    estimate = add("Estimate Error")
    apply()
    look(estimate)
    picture("EstimateError")
    Delete(estimate)
    SetActiveSource(space)

    touch = add("Touch State Space")
    apply()
    Show(space)
    outermost = "(CheckPoint[:,0] == 0) & (CheckPoint[:,1] == 0) & (CheckPoint[:,2] == 3)"
    QuerySelect(QueryString=outermost, FieldType="POINT", Source=space)
    # Not that of the equilibrium that was there before.
    GetDisplayProperties(touch).RescaleTransferFunctionToDataRange(False, True)
    picture("TouchStateSpace")
    ClearSelection(space)
    Delete(touch)
    SetActiveSource(space)

    part("propertiesDock").hide()
    part("pipelineBrowserDock").hide()
    dock.show()
    dock.raise_()
    wait(0.3)
    dock.findChild(QtWidgets.QComboBox, "device").setCurrentText("Mouse")
    part("start").click()
    wait(0.5)
    # It stays pressed.
    node = qt.pixel_of_node(GetActiveView(), FindSource("TouchStateSpace1"))
    qt.drag(node, QtCore.QPoint(1, 1), 20)
    wait(0.5)
    picture("dock")
    part("start").click()

    part("records").click()
    part("recordingFile").findChild(QtWidgets.QLineEdit).setText(os.path.abspath("touched.csv"))
    part("start").click()
    wait(0.5)
    last = qt.drag(node, QtCore.QPoint(1, 1), 40)
    wait(0.5)
    part("start").click()
    qt.send(qt.Event.MouseButtonRelease, last, buttons=qt.Button.NoButton)
    Delete(FindSource("TouchStateSpace1"))

    dock.hide()
    part("propertiesDock").show()
    part("pipelineBrowserDock").show()
    SetActiveSource(space)
    replay = add("Replay Touch")
    replay.FileName = "touched.csv"
    apply()
    GetAnimationScene().GoToLast()
    GetAnimationScene().GoToPrevious()
    force = OutputPort(replay, 2)
    force.UpdatePipeline(GetAnimationScene().AnimationTime)
    arrow = Glyph(Input=force, GlyphType="Arrow", GlyphMode="All Points",
                  OrientationArray=["POINTS", "Force"], ScaleArray=["POINTS", "Force"],
                  ScaleFactor=0.04)
    shown = Show(arrow)
    shown.SetScalarBarVisibility(GetActiveView(), False)
    ColorBy(shown, None)
    shown.AmbientColor = shown.DiffuseColor = [0.8, 0.1, 0.1]
    look(replay)
    SetActiveSource(replay)
    picture("ReplayTouch")
    Delete(arrow)
    Delete(replay)
    SetActiveSource(space)
    Show(space)
    save_label_map("liver.mha")
    for source in GetSources().values():
        Hide(source)
    image = OpenDataFile("liver.mha")
    SetActiveSource(image)
    wait(0.3)
    tissues = add("Tetrahedralize Label Map")
    tissues.Unit, tissues.ElementSize, tissues.ElementOrder = "mm", 0.014, "Quadratic"
    apply()
    Hide(image)
    half = Clip(Input=tissues, ClipType="Plane", Crinkleclip=1)
    half.ClipType.Origin, half.ClipType.Normal = list(NODULE), [0, 0, 1]
    Hide(tissues)
    shown = Show(half)
    shown.SetRepresentationType("Surface With Edges")
    ColorBy(shown, ("CELLS", "RegionId"))
    look(half)
    SetActiveSource(tissues)
    picture("TetrahedralizeLabelMap")
    for proxy in (half, tissues, image):
        Delete(proxy)
    SetActiveSource(space)
    Show(space)
    report = add("Accuracy Report")
    report.TestPoints = 100
    apply()
    picture("AccuracyReport")


def run():
    try:
        main()
    except BaseException:
        traceback.print_exc()
        window.grab().save("failed.png")
    os._exit(0)


QtCore.QTimer.singleShot(500, run)

# SPDX-License-Identifier: BSD-3-Clause
"""What long filters say that they will take, before they are applied: beside what they took, and
where something is wrong. On several ranks it is the first one that says it, of the whole body."""

import os
import re

import numpy
from paraview.modules.vtkRemotingCore import vtkProcessModule
from paraview.simple import *
from support import box_body, expect_silence, fetch, field, node_at, produce, scene, source
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkMetaImageWriter

RANKS = vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
# The number of tetrahedra that TetGen makes is told to this factor (vtkPalpateTetrahedralize*.cxx);
# other numbers have two figures.
MESHED, ROUNDED = 2.5, 1.05


def estimate(filter_):
    expect_silence(lambda: filter_.InvokeCommand("UpdateEstimate"))
    filter_.UpdatePropertyInformation()
    return filter_.GetPropertyValue("Estimate")


def number_before(word, text):
    """As 12 000 in "12 000 tetrahedra", or 1.5e9 in "1.5 GB"."""
    found = re.search(rf"(\d[\d.\u00a0]*) {word}", text)
    assert found, (word, text)
    return float(found.group(1).replace("\u00a0", "")) * {"MB": 1e6, "GB": 1e9}.get(word, 1)


def assert_near(told, took, factor, what):
    assert took / factor <= told <= took * factor, (what, told, took)


def assert_body(filter_):
    text = estimate(filter_)
    grid = fetch(filter_)
    assert_near(number_before("tetrahedra", text), grid.GetNumberOfCells(), MESHED, text)
    assert_near(number_before("points", text), grid.GetNumberOfPoints(), MESHED, text)
    assert "GB" not in text and number_before("MB", text) > 0, text
    return number_before("tetrahedra", text)


def test_surface():
    ball = Sphere(Radius=0.05, ThetaResolution=24, PhiResolution=24)
    body = TetrahedralizeSurface(Input=ball)
    assert "Apply the filter before this one" in estimate(body)
    ball.UpdatePipeline()
    coarse = assert_body(body)
    body.MaximumVolume = 2e-8
    assert assert_body(body) > 3 * coarse
    body.ElementOrder = "Quadratic"
    assert_body(body)
    body.MaximumVolume, body.RefineVolume = 0, 2e-8
    body.RefineRegion = "Sphere"
    body.RefineRegion.Center, body.RefineRegion.Radius = [0.05, 0, 0], 0.03
    assert assert_body(body) > 1.5 * coarse
    body.PreserveSurface = 1
    assert_body(body)
    body.MaximumVolume = 1e-15
    assert "asks for more than 2e+07 tetrahedra" in estimate(body), estimate(body)


def label_image(size, kind, factor=1):
    """A ball, in a file, from which every rank reads."""
    axis = numpy.linspace(-1, 1, size)
    z, y, x = numpy.meshgrid(axis, axis, axis, indexing="ij")
    image = vtkImageData()
    image.SetDimensions(size, size, size)
    image.GetPointData().SetScalars(numpy_to_vtk(
        (factor * (x**2 + y**2 + z**2 < 0.8)).astype(kind).ravel(), deep=True))
    name = f"ball_{size}.mha"
    writer = vtkMetaImageWriter()
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()
    opened = OpenDataFile(name)
    opened.UpdatePipeline()
    return opened


def test_label_map():
    body = TetrahedralizeLabelMap(Input=label_image(40, numpy.uint8))
    assert "Unit of the image is not said" in estimate(body), estimate(body)
    body.Unit = "mm"
    automatic = assert_body(body)
    body.ElementSize = 0.006
    assert assert_body(body) < automatic
    body.ElementSize = 1e-5
    assert "more than 2e+07" in estimate(body), estimate(body)

    wrong = TetrahedralizeLabelMap(Input=label_image(10, numpy.float64, 0.5), Unit="mm")
    assert "0.5" in estimate(wrong), estimate(wrong)
    if RANKS > 1:
        return

    # 10⁸ voxels and more: nothing is made of them, and nothing is read.
    huge = vtkImageData()
    huge.SetDimensions(500, 500, 401)
    huge.AllocateScalars(3, 1)  # unsigned char
    many = produce(huge)
    many.UpdatePipeline()
    text = estimate(TetrahedralizeLabelMap(Input=many, Unit="mm"))
    assert "1.0025e+08 voxels" in text and "Extract Subset" in text, text


def test_equilibrium(boundary, node):
    solve = SolveEquilibrium(Input=boundary, ActiveNodes=[node], Displacement=[0, 0, 0.005])
    text = estimate(solve)
    assert_near(number_before("unknowns", text), field(fetch(solve), "Unknowns")[0], ROUNDED, text)
    assert number_before("MB", text) > 0, text
    solve.Tool = "Sphere"
    assert estimate(solve) != text or "at most" in text


def test_space(boundary, node):
    space = PrecomputeStateSpace(Input=boundary, ActiveNodes=[node], HalfWidth=0.003, Resolution=5,
                                 FileName="estimate.palpate", Keep="All",
                                 LogInterval=0)
    text = estimate(space)
    assert_near(number_before("configurations", text), 125, ROUNDED, text)
    expect_silence(space.UpdatePipeline)
    # Those of the active node are eliminated.
    unknowns = space.FieldData["Unknowns"].GetRange(0)[0] + 3
    assert_near(number_before("unknowns", text), unknowns, ROUNDED, text)
    size = os.path.getsize("estimate.palpate")
    assert_near(number_before("MB of disk", text) * 1e6, size, 1.5, text)
    assert estimate(space) == text

    report = AccuracyReport(Input=space, TestPoints=20, LogInterval=0)
    assert_near(number_before("equilibria", estimate(report)), 20, ROUNDED, "points")

    space.Tool, space.ToolRadius, space.Depth, space.Spacing = "Sphere", 0.02, 0.004, 0.01
    text = estimate(space)
    assert "touches nothing" in text, text
    space.MaximumConfigurations = 10
    assert "at most 10 are allowed" in estimate(space), estimate(space)
    space.MaximumConfigurations = 30000
    space.Spacing = 1e-4
    assert "Take a spacing of" in estimate(space), estimate(space)
    space.Depth = 0
    assert "Neither a depth nor a force limit" in estimate(space), estimate(space)


def test_not_applied():
    """A person sees what is to be done first, and nothing fails."""
    body = source(box_body(), "bare")
    solve = SolveEquilibrium(Input=body)
    assert "Apply the filter before this one" in estimate(solve), estimate(solve)
    body.UpdatePipeline()
    assert "Assign Material" in estimate(solve), estimate(solve)
    space = PrecomputeStateSpace(Input=body)
    assert "Assign Material" in estimate(space), estimate(space)


test_surface()
test_label_map()
held = scene()
held.UpdatePipeline()
touched = node_at(held, [0.2, 0.05, 0.1]) if RANKS == 1 else 10
test_not_applied()
test_equilibrium(held, touched)
test_space(held, touched)

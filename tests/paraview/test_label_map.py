# SPDX-License-Identifier: BSD-3-Clause
"""TetrahedralizeLabelMap in ParaView: from an image on disk to a touched body of two tissues, every
property, and errors. On several ranks the first one has the body."""

import math

import numpy
from paraview import servermanager
from paraview.modules.vtkRemotingCore import vtkProcessModule
from paraview.simple import (AssignMaterial, OpenDataFile, SetBoundary, SolveEquilibrium,
                             TetrahedralizeLabelMap)
from support import cell_array, expect_error, expect_silence, fetch, field, places
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, vtkImageData
from vtkmodules.vtkIOXML import vtkXMLImageDataWriter

RANKS = vtkProcessModule.GetProcessModule().GetNumberOfLocalPartitions()
SIZE = 31  # voxels along an axis
SPACING = (2.0, 2.0, 2.0)  # mm
RADIUS, NODULE = 24.0, 9.0  # mm


def save_image(name):
    """A ball of label 1 with a nodule of label 2, off its middle."""
    axis = SPACING[0] * (numpy.arange(SIZE) - (SIZE - 1) / 2)
    z, y, x = numpy.meshgrid(axis, axis, axis, indexing="ij")
    labels = (x**2 + y**2 + z**2 < RADIUS**2).astype(numpy.uint8)
    labels[(x - 8)**2 + y**2 + z**2 < NODULE**2] = 2
    image = vtkImageData()
    image.SetDimensions(SIZE, SIZE, SIZE)
    image.SetSpacing(SPACING)
    image.SetOrigin(100, 0, -50)
    image.GetPointData().SetScalars(numpy_to_vtk(labels.ravel(), deep=True))
    image.GetPointData().GetScalars().SetName("Tissues")
    writer = vtkXMLImageDataWriter()
    writer.SetDataModeToBinary()  # recent releases of Expat make readers refuse appended data
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()
    return {label: (labels == label).sum() * numpy.prod(SPACING) * 1e-9 for label in (1, 2)}


def test_road(image, volumes):
    body = TetrahedralizeLabelMap(Input=image, Unit="mm", ElementSize=0.005,
                                  ElementOrder="Quadratic")
    grid = expect_silence(lambda: fetch(body))
    assert grid.GetCellType(0) == VTK_QUADRATIC_TETRA
    assert set(cell_array(grid, "RegionId")) == {1, 2}
    assert list(field(grid, "Label")) == [1, 2]
    for told, mesh, label in zip(field(grid, "ImageVolume"), field(grid, "MeshVolume"), (1, 2)):
        assert math.isclose(told, volumes[label], rel_tol=1e-9), label
        assert math.isclose(mesh, told, rel_tol=0.02), label
    middle = places(grid).mean(axis=0)
    assert numpy.allclose(middle, [0.13, 0.03, -0.02], atol=2e-3), middle
    walls = servermanager.Fetch(body, idx=1)
    sides = {tuple(sorted(walls.GetCellData().GetArray("BoundaryLabels").GetTuple2(i)))
             for i in range(walls.GetNumberOfCells())}
    assert sides == {(0, 1), (1, 2)}, sides

    material = AssignMaterial(
        Input=body, RegionType="Table", RegionArray="RegionId",
        Regions=["1", "Neo-Hookean", "YoungsModulus 5000 PoissonsRatio 0.45",
                 "2", "Neo-Hookean", "YoungsModulus 20000 PoissonsRatio 0.45"])
    boundary = SetBoundary(Input=material, FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0.115, 0, 0], [1, 0, 0]
    node = int(numpy.argmax(places(grid)[:, 0]))
    solved = fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[node],
                                    Displacement=[-0.003, 0, 0], TipRadius=0.008))
    assert field(solved, "Outcome")[0] == 0
    force = numpy.ravel(field(solved, "ReactionForce"))
    assert -10 < force[0] < -0.1, force


def test_every_property(image):
    body = TetrahedralizeLabelMap(
        Input=image, Unit="mm", LabelArray="Tissues", Labels=[2], Smoothing=5,
        SmallestIsland=1e-9, FillHoles=1, ElementSize=0.006, LabelSizes=[2, 0.004],
        ElementOrder="Linear", MaximumRadiusEdgeRatio=1.6, TimeOut=60.0)
    names = set(body.ListProperties()) - {"Input", "ErrorCode", "Estimate", "UpdateEstimate"}
    assert names == {"Unit", "LabelArray", "Labels", "Smoothing", "SmallestIsland", "FillHoles",
                     "ElementSize", "LabelSizes", "ElementOrder", "MaximumRadiusEdgeRatio",
                     "TimeOut", "RefineRegion", "RefineEdge", "EdgeGrowth"}, names
    grid = expect_silence(lambda: fetch(body))
    assert set(cell_array(grid, "RegionId")) == {2}


def test_edges_in_a_region(image, volumes):
    """Finer where a tool will press, with the tissues as they were."""
    body = TetrahedralizeLabelMap(Input=image, Unit="mm", ElementSize=0.01)
    coarse = fetch(body)
    body.RefineRegion = "Sphere"
    body.RefineRegion.Center, body.RefineRegion.Radius = [0.154, 0.03, -0.02], 0.006
    body.RefineEdge = 0.003
    grid = expect_silence(lambda: fetch(body))
    assert grid.GetNumberOfCells() > 2 * coarse.GetNumberOfCells()
    points = places(grid)
    cells = numpy.array([[grid.GetCell(i).GetPointId(k) for k in range(4)]
                         for i in range(grid.GetNumberOfCells())])
    p = points[cells]
    sizes = numpy.einsum("ij,ij->i", numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]),
                         p[:, 3] - p[:, 0]) / 6
    assert sizes.min() > 0
    region = cell_array(grid, "RegionId")
    for label, told in zip(field(grid, "Label"), field(grid, "MeshVolume")):
        assert math.isclose(sizes[region == label].sum(), told, rel_tol=1e-6), label
        assert math.isclose(told, volumes[label], rel_tol=0.1), label
    inside = numpy.linalg.norm(p.mean(axis=1) - [0.154, 0.03, -0.02], axis=1) < 0.005
    edges = numpy.max([numpy.linalg.norm(p[:, a] - p[:, b], axis=1)
                       for a in range(4) for b in range(a)], axis=0)
    assert inside.sum() > 20 and edges[inside].max() <= 0.003 * (1 + 1e-6)
    assert edges.max() > 0.008


def test_errors(image):
    expect_error(lambda: fetch(TetrahedralizeLabelMap(Input=image)), "Unit", "60 × 60 × 60", "mm")
    expect_error(lambda: fetch(TetrahedralizeLabelMap(Input=image, Unit="m", ElementSize=0.01)),
                 "tetrahedra", "ElementSize")
    expect_error(lambda: fetch(TetrahedralizeLabelMap(Input=image, Unit="mm", Labels=[4])),
                 "Labels has 4", "1, 2")
    # One error, though a filter follows.
    failed = TetrahedralizeLabelMap(Input=image, Unit="mm", ElementSize=1)
    expect_error(lambda: fetch(AssignMaterial(Input=failed)), "vanishes")


def main():
    volumes = save_image("ball.vti")
    image = OpenDataFile("ball.vti")
    test_road(image, volumes)
    if RANKS == 1:
        test_every_property(image)
        test_edges_in_a_region(image, volumes)
        test_errors(image)


main()

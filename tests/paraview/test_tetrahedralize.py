# SPDX-License-Identifier: BSD-3-Clause
"""TetrahedralizeSurface in ParaView: every property, both outputs, errors, ranks."""

import math
import os

import numpy
from paraview import servermanager
from paraview.simple import (AppendDatasets, AppendGeometry, Box, Clip, Cylinder, ExtractSurface,
                             GroupDatasets, ProgrammableFilter, Sphere, STLReader,
                             TetrahedralizeSurface)
from support import cell_array, expect_error, expect_silence, fetch, places
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA


def corners(grid):
    return numpy.array([[grid.GetCell(i).GetPointId(k) for k in range(4)]
                        for i in range(grid.GetNumberOfCells())])


def volumes(grid):
    p = places(grid)[corners(grid)]
    return numpy.einsum("ij,ij->i", numpy.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]),
                        p[:, 3] - p[:, 0]) / 6


def repair_report(grid):
    return grid.GetFieldData().GetAbstractArray("Repair").GetValue(0)


def good(body, volume, tolerance=1e-6):
    grid = expect_silence(lambda: fetch(body))
    assert grid.GetNumberOfCells() > 0
    assert volumes(grid).min() > 0
    assert abs(volumes(grid).sum() / volume - 1) < tolerance, volumes(grid).sum() / volume
    return grid


def check_defaults_and_names():
    body = TetrahedralizeSurface(Input=Box())
    assert body.Unit == "m"
    assert body.ElementOrder == "Linear"
    assert body.MaximumRadiusEdgeRatio == 1.414
    assert body.MaximumVolume == 0
    assert body.PreserveSurface == 0
    assert body.RegionArray == "Automatic"
    assert body.WallTolerance == 0
    assert body.RepairSurface == 0
    assert body.RepairResolution == 80
    assert body.RefineVolume == 0 and body.RefineEdge == 0
    assert body.EdgeArray == "None" and body.EdgeGrowth == 0.4
    assert body.TimeOut == 600
    grid = good(body, 1)
    assert grid.GetCellType(0) == VTK_TETRA
    assert set(cell_array(grid, "Region")) == {0}
    assert repair_report(grid) == "none"
    assert servermanager.Fetch(body, idx=1).GetNumberOfCells() == 0


def check_every_property():
    body = TetrahedralizeSurface(Input=Box())
    coarse = good(body, 1).GetNumberOfCells()
    body.MaximumVolume = 0.002
    bounded = good(body, 1)
    assert volumes(bounded).max() <= 0.002 * (1 + 1e-9)
    body.MaximumVolume = 2e-12
    body.Unit = "mm"
    assert abs(good(body, 1e-9).GetNumberOfCells() / bounded.GetNumberOfCells() - 1) < 0.2
    body.MaximumVolume = 0.002
    body.Unit = "m"
    assert bounded.GetNumberOfCells() > coarse
    body.ElementOrder = "Quadratic"
    quadratic = good(body, 1)
    assert quadratic.GetCellType(0) == VTK_QUADRATIC_TETRA
    assert quadratic.GetNumberOfCells() == bounded.GetNumberOfCells()
    body.ElementOrder = "Linear"
    body.MaximumRadiusEdgeRatio = 1.1
    assert good(body, 1).GetNumberOfCells() > bounded.GetNumberOfCells()

    body = TetrahedralizeSurface(Input=Sphere(ThetaResolution=24, PhiResolution=24))
    exact = math.pi / 6
    free = good(body, exact, 0.03).GetNumberOfCells()
    body.PreserveSurface = 1
    assert good(body, exact, 0.03).GetNumberOfCells() < free
    body.RepairSurface = 1
    body.RepairResolution = 40
    assert repair_report(good(body, exact, 0.03)) == "none needed"
    body.TimeOut = 60
    good(body, exact, 0.03)


def check_refine_region():
    body = TetrahedralizeSurface(Input=Box())
    coarse = good(body, 1).GetNumberOfCells()
    body.RefineRegion = "Sphere"
    body.RefineRegion.Center = [0.25, 0.25, 0.25]
    body.RefineRegion.Radius = 0.2
    assert good(body, 1).GetNumberOfCells() == coarse  # no RefineVolume yet
    body.RefineVolume = 1e-4

    def volumes_inside(inside):
        grid = good(body, 1)
        middles = places(grid)[corners(grid)].mean(axis=1)
        return volumes(grid)[inside(middles)], volumes(grid)

    fine, every = volumes_inside(lambda x: numpy.linalg.norm(x - 0.25, axis=1) < 0.2)
    assert len(fine) > 100 and fine.max() <= 1e-4 * (1 + 1e-6)
    assert every.max() > 1e-3
    body.RefineRegion = "Box"
    body.RefineRegion.Position = [-0.5, -0.5, -0.5]
    body.RefineRegion.Length = [0.3, 0.3, 0.3]
    fine, every = volumes_inside(lambda x: (x < -0.2).all(axis=1))
    assert len(fine) > 100 and fine.max() <= 1e-4 * (1 + 1e-6)
    body.RefineRegion = "Plane"
    body.RefineRegion.Origin = [0.3, 0, 0]
    body.RefineRegion.Normal = [-1, 0, 0]
    fine, every = volumes_inside(lambda x: x[:, 0] > 0.3)
    assert len(fine) > 100 and fine.max() <= 1e-4 * (1 + 1e-6)
    body.RefineRegion = "Cylinder"
    body.RefineRegion.Radius = 0.1
    fine, every = volumes_inside(lambda x: numpy.hypot(x[:, 0], x[:, 2]) < 0.1)
    assert len(fine) > 100 and fine.max() <= 1e-4 * (1 + 1e-6)


def longest_edges(grid):
    """Of each cell."""
    p = places(grid)[corners(grid)]
    return numpy.max([numpy.linalg.norm(p[:, a] - p[:, b], axis=1)
                      for a in range(4) for b in range(a)], axis=0)


def check_edges(grid, allowed):
    """No edge is longer than allowed at the corners of its cell; most are not much shorter.
    @returns the longest edges of the cells."""
    longest = longest_edges(grid)
    at_corners = allowed(places(grid))[corners(grid)].min(axis=1)
    assert (longest <= at_corners * (1 + 1e-6)).all(), (longest / at_corners).max()
    return longest


def check_edges_in_a_region():
    body = TetrahedralizeSurface(Input=Box(), PreserveSurface=1)
    coarse = good(body, 1).GetNumberOfCells()
    body.RefineRegion = "Sphere"
    centre, radius = numpy.array([0.5, 0, 0]), 0.05
    body.RefineRegion.Center, body.RefineRegion.Radius = list(centre), radius
    body.RefineEdge = 0.03
    # The region is known on a grid, half of whose diagonal is less than that.
    slack = 0.02

    def allowed(growth):
        return lambda x: 0.03 + growth * numpy.maximum(
            0, numpy.linalg.norm(x - centre, axis=1) - radius + slack)

    grid = good(body, 1)
    longest = check_edges(grid, allowed(0.4))
    assert longest.max() > 0.15 and 500 < grid.GetNumberOfCells() < 60000, grid.GetNumberOfCells()
    # The facets under the tool are as fine as the cells, and the box is still a box.
    faces = fetch(ExtractSurface(Input=body))
    near = [i for i in range(faces.GetNumberOfCells())
            if numpy.linalg.norm(numpy.mean([faces.GetPoint(faces.GetCell(i).GetPointId(k))
                                             for k in range(3)], axis=0) - centre) < radius]
    assert len(near) > 10
    body.EdgeGrowth = 1.5
    fewer = good(body, 1)
    check_edges(fewer, allowed(1.5))
    assert coarse < fewer.GetNumberOfCells() < grid.GetNumberOfCells()
    body.ElementOrder = "Quadratic"
    assert good(body, 1).GetCellType(0) == VTK_QUADRATIC_TETRA
    body.RefineRegion.Center = [5, 0, 0]
    expect_error(lambda: fetch(body), "RefineRegion has no point in the body")
    body.RefineRegion.Center, body.RefineEdge = [0, 0, 0], 1e-5
    expect_error(lambda: fetch(body), "tetrahedra", "RefineEdge", "EdgeGrowth")


def check_edges_of_an_array():
    """Of surfaces of two regions, in mm: sizes at points of one of them."""
    def sized(source):
        return ProgrammableFilter(Input=source, Script="""
import numpy
output.ShallowCopy(inputs[0].VTKObject)
points = numpy.array(inputs[0].Points)
output.PointData.append(numpy.where(points[:, 2] > 999, 5e-2, 0.0), "Edge")
""")
    lower = Box(XLength=1000, YLength=1000, ZLength=1000, Center=[0, 0, 500])
    upper = Box(XLength=1000, YLength=1000, ZLength=500, Center=[0, 0, 1250])
    body = TetrahedralizeSurface(Input=[sized(lower), upper], Unit="mm", EdgeGrowth=0.6)
    coarse = good(body, 1.5)
    body.EdgeArray = "Edge"
    grid = good(body, 1.5)
    assert region_volumes(grid) == [1, 0.5]
    corner = numpy.array([0.5, 0.5, 1])

    def allowed(x):
        return numpy.min([0.05 + 0.6 * numpy.linalg.norm(x - corner * [i, j, 1], axis=1)
                          for i in (-1, 1) for j in (-1, 1)], axis=0)

    longest = check_edges(grid, allowed)
    assert longest.min() < 0.05 and grid.GetNumberOfCells() > 2 * coarse.GetNumberOfCells()
    body.EdgeArray = "Other"
    expect_error(lambda: fetch(body), "EdgeArray is 'Other'", "point array")


def check_several_bodies():
    two = ExtractSurface(Input=AppendDatasets(Input=[Box(), Cylinder(Center=[5, 0, 0])]))
    grid = good(TetrahedralizeSurface(Input=two), 1 + 0.25 * 6 * math.sin(math.pi / 3) / 2)
    assert set(cell_array(grid, "Region")) == {0, 1}


def layers():
    return [Box(ZLength=height, Center=[0, 0, middle])
            for height, middle in ((1, 0.5), (2, 2), (0.5, 3.25))]


def region_volumes(grid):
    region = cell_array(grid, "Region")
    exact = {int(k): volumes(grid)[region == k].sum() for k in numpy.unique(region)}
    fields = grid.GetFieldData()
    told = [fields.GetArray(name) for name in ("RegionNumber", "RegionVolume")]
    assert exact.keys() == {int(told[0].GetTuple1(i)) for i in range(told[0].GetNumberOfTuples())}
    for i in range(told[0].GetNumberOfTuples()):
        assert abs(told[1].GetTuple1(i) / exact[int(told[0].GetTuple1(i))] - 1) < 1e-9
    assert len(numpy.unique(places(grid), axis=0)) == grid.GetNumberOfPoints()
    return [round(exact[k], 9) for k in sorted(exact)]


def check_tissues_that_share_walls():
    body = TetrahedralizeSurface(Input=layers())
    assert region_volumes(good(body, 3.5)) == [1, 2, 0.5]
    body.InvokeCommand("UpdateEstimate")
    body.UpdatePropertyInformation()
    assert "tetrahedra" in body.GetPropertyValue("Estimate")
    for kind in ("vtkMultiBlockDataSet", "vtkPartitionedDataSetCollection"):
        group = GroupDatasets(Input=layers(), BlockNames=["skin", "fat", "muscle"])
        group.OutputType = kind
        grid = good(TetrahedralizeSurface(Input=group), 3.5)
        assert region_volumes(grid) == [1, 2, 0.5]
        names = grid.GetFieldData().GetAbstractArray("RegionName")
        assert [names.GetValue(i) for i in range(3)] == ["skin", "fat", "muscle"], kind
    # The second lies 1 mm above the first, and has other triangles.
    apart = TetrahedralizeSurface(Input=[Box(Center=[0, 0, 0.5]), Box(ZLength=2,
                                                                      Center=[0.2, 0, 2.001])])
    apart.WallTolerance = 0.002
    region_volumes(good(apart, 3.0008, 1e-4))
    assert "0.001 m away" in repair_report(fetch(apart))
    one = AppendGeometry(Input=layers())
    assert region_volumes(good(TetrahedralizeSurface(Input=one), 3.5)) == [1, 2, 0.5]
    numbered = ProgrammableFilter(Input=one, Script="""
import numpy
output.ShallowCopy(inputs[0].VTKObject)
count = output.GetNumberOfCells()
output.CellData.append(numpy.repeat([9, 4, 4], count // 3), "Tissue")
""")
    body = TetrahedralizeSurface(Input=numbered, RegionArray="Tissue")
    assert region_volumes(good(body, 3.5)) == [2.5, 1]
    assert set(cell_array(fetch(body), "Region")) == {4, 9}
    body.RegionArray = "None"
    assert region_volumes(good(body, 3.5)) == [1, 2, 0.5]


def check_errors():
    half = ExtractSurface(Input=Clip(Input=Sphere(), ClipType="Plane"))
    body = TetrahedralizeSurface(Input=half)
    expect_error(lambda: fetch(body), "open edges", "near (", "RepairSurface")
    assert fetch(body).GetNumberOfCells() == 0
    faults = servermanager.Fetch(body, idx=1)
    assert faults.GetNumberOfLines() > 0
    names = faults.GetFieldData().GetAbstractArray("FaultName")
    assert names.GetValue(int(cell_array(faults, "SurfaceFault")[0])) == "open edges"

    body.RepairSurface = 1
    grid = good(body, math.pi / 12, 0.2)  # a sphere of few facets
    assert "filled holes" in repair_report(grid)

    spoilt = ProgrammableFilter(Input=Sphere(), Script="""
import numpy
points = numpy.array(inputs[0].Points)
points[3] = numpy.nan
output.ShallowCopy(inputs[0].VTKObject)
output.Points = points
""")
    expect_error(lambda: fetch(TetrahedralizeSurface(Input=spoilt)), "not finite")
    good(TetrahedralizeSurface(Input=Box()), 1)


def check_liver():
    folder = os.environ.get("PALPATE_SHARED_DATA", "")
    if not folder:
        return
    body = TetrahedralizeSurface(Input=STLReader(FileNames=[os.path.join(folder, "liver.stl")]))
    expect_error(lambda: fetch(body), "7 pairs of triangles that cross each other", "RepairSurface")
    body.RepairSurface = 1
    good(body, 1.206e-3, 0.02)


check_defaults_and_names()
check_every_property()
check_refine_region()
check_edges_in_a_region()
check_edges_of_an_array()
check_several_bodies()
check_tissues_that_share_walls()
check_errors()
check_liver()

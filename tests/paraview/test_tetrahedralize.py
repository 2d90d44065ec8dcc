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
    assert body.RefineVolume == 0
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
check_several_bodies()
check_tissues_that_share_walls()
check_errors()
check_liver()

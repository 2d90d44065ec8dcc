# SPDX-License-Identifier: BSD-3-Clause
"""A scene to FEBio's file and back, by ParaView's own ways to save and to open."""

import os

import numpy
from paraview.simple import (AssignMaterial, Calculator, FEBioReader, OpenDataFile, SaveData,
                             SetBoundary, SolveEquilibrium)
from support import (EDGES, Messages, box_body, cell_array, expect_error, expect_silence, fetch,
                     field, grid_of, node_at, places, point_array, source)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA

PARAMETERS = ("Law", "YoungsModulus", "PoissonsRatio", "C10", "C01", "BulkModulus")


def oriented(grid):
    """The same body, whose cells are all right-handed, as FEBio needs them."""
    points, cells = places(grid), []
    for cell in range(grid.GetNumberOfCells()):
        ids = grid.GetCell(cell).GetPointIds()
        nodes = [ids.GetId(i) for i in range(ids.GetNumberOfIds())]
        edges = points[nodes[1:4]] - points[nodes[0]]
        if numpy.linalg.det(edges) < 0:
            # Corners 2 and 3 change places, and the midside nodes with them.
            order = [0, 1, 3, 2]
            midsides = {frozenset(edge): node for edge, node in zip(EDGES, nodes[4:])}
            nodes = [nodes[i] for i in order] + [
                midsides[frozenset(order[i] for i in edge)] for edge in EDGES if midsides]
        cells.append(nodes)
    return grid_of(points, cells, VTK_TETRA if len(cells[0]) == 4 else VTK_QUADRATIC_TETRA)


def scene_of(quadratic, name):
    """Two regions of different laws, with values that no short fraction holds; held at x = 0."""
    body = source(oriented(box_body(quadratic=quadratic)), name)
    whole = AssignMaterial(Input=body, Law="Neo-Hookean", PoissonsRatio=1 / 3)
    varied = Calculator(Input=whole, AttributeType="Cell Data", ResultArrayName="YoungsModulus",
                        Function="YoungsModulus / 3")
    part = AssignMaterial(Input=varied, Law="Mooney-Rivlin", RegionType="Shape",
                          RegionShape="Plane")
    part.RegionShape.Origin, part.RegionShape.Normal = [0.1, 0, 0], [1, 0, 0]
    boundary = SetBoundary(Input=part, FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    return boundary


def expect_same(one, other):
    assert (places(one) == places(other)).all()
    for get in ("GetConnectivityArray", "GetOffsetsArray"):
        assert (vtk_to_numpy(getattr(one.GetCells(), get)())
                == vtk_to_numpy(getattr(other.GetCells(), get)())).all(), get
    for name in ("Fixed", "Touchable", "BoundaryKind"):
        assert (point_array(one, name) == point_array(other, name)).all(), name
    for name in PARAMETERS:
        assert one.GetCellData().HasArray(name) == other.GetCellData().HasArray(name), name
        if one.GetCellData().HasArray(name):
            assert (cell_array(one, name) == cell_array(other, name)).all(), name


def solve(scene):
    node = node_at(scene, [0.2, 0.1, 0.1])
    solved = expect_silence(lambda: fetch(SolveEquilibrium(
        Input=scene, ActiveNodes=[node], Displacement=[0.01, 0, -0.02])))
    assert field(solved, "Outcome")[0] == 0
    return point_array(solved, "Displacement"), field(solved, "ReactionForce")


def test_round_trip():
    for quadratic in (False, True):
        scene = scene_of(quadratic, f"body{quadratic}")
        name = os.path.abspath(f"body{quadratic}.feb")
        expect_silence(lambda: SaveData(name, proxy=scene))
        back = expect_silence(lambda: OpenDataFile(name))
        assert back.GetXMLName() == "FEBioReader", back.GetXMLName()
        grid = expect_silence(lambda: fetch(back))
        expect_same(fetch(scene), grid)
        regions = grid.GetFieldData().GetAbstractArray("Regions")
        names = [regions.GetValue(i) for i in range(regions.GetNumberOfValues())]
        assert names == ["Body", "Body_2"], names
        assert set(cell_array(grid, "RegionId")) == {0, 1}
        for one, other in zip(solve(scene), solve(back)):
            assert (one == other).all(), abs(one - other).max()

        # Once more, from what was read: RegionId now is there.
        again = os.path.abspath("again.feb")
        expect_silence(lambda: SaveData(again, proxy=back))
        expect_same(grid, expect_silence(lambda: fetch(OpenDataFile(again))))


def test_what_is_said_once():
    scene = scene_of(True, "faults")
    incompressible = AssignMaterial(Input=scene, Law="Neo-Hookean incompressible")
    expect_error(lambda: SaveData("refused.feb", proxy=incompressible),
                 "Neo-Hookean incompressible cannot be written", "Assign Mooney-Rivlin")
    assert not os.path.exists("refused.feb")
    body = source(box_body(), "bare")
    expect_error(lambda: SaveData("bare.feb", proxy=body), "Apply Assign Material")
    expect_error(lambda: SaveData("nowhere/body.feb", proxy=scene), "No such file")
    # Written once, and so warned of once.
    nearly = AssignMaterial(Input=scene, Law="Neo-Hookean", PoissonsRatio=0.49)
    with Messages() as messages:
        SaveData("nearly.feb", proxy=nearly)
    assert messages.warnings == 1 and messages.errors == 0, messages.text
    expect_same(fetch(nearly), expect_silence(lambda: fetch(OpenDataFile(
        os.path.abspath("nearly.feb")))))


def test_reader():
    folder = os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "data")
    name = os.path.join(folder, "febio_25.feb")
    reader = FEBioReader(FileName=name)
    expect_error(reader.UpdatePipeline, "does not say its units", "Set Units")
    reader.UpdatePropertyInformation()
    assert reader.GetPropertyValue("ErrorCode") != 0
    for units, length, pressure in (
            ("SI", 1, 1), ("mm-N-s", 1e-3, 1e6), ("mm-kg-s", 1e-3, 1e3), ("um-nN-s", 1e-6, 1e3),
            ("CGS", 1e-2, 0.1), ("mm-g-s", 1e-3, 1), ("mm-mg-s", 1e-3, 1e-3)):
        reader.Units = units
        grid = expect_silence(lambda: fetch(reader))
        assert (cell_array(grid, "YoungsModulus") == 5 * pressure).all(), units
        assert (places(grid).max(axis=0) == 2 * length).all(), units
    assert reader.GetPropertyValue("Units") == "mm-mg-s"
    expect_error(FEBioReader().UpdatePipeline, "Set FileName")

    loaded = FEBioReader(FileName=os.path.join(folder, "febio_30.feb"))
    with Messages() as messages:
        loaded.UpdatePipeline()
    assert messages.warnings == 1 and messages.errors == 0, messages.text
    assert "Pressure1" in messages.text and "Pull" in messages.text, messages.text


if __name__ == "__main__":
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test()
            print(name, "passed", flush=True)

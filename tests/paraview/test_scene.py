# SPDX-License-Identifier: BSD-3-Clause
"""AssignMaterial and SetBoundary: from a body to a scene."""

import numpy
from paraview.simple import (AssignMaterial, Calculator, IDSelectionSource, SelectionQuerySource,
                             SetBoundary, SolveEquilibrium)
from support import (Messages, box_body, cell_array, expect_silence, fetch, field, places,
                     point_array, source)
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkIntArray

LINEAR, ST_VENANT_KIRCHHOFF, NEO_HOOKEAN, MOONEY_RIVLIN = range(4)
NO_LAW = -1


def body_with_regions():
    """Cell arrays Part (0 for x < 0.1 m, else 1) and Share (0.1 or 0.2, single precision)."""
    grid = box_body()
    part, share = vtkIntArray(), vtkFloatArray()
    part.SetName("Part")
    share.SetName("Share")
    for cell in range(grid.GetNumberOfCells()):
        bounds = grid.GetCell(cell).GetBounds()
        right = (bounds[0] + bounds[1]) / 2 > 0.1
        part.InsertNextValue(int(right))
        share.InsertNextValue(0.2 if right else 0.1)
    grid.GetCellData().AddArray(part)
    grid.GetCellData().AddArray(share)
    inlet = vtkIntArray()
    inlet.SetName("Inlet")
    for x, _, _ in places(grid):
        inlet.InsertNextValue(int(x < 0.01))
    grid.GetPointData().AddArray(inlet)
    return source(grid, "body")


def test_every_property(body):
    """Each property by its public name, enumerations by their entries."""
    selection = IDSelectionSource(FieldType="POINT", IDs=[0, 0])
    settings = {
        AssignMaterial: {
            "Law": "Mooney-Rivlin", "YoungsModulus": 5000.0, "PoissonsRatio": 0.3, "C10": 900.0,
            "C01": 100.0, "BulkModulus": 2e4, "RegionArray": "Part", "RegionValue": 1.0},
        SetBoundary: {
            "FixedBy": "Array", "TouchableBy": "Region", "FixedRegion": "Cylinder",
            "TouchableRegion": "Box", "FixedArray": "Inlet", "TouchableArray": "Inlet",
            "FixedSelection": selection, "TouchableSelection": selection},
        SolveEquilibrium: {
            "ActiveNode": [3, 4], "Displacement": [0.01, 0, 0, 0, 0.01, 0], "Tolerance": 1e-8,
            "MaximumIterations": 20, "MaximumSeconds": 5.0, "LinearSolver": "Automatic"},
    }
    for proxy, values in settings.items():
        filtered = proxy(Input=body, **values)
        hidden = {"Input", "LinearSolverNames"}
        assert set(filtered.ListProperties()) - hidden == set(values), filtered.ListProperties()
        for name, value in values.items():
            got = filtered.GetPropertyValue(name)
            if name.endswith("Region"):
                assert got.GetXMLName() == value, (name, got.GetXMLName())
            elif name.endswith("Selection"):
                assert got is not None, name
            elif isinstance(value, list):
                assert list(got) == value, (name, got)
            else:
                assert got == value, (name, got)
    for law in ("Linear", "St. Venant-Kirchhoff", "Neo-Hookean", "Mooney-Rivlin"):
        assert AssignMaterial(Input=body, Law=law).Law == law
    for chooser in ("Region", "Array", "Selection", "Surface"):
        assert SetBoundary(Input=body, TouchableBy=chooser).TouchableBy == chooser


def test_material_of_the_whole_body(body):
    grid = expect_silence(lambda: fetch(AssignMaterial(Input=body)))
    assert set(cell_array(grid, "Law")) == {ST_VENANT_KIRCHHOFF}
    assert set(cell_array(grid, "YoungsModulus")) == {10000}
    assert set(cell_array(grid, "PoissonsRatio")) == {0.45}
    for unused in ("C10", "C01", "BulkModulus"):
        assert not grid.GetCellData().HasArray(unused)

    soft = AssignMaterial(Input=body)
    grid = fetch(AssignMaterial(Input=soft, Law="Mooney-Rivlin"))
    assert set(cell_array(grid, "C10")) == {1293.1}
    assert set(cell_array(grid, "C01")) == {431.03}
    assert set(cell_array(grid, "BulkModulus")) == {33333}
    for unused in ("YoungsModulus", "PoissonsRatio"):
        assert not grid.GetCellData().HasArray(unused)


def test_material_by_region(body):
    left = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=2000, RegionArray="Part",
                          RegionValue=0)
    grid = fetch(left)
    part = cell_array(grid, "Part")
    assert (cell_array(grid, "Law") == numpy.where(part == 0, NEO_HOOKEAN, NO_LAW)).all()

    # 0.2 in single precision is not 0.2.
    both = AssignMaterial(Input=left, Law="Mooney-Rivlin", C10=700, RegionArray="Share",
                          RegionValue=0.2)
    grid = expect_silence(lambda: fetch(both))
    assert (cell_array(grid, "Law") == numpy.where(part == 0, NEO_HOOKEAN, MOONEY_RIVLIN)).all()
    assert (cell_array(grid, "YoungsModulus") == numpy.where(part == 0, 2000, 0)).all()
    assert (cell_array(grid, "PoissonsRatio") == numpy.where(part == 0, 0.45, 0)).all()
    assert (cell_array(grid, "C10") == numpy.where(part == 0, 0, 700)).all()
    assert not fetch(left).GetCellData().HasArray("C10"), "the input of a filter has changed"


def fixed_points(body, **settings):
    """Ids of the fixed points; the touchable ones are checked on the way."""
    grid = expect_silence(lambda: fetch(SetBoundary(Input=body, **settings)))
    fixed, touchable = point_array(grid, "Fixed"), point_array(grid, "Touchable")
    assert set(fixed) == {0, 1} and set(touchable) <= {0, 1}
    assert not (fixed & touchable).any()
    return set(numpy.flatnonzero(fixed)), grid


def with_region(body, kind, **parameters):
    boundary = SetBoundary(Input=body, FixedBy="Region", FixedRegion=kind)
    for name, value in parameters.items():
        setattr(boundary.FixedRegion, name, value)
    grid = expect_silence(lambda: fetch(boundary))
    return set(numpy.flatnonzero(point_array(grid, "Fixed")))


def test_regions(body):
    grid = fetch(body)
    x, y, z = places(grid).T
    left_face = set(numpy.flatnonzero(x == 0))
    assert len(left_face) == 25

    assert with_region(body, "Box", Position=[-0.01, -1, -1], Length=[0.02, 2, 2]) == left_face
    # Turned by 45 degrees about z, with one face through the edge x = y = 0.
    turned = with_region(body, "Box", Position=[0, 0, -1], Length=[1, 1, 2], Rotation=[0, 0, 45])
    assert turned == set(numpy.flatnonzero(y >= x - 1e-12))
    assert with_region(body, "Plane", Origin=[0, 0, 0], Normal=[1, 0, 0]) == left_face
    assert with_region(body, "Plane", Origin=[0.2, 0, 0], Normal=[-1, 0, 0]) == set(
        numpy.flatnonzero(x == 0.2))
    assert with_region(body, "Sphere", Center=[0, 0, 0], Radius=0.06) == set(
        numpy.flatnonzero(x**2 + y**2 + z**2 <= 0.06**2))
    assert with_region(body, "Cylinder", Center=[0, 0, 0], Axis=[0, 1, 0], Radius=0.03) == set(
        numpy.flatnonzero(x**2 + z**2 <= 0.03**2))


def test_array(body):
    grid = fetch(body)
    inlet = set(numpy.flatnonzero(point_array(grid, "Inlet")))
    fixed, _ = fixed_points(body, FixedBy="Array", FixedArray="Inlet")
    assert fixed == inlet


def test_selections(body):
    grid = fetch(body)
    by_id = IDSelectionSource(FieldType="POINT", IDs=[0, 3, 0, 7])
    fixed, _ = fixed_points(body, FixedBy="Selection", FixedSelection=by_id)
    assert fixed == {3, 7}

    cells = IDSelectionSource(FieldType="CELL", IDs=[0, 5])
    fixed, _ = fixed_points(body, FixedBy="Selection", FixedSelection=cells)
    nodes = grid.GetCell(5).GetPointIds()
    assert fixed == {nodes.GetId(i) for i in range(nodes.GetNumberOfIds())}

    query = SelectionQuerySource(ElementType="Point Data", QueryString="Inlet == 1")
    fixed, _ = fixed_points(body, FixedBy="Selection", FixedSelection=query)
    assert fixed == set(numpy.flatnonzero(point_array(grid, "Inlet")))


def test_touchable_points(body):
    grid = fetch(body)
    lattice = numpy.rint(places(grid) / 0.025).astype(int)
    corner = (lattice % 2 == 0).all(axis=1)
    surface = ((lattice == 0) | (lattice == [8, 4, 4])).any(axis=1)
    free = lattice[:, 0] > 0
    _, scene = fixed_points(body, FixedBy="Array", FixedArray="Inlet")
    assert (point_array(scene, "Touchable") == (corner & surface & free)).all()

    right = SelectionQuerySource(ElementType="Point Data", QueryString="mag(inputs[0].Points - [0.2, 0, 0]) < 0.06")
    _, scene = fixed_points(body, FixedBy="Array", FixedArray="Inlet", TouchableBy="Selection",
                            TouchableSelection=right)
    near = numpy.linalg.norm(places(grid) - [0.2, 0, 0], axis=1) < 0.06
    assert (point_array(scene, "Touchable") == (corner & surface & near)).all()

    boundary = SetBoundary(Input=body, FixedBy="Array", FixedArray="Inlet", TouchableBy="Region",
                           TouchableRegion="Sphere")
    boundary.TouchableRegion.Center = [0.2, 0, 0]
    boundary.TouchableRegion.Radius = 0.06
    assert (point_array(fetch(boundary), "Touchable") == (corner & surface & near)).all()

    # A change of the region alone reaches the filter.
    boundary.TouchableRegion.Center = [5, 5, 5]
    with Messages() as messages:
        touchable = point_array(fetch(boundary), "Touchable")
    assert not touchable.any() and messages.warnings == 1 and messages.errors == 0


def test_road(body):
    """Two regions, a stiffness from a Calculator, a boundary, an equilibrium."""
    material = AssignMaterial(Input=body, Law="Neo-Hookean", RegionArray="Part", RegionValue=0)
    material = AssignMaterial(Input=material, Law="Mooney-Rivlin", RegionArray="Part",
                              RegionValue=1)

    def reaction(scene):
        boundary = SetBoundary(Input=scene, FixedBy="Array", FixedArray="Inlet")
        grid = fetch(boundary)
        node = int(numpy.argmin(numpy.linalg.norm(places(grid) - [0.2, 0.1, 0.1], axis=1)))
        solved = expect_silence(lambda: fetch(SolveEquilibrium(
            Input=boundary, ActiveNode=[node], Displacement=[0.005, 0, 0])))
        assert field(solved, "Outcome")[0] == 0
        assert numpy.allclose(point_array(solved, "Displacement")[node], [0.005, 0, 0], atol=0)
        return field(solved, "ReactionForce")[0][0]

    plain = reaction(material)
    stiffer = reaction(Calculator(Input=material, AttributeType="Cell Data",
                                  ResultArrayName="YoungsModulus",
                                  Function="YoungsModulus * 3"))
    assert 0 < plain < stiffer, (plain, stiffer)


if __name__ == "__main__":
    body = body_with_regions()
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test(body)
            print(name, "passed", flush=True)

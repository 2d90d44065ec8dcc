# SPDX-License-Identifier: BSD-3-Clause
"""AssignMaterial and SetBoundary: from a body to a scene."""

import os
import sqlite3

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, Box, Calculator, GetSources, IDSelectionSource,
                             LoadState, OpenDataFile, PrecomputeStateSpace, ReverseSense,
                             SaveData, SaveState, SelectionQuerySource, SetBoundary,
                             SolveEquilibrium, Sphere, StateSpaceReader,
                             XMLUnstructuredGridReader)
from support import (Messages, box_body, cell_array, expect_error, expect_silence, fetch, field,
                     places, point_array, produce, source)
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkIntArray

LAWS = ("Linear", "St. Venant-Kirchhoff", "Neo-Hookean", "Mooney-Rivlin",
        "Mooney-Rivlin polynomial", "Fung", "Neo-Hookean incompressible",
        "Mooney-Rivlin incompressible", "Ogden")
NO_LAW = -1
# Of BoundaryKind.
FREE, TOUCHABLE, FIXED, HELD, LOADED = range(5)
DISPLACEMENT, MIXED, FINE = range(3)
# The settings of a material and the cell arrays that come of them.
MATERIALS = {
    "Linear": ({"YoungsModulus": 2000, "PoissonsRatio": 0.3},
               {"YoungsModulus": 2000, "PoissonsRatio": 0.3}),
    "St. Venant-Kirchhoff": ({"YoungsModulus": 3000, "PoissonsRatio": 0.2},
                             {"YoungsModulus": 3000, "PoissonsRatio": 0.2}),
    "Neo-Hookean": ({"YoungsModulus": 4000, "PoissonsRatio": 0.49},
                    {"YoungsModulus": 4000, "PoissonsRatio": 0.49}),
    "Mooney-Rivlin": ({"C10": 700, "C01": 70, "BulkModulus": 9000},
                      {"C10": 700, "C01": 70, "BulkModulus": 9000}),
    "Mooney-Rivlin polynomial": (
        {"Coefficients": [0, 1, -20, 1, 0, 500, 2, 1, 30, 0, 3, 40], "BulkModulus": 8000},
        {"C10": 500, "C01": -20, "C20": 0, "C11": 0, "C02": 0, "C30": 0, "C21": 30, "C12": 0,
         "C03": 40, "BulkModulus": 8000}),
    "Fung": ({"YoungsModulus": 5000, "PoissonsRatio": 0.4, "Exponent": 2.5},
             {"YoungsModulus": 5000, "PoissonsRatio": 0.4, "Exponent": 2.5}),
    "Neo-Hookean incompressible": ({"YoungsModulus": 6000}, {"YoungsModulus": 6000}),
    "Mooney-Rivlin incompressible": ({"C10": 800, "C01": 80}, {"C10": 800, "C01": 80}),
    "Ogden": ({"OgdenModuli": [300, 200, 0], "OgdenExponents": [2.5, -7, 0], "BulkModulus": 4000},
              {"OgdenModulus1": 300, "OgdenExponent1": 2.5, "OgdenModulus2": 200,
               "OgdenExponent2": -7, "OgdenModulus3": 0, "OgdenExponent3": 0,
               "BulkModulus": 4000}),
}
PARAMETERS = sorted({name for _, arrays in MATERIALS.values() for name in arrays})


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
    sphere = Sphere()
    settings = {
        AssignMaterial: {
            "Law": "Mooney-Rivlin", "YoungsModulus": 5000.0, "PoissonsRatio": 0.3, "C10": 900.0,
            "C01": 100.0, "BulkModulus": 2e4, "Exponent": 3.0,
            "Coefficients": [1.0, 0.0, 500.0, 2.0, 1.0, 30.0], "Formulation": "Mixed",
            "Quadrature": "Fine",
            "OgdenModuli": [100.0, 50.0, 5.0], "OgdenExponents": [2.0, -2.0, 9.0],
            "Density": 1060.0, "ViscousTime": 0.01, "PronyModuli": [0.5, 0.3],
            "PronyTimes": [0.1, 1.0],
            "RegionType": "Table", "RegionArray": "Part", "RegionValue": 1.0,
            "Regions": ["0", "Neo-Hookean", "YoungsModulus 2000 PoissonsRatio 0.3"],
            "RegionShape": "Cylinder", "RegionSurface": sphere},
        SetBoundary: {
            "FixedBy": "Array", "TouchableBy": "Region", "FixedRegion": "Cylinder",
            "TouchableRegion": "Box", "FixedArray": "Inlet", "TouchableArray": "Inlet",
            "FixedSelection": selection, "TouchableSelection": selection, "Merge": 1,
            "Support": "Springs", "HeldDirection": [1.0, 0.0, 2.0], "SupportStiffness": 2e4,
            "Load": "Traction", "AppliedPressure": 5.0, "AppliedTraction": [1.0, 2.0, 3.0],
            "LoadBy": "Cavities", "LoadRegion": "Sphere", "LoadArray": "Inlet",
            "LoadSelection": selection, "Contact": "Also With Themselves", "PartsBy": "Array",
            "PartArray": "Part", "ContactThickness": 0.002, "ContactStiffness": 1e4},
        SolveEquilibrium: {
            "ActiveNodes": [3, 4], "Displacement": [0.01, 0, 0, 0, 0.01, 0], "TipRadius": 0.01,
            "Tolerance": 1e-8, "MaximumIterations": 20, "MaximumSeconds": 5.0, "Threads": 2,
            "Increments": 2, "EstimateCondition": 1, "EstimateMeshError": 1,
            "GroupUnknowns": 100, "LinearSolver": "Automatic", "Stress": 1, "Tool": "Capsule",
            "ToolRadius": 0.02, "ToolAxis": [0.0, 1.0, 0.0], "ToolLength": 0.05,
            "ToolPosition": [0.1, 0.2, 0.3], "ToolOrientation": [0.8, 0.6, 0.0, 0.0],
            "ToolSurface": sphere, "ContactThickness": 0.003,
            "ContactStiffness": 5e3, "BodyForce": [0.0, 1.0, -9.0], "FractureToughness": 100.0,
            "StartFromDisplacement": 1},
    }
    for proxy, values in settings.items():
        filtered = proxy(Input=body, **values)
        hidden = {"Input", "LinearSolverNames", "ActiveNode", "ErrorCode", "Estimate",
                  "UpdateEstimate"}
        assert set(filtered.ListProperties()) - hidden == set(values), filtered.ListProperties()
        for name, value in values.items():
            got = filtered.GetPropertyValue(name)
            if name.endswith(("Region", "Shape")) or name == "Tool":
                assert got.GetXMLName() == value, (name, got.GetXMLName())
            elif name.endswith(("Selection", "Surface")):
                assert got is not None, name
            elif isinstance(value, list):
                assert list(got) == value, (name, got)
            else:
                assert got == value, (name, got)
    for law in LAWS:
        assert AssignMaterial(Input=body, Law=law).Law == law
    # By the name that it had in earlier versions.
    renamed = SolveEquilibrium(Input=body, ActiveNode=[5, 6])
    assert list(renamed.ActiveNodes) == [5, 6]
    renamed.ActiveNodes = [7]
    SaveState("renamed.pvsm")
    LoadState("renamed.pvsm")
    assert [list(proxy.ActiveNodes) for proxy in GetSources().values()
            if proxy.GetXMLName() == "SolveEquilibrium"].count([7]) == 2
    for formulation in ("Automatic", "Displacement", "Mixed"):
        assert AssignMaterial(Input=body, Formulation=formulation).Formulation == formulation
    assert AssignMaterial(Input=body).Formulation == "Automatic"
    for chooser in ("Region", "Array", "Selection", "Surface"):
        assert SetBoundary(Input=body, TouchableBy=chooser).TouchableBy == chooser
    for support in ("Fixed", "Direction", "Normal", "Springs", "Nothing"):
        assert SetBoundary(Input=body, Support=support).Support == support


def test_linear_mixed_cells_are_told(body):
    linear = source(box_body(quadratic=False), "linear_cells")
    mixed = ({"Law": "Neo-Hookean", "PoissonsRatio": 0.49},
             {"Law": "Mooney-Rivlin incompressible"},
             {"Law": "Neo-Hookean", "PoissonsRatio": 0.3, "Formulation": "Mixed"})
    for material in mixed:
        with Messages() as messages:
            fetch(AssignMaterial(Input=linear, **material))
        assert messages.warnings == 1 and messages.errors == 0, (material, messages.text)
        for words in ("too stiff in bending", "ElementOrder Quadratic"):
            assert words in messages.text, messages.text
        expect_silence(lambda: fetch(AssignMaterial(Input=body, **material)))
    for material in ({"Law": "Neo-Hookean", "PoissonsRatio": 0.45},
                     {"Law": "Neo-Hookean", "PoissonsRatio": 0.49, "Formulation": "Displacement"}):
        expect_silence(lambda: fetch(AssignMaterial(Input=linear, **material)))


def test_material_of_the_whole_body(body):
    grid = expect_silence(lambda: fetch(AssignMaterial(Input=body)))
    assert set(cell_array(grid, "Law")) == {LAWS.index("St. Venant-Kirchhoff")}
    assert set(cell_array(grid, "YoungsModulus")) == {10000}
    assert set(cell_array(grid, "PoissonsRatio")) == {0.45}
    for unused in ("C10", "C01", "BulkModulus", "Formulation"):
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
    neo_hookean, mooney_rivlin = map(LAWS.index, ("Neo-Hookean", "Mooney-Rivlin"))
    assert (cell_array(grid, "Law") == numpy.where(part == 0, neo_hookean, NO_LAW)).all()

    # 0.2 in single precision is not 0.2.
    both = AssignMaterial(Input=left, Law="Mooney-Rivlin", C10=700, RegionArray="Share",
                          RegionValue=0.2)
    grid = expect_silence(lambda: fetch(both))
    assert (cell_array(grid, "Law") == numpy.where(part == 0, neo_hookean, mooney_rivlin)).all()
    assert (cell_array(grid, "YoungsModulus") == numpy.where(part == 0, 2000, 0)).all()
    assert (cell_array(grid, "PoissonsRatio") == numpy.where(part == 0, 0.45, 0)).all()
    assert (cell_array(grid, "C10") == numpy.where(part == 0, 0, 700)).all()
    assert not fetch(left).GetCellData().HasArray("C10"), "the input of a filter has changed"


def test_materials_by_table(body):
    table = AssignMaterial(
        Input=AssignMaterial(Input=body, Law="Linear"), RegionType="Table", RegionArray="Part",
        Regions=["1", "Ogden", "BulkModulus 9000 OgdenModulus1 700 OgdenExponent1 -4",
                 "0", "Fung", "Exponent 3 PoissonsRatio 0.4 YoungsModulus 2000"])
    grid = expect_silence(lambda: fetch(table))
    left = cell_array(grid, "Part") == 0
    expect_material(grid, left, "Fung",
                    {"YoungsModulus": 2000, "PoissonsRatio": 0.4, "Exponent": 3})
    expect_material(grid, ~left, "Ogden",
                    {"BulkModulus": 9000, "OgdenModulus1": 700, "OgdenExponent1": -4,
                     "OgdenModulus2": 0, "OgdenExponent2": 0, "OgdenModulus3": 0,
                     "OgdenExponent3": 0})

    # A value without a row keeps what it has. By the state as by the script.
    table.Regions = ["1", "Mooney-Rivlin polynomial", "BulkModulus 8000 C10 500 C03 40"]
    SaveState("table.pvsm")
    LoadState("table.pvsm")
    loaded = [proxy for proxy in GetSources().values() if proxy.GetXMLName() == "AssignMaterial"
              and proxy.RegionType == "Table" and proxy is not table][-1]
    for one in (table, loaded):
        grid = expect_silence(lambda: fetch(one))
        expect_material(grid, left, "Linear", {"YoungsModulus": 10000, "PoissonsRatio": 0.45})
        expect_material(grid, ~left, "Mooney-Rivlin polynomial", {
            "BulkModulus": 8000, "C10": 500, "C03": 40, "C01": 0, "C20": 0, "C11": 0, "C02": 0,
            "C30": 0, "C21": 0, "C12": 0})


RHEOLOGY = ["Density", "ViscousTime"] + [f"Prony{what}{term}" for term in range(1, 5)
                                         for what in ("Modulus", "Time")]


def rheology(grid):
    """Of each cell, by the names of the arrays that are there."""
    return {name: cell_array(grid, name) for name in RHEOLOGY
            if grid.GetCellData().HasArray(name)}


def test_density_and_viscosity(body):
    """Arrays are there where they are given; a filter that gives none leaves them."""
    assert rheology(fetch(AssignMaterial(Input=body))) == {}
    whole = AssignMaterial(Input=body, Density=1000, ViscousTime=0.01, PronyModuli=[0.5, 0.3],
                           PronyTimes=[0.1, 1])
    values = {"Density": 1000, "ViscousTime": 0.01, "PronyModulus1": 0.5, "PronyTime1": 0.1,
              "PronyModulus2": 0.3, "PronyTime2": 1}
    grid = expect_silence(lambda: fetch(whole))
    got = rheology(grid)
    assert list(got) == list(values)
    assert all((got[name] == values[name]).all() for name in values)

    # A region of another density, and that alone.
    heavy = AssignMaterial(Input=whole, Law="Linear", Density=2000, RegionArray="Part",
                           RegionValue=1)
    right = cell_array(grid, "Part") == 1
    got = rheology(fetch(heavy))
    assert list(got) == list(values)
    for name, value in values.items():
        other = 2000 if name == "Density" else 0
        assert (got[name] == numpy.where(right, other, value)).all(), name
    kept = rheology(fetch(AssignMaterial(Input=whole, Law="Linear", RegionArray="Part",
                                         RegionValue=1)))
    assert all((kept[name] == values[name]).all() for name in values)

    # Rows of a table: their own, or that of the properties.
    table = AssignMaterial(
        Input=body, RegionType="Table", RegionArray="Part", Density=900,
        Regions=["0", "Liver", "PronyModulus1 0.7 PronyTime1 0.2 Density 1060", "1", "Kidney", ""])
    got = rheology(expect_silence(lambda: fetch(table)))
    assert list(got) == ["Density", "PronyModulus1", "PronyTime1"]
    for name, left, of_right in (("Density", 1060, 900), ("PronyModulus1", 0.7, 0),
                                 ("PronyTime1", 0.2, 0)):
        assert (got[name] == numpy.where(right, of_right, left)).all(), name


def test_density_changes_no_state_space(body):
    """Its configurations do not depend on density and viscosity: the hash of the scene is one."""
    hashes = set()
    for name, settings in (("without", {}), ("with", {"Density": 1000, "PronyModuli": [1],
                                                      "PronyTimes": [0.1]})):
        held = SetBoundary(Input=AssignMaterial(Input=body, **settings), FixedBy="Array",
                           FixedArray="Inlet")
        corner = int(numpy.argmax(places(fetch(held)).sum(axis=1)))
        space = PrecomputeStateSpace(Input=held, ActiveNodes=[corner], HalfWidth=0.002,
                                     Resolution=3, FileName=f"{name}.palpate")
        expect_silence(space.UpdatePipeline)
        with sqlite3.connect(f"file:{name}.palpate?mode=ro", uri=True) as database:
            hashes.update(database.execute("SELECT hash FROM scene").fetchall())
    assert len(hashes) == 1, hashes


def test_tissues(body):
    """By the panel's list as by a table; both have all of them."""
    domain = AssignMaterial(Input=body).GetProperty("Law").GetDomain("enum")
    names = [domain.GetEntryText(i) for i in range(domain.GetNumberOfEntries())
             if domain.GetEntryValue(i) >= 100]
    assert len(names) == 11, names
    for name in names:
        one = fetch(AssignMaterial(Input=body, Law=name))
        rows = fetch(AssignMaterial(Input=body, RegionType="Table", RegionArray="Part",
                                    Regions=["0", name, "", "1", name, ""]))
        for i in range(one.GetCellData().GetNumberOfArrays()):
            array = one.GetCellData().GetArrayName(i)
            assert (cell_array(one, array) == cell_array(rows, array)).all(), (name, array)
    whole = numpy.ones(one.GetNumberOfCells(), bool)
    expect_material(fetch(AssignMaterial(Input=body, Law="Liver")), whole,
                    "Neo-Hookean incompressible", {"YoungsModulus": 6900})
    white = fetch(AssignMaterial(Input=body, Law="Brain white matter"))
    assert set(cell_array(white, "OgdenModulus1")) == {631}
    assert set(cell_array(white, "OgdenExponent1")) == {-24}


def test_region_by_shape_and_surface(body):
    soft = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=2000)
    centre, radius = numpy.array([0.1, 0.05, 0.05]), 0.045
    shape = AssignMaterial(Input=soft, Law="Neo-Hookean", YoungsModulus=8000, RegionType="Shape",
                           RegionShape="Sphere")
    shape.RegionShape.Center, shape.RegionShape.Radius = list(centre), radius
    grid = expect_silence(lambda: fetch(shape))
    middles = numpy.array([numpy.mean([grid.GetPoint(grid.GetCell(cell).GetPointId(corner))
                                       for corner in range(4)], axis=0)
                           for cell in range(grid.GetNumberOfCells())])
    within = numpy.linalg.norm(middles - centre, axis=1) <= radius
    assert 0 < within.sum() < len(within), within.sum()
    assert (cell_array(grid, "YoungsModulus") == numpy.where(within, 8000, 2000)).all()
    shape.RegionShape.Radius = 1
    assert set(cell_array(fetch(shape), "YoungsModulus")) == {8000}

    # A box of triangles: exact, and its normals may point either way.
    corner = Box(XLength=0.1, YLength=0.2, ZLength=0.2, Center=[0.05, 0.05, 0.05])
    for surface in (corner, ReverseSense(Input=corner)):
        by_surface = AssignMaterial(Input=soft, Law="Neo-Hookean", YoungsModulus=8000,
                                    RegionType="Surface", RegionSurface=surface)
        grid = expect_silence(lambda: fetch(by_surface))
        assert (cell_array(grid, "YoungsModulus")
                == numpy.where(middles[:, 0] < 0.1, 8000, 2000)).all()


def expect_material(grid, cells, law, arrays):
    """The cells have the law and, of all arrays of parameters that are there, these values."""
    assert set(cell_array(grid, "Law")[cells]) == {LAWS.index(law)}, law
    for name in PARAMETERS:
        if grid.GetCellData().HasArray(name):
            assert set(cell_array(grid, name)[cells]) == {arrays.get(name, 0)}, (law, name)
        else:
            assert name not in arrays, (law, name)


def test_every_law(body):
    whole = numpy.ones(fetch(body).GetNumberOfCells(), bool)
    for law, (settings, arrays) in MATERIALS.items():
        grid = expect_silence(lambda: fetch(AssignMaterial(Input=body, Law=law, **settings)))
        expect_material(grid, whole, law, arrays)
        present = {name for name in PARAMETERS if grid.GetCellData().HasArray(name)}
        assert present == set(arrays), (law, present)
        assert not grid.GetCellData().HasArray("Formulation"), law


def test_different_laws_in_one_body(body):
    left = cell_array(fetch(body), "Part") == 0
    for first, (first_settings, first_arrays) in MATERIALS.items():
        one = AssignMaterial(Input=body, Law=first, RegionArray="Part", RegionValue=0,
                             **first_settings)
        for second, (second_settings, second_arrays) in MATERIALS.items():
            both = AssignMaterial(Input=one, Law=second, RegionArray="Part", RegionValue=1,
                                  **second_settings)
            grid = expect_silence(lambda: fetch(both))
            expect_material(grid, left, first, first_arrays)
            expect_material(grid, ~left, second, second_arrays)
            present = {name for name in PARAMETERS if grid.GetCellData().HasArray(name)}
            assert present == set(first_arrays) | set(second_arrays), (first, second, present)
            assert not grid.GetCellData().HasArray("Formulation")


def test_formulation(body):
    """An array where, and only where, it is not the automatic one."""
    def formulation(**settings):
        grid = expect_silence(lambda: fetch(AssignMaterial(Input=body, **settings)))
        has = grid.GetCellData().HasArray("Formulation")
        return set(cell_array(grid, "Formulation")) if has else None

    for law, (settings, _) in MATERIALS.items():
        nearly = law == "Neo-Hookean" or law.endswith("incompressible")
        assert formulation(Law=law, Formulation="Automatic", **settings) is None
        assert formulation(Law=law, Formulation="Mixed", **settings) == (
            None if nearly else {MIXED})
        if not law.endswith("incompressible"):
            assert formulation(Law=law, Formulation="Displacement", **settings) == (
                {DISPLACEMENT} if nearly else None)

    # Region by region: the array comes with the first cell that needs it and goes with the last.
    left = cell_array(fetch(body), "Part") == 0
    nearly = AssignMaterial(Input=body, Law="Neo-Hookean incompressible", RegionArray="Part",
                            RegionValue=0)
    assert not fetch(nearly).GetCellData().HasArray("Formulation")
    mixed = AssignMaterial(Input=nearly, Law="Fung", Formulation="Mixed", RegionArray="Part",
                           RegionValue=1)
    assert set(cell_array(fetch(mixed), "Formulation")) == {MIXED}
    locking = AssignMaterial(Input=mixed, PoissonsRatio=0.49, Formulation="Displacement",
                             RegionArray="Part", RegionValue=0)
    expected = numpy.where(left, DISPLACEMENT, MIXED)
    assert (cell_array(fetch(locking), "Formulation") == expected).all()
    last = AssignMaterial(Input=locking, PoissonsRatio=0.49, RegionArray="Part", RegionValue=0)
    assert set(cell_array(fetch(last), "Formulation")) == {MIXED}
    none = AssignMaterial(Input=last, RegionArray="Part", RegionValue=1)
    assert not expect_silence(lambda: fetch(none)).GetCellData().HasArray("Formulation")

    # A finer rule of quadrature is of mixed cells alone.
    assert formulation(Law="Neo-Hookean incompressible", Quadrature="Fine") == {FINE}
    assert formulation(Law="Fung", Formulation="Mixed", Quadrature="Fine") == {FINE}
    assert formulation(Law="Fung", Quadrature="Fine") is None
    standard = AssignMaterial(Input=AssignMaterial(Input=body, Law="Neo-Hookean incompressible",
                                                   Quadrature="Fine"),
                              Law="Neo-Hookean incompressible")
    assert not fetch(standard).GetCellData().HasArray("Formulation")

    # A region without a material has no formulation of its own.
    alone = fetch(AssignMaterial(Input=body, Formulation="Mixed", RegionArray="Part",
                                 RegionValue=1))
    assert (cell_array(alone, "Formulation") == numpy.where(left, 0, MIXED)).all()


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

    right = SelectionQuerySource(ElementType="Point Data",
                                 QueryString="mag(inputs[0].Points - [0.2, 0, 0]) < 0.06")
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


def on_plane(body, origin, normal, **settings):
    """What is on the side of a plane that its normal points away from, held or loaded."""
    boundary = SetBoundary(Input=body, **settings)
    for region in (boundary.FixedRegion, boundary.LoadRegion):
        region.Origin, region.Normal = origin, normal
    return boundary


def quarter(body, support="Direction"):
    """Held along x, y and z in the planes where these are 0."""
    for axis in numpy.eye(3):
        body = on_plane(body, [0, 0, 0], axis, Support=support, HeldDirection=list(2 * axis),
                        FixedRegion="Plane", LoadRegion="Plane")
    return body


def at_rest(scene):
    """The displacement of the body under its loads."""
    grid = fetch(scene)
    node = int(numpy.argmin(numpy.linalg.norm(places(grid) - [0.2, 0.1, 0.1], axis=1)))
    solved = expect_silence(lambda: fetch(SolveEquilibrium(
        Input=scene, ActiveNodes=[node], Displacement=[0, 0, 0])))
    assert field(solved, "Outcome")[0] == 0
    return point_array(solved, "Displacement")


def test_planes_of_symmetry(body):
    """One, two and three planes hold a point; what was held before stays."""
    grid = fetch(body)
    on = places(grid) == 0
    for support in ("Direction", "Normal"):
        held = expect_silence(lambda: fetch(quarter(body, support)))
        assert (point_array(held, "Fixed") == (on.sum(axis=1) == 3)).all()
        spanned = numpy.zeros((len(on), 3))
        for name in ("HeldDirection", "HeldDirection2"):
            spanned += numpy.abs(point_array(held, name))
        expected = numpy.where((on.sum(axis=1) < 3)[:, None], on, 0)
        assert numpy.allclose(spanned, expected, atol=1e-15)
        assert not point_array(held, "Touchable")[on.any(axis=1)].any()
        assert point_array(held, "Touchable").any()


def test_a_pulled_bar_and_a_pressed_body(body):
    """A patch of uniform stress is exact: the linear law at a pull, and at a pressure."""
    young, poisson = 2000, 0.3
    linear = AssignMaterial(Input=body, Law="Linear", YoungsModulus=young, PoissonsRatio=poisson)
    place = places(fetch(body))
    pulled = on_plane(quarter(linear), [0.2, 0, 0], [-1, 0, 0], Support="Nothing",
                      Load="Traction", AppliedTraction=[30, 0, 0], FixedRegion="Plane",
                      LoadRegion="Plane")
    assert abs(field(fetch(pulled), "LoadedArea")[0] - 0.01) < 1e-15
    assert numpy.allclose(at_rest(pulled), 30 / young * place * [1, -poisson, -poisson],
                          atol=1e-11)
    # What the pressure pushes on turns and shrinks by a share of p/E.
    pressure = 1e-3
    pressed = SetBoundary(Input=quarter(linear), Support="Nothing", Load="Pressure",
                          AppliedPressure=pressure, LoadBy="Surface")
    expected = -pressure * (1 - 2 * poisson) / young * place
    assert numpy.abs(at_rest(pressed) - expected).max() < 1e-5 * numpy.abs(expected).max()
    # By an array of a Calculator as well.
    by_hand = Calculator(Input=quarter(linear), ResultArrayName="AppliedPressure",
                         Function=str(pressure))
    assert (at_rest(by_hand) == at_rest(pressed)).all()


def test_springs_alone_hold_a_body(body):
    """A stiff one is pulled up by its traction over the stiffness of the bed."""
    stiff = AssignMaterial(Input=body, Law="Neo-Hookean", YoungsModulus=1e8)
    bed = on_plane(stiff, [0, 0, 0], [0, 0, 1], Support="Springs", SupportStiffness=1e5,
                   FixedRegion="Plane", LoadRegion="Plane")
    loaded = on_plane(bed, [0, 0, 0.1], [0, 0, -1], Support="Nothing", Load="Traction",
                      AppliedTraction=[0, 0, 50], FixedRegion="Plane", LoadRegion="Plane")
    moved = at_rest(loaded)
    assert numpy.abs(moved - [0, 0, 5e-4]).max() < 1e-3 * 5e-4


def kinds_of(scene):
    """BoundaryKind, as Set Boundary gives it to what is there."""
    return point_array(expect_silence(lambda: fetch(scene)), "BoundaryKind")


def test_every_kind_of_boundary(body):
    """Free, touchable, fixed, held and loaded points, in data, in files and in a state space."""
    regions = {"FixedRegion": "Plane", "LoadRegion": "Plane"}
    material = AssignMaterial(Input=body, Law="Neo-Hookean")
    fixed = on_plane(material, [0, 0, 0], [1, 0, 0], **regions)
    held = on_plane(fixed, [0, 0, 0], [0, 1, 0], Support="Direction", HeldDirection=[0, 1, 0],
                    **regions)
    loaded = on_plane(held, [0, 0, 0.1], [0, 0, -1], Support="Nothing", Load="Traction",
                      AppliedTraction=[0, 0, 1], **regions)
    at = places(fetch(body))
    x, y, z = at.T
    cells = fetch(body)
    corners = numpy.zeros(len(at), bool)
    for cell in range(cells.GetNumberOfCells()):
        ids = cells.GetCell(cell).GetPointIds()
        corners[[ids.GetId(i) for i in range(4)]] = True
    outside = (numpy.isclose(at, 0) | numpy.isclose(at, [0.2, 0.1, 0.1])).any(axis=1)
    expected = numpy.where(corners & outside, TOUCHABLE, FREE)
    expected[numpy.isclose(z, 0.1)] = LOADED
    expected[y == 0] = HELD
    expected[x == 0] = FIXED
    assert set(expected) == {FREE, TOUCHABLE, FIXED, HELD, LOADED}
    assert (kinds_of(loaded) == expected).all()
    # Springs hold too, by their faces.
    springs = on_plane(loaded, [0, 0, 0], [0, 0, 1], Support="Springs", SupportStiffness=1e5,
                       **regions)
    on_springs = expected.copy()
    on_springs[(z == 0) & (x > 0)] = HELD
    assert (on_springs != expected).any()
    assert (kinds_of(springs) == on_springs).all()

    SaveData("kinds.vtu", proxy=springs, DataMode="Binary")
    back = XMLUnstructuredGridReader(FileName="kinds.vtu")
    assert (kinds_of(back) == on_springs).all()
    assert (kinds_of(SetBoundary(Input=back, Support="Nothing")) == on_springs).all()
    with Messages() as messages:
        SaveData("kinds.feb", proxy=loaded)
    assert messages.errors == 0, messages.text
    assert (kinds_of(OpenDataFile(os.path.abspath("kinds.feb"))) == expected).all()
    node = int(numpy.argmin(numpy.linalg.norm(at - [0.2, 0.1, 0.1], axis=1)))
    space = PrecomputeStateSpace(Input=springs, ActiveNodes=[node], HalfWidth=0.001, Resolution=3,
                                 FileName="kinds.palpate")
    expect_silence(lambda: servermanager.Fetch(space, 0))
    read = servermanager.Fetch(StateSpaceReader(FileName="kinds.palpate"), 0)
    of_space = produce(read.GetPartition(0, 0))
    assert (kinds_of(SetBoundary(Input=of_space, Support="Nothing")) == on_springs).all()


def test_bad_supports_and_loads(body):
    """Each is one error, of the filter that can be mended."""
    material = AssignMaterial(Input=body, Law="Neo-Hookean")
    regions = {"FixedRegion": "Plane", "LoadRegion": "Plane"}

    def fails(scene, *words):
        expect_error(lambda: fetch(scene), *words)

    far = [9, 0, 0]
    fails(on_plane(material, [-9, 0, 0], [1, 0, 0], Support="Springs", **regions), "FixedRegion")
    fails(on_plane(material, far, [1, 0, 0], Support="Direction", HeldDirection=[0, 0, 0],
                   **regions), "HeldDirection")
    fails(on_plane(material, far, [1, 0, 0], Support="Springs", SupportStiffness=0, **regions),
          "SupportStiffness")
    fails(SetBoundary(Input=material, Support="Nothing", Load="Pressure", LoadBy="Cavities"),
          "no closed cavity", "LoadBy")
    fails(on_plane(material, [-9, 0, 0], [1, 0, 0], Support="Nothing", Load="Pressure",
                   **regions), "No face")
    fails(SetBoundary(Input=material, Support="Nothing", Load="Traction",
                      AppliedTraction=[0, 0, 0], LoadBy="Surface"), "AppliedTraction")

    def solved(scene):
        return SolveEquilibrium(Input=scene, ActiveNodes=[0], Displacement=[0, 0, 0])

    sliding = on_plane(material, [0, 0, 0], [1, 0, 0], Support="Direction",
                       HeldDirection=[1, 0, 0], **regions)
    fails(solved(sliding), "moves freely along (0, ", "Set Boundary")
    fixed = on_plane(material, [0, 0, 0], [1, 0, 0], **regions)
    rim = on_plane(fixed, [0, 0, 0.1], [0, 0, -1], Support="Nothing", Load="Pressure", **regions)
    fails(solved(rim), "rim", "AppliedTraction")
    of_cells = Calculator(Input=fixed, AttributeType="Cell Data",
                          ResultArrayName="AppliedPressure", Function="3")
    fails(solved(of_cells), "AppliedPressure", "of cells")
    wide = Calculator(Input=fixed, ResultArrayName="SupportStiffness", Function="iHat")
    fails(solved(wide), "SupportStiffness has 3 components")


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
            Input=boundary, ActiveNodes=[node], Displacement=[0.005, 0, 0])))
        assert field(solved, "Outcome")[0] == 0
        assert numpy.allclose(point_array(solved, "Displacement")[node], [0.005, 0, 0], atol=0)
        return field(solved, "ReactionForce")[0][0]

    plain = reaction(material)
    stiffer = reaction(Calculator(Input=material, AttributeType="Cell Data",
                                  ResultArrayName="YoungsModulus",
                                  Function="YoungsModulus * 3"))
    assert 0 < plain < stiffer, (plain, stiffer)


def test_laws_beside_each_other_solve(body):
    """Compressible, nearly and fully incompressible parts of one body."""
    for left, right in zip(LAWS, LAWS[-1:] + LAWS[:-1]):
        material = AssignMaterial(Input=body, Law=left, RegionArray="Part", RegionValue=0,
                                  **MATERIALS[left][0])
        material = AssignMaterial(Input=material, Law=right, RegionArray="Part", RegionValue=1,
                                  **MATERIALS[right][0])
        boundary = SetBoundary(Input=material, FixedBy="Array", FixedArray="Inlet")
        offsets = places(fetch(boundary)) - [0.2, 0.1, 0.1]
        node = int(numpy.argmin(numpy.linalg.norm(offsets, axis=1)))
        solved = expect_silence(lambda: fetch(SolveEquilibrium(
            Input=boundary, ActiveNodes=[node], Displacement=[0.005, 0, 0])))
        assert field(solved, "Outcome")[0] == 0, (left, right)
        assert field(solved, "ReactionForce")[0][0] > 0, (left, right)


if __name__ == "__main__":
    body = body_with_regions()
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test(body)
            print(name, "passed", flush=True)

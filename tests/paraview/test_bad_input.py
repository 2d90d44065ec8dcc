# SPDX-License-Identifier: BSD-3-Clause
"""Bad input gives one clear error, wherever it enters the road, and ParaView lives on."""

import math

import numpy
from paraview.simple import (AssignMaterial, Calculator, Delete, IDSelectionSource, Plane,
                             PrecomputeStateSpace, SetBoundary, SolveEquilibrium, Sphere)
from support import (Messages, box_body, expect_error, expect_silence, fetch, field, grid_of,
                     places, produce, source)
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import (VTK_CONVEX_POINT_SET, VTK_QUAD, VTK_QUADRATIC_TETRA,
                                           VTK_TETRA)

LAWS_WITH_MODULUS = ("Linear", "St. Venant-Kirchhoff", "Neo-Hookean")
FAR_CORNER = (0.2, 0.1, 0.1)
CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def node_at(grid, place):
    return int(numpy.argmin(numpy.linalg.norm(places(grid) - place, axis=1)))


def road(body, node, material=None, boundary=None, equilibrium=None):
    """All three filters, fixed at x = 0."""
    assigned = AssignMaterial(Input=body, **(material or {}))
    held = SetBoundary(Input=assigned, FixedRegion="Plane")
    held.FixedRegion.Origin = [0, 0, 0]
    held.FixedRegion.Normal = [1, 0, 0]
    for name, value in (boundary or {}).items():
        setattr(held, name, value)
    settings = {"ActiveNodes": [node], "Displacement": [0.005, 0, 0], **(equilibrium or {})}
    return SolveEquilibrium(Input=held, **settings)


def delete(last):
    """The filters of a road: ParaView takes the longer for a new one the more there are."""
    for proxy in (last, last.Input, last.Input.Input):
        Delete(proxy)


class BadInput:
    """A good body, and the roads that lead from it or from a spoilt one to an error."""

    def __init__(self):
        self.grid = box_body(quadratic=False)
        self.body = source(self.grid, "good")
        self.node = node_at(self.grid, FAR_CORNER)

    def fails(self, *words, **settings):
        """The road with these settings ends with one error that has the words."""
        last = road(settings.pop("body", self.body), settings.pop("node", self.node), **settings)
        expect_error(lambda: fetch(last), *words)
        assert fetch(last).GetNumberOfCells() == 0
        delete(last)
        self.good_run()

    def good_run(self):
        last = road(self.body, self.node)
        grid = expect_silence(lambda: fetch(last))
        assert field(grid, "Outcome")[0] == 0
        delete(last)


def spoilt(change):
    """A copy of the good body, changed, as a source."""
    grid = box_body(quadratic=False)
    change(grid)
    return source(grid, change.__name__)


def test_no_cells(bad):
    bad.fails("no cells", body=source(grid_of(CUBE, [], VTK_TETRA), "empty"))


def test_other_cells(bad):
    bad.fails("Cell 0", "vtkConvexPointSet", "filter Tetrahedralize",
              body=source(grid_of(CUBE, [range(8)], VTK_CONVEX_POINT_SET), "convex"))
    bad.fails("no solid cells", "1 vtkQuad",
              body=source(grid_of(CUBE, [range(4)], VTK_QUAD), "quadrilateral"))

    mixed = box_body((1, 1, 1))
    corners = mixed.GetCell(0).GetPointIds()
    mixed.InsertNextCell(VTK_TETRA, 4, [corners.GetId(i) for i in range(4)])
    assert mixed.GetCellType(0) == VTK_QUADRATIC_TETRA
    bad.fails("mixed", "Cell 6", "vtkTetra", body=source(mixed, "mixed"))


def test_coordinate_not_finite(bad):
    def not_a_number(grid):
        grid.GetPoints().SetPoint(7, 0.1, math.nan, 0)

    bad.fails("Point 7", "not finite", body=spoilt(not_a_number))
    infinite = box_body(quadratic=False)
    infinite.GetPoints().SetPoint(7, 0.1, math.inf, 0)
    bad.fails("Point 7", "not finite", body=produce(infinite))


def test_cell_without_volume(bad):
    def flat_cell(grid):
        ids = grid.GetCell(3).GetPointIds()
        grid.InsertNextCell(VTK_TETRA, 4, [ids.GetId(i) for i in (0, 1, 2, 2)])

    last = box_body(quadratic=False).GetNumberOfCells()
    bad.fails("no volume", f"cell {last}", body=spoilt(flat_cell))


def test_left_handed_cells(bad):
    """No error: such cells are turned round."""
    grid = box_body(quadratic=False)
    mirrored = grid_of(places(grid) * [1, 1, -1],
                       [[grid.GetCell(c).GetPointId(i) for i in range(4)]
                        for c in range(grid.GetNumberOfCells())], VTK_TETRA)
    node = node_at(mirrored, (0.2, 0.1, -0.1))
    result = expect_silence(lambda: fetch(road(source(mirrored, "mirrored"), node)))
    straight = fetch(road(bad.body, bad.node))
    assert numpy.allclose(field(result, "ReactionForce") * [1, 1, -1],
                          field(straight, "ReactionForce"), rtol=1e-9, atol=1e-12)


def test_material_out_of_range(bad):
    for law in LAWS_WITH_MODULUS:
        for value in (0.5, 0.7, -1, -2, math.nan):
            bad.fails("Poisson's ratio", f"{value:g}",
                      material={"Law": law, "PoissonsRatio": value})
        for value in (-5, 0):
            bad.fails("Young's modulus", f"{value:g}",
                      material={"Law": law, "YoungsModulus": value})
    mooney_rivlin = {"Law": "Mooney-Rivlin"}
    bad.fails("C10", "-3", material={**mooney_rivlin, "C10": -3})
    bad.fails("C01", "-4", material={**mooney_rivlin, "C01": -4})
    bad.fails("C10 + C01", material={**mooney_rivlin, "C10": 0, "C01": 0})
    bad.fails("bulk modulus", "-7", material={**mooney_rivlin, "BulkModulus": -7})
    for value in (-5, 0, math.nan):
        bad.fails("Exponent", f"{value:g}", material={"Law": "Fung", "Exponent": value})
    bad.fails("Poisson's ratio", "0.5", material={"Law": "Fung", "PoissonsRatio": 0.5})
    ogden = {"Law": "Ogden"}
    bad.fails("Ogden moduli", "-5", material={**ogden, "OgdenModuli": [-5, 0, 0]})
    bad.fails("OgdenExponent1 is 0", material={**ogden, "OgdenExponents": [0, 0, 0]})
    bad.fails("OgdenExponent2 is 3", material={**ogden, "OgdenExponents": [2, 3, 0]})
    bad.fails("OgdenModulus3", "nan", material={**ogden, "OgdenModuli": [1, 0, math.nan]})
    bad.fails("bulk modulus", "-7", material={**ogden, "BulkModulus": -7})
    bad.fails("Young's modulus", "-5", material={"Law": "Neo-Hookean incompressible",
                                                 "YoungsModulus": -5})
    bad.fails("C10 + C01", material={"Law": "Mooney-Rivlin incompressible", "C10": 0, "C01": 0})


def test_coefficients(bad):
    def fails(coefficients, *words, **settings):
        bad.fails(*words, material={"Law": "Mooney-Rivlin polynomial",
                                    "Coefficients": coefficients, **settings})

    fails([], "Coefficients", "empty")
    for r, s in ((2, 2), (0, 0), (4, 0), (-1, 2), (1.5, 1), (math.nan, 1)):
        fails([1, 0, 500, r, s, 10], "Coefficients", f"r = {r:g}", f"s = {s:g}")
    fails([1, 0, 500, 2, 1, 10, 2, 1, 10], "Coefficients", "C21", "twice")
    fails([1, 0, 500, 2, 1, math.nan], "C21", "nan")
    fails([2, 0, 500], "C10 + C01")
    fails([1, 0, 500], "bulk modulus", "-7", BulkModulus=-7)


def test_density_and_viscosity(bad):
    for name in ("Density", "ViscousTime"):
        for value in (-1, math.nan, math.inf):
            bad.fails(name, f"{value:g}", material={name: value})

    def prony_fails(moduli, times, *words):
        bad.fails(*words, material={"PronyModuli": moduli, "PronyTimes": times})

    prony_fails([0.5], [], "PronyModuli has 1", "PronyTimes has 0")
    prony_fails([0.1] * 5, [1, 2, 3, 4, 5], "5 terms", "4 at the most")
    prony_fails([0.5, 0.2], [1, 1], "PronyTimes", "Sort", "1 s, after 1 s")
    prony_fails([0.5, 0.2], [1, 0.1], "PronyTimes", "Sort", "0.1")
    prony_fails([-0.5], [1], "PronyModuli", "-0.5")
    prony_fails([0.5], [-1], "PronyTimes", "-1")
    prony_fails([0.5], [0], "Term 1", "both above 0")
    prony_fails([0, 0.5], [0, 1], "Term 1", "leave it out")
    prony_fails([math.nan], [1], "PronyModuli", "nan")


def test_formulation(bad):
    for law in ("Neo-Hookean incompressible", "Mooney-Rivlin incompressible"):
        bad.fails("Formulation", "Displacement", law,
                  material={"Law": law, "Formulation": "Displacement"})
    for law in LAWS_WITH_MODULUS:
        bad.fails("Formulation", "Mixed", "Poisson's ratio", "-0.1",
                  material={"Law": law, "PoissonsRatio": -0.1, "Formulation": "Mixed"})


def test_material_of_a_calculator(bad):
    """Arrays may come from anywhere: the first cell that is wrong is named."""
    material = AssignMaterial(Input=bad.body)
    for array, value, words in (
            ("YoungsModulus", "-1", ("cell 0", "Young's modulus")),
            ("PoissonsRatio", "0.5", ("cell 0", "Poisson's ratio")),
            ("Law", "9", ("Cell 0", "Law 9")),
            ("Law", "3", ("cell 0", "C10", "Assign Material")),
            ("Law", "5", ("cell 0", "Exponent", "Assign Material")),
            ("Formulation", "3", ("Cell 0", "Formulation 3"))):
        changed = Calculator(Input=material, AttributeType="Cell Data", ResultArrayName=array,
                             Function=value)
        boundary = SetBoundary(Input=changed, FixedRegion="Plane")
        boundary.FixedRegion.Origin = [0, 0, 0]
        expect_error(lambda: fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[bad.node])),
                     *words)
    bad.good_run()


def test_missing_arrays(bad):
    boundary = SetBoundary(Input=bad.body, FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    expect_error(lambda: fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[bad.node])),
                 "no material", "Assign Material")
    material = AssignMaterial(Input=bad.body)
    expect_error(lambda: fetch(SolveEquilibrium(Input=material, ActiveNodes=[bad.node])),
                 "fixed", "Set Boundary")
    bad.good_run()


def test_region_of_material(bad):
    bad.fails("RegionArray", "Nowhere", material={"RegionArray": "Nowhere"})

    def with_part(grid):
        part = vtkUnsignedCharArray()
        part.SetName("Part")
        for cell in range(grid.GetNumberOfCells()):
            part.InsertNextValue(2 + cell % 2)
        grid.GetCellData().AddArray(part)

    body = spoilt(with_part)
    bad.fails("No cell has the value 5 of Part", "2", "3", body=body,
              material={"RegionArray": "Part", "RegionValue": 5})
    bad.fails("Cell 1", "no material", body=body,
              material={"RegionArray": "Part", "RegionValue": 2})

    def table_fails(regions, *words):
        bad.fails(*words, body=body, material={"RegionType": "Table", "RegionArray": "Part",
                                               "Regions": regions})

    good = "YoungsModulus 5000 PoissonsRatio 0.3"
    table_fails([], "Regions is empty")
    bad.fails("no RegionArray", body=body, material={"RegionType": "Table",
                                                     "Regions": ["2", "Linear", good]})
    table_fails(["2", "Linear", good, "5", "Linear", good], "No cell has the value 5 of Part")
    table_fails(["2", "Linear", good, "2.0", "Linear", good], "'2.0'", "twice")
    table_fails(["two", "Linear", good], "'two' is not a number")
    table_fails(["2", "Jelly", good], "no law or tissue 'Jelly'", "Neo-Hookean", "Ogden", "Liver")
    table_fails(["2", "Liver", good], "the tissue Liver has parameters of its own")
    table_fails(["2", "Linear", "YoungsModulus 5000"], "value '2'", "needs PoissonsRatio")
    table_fails(["2", "Linear", good + " C10 7"], "no parameter 'C10'", "YoungsModulus")
    table_fails(["2", "Linear", good + " PoissonsRatio 0.2"], "PoissonsRatio is given twice")
    table_fails(["2", "Linear", good + " PoissonsRatio"], "PoissonsRatio has no value")
    table_fails(["2", "Linear", "YoungsModulus 5e3Pa PoissonsRatio 0.3"], "5e3Pa")
    table_fails(["2", "Linear", "YoungsModulus -5 PoissonsRatio 0.3"], "Young's modulus is -5")
    table_fails(["2", "Linear", good + " Density -5"], "value '2'", "Density", "-5")
    table_fails(["2", "Liver", "PronyModulus1 0.5"], "value '2'", "Term 1")

    nowhere = AssignMaterial(Input=bad.body, RegionType="Shape", RegionShape="Sphere")
    nowhere.RegionShape.Center = [9, 9, 9]
    expect_error(lambda: fetch(nowhere), "No cell", "Region Shape", "(0, 0, 0)")
    bad.fails("Region Surface has no polygons", material={"RegionType": "Surface"})
    bad.fails("bounds no region", "open edges",
              material={"RegionType": "Surface", "RegionSurface": Plane()})
    bad.fails("Region Surface", "No cell",
              material={"RegionType": "Surface", "RegionSurface": Sphere(Center=[9, 9, 9])})


def test_no_fixed_point(bad):
    far = SetBoundary(Input=bad.body, FixedRegion="Sphere")
    far.FixedRegion.Center = [9, 9, 9]
    far.FixedRegion.Radius = 0.1
    expect_error(lambda: fetch(far), "No point", "fixed", "FixedRegion")
    far.FixedRegion.Center = [0, 0, 0]
    far.FixedRegion.Radius = 10
    expect_error(lambda: fetch(far), "Every point", "fixed")

    nothing = IDSelectionSource(FieldType="POINT", IDs=[])
    bad.fails("No point", "Selection", boundary={"FixedBy": "Selection",
                                                 "FixedSelection": nothing})
    bad.fails("FixedSelection", boundary={"FixedBy": "Selection"})
    bad.fails("FixedArray", "None", boundary={"FixedBy": "Array"})
    bad.fails("TouchableArray", "Nowhere", boundary={"TouchableBy": "Array",
                                                     "TouchableArray": "Nowhere"})

    def fixed_nowhere(grid):
        for name, components in (("Zero", 1), ("Vector", 3)):
            array = vtkDoubleArray()
            array.SetName(name)
            array.SetNumberOfComponents(components)
            array.SetNumberOfTuples(grid.GetNumberOfPoints())
            array.Fill(0)
            grid.GetPointData().AddArray(array)

    body = spoilt(fixed_nowhere)
    bad.fails("No point", "Array", body=body, boundary={"FixedBy": "Array", "FixedArray": "Zero"})
    bad.fails("FixedArray", "Vector", body=body,
              boundary={"FixedBy": "Array", "FixedArray": "Vector"})


def test_fixed_by_an_array_of_the_file(bad):
    """An array Fixed that is 0 throughout, without SetBoundary."""
    def fixed_zero(grid):
        fixed = vtkUnsignedCharArray()
        fixed.SetName("Fixed")
        fixed.SetNumberOfTuples(grid.GetNumberOfPoints())
        fixed.Fill(0)
        grid.GetPointData().AddArray(fixed)

    material = AssignMaterial(Input=spoilt(fixed_zero))
    expect_error(lambda: fetch(SolveEquilibrium(Input=material, ActiveNodes=[bad.node])),
                 "No point", "fixed", "Set Boundary")
    bad.good_run()


def test_text_that_a_terminal_obeys(bad):
    # The names of arrays come from files of anybody.
    name = "\x1b[2J\u202e" + 20000 * "x"
    with Messages() as messages:
        boundary = SetBoundary(Input=produce(box_body()), FixedBy="Array", FixedArray=name)
        boundary.UpdatePipeline()
    assert messages.errors == 1, messages.text
    assert "\\x1b[2J\\xe2\\x80\\xae" in messages.text, messages.text[:1000]
    assert "\x1b" not in messages.text and "\u202e" not in messages.text
    assert len(messages.text) < 11000, len(messages.text)
    Delete(boundary)


def test_active_node(bad):
    interior = node_at(bad.grid, (0.1, 0.05, 0.05))
    bad.fails("inside", f"node {interior}", node=interior)
    fixed = node_at(bad.grid, (0, 0, 0))
    bad.fails("fixed", f"node {fixed}", node=fixed)
    beyond = bad.grid.GetNumberOfPoints()
    for node in (beyond, -1):
        bad.fails("does not exist", f"node {node}", node=node)
    bad.fails("twice",
              equilibrium={"ActiveNodes": [bad.node] * 2, "Displacement": [0.01, 0, 0] * 2})
    bad.fails("No active node", equilibrium={"ActiveNodes": []})

    def with_loose_point(grid):
        grid.GetPoints().InsertNextPoint(1, 1, 1)

    bad.fails("no cell", f"node {beyond}", body=spoilt(with_loose_point), node=beyond)


def test_displacement_and_options(bad):
    bad.fails("displacement", "6", equilibrium={"Displacement": [0.01, 0, 0] * 2})
    bad.fails("displacement", "finite", equilibrium={"Displacement": [math.nan, 0, 0]})
    bad.fails("tolerance", equilibrium={"Tolerance": 0})
    bad.fails("max_iterations", equilibrium={"MaximumIterations": 0})
    bad.fails("threads", "1024", equilibrium={"Threads": 1025})
    bad.fails("threads", equilibrium={"Threads": -1})
    bad.fails("max_seconds", equilibrium={"MaximumSeconds": -1})
    bad.fails("linear solver", "Abacus", equilibrium={"LinearSolver": "Abacus"})


def test_lengths_that_no_body_resolves(bad):
    """On all roads, and in few words: a force of zero would be wrong without a word."""
    pressing = {"ActiveNodes": [], "Displacement": [], "Tool": "Sphere", "ToolRadius": 0.03,
                "ToolPosition": [0.1, 0.05, 0.127]}
    for name, value, *words in (("ToolRadius", 1e-300, "(ToolRadius) is 1e-300 m"),
                                ("ToolRadius", 1e300, "1e+300 m, too large", "ToolRadius"),
                                ("ContactThickness", 1e-300, "(ContactThickness) is 1e-300 m"),
                                ("ContactThickness", 1e300, "(ContactThickness) is 1e+300 m")):
        bad.fails(*words, equilibrium={**pressing, name: value})
    held = road(bad.body, bad.node).Input
    space = {"Tool": "Sphere", "ToolRadius": 0.03, "Spacing": 0.02, "Depth": 0.01}
    for settings, *words in (
            ({"ActiveNodes": [bad.node], "HalfWidth": 1e-300}, "(HalfWidth) is 1e-300 m"),
            ({**space, "Depth": 1e-300}, "(Depth) is 1e-300 m"),
            ({**space, "Spacing": 1e-300}, "Cells of 1e-300 m", "Take a spacing"),
            ({**space, "ToolRadius": 1e-300}, "(ToolRadius) is 1e-300 m"),
            ({**space, "ToolRadius": 1e300}, "1e+300 m, too large", "ToolRadius"),
            ({**space, "ContactThickness": 1e300}, "(ContactThickness) is 1e+300 m")):
        made = PrecomputeStateSpace(Input=held, **settings)
        with Messages() as messages:
            made.UpdatePipeline()
        assert messages.errors == 1, (settings, messages.text)
        assert all(word in messages.text for word in words), (settings, messages.text)
        assert len(messages.text) < 500, messages.text
        Delete(made)


if __name__ == "__main__":
    bad = BadInput()
    bad.good_run()
    for name, test in list(globals().items()):
        if name.startswith("test_"):
            test(bad)
            print(name, "passed", flush=True)

# SPDX-License-Identifier: BSD-3-Clause
"""What other programs write as a body: hexahedra, Lagrange's tetrahedra, and triangles, lines and
vertices among tetrahedra. Forces are those of the same body of tetrahedra."""

import itertools

import numpy
from paraview.simple import AssignMaterial, IDSelectionSource, SetBoundary, SolveEquilibrium
from support import (Messages, box_body, cell_array, expect_error, expect_silence, fetch, field,
                     grid_of, places, point_array, produce, source)
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkIdList, vtkIntArray
from vtkmodules.vtkCommonDataModel import (VTK_HEXAHEDRON, VTK_LAGRANGE_TETRAHEDRON, VTK_LINE,
                                           VTK_POLYHEDRON, VTK_QUADRATIC_HEXAHEDRON,
                                           VTK_QUADRATIC_TETRA, VTK_TETRA, VTK_TRIANGLE,
                                           VTK_VERTEX)

DIVISIONS, LENGTHS = (4, 2, 2), (0.2, 0.1, 0.1)
FAR_SIDE = (0.2, 0.05, 0.05)


# Nodes of a hexahedron in half edges: corners, then the middles of edges as VTK has them.
CORNERS = ((0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2))
MIDDLES = ((1, 0, 0), (2, 1, 0), (1, 2, 0), (0, 1, 0), (1, 0, 2), (2, 1, 2), (1, 2, 2), (0, 1, 2),
           (0, 0, 1), (2, 0, 1), (2, 2, 1), (0, 2, 1))


def hexahedra(quadratic):
    """The box of support.box_body, with the cell array Column, the number of a cube along x, and
    the point array Height, z in m."""
    points, ids, cells, columns = [], {}, [], []
    for cube in itertools.product(*map(range, DIVISIONS)):
        cell = []
        for node in CORNERS + (MIDDLES if quadratic else ()):
            lattice = tuple(2 * c + n for c, n in zip(cube, node))
            if lattice not in ids:
                ids[lattice] = len(points)
                points.append([length * i / (2 * n)
                               for length, i, n in zip(LENGTHS, lattice, DIVISIONS)])
            cell.append(ids[lattice])
        cells.append(cell)
        columns.append(cube[0])
    grid = grid_of(points, cells, VTK_QUADRATIC_HEXAHEDRON if quadratic else VTK_HEXAHEDRON)
    column, height = vtkIntArray(), vtkDoubleArray()
    column.SetName("Column")
    height.SetName("Height")
    for number in columns:
        column.InsertNextValue(number)
    for place in points:
        height.InsertNextValue(place[2])
    grid.GetCellData().AddArray(column)
    grid.GetPointData().AddArray(height)
    return grid


def tetrahedra(grid):
    cells = map(grid.GetCell, range(grid.GetNumberOfCells()))
    return [[cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())] for cell in cells]


def solved(body, node_of=FAR_SIDE, tip=0.05):
    boundary = SetBoundary(Input=AssignMaterial(Input=body), FixedRegion="Plane")
    boundary.FixedRegion.Origin, boundary.FixedRegion.Normal = [0, 0, 0], [1, 0, 0]
    node = int(numpy.argmin(numpy.linalg.norm(places(fetch(boundary)) - node_of, axis=1)))
    grid = fetch(SolveEquilibrium(Input=boundary, ActiveNodes=[node], TipRadius=tip,
                                  Displacement=[0.01, 0.005, 0]))
    assert field(grid, "Outcome")[0] == 0
    return grid, field(grid, "ReactionForce")[0]


def volumes(grid):
    """Of each cell, by its corners."""
    x = places(grid)[numpy.array(tetrahedra(grid))[:, :4]]
    return numpy.linalg.det(x[:, 1:] - x[:, :1]) / 6


def test_block_of_hexahedra():
    # The cubes are cut along other diagonals. In so coarse a mesh that is 8 % of the force, of
    # quadratic tetrahedra 2 %.
    for quadratic, tolerance in ((False, 0.1), (True, 0.025)):
        _, expected = solved(source(box_body(DIVISIONS, LENGTHS, quadratic), "tetrahedra"))
        grid, force = expect_silence(lambda: solved(source(hexahedra(quadratic), "hexahedra")))
        print("force", force, "of tetrahedra", expected)
        difference = numpy.linalg.norm(force - expected)
        assert difference < tolerance * numpy.linalg.norm(expected), (force, expected)
        assert grid.GetCellType(0) == (VTK_QUADRATIC_TETRA if quadratic else VTK_TETRA)
        assert (volumes(grid) > 0).all()
        for column in range(DIVISIONS[0]):
            volume = volumes(grid)[cell_array(grid, "Column") == column].sum()
            assert numpy.isclose(volume, numpy.prod(LENGTHS) / DIVISIONS[0], rtol=1e-12), column
        assert numpy.allclose(point_array(grid, "Height"), places(grid)[:, 2], atol=1e-12)


def test_regions_of_hexahedra():
    body = source(hexahedra(False), "hexahedra")
    stiff = AssignMaterial(Input=AssignMaterial(Input=body, YoungsModulus=1000),
                           YoungsModulus=9000, RegionArray="Column", RegionValue=2)
    grid = expect_silence(lambda: fetch(stiff))
    assert ((cell_array(grid, "YoungsModulus") == 9000) == (cell_array(grid, "Column") == 2)).all()


def test_selection_of_hexahedra():
    """A selection has the ids of the hexahedra, and of their points."""
    body = source(hexahedra(True), "hexahedra")
    first = [0, cell_of_cube((0, 0, 1)), cell_of_cube((0, 1, 0)), cell_of_cube((0, 1, 1))]
    cells = IDSelectionSource(FieldType="CELL", IDs=[i for cell in first for i in (0, cell)])
    boundary = SetBoundary(Input=body, FixedBy="Selection", FixedSelection=cells)
    grid = expect_silence(lambda: fetch(boundary))
    assert grid.GetNumberOfPoints() > hexahedra(True).GetNumberOfPoints()
    near = places(grid)[:, 0] < 0.05 + 1e-9
    assert (point_array(grid, "Fixed") == near).all()


def cell_of_cube(cube):
    return (cube[0] * DIVISIONS[1] + cube[1]) * DIVISIONS[2] + cube[2]


def test_lagrange():
    """What FEniCS writes: the very same body."""
    for quadratic in (False, True):
        plain = box_body(DIVISIONS, LENGTHS, quadratic)
        lagrange = grid_of(places(plain), tetrahedra(plain), VTK_LAGRANGE_TETRAHEDRON)
        _, expected = solved(source(plain, "plain"))
        _, force = expect_silence(lambda: solved(source(lagrange, "lagrange")))
        assert (force == expected).all(), (force, expected)


def test_cells_that_are_no_solids():
    """What pygmsh writes: vertices, lines and triangles, tetrahedra, and points of no cell."""
    plain = box_body(DIVISIONS, LENGTHS, quadratic=False)
    _, expected = solved(source(plain, "plain"))
    mixed = grid_of(numpy.vstack([places(plain), [[9, 9, 9], [0, 0, -3]]]), [], VTK_TETRA)
    for point in (0, 1):
        mixed.InsertNextCell(VTK_VERTEX, 1, [point])
    for cell in tetrahedra(plain)[:10]:
        mixed.InsertNextCell(VTK_LINE, 2, cell[:2])
        mixed.InsertNextCell(VTK_TRIANGLE, 3, cell[:3])
    for cell in tetrahedra(plain):
        mixed.InsertNextCell(VTK_TETRA, 4, cell)
    with Messages() as messages:
        _, force = solved(source(mixed, "mixed"))
    assert messages.warnings == 1 and messages.errors == 0, messages.text
    for words in ("2 vtkVertex", "10 vtkLine", "10 vtkTriangle", "left out"):
        assert words in messages.text, messages.text
    assert (force == expected).all(), (force, expected)


def test_errors():
    cube = hexahedra(False)
    faces = vtkIdList()
    faces.InsertNextId(6)
    for face in ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6),
                 (3, 0, 4, 7)):
        for number in (4, *face):
            faces.InsertNextId(number)
    grid = grid_of(places(cube), [], VTK_TETRA)
    grid.InsertNextCell(VTK_POLYHEDRON, faces)
    for choose in (AssignMaterial, SetBoundary):
        expect_error(lambda: fetch(choose(Input=produce(grid))), "Cell 0", "vtkPolyhedron",
                     "Tetrahedralize")
        for number in (3, 10000):
            spoilt = hexahedra(False)
            array = vtkIntArray()
            array.SetName("Wrong")
            array.SetNumberOfValues(number)
            spoilt.GetCellData().AddArray(array)
            expect_error(lambda: fetch(choose(Input=produce(spoilt))), "cell array 'Wrong'",
                         f"{number} values", "16 cells")
            spoilt.GetCellData().RemoveArray("Wrong")
            spoilt.GetPointData().AddArray(array)
            array.SetName(None)
            expect_error(lambda: fetch(choose(Input=produce(spoilt))),
                         "point array without a name", "45 points")
    expect_error(lambda: fetch(SolveEquilibrium(Input=produce(cube), ActiveNodes=[1])), "Cell 0",
                 "vtkHexahedron", "Assign Material or Set Boundary")
    # A number with several components is no number.
    body = box_body(DIVISIONS, LENGTHS, quadratic=False)
    three = vtkDoubleArray()
    three.SetName("Density")
    three.SetNumberOfComponents(3)
    three.SetNumberOfTuples(body.GetNumberOfCells())
    three.Fill(1000)
    body.GetCellData().AddArray(three)
    expect_error(lambda: fetch(AssignMaterial(Input=produce(body), Density=900, RegionType="Shape",
                                              RegionShape="Sphere")), "'Density'", "3 components")


for name, test in list(globals().items()):
    if name.startswith("test_"):
        test()
        print(name, "passed", flush=True)

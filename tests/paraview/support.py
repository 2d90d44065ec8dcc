# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the filters share: a body to work on, its results as numbers, the messages."""

import itertools

import numpy
from paraview import servermanager
from paraview.simple import (AssignMaterial, Delete, GetSources, PVTrivialProducer, SetBoundary,
                             XMLUnstructuredGridReader)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkOutputWindow, vtkPoints, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import VTK_QUADRATIC_TETRA, VTK_TETRA, vtkUnstructuredGrid
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter

SKIPPED = 77  # exit code
# Corners of the edges, in the order of VTK's midside nodes.
EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))


def box_body(divisions=(4, 2, 2), lengths=(0.2, 0.1, 0.1), quadratic=True):
    """A box with a corner at the origin, m: cubes of six tetrahedra each round a diagonal."""
    points, ids, cells = [], {}, []

    def point(lattice):
        # The lattice is twice as fine as the cubes: midside nodes are on it.
        if lattice not in ids:
            ids[lattice] = len(points)
            points.append([length * i / (2 * n)
                           for length, i, n in zip(lengths, lattice, divisions)])
        return ids[lattice]

    for cube in itertools.product(*map(range, divisions)):
        for path in itertools.permutations(range(3)):
            corners = [numpy.array(cube) * 2]
            for axis in path:
                corners.append(corners[-1] + 2 * numpy.eye(3, dtype=int)[axis])
            nodes = list(corners)
            if quadratic:
                nodes += [(corners[a] + corners[b]) // 2 for a, b in EDGES]
            cells.append([point(tuple(int(i) for i in node)) for node in nodes])
    return grid_of(points, cells, VTK_QUADRATIC_TETRA if quadratic else VTK_TETRA)


def grid_of(points, cells, cell_type):
    grid = vtkUnstructuredGrid()
    places = vtkPoints()
    places.SetDataTypeToDouble()
    for place in points:
        places.InsertNextPoint(place)
    grid.SetPoints(places)
    for cell in cells:
        grid.InsertNextCell(cell_type, len(cell), cell)
    return grid


def source(grid, name):
    """The grid as a source of the pipeline, through a file of the working folder."""
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(name + ".vtu")
    writer.SetInputData(grid)
    writer.SetDataModeToBinary()  # recent releases of Expat make readers refuse appended data
    assert writer.Write() == 1
    return XMLUnstructuredGridReader(FileName=[name + ".vtu"])


def produce(grid):
    """The grid as a source of the pipeline, without a file: where the format has no word for it."""
    producer = PVTrivialProducer()
    producer.GetClientSideObject().SetOutput(grid)
    return producer


def delete_all(but=()):
    """Every source of the pipeline, but those with these keys: what a source is made of is older
    than the source."""
    for key, proxy in sorted(GetSources().items(), key=lambda item: -int(item[0][1])):
        if key not in but:
            Delete(proxy)


def fetch(proxy):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy)


def point_array(grid, name):
    return vtk_to_numpy(grid.GetPointData().GetArray(name))


def cell_array(grid, name):
    return vtk_to_numpy(grid.GetCellData().GetArray(name))


def places(grid):
    return vtk_to_numpy(grid.GetPoints().GetData())


def field(grid, name):
    return vtk_to_numpy(grid.GetFieldData().GetArray(name))


def message(grid):
    return grid.GetFieldData().GetAbstractArray("Message").GetValue(0)


def scene(name="body", law="Neo-Hookean", quadratic=True):
    """A box held at x = 0."""
    body = source(box_body(quadratic=quadratic), name)
    boundary = SetBoundary(Input=AssignMaterial(Input=body, Law=law), FixedRegion="Plane")
    boundary.FixedRegion.Origin = [0, 0, 0]
    boundary.FixedRegion.Normal = [1, 0, 0]
    return boundary


def node_at(boundary, place):
    distance = numpy.linalg.norm(places(fetch(boundary)) - place, axis=1)
    assert distance.min() < 1e-9
    return int(distance.argmin())


class Messages:
    """Error and warning messages of VTK while the context lasts."""

    def __enter__(self):
        self.window = vtkStringOutputWindow()
        self.before = vtkOutputWindow.GetInstance()
        vtkOutputWindow.SetInstance(self.window)
        return self

    def __exit__(self, *_):
        vtkOutputWindow.SetInstance(self.before)

    @property
    def text(self):
        return self.window.GetOutput()

    @property
    def errors(self):
        return self.text.count("ERROR:")

    @property
    def warnings(self):
        return self.text.count("Warning:")


def expect_error(run, *words):
    """Calls run(): it shall end with one error message that has all the words."""
    with Messages() as messages:
        run()
    assert messages.errors == 1, f"{messages.errors} errors where 1 is due: {messages.text}"
    for word in words:
        assert word in messages.text, f"'{word}' is missing in: {messages.text}"


def expect_warning(run, *words):
    """Calls run(): it shall end with one warning that has all the words, and no error."""
    with Messages() as messages:
        run()
    assert messages.errors == 0 and messages.warnings == 1, messages.text
    for word in words:
        assert word in messages.text, f"'{word}' is missing in: {messages.text}"


def expect_silence(run):
    """Calls run(): there shall be no error and no warning."""
    with Messages() as messages:
        result = run()
    assert not messages.text, messages.text
    return result

# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmarks that press a ball into a body share: the arguments, the scene, and places of
its surface that are drawn at random.
"""

import numpy
from paraview import servermanager
from paraview.simple import AssignMaterial, XMLUnstructuredGridReader
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray
from vtkmodules.vtkFiltersCore import vtkPolyDataNormals
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkParallelCore import vtkMultiProcessController


def add_arguments(parser):
    parser.add_argument("body", help="a .vtu file with the point arrays Fixed and Touchable, "
                        "perhaps with materials")
    parser.add_argument("--youngs-modulus", type=float, default=5e3, help="Pa")
    parser.add_argument("--poissons-ratio", type=float, default=0.4)
    parser.add_argument("--radius", type=float, default=0.01, help="of the ball, m")
    parser.add_argument("--depth", type=float, default=0.008, help="the largest, m")
    parser.add_argument("--least-depth", type=float, default=0.4, help="a share of the largest")
    parser.add_argument("--places", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)


def scene_of(arguments):
    """The body with its own materials, or, where it has none, with the one of the arguments."""
    reader = XMLUnstructuredGridReader(FileName=[arguments.body])
    # The header, which every rank has, and not the body, which the first one has alone.
    if "Law" in reader.CellArrayStatus.Available:
        return reader
    return AssignMaterial(Input=reader, Law="Neo-Hookean", YoungsModulus=arguments.youngs_modulus,
                          PoissonsRatio=arguments.poissons_ratio)


def fetch(proxy):
    proxy.UpdatePipeline()
    return servermanager.Fetch(proxy)


def field(data, name):
    return vtk_to_numpy(data.GetFieldData().GetArray(name))


def choose(body, arguments):
    """As draw, of the data of a body: a row each [places, 5]."""
    surface = vtkGeometryFilter()
    surface.SetInputData(body)
    surface.SetNonlinearSubdivisionLevel(0)
    normals = vtkPolyDataNormals()
    normals.SetInputConnection(surface.GetOutputPort())
    normals.SplittingOff()
    normals.Update()
    skin = normals.GetOutput()
    points = vtk_to_numpy(skin.GetPoints().GetData())
    outward = vtk_to_numpy(skin.GetPointData().GetNormals())
    is_touchable = vtk_to_numpy(skin.GetPointData().GetArray("Touchable")) == 1
    all_points = vtk_to_numpy(body.GetPoints().GetData())
    held = all_points[vtk_to_numpy(body.GetPointData().GetArray("Fixed")) == 1]
    far = numpy.array([numpy.linalg.norm(held - p, axis=1).min() for p in points])
    chosen = numpy.flatnonzero(is_touchable & (far > 2 * arguments.radius))
    random = numpy.random.default_rng(arguments.seed)
    rows = []
    for _ in range(arguments.places):
        index = random.choice(chosen)
        depth = arguments.depth * random.uniform(arguments.least_depth, 1)
        node = int(numpy.linalg.norm(all_points - points[index], axis=1).argmin())
        place = points[index] + (arguments.radius - depth) * outward[index]
        rows.append((node, depth, *place))
    return rows


def draw(scene, arguments):
    """A node of the surface, a depth (m) and the place of the ball's centre (m), for each place.
    They are farther than the ball is wide from what holds the body. Of several ranks the first one,
    which alone has the body, draws."""
    controller = vtkMultiProcessController.GetGlobalController()
    drawn = vtkDoubleArray()
    drawn.SetNumberOfComponents(5)
    drawn.SetNumberOfTuples(arguments.places)
    body = fetch(scene)
    if controller.GetLocalProcessId() == 0:
        vtk_to_numpy(drawn)[:] = choose(body, arguments)
    controller.Broadcast(drawn, 0)
    for node, depth, *place in vtk_to_numpy(drawn):
        yield int(node), depth, numpy.array(place)


def ball(proxy, arguments):
    proxy.Tool = "Sphere"
    proxy.Tool.Radius = arguments.radius
    return proxy

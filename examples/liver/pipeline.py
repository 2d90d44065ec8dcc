# SPDX-License-Identifier: BSD-3-Clause
"""Small helpers around ParaView's pipeline, for scripts in one process or under mpiexec."""
import os

from paraview.simple import *
from vtkmodules.util.misc import calldata_type
from vtkmodules.util.vtkConstants import VTK_STRING
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersGeometry import vtkGeometryFilter
from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter


class Failure(Exception):
    """What went wrong, in one line for the user."""


def update(proxy):
    """Runs a source or filter and answers with it; an error that it reports becomes a Failure, and
    so does one of a filter of Palpate before it."""
    messages = []

    @calldata_type(VTK_STRING)
    def note(_, event, message):
        messages.append(message)

    algorithm = proxy.GetClientSideObject()
    observer = algorithm.AddObserver("ErrorEvent", note)
    proxy.UpdatePipeline()
    algorithm.RemoveObserver(observer)
    if messages:
        # "ERROR: In <file>, line <n>\n<class> (<address>): <message>\n\n"
        raise Failure(messages[0].partition("): ")[2].strip() or messages[0].strip())
    proxy.UpdatePropertyInformation()
    if proxy.GetProperty("ErrorCode") and proxy.GetPropertyValue("ErrorCode") != 0:
        raise Failure("a filter before this one failed; its message is above.")
    return proxy


def output(proxy):
    """The data that a filter has made. Palpate's are whole on rank 0, where a script runs."""
    return proxy.GetClientSideObject().GetOutputDataObject(0)


def field(data, name):
    """A field array of a data set as a list, or None where it is not there."""
    array = data.GetFieldData().GetAbstractArray(name)
    if array is None:
        return None
    count = array.GetNumberOfValues()
    get = array.GetValue if hasattr(array, "GetValue") else array.GetVariantValue
    return [get(i) for i in range(count)]


def boundary(data):
    """The triangles on the surface of a data set, as a vtkPolyData."""
    surface, triangles = vtkGeometryFilter(), vtkTriangleFilter()
    surface.SetInputData(data)
    triangles.SetInputConnection(surface.GetOutputPort())
    triangles.Update()
    return triangles.GetOutput()


def save_surface(surface, path):
    """Writes a vtkPolyData, so that the readers of all ranks find it, and answers with a reader."""
    writer = vtkXMLPolyDataWriter()
    writer.SetInputData(surface)
    writer.SetFileName(path)
    writer.SetDataModeToBinary()  # recent releases of Expat make readers refuse appended data
    if not writer.Write():
        raise Failure(f"cannot write {path}.")
    return update(OpenDataFile(path))

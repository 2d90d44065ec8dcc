# SPDX-License-Identifier: BSD-3-Clause
"""Data that a script has made, as a source of the pipeline."""
import sys

from paraview.simple import *
from vtkmodules.vtkIOLegacy import vtkGenericDataObjectWriter

# On several ranks a script runs on the first one alone: the others have an empty piece.
SCRIPT = """
from vtkmodules.vtkIOLegacy import vtkGenericDataObjectReader
from vtkmodules.vtkParallelCore import vtkMultiProcessController
if vtkMultiProcessController.GetGlobalController().GetLocalProcessId() == 0:
    reader = vtkGenericDataObjectReader()
    reader.ReadFromInputStringOn()
    reader.SetInputString({text!r})
    reader.Update()
    self.GetOutputDataObject(0).ShallowCopy(reader.GetOutputDataObject(0))
"""


def source_of(data):
    """For a few hundred rows or cells: the data goes as text."""
    writer = vtkGenericDataObjectWriter()
    writer.SetInputData(data)
    writer.WriteToOutputStringOn()
    writer.Write()
    return programmed(data.GetClassName(), SCRIPT.format(text=writer.GetOutputString()))


def programmed(kind, script):
    """What a script makes on each rank, data of the class `kind`."""
    source = ProgrammableSource(OutputDataSetType=kind, Script=script)
    # ParaView leaves functions with the names min, max, sum, … in the script that was started, and
    # those wait for all ranks.
    names = vars(sys.modules["__main__"])
    before = dict(names)
    source.UpdatePipeline()
    names.clear()
    names.update(before)
    return source

# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the accuracy report share: its tables as numbers."""

import numpy
from paraview import servermanager
from vtkmodules.util.numpy_support import vtk_to_numpy

# Columns of which no two runs are alike.
TIMES = {"PrecomputeSeconds", "SetupSeconds", "EvaluationP50", "EvaluationP999"}


def fetch_report(report):
    report.UpdatePipeline()
    return (servermanager.Fetch(report), servermanager.Fetch(report, idx=1),
            servermanager.Fetch(report, idx=2))


def columns(table):
    names = [table.GetColumnName(i) for i in range(table.GetNumberOfColumns())]

    def values(name):
        if name not in ("Method", "Tool"):
            return vtk_to_numpy(table.GetColumnByName(name))
        return numpy.array([table.GetValueByName(row, name).ToString()
                            for row in range(table.GetNumberOfRows())])

    return {name: values(name) for name in names}


def row(table, method, resolution):
    found = numpy.flatnonzero((table["Method"] == method) & (table["Resolution"] == resolution))
    assert len(found) == 1, (method, resolution, table["Method"])
    return {name: values[found[0]] for name, values in table.items()}

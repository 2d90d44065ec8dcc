# SPDX-License-Identifier: BSD-3-Clause
"""A recording of the haptic loop is a table in ParaView, and its positions are points.

  test_recording.py <palpate-servo> <palpate_test_make_space>
"""

import csv
import os
import subprocess
import sys

import numpy
from paraview.simple import OpenDataFile, TableToPoints
from vtkmodules.util.numpy_support import vtk_to_numpy

from support import expect_silence, fetch, places, point_array

TEXT = ["received_0", "received_1", "received_2", "received_3", "sent", "settings"]


def main():
    servo, make_space = sys.argv[1:]
    subprocess.run([make_space, "block.palpate"], check=True, stdout=subprocess.DEVNULL)
    subprocess.run([servo, "block.palpate", "--seconds", "1.5", "--record", "run.csv"], check=True,
                   stdout=subprocess.DEVNULL)
    with open("run.csv", newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    columns = dict(zip(names, zip(*rows)))

    reader = OpenDataFile(os.path.abspath("run.csv"))
    table = expect_silence(lambda: fetch(reader))
    assert table.GetNumberOfRows() == len(rows) > 100
    assert [table.GetColumnName(c) for c in range(table.GetNumberOfColumns())] == names
    for name in names:
        column = table.GetColumnByName(name)
        if name in TEXT:
            assert column.IsA("vtkStringArray"), name
            assert [column.GetValue(r) for r in range(len(rows))] == list(columns[name]), name
        else:
            assert numpy.array_equal(vtk_to_numpy(column),
                                     numpy.array(columns[name], dtype=float)), name
    assert set(columns["contact"]) >= {"1", "3"}, "the tool was free, and touched"

    axes = [f"position_{axis}_m" for axis in "xyz"]
    points = TableToPoints(Input=reader, XColumn=axes[0], YColumn=axes[1], ZColumn=axes[2])
    cloud = expect_silence(lambda: fetch(points))
    position = numpy.array([columns[axis] for axis in axes], dtype=float).T
    assert numpy.array_equal(places(cloud).astype(numpy.float32), position.astype(numpy.float32))
    assert numpy.ptp(position, axis=0).max() > 0.01
    force = numpy.array(columns["force_x_N"], dtype=float)
    assert numpy.array_equal(point_array(cloud, "force_x_N"), force)


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: BSD-3-Clause
"""What is carried of a state space for touching: bytes a configuration, array by array, and how far
the surface that is drawn is off.

Sample run:
  PV_PLUGIN_PATH=$(echo build/lib/paraview-*/plugins/Palpate) xvfb-run -a pvbatch \\
    tests/benchmark/size.py seed.palpate

The file is of PrecomputeStateSpace, as seed_problem.py --file makes it. The errors are those of
Modes and Coefficients against the displacement that the file holds of every configuration, at every
point of the surface; the file is read by SQLite and the bodies are compared here.
"""

import argparse
import os
import sqlite3

import numpy as np
from paraview.simple import StateSpaceReader
from vtkmodules.util.numpy_support import vtk_to_numpy

parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
parser.add_argument("file", help="a .palpate file")
arguments = parser.parse_args()

reader = StateSpaceReader(FileName=arguments.file)
reader.UpdatePipeline()
space = reader.GetClientSideObject().GetOutputDataObject(0)
surface, configurations = (space.GetPartitionAsDataObject(i, 0) for i in (1, 2))
arrays = configurations.GetPointData()
count = configurations.GetNumberOfPoints()


def bytes_of(array):
    return array.GetNumberOfValues() * array.GetDataTypeSize()


def bytes_of_cells(cells):
    return bytes_of(cells.GetConnectivityArray()) + bytes_of(cells.GetOffsetsArray())


def point_array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


rows = [("points", bytes_of(configurations.GetPoints().GetData())),
        ("vertices and transitions", bytes_of_cells(configurations.GetVerts())
         + bytes_of_cells(configurations.GetLines()))]
for i in range(arrays.GetNumberOfArrays()):
    rows.append((arrays.GetArrayName(i), bytes_of(arrays.GetAbstractArray(i))))

modes = point_array(surface, "Modes").reshape(surface.GetNumberOfPoints(), -1, 3)
coefficients = point_array(configurations, "Coefficients")
gradients = point_array(configurations, "CoefficientGradient").reshape(count, 3, -1)
outcomes = point_array(configurations, "Outcome")
check_points = point_array(configurations, "CheckPoint")
nodes = point_array(configurations, "ActiveNode")
levels = point_array(configurations, "Level")
mesh_points = point_array(surface, "MeshPoint")
fields = configurations.GetFieldData()
step = (2 * fields.GetArray("HalfWidth").GetValue(0)
        / (fields.GetArray("Resolution").GetValue(0) - 1))

database = sqlite3.connect(f"file:{arguments.file}?mode=ro", uri=True)
largest = error = sensitivity_error = 0.0
for c in np.flatnonzero(outcomes == 0):
    u, v = database.execute(
        "SELECT u, v FROM configuration WHERE tool_space_id = ? AND i = ? AND j = ? AND k = ? "
        "AND level = ?", [int(x) for x in (nodes[c], *check_points[c], levels[c])]).fetchone()
    u = np.frombuffer(u).reshape(-1, 3)[mesh_points]
    v = np.frombuffer(v).reshape(3, -1, 3)[:, mesh_points]
    largest = max(largest, np.linalg.norm(u, axis=1).max())
    of_modes = np.einsum("prx,r->px", modes, coefficients[c])
    error = max(error, np.linalg.norm(u - of_modes, axis=1).max())
    of_modes = np.einsum("prx,ar->apx", modes, gradients[c])
    sensitivity_error = max(sensitivity_error, step * np.linalg.norm(v - of_modes, axis=2).max())

print(f"configurations             {count}, {(outcomes == 0).sum()} usable")
basis = bytes_of(surface.GetPointData().GetArray("Modes"))
print(f"modes                      {modes.shape[1]}, {basis / 1e3:.0f} kB for the "
      f"{surface.GetNumberOfPoints()} points of the surface")
for name, size in rows:
    print(f"  {name:25}{size / count:.0f} B a configuration")
print(f"all of them                {sum(size for _, size in rows) / count:.0f} B a configuration")
print(f"largest displacement       {1e3 * largest:.3f} mm")
print(f"its error, all points      {100 * error / largest:.4f} % of that")
print(f"of the spacing times v     {100 * sensitivity_error / largest:.4f} %")
print(f"the file                   {1e-6 * os.path.getsize(arguments.file):.1f} MB")

# SPDX-License-Identifier: BSD-3-Clause
"""The figures of a run, as a table."""
import csv
import os

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

from pipeline import boundary, field
from remesh import arrays, volume

OUTCOMES = ("converged", "not converged", "tangent could not be factorised", "budget used up",
            "aborted", "invalid scene", "tangent could not be solved for without a factor",
            "tool inside the body")
FLAGS = {1: "inverted (det F ≤ 0 somewhere)", 2: "unstable (negative pivots)",
         4: "beyond the force limit", 8: "near a fold", 16: "inertia not computed",
         32: "inaccurate", 64: "touches nothing"}
FOUND = ("nothing found", "inside the space", "extrapolated", "in a marked region")


class Table:
    """Rows of a quantity, its value and its unit."""

    def __init__(self):
        self.rows = []

    def add(self, quantity, value, unit=""):
        self.rows.append((quantity, f"{value:.4g}" if isinstance(value, float) else str(value),
                          unit))

    def describe_body(self, surface, scene, law, meshing_seconds):
        triangles = boundary(surface)
        self.add("triangles of the surface", triangles.GetNumberOfCells())
        self.add("volume of the surface", abs(volume(*arrays(triangles))), "m³")
        self.add("volume of the body", body_volume(scene), "m³")
        self.add("tetrahedra (quadratic)", scene.GetNumberOfCells())
        self.add("points", scene.GetNumberOfPoints())
        self.add("fixed points", int(point_array(scene, "Fixed").sum()))
        self.add("meshing", meshing_seconds, "s")
        self.add("law", law)

    def describe_space(self, space):
        configurations = space.GetPartitionAsDataObject(2, 0)

        def value(name):
            return field(configurations, name)[0]

        self.add("active nodes", ", ".join(map(str, field(configurations, "ActiveNodes"))))
        self.add("half-width", value("HalfWidth"), "m")
        self.add("check-points along an axis", int(value("Resolution")))
        self.add("unknowns", int(value("Unknowns")))
        self.add("configurations", configurations.GetNumberOfPoints())
        outcomes = point_array(configurations, "Outcome")
        for number, name in enumerate(OUTCOMES):
            count = np.count_nonzero(outcomes == number)
            if count or number < 2:
                self.add(f"… {name}", count)
        flags = point_array(configurations, "Flags")
        for bit, name in FLAGS.items():
            self.add(f"… {name}", np.count_nonzero(flags & bit))
        self.add("check-points not reached", int(value("NotReached")))
        forces = np.linalg.norm(point_array(configurations, "Force"), axis=1)
        self.add("largest force", forces[outcomes == 0].max(), "N")
        self.add("error of the displayed displacement", value("DisplacementError"), "m")

        self.add("ranks", int(value("Ranks")))
        self.add("solved in this run", int(value("Solved")))
        self.add("taken from the file", int(value("Reused")))
        if value("Solved") > 0:
            self.describe_time(value)
        self.add("size of the file", os.path.getsize(field(configurations, "FileName")[0]) / 1e6,
                 "MB")

    def describe_time(self, value):
        each = value("ExplorationSeconds") * value("Ranks") / value("Solved")
        self.add("time", value("ExplorationSeconds") + value("FinishingSeconds"), "s")
        self.add("… of it after the last solve", value("FinishingSeconds"), "s")
        self.add("time per configuration, one core", 1e3 * each, "ms")
        self.add("floor: assembly + factorisation + 3 solves", 1e3 * value("FloorSeconds"), "ms")
        self.add("time per configuration over the floor", each / value("FloorSeconds"))
        self.add("one assembly", 1e3 * value("AssemblySeconds"), "ms")
        self.add("one factorisation", 1e3 * value("FactorisationSeconds"), "ms")
        self.add("one solve", 1e3 * value("SolveSeconds"), "ms")

    def describe_touch(self, name, touched, solved):
        """The interpolated force beside that of a solve for the same displacement."""
        force, exact = np.array(field(touched, "Force")), np.array(field(solved, "ReactionForce"))
        found = FOUND[int(field(touched, "Found")[0])]
        outcome = OUTCOMES[int(field(solved, "Outcome")[0])]
        self.add(f"{name}: force, interpolated ({found})", float(np.linalg.norm(force)), "N")
        self.add(f"{name}: force, solved for ({outcome})", float(np.linalg.norm(exact)), "N")
        self.add(f"{name}: difference",
                 float(100 * np.linalg.norm(force - exact) / np.linalg.norm(exact)), "%")

    def markdown(self):
        lines = ["| quantity | value | unit |", "|---|---:|---|"]
        return "\n".join(lines + [f"| {' | '.join(row)} |" for row in self.rows])

    def save(self, folder):
        with open(os.path.join(folder, "table.md"), "w", encoding="utf-8") as file:
            file.write(self.markdown() + "\n")
        with open(os.path.join(folder, "table.csv"), "w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([("quantity", "value", "unit")] + self.rows)


def point_array(data, name):
    return vtk_to_numpy(data.GetPointData().GetArray(name))


def body_volume(body):
    """The volume of quadratic tetrahedra with straight edges."""
    points = vtk_to_numpy(body.GetPoints().GetData())
    cells = vtk_to_numpy(body.GetCells().GetConnectivityArray()).reshape(-1, 10)
    a, b, c, d = (points[cells[:, k]] for k in range(4))
    return np.abs(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)).sum() / 6

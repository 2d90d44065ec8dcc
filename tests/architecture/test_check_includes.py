#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The check finds what it is there for: each case is a small tree with one fault, or with none."""

import tempfile
import unittest
from pathlib import Path

from check_includes import check_tree

# The headers that the cases include.
HEADERS = [
    "solvers/base/error.h", "solvers/mesh/tet_mesh.h", "solvers/linear/linear_solver.h",
    "solvers/interpolation/interpolation.h", "solvers/state_space/state_space.h",
    "haptic/profile/report.h", "haptic/servo/servo.h", "filters/vtkPalpateGuard.h",
    "filters/tetgen/stream.h", "solvers/reduced/reduced_body.h", "solvers/reduction/nnls.h",
    "haptic/simulating/coupled_tool.h", "filters/program/limit.h",
]


def violations_of(files):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve()
        for name, text in {**{header: "#pragma once\n" for header in HEADERS}, **files}.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return list(check_tree(root))


class AllowedTest(unittest.TestCase):
    def check(self, name, *includes):
        text = "".join(f"#include {include}\n" for include in includes)
        self.assertEqual(violations_of({name: text}), [])

    def test_earlier_part(self):
        self.check("solvers/mesh/a.cpp", '"base/error.h"', '"mesh/tet_mesh.h"', "<vector>")

    def test_libraries_in_their_place(self):
        self.check("solvers/base/a.h", "<Eigen/Core>")
        self.check("solvers/linear/a.cpp", "<dmumps_c.h>", "<mpi.h>")
        self.check("solvers/schedule/a.cpp", "<mpi.h>")
        self.check("solvers/state_space/a.cpp", "<sqlite3.h>")
        self.check("filters/tetgen/main.cpp", "<tetgen.h>", '"stream.h"', '"program/limit.h"')
        self.check("filters/image/main.cpp", "<itkNrrdImageIO.h>", "<NrrdIO.h>",
                   '"program/limit.h"')

    def test_haptic(self):
        self.check("haptic/servo/a.cpp", '"haptic/profile/report.h"',
                   '"interpolation/interpolation.h"')
        self.check("haptic/transport/a.cpp", "<hidapi/hidapi.h>", '"haptic/profile/report.h"')

    def test_haptic_computes_with_reduced_bodies(self):
        self.check("haptic/simulating/a.cpp", '"reduced/reduced_body.h"')
        self.check("haptic/servo/a.cpp", '"haptic/simulating/coupled_tool.h"')

    def test_filters(self):
        self.check("filters/a.cxx", '"vtkPalpateGuard.h"', '"mesh/tet_mesh.h"', "<vtkMPI.h>",
                   '"vtkPolyData.h"', '"PalpateFiltersModule.h"', "<vtkSMPTools.h>", "<spawn.h>")

    def test_examples(self):
        self.check("examples/a/a.cpp", '"haptic/servo/servo.h"',
                   '"state_space/state_space.h"', "<cstdio>")

    def test_tests_see_all(self):
        self.check("tests/filters/a.cpp", '"vtkPalpateGuard.h"', '"base/error.h"',
                   "<gtest/gtest.h>")

    def test_ignored_folders(self):
        self.check("build-debug/a.cpp", "<vtkPolyData.h>")


class ForbiddenTest(unittest.TestCase):
    def check(self, name, include, expected):
        self.assertEqual(violations_of({name: f"\n#include {include}\n"}),
                         [f"{name}:2: {expected}"])

    def test_later_part(self):
        self.check("solvers/mesh/a.cpp", '"linear/linear_solver.h"',
                   "linear/linear_solver.h: solvers/mesh may not include solvers/linear")

    def test_interpolation_knows_nothing_of_solving_later(self):
        self.check("solvers/state_space/a.cpp", '"interpolation/interpolation.h"',
                   "interpolation/interpolation.h: solvers/state_space may not include "
                   "solvers/interpolation")

    def test_reduced_bodies_know_no_mesh(self):
        self.check("solvers/reduced/a.cpp", '"mesh/tet_mesh.h"',
                   "mesh/tet_mesh.h: solvers/reduced may not include solvers/mesh")

    def test_simulating_knows_no_servo_loop(self):
        self.check("haptic/simulating/a.cpp", '"haptic/servo/servo.h"',
                   "haptic/servo/servo.h: haptic/simulating may not include haptic/servo")

    def test_haptic_reduces_nothing(self):
        self.check("haptic/servo/a.cpp", '"reduction/nnls.h"',
                   "reduction/nnls.h: haptic/servo may not include solvers/reduction")

    def test_solvers_see_no_other_folder(self):
        self.check("solvers/exploration/a.cpp", '"vtkPalpateGuard.h"',
                   "vtkPalpateGuard.h: solvers/exploration may not include filters")
        self.check("solvers/exploration/a.cpp", '"haptic/profile/report.h"',
                   "haptic/profile/report.h: solvers/exploration may not include haptic/profile")

    def test_no_vtk_or_qt_outside_filters_and_plugin(self):
        for folder in ("solvers/exploration", "haptic/servo"):
            self.check(f"{folder}/a.h", "<vtkPolyData.h>",
                       f"vtkPolyData.h: {folder} may not include VTK")
            self.check(f"{folder}/a.h", "<QWidget>", f"QWidget: {folder} may not include Qt")
            self.check(f"{folder}/a.h", "<vtkSMProxy.h>",
                       f"vtkSMProxy.h: {folder} may not include ParaView")

    def test_no_qt_on_the_server(self):
        self.check("filters/a.cxx", "<QtCore/QString>",
                   "QtCore/QString: filters may not include Qt")

    def test_libraries_out_of_their_place(self):
        self.check("solvers/equilibrium/a.cpp", "<dmumps_c.h>",
                   "dmumps_c.h: solvers/equilibrium may not include MUMPS")
        self.check("solvers/exploration/a.cpp", "<mpi.h>",
                   "mpi.h: solvers/exploration may not include MPI")
        self.check("haptic/servo/a.cpp", "<hidapi/hidapi.h>",
                   "hidapi/hidapi.h: haptic/servo may not include hidapi")
        self.check("solvers/interpolation/a.cpp", "<sqlite3.h>",
                   "sqlite3.h: solvers/interpolation may not include SQLite")
        self.check("solvers/exploration/a.cpp", "<zlib.h>",
                   "zlib.h: solvers/exploration may not include zlib")
        self.check("filters/a.cxx", "<tetgen.h>", "tetgen.h: filters may not include TetGen")
        self.check("solvers/mesh/a.cpp", "<xxhash.h>",
                   "xxhash.h: solvers/mesh may not include xxHash")

    def test_itk_is_in_its_program_alone(self):
        self.check("filters/a.cxx", "<itkImage.h>", "itkImage.h: filters may not include ITK")

    def test_tetgen_program_stands_alone(self):
        self.check("filters/tetgen/main.cpp", '"base/error.h"',
                   "base/error.h: filters/tetgen may not include solvers/base")

    def test_haptic_does_not_solve(self):
        self.check("haptic/servo/a.cpp", '"linear/linear_solver.h"',
                   "linear/linear_solver.h: haptic/servo may not include solvers/linear")

    def test_examples_neither_show_nor_solve(self):
        self.check("examples/a/a.cpp", "<vtkPolyData.h>",
                   "vtkPolyData.h: examples may not include VTK")
        self.check("examples/a/a.cpp", '"linear/linear_solver.h"',
                   "linear/linear_solver.h: examples may not include solvers/linear")

    def test_haptic_parts_see_only_those_before(self):
        self.check("haptic/profile/a.cpp", '"haptic/servo/servo.h"',
                   "haptic/servo/servo.h: haptic/profile may not include haptic/servo")

    def test_unknown_library(self):
        self.check("solvers/base/a.h", "<boost/any.hpp>",
                   "boost/any.hpp: neither a header of the project nor of a library with a rule")

    def test_names_start_at_a_root(self):
        self.check("solvers/mesh/a.cpp", '"../base/error.h"',
                   "../base/error.h: the name starts at a root, without ..")
        self.check("solvers/mesh/a.cpp", '"tet_mesh.h"',
                   "tet_mesh.h: the name starts with the part of solvers/")

    def test_part_without_a_rule(self):
        self.check("solvers/other/a.cpp", "<vector>",
                   "solvers/other has no rule: give it one in check_includes.py")


class TreeTest(unittest.TestCase):
    def test_unknown_folder(self):
        self.assertEqual(violations_of({"misc/notes.md": "x"}),
                         ["misc: an unknown folder at the top"])

    def test_machine_path(self):
        for place in ("home", "root", "work"):
            path = f"/{place}/someone/data.vtu"  # put together, or this file would be a violation
            self.assertEqual(violations_of({"examples/a.pvsm": f'<x value="{path}"/>\n'}),
                             ["examples/a.pvsm:1: a path of somebody's machine"])

    def test_what_only_looks_like_a_machine_path(self):
        text = '"$here/work/a" www.a.org/home/ a/root/b'
        self.assertEqual(violations_of({"examples/a.sh": text}), [])


if __name__ == "__main__":
    unittest.main()

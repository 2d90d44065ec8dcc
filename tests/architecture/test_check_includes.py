#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""The check finds what it is there for: each case is a small tree with one fault, or with none."""

import tempfile
import unittest
from pathlib import Path

from check_includes import check_tree, module_of

# The headers that the cases include.
HEADERS = [
    "solvers/base/error.h", "solvers/mesh/tet_mesh.h", "solvers/linear/linear_solver.h",
    "solvers/interpolation/interpolation.h", "solvers/state_space/state_space.h",
    "solvers/storage/state_space_file.h",
    "haptic/profile/report.h", "haptic/servo/servo.h", "filters/common/vtkPalpateGuard.h",
    "filters/surface/vtkPalpateSurface.h", "filters/scene/vtkPalpateScene.h",
    "filters/programs/tetgen/stream.h", "solvers/reduced/reduced_body.h",
    "solvers/reduction/nnls.h", "haptic/simulating/coupled_tool.h",
    "filters/programs/program/limit.h",
    "plugin/PalpateInteractor/common/pqPalpateFetch.h",
    "plugin/PalpateInteractor/touch/pqPalpateTouch.h",
]

# The rooms that they name, of those that the cases have files in.
MODULES = {
    "common": "", "surface": "Palpate::Common", "segmentation": "", "meshing": "",
    "scene": "Palpate::Common Palpate::Surface", "febio": "Palpate::Scene",
}


def violations_of(files, exceptions=()):
    modules = {f"filters/{room}/vtk.module": f"NAME\n  {module_of(room)}\nDEPENDS\n  {named}\n"
               for room, named in MODULES.items()}
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder).resolve()
        for name, text in {**{header: "#pragma once\n" for header in HEADERS}, **modules,
                           **files}.items():
            path = root / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return list(check_tree(root, exceptions))


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
        self.check("solvers/storage/a.cpp", "<sqlite3.h>")
        self.check("filters/programs/tetgen/main.cpp", "<tetgen.h>", '"stream.h"',
                   '"program/limit.h"')
        self.check("filters/programs/image/main.cpp", "<itkNrrdImageIO.h>", "<NrrdIO.h>",
                   '"program/limit.h"')

    def test_haptic(self):
        self.check("haptic/servo/a.cpp", '"haptic/profile/report.h"',
                   '"interpolation/interpolation.h"')
        self.check("haptic/transport/a.cpp", "<hidapi/hidapi.h>", '"haptic/profile/report.h"')
        self.check("haptic/palpate_servo/a.cpp", '"storage/state_space_file.h"')

    def test_haptic_computes_with_reduced_bodies(self):
        self.check("haptic/simulating/a.cpp", '"reduced/reduced_body.h"')
        self.check("haptic/servo/a.cpp", '"haptic/simulating/coupled_tool.h"')

    def test_filters(self):
        self.check("filters/surface/a.cxx", '"vtkPalpateGuard.h"', '"mesh/tet_mesh.h"',
                   "<vtkMPI.h>", '"vtkPolyData.h"', '"PalpateSurfaceModule.h"', "<vtkSMPTools.h>",
                   "<spawn.h>")

    def test_dock(self):
        self.check("plugin/PalpateInteractor/dock/a.cxx", '"pqPalpateTouch.h"', "<QWidget>",
                   '"pqPalpateFetch.h"', '"vtkPalpateScene.h"', '"haptic/servo/servo.h"')

    def test_examples(self):
        self.check("examples/a/a.cpp", '"haptic/servo/servo.h"',
                   '"state_space/state_space.h"', "<cstdio>")

    def test_tests_see_all(self):
        self.check("tests/filters/scene/a.cpp", '"vtkPalpateGuard.h"', '"base/error.h"',
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

    def test_interpolation_and_touching_know_no_file(self):
        for folder in ("solvers/interpolation", "haptic/touching"):
            self.check(f"{folder}/a.cpp", '"storage/state_space_file.h"',
                       f"storage/state_space_file.h: {folder} may not include solvers/storage")

    def test_haptic_reduces_nothing(self):
        self.check("haptic/servo/a.cpp", '"reduction/nnls.h"',
                   "reduction/nnls.h: haptic/servo may not include solvers/reduction")

    def test_solvers_see_no_other_folder(self):
        self.check("solvers/exploration/a.cpp", '"vtkPalpateGuard.h"',
                   "vtkPalpateGuard.h: solvers/exploration may not include filters/common")
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
        self.check("filters/scene/a.cxx", "<QtCore/QString>",
                   "QtCore/QString: filters/scene may not include Qt")

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
        self.check("filters/meshing/a.cxx", "<tetgen.h>",
                   "tetgen.h: filters/meshing may not include TetGen")
        self.check("solvers/mesh/a.cpp", "<xxhash.h>",
                   "xxhash.h: solvers/mesh may not include xxHash")

    def test_itk_is_in_its_program_alone(self):
        self.check("filters/segmentation/a.cxx", "<itkImage.h>",
                   "itkImage.h: filters/segmentation may not include ITK")

    def test_folders_of_the_dock_see_only_those_before(self):
        place = "plugin/PalpateInteractor"
        self.check(f"{place}/mouse/a.cxx", '"pqPalpateTouch.h"',
                   f"pqPalpateTouch.h: {place}/mouse may not include {place}/touch")
        self.check(f"{place}/widgets/a.cxx", '"haptic/servo/servo.h"',
                   f"haptic/servo/servo.h: {place}/widgets may not include haptic/servo")
        self.check(f"{place}/dock/a.cxx", "<X11/Xlib.h>",
                   f"X11/Xlib.h: {place}/dock may not include X11")

    def test_tetgen_program_stands_alone(self):
        self.check("filters/programs/tetgen/main.cpp", '"base/error.h"',
                   "base/error.h: filters/programs/tetgen may not include solvers/base")

    def test_rooms_see_only_those_before(self):
        self.check("filters/surface/a.cxx", '"vtkPalpateScene.h"',
                   "vtkPalpateScene.h: filters/surface may not include filters/scene")

    def test_rooms_see_only_those_that_their_module_names(self):
        self.check("filters/febio/a.cxx", '"vtkPalpateSurface.h"',
                   "vtkPalpateSurface.h: filters/febio/vtk.module does not name Palpate::Surface")

    def test_rooms_see_solvers_as_far_as_they_need(self):
        self.check("filters/surface/a.cxx", '"linear/linear_solver.h"',
                   "linear/linear_solver.h: filters/surface may not include solvers/linear")

    def test_filters_are_in_rooms(self):
        self.check("filters/a.cxx", "<vector>",
                   "filters has no rule: give it one in check_includes.py")

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


class ThroughHeadersTest(unittest.TestCase):
    """haptic/servo/a.cpp includes a header that includes one that it may not include itself."""

    FILES = {"haptic/servo/a.cpp": '#include <vector>\n#include "state_space/file.h"\n',
             "solvers/state_space/file.h": '#include "state_space/scene_of_file.h"\n',
             "solvers/state_space/scene_of_file.h": '#include "assembly/scene.h"\n',
             "solvers/assembly/scene.h": "#pragma once\n"}
    EXCEPTION = ("haptic", "solvers/assembly", "a file has a scene")

    def test_it_is_seen(self):
        self.assertEqual(violations_of(self.FILES),
                         ["haptic/servo/a.cpp:2: scene_of_file.h: through it haptic/servo sees "
                          "solvers/assembly, which it may not include"])

    def test_exception(self):
        self.assertEqual(violations_of(self.FILES, [self.EXCEPTION]), [])

    def test_exception_of_another_folder(self):
        self.assertEqual(len(violations_of(self.FILES, [self.EXCEPTION,
                                                        ("plugin", "solvers/assembly", "")])), 1)
        self.assertEqual(len(violations_of(self.FILES, [("plugin", "solvers/assembly", "")])), 2)

    def test_exceptions_become_fewer(self):
        self.assertEqual(violations_of({}, [self.EXCEPTION]),
                         ["haptic no longer sees solvers/assembly through a header: delete the "
                          "exception"])


class TreeTest(unittest.TestCase):
    def test_room_without_a_module(self):
        self.assertEqual(violations_of({"filters/tool/a.cxx": "\n"}),
                         ["filters/tool: no vtk.module"])

    def test_module_that_names_a_later_room(self):
        self.assertEqual(violations_of({"filters/surface/vtk.module": "DEPENDS Palpate::Scene\n"}),
                         ["filters/surface/vtk.module: it names Palpate::Scene, which comes after "
                          "it"])

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

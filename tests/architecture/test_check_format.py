#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What check_format.py reports, of small trees that are made here."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import check_format

STYLE = "BasedOnStyle: Google\n"


class Format(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = Path(folder.name).resolve()
        self.write(".clang-format", STYLE)

    def write(self, path, text):
        path = self.root / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def check(self):
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            result = check_format.main(self.root)
        return result, output.getvalue()

    def test_long_lines_of_texts_are_told(self):
        self.write("cmake/CMakeLists.txt", "#\n" + "x" * 101 + "\n")
        self.write("examples/run", "#!/bin/sh\n" + "é" * 100 + "\n")
        self.write("examples/README.md", "x" * 300 + "\n")
        result, output = self.check()
        self.assertEqual(result, 1)
        self.assertIn("cmake/CMakeLists.txt:2: the line has 101 characters", output)
        self.assertNotIn("run", output)
        self.assertNotIn("README", output)

    @unittest.skipUnless(check_format.clang_format(), "there is no clang-format of the version")
    def test_a_source_that_is_not_formatted_is_told(self):
        self.write("solvers/good.cpp", "int f() { return 1; }\n")
        self.write("solvers/bad.cpp", "int g() { return 1; }\nint  f(){return 1;}\n")
        result, output = self.check()
        self.assertEqual(result, 1)
        self.assertIn("solvers/bad.cpp:2: it is not formatted", output)
        self.assertNotIn("good", output)
        self.write("solvers/bad.cpp", "int f() { return 1; }\n")
        self.assertEqual(self.check(), (0, "No violation.\n"))

    def test_without_the_program_it_is_skipped_and_says_why(self):
        with mock.patch.object(check_format, "clang_format", return_value=None), \
                mock.patch.object(check_format, "is_debian_12", return_value=False):
            result, output = self.check()
        self.assertEqual(result, check_format.SKIPPED)
        self.assertIn("clang-format 14 is missing", output)

    def test_in_debian_12_nothing_is_skipped_where_that_is_asked_for(self):
        with mock.patch.object(check_format, "clang_format", return_value=None), \
                mock.patch.object(check_format, "is_debian_12", return_value=True), \
                mock.patch.dict("os.environ", {"PALPATE_SKIP_NOTHING": "1"}):
            self.assertEqual(self.check()[0], 1)


if __name__ == "__main__":
    unittest.main()

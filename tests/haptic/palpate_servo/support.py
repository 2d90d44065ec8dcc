# SPDX-License-Identifier: BSD-3-Clause
"""Runs palpate-servo, the first argument of the test, and reads what it prints and records."""

import csv
import math
import os
import re
import struct
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM = sys.argv[1]
RUNNING, ATTACHED = 2, 3  # as in haptic/servo/tick.h and haptic/touching/contact.h
# The simulated board takes force in steps of 1 mN, each axis rounded.
STEP = 1e-3
BOARD_LIMIT = 7.9  # N, of the simulated board


def command(arguments):
    return [PROGRAM, *map(str, arguments)]


def run(*arguments):
    return subprocess.run(command(arguments), capture_output=True, text=True, timeout=120,
                          check=False)


def stopped(arguments, recording, with_signal):
    """A run without an end that is sent a signal when its recording has some ticks."""
    with subprocess.Popen(command(arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          text=True) as process:
        end = time.monotonic() + 60
        while time.monotonic() < end:
            time.sleep(0.05)
            if os.path.exists(recording) and os.path.getsize(recording) > 500_000:
                break
        process.send_signal(with_signal)
        output, errors = process.communicate(timeout=60)
    return process.returncode, output, errors


def number(output, form):
    """The number in parentheses of a regular expression."""
    return float(re.search(form, output).group(1))


def sent_force(row):
    """Of a row of a recording, N; None: motors off."""
    report = bytes.fromhex(row["sent"][1:])
    kind, _, x, y, z, force = struct.unpack("<BHhhhB", report)
    assert kind == 3 and force in (0, 1), row["sent"]
    return math.hypot(x, y, z) * STEP if force else None


def rows_of(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


class ProgramTest(unittest.TestCase):
    """A test with a folder of its own."""

    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()

    @classmethod
    def tearDownClass(cls):
        cls.folder.cleanup()

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder.name, name)

    def check_safety(self, output, rows, limit):
        self.assertIn("motors off", output)
        self.assertLessEqual(number(output, r"largest ([\d.]+) N, limit"), limit + 1e-4)
        self.assertAlmostEqual(number(output, r"limit ([\d.]+) N"), limit, places=4)
        for row in rows:
            force = sent_force(row)
            if int(row["state"]) == RUNNING:
                self.assertLessEqual(force, limit + STEP)
            else:
                self.assertIsNone(force)

    def expect_error(self, arguments, *words):
        done = run(*arguments)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertTrue(done.stderr.startswith("palpate-servo: "), done.stderr)
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in words:
            self.assertIn(word, done.stderr)

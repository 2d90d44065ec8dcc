# SPDX-License-Identifier: BSD-3-Clause
"""palpate-servo with a reduced model: several devices on one body, what it prints and records,
safety rules, bad input, signals.

  test_reduced.py <palpate-servo> <palpate_test_make_model>

Nothing here depends on how fast or how busy the machine is.
"""

import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import unittest

from support import ATTACHED, BOARD_LIMIT, ProgramTest, number, rows_of, run, stopped

MAKE_MODEL = sys.argv[2]
REACH = 0.01  # m, of the models
TWO = ("--device", "simulated", "--device", "simulated")


def parts_of(output):
    """What is printed at the end of each tool and of the body, by "tool 0" and so on."""
    parts = re.split(r"^(tool \d|body) +(?:simulated|reduced model \d)\n", output, flags=re.M)
    return dict(zip(parts[1::2], parts[2::2]))


class Reduced(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.model, cls.both = cls.path("model.palpate"), cls.path("both.palpate")
        for arguments in ([cls.model, "1"], [cls.both, "2", "space"]):
            made = subprocess.run([MAKE_MODEL, *arguments], capture_output=True, text=True,
                                  check=True)
        cls.nodes = made.stdout.split()

    def touch(self, name, *arguments, file=None, num_devices=1, limit=BOARD_LIMIT):
        """A run with recordings of that name. A busy machine may pause it for long: a hand that is
        not seen outside takes no hold, so that such a run is one more time."""
        recordings = [self.path(f"{name}-tool{tool}.csv") for tool in range(num_devices)]
        for _ in range(5):
            done = run(file or self.model, "--record", self.path(name + ".csv"),
                       "--release-after", 60, *arguments)
            self.assertEqual(done.returncode, 0, done.stderr)
            tables = [rows_of(recording) for recording in recordings]
            touching = [sum(int(row["contact"]) == ATTACHED for row in rows) for rows in tables]
            if min(touching) > 100:
                break
            for recording in recordings:
                os.remove(recording)
        self.assertGreater(min(touching), 100)
        parts = parts_of(done.stdout)
        names = [f"tool {tool}" for tool in range(num_devices)]
        self.assertEqual(list(parts), [*names, "body"], done.stdout)
        for tool, rows in enumerate(tables):
            part = parts[f"tool {tool}"]
            self.assertEqual(len(rows), number(part, r"ticks +(\d+) in"))
            self.assertEqual(len(rows), number(part, r"recording +(\d+) ticks, 0 dropped"))
            self.assertEqual(touching[tool], number(part, r"(\d+) ticks touching"))
            self.assertEqual(number(part, r"interlock +(\d+) ticks without force"), 0)
            self.check_safety(part, rows, limit)
        self.assertFalse(os.path.exists(self.path(f"{name}-tool{num_devices}.csv")))
        return done.stdout, parts, tables

    def test_two_hands_hold_one_body(self):
        output, parts, tables = self.touch("two", *TWO, "--seconds", 1.5, num_devices=2)
        for tool, node in enumerate(self.nodes):
            self.assertIn(f"tool {tool}       at point {node}, simulated, reach {REACH:g} m",
                          output)
        for part in parts.values():
            self.assertRegex(part, r"lateness +median [\d.]+ us, .*99.9 % [\d.]+ us, largest")
            self.assertRegex(part, r"realtime +priority (yes|no), memory locked (yes|no)")
        body = parts["body"]
        self.assertGreater(number(body, r"steps +(\d+) in"), 10)
        self.assertRegex(body, r"steps .* (\d+) missed, (\d+) longer than the period")
        self.assertRegex(body, r"step +median [\d.]+ us, 99 % [\d.]+ us, 99.9 % [\d.]+ us, largest")
        self.assertIn("failed       0 steps without a balance and 0 beyond training", body)
        # The hand wants to move the tool by 0.6 of that. Where the machine pauses the hand jumps,
        # and the body swings beyond.
        trust, beyond = (number(body, form) for form in (r"trust +largest ([\d.]+)",
                                                         r"(\d+) steps above 2"))
        self.assertGreater(trust, 0)
        self.assertEqual(beyond > 0, trust > 2)
        for rows in tables:
            held = [row for row in rows if int(row["contact"]) == ATTACHED]
            # Three digits of it are printed.
            self.assertLessEqual(max(float(row["trust"]) for row in held), 1.005 * trust)
            self.assertGreater(max(float(row["trust"]) for row in held), 0)
            # The body holds up what moves its tool into it; as it swings, not in each tick.
            self.assertLess(sum(float(row[f"force_{axis}_N"]) * float(row[f"displacement_{axis}_m"])
                                for row in held for axis in "xyz"), 0)

    def test_one_hand(self):
        output, _, _ = self.touch("one", "--motion", "circle", "--seconds", 1)
        self.assertIn(f"tool 1       at point {self.nodes[1]}, without a device: it moves with",
                      output)
        self.expect_error([self.both, "--replay", self.path("one-tool0.csv")],
                          "a replay cannot step")

    def test_under_gravity(self):
        """The tool is held where it hangs."""
        heavy = self.path("heavy.palpate")
        subprocess.run([MAKE_MODEL, heavy, "1", "gravity"], capture_output=True, check=True)
        places = []
        for name, file in (("light", self.model), ("heavy", heavy)):
            _, _, (rows,) = self.touch(name, "--seconds", 1, file=file)
            held = next(row for row in rows if int(row["contact"]) == ATTACHED)
            places.append(float(held["anchor_z_m"]))
        self.assertLess(places[1], places[0] - 0.002)

    def test_limits(self):
        _, parts, _ = self.touch("limited", *TWO, "--seconds", 1, "--force-limit", 0.05,
                                 "--force-scale", 10, "--motion", "tap", num_devices=2, limit=0.05)
        for tool in ("tool 0", "tool 1"):
            self.assertGreater(number(parts[tool], r"limiter +(\d+) ticks by size"), 0)

    def test_options(self):
        output, parts, _ = self.touch("options", "--seconds", 1.5, "--motion", "slide",
                                      "--coupling", 100, "--coupling-damping", 0.5,
                                      "--step", 0.004, "--damping", 1, "--scale", 2, "--depth",
                                      0.002, "--no-passivity-control", "--no-realtime")
        self.assertIn("coupling 100 N/m", output)
        self.assertIn("a step each 4 ms", output)
        self.assertLessEqual(number(parts["body"], r"steps +(\d+) in"),
                             250 * number(parts["body"], r"steps +\d+ in ([\d.]+) s") + 1)
        self.assertIn("realtime     priority no", parts["body"])
        # The hand moves the tool by a fifth of what the model was trained for, and after a jump the
        # body swings to twice that.
        self.assertLess(number(parts["body"], r"trust +largest ([\d.]+)"), 0.5)

    def test_which_model(self):
        done = run(self.both, "--seconds", 0.1)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("2 active node(s)", done.stdout)
        for number_of_model, modes in ((1, 4), (2, 6)):
            done = run(self.both, "--reduced", number_of_model, "--seconds", 0.1)
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn(f"reduced model {number_of_model}: {modes} modes", done.stdout)

    def test_bad_input(self):
        twice = ("--device", "/dev/hidraw99", "--device", "/dev/hidraw99")
        for file, arguments, *words in (
                (self.both, ["--reduced", 3], "no 3", "1 (tools at points", "2 (tools", "6 modes"),
                (self.both, ["--reduced", 0], "no 0"), (self.both, ["--reduced", "x"], "x"),
                (self.both, TWO, "2 devices", "--reduced"),
                (self.both, ["--step", 0.01], "--step", "state space"),
                (self.both, ["--coupling-damping", 1], "--coupling-damping", "state space"),
                (self.model, [*TWO, "--device", "simulated"], "3 devices", "2 tool(s)"),
                (self.model, twice, "/dev/hidraw99 is given twice"),
                (self.model, ["--device", "list", "--device", "simulated"], "--device list"),
                (self.model, ["--device", "simulated", "--device", "/dev/none"], "/dev/none"),
                (self.model, ["--node", 1], "--node"), (self.model, ["--friction", 1], "friction"),
                (self.model, ["--bonded"], "--bonded"),
                (self.model, ["--release-force", 1], "--release-force"),
                (self.model, ["--no-blending"], "--no-blending"),
                (self.model, ["--method", "trilinear"], "--method"),
                (self.model, ["--grasp", 0], "--grasp", "real device"),
                (self.model, ["--dead-man", 0], "--dead-man", "real device"),
                (self.model, ["--replay", "a.csv"], "cannot be replayed", "--replay"),
                (self.both, ["--reduced", 1, "--replay", "a.csv"], "cannot be replayed"),
                (self.model, ["--coupling", 0], "coupling", "more than 0"),
                (self.model, ["--coupling-damping", -1], "damping", "0 or more"),
                (self.model, ["--step", 0], "--step"), (self.model, ["--step", "nan"], "--step"),
                (self.model, ["--step", 0.02], "--step", "--release-after"),
                (self.model, ["--depth", 1], "--depth"),
                (self.model, ["--force-limit", -1], "force limit"),
                (self.model, ["--record", self.folder.name], "is a folder")):
            with self.subTest(arguments=arguments):
                self.expect_error([file, *arguments], *words)
        self.expect_error(["--reduced", 1, "--device", "simulated"], "--reduced", ".palpate")

    def test_several_models_and_none_is_chosen(self):
        models = self.path("models.palpate")
        subprocess.run([MAKE_MODEL, models, "2"], capture_output=True, check=True)
        self.expect_error([models], "1 (tools at points", "2 (tools", "--reduced")

    def test_a_model_that_is_damaged(self):
        damaged = self.path("damaged.palpate")
        shutil.copy(self.model, damaged)
        with sqlite3.connect(damaged) as file:
            file.execute("UPDATE reduced_array SET numbers = zeroblob(length(numbers)) "
                         "WHERE name = 'Mass'")
        file.close()
        self.expect_error([damaged], "reduced model 1", "damaged", "Build")

    def test_no_model(self):
        space = self.path("space.palpate")
        subprocess.run([MAKE_MODEL, space, "0", "space"], capture_output=True, check=True)
        self.expect_error([space, "--reduced", 1], "no reduced model")

    def test_recordings_are_made_together_or_not_at_all(self):
        with open(self.path("there-tool1.csv"), "w", encoding="utf-8") as file:
            file.write("something")
        self.expect_error([self.model, *TWO, "--record", self.path("there.csv")], "there-tool1.csv",
                          "already")
        self.assertFalse(os.path.exists(self.path("there-tool0.csv")))

    def test_signals(self):
        for name, with_signal in (("int", signal.SIGINT), ("stop", signal.SIGTSTP)):
            path = self.path(name + ".csv")
            code, output, errors = stopped(
                [self.model, *TWO, "--seconds", 0, "--motion", "tap", "--record", path],
                self.path(name + "-tool0.csv"), with_signal)
            self.assertEqual(code, 0, errors)
            parts = parts_of(output)
            for tool in (0, 1):
                self.check_safety(parts[f"tool {tool}"],
                                  rows_of(self.path(f"{name}-tool{tool}.csv")), BOARD_LIMIT)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

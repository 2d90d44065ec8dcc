# SPDX-License-Identifier: BSD-3-Clause
"""palpate-servo as somebody uses it: runs, safety rules, recording and replay, bad input, signals.

  test_palpate_servo.py <palpate-servo> <palpate_test_make_space>

Nothing here depends on how fast or how busy the machine is.
"""

import os
import re
import signal
import subprocess
import sys
import unittest

from support import (ATTACHED, BOARD_LIMIT, RUNNING, STEP, ProgramTest, number, rows_of, run,
                     sent_force, stopped)

MAKE_SPACE = sys.argv[2]
WORKSPACE = 0.08  # m, its radius


class PalpateServo(ProgramTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.space = cls.path("block.palpate")
        made = subprocess.run([MAKE_SPACE, cls.space], capture_output=True, text=True, check=True)
        cls.corner, cls.middle = map(int, made.stdout.split())

    def touch(self, name, *arguments, limit=BOARD_LIMIT):
        """A run of 1.5 s with a recording of that name. A busy machine may pause it for long."""
        done = run(self.space, "--seconds", 1.5, "--record", self.path(name), "--release-after", 60,
                   *arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        rows = rows_of(self.path(name))
        self.assertEqual(len(rows), number(done.stdout, r"ticks +(\d+) in"))
        self.assertEqual(len(rows), number(done.stdout, r"recording +(\d+) ticks, 0 dropped"))
        self.assertLessEqual(len(rows), 1000 * number(done.stdout, r"ticks +\d+ in ([\d.]+) s") + 1)
        touching = [row for row in rows if int(row["contact"]) == ATTACHED]
        self.assertEqual(len(touching), number(done.stdout, r"(\d+) ticks touching"))
        self.assertGreater(len(touching), 10)
        self.check_safety(done.stdout, rows, limit)
        return done.stdout, rows

    def test_run_and_replay(self):
        # With passivity control one tick that differs would change the damping of all that follow.
        output, rows = self.touch("press.csv", "--no-passivity-control")
        self.assertIn("2 active node(s)", output)
        self.assertIn(f"node {min(self.corner, self.middle)}", output)
        self.assertGreater(number(output, r"largest ([\d.]+) N, limit"), 0.1)
        for line in ("lateness", "interval", "tick", "own work"):
            self.assertRegex(output, rf"{line} +median [\d.]+ us, .*99.9 % [\d.]+ us, largest")
        self.assertEqual(number(output, r"interlock +(\d+) ticks without force"), 0)
        self.assertRegex(output, r"realtime +priority (yes|no), memory locked (yes|no)")
        # It comes down along the inward normal: the tool moves the node into the body.
        inward = [row for row in rows if int(row["contact"]) == ATTACHED][-1]
        force = [float(row) for row in (inward["force_x_N"], inward["force_y_N"],
                                        inward["force_z_N"])]
        moved = [float(inward[f"displacement_{axis}_m"]) for axis in "xyz"]
        self.assertLess(sum(f * u for f, u in zip(force, moved)), 0)

        # The hand rests where its spring of 150 N/m balances the body: not where it wants to be, a
        # quarter of the board's workspace and 5 mm down.
        begin = float(rows[0]["time_s"])
        held = [(float(row["device_position_z_m"]), sent_force(row) or 0) for row in rows
                if float(row["time_s"]) - begin > 1.1 and int(row["contact"]) == ATTACHED]
        wish = -(0.25 * WORKSPACE + 0.005)
        self.assertTrue(any(z - wish > 0.5 * force / 150 > 1e-4 for z, force in held))

        again = run(self.space, "--replay", self.path("press.csv"))
        self.assertEqual(again.returncode, 0, again.stderr)
        # Reports are read some microseconds after a tick begins, and replayed at its beginning: on
        # a busy machine a report may be just too old in one of them.
        self.assertLessEqual(number(again.stdout, r"forces differ in (\d+) ticks"),
                             0.01 * len(rows))
        self.assertEqual(number(again.stdout, r"ticks +(\d+) in"), len(rows))

    def test_limits(self):
        output, rows = self.touch("limited.csv", "--force-limit", 0.05, "--force-scale", 10,
                                  "--motion", "tap", "--node", self.corner, limit=0.05)
        self.assertGreater(number(output, r"limiter +(\d+) ticks by size"), 0)
        self.assertGreater(max(sent_force(row) or 0 for row in rows), 0.04)
        output, rows = self.touch("slow.csv", "--slew-limit", 0.1, "--motion", "tap")
        self.assertGreater(number(output, r"(\d+) by change"), 0)
        for before, row in zip(rows, rows[1:]):
            # After a late tick it may change by as much as in two.
            rise = float(row["force_z_N"]) - float(before["force_z_N"])
            self.assertLessEqual(rise, 0.1 * 2e-3 + 1e-9)

    def test_motions_and_options(self):
        for motion in ("slide", "circle"):
            self.touch(motion + ".csv", "--motion", motion, "--depth", 0.004, "--scale", 0.5,
                       "--method", "trilinear", "--bonded", "--damping", 1, "--coupling", 500,
                       "--no-blending", "--no-passivity-control", "--no-realtime")

    def test_without_a_space_there_is_no_force(self):
        done = run("--device", "simulated", "--seconds", 1.2, "--record", self.path("none.csv"))
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"position +\S+ +\S+ +\S+ m, buttons 0, (ready|stale)")
        self.assertEqual(number(done.stdout, r"largest ([\d.]+) N, limit"), 0)
        self.assertTrue(all(sent_force(row) is None for row in rows_of(self.path("none.csv"))))

    def test_list_and_help(self):
        done = run("--device", "list")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("simulated", done.stdout)
        done = run("--help")
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertIn("--force-limit", done.stdout)

    def test_bad_input(self):
        text = self.path("text.palpate")
        with open(text, "w", encoding="utf-8") as file:
            file.write("no space")
        self.expect_error([], "palpate-servo --help")
        self.expect_error(["--device", "simulated", "--replay", text], "state space")
        self.expect_error([self.path("none.palpate")], "none.palpate")
        self.expect_error([text], "text.palpate")
        for option, value, *words in (
                ("--seconds", "soon", "soon"), ("--seconds", -1, "-1"),
                ("--motion", "dance", "dance", "press, slide, tap"),
                ("--method", "best", "best", "energy-hermite"),
                ("--node", 3, "3", f"{min(self.corner, self.middle)}, "),
                ("--node", -1, "-1"), ("--force-limit", -1, "force limit"),
                ("--slew-limit", 0, "slew limit"), ("--scale", 0, "scale"),
                ("--release-after", 0, "lets go"), ("--dead-man", -2, "dead-man"),
                ("--dead-man", 3, "Button 3", "1 button(s)"), ("--damping", "nan", "damping"),
                ("--coupling", -1, "coupling"),
                ("--depth", 1, "--depth"), ("--depth", "inf", "--depth"),
                ("--scale", 1e-9, "at 6e-11 m"), ("--force-scale", -1, "is -1. Give"),
                ("--blade-friction", -1, "friction of the blade"),
                ("--blade-stiffness", 0, "stiffness before the blade"),
                ("--what", 1, "--what"),
                ("--record", self.path("none/a.csv"), "none/a.csv"),
                ("--record", text, "text.palpate", "already"),
                ("--record", self.folder.name, "is a folder"), ("--record", "/dev/full", "device"),
                ("--replay", self.path("none.csv"), "none.csv"), ("--replay", text, "recording")):
            with self.subTest(option=option, value=value):
                self.expect_error([self.space, option, value], *words)

        self.expect_error([self.space, "--blade"], "stages of a cut")

    def test_a_replay_takes_no_other_settings(self):
        for option in (["--force-limit", 1], ["--method", "trilinear"], ["--bonded"],
                       ["--no-realtime"], ["--device", "list"], ["--record", "again.csv"]):
            self.expect_error([self.space, "--replay", "any.csv", *option], "--replay", option[0])

    def test_without_a_recording_no_device_is_opened(self):
        self.expect_error([self.space, "--device", "ffff:ffff", "--record", self.folder.name],
                          "is a folder")
        path = self.path("unused.csv")
        self.assertEqual(run(self.space, "--device", "ffff:ffff", "--record", path).returncode, 1)
        self.assertFalse(os.path.exists(path))

    def test_no_such_device(self):
        for device in ("ffff:ffff", "/dev/none"):
            done = run(self.space, "--device", device)
            self.assertEqual(done.returncode, 1)
            self.assertIn("There is no haptic device " + device, done.stderr)

    def test_another_scene(self):
        self.touch("scene.csv")
        with open(self.path("scene.csv"), encoding="utf-8") as file:
            text = file.read()
        with open(self.path("other.csv"), "w", encoding="utf-8") as file:
            file.write(re.sub(r"scene=\w+", "scene=0123", text))
        self.expect_error([self.space, "--replay", self.path("other.csv")], "another scene")

    def stopped(self, name, with_signal):
        """A run without an end that is sent a signal when it touches."""
        path = self.path(name)
        return stopped([self.space, "--seconds", 0, "--motion", "tap", "--record", path], path,
                       with_signal)

    def test_signals(self):
        for name, with_signal in (("int.csv", signal.SIGINT), ("term.csv", signal.SIGTERM),
                                  ("hup.csv", signal.SIGHUP), ("quit.csv", signal.SIGQUIT),
                                  ("stop.csv", signal.SIGTSTP)):
            code, output, errors = self.stopped(name, with_signal)
            self.assertEqual(code, 0, errors)
            rows = rows_of(self.path(name))
            self.assertEqual(len(rows), number(output, r"ticks +(\d+) in"))
            self.check_safety(output, rows, BOARD_LIMIT)

    def test_a_recording_outlives_kill(self):
        code, _, _ = self.stopped("kill.csv", signal.SIGKILL)
        self.assertEqual(code, -signal.SIGKILL)
        again = run(self.space, "--replay", self.path("kill.csv"))
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertGreater(number(again.stdout, r"ticks +(\d+) in"), 100)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])

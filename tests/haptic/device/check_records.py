#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""What the records of a run of the device test must show.

    check_records.py <records>

Board and program have written down what happened, a line a record; board.h, user.h and body.h say
what each holds. Prints a line for each thing that is required, and ends with 1 if one is not so.
"""

import bisect
import math
import sys
from collections import defaultdict
from pathlib import Path
from typing import NamedTuple

# All times are in µs.
TICK = 1000
# ServoOptions::stale_after: an older report is answered by zero, two ticks later at the latest.
STALE_AFTER = 5 * TICK
NO_FORCE_AFTER = STALE_AFTER + 2 * TICK
# ServoOptions::release_after: without a fresh report for so long the tool lets go.
RELEASE_AFTER = 20 * TICK
# The loop is back, or an unplug is noticed, this soon.
SOON = 5 * TICK
# From the button by way of the program, which looks each ms, to the last force of the loop.
STOP_AFTER = 10 * TICK
# Zero force after the host's program was killed or stopped.
NO_FORCE_WITHOUT_HOST = 25 * TICK
# DeviceSession::kRetryPause, and two ticks.
RETRY_AFTER = 7 * TICK
# ServoOptions::stop_timeout.
STOP_TIMEOUT = 200 * TICK
# The kernel waits 5 s for a feature report; what the program has begun meanwhile comes before it.
OPEN_AFTER = {"unplug": 100 * TICK, "stall": 5500 * TICK}

NUM_STROKES = 14
# Of a stroke: within so long the stylus has come down to the body.
IN_THE_BODY = 140 * TICK
# With these nothing that is fresh comes from a board that is there.
SILENT = ("device_pause", "wrong_size", "frozen", "empty", "away")
# After these there is no force until the tool was outside of the body.
RELEASING = (*SILENT, "host_pause", "write_error")
# The ways in which the host's program ends or stops.
WAYS = {"kill": "SIGKILL", "host_pause": "SIGSTOP", "crash": "SIGSEGV", "interrupt": "Ctrl+C"}


class Sent(NamedTuple):
    """An input report: what the board measured."""
    time: int
    counter: int
    position: tuple
    how: str


class Force(NamedTuple):
    """A force report that came to the board."""
    time: int
    counter: int
    counts: tuple

    def is_zero(self):
        return self.counts == (0, 0, 0)


class Tick(NamedTuple):
    """Of the loop: when it began, and the reports that it read."""
    time: int
    counters: tuple


class Span(NamedTuple):
    begin: int
    end: int

    def __contains__(self, time):
        return self.begin <= time <= self.end

    def of(self, records):
        return [record for record in records if record.time in self]


class Records:
    """Of one script."""

    def __init__(self, text):
        lines = self.lines = defaultdict(list)
        for line in text.splitlines():
            kind, *values = line.split()
            lines[kind].append(values)
        self.sent = [Sent(int(t), int(c), (int(x), int(y), int(z)), how)
                     for t, c, x, y, z, how in lines["in"]]
        self.whole = [s for s in self.sent if s.how == "whole"]
        self.forces = [Force(int(t), int(c), (int(x), int(y), int(z)))
                       for t, c, x, y, z, _, _ in lines["out"]]
        self.measured_at = {s.counter: s.time for s in reversed(self.whole)}
        self.ticks = [Tick(int(t), tuple(map(int, counters)))
                      for t, _, _, *counters in lines["tick"]]
        self.faults = {fault: Span(int(t), next(int(u) for u, f in lines["end"] if f == fault))
                       for t, fault in lines["begin"]}
        # From an opening to a closing; those in which the loop has run.
        closed = [int(t) for t, in lines["close"]] + [sys.maxsize]
        uses = [Span(int(t), next(u for u in closed if u > int(t))) for t, in lines["open"]]
        self.sessions = [use for use in uses if use.of(self.forces)]

    def times(self, kind):
        return [int(values[0]) for values in self.lines[kind]]


class Body:
    """The block: h = K t + a |t|² t at each node, and the weights of a point of its top."""

    def __init__(self, lines):
        self.nodes = []
        for values in lines["node"]:
            x, y, _, xx, xy, xz, yy, yz, zz = map(float, values)
            self.nodes.append(((x, y), ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))))
        self.triangles = [tuple(map(int, values)) for values in lines["triangle"]]
        self.stiffening, = (float(value) for value, in lines["stiffening"])
        self.position_unit, self.force_unit = map(float, lines["units"][0])
        self.scale, *rotation = map(float, lines["workspace"][0])
        self.rotation = [rotation[0:3], rotation[3:6], rotation[6:9]]

    def place(self, counts):
        """Of the tool in the scene [3], m."""
        return times(self.rotation, [self.scale * self.position_unit * c for c in counts])

    def weights(self, point):
        """The nodes of the triangle of the top that holds the point, with their weights."""
        x, y = point[:2]
        for triangle in self.triangles:
            (ax, ay), (bx, by), (cx, cy) = (self.nodes[n][0] for n in triangle)
            area = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
            b = ((x - ax) * (cy - ay) - (cx - ax) * (y - ay)) / area
            c = ((bx - ax) * (y - ay) - (x - ax) * (by - ay)) / area
            if min(b, c, 1 - b - c) >= 0:
                return zip(triangle, (1 - b - c, b, c))
        raise ValueError(f"{point} is not above the body")

    def force(self, anchor, place):
        """On a tool that came in at the anchor and is at the place, in counts of the device [3]."""
        t = [p - a for p, a in zip(place, anchor)]
        square = sum(v * v for v in t)
        held = [0.0, 0.0, 0.0]
        for node, weight in self.weights(anchor):
            linear = times(self.nodes[node][1], t)
            for k in range(3):
                held[k] += weight * (linear[k] + self.stiffening * square * t[k])
        back = zip(*self.rotation)  # of a rotation the transpose is the inverse
        return [-value / self.force_unit for value in times(back, held)]


def times(matrix, vector):
    return [sum(m * v for m, v in zip(row, vector)) for row in matrix]


def expected_forces(records, body):
    """For each force report what the input report that it names calls for, in counts; None where
    there is no such report.

    The tool touches where it is first seen inside after it was seen outside, at the nearest point
    of the top, and lets go where it is outside and would be pulled, and after RELEASE_AFTER without
    a fresh report. A new loop, and one that has let go for that, must see it outside first.
    """
    position = {s.counter: s.position for s in records.whole}
    # What the guardian sends answers nothing.
    pause = records.faults["host_pause"]
    guardians = Span(pause.begin + TICK, pause.end + SOON)
    expected = []
    for session in records.sessions:
        was_outside, anchor, fresh_at = False, None, math.inf
        for force in session.of(records.forces):
            if force.counter not in position or force.time in guardians:
                expected.append(None)
                continue
            if force.time - fresh_at > RELEASE_AFTER:
                was_outside, anchor = False, None
            if force.time - records.measured_at[force.counter] <= STALE_AFTER:
                fresh_at = force.time
            place, felt = body.place(position[force.counter]), [0.0, 0.0, 0.0]
            if place[2] <= 0 and was_outside:
                anchor, was_outside = (place[0], place[1], 0.0), False
            if anchor:
                felt = body.force(anchor, place)
                if place[2] > 0 and felt[2] < 0:
                    anchor, felt = None, [0.0, 0.0, 0.0]
            was_outside |= anchor is None and place[2] > 0
            expected.append(felt)
    return expected


def matches(force, expected):
    """What is sent is cut to whole counts, towards zero."""
    return expected is not None and all(-1.001 < abs(f) - abs(e) < 0.001 and f * e >= 0
                                        for f, e in zip(force.counts, expected))


class Requirements:
    failed = False

    def __call__(self, holds, what):
        print("ok    " if holds else "FAILED", what)
        self.failed |= not holds


def check(path):
    """Exit status."""
    require = Requirements()
    faults, _, trials = Path(path).read_text().partition("trials\n")
    records = Records(faults)
    strokes = records.times("stroke")
    require(records.lines["ended"] == [["0"]] and len(strokes) == NUM_STROKES,
            f"the script went to its end ({len(strokes)} strokes), and the program too")
    if not require.failed:
        body = Body(records.lines)
        check_use(require, records, body)
        check_reports(require, records)
        check_forces(require, records, body)
        check_times(require, records)
        check_faults(require, records)
        check_trials(require, Records(trials))
    return 1 if require.failed else 0


def check_use(require, records, body):
    """So that the rest is not said of nothing."""
    paths = {path for _, _, path in records.lines["opened"]}
    require(paths == {"/dev/hidraw1"}, f"the board was opened, the mouse not: {paths}")
    counted = records.lines["counted"]
    require(counted and all(values[4:] == ["1", "1"] for values in counted),
            "the loop had real-time priority and locked memory")
    strokes = records.times("stroke")
    touched = [any(not f.is_zero() for f in Span(begin, end).of(records.forces))
               for begin, end in zip(strokes, strokes[1:] + [sys.maxsize])]
    largest = max(math.hypot(*f.counts) for f in records.forces) * body.force_unit
    require(largest > 1 and all(touched),
            f"each stroke touched; the largest force was {largest:.2f} N")


def check_reports(require, records):
    read = {counter for tick in records.ticks for counter in tick.counters}
    # Of a pause of the host, and of what came before the loop first read, the kernel keeps only the
    # oldest.
    pause = records.faults["host_pause"]
    not_kept = Span(pause.begin, pause.end + TICK)
    wanted = []
    for session in records.sessions:
        ticks = session.of(records.ticks)
        wanted += Span(ticks[0].time + TICK, ticks[-1].time).of(records.whole) if ticks else []
    wanted = [s for s in wanted if s.time not in not_kept]
    lost = [s for s in wanted if s.counter not in read]
    require(wanted and not lost, f"lost reports: {len(lost)} of {len(wanted)} {lost[:3]}")
    short, long = (sum(s.how == how for s in records.sent) for how in ("short", "long"))
    bad = sum(int(values[0]) for values in records.lines["counted"])
    # Newer kernels keep the short ones to themselves.
    require(bad in (long, short + long), f"{short} short and {long} long reports: {bad} refused")


def check_forces(require, records, body):
    forces, faults = records.forces, records.faults
    headers = {tuple(values[5:]) for values in records.lines["out"]}
    require(headers == {("3", "10")}, f"number and size of force reports: {headers}")

    # Zero is right while nothing fresh comes, as the last word, and before the first report. The
    # loop counts the age of a report from when it last read nothing, which was up to a tick before
    # the board sent it.
    sent_at = [s.time for s in records.whole]
    newest = {name: sent_at[bisect.bisect_right(sent_at, faults[name].begin) - 1]
              for name in RELEASING}
    stale = [Span(newest[name] + STALE_AFTER - TICK, faults[name].end + SOON)
             for name in RELEASING]
    last = {session.of(forces)[-1] for session in records.sessions}
    unmatched = [(f, e) for f, e in zip(forces, expected_forces(records, body))
                 if not matches(f, e) and not (f.is_zero() and (
                     e is None or f in last or any(f.time in span for span in stale)))]
    require(not unmatched, f"unmatched forces: {len(unmatched)} of {len(forces)} {unmatched[:3]}")

    after_pause = Span(faults["host_pause"].begin, faults["host_pause"].end + 2 * TICK)
    behind = [(records.whole[newest - 1].counter - f.counter) % 0x10000 for f, newest in
              ((f, bisect.bisect_right(sent_at, f.time)) for f in forces)
              if newest > 0 and f.time not in after_pause]
    share = sum(reports <= 1 for reports in behind) / len(behind)
    require(share >= 0.99, f"forces that answer the newest or the previous report: {share:.2%}")

    oldest = max(f.time - records.measured_at.get(f.counter, 0) for f in forces if not f.is_zero())
    require(oldest <= NO_FORCE_AFTER,
            f"oldest report that was answered by a force: {oldest / 1000:.1f} ms")


def check_times(require, records):
    pauses = [records.faults[name] for name in ("host_pause", "write_error")]
    for session in records.sessions:
        at = [f.time for f in session.of(records.forces)]
        if len(at) < 2:
            require(False, "a loop ended after one tick")
            continue
        # The last force comes when it ends, not by the clock.
        gaps = [b - a for a, b in zip(at, at[1:-1])
                if not any(pause.begin - TICK <= b and a <= pause.end + RETRY_AFTER
                           for pause in pauses)]
        require(max(gaps) < 2 * TICK, f"longest time without a force report: {max(gaps)} µs")
        rate = 1e6 * len(gaps) / sum(gaps)
        require(990 <= rate <= 1010, f"forces a second: {rate:.1f} in {len(gaps)} ticks")


def check_faults(require, records):
    forces, faults = records.forces, records.faults
    for name in SILENT:
        fault = faults[name]
        during = Span(fault.begin + NO_FORCE_AFTER, fault.end).of(forces)
        least = 0.9 * (fault.end - fault.begin - NO_FORCE_AFTER) / TICK
        require(len(during) >= least and all(f.is_zero() for f in during),
                f"{name}: zero force from {NO_FORCE_AFTER / TICK:.0f} ms on, {len(during)} times")
    pause = faults["host_pause"]
    require(off_after(records, pause.begin, pause.end) <= NO_FORCE_WITHOUT_HOST,
            "host_pause: the guardian sets the motors to zero")
    # Of what was kept of it the loop's records hold the newest few; check_forces() has seen that
    # none of them was answered by a force.
    waited = max(tick.time - records.measured_at[counter] for tick in records.ticks
                 for counter in tick.counters if pause.end < tick.time < pause.end + SOON)
    require(waited > 100 * TICK, f"host_pause: reports had waited for {waited / 1000:.0f} ms")
    doubled = faults["doubled"].of(forces)
    require(doubled and not any(f.is_zero() for f in doubled), "doubled: nothing is felt of it")
    strokes = records.times("stroke")
    for name in RELEASING:
        rest = Span(faults[name].end, min(t for t in strokes if t > faults[name].end))
        after = rest.of(forces)
        require(after and all(f.is_zero() for f in after),
                f"{name}: zero force in the rest of the stroke, {len(after)} times")
        touched = soonest(rest.end, (f.time for f in forces if not f.is_zero()))
        require(touched <= IN_THE_BODY, f"{name}: force again {touched} µs after the next began")
    failing = faults["write_error"]
    require(not Span(failing.begin + 2 * TICK, failing.end).of(forces), "write_error: writes fail")
    before = [f for f in forces if f.time < failing.begin + 2 * TICK][-1]
    first = next(f for f in forces if f.time > failing.end)
    require(not before.is_zero() and first.is_zero() and first.time <= failing.end + RETRY_AFTER,
            f"write_error: zero arrives {first.time - failing.end} µs after writes no longer fail")
    away = faults["away"]
    sides = [soonest_of(records.whole, away.begin - 2 * TICK), soonest_of(records.whole, away.end)]
    moved = math.dist(*(s.position for s in sides))  # in µm
    require(moved >= 50_000, f"away: silent for {1e-6 * (away.end - away.begin):.1f} s, moved "
                           f"{1e-4 * moved:.1f} cm")
    # By the loop: the program that looks at it has no priority, and comes when the kernel lets it.
    gone = [int(time) for time, state, *_ in records.lines["tick"] if state == "gone"]
    for name, limit in OPEN_AFTER.items():
        # A tick has the time of its beginning, and may be the one in which the device goes.
        after = soonest(faults[name].begin - TICK, gone) - TICK
        require(after <= SOON, f"{name}: noticed after {after} µs")
        after = soonest(faults[name].end, records.times("opened"))
        require(after <= limit, f"{name}: open again {after} µs after it came back")
    for name in ("stop", "leave"):
        button = faults[name].begin
        session = next(s for s in records.sessions if button in s)
        last = session.of(forces)[-1]
        late = [f for f in Span(button + STOP_AFTER, session.end).of(forces) if not f.is_zero()]
        require(last.is_zero() and not late,
                f"{name}: the last force is zero, {last.time - button} µs after the button")
    require(records.lines["stopped"], "stop: it was stopped")
    for _, took, ended in records.lines["stopped"]:
        require(ended == "1" and int(took) <= STOP_TIMEOUT, f"stop: took {took} µs")


def check_trials(require, records):
    strokes = records.times("stroke") + [sys.maxsize]
    faults = [(name, int(begin)) for begin, name in records.lines["begin"] if name in WAYS]
    number = len(faults) // len(WAYS)
    require(number > 0 and records.lines["ended"] == [["0"]], f"trials: {number} of each")
    after = {name: [] for name in WAYS}
    for name, begin in faults:
        end = next(at for at in strokes if at > begin)
        held = [f for f in records.forces if f.time < begin][-1]
        back = [f for f in Span(end, end + 180 * TICK).of(records.forces) if not f.is_zero()]
        worked = not held.is_zero() and back
        after[name].append(off_after(records, begin, end) if worked else math.inf)
    for name, times_of in after.items():
        good = [t for t in times_of if t <= NO_FORCE_WITHOUT_HOST]
        times_of.sort()
        require(len(good) == len(times_of) == number,
                f"{WAYS[name]}: the force was zero within {NO_FORCE_WITHOUT_HOST / TICK:.0f} ms, "
                f"and until the tool was outside, {len(good)} of {number} times; after "
                f"{times_of[0] / TICK:.2f} to {times_of[-1] / TICK:.2f} ms, median "
                f"{times_of[number // 2] / TICK:.2f} ms")


def off_after(records, begin, end):
    """When the motors had zero force for good between two times, after the first of them, µs."""
    forces = Span(begin, end).of(records.forces)
    last = max((f.time for f in forces if not f.is_zero()), default=begin)
    return soonest(last, (f.time for f in forces if f.is_zero())) + last - begin


def soonest_of(records, since):
    return next(record for record in records if record.time > since)


def soonest(since, at):
    return min((t - since for t in at if t > since), default=math.inf)


if __name__ == "__main__":
    sys.exit(check(sys.argv[1]))

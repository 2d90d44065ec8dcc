# SPDX-License-Identifier: BSD-3-Clause
"""For scripts inside ParaView's window: what a person does and reads in the dock Palpate."""

import contextlib
import os
import re
import time
import traceback

from paraview.simple import FindSource

from qt import Button, QTest, application, part, wait, wait_until, window
from support import delete_all


def wait_for(condition, what, time_out=60):
    wait_until(condition, lambda: f"{what}; {part('state').text()}", time_out)


def number(name):
    """The first number of a label."""
    return float(re.search(r"-?[\d.]+", part(name).text()).group())


def runs():
    return part("start").text() == "Stop"


def click_start(device="Simulated hand"):
    assert not runs()
    part("device").setCurrentText(device)
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert runs(), part("message").text()


def click_stop():
    assert runs()
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert not runs()


def clear(size):
    """Nothing is open any more, in a window of that size."""
    delete_all()
    window.resize(size)
    wait(0.2)


def run_in_turn(scripts):
    """One after another in the same window, those of a table that PALPATE_INTERACTOR_RUN names; and
    quits. What fails is printed, and nothing is run after it."""
    size = window.size()
    try:
        for i, name in enumerate(os.environ["PALPATE_INTERACTOR_RUN"].split(",")):
            if i > 0:
                clear(size)
            scripts[name]()
    except BaseException:
        traceback.print_exc()
        window.grab().save("failed.png")
    application.quit()


def touches():
    return part("state").text().endswith(", touching")


def presses():
    return part("state").text().endswith(", pressing")


def touch_filter():
    return FindSource("TouchStateSpace1")


def said(view):
    """The text in the view."""
    actors = view.GetClientSideObject().GetNonCompositedRenderer().GetActors2D()
    texts = [actors.GetItemAsObject(i) for i in range(actors.GetNumberOfItems())]
    return "".join(text.GetInput() or "" for text in texts
                   if text.IsA("vtkTextActor") and text.GetVisibility())


def work():
    """Of this process, s: what this thread has spent on a processor, and what all its threads have
    waited for one."""
    waited = 0
    for task in os.listdir("/proc/self/task"):
        with contextlib.suppress(FileNotFoundError):  # It has ended.
            with open(f"/proc/self/task/{task}/schedstat", encoding="ascii") as figures:
                waited += 1e-9 * int(figures.read().split()[1])
    return time.thread_time(), waited


def unfold(name):
    """Opens one of the dock's folds."""
    part(name + "Fold").setProperty("checked", True)
    assert part(name).isVisible()


def measure_frames(view, seconds):
    """Prints what a frame takes on a processor, s; the share of the time in which threads have
    waited for one; frames in a second."""
    window_of_view = view.GetRenderWindow()
    frames = []
    observer = window_of_view.AddObserver("EndEvent", lambda *_: frames.append(0))
    begin, (worked, waited) = time.monotonic(), work()
    wait(seconds)
    elapsed, (worked_then, waited_then) = time.monotonic() - begin, work()
    window_of_view.RemoveObserver(observer)
    print("frame", (worked_then - worked) / len(frames), (waited_then - waited) / elapsed,
          len(frames) / elapsed)

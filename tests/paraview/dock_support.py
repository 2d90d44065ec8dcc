# SPDX-License-Identifier: BSD-3-Clause
"""For scripts inside ParaView's window: what a person does and reads in the dock Palpate."""

import re

from paraview.simple import FindSource

from qt import Button, QTest, part, wait_until


def wait_for(condition, what):
    wait_until(condition, lambda: f"{what}; {part('state').text()}")


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


def touches():
    return part("state").text().endswith(", touching")


def touch_filter():
    return FindSource("TouchStateSpace1")


def said(view):
    """The text in the view."""
    actors = view.GetClientSideObject().GetNonCompositedRenderer().GetActors2D()
    texts = [actors.GetItemAsObject(i) for i in range(actors.GetNumberOfItems())]
    return "".join(text.GetInput() or "" for text in texts
                   if text.IsA("vtkTextActor") and text.GetVisibility())

# SPDX-License-Identifier: BSD-3-Clause
"""Runs inside ParaView's window, touches a reduced body with the two devices of fake_hid.cpp as
PALPATE_INTERACTOR_RUN says, and quits; test_devices.py reads what it prints. Only what the devices
were sent counts."""

import ctypes
import os
import signal
import struct
import sys

import numpy
from paraview.simple import Delete, FindSource, OpenDataFile, Show

sys.path.append(os.path.join(os.environ["PALPATE_SOURCE_DIR"], "tests", "paraview"))
from dock_support import click_start, run_in_turn, runs, touch_filter, touches, wait_for
from hands_script import CORNERS, LENGTH, WIDTH, cell, choose_device, model_of_block
from qt import Button, QtCore, QTest, part, wait

FOLDER = os.environ["PALPATE_FAKE_HID"]
NAMES = ("buttons", "plain")
TOOL, DEVICE, FORCE, STATE = range(4)
# The device's axes x, y, z in the scene, where they do not turn with the camera.
AXES = numpy.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]], dtype=float).T
CENTRE = numpy.array([LENGTH, WIDTH, WIDTH]) / 2
# Of the workspace, as the dock lays it around the body.
SCALE = 1.3 * numpy.linalg.norm(CENTRE) / 0.08
OUT = numpy.array([0.03, 0, 0.02])
IN = numpy.array([0.003, 0, 0.004])
REPORT = 10  # bytes; the force is in those from 3 to 8


def move(name, tool, offset, buttons=0):
    """Takes the handle to a place near a tool, m in the scene."""
    place = AXES.T @ (numpy.array(CORNERS[tool]) + offset - CENTRE) / SCALE
    with open(os.path.join(FOLDER, name + ".hand"), "r+b") as hand:
        hand.write(struct.pack("4d", *place, buttons))


def sent(name):
    """The forces that a device was sent so far, in its units [number × 3]."""
    path = os.path.join(FOLDER, name + ".sent")
    if not os.path.exists(path):
        return numpy.zeros((0, 3))
    data = numpy.fromfile(path, dtype=numpy.uint8)
    data = data[:len(data) // REPORT * REPORT].reshape(-1, REPORT)
    return numpy.ascontiguousarray(data[:, 3:9]).view("<i2")


def forces(name, seconds):
    """How many of the reports ask for a force in the next time."""
    before = len(sent(name))
    wait(seconds)
    after = sent(name)[before:]
    assert len(after) > 0, f"{name} is sent nothing"
    return int((after != 0).any(axis=1).sum())


def device_named(name):
    devices = part("deviceOfTool0")
    texts = [devices.itemText(i) for i in range(devices.count())]
    return next(text for text in texts if text.startswith(os.path.join(FOLDER, name) + " "))


def prepare():
    for name in NAMES:
        open(os.path.join(FOLDER, name), "wb").close()
        open(os.path.join(FOLDER, name + ".hand"), "wb").close()
    move("buttons", 0, OUT)
    move("plain", 1, OUT)
    model_of_block()
    QTest.mouseClick(part("refresh"), Button.LeftButton)
    part("followsCamera").setChecked(False)


def start(first, second):
    for tool, device in enumerate((first, second)):
        choose_device(tool, device)
    QTest.mouseClick(part("start"), Button.LeftButton)


def stop():
    assert runs()
    QTest.mouseClick(part("start"), Button.LeftButton)
    assert not runs()


def dead_man():
    """*Only while the button is held*: no device gets a force that nobody commands."""
    prepare()
    buttons, plain = device_named("buttons"), device_named("plain")
    choose_device(0, buttons)
    part("needsButton").setChecked(True)
    start(buttons, plain)
    assert not runs() and "motors and no button" in part("message").text(), part("message").text()
    start("None", plain)
    assert not runs() and "motors and no button" in part("message").text(), part("message").text()
    for name in NAMES:
        assert not (sent(name) != 0).any()
    # Grey, as with the mouse, it is not given up.
    start("Mouse", "None")
    assert runs(), part("message").text()
    choose_device(1, plain)
    assert "motors and no button" in part("message").text(), part("message").text()
    wait_for(lambda: cell(1, STATE) == "free", "no device has tool 1")
    stop()
    start(buttons, "None")
    assert runs(), part("message").text()
    wait(0.3)
    move("buttons", 0, IN)
    assert forces("buttons", 1) == 0, "nobody holds the button"
    move("buttons", 0, OUT, 1)
    wait(0.3)
    move("buttons", 0, numpy.zeros(3), 3)
    wait(0.3)
    move("buttons", 0, IN, 3)
    wait_for(lambda: forces("buttons", 0.2) > 0, "it is held")
    move("buttons", 0, IN, 2)
    wait(0.1)
    assert forces("buttons", 0.5) == 0, "the button was let go"
    # A device without a button beside it, while that touches.
    choose_device(1, plain)
    assert "motors and no button" in part("message").text(), part("message").text()
    assert runs() and not (sent("plain") != 0).any()
    stop()
    # Without the switch it touches, and no more from the moment on when that is set.
    part("needsButton").setChecked(False)
    start("None", plain)
    assert runs(), part("message").text()
    wait(0.3)
    move("plain", 1, numpy.zeros(3))
    wait(0.3)
    move("plain", 1, IN)
    wait_for(lambda: forces("plain", 0.2) > 0, "it holds its tool")
    part("needsButton").setChecked(True)
    wait_for(lambda: "motors and no button" in part("message").text(), "it is told")
    last = len(sent("plain"))
    wait(0.5)
    assert len(sent("plain")) == last and not sent("plain")[-1].any(), "zero is the last"
    stop()
    part("needsButton").setChecked(False)
    print("dead_man 1")


def throw_at(source):
    """When it is next modified, as a frame does."""
    address = int(source.GetClientSideObject().__this__.split("_")[1], 16)
    thrower = ctypes.CDLL(os.environ["PALPATE_THROWER"])
    thrower.palpate_throw_once(ctypes.c_void_p(address))


def failing():
    """What a frame throws ends the touch with zero force and is said, and the window lives on."""
    prepare()
    plain = device_named("plain")
    start("None", plain)
    assert runs(), part("message").text()
    wait(0.3)
    move("plain", 1, numpy.zeros(3))
    wait(0.3)
    move("plain", 1, IN)
    wait_for(lambda: forces("plain", 0.2) > 0, "it holds its tool")
    throw_at(FindSource("TouchReducedModel1"))
    move("plain", 1, 2 * IN)
    wait_for(lambda: not runs(), "it ends")
    assert "thrown by a test" in part("message").text(), part("message").text()
    assert not sent("plain")[-1].any(), "zero is the last"
    Delete(FindSource("TouchReducedModel1"))
    start("None", "Simulated hand")
    wait_for(lambda: cell(1, STATE) == "running, held", "the window goes on")
    stop()
    Show(OpenDataFile(os.path.abspath("block.palpate")))
    wait_for(lambda: part("space").count() == 2, "the dock knows of it")
    part("space").setCurrentIndex(1)
    click_start()
    wait_for(touches, "the hand presses")
    throw_at(touch_filter())
    wait_for(lambda: not runs(), "it ends")
    assert "thrown by a test" in part("message").text(), part("message").text()
    print("failing 1")


def crash():
    """The main thread runs into a fault again and again and the program does not end: the loop of
    the device lives, and sends zero."""
    prepare()
    signal.signal(signal.SIGSEGV, lambda *_: None)
    start("None", device_named("plain"))
    assert runs(), part("message").text()
    wait(0.3)
    move("plain", 1, numpy.zeros(3))
    wait(0.3)
    move("plain", 1, IN)
    wait_for(lambda: forces("plain", 0.2) > 0, "it holds its tool")
    # Past ParaView, which may keep what a script prints until the window handles events again.
    os.write(1, f"\nreports {len(sent('plain'))}\n".encode())
    ctypes.memset(0, 0, 1)


# In the loop of events, as what a person does.
QtCore.QTimer.singleShot(300, lambda: run_in_turn(
    {"dead_man": dead_man, "failing": failing, "crash": crash}))

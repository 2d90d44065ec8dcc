# SPDX-License-Identifier: BSD-3-Clause
"""For scripts inside ParaView's window: Qt in Python, of the version that the window has loaded,
and what a person does there. Enumerators are written with their scope, which both versions know:
Button.LeftButton."""

import re
import time
import traceback

with open("/proc/self/maps", encoding="utf-8") as maps:
    QT_6 = "libQt6Core" in maps.read()
if QT_6:
    from PyQt6 import QtCore, QtGui, QtWidgets
    from PyQt6.QtOpenGLWidgets import QOpenGLWidget
    from PyQt6.QtTest import QTest
else:
    from PyQt5 import QtCore, QtGui, QtWidgets
    from PyQt5.QtTest import QTest
    QOpenGLWidget = QtWidgets.QOpenGLWidget

Button = QtCore.Qt.MouseButton
Modifier = QtCore.Qt.KeyboardModifier
Event = QtCore.QEvent.Type

application = QtWidgets.QApplication.instance()
window = next(w for w in application.topLevelWidgets() if w.objectName() == "pqClientMainWindow")
# Without the plugin PalpateInteractor there is none.
dock = window.findChild(QtWidgets.QDockWidget, "pqPalpateInteractorDock")


def part(name):
    """A widget of the dock."""
    return dock.findChild(QtWidgets.QWidget, name)


def canvas():
    """What is drawn on in the view. Looking through all of the window's thousands of objects would
    take longer than drawing; the views are in its middle."""
    return max(window.centralWidget().findChildren(QOpenGLWidget),
               key=lambda widget: widget.width() * widget.height())


def display(view, place):
    """Where a place of the scene is seen in a view: pixels from its lower left corner."""
    renderer = view.GetRenderer()
    renderer.SetWorldPoint(*place, 1)
    renderer.WorldToDisplay()
    return [round(c) for c in renderer.GetDisplayPoint()[:2]]


def pixel_of(view, place):
    """The same from the upper left corner, as Qt has it."""
    x, y = display(view, place)
    return QtCore.QPoint(x, canvas().height() - 1 - y)


def pixel_of_node(view, touch):
    """Where the active node of a filter TouchStateSpace is seen."""
    place = touch.FieldData["ActivePosition"]
    return pixel_of(view, [place.GetRange(axis)[0] for axis in range(3)])


def send(kind, at, button=Button.LeftButton, buttons=Button.LeftButton,
         modifiers=Modifier.NoModifier):
    """An event of the mouse in the view."""
    application.sendEvent(canvas(), QtGui.QMouseEvent(
        kind, QtCore.QPointF(at), QtCore.QPointF(canvas().mapToGlobal(at)), button, buttons,
        modifiers))


def drag(start, step, count):
    """Presses the left button there, and moves the mouse.
    @returns where the button is still pressed."""
    send(Event.MouseButtonPress, start)
    wait(0.3)
    for i in range(1, count + 1):
        send(Event.MouseMove, start + i * step, Button.NoButton)
        wait(0.02)
    return start + count * step


def click(at):
    send(Event.MouseButtonPress, at)
    send(Event.MouseButtonRelease, at, buttons=Button.NoButton)


def turn_wheel(at, notches=1):
    """Away from the person, with the left button held."""
    for _ in range(abs(notches)):
        application.sendEvent(canvas(), QtGui.QWheelEvent(
            QtCore.QPointF(at), QtCore.QPointF(canvas().mapToGlobal(at)), QtCore.QPoint(),
            QtCore.QPoint(0, 120 if notches > 0 else -120), Button.LeftButton,
            Modifier.NoModifier, QtCore.Qt.ScrollPhase.NoScrollPhase, False))


def press_escape(widget):
    """As the keyboard does, through the widget's window."""
    QTest.keyClick(widget.window().windowHandle(), QtCore.Qt.Key.Key_Escape)


def wait(seconds):
    """Lets the window live."""
    loop = QtCore.QEventLoop()
    QtCore.QTimer.singleShot(round(1000 * seconds), loop.quit)
    # PyQt 5 has exec_ for a word that Python 2 kept for itself.
    (loop.exec if QT_6 else loop.exec_)()


def wait_until(condition, what, time_out=60):
    end = time.monotonic() + time_out
    while not condition():
        said = what() if callable(what) else what
        assert time.monotonic() < end, f"waited in vain: {said}"
        wait(0.05)


def action(name):
    """One of the view's toolbar."""
    kind = QtGui.QAction if QT_6 else QtWidgets.QAction
    return window.findChild(kind, name)


def menu(*path):
    """Activates an entry of the menu bar, by the words that are seen."""
    entries = window.menuBar().actions()
    for word in path:
        found = [entry for entry in entries if re.sub(r"&|…|\.\.\.", "", entry.text()) == word]
        assert found, (word, [entry.text() for entry in entries])
        if found[0].menu():
            found[0].menu().aboutToShow.emit()
            entries = found[0].menu().actions()
    found[0].trigger()


def dialogs():
    """Those that are open."""
    return [w for w in application.topLevelWidgets()
            if w.isVisible() and isinstance(w, QtWidgets.QDialog)]


def in_dialog(act):
    """When the next dialog is open, act(dialog)."""
    def look():
        found = dialogs()
        if not found:
            QtCore.QTimer.singleShot(100, look)
            return
        try:
            act(found[0])
        except BaseException:  # PyQt would abort the program
            traceback.print_exc()
            found[0].reject()
    QtCore.QTimer.singleShot(100, look)


def open_file(path):
    """File > Open…, and the name in ParaView's dialog."""
    def choose(dialog):
        names = [line for line in dialog.findChildren(QtWidgets.QLineEdit)
                 if line.objectName() in ("EntityName", "FileName")]
        names[0].setText(path)
        dialog.findChild(QtWidgets.QPushButton, "OK").click()
    in_dialog(choose)
    menu("File", "Open")


def shown_properties(name):
    """Its editors in the panel Properties."""
    panel = window.findChild(QtWidgets.QWidget, "propertiesPanel")
    return [w for w in panel.findChildren(QtWidgets.QWidget, name) if w.isVisibleTo(panel)]


def is_shown(name):
    return bool(shown_properties(name))


def property_widget(name, kind):
    """The editor of a property in the panel Properties."""
    shown = shown_properties(name)
    assert shown, f"no property {name} is shown"
    return shown[0].findChild(kind)


def write(name, text):
    """Types into a property of numbers or of words."""
    line = property_widget(name, QtWidgets.QLineEdit)
    line.selectAll()
    QTest.keyClicks(line, text)
    line.editingFinished.emit()


def choose(name, text):
    """Chooses from a property's list."""
    box = property_widget(name, QtWidgets.QComboBox)
    index = box.findText(text)
    assert index >= 0, (name, [box.itemText(i) for i in range(box.count())])
    box.setCurrentIndex(index)
    box.activated.emit(index)


def apply():
    wait(0.1)
    window.findChild(QtWidgets.QPushButton, "Accept").click()
    wait(0.1)

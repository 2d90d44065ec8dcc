# SPDX-License-Identifier: BSD-3-Clause
"""Qt in Python, for scripts inside ParaView's window: of the version that the window has loaded.
Enumerators are written with their scope, which both know: Button.LeftButton."""

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

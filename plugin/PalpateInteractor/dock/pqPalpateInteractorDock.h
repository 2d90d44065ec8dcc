// SPDX-License-Identifier: BSD-3-Clause
/// The dock in ParaView's window from which one touches a state space or a reduced body. It chooses
/// what is touched, the device of each tool and the settings, and shows the figures of the loops.
#pragma once

#include <QDockWidget>
#include <QTimer>
#include <functional>

#include "pqPalpateReducedTouch.h"
#include "pqPalpateTouch.h"

class QAction;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QGroupBox;
class QLabel;
class QPushButton;
class QTableWidget;
class QVBoxLayout;
class pqFileChooserWidget;
class pqOutputPort;
class pqPalpateForceGraph;

class pqPalpateInteractorDock : public QDockWidget
{
  Q_OBJECT
  typedef QDockWidget Superclass;

public:
  explicit pqPalpateInteractorDock(QWidget* parent = nullptr);

protected:
  void closeEvent(QCloseEvent* event) override;

private:
  void makeChoices(QFormLayout* form);
  void makeTools(QVBoxLayout* column);
  void makeSettings(QFormLayout* form);
  QLabel* addFigure(QFormLayout* form, const char* title, const char* name, const char* tip);
  /// Makes the figures that one looks at while touching.
  void makeFigures(QFormLayout* form);
  void makePace(QFormLayout* form);
  void makeRecorder(QFormLayout* form);
  /// Makes the actions in a toolbar of ParaView's window, with their keys.
  void makeActions();

  void listSpaces();
  void listDevices();
  /// Makes a row for each tool of the chosen reduced model, with its list of devices. Without a
  /// reduced model there is no table.
  void listTools();
  /// Gives a tool the device that was chosen for it, also while the body is touched.
  void chooseDevice(int tool);
  bool isTouching() const { return this->Touch.isRunning() || this->ReducedTouch.isRunning(); }
  void stopTouching();
  /// Why the chosen device cannot move the tool, which is that another tool has the device; empty:
  /// it can.
  QString whyTaken(int tool) const;
  /// Shows or hides a row of the figures.
  void showRow(QWidget* field, bool shown);
  /// @param unit What the numbers count, with a space before it; empty: ticks.
  void showPace(const pqPalpateRun::Pace& pace, const char* unit);
  /// Connects the signals of what both kinds of touching have in common.
  void follow(pqPalpateRun& run);
  /// Disables the settings that have no meaning for the present choice.
  void enableSettings();
  void startOrStop();
  void showState();
  void showFigures();
  void showReducedFigures();
  /// Shows or hides the chart of the force. The chart is made when it is first shown, so that
  /// nobody else pays for its OpenGL window.
  void showGraph(bool shown);
  void sendSettings();
  pqOutputPort* chosenSpace() const;
  /// Calls `body()`, and shows the exception that it throws.
  void guard(const std::function<void()>& body);
  /// Shows a message: a fault in red, any other in black.
  void say(const QString& text, bool isFault);

  // Touch and ReducedTouch signal their end when they are destroyed. So the members that their
  // slots use come before them, and are destroyed after them.
  QTimer FiguresTimer;
  QString Problem;
  pqPalpateTouch Touch;
  pqPalpateReducedTouch ReducedTouch;

  QComboBox* Space = nullptr;
  QComboBox* Device = nullptr;
  QGroupBox* ToolsGroup = nullptr;
  QTableWidget* Tools = nullptr;
  QVector<QComboBox*> DeviceOfTool;
  QPushButton* Refresh = nullptr;
  QPushButton* Start = nullptr;
  QAction* StartAction = nullptr;
  QLabel* Message = nullptr;

  QDoubleSpinBox* WorkspaceScale = nullptr;
  QCheckBox* FollowsCamera = nullptr;
  QDoubleSpinBox* ForceScale = nullptr;
  QDoubleSpinBox* ForceLimit = nullptr;
  QCheckBox* Bonded = nullptr;
  QDoubleSpinBox* ReleaseForce = nullptr;
  QDoubleSpinBox* Friction = nullptr;
  QCheckBox* Grasps = nullptr;
  QCheckBox* NeedsButton = nullptr;
  QCheckBox* InTissue = nullptr;

  QCheckBox* Records = nullptr;
  pqFileChooserWidget* RecordingFile = nullptr;
  QLabel* Recorded = nullptr;
  QGroupBox* GraphGroup = nullptr;
  pqPalpateForceGraph* Graph = nullptr;

  QLabel* State = nullptr;
  QLabel* Rates = nullptr;
  QLabel* Lateness = nullptr;
  QLabel* Missed = nullptr;
  QLabel* Force = nullptr;
  QLabel* Depth = nullptr;
  QLabel* Energy = nullptr;
  QLabel* Place = nullptr;
  QLabel* Damping = nullptr;
  QLabel* Trust = nullptr;
  QLabel* StepTime = nullptr;
};

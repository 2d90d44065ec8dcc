// SPDX-License-Identifier: BSD-3-Clause
/// The dock of ParaView's window from where a state space or a reduced body is touched: what, with
/// which device, or with which devices each of the tools, how, and what the loops find.
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
  /// What one looks at while touching.
  void makeFigures(QFormLayout* form);
  void makePace(QFormLayout* form);
  void makeRecorder(QFormLayout* form);
  /// In a toolbar of ParaView's window, with keys.
  void makeActions();

  void listSpaces();
  void listDevices();
  /// A row for each tool of the reduced model that is chosen, with its list of devices; no table
  /// where none is.
  void listTools();
  /// A device that is chosen for a tool while it is touched has it from now on.
  void chooseDevice(int tool);
  bool isTouching() const { return this->Touch.isRunning() || this->ReducedTouch.isRunning(); }
  void stopTouching();
  /// Why the tool's device cannot have it: another tool has that device; empty: it can.
  QString whyTaken(int tool) const;
  /// Of the figures.
  void showRow(QWidget* field, bool shown);
  void showRecorded(quint64 ticks, quint64 missing);
  /// Shows what a Touch or a ReducedTouch tells.
  template <class AnyTouch>
  void follow(AnyTouch& touch);
  /// Settings that have no meaning with what is chosen are grey.
  void enableSettings();
  void startOrStop();
  void showState();
  void showFigures();
  void showReducedFigures();
  /// Made when it is first wanted: a scene that does not need it does without its window of OpenGL.
  void showGraph(bool shown);
  void sendSettings();
  pqOutputPort* chosenSpace() const;
  /// Calls `body()`, and says what it throws.
  void guard(const std::function<void()>& body);
  /// What goes well is black.
  void say(const QString& text, bool isFault);

  // Told by what touches when that ends: the last of them to go.
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

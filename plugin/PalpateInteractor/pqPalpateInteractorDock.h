// SPDX-License-Identifier: BSD-3-Clause
/// The dock of ParaView's window from where a state space is touched: what, with which device, how,
/// and what the loop finds.
#pragma once

#include <QDockWidget>
#include <QTimer>

#include "pqPalpateTouch.h"

class QAction;
class QCheckBox;
class QComboBox;
class QDoubleSpinBox;
class QFormLayout;
class QGroupBox;
class QLabel;
class QPushButton;
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
  void makeSettings(QFormLayout* form);
  void makeFigures(QFormLayout* form);
  void makeRecorder(QFormLayout* form);
  /// In a toolbar of ParaView's window, with keys.
  void makeActions();

  void listSpaces();
  void listDevices();
  /// Settings that have no meaning with what is chosen are grey.
  void enableSettings();
  void startOrStop();
  void showState();
  void showFigures();
  /// Made when it is first wanted: a scene that does not need it does without its window of OpenGL.
  void showGraph(bool shown);
  void sendSettings();
  pqOutputPort* chosenSpace() const;
  /// What goes well is black.
  void say(const QString& text, bool isFault);

  // Told by what touches when that ends: the last of them to go.
  QTimer FiguresTimer;
  QString Problem;
  pqPalpateTouch Touch;

  QComboBox* Space = nullptr;
  QComboBox* Device = nullptr;
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
  QLabel* Energy = nullptr;
  QLabel* Place = nullptr;
  QLabel* Damping = nullptr;
};

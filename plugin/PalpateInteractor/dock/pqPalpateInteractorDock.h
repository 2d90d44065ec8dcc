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
class QComboBox;
class QFormLayout;
class QGroupBox;
class QLabel;
class QPushButton;
class pqOutputPort;
class pqPalpateDevicesPanel;
class pqPalpateFiguresPanel;
class pqPalpateForceGraph;
class pqPalpateRecordingPanel;
class pqPalpateSettingsPanel;

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
  void makeCut(QFormLayout* form);
  /// Makes the actions in a toolbar of ParaView's window, with their keys.
  void makeActions();

  void listSpaces();
  void listDevices();
  /// Shows the tools of the chosen space or reduced model, and the figures that it has.
  void listTools();
  /// Gives a tool the device that was chosen for it, also while the body is touched.
  void chooseDevice(int tool);
  bool isTouching() const { return this->Touch.isRunning() || this->ReducedTouch.isRunning(); }
  void stopTouching();
  /// Connects the signals of what both kinds of touching have in common.
  void follow(pqPalpateRun& run);
  /// Disables the settings that have no meaning for the present choice.
  void enableSettings();
  void startOrStop();
  void showState();
  void showFigures();
  /// Shows or hides the chart of the force. The chart is made when it is first shown, so that
  /// nobody else pays for its OpenGL window.
  void showGraph(bool shown);
  void sendSettings();
  /// Shows the surfaces of the pipeline that may be the sheet of a cut.
  void listSheets();
  /// Cuts the body of the chosen space along the chosen sheet, also while it is touched.
  void cutNow();
  pqOutputPort* chosenSpace() const;
  /// The port that was chosen in a list; null: it is gone.
  static pqOutputPort* chosenIn(const QComboBox* list);
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
  QPushButton* Start = nullptr;
  QAction* StartAction = nullptr;
  QLabel* Message = nullptr;
  pqPalpateDevicesPanel* Devices = nullptr;
  pqPalpateFiguresPanel* Figures = nullptr;
  pqPalpateSettingsPanel* Settings = nullptr;
  pqPalpateRecordingPanel* Recording = nullptr;
  QComboBox* Sheet = nullptr;
  QPushButton* Cut = nullptr;
  QGroupBox* GraphGroup = nullptr;
  pqPalpateForceGraph* Graph = nullptr;
};

// SPDX-License-Identifier: BSD-3-Clause
/// The figures of the loop, of the tool and of the body, as they are while one touches.
#pragma once

#include <QObject>

#include "pqPalpateReducedTouch.h"
#include "pqPalpateTouch.h"

class QFormLayout;
class QLabel;

class pqPalpateFiguresPanel : public QObject
{
  Q_OBJECT
public:
  explicit pqPalpateFiguresPanel(QObject* parent);

  /// Makes the figures that one looks at while touching.
  void addLive(QFormLayout* form);
  /// Makes those of the pace of the loop.
  void addPace(QFormLayout* form);

  /// Shows the rows that a state space has, or those that a reduced model has.
  void showRows(bool isReduced);
  void show(const pqPalpateTouch::Figures& figures);
  void show(const pqPalpateReducedTouch::Figures& figures);
  void showClosed();

private:
  /// @param unit What the numbers count, with a space before it; empty: ticks.
  void showPace(const pqPalpateRun::Pace& pace, const char* unit);

  QLabel* State = nullptr;
  QLabel* Rates = nullptr;
  QLabel* Lateness = nullptr;
  QLabel* Missed = nullptr;
  QLabel* Force = nullptr;
  QLabel* Depth = nullptr;
  QLabel* Energy = nullptr;
  QLabel* Place = nullptr;
  QLabel* Mesh = nullptr;
  QLabel* Tear = nullptr;
  QLabel* Explored = nullptr;
  QLabel* Damping = nullptr;
  QLabel* Trust = nullptr;
  QLabel* StepTime = nullptr;
};

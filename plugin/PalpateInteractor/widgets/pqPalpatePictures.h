// SPDX-License-Identifier: BSD-3-Clause
/// Behaviour of pictures that ParaView's XML cannot express. When a check-point of a state space is
/// selected, the filters Touch State Space on that space show the body there. The chart of an
/// Accuracy Report has logarithmic axes with titles.
#pragma once

#include <QObject>

class pqOutputPort;
class pqRepresentation;
class pqView;

class pqPalpatePictures : public QObject
{
  Q_OBJECT

public:
  explicit pqPalpatePictures(QObject* parent = nullptr);

  void startup();
  void shutdown() {}

private:
  void watch();
  /// Shows the body at the selected configuration, if exactly one is selected.
  void touchSelected(pqOutputPort* space);
  void makeAxes(pqView* view, pqRepresentation* shown);

private Q_SLOTS:
  /// Names the x axes of all charts after the column that they show there.
  void nameXAxes();
};

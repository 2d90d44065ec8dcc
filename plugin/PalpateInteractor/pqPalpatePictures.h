// SPDX-License-Identifier: BSD-3-Clause
/// What ParaView's XML cannot say of pictures: a selected check-point of a state space is where the
/// filters Touch State Space on it show the body; the chart of an Accuracy Report has logarithmic
/// axes with titles.
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
  /// Nothing happens where something else than one configuration is selected.
  void touchSelected(pqOutputPort* space);
  void makeAxes(pqView* view, pqRepresentation* shown);

private Q_SLOTS:
  /// Of all charts, after what they have for it.
  void nameXAxes();
};

// SPDX-License-Identifier: BSD-3-Clause
/// Touches a reduced body of the pipeline with several devices. One thread steps the body; each
/// tool that a device moves has a servo loop of its own, with its own limiter, interlock and
/// statistics. A tool that no device moves goes with the body.
///
/// A filter TouchReducedModel shows the body; its coordinates are set each frame. A single tool
/// ends when its device is pulled out or taken from it, and the others go on.
#pragma once

#include <QString>
#include <QVector>
#include <memory>

#include "pqPalpateRun.h"

class pqOutputPort;
class pqRenderView;

class pqPalpateReducedTouch : public pqPalpateRun
{
  Q_OBJECT
public:
  struct ToolFigures
  {
    qlonglong ActiveNode = -1;
    /// The state of the loop and of the tool, in words.
    QString State = "free";
    /// The force at the device, and that of the body, N.
    double Force = 0;
    double BodyForce = 0;
  };

  /// The pace is that of the steps of the body.
  struct Figures : Pace
  {
    QVector<ToolFigures> Tools;
    /// How the last step ended.
    QString Outcome;
    /// ReducedState::trust: how far the body is beyond what its model was trained for.
    double Trust = 0;
    bool IsTrusted = true;
    /// The time that half and 99 % of the steps did not exceed, µs.
    double StepTime[2] = { 0, 0 };
  };

  explicit pqPalpateReducedTouch(QObject* parent = nullptr);
  ~pqPalpateReducedTouch() override;

  /// @param devices The device of each tool, as in pqPalpateDevices.h; empty: none.
  /// @param recording The file for the ticks. Each tool has one, with -tool0 and so on before the
  ///   suffix; empty: none.
  /// @return Why it does not run; empty: it runs. Scales that are set later take effect at the next
  ///   start, so that no coupling becomes stiffer than its device displays; the rest at once.
  QString start(pqOutputPort* model, pqRenderView* view, const QVector<QString>& devices,
    const QString& recording);

  /// Takes a tool from its device, with zero force, and gives it to another device while it runs.
  /// @param device The new device; empty: none.
  /// @return Why the device does not move the tool, which then has none; empty: all is well.
  QString setDevice(int tool, const QString& device);
  QString device(int tool) const;

  Figures figures();

Q_SIGNALS:
  /// Emitted when the tool has lost its device.
  void toolLost(int tool, const QString& why);

protected:
  void tellLives() override;
  void advance() override;
  void takeNewData() override;
  QString endLoops(pqPalpateRun::Session& session) override;

private:
  struct Session;

  /// The session that runs; null: none does.
  std::shared_ptr<Session> session() const;
  std::unique_ptr<Hand> makeHand(Session& session, int tool, const QString& device);
  void applySettings(Session& session, Hand& hand) const;
  /// @return Whether the thread of the tool's loop has ended.
  bool endHand(Session& session, int tool);
  /// Shows what has changed since the last frame.
  void show(Session& session);
};

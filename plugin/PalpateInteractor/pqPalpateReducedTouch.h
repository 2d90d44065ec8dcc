// SPDX-License-Identifier: BSD-3-Clause
/// Touches a reduced body of the pipeline with several devices. One thread steps the body; each
/// tool that a device moves has a servo loop of its own, with its own limiter, interlock and
/// statistics. A tool that no device moves goes with the body.
///
/// Neither the body nor a loop waits for ParaView. A filter TouchReducedModel on the server,
/// wherever that is, shows the body; its coordinates are set each frame, and other filters can take
/// its output. All tools end, with zero force, where pqPalpateTouch does. A single tool ends when
/// its device is pulled out or taken from it, and the others go on.
#pragma once

#include <QObject>
#include <QString>
#include <QTimer>
#include <QVector>
#include <memory>

#include "pqPalpateRunWatch.h"
#include "pqPalpateTouch.h"

class pqOutputPort;
class pqRenderView;

class pqPalpateReducedTouch : public QObject
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

  struct Figures
  {
    QVector<ToolFigures> Tools;
    /// How the last step ended.
    QString Outcome;
    /// ReducedState::trust: how far the body is beyond what its model was trained for.
    double Trust = 0;
    bool IsTrusted = true;
    /// Steps and frames a second.
    double Rate = 0;
    double FrameRate = 0;
    /// The lateness that half, 99 % and all of the steps did not exceed, µs.
    double Lateness[3] = { 0, 0, 0 };
    /// The time that half and 99 % of the steps did not exceed, µs.
    double StepTime[2] = { 0, 0 };
    quint64 Steps = 0;
    quint64 Missed = 0;
    /// The ticks in the recordings, and the ticks that were lost.
    quint64 Recorded = 0;
    quint64 NotRecorded = 0;
    /// What is wrong with the body, the loops or their devices, and what to do.
    QString Problem;
  };

  explicit pqPalpateReducedTouch(QObject* parent = nullptr);
  ~pqPalpateReducedTouch() override;

  /// @param devices The device of each tool, as in pqPalpateDevices.h; empty: none.
  /// @param recording The file for the ticks. Each tool has one, with -tool0 and so on before the
  ///   suffix; empty: none.
  /// @return Why it does not run; empty: it runs.
  QString start(pqOutputPort* model, pqRenderView* view, const QVector<QString>& devices,
    const QString& recording);
  /// Ends with zero force, and shows the body at rest.
  void stop();
  bool isRunning() const { return this->Running != nullptr; }

  /// Takes a tool from its device, with zero force, and gives it to another device while it runs.
  /// @param device The new device; empty: none.
  /// @return Why the device does not move the tool, which then has none; empty: all is well.
  QString setDevice(int tool, const QString& device);
  QString device(int tool) const;

  /// Sets the settings. Scales take effect at the next start, so that no coupling becomes stiffer
  /// than its device displays; the rest at once.
  void setSettings(const pqPalpateTouch::Settings& settings);
  Figures figures();

Q_SIGNALS:
  void started();
  /// @param why The reason; empty: a person asked for it.
  void stopped(const QString& why);
  /// Emitted when the tool has lost its device.
  void toolLost(int tool, const QString& why);
  /// Emitted some thirty times a second while it runs.
  /// @param time The time since the start, s.
  /// @param force The largest force at a device, N; bodyForce that of the body.
  void sampled(double time, double force, double bodyForce);
  /// Emitted when a recording is closed.
  /// @param fault Why the recording is not complete; empty: it is.
  void recorded(const QString& file, quint64 ticks, const QString& fault);

private:
  struct Hand;
  struct Session;

  std::unique_ptr<Hand> makeHand(Session& session, int tool, const QString& device) const;
  void applySettings(Session& session, Hand& hand) const;
  /// @return Whether the thread of the tool's loop has ended.
  bool endHand(Session& session, int tool);
  /// Called at each frame. Calls advance(), and ends where that fails.
  void showFrame();
  void advance();
  /// Shows what has changed since the last frame.
  void show(Session& session);
  /// Ends with zero force first; then restores the picture of the view and shows the body at rest.
  void end(const QString& why, pqPalpateRunWatch::Left left);

  pqPalpateTouch::Settings Current;
  /// The session, shared with the frame that is being drawn, because the session may end within it.
  std::shared_ptr<Session> Running;
  /// Declared after Running, which it uses.
  pqPalpateRunWatch Watch;
  QTimer FrameTimer;
  bool IsShowing = false;
};

// SPDX-License-Identifier: BSD-3-Clause
/// Touches a reduced body of the pipeline with several devices: one thread that steps the body, and
/// for each tool that a device has a servo loop of its own, with its own limiter, interlock and
/// statistics. A tool that no device has moves with the body.
///
/// Neither the body nor a loop waits for ParaView. What is shown is a filter TouchReducedModel, on
/// the server wherever that is, whose coordinates are set each frame: other filters can hang on it.
/// All ends, with zero force, as in pqPalpateTouch; a single tool, when its device is pulled out or
/// it is taken from it, and the others go on.
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
    /// Of the loop and of the tool, in words.
    QString State = "free";
    /// At the device, and of the body, N.
    double Force = 0;
    double BodyForce = 0;
  };

  struct Figures
  {
    QVector<ToolFigures> Tools;
    /// How the last step ended.
    QString Outcome;
    /// How far the body is from what its model was trained for.
    double Trust = 0;
    bool IsTrusted = true;
    /// Steps and frames a second.
    double Rate = 0;
    double FrameRate = 0;
    /// How late steps began, µs: half, 99 % and all of them were less.
    double Lateness[3] = { 0, 0, 0 };
    /// What a step took, µs: half and 99 % of them less than.
    double StepTime[2] = { 0, 0 };
    quint64 Steps = 0;
    quint64 Missed = 0;
    /// Ticks in the recordings, and those that they lost.
    quint64 Recorded = 0;
    quint64 NotRecorded = 0;
    /// What is wrong with the body, the loops or their devices, and what to do.
    QString Problem;
  };

  explicit pqPalpateReducedTouch(QObject* parent = nullptr);
  ~pqPalpateReducedTouch() override;

  /// @param devices Of each tool, as in pqPalpateDevices.h; empty: none.
  /// @param recording Every tick of each tool goes into this file, with -tool0 and so on before its
  ///   suffix; empty: into none.
  /// @return What was wrong; empty: it runs.
  QString start(pqOutputPort* model, pqRenderView* view, const QVector<QString>& devices,
    const QString& recording);
  /// Zero force, the body at rest.
  void stop();
  bool isRunning() const { return this->Running != nullptr; }

  /// Takes a tool from its device, with zero force, and gives it another one, while it runs.
  /// @param device Empty: none.
  /// @return What was wrong, and then no device has the tool; empty: it runs.
  QString setDevice(int tool, const QString& device);
  QString device(int tool) const;

  /// Scales count from the next start on, so that no coupling becomes stiffer than its device
  /// displays; the rest at once.
  void setSettings(const pqPalpateTouch::Settings& settings);
  Figures figures();

Q_SIGNALS:
  void started();
  /// @param why Empty where it was asked for.
  void stopped(const QString& why);
  /// No device has this tool any more.
  void toolLost(int tool, const QString& why);
  /// Some thirty times a second while it runs.
  /// @param time Since the start, s.
  /// @param force The largest at a device, and of the body, N.
  void sampled(double time, double force, double bodyForce);
  /// A recording is closed.
  /// @param fault Why it is not whole; empty: it is.
  void recorded(const QString& file, quint64 ticks, const QString& fault);

private:
  struct Hand;
  struct Session;

  std::unique_ptr<Hand> makeHand(Session& session, int tool, const QString& device) const;
  void applySettings(Session& session, Hand& hand) const;
  /// @return Whether the thread of its loop has ended.
  bool endHand(Session& session, int tool);
  /// At each frame: advance(), and the end where that fails.
  void showFrame();
  void advance();
  /// What has changed since the last frame.
  void show(Session& session);
  /// Zero force first; then the whole picture of the view, and the body at rest.
  void end(const QString& why, pqPalpateRunWatch::Left left);

  pqPalpateTouch::Settings Current;
  /// Shared with the frame that is drawn, in which it may end.
  std::shared_ptr<Session> Running;
  /// Uses what runs.
  pqPalpateRunWatch Watch;
  QTimer FrameTimer;
  bool IsShowing = false;
};

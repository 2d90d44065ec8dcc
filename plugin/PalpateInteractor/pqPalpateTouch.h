// SPDX-License-Identifier: BSD-3-Clause
/// Touches a state space of the pipeline: owns the servo loop, the body as it feels it, and the
/// device, and shows some thirty times a second in a view what the loop has found.
///
/// The loop has its own thread and neither waits for ParaView nor is waited for. What is shown is a
/// filter TouchStateSpace, on the server wherever that is, whose node and displacement, or place of
/// a rigid tool, are set each frame: other filters can hang on it. It ends by itself, with zero
/// force, when the space, the view or the server goes, when the device is pulled out, and when
/// ParaView quits; and by Escape, wherever in ParaView's windows that is pressed, whatever else it
/// does there, and while they handle no event.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QString>
#include <QTimer>
#include <memory>

#include "haptic/realtime/clock.h"
#include "haptic/touching/settings.h"
#include "pqPalpateRunWatch.h"

class pqOutputPort;
class pqRenderView;
namespace palpate
{
struct Tick;
}

class pqPalpateTouch : public QObject
{
  Q_OBJECT
public:
  static constexpr int FrameInterval = 33; // ms
  /// Of the radius of what can be touched: what the device reaches beyond that.
  static constexpr double Room = 1.3;
  static double Microseconds(palpate::Duration duration)
  {
    return 1e6 * palpate::seconds(duration);
  }

  /// What may change while it runs.
  struct Settings
  {
    /// Metres in the scene for a metre at the device; 0: so that all that can be touched is
    /// reached.
    double WorkspaceScale = 0;
    /// The device's axes are those of the view; else those of the scene, y being up.
    bool FollowsCamera = true;
    double ForceScale = 1;
    /// N at the device; 0: that of the device.
    double ForceLimit = 0;
    /// The tool also pulls. The mouse is always bonded to what it holds.
    bool Bonded = false;
    /// N of the body, above which a tool that pulls lets go; 0: never.
    double ReleaseForce = palpate::TouchSettings().release_force;
    /// There is a force only as long as the device's first button is held.
    bool NeedsButton = false;
    /// A rigid tool holds the body as long as the device's last button is held, where that is
    /// another one.
    bool GraspsWithButton = true;
    /// Coefficient of friction of a rigid tool.
    double Friction = 0;
    /// The body at rest has the colour of tissue, and others where it is pressed or moved; else
    /// those of ParaView's map. What a person has coloured before keeps its colours.
    bool InTissue = true;
  };

  /// What is known of the loop and of the view, in words where it is not a number.
  struct Figures
  {
    QString State;
    QString Contact;
    /// Ticks a second, frames a second.
    double Rate = 0;
    double FrameRate = 0;
    /// How late ticks began, µs: half, 99 % and all of them were less.
    double Lateness[3] = { 0, 0, 0 };
    quint64 Ticks = 0;
    quint64 Missed = 0;
    /// At the device, and of the body, N.
    double Force = 0;
    double BodyForce = 0;
    /// What the hand has put in less what the body stores, J.
    double Dissipated = 0;
    /// That is added against energy of the sampled loop's making, N·s/m.
    double Damping = 0;
    int Node = -1;
    int Branch = 0;
    QString Support;
    /// How deep a rigid tool is in the body at rest, or how far the tool has moved its node, m;
    /// below 0: it touches nothing.
    double Depth = -1;
    /// How much deeper a rigid tool that presses can go, m; below 0: there is none.
    double DepthLeft = -1;
    /// Ticks in the recording, and those that it lost.
    quint64 Recorded = 0;
    quint64 NotRecorded = 0;
    /// What is wrong with the loop or its device, and what to do.
    QString Problem;
  };

  explicit pqPalpateTouch(QObject* parent = nullptr);
  ~pqPalpateTouch() override;

  /// @param device As in pqPalpateDevices.h.
  /// @param recording Every tick goes into this file, or one that is named after it where it is
  ///   there already; empty: into none.
  /// @return What was wrong; empty: it runs.
  QString start(
    pqOutputPort* space, pqRenderView* view, const QString& device, const QString& recording);
  /// Zero force, the body at rest.
  void stop();
  bool isRunning() const { return this->Running != nullptr; }

  void setSettings(const Settings& settings);
  Figures figures();

Q_SIGNALS:
  void started();
  /// @param why Empty where it was asked for.
  void stopped(const QString& why);
  /// Some thirty times a second while it runs.
  /// @param time Since the start, s.
  /// @param force At the device, and of the body, N.
  void sampled(double time, double force, double bodyForce);
  /// A recording is closed.
  /// @param fault Why it is not whole; empty: it is.
  void recorded(const QString& file, quint64 ticks, const QString& fault);

private:
  struct Session;

  /// At each frame: advance(), and the end where that fails.
  void showFrame();
  void advance();
  /// What has changed since the last frame.
  void show(const palpate::Tick& tick);
  /// @param fault Why it ends before its time; empty: it does not.
  void closeRecording(Session& session, const QString& fault);
  /// The workspace, and the rest of what the loop is told.
  void applySettings(const palpate::Tick& tick);
  void takeNewData();
  /// Zero force first; then the whole picture of the view, and the body at rest.
  void end(const QString& why, pqPalpateRunWatch::Left left);

  Settings Current;
  /// Shared with the frame that is drawn, in which it may end.
  std::shared_ptr<Session> Running;
  /// Uses what runs.
  pqPalpateRunWatch Watch;
  QTimer FrameTimer;
  bool IsShowing = false;
};

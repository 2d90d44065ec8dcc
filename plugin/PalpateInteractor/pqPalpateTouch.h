// SPDX-License-Identifier: BSD-3-Clause
/// Touches a state space of the pipeline. It owns the servo loop, the body that the loop touches,
/// and the device. Some thirty times a second it shows in a view what the loop has found.
///
/// The loop has its own thread; neither it nor ParaView waits for the other. A filter
/// TouchStateSpace on the server, wherever that is, shows the body. Its node and displacement, or
/// the place of a rigid tool, are set each frame, and other filters can take its output. Touching
/// ends by itself, with zero force, when the space, the view or the server goes away, when the
/// device is pulled out, and when ParaView quits. Escape ends it too, wherever in ParaView's
/// windows it is pressed, whatever else it does there, and also while they handle no event.
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
  /// The device reaches this many times the radius of what can be touched.
  static constexpr double Room = 1.3;
  static double Microseconds(palpate::Duration duration)
  {
    return 1e6 * palpate::seconds(duration);
  }

  /// What may change while it runs.
  struct Settings
  {
    /// Metres in the scene for a metre at the device; 0: as many as it takes to reach all that can
    /// be touched.
    double WorkspaceScale = 0;
    /// Whether the device's axes follow the view; else they are those of the scene, with y up.
    bool FollowsCamera = true;
    double ForceScale = 1;
    /// The largest force, N at the device; 0: that of the device.
    double ForceLimit = 0;
    /// Whether the tool also pulls. The mouse is always bonded to what it holds.
    bool Bonded = false;
    /// The force of the body above which a tool that pulls lets go, N; 0: never.
    double ReleaseForce = palpate::TouchSettings().release_force;
    /// Whether there is a force only as long as the device's first button is held.
    bool NeedsButton = false;
    /// Whether a rigid tool holds the body as long as the device's last button is held, where that
    /// is not the first one.
    bool GraspsWithButton = true;
    /// Coefficient of friction of a rigid tool.
    double Friction = 0;
    /// Whether the body has the colour of tissue at rest and other colours where it is pressed or
    /// moved; else the colours are those of ParaView's map. A body that a person has coloured keeps
    /// its colours.
    bool InTissue = true;
  };

  /// Figures of the loop and of the view, in words where they are not numbers.
  struct Figures
  {
    QString State;
    QString Contact;
    /// Ticks a second, frames a second.
    double Rate = 0;
    double FrameRate = 0;
    /// The lateness that half, 99 % and all of the ticks did not exceed, µs.
    double Lateness[3] = { 0, 0, 0 };
    quint64 Ticks = 0;
    quint64 Missed = 0;
    /// The force at the device, and that of the body, N.
    double Force = 0;
    double BodyForce = 0;
    /// The energy that the hand has put in, less what the body stores, J.
    double Dissipated = 0;
    /// The damping that takes away energy which the sampled loop has made, N·s/m.
    double Damping = 0;
    int Node = -1;
    int Branch = 0;
    QString Support;
    /// How deep a rigid tool is in the body at rest, or how far the tool has moved its node, m;
    /// below 0: the tool touches nothing.
    double Depth = -1;
    /// How much deeper a rigid tool that presses can go, m; below 0: no rigid tool presses.
    double DepthLeft = -1;
    /// The ticks in the recording, and the ticks that were lost.
    quint64 Recorded = 0;
    quint64 NotRecorded = 0;
    /// What is wrong with the loop or its device, and what to do; empty: nothing.
    QString Problem;
  };

  explicit pqPalpateTouch(QObject* parent = nullptr);
  ~pqPalpateTouch() override;

  /// @param device The device, as in pqPalpateDevices.h.
  /// @param recording The file for the ticks, or, where there is such a file already, one that is
  ///   named after it; empty: none.
  /// @return Why it does not run; empty: it runs.
  QString start(
    pqOutputPort* space, pqRenderView* view, const QString& device, const QString& recording);
  /// Ends with zero force, and shows the body at rest.
  void stop();
  bool isRunning() const { return this->Running != nullptr; }

  void setSettings(const Settings& settings);
  Figures figures();

Q_SIGNALS:
  void started();
  /// @param why The reason; empty: a person asked for it.
  void stopped(const QString& why);
  /// Emitted some thirty times a second while it runs.
  /// @param time The time since the start, s.
  /// @param force The force at the device, N; bodyForce that of the body.
  void sampled(double time, double force, double bodyForce);
  /// Emitted when a recording is closed.
  /// @param fault Why the recording is not complete; empty: it is.
  void recorded(const QString& file, quint64 ticks, const QString& fault);

private:
  struct Session;

  /// Called at each frame. Calls advance(), and ends where that fails.
  void showFrame();
  void advance();
  /// Shows what has changed since the last frame.
  void show(const palpate::Tick& tick);
  /// @param fault Why the recording ends early; empty: it does not.
  void closeRecording(Session& session, const QString& fault);
  /// Sends the workspace and the other settings to the loop.
  void applySettings(const palpate::Tick& tick);
  void takeNewData();
  /// Ends with zero force first; then restores the picture of the view and shows the body at rest.
  void end(const QString& why, pqPalpateRunWatch::Left left);

  Settings Current;
  /// The session, shared with the frame that is being drawn, because the session may end within it.
  std::shared_ptr<Session> Running;
  /// Declared after Running, which it uses.
  pqPalpateRunWatch Watch;
  QTimer FrameTimer;
  bool IsShowing = false;
};

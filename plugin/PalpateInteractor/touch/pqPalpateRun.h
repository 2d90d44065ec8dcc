// SPDX-License-Identifier: BSD-3-Clause
/// One run of touching, whatever is touched. It shows some thirty times a second in a view what the
/// servo loops have found, and ends by itself, with zero force, when the touched data, the view or
/// the server goes away, and when ParaView quits. Escape ends it too, wherever in ParaView's
/// windows it is pressed, whatever else it does there, and also while they handle no event.
///
/// The loops have threads of their own; neither they nor ParaView wait for the other. A filter on
/// the server, wherever that is, shows the body, and other filters can take its output.
#pragma once

#include <QElapsedTimer>
#include <QObject>
#include <QPointer>
#include <QString>
#include <QTimer>
#include <functional>
#include <memory>
#include <string_view>

#include "haptic/servo/servo.h"
#include "haptic/transport/motion.h"
#include "pqOutputPort.h"
#include "pqPalpateBodyView.h"
#include "pqPalpateDevices.h"
#include "pqPalpateExploration.h"
#include "pqPalpateMouse.h"
#include "pqPalpateRecording.h"
#include "pqPalpateRunWatch.h"
#include "pqPipelineSource.h"
#include "pqRenderView.h"

class pqPalpateRun : public QObject
{
  Q_OBJECT
public:
  static constexpr int FrameInterval = 33; // ms
  /// The device reaches this many times the radius of what can be touched.
  static constexpr double Room = 1.3;

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
    /// The energy that it takes to open a cut whose stages the space has, J/m²; 0: it does not
    /// tear.
    double FractureToughness = 0;
    /// Whether the tool is a blade, which opens such a cut.
    bool IsBlade = false;
    /// The energy that this takes, J/m²; 0: as much as it takes to tear. The stiffness of the
    /// tissue before its edge, N/m, and the force that draws it through what is cut, N.
    double BladeToughness = 0;
    double BladeStiffness = palpate::TouchSettings().blade_stiffness;
    double BladeFriction = 0;
    /// Coefficient of friction of a rigid tool.
    double Friction = 0;
    /// Who explores a space that is explored around the hand; as it is when touching begins.
    pqPalpateExploration::Explorers Explorers;
    /// Whether the body has the colour of tissue at rest and other colours where it is pressed or
    /// moved; else the colours are those of ParaView's map. A body that a person has coloured keeps
    /// its colours.
    bool InTissue = true;
  };

  /// Figures of what runs in real time, which are ticks of the servo loop or steps of the body, and
  /// of the view.
  struct Pace
  {
    /// Ticks or steps a second, frames a second.
    double Rate = 0;
    double FrameRate = 0;
    /// The lateness that half, 99 % and all of them did not exceed, µs.
    double Lateness[3] = { 0, 0, 0 };
    quint64 Number = 0;
    quint64 Missed = 0;
    /// The ticks in the recordings, and the ticks that were lost.
    quint64 Recorded = 0;
    quint64 NotRecorded = 0;
    /// What is wrong with the loops or their devices, and what to do; empty: nothing.
    QString Problem;
  };

  bool isRunning() const { return this->Running != nullptr; }
  /// Ends with zero force, and shows the body at rest.
  void stop() { this->end({}, pqPalpateRunWatch::Left::All); }
  void setSettings(const Settings& settings);

Q_SIGNALS:
  void started();
  /// @param why The reason; empty: a person asked for it.
  void stopped(const QString& why);
  /// Emitted some thirty times a second while it runs.
  /// @param time The time since the start, s.
  /// @param force The largest force at a device, N; bodyForce that of the body.
  void sampled(double time, double force, double bodyForce);
  /// Emitted when a recording is closed.
  /// @param fault Why the recording is not complete; empty: it is.
  void recorded(const QString& file, quint64 ticks, const QString& fault);

protected:
  /// A device, its loop, and the tool that it moves.
  struct Hand
  {
    /// As in pqPalpateDevices.h.
    QString Device;
    std::unique_ptr<palpate::Servo> Servo;
    /// The settings as they were last set.
    palpate::ServoSettings Settings;
    std::shared_ptr<palpate::MouseMotion> Motion;
    std::unique_ptr<pqPalpateMouse> Mouse;
    /// The place and the axes of the simulated hand's workspace.
    palpate::Vec3 Centre = palpate::Vec3::Zero();
    palpate::Mat3 Rotation = palpate::Mat3::Identity();
    std::unique_ptr<pqPalpateRecording> Recording;
    palpate::Tick Tick;

    bool IsSimulated() const { return this->Device == pqPalpateHandDevice; }
    bool IsReal() const { return this->Device != pqPalpateMouseDevice && !this->IsSimulated(); }
  };

  /// Where the simulated hand begins, above a place of the body, and how far it goes down, m.
  struct HandWay
  {
    palpate::Vec3 Place = palpate::Vec3::Zero();
    palpate::Vec3 Normal = palpate::Vec3::UnitZ();
    double Height = 0;
    double Length = 0;
  };

  /// The objects that exist while it runs.
  struct Session
  {
    Session(pqOutputPort* port, pqRenderView* view);
    virtual ~Session();

    QPointer<pqOutputPort> Port;
    QPointer<pqPipelineSource> Source;
    QPointer<pqRenderView> View;
    /// A sphere around all that can be touched, m.
    palpate::Vec3 Centre = palpate::Vec3::Zero();
    double Radius = 0;
    std::unique_ptr<pqPalpateBodyView> BodyView;
    QElapsedTimer Time;
    /// The forces of the newest frame, as sampled() tells them.
    double Force = 0;
    double BodyForce = 0;
  };

  explicit pqPalpateRun(QObject* parent);
  /// A class that is derived calls end() first.
  ~pqPalpateRun() override;

  /// Says to the loops that ParaView lives.
  virtual void tellLives() = 0;
  /// Shows what the loops have found since the last frame. The session may end within it.
  virtual void advance() = 0;
  /// Takes what the pipeline has made anew of the touched data.
  virtual void takeNewData() = 0;
  /// Ends all loops with zero force, closes their recordings, and removes what was drawn.
  /// @return Why a loop has not ended; empty: all have.
  virtual QString endLoops(Session& session) = 0;

  /// Call this when a session was begun.
  void hasBegun();
  /// Ends with zero force first; then restores the picture of the view and shows the body at rest.
  void end(const QString& why, pqPalpateRunWatch::Left left);
  /// @param fault Why the recording ends early; empty: it does not.
  void closeRecording(std::unique_ptr<pqPalpateRecording> recording, const QString& fault = {});

  /// Opens the device of a hand.
  /// @param way Is asked where the device is the simulated hand.
  static pqPalpateDevice open(
    Hand& hand, const std::shared_ptr<palpate::Clock>& clock, const std::function<HandWay()>& way);
  /// Finds for the settings of a hand its limit, its buttons, and the workspace, which follows the
  /// camera only while the tool touches nothing, so that the tool is not torn through the body.
  /// @param simulatedGrasps Whether the simulated hand grasps with a button, too.
  void findSettings(const Session& session, Hand& hand, bool simulatedGrasps) const;

  static double microseconds(palpate::Duration duration)
  {
    return 1e6 * palpate::seconds(duration);
  }
  static QString words(std::string_view text);
  /// @param statistics palpate::Statistics or palpate::ReducedBodyStatistics.
  template <class Statistics>
  static void takePace(const Session& session, const Statistics& statistics, Pace& pace)
  {
    pace.Rate = statistics.rate();
    pace.FrameRate = session.BodyView->GetFrameRate();
    pace.Lateness[0] = microseconds(statistics.lateness.median);
    pace.Lateness[1] = microseconds(statistics.lateness.p99);
    pace.Lateness[2] = microseconds(statistics.lateness.largest);
    pace.Missed = statistics.missed;
  }
  static void addRecorded(const Hand& hand, Pace& pace);

  Settings Current;
  /// The session, shared with the frame that is being drawn, because the session may end within it.
  std::shared_ptr<Session> Running;
  /// Declared after Running, which it uses.
  pqPalpateRunWatch Watch;

private:
  /// Called at each frame. Ends where something in it fails.
  void showFrame();

  QTimer FrameTimer;
  bool IsShowing = false;
};

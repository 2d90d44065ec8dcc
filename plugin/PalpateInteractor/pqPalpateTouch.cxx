// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateTouch.h"

#include <QElapsedTimer>
#include <QPointer>
#include <QScopedValueRollback>
#include <algorithm>
#include <exception>
#include <utility>

#include "haptic/servo/interlock.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"
#include "haptic/touching/pressing_range.h"
#include "pqApplicationCore.h"
#include "pqOutputPort.h"
#include "pqPalpateBodyView.h"
#include "pqPalpateDevices.h"
#include "pqPalpateFault.h"
#include "pqPalpateFetch.h"
#include "pqPalpateNodeMouse.h"
#include "pqPalpateRecording.h"
#include "pqPalpateToolMouse.h"
#include "pqPalpateToolView.h"
#include "pqPipelineSource.h"
#include "pqRenderView.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"
#include "vtkPVLogger.h"
#include "state_space/pressing_space.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"

using palpate::Mat3;
using palpate::Vec3;

namespace
{
/// The height above the body at which the simulated hand begins, and the depth to which it goes, as
/// shares of the depth of the space.
constexpr double HandHeight = 0.25;
constexpr double HandDepth = 0.6;
/// The height at which a rigid tool begins, in sides of the coarsest cells: there it surely touches
/// nothing.
constexpr double HandRoom = 2;
/// The ratio of the pressure in the middle of a contact to the mean pressure, after Hertz.
constexpr double MiddleOfMean = 1.5;
constexpr double Pi = 3.14159265358979323846;

QString Words(palpate::ContactStatus status)
{
  switch (status)
  {
    case palpate::ContactStatus::nothing:
      return "no body";
    case palpate::ContactStatus::free:
      return "free";
    case palpate::ContactStatus::inside:
      return "inside, not touching";
    case palpate::ContactStatus::attached:
      return "touching";
    case palpate::ContactStatus::pressing:
      return "pressing";
  }
  return {};
}

QString Words(palpate::Support support)
{
  switch (support)
  {
    case palpate::Support::none:
      return "nothing found";
    case palpate::Support::inside:
      return "inside the space";
    case palpate::Support::extrapolated:
      return "beyond the space";
    case palpate::Support::marked:
      return "in a marked region";
  }
  return {};
}

/// The pressure under the middle of a rigid tool, Pa. It follows from the mean force and from
/// Hertz's area at the largest depth, so that a deep press is in the last colour.
double UsualPressure(const palpate::TouchToolSpace& rigid)
{
  double sum = 0;
  int number = 0;
  for (const palpate::ConfigurationSummary& c : rigid.configurations)
  {
    if (c.usable() && (c.flags & palpate::flags::touches_nothing) == 0)
    {
      sum += c.force.norm();
      ++number;
    }
  }
  const double radius = rigid.setup.interaction.touching_radius();
  const double area = Pi * radius * rigid.setup.depth();
  return number > 0 ? MiddleOfMean * sum / number / area : 0;
}
}

/// The objects that exist while it runs.
struct pqPalpateTouch::Session
{
  QPointer<pqOutputPort> Space;
  QPointer<pqPipelineSource> Source;
  QPointer<pqRenderView> View;
  QString Device;
  vtkMTimeType DataTime = 0;
  std::shared_ptr<const palpate::Touchable> Body;
  /// A sphere around all that can be touched, m.
  Vec3 Centre = Vec3::Zero();
  double Radius = 0;
  /// How deep the rigid tool presses, m; 0: there is none.
  double Deepest = 0;
  palpate::RigidTool RigidTool;
  /// The place and the axes of the simulated hand's workspace.
  Vec3 HandCentre = Vec3::Zero();
  Mat3 HandRotation = Mat3::Identity();

  std::unique_ptr<palpate::Servo> Servo;
  /// The settings of the servo as they were last set.
  palpate::ServoSettings ServoSettings;
  palpate::TouchSettings TouchSettings;
  std::shared_ptr<palpate::MouseMotion> Motion;
  std::unique_ptr<pqPalpateMouse> Mouse;
  std::unique_ptr<pqPalpateToolView> Tool;
  std::unique_ptr<pqPalpateBodyView> BodyView;
  std::unique_ptr<pqPalpateRecording> Recording;

  /// The node and the branch that are shown.
  int Node = -1;
  int Branch = 0;
  Vec3 Displacement = Vec3::Zero();
  Vec3 Pressed = Vec3::Zero();
  Vec3 Place = Vec3::Zero();
  bool ShowsFree = false;
  bool Touches = false;
  QElapsedTimer Time;

  /// Takes the client's copy of the space.
  void SetSpace(const palpate::TouchSpace& space)
  {
    this->Body = std::make_shared<const palpate::Touchable>(space);
    Eigen::AlignedBox3d box;
    double beyond = 0;
    for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
    {
      const palpate::InteractionSpec& interaction = toolSpace.setup.interaction;
      if (interaction.presses())
      {
        box.extend(this->Body->surface().bounds());
        beyond = std::max(beyond, 2 * interaction.touching_radius());
      }
      else
      {
        box.extend(interaction.material_point);
        beyond = std::max(beyond, toolSpace.setup.grid.half_width);
      }
    }
    this->Centre = box.center();
    this->Radius = Room * (box.diagonal().norm() / 2 + beyond);
    const palpate::TouchToolSpace* rigid = palpate::find_pressing(space);
    this->Deepest = rigid ? rigid->setup.depth() : 0;
    this->RigidTool = rigid ? rigid->setup.interaction.tool : palpate::RigidTool();
  }

  /// How deep a rigid tool is in the body at rest, or how far the tool has moved its node, m; below
  /// 0: the tool touches nothing.
  double Depth(const palpate::Contact& contact) const
  {
    if (contact.status == palpate::ContactStatus::pressing)
    {
      const palpate::SurfaceTree& surface = this->Body->surface();
      return std::max(0.0, palpate::depth_in_body(surface, this->RigidTool, contact.anchor));
    }
    return palpate::touches(contact.status) ? contact.displacement.norm() : -1;
  }

  /// A place where a rigid tool touches nothing, m.
  Vec3 Away() const { return this->Centre + this->Radius * Vec3::Ones(); }

  /// Makes what is drawn over the body, and the mouse that finds it.
  void ShowSpace(const palpate::TouchSpace& space)
  {
    vtkSMRenderViewProxy* view = this->View->getRenderViewProxy();
    this->Tool = std::make_unique<pqPalpateToolView>(view, space, *this->Body);
    if (this->Motion)
    {
      std::unique_ptr<pqPalpateMouse> mouse;
      if (this->Body->force_on_tool())
      {
        mouse = std::make_unique<pqPalpateToolMouse>(view, space, this->Body, this->Motion);
      }
      else
      {
        mouse = std::make_unique<pqPalpateNodeMouse>(view, space, this->Body, this->Motion);
      }
      if (this->Mouse)
      {
        mouse->GoOnFrom(*this->Mouse);
      }
      this->Mouse = std::move(mouse);
      this->Tool->Say(this->Mouse->GetHint());
    }
    // This draws the view, because no frame is drawn as long as nothing is touched.
    this->View->render();
  }

  pqPalpateDevice OpenDevice(
    const std::shared_ptr<palpate::Clock>& clock, const palpate::TouchSpace& space)
  {
    if (this->Device == pqPalpateMouseDevice)
    {
      this->Motion = std::make_shared<palpate::MouseMotion>();
      return pqPalpateSimulatedDevice(clock, this->Motion);
    }
    if (this->Device == pqPalpateHandDevice)
    {
      const palpate::TouchToolSpace* rigid = palpate::find_pressing(space);
      const palpate::ToolSpaceSetup& setup = (rigid ? *rigid : space.tool_spaces.front()).setup;
      const auto [place, normal, depth] = palpate::start_place(space, *this->Body);
      const double height =
        rigid ? HandRoom * setup.grid.coarsest * setup.grid.spacing() : HandHeight * depth;
      this->HandCentre = place + height * normal;
      const Vec3 across = normal.unitOrthogonal();
      this->HandRotation << across, normal.cross(across), normal;
      return pqPalpateSimulatedDevice(clock, pqPalpateHandMotion(height + HandDepth * depth));
    }
    return pqPalpateOpenDevice(this->Device);
  }

  void MakeBodyView(const palpate::TouchSpace& space, bool inTissue)
  {
    const palpate::TouchToolSpace* rigid = palpate::find_pressing(space);
    const double depth = space.tool_spaces.front().setup.depth();
    this->BodyView = std::make_unique<pqPalpateBodyView>(this->Space, this->View,
      rigid ? "ContactPressure" : "Displacement", rigid ? UsualPressure(*rigid) : depth, inTissue,
      this->Away().data());
  }

  bool IsSimulatedHand() const { return this->Device == pqPalpateHandDevice; }
};

pqPalpateTouch::pqPalpateTouch(QObject* parent)
  : QObject(parent)
{
  this->FrameTimer.setInterval(FrameInterval);
  this->FrameTimer.setTimerType(Qt::PreciseTimer);
  QObject::connect(&this->FrameTimer, &QTimer::timeout, this, &pqPalpateTouch::showFrame);

  QObject::connect(&this->Watch, &pqPalpateRunWatch::mustEnd, this, &pqPalpateTouch::end);
  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, &pqServerManagerModel::dataUpdated, this,
    [this](pqPipelineSource* source)
    {
      if (this->Running && source == this->Running->Source)
      {
        this->takeNewData();
      }
    });
}

pqPalpateTouch::~pqPalpateTouch()
{
  this->end({}, pqPalpateRunWatch::Left::Nothing);
}

QString pqPalpateTouch::start(
  pqOutputPort* space, pqRenderView* view, const QString& device, const QString& recording)
{
  this->stop();
  try
  {
    auto session = std::make_shared<Session>();
    // The recording is made first, because without it there is no reason to open a device.
    if (!recording.isEmpty())
    {
      session->Recording = std::make_unique<pqPalpateRecording>(recording);
    }
    const palpate::TouchSpace copy = pqPalpateFetchSpace(space);
    session->Space = space;
    session->Source = space->getSource();
    session->View = view;
    session->Device = device;
    session->DataTime = pqPalpateDataTime(space);
    session->SetSpace(copy);
    const auto clock = std::make_shared<palpate::MonotonicClock>();
    pqPalpateDevice opened = session->OpenDevice(clock, copy);
    session->MakeBodyView(copy, this->Current.InTissue);
    session->ShowSpace(copy);
    session->Servo = std::make_unique<palpate::Servo>(
      std::move(opened.Transport), std::move(opened.Profile), clock, opened.Setup.options);
    // The filter that shows the body moves one node, so one node is felt.
    session->TouchSettings.blended = false;
    session->Servo->set_touch(palpate::make_touch(session->Body));
    if (session->Recording)
    {
      opened.Setup.scene_hash = session->Body->scene_hash();
      session->Recording->Start(opened.Setup, *session->Servo);
    }
    session->Time.start();
    this->Running = std::move(session);
    this->applySettings({});
    this->Running->Servo->start();
    this->Watch.begin(space, view, this->Running->BodyView->GetFilter(),
      [servo = this->Running->Servo.get()] { servo->let_go(); });
  }
  catch (const std::exception& error)
  {
    this->end({}, pqPalpateRunWatch::Left::All);
    return error.what();
  }
  this->FrameTimer.start();
  Q_EMIT this->started();
  return {};
}

void pqPalpateTouch::stop()
{
  this->end({}, pqPalpateRunWatch::Left::All);
}

void pqPalpateTouch::end(const QString& why, pqPalpateRunWatch::Left left)
{
  if (!this->Running)
  {
    return;
  }
  this->FrameTimer.stop();
  const std::shared_ptr<Session> session = std::move(this->Running);
  const bool ended = session->Servo->stop();
  const palpate::Statistics statistics = session->Servo->statistics();
  const quint64 frames = session->BodyView->GetNumberOfFrames();
  vtkVLogF(PARAVIEW_LOG_PLUGIN_VERBOSITY(),
    "touched with %s: %llu ticks, %.1f /s, lateness 50 %% %.0f us, 99 %% %.0f us, 99.9 %% %.0f us, "
    "largest %.0f us, missed %llu, largest force %.3f N, %llu frames, %.1f /s",
    session->Device.toUtf8().constData(), static_cast<unsigned long long>(statistics.ticks),
    statistics.rate(), Microseconds(statistics.lateness.median),
    Microseconds(statistics.lateness.p99), Microseconds(statistics.lateness.p999),
    Microseconds(statistics.lateness.largest), static_cast<unsigned long long>(statistics.missed),
    statistics.largest_force, static_cast<unsigned long long>(frames),
    1e3 * static_cast<double>(frames) / std::max<qint64>(1, session->Time.elapsed()));
  this->closeRecording(*session, {});
  session->Mouse.reset();
  session->Tool.reset();
  // The fault that has ended it may come again here.
  const QString fault = pqPalpateFault([&] { session->BodyView->Leave(left); });
  Q_EMIT this->stopped(ended
      ? (why.isEmpty() ? fault : why)
      : "The device's driver hangs: the device itself has to switch its motors off.");
  // This comes last: any question to a server that is lost ends ParaView, and the message has to
  // come before that.
  this->Watch.end();
}

void pqPalpateTouch::closeRecording(Session& session, const QString& fault)
{
  if (const std::unique_ptr<pqPalpateRecording> recording = std::move(session.Recording))
  {
    const QString ownFault = recording->Close();
    Q_EMIT this->recorded(
      recording->GetFile(), recording->GetWritten(), ownFault.isEmpty() ? fault : ownFault);
  }
}

void pqPalpateTouch::setSettings(const Settings& settings)
{
  if (this->Running && settings.InTissue != this->Current.InTissue)
  {
    this->Running->BodyView->SetColours(settings.InTissue);
  }
  this->Current = settings;
}

void pqPalpateTouch::applySettings(const palpate::Tick& tick)
{
  Session& session = *this->Running;
  palpate::ServoSettings& servo = session.ServoSettings;
  servo.force_scale = this->Current.ForceScale;
  servo.force_limit = this->Current.ForceLimit;
  const bool isReal = !session.Mouse && !session.IsSimulatedHand();
  servo.dead_man_button = isReal && this->Current.NeedsButton
    ? palpate::dead_man_button_of(session.Servo->specification())
    : -1;
  session.TouchSettings.bonded = this->Current.Bonded;
  session.TouchSettings.release_force = this->Current.ReleaseForce;
  servo.grasp_button = -1;
  session.TouchSettings.friction = this->Current.Friction;
  if (session.Mouse)
  {
    servo.workspace_centre = session.Mouse->GetWorkspaceCentre();
    servo.grasp_button = pqPalpateGraspButton;
    session.TouchSettings.bonded = session.Mouse->IsHolding();
    // The mouse pulls no hand, so that it never has to let go.
    session.TouchSettings.release_force = 0;
  }
  else if (session.IsSimulatedHand())
  {
    servo.workspace_centre = session.HandCentre;
    servo.workspace_rotation = session.HandRotation;
  }
  // The workspace follows the camera only while the tool touches nothing, so that the tool is not
  // torn through the body.
  else if (!palpate::touches(tick.contact.status))
  {
    const palpate::Specification& device = session.Servo->specification();
    servo.workspace_centre = session.Centre;
    servo.workspace_scale = this->Current.WorkspaceScale > 0
      ? this->Current.WorkspaceScale
      : session.Radius / device.workspace_radius;
    servo.workspace_rotation =
      pqPalpateAxesOfDevice(this->Current.FollowsCamera ? session.View.data() : nullptr);
  }
  if (!session.Mouse && this->Current.GraspsWithButton)
  {
    const int last = session.Servo->specification().num_buttons - 1;
    servo.grasp_button = last > servo.dead_man_button ? last : -1;
  }
  session.TouchSettings.coupling_stiffness = palpate::coupling_stiffness_for(
    session.Servo->specification(), session.Body->largest_stiffness(), servo);
  session.Servo->set_settings(servo);
  session.Servo->set_touch_settings(session.TouchSettings);
}

void pqPalpateTouch::takeNewData()
{
  // The session may end while the data are on their way.
  const std::shared_ptr<Session> kept = this->Running;
  Session& session = *kept;
  const QString fault = pqPalpateFault(
    [&]
    {
      const vtkMTimeType time = pqPalpateDataTime(session.Space);
      if (time != 0 && time == session.DataTime)
      {
        return;
      }
      session.DataTime = time;
      const palpate::TouchSpace copy = pqPalpateFetchSpace(session.Space);
      if (this->Running != kept)
      {
        return;
      }
      const bool isOther = copy.scene_hash != session.Body->scene_hash();
      session.SetSpace(copy);
      session.ShowSpace(copy);
      session.Servo->set_touch(palpate::make_touch(session.Body));
      if (isOther && session.Recording)
      {
        session.Servo->set_recording(nullptr);
        this->closeRecording(session, "The body has become another one: the recording ends there.");
      }
      if (session.Node >= 0 && session.Body->find(session.Node) < 0)
      {
        session.Node = -1;
        session.BodyView->ShowRest();
      }
    });
  if (!fault.isEmpty())
  {
    this->end(fault, pqPalpateRunWatch::Left::View);
  }
}

void pqPalpateTouch::showFrame()
{
  const QString fault = pqPalpateFault([this] { this->advance(); });
  if (!fault.isEmpty())
  {
    this->end(fault, pqPalpateRunWatch::Left::All);
  }
}

void pqPalpateTouch::advance()
{
  if (this->Watch.hearsEscape())
  {
    this->stop();
  }
  if (this->Running)
  {
    this->Running->Servo->host_lives();
  }
  // Rendering may handle events, also those of the timer.
  if (!this->Running || this->IsShowing || this->Running->Source->getServer()->isProgressPending())
  {
    return;
  }
  const QScopedValueRollback<bool> showing(this->IsShowing, true);
  const std::shared_ptr<Session> kept = this->Running;
  Session& session = *kept;
  const palpate::Tick tick = session.Servo->latest();
  if (tick.state == palpate::ServoState::gone)
  {
    this->end("The device is gone: " + QString::fromStdString(session.Servo->problem()),
      pqPalpateRunWatch::Left::All);
    return;
  }
  if (session.Mouse)
  {
    session.Mouse->Advance(tick);
  }
  this->applySettings(tick);

  // A space that grows is computed on here and not within the frame, where progress would not be
  // shown and the button not heard.
  vtkSMPropertyHelper growth(session.Source->getProxy(), "UpdateInterval", true);
  if (growth.GetAsDouble() > 0)
  {
    session.Source->updatePipeline();
  }
  if (this->Running == kept)
  {
    this->show(tick);
  }
  if (this->Running == kept)
  {
    Q_EMIT this->sampled(
      1e-3 * session.Time.elapsed(), tick.force.norm(), tick.contact.force.norm());
  }
}

void pqPalpateTouch::show(const palpate::Tick& tick)
{
  Session& session = *this->Running;
  const palpate::Contact& contact = tick.contact;
  const bool touches = palpate::touches(contact.status);
  const bool presses = contact.status == palpate::ContactStatus::pressing;
  const bool holds = touches && !presses;
  const int node = holds ? contact.nodes[0] : presses ? -1 : session.Node;
  const int branch = holds ? contact.branches[0] : 0;
  const Vec3 displacement = holds ? contact.displacement : Vec3::Zero();
  const Vec3 pressed = presses ? contact.anchor : session.Away();
  const bool moved = node != session.Node || branch != session.Branch ||
    displacement != session.Displacement || pressed != session.Pressed;
  const bool showsFree = !session.Mouse || session.Mouse->ShowsTool();
  const bool says = session.Mouse && session.Tool->Say(session.Mouse->GetHint());
  if (!moved && !says && touches == session.Touches && showsFree == session.ShowsFree &&
    (!showsFree || tick.position == session.Place))
  {
    session.BodyView->Rest();
    return;
  }
  if (moved)
  {
    if (holds || session.Deepest == 0)
    {
      session.BodyView->Show(node, branch, displacement.data());
    }
    else
    {
      session.BodyView->ShowPressed(pressed.data());
    }
    // That a server is gone is noticed only when something is sent to it, so that the session may
    // have ended here.
    if (this->Running.get() != &session)
    {
      return;
    }
  }
  session.Node = node;
  session.Branch = branch;
  session.Displacement = displacement;
  session.Pressed = pressed;
  session.ShowsFree = showsFree;
  session.Place = tick.position;
  session.Touches = touches;
  session.Tool->Show(tick, showsFree, session.Depth(contact));
  session.BodyView->Draw();
}

pqPalpateTouch::Figures pqPalpateTouch::figures()
{
  Figures figures;
  if (!this->Running)
  {
    figures.State = "closed";
    return figures;
  }
  Session& session = *this->Running;
  const palpate::Tick tick = session.Servo->latest();
  const palpate::Statistics statistics = session.Servo->statistics();
  const std::string_view state = palpate::to_string(tick.state);
  figures.State = QString::fromUtf8(state.data(), static_cast<int>(state.size()));
  figures.Contact = Words(tick.contact.status);
  figures.Rate = statistics.rate();
  figures.FrameRate = session.BodyView->GetFrameRate();
  figures.Lateness[0] = Microseconds(statistics.lateness.median);
  figures.Lateness[1] = Microseconds(statistics.lateness.p99);
  figures.Lateness[2] = Microseconds(statistics.lateness.largest);
  figures.Ticks = statistics.ticks;
  figures.Missed = statistics.missed;
  figures.Force = tick.force.norm();
  figures.BodyForce = tick.contact.force.norm();
  figures.Depth = session.Depth(tick.contact);
  figures.Dissipated = tick.dissipated;
  figures.Damping = tick.added_damping;
  if (tick.contact.status == palpate::ContactStatus::attached)
  {
    figures.Node = tick.contact.nodes[0];
    figures.Branch = tick.contact.branches[0];
    figures.Support = Words(tick.contact.support);
  }
  if (tick.contact.status == palpate::ContactStatus::pressing)
  {
    figures.Support = Words(tick.contact.support);
    const Vec3 push = -tick.contact.force.stableNormalized();
    figures.DepthLeft = palpate::depth_left(
      *session.Body->force_on_tool(), tick.contact.anchor, push, 2 * session.Deepest);
  }
  if (session.Recording)
  {
    figures.Recorded = session.Recording->GetWritten();
    figures.NotRecorded = session.Recording->GetDropped();
  }
  figures.Problem = QString::fromStdString(session.Servo->problem());
  const std::string_view why = palpate::words_for(tick.tripped);
  if (!why.empty())
  {
    figures.Problem =
      "There is no force: " + QString::fromUtf8(why.data(), static_cast<int>(why.size())) +
      ". It comes back when that is over and the tool was outside of the body.";
  }
  return figures;
}

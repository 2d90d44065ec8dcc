// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateTouch.h"

#include <algorithm>
#include <exception>
#include <optional>
#include <utility>

#include "haptic/exploring/expected_press.h"
#include "haptic/servo/interlock.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"
#include "haptic/touching/pressing_range.h"
#include "pqPalpateExploration.h"
#include "pqPalpateFault.h"
#include "pqPalpateFetch.h"
#include "pqPalpateNodeMouse.h"
#include "pqPalpateToolMouse.h"
#include "pqPalpateToolView.h"
#include "vtkPVLogger.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"

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

/// What is said of a force that is extrapolated: in a space that is as large as it will be, and in
/// one that is explored around the hand.
constexpr const char* Beyond = "beyond the space";
constexpr const char* Estimated = "estimated, being computed";

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
    case palpate::ContactStatus::cutting:
      return "cutting";
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
      return Beyond;
    case palpate::Support::marked:
      return "in a marked region";
  }
  return {};
}

/// Of all configurations, N.
double LargestForce(const palpate::TouchSpace& space)
{
  double largest = 0;
  for (const palpate::TouchToolSpace& toolSpace : space.tool_spaces)
  {
    for (const palpate::ConfigurationSummary& configuration : toolSpace.configurations)
    {
      if (configuration.usable())
      {
        largest = std::max(largest, configuration.force.norm());
      }
    }
  }
  return largest;
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
struct pqPalpateTouch::Session : pqPalpateRun::Session
{
  using pqPalpateRun::Session::Session;

  pqPalpateRun::Hand Hand;
  vtkMTimeType DataTime = 0;
  std::shared_ptr<const palpate::Touchable> Body;
  /// Whether the force of the body is corrected for the error of the mesh.
  bool CorrectsMeshError = true;
  /// How deep the rigid tool presses, m; 0: there is none.
  double Deepest = 0;
  palpate::RigidTool RigidTool;
  /// The points of the surface that a rigid tool can press.
  std::vector<char> Pressable;
  /// What explores the space meanwhile; null: nothing does.
  std::unique_ptr<pqPalpateExploration> Exploration;
  /// The space that takes the place of this one as soon as its body is felt where the hand is.
  std::optional<palpate::TouchSpace> Coming;
  /// Whether more was found since the body was last shown.
  bool HasGrown = false;
  /// The settings of the touch as they were last set.
  palpate::TouchSettings TouchSettings;
  std::unique_ptr<pqPalpateToolView> Tool;

  /// The node and the branch that are shown.
  int Node = -1;
  palpate::BodyId OnBody = palpate::kFirstBody;
  double TornArea = 0;
  int Branch = 0;
  Vec3 Displacement = Vec3::Zero();
  Vec3 Pressed = Vec3::Zero();
  Vec3 Place = Vec3::Zero();
  bool ShowsFree = false;
  bool Touches = false;

  /// Whether the filter that shows the body corrects its force for the error of the mesh; what is
  /// felt is what it tells.
  bool AsksForCorrection() const
  {
    pqPipelineSource* filter = this->BodyView ? this->BodyView->GetFilter() : nullptr;
    return !filter || vtkSMPropertyHelper(filter->getProxy(), "CorrectMeshError").GetAsInt() != 0;
  }

  palpate::TouchableOptions Options()
  {
    palpate::TouchableOptions options;
    this->CorrectsMeshError = this->AsksForCorrection();
    options.interpolation.correct_mesh_error = this->CorrectsMeshError;
    return options;
  }

  /// Takes the client's copy of the space.
  void SetSpace(const palpate::TouchSpace& space)
  {
    this->Body = std::make_shared<const palpate::Touchable>(space, this->Options());
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
    const palpate::TouchToolSpace* rigid = space.find_pressing();
    this->Deepest = rigid ? rigid->setup.depth() : 0;
    this->RigidTool = rigid ? rigid->setup.interaction.tool : palpate::RigidTool();
    this->Pressable.clear();
    if (rigid)
    {
      this->Pressable = this->Exploration
        ? this->Exploration->Pressable(space.surface)
        : palpate::pressable_points(space.surface, this->RigidTool, *this->Body->force_on_tool());
    }
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
    return contact.status == palpate::ContactStatus::attached ? contact.displacement.norm() : -1;
  }

  /// A place where a rigid tool touches nothing, m.
  Vec3 Away() const { return this->Centre + this->Radius * Vec3::Ones(); }

  /// Makes what is drawn over the body, and the mouse that finds it.
  void ShowSpace(const palpate::TouchSpace& space)
  {
    vtkSMRenderViewProxy* view = this->View->getRenderViewProxy();
    const palpate::TouchToolSpace* rigid = space.find_pressing();
    this->Tool = std::make_unique<pqPalpateToolView>(view, space, *this->Body, this->Pressable,
      this->Exploration ? this->Exploration->Expected(*rigid).force : LargestForce(space),
      this->Exploration ? Estimated : Beyond);
    if (const auto& motion = this->Hand.Motion)
    {
      std::unique_ptr<pqPalpateMouse> mouse;
      if (this->Body->force_on_tool())
      {
        mouse = std::make_unique<pqPalpateToolMouse>(
          view, space, this->Body, motion, this->Pressable, this->Exploration != nullptr);
      }
      else
      {
        mouse = std::make_unique<pqPalpateNodeMouse>(view, space, this->Body, motion);
      }
      if (this->Hand.Mouse)
      {
        mouse->GoOnFrom(*this->Hand.Mouse);
      }
      this->Hand.Mouse = std::move(mouse);
      this->Tool->Say(this->Hand.Mouse->GetHint());
    }
    // This draws the view, because no frame is drawn as long as nothing is touched.
    this->View->render();
  }

  /// The way of the simulated hand.
  pqPalpateRun::HandWay HandWay(const palpate::TouchSpace& space) const
  {
    const palpate::TouchToolSpace* rigid = space.find_pressing();
    const palpate::ToolSpaceSetup& setup = (rigid ? *rigid : space.tool_spaces.front()).setup;
    const auto [place, normal, depth] = palpate::start_place(space, *this->Body, this->Pressable);
    const double height =
      rigid ? HandRoom * setup.grid.coarsest * setup.grid.spacing() : HandHeight * depth;
    return { place, normal, height, height + HandDepth * depth };
  }

  void MakeBodyView(const palpate::TouchSpace& space, bool inTissue)
  {
    const palpate::TouchToolSpace* rigid = space.find_pressing();
    const double depth = space.tool_spaces.front().setup.depth();
    const double most = !rigid ? depth
      : this->Exploration      ? this->Exploration->Expected(*rigid).pressure
                               : UsualPressure(*rigid);
    this->BodyView = std::make_unique<pqPalpateBodyView>(this->Port, this->View,
      rigid ? "ContactPressure" : "Displacement", most, inTissue, this->Away().data());
  }
};

pqPalpateTouch::pqPalpateTouch(QObject* parent)
  : pqPalpateRun(parent)
{
}

pqPalpateTouch::~pqPalpateTouch()
{
  this->end({}, pqPalpateRunWatch::Left::Nothing);
}

std::shared_ptr<pqPalpateTouch::Session> pqPalpateTouch::session() const
{
  return std::static_pointer_cast<Session>(this->Running);
}

QString pqPalpateTouch::start(
  pqOutputPort* space, pqRenderView* view, const QString& device, const QString& recording)
{
  this->stop();
  try
  {
    auto session = std::make_shared<Session>(space, view);
    Hand& hand = session->Hand;
    hand.Device = device;
    // The recording is made first, because without it there is no reason to open a device.
    if (!recording.isEmpty())
    {
      hand.Recording = std::make_unique<pqPalpateRecording>(recording);
    }
    const palpate::TouchSpace copy = pqPalpateFetchSpace(space);
    session->DataTime = pqPalpateDataTime(space);
    session->Exploration = pqPalpateExploration::Of(space);
    session->SetSpace(copy);
    const auto clock = std::make_shared<palpate::MonotonicClock>();
    pqPalpateDevice opened = open(hand, clock, [&] { return session->HandWay(copy); });
    session->MakeBodyView(copy, this->Current.InTissue);
    if (!session->AsksForCorrection())
    {
      session->SetSpace(copy);
    }
    session->ShowSpace(copy);
    hand.Servo = std::make_unique<palpate::Servo>(
      std::move(opened.Transport), std::move(opened.Profile), clock, opened.Setup.options);
    // The filter that shows the body moves one node, so one node is felt.
    session->TouchSettings.blended = false;
    hand.Servo->set_touch(palpate::make_touch(session->Body));
    if (session->Exploration)
    {
      session->Exploration->Begin(this->Current.Explorers, session->Options(), hand.Servo.get(),
        pqPalpateExploration::Giving::AtOnce);
      session->TouchSettings.grows = true;
    }
    if (hand.Recording)
    {
      opened.Setup.scene_hash = session->Body->scene_hash();
      hand.Recording->Start(opened.Setup, *hand.Servo);
    }
    session->Time.start();
    this->Running = session;
    this->applySettings();
    hand.Servo->start();
    this->Watch.begin(
      space, view, session->BodyView->GetFilter(), [servo = hand.Servo.get()] { servo->let_go(); });
  }
  catch (const std::exception& error)
  {
    this->end({}, pqPalpateRunWatch::Left::All);
    return error.what();
  }
  this->hasBegun();
  return {};
}

QString pqPalpateTouch::endLoops(pqPalpateRun::Session& ended)
{
  auto& session = static_cast<Session&>(ended);
  Hand& hand = session.Hand;
  const bool hasEnded = hand.Servo->stop();
  QString notKept;
  if (session.Exploration)
  {
    notKept = session.Exploration->End();
    session.Exploration->HandOver();
  }
  const palpate::Statistics statistics = hand.Servo->statistics();
  const quint64 frames = session.BodyView->GetNumberOfFrames();
  vtkVLogF(PARAVIEW_LOG_PLUGIN_VERBOSITY(),
    "touched with %s: %llu ticks, %.1f /s, lateness 50 %% %.0f us, 99 %% %.0f us, 99.9 %% %.0f us, "
    "largest %.0f us, missed %llu, largest force %.3f N, %llu frames, %.1f /s",
    hand.Device.toUtf8().constData(), static_cast<unsigned long long>(statistics.ticks),
    statistics.rate(), microseconds(statistics.lateness.median),
    microseconds(statistics.lateness.p99), microseconds(statistics.lateness.p999),
    microseconds(statistics.lateness.largest), static_cast<unsigned long long>(statistics.missed),
    statistics.largest_force, static_cast<unsigned long long>(frames),
    1e3 * static_cast<double>(frames) / std::max<qint64>(1, session.Time.elapsed()));
  this->closeRecording(std::move(hand.Recording));
  hand.Mouse.reset();
  session.Tool.reset();
  return hasEnded ? notKept
                  : "The device's driver hangs: the device itself has to switch its motors off.";
}

void pqPalpateTouch::applySettings()
{
  Session& session = *this->session();
  Hand& hand = session.Hand;
  this->findSettings(session, hand, true);
  hand.Settings.force_scale = this->Current.ForceScale;
  session.TouchSettings.bonded = this->Current.Bonded;
  session.TouchSettings.release_force = this->Current.ReleaseForce;
  session.TouchSettings.friction = this->Current.Friction;
  session.TouchSettings.fracture_toughness = this->Current.FractureToughness;
  session.TouchSettings.is_blade = this->Current.IsBlade && session.Body->torn().is_cut();
  session.TouchSettings.blade_toughness = this->Current.BladeToughness;
  session.TouchSettings.blade_stiffness = this->Current.BladeStiffness;
  session.TouchSettings.blade_friction = this->Current.BladeFriction;
  if (hand.Mouse)
  {
    hand.Mouse->SetBlade(session.TouchSettings.is_blade);
    session.TouchSettings.bonded = hand.Mouse->IsHolding();
    session.TouchSettings.reach = hand.Mouse->GetReach();
    // The mouse pulls no hand, so that it never has to let go.
    session.TouchSettings.release_force = 0;
  }
  else if (hand.IsReal() && !palpate::touches(hand.Tick.contact.status))
  {
    hand.Settings.workspace_scale = this->Current.WorkspaceScale > 0
      ? this->Current.WorkspaceScale
      : session.Radius / hand.Servo->specification().workspace_radius;
  }
  session.TouchSettings.coupling_stiffness =
    palpate::coupling_stiffness_for(hand.Servo->specification(),
      palpate::stiffest(*session.Body, session.TouchSettings), hand.Settings);
  hand.Servo->set_settings(hand.Settings);
  hand.Servo->set_touch_settings(session.TouchSettings);
}

void pqPalpateTouch::takeNewData()
{
  // The session may end while the data are on their way.
  const std::shared_ptr<Session> kept = this->session();
  Session& session = *kept;
  const QString fault = pqPalpateFault(
    [&]
    {
      const vtkMTimeType time = pqPalpateDataTime(session.Port);
      if (time != 0 && time == session.DataTime &&
        session.AsksForCorrection() == session.CorrectsMeshError)
      {
        return;
      }
      session.DataTime = time;
      const palpate::TouchSpace copy = pqPalpateFetchSpace(session.Port);
      if (this->Running != kept)
      {
        return;
      }
      if (session.Exploration)
      {
        const QString notKept = session.Exploration->End();
        if (!notKept.isEmpty())
        {
          this->end(notKept, pqPalpateRunWatch::Left::All);
          return;
        }
        session.Exploration = pqPalpateExploration::Of(session.Port);
        session.TouchSettings.grows = session.Exploration != nullptr;
      }
      if (session.Exploration)
      {
        // The body as it was is felt until enough of this one is known.
        session.Exploration->Begin(this->Current.Explorers, session.Options(),
          session.Hand.Servo.get(), pqPalpateExploration::Giving::WhereTheHandIs);
        session.Coming = copy;
        return;
      }
      this->takeSpace(copy);
      session.Hand.Servo->set_touch(palpate::make_touch(session.Body, palpate::Relation::changed));
      if (session.Node >= 0 && session.Body->find(session.Node, session.OnBody) < 0)
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

void pqPalpateTouch::takeSpace(const palpate::TouchSpace& space)
{
  Session& session = *this->session();
  const bool isOther = !palpate::is_same_space(space.scene_hash, session.Body->scene_hash());
  session.SetSpace(space);
  session.ShowSpace(space);
  if (isOther && session.Hand.Recording)
  {
    session.Hand.Servo->set_recording(nullptr);
    this->closeRecording(std::move(session.Hand.Recording),
      "The body has become another one: the recording ends there.");
  }
}

void pqPalpateTouch::tellLives()
{
  this->session()->Hand.Servo->host_lives();
}

void pqPalpateTouch::advance()
{
  const std::shared_ptr<Session> kept = this->session();
  Session& session = *kept;
  Hand& hand = session.Hand;
  hand.Tick = hand.Servo->latest();
  if (hand.Tick.state == palpate::ServoState::gone)
  {
    this->end("The device is gone: " + QString::fromStdString(hand.Servo->problem()),
      pqPalpateRunWatch::Left::All);
    return;
  }
  if (hand.Mouse)
  {
    hand.Mouse->Advance(hand.Tick);
  }
  if (session.AsksForCorrection() != session.CorrectsMeshError)
  {
    this->takeNewData();
    if (this->Running != kept)
    {
      return;
    }
  }
  this->applySettings();
  session.Force = hand.Tick.force.norm();
  session.BodyForce = hand.Tick.contact.force.norm();

  if (session.Exploration)
  {
    if (auto grown = session.Exploration->TakeGrown())
    {
      if (const auto coming = std::exchange(session.Coming, std::nullopt))
      {
        this->takeSpace(*coming);
        if (this->Running != kept)
        {
          return;
        }
      }
      session.Body = std::move(grown);
      session.HasGrown = true;
    }
  }
  else if (vtkSMPropertyHelper(session.Source->getProxy(), "UpdateInterval", true).GetAsDouble() >
    0)
  {
    // A space that grows is computed on here and not within the frame, where progress would not be
    // shown and the button not heard.
    session.Source->updatePipeline();
  }
  if (this->Running == kept)
  {
    this->show();
  }
}

void pqPalpateTouch::show()
{
  Session& session = *this->session();
  const palpate::Tick& tick = session.Hand.Tick;
  const pqPalpateMouse* mouse = session.Hand.Mouse.get();
  const palpate::Contact& contact = tick.contact;
  const bool touches = palpate::touches(contact.status);
  const bool presses = contact.status == palpate::ContactStatus::pressing;
  // What is held stays so while a blade is moved.
  const bool holds = contact.nodes[0] >= 0;
  const int node = holds ? contact.nodes[0] : presses ? -1 : session.Node;
  const palpate::BodyId body = holds ? contact.bodies[0]
    : presses                        ? palpate::kFirstBody
                                     : session.OnBody;
  const int branch = touches ? contact.branches[0] : 0;
  const Vec3 displacement = holds ? contact.displacement : Vec3::Zero();
  const Vec3 pressed = presses ? contact.anchor : session.Away();
  const bool grew = presses && std::exchange(session.HasGrown, false);
  const bool moved = grew || node != session.Node || body != session.OnBody ||
    branch != session.Branch || contact.torn_area != session.TornArea ||
    displacement != session.Displacement || pressed != session.Pressed;
  // Where a blade stands still, its force may change.
  const bool cuts = contact.status == palpate::ContactStatus::cutting;
  const bool showsFree = !mouse || mouse->ShowsTool();
  const bool says = mouse && session.Tool->Say(mouse->GetHint());
  if (!moved && !says && !cuts && touches == session.Touches && showsFree == session.ShowsFree &&
    (!showsFree || tick.position == session.Place))
  {
    session.BodyView->Rest();
    return;
  }
  if (moved)
  {
    if (holds || session.Deepest == 0)
    {
      session.BodyView->Show(node, body, branch, displacement.data(), contact.torn_area);
    }
    else
    {
      session.BodyView->ShowPressed(pressed.data(), branch, grew);
    }
    // That a server is gone is noticed only when something is sent to it, so that the session may
    // have ended here.
    if (this->Running.get() != &session)
    {
      return;
    }
  }
  session.Node = node;
  session.OnBody = body;
  session.Branch = branch;
  session.TornArea = contact.torn_area;
  session.Displacement = displacement;
  session.Pressed = pressed;
  session.ShowsFree = showsFree;
  session.Place = tick.position;
  session.Touches = touches;
  session.Tool->Show(tick, showsFree, session.Depth(contact));
  session.BodyView->Draw();
}

pqPalpateHeldTool pqPalpateTouch::heldTool() const
{
  pqPalpateHeldTool held;
  if (!this->Running)
  {
    return held;
  }
  const palpate::Contact contact = this->session()->Hand.Servo->latest().contact;
  held.Touches = palpate::touches(contact.status);
  const bool presses = contact.status == palpate::ContactStatus::pressing;
  held.Node = contact.nodes[0];
  const Vec3& place = presses ? contact.anchor : contact.displacement;
  held.Place = { place[0], place[1], place[2] };
  return held;
}

pqPalpateTouch::Figures pqPalpateTouch::figures()
{
  Figures figures;
  if (!this->Running)
  {
    figures.State = "closed";
    return figures;
  }
  Session& session = *this->session();
  palpate::Servo& servo = *session.Hand.Servo;
  const palpate::Tick tick = servo.latest();
  const palpate::Statistics statistics = servo.statistics();
  takePace(session, statistics, figures);
  figures.Number = statistics.ticks;
  figures.State = words(palpate::to_string(tick.state));
  figures.Contact = Words(tick.contact.status);
  figures.Force = tick.force.norm();
  figures.BodyForce = tick.contact.force.norm();
  figures.Depth = session.Depth(tick.contact);
  figures.MeshError = tick.contact.mesh_error;
  figures.HasCut = session.Body->torn().is_cut();
  figures.TornArea = tick.contact.torn_area;
  figures.HandWork = tick.contact.hand_work;
  figures.Stored = tick.contact.energy;
  figures.TornWork = tick.contact.torn_work;
  figures.FrictionWork = tick.contact.friction_work;
  figures.Dissipated = tick.dissipated;
  figures.Damping = tick.added_damping;
  if (tick.contact.status == palpate::ContactStatus::attached)
  {
    figures.Node = tick.contact.nodes[0];
    figures.Branch = tick.contact.branches[0];
    figures.Support = Words(tick.contact.support);
  }
  // The newest tick may still be of a body that was taken away since.
  if (tick.contact.status == palpate::ContactStatus::pressing && session.Body->force_on_tool())
  {
    figures.Support = Words(tick.contact.support);
    if (session.Exploration && tick.contact.support == palpate::Support::extrapolated)
    {
      figures.Support = Estimated;
    }
    else
    {
      const Vec3 push = -tick.contact.force.stableNormalized();
      figures.DepthLeft = palpate::depth_left(
        *session.Body->force_on_tool(), tick.contact.anchor, push, 2 * session.Deepest);
    }
  }
  addRecorded(session.Hand, figures);
  figures.Problem = QString::fromStdString(servo.problem());
  if (session.Exploration)
  {
    QString problem;
    figures.Explored = session.Exploration->InWords(problem);
    figures.Problem = figures.Problem.isEmpty() ? problem : figures.Problem;
  }
  const std::string_view why = palpate::words_for(tick.tripped);
  if (!why.empty())
  {
    figures.Problem = "There is no force: " + words(why) +
      ". It comes back when that is over and the tool was outside of the body.";
  }
  return figures;
}

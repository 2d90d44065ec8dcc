// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateReducedTouch.h"

#include <QFileInfo>
#include <algorithm>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "haptic/servo/interlock.h"
#include "haptic/servo/servo.h"
#include "haptic/simulating/coupled_tool.h"
#include "haptic/simulating/reduced_body_thread.h"
#include "pqPalpateFault.h"
#include "pqPalpateFetch.h"
#include "pqPalpateReducedMouse.h"
#include "pqPalpateToolView.h"
#include "vtkPVLogger.h"
#include "vtkSMRenderViewProxy.h"

using palpate::Vec3;

namespace
{
/// The distance from the tool at which the simulated hand begins, in reaches of the tool, and how
/// far it moves the tool, as a share of what the model was trained for.
constexpr double HeldHeight = 1.2;
constexpr double HeldDepth = 0.6;

QString WordsOfHold(palpate::ContactStatus status)
{
  switch (status)
  {
    case palpate::ContactStatus::nothing:
      return "no body";
    case palpate::ContactStatus::free:
      return "not held";
    case palpate::ContactStatus::inside:
      return "not held until the hand was outside";
    case palpate::ContactStatus::attached:
    case palpate::ContactStatus::pressing:
    case palpate::ContactStatus::cutting:
      return "held";
  }
  return {};
}

/// The largest value of a coordinate of the tool in training, m.
double Trained(const palpate::ReducedModel& model, int tool)
{
  return model.trained_tools.segment<3>(3 * tool).maxCoeff();
}
}

/// The objects that exist while it runs.
struct pqPalpateReducedTouch::Session : pqPalpateRun::Session
{
  using pqPalpateRun::Session::Session;

  pqPalpateReducedSpace Space;
  /// The figures of the model that is touched, see pqPalpateMarkReduced().
  std::vector<double> Mark;
  pqPalpateRun::Settings Settings;
  QString Recording;
  std::shared_ptr<palpate::Clock> Clock = std::make_shared<palpate::MonotonicClock>();
  std::vector<palpate::SimulatedToolOptions> Options;
  std::unique_ptr<palpate::ReducedBodyThread> Body;
  /// The hand of each tool; null: no device moves the tool.
  std::vector<std::unique_ptr<Hand>> Hands;
  /// Guards the list of hands, because Escape lets go of all of them on a thread of its own.
  std::mutex Mutex;
  std::vector<std::unique_ptr<pqPalpateToolView>> Tools;
  /// The coordinates that were last shown.
  Eigen::VectorXd Coordinates;

  void LetGo()
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    for (const std::unique_ptr<Hand>& hand : this->Hands)
    {
      if (hand)
      {
        hand->Servo->let_go();
      }
    }
  }

  std::unique_ptr<Hand> Exchange(int tool, std::unique_ptr<Hand> hand)
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    return std::exchange(this->Hands[static_cast<std::size_t>(tool)], std::move(hand));
  }
};

pqPalpateReducedTouch::pqPalpateReducedTouch(QObject* parent)
  : pqPalpateRun(parent)
{
}

pqPalpateReducedTouch::~pqPalpateReducedTouch()
{
  this->end({}, pqPalpateRunWatch::Left::Nothing);
}

std::shared_ptr<pqPalpateReducedTouch::Session> pqPalpateReducedTouch::session() const
{
  return std::static_pointer_cast<Session>(this->Running);
}

void pqPalpateReducedTouch::takeNewData()
{
  std::vector<double> mark;
  const std::shared_ptr<Session> session = this->session();
  QString why = pqPalpateFault([&] { mark = pqPalpateMarkReduced(session->Port); });
  if (why.isEmpty() && mark != session->Mark)
  {
    why = "The reduced model was made anew. Start again to touch the new one.";
  }
  if (!why.isEmpty())
  {
    this->end(why, pqPalpateRunWatch::Left::All);
  }
}

std::unique_ptr<pqPalpateRun::Hand> pqPalpateReducedTouch::makeHand(
  Session& session, int tool, const QString& device)
{
  auto hand = std::make_unique<Hand>();
  hand->Device = device;
  const auto number = static_cast<std::size_t>(tool);
  const Vec3& place = session.Space.Places[number];
  const palpate::SimulatedToolOptions& options = session.Options[number];
  pqPalpateDevice opened = open(*hand, session.Clock,
    [&]
    {
      const double height = HeldHeight * options.reach;
      // The hand takes hold where it comes within reach.
      return HandWay{ place, (place - session.Centre).normalized(), height,
        height - options.reach + HeldDepth * Trained(*session.Space.Model, tool) };
    });
  if (hand->Motion)
  {
    hand->Mouse = std::make_unique<pqPalpateReducedMouse>(
      session.View->getRenderViewProxy(), session.Space.Surface, place, hand->Motion);
  }
  hand->Servo = std::make_unique<palpate::Servo>(
    std::move(opened.Transport), std::move(opened.Profile), session.Clock, opened.Setup.options);
  hand->Settings.force_scale = session.Settings.ForceScale;
  if (hand->IsReal())
  {
    hand->Settings.workspace_scale = session.Settings.WorkspaceScale > 0
      ? session.Settings.WorkspaceScale
      : session.Radius / hand->Servo->specification().workspace_radius;
  }
  // The settings are applied before anything is started, because the device may lack what they ask
  // for.
  this->applySettings(session, *hand);
  if (!session.Recording.isEmpty())
  {
    const QFileInfo file(session.Recording);
    const QString ending = file.suffix().isEmpty() ? QString() : "." + file.suffix();
    hand->Recording = std::make_unique<pqPalpateRecording>(
      QString("%1/%2-tool%3%4")
        .arg(file.path(), file.completeBaseName(), QString::number(tool), ending));
    hand->Recording->Start(opened.Setup, *hand->Servo);
  }
  return hand;
}

void pqPalpateReducedTouch::applySettings(Session& session, Hand& hand) const
{
  this->findSettings(session, hand, false);
  hand.Servo->set_settings(hand.Settings);
}

QString pqPalpateReducedTouch::start(pqOutputPort* model, pqRenderView* view,
  const QVector<QString>& devices, const QString& recording)
{
  this->stop();
  try
  {
    auto session = std::make_shared<Session>(model, view);
    session->Space = pqPalpateFetchReduced(model);
    const palpate::ReducedModel& reduced = *session->Space.Model;
    session->Coordinates = Eigen::VectorXd::Zero(reduced.num_coordinates());
    session->Mark = pqPalpateMarkReduced(model);
    session->Settings = this->Current;
    session->Recording = recording;
    Eigen::AlignedBox3d box;
    for (const Vec3& point : session->Space.Surface.points)
    {
      box.extend(point);
    }
    session->Centre = box.center();
    const double size = box.diagonal().norm();
    session->Radius = Room * size / 2;
    const int tools = static_cast<int>(session->Space.Places.size());
    for (int tool = 0; tool < tools; ++tool)
    {
      palpate::SimulatedToolOptions options;
      options.place = session->Space.Places[static_cast<std::size_t>(tool)];
      options.reach = Trained(reduced, tool);
      session->Options.push_back(options);
    }
    session->Hands.resize(static_cast<std::size_t>(tools));
    for (int tool = 0; tool < std::min(tools, static_cast<int>(devices.size())); ++tool)
    {
      if (devices[tool].isEmpty())
      {
        continue;
      }
      std::unique_ptr<Hand> hand = this->makeHand(*session, tool, devices[tool]);
      palpate::SimulatedToolOptions& options = session->Options[static_cast<std::size_t>(tool)];
      options.coupling_stiffness = palpate::coupling_stiffness_of_tool(
        hand->Servo->specification(), options.coupling_stiffness, hand->Settings);
      session->Hands[static_cast<std::size_t>(tool)] = std::move(hand);
    }
    session->Body = std::make_unique<palpate::ReducedBodyThread>(
      session->Space.Model, session->Options, session->Clock);
    session->BodyView = std::make_unique<pqPalpateBodyView>(
      model, view, reduced.trained_tools.maxCoeff(), this->Current.InTissue);
    for (int tool = 0; tool < tools; ++tool)
    {
      const double stiffness = reduced.tool_stiffness.block<3, 3>(3 * tool, 3 * tool).norm();
      session->Tools.push_back(std::make_unique<pqPalpateToolView>(view->getRenderViewProxy(),
        session->Space.Places[static_cast<std::size_t>(tool)], size,
        stiffness * Trained(reduced, tool)));
    }
    view->render();
    session->Time.start();
    session->Body->start();
    for (int tool = 0; tool < tools; ++tool)
    {
      if (Hand* hand = session->Hands[static_cast<std::size_t>(tool)].get())
      {
        hand->Servo->set_touch(std::make_unique<palpate::CoupledTool>(session->Body->tool(tool)));
        hand->Servo->start();
      }
    }
    this->Watch.begin(
      model, view, session->BodyView->GetFilter(), [s = session.get()] { s->LetGo(); });
    this->Running = std::move(session);
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  this->hasBegun();
  return {};
}

QString pqPalpateReducedTouch::setDevice(int tool, const QString& device)
{
  const std::shared_ptr<Session> session = this->session();
  if (!session || tool < 0 || tool >= static_cast<int>(session->Hands.size()))
  {
    return {};
  }
  if (!this->endHand(*session, tool))
  {
    return "The device's driver hangs: the device itself has to switch its motors off.";
  }
  if (device.isEmpty())
  {
    return {};
  }
  try
  {
    std::unique_ptr<Hand> hand = this->makeHand(*session, tool, device);
    const double coupling = session->Options[static_cast<std::size_t>(tool)].coupling_stiffness;
    const double displayed =
      palpate::coupling_stiffness_of_tool(hand->Servo->specification(), coupling, hand->Settings);
    if (displayed < coupling)
    {
      throw std::runtime_error(
        "The tool is coupled more stiffly than this device displays stably. Stop, choose the "
        "device, and start again.");
    }
    hand->Servo->set_touch(std::make_unique<palpate::CoupledTool>(session->Body->tool(tool)));
    hand->Servo->start();
    session->Exchange(tool, std::move(hand));
  }
  catch (const std::exception& error)
  {
    return error.what();
  }
  return {};
}

QString pqPalpateReducedTouch::device(int tool) const
{
  const std::shared_ptr<Session> session = this->session();
  const Hand* hand = session && tool < static_cast<int>(session->Hands.size())
    ? session->Hands[static_cast<std::size_t>(tool)].get()
    : nullptr;
  return hand ? hand->Device : QString();
}

bool pqPalpateReducedTouch::endHand(Session& session, int tool)
{
  const std::unique_ptr<Hand> hand = session.Exchange(tool, nullptr);
  if (!hand)
  {
    return true;
  }
  const bool ended = hand->Servo->stop();
  const palpate::Statistics statistics = hand->Servo->statistics();
  vtkVLogF(PARAVIEW_LOG_PLUGIN_VERBOSITY(),
    "tool %d with %s: %llu ticks, %.1f /s, lateness 99 %% %.0f us, missed %llu, largest force "
    "%.3f N, untrusted ticks %llu",
    tool, hand->Device.toUtf8().constData(), static_cast<unsigned long long>(statistics.ticks),
    statistics.rate(), microseconds(statistics.lateness.p99),
    static_cast<unsigned long long>(statistics.missed), statistics.largest_force,
    static_cast<unsigned long long>(statistics.untrusted_ticks));
  this->closeRecording(std::move(hand->Recording));
  return ended;
}

QString pqPalpateReducedTouch::endLoops(pqPalpateRun::Session& touched)
{
  auto& session = static_cast<Session&>(touched);
  // All loops are asked to end at once, and are then waited for one after the other.
  session.LetGo();
  bool ended = true;
  for (int tool = 0; tool < static_cast<int>(session.Hands.size()); ++tool)
  {
    ended = this->endHand(session, tool) && ended;
  }
  session.Body->stop();
  const palpate::ReducedBodyStatistics statistics = session.Body->statistics();
  const quint64 frames = session.BodyView->GetNumberOfFrames();
  vtkVLogF(PARAVIEW_LOG_PLUGIN_VERBOSITY(),
    "reduced body: %llu steps, %.1f /s, step 50 %% %.0f us, 99 %% %.0f us, missed %llu, largest "
    "trust %.2f, %llu frames, %.1f /s",
    static_cast<unsigned long long>(statistics.steps), statistics.rate(),
    microseconds(statistics.step_time.median), microseconds(statistics.step_time.p99),
    static_cast<unsigned long long>(statistics.missed), statistics.largest_trust,
    static_cast<unsigned long long>(frames),
    1e3 * static_cast<double>(frames) / std::max<qint64>(1, session.Time.elapsed()));
  session.Tools.clear();
  return ended ? QString()
               : "A device's driver hangs: the device itself has to switch its motors off.";
}

void pqPalpateReducedTouch::tellLives()
{
  for (const std::unique_ptr<Hand>& hand : this->session()->Hands)
  {
    if (hand)
    {
      hand->Servo->host_lives();
    }
  }
}

void pqPalpateReducedTouch::advance()
{
  const std::shared_ptr<Session> session = this->session();
  session->Force = 0;
  session->BodyForce = 0;
  for (int tool = 0; tool < static_cast<int>(session->Hands.size()); ++tool)
  {
    Hand* hand = session->Hands[static_cast<std::size_t>(tool)].get();
    if (!hand)
    {
      continue;
    }
    hand->Tick = hand->Servo->latest();
    // Before its first tick a loop is `closed` too.
    const bool hasEnded = hand->Tick.state == palpate::ServoState::closed && hand->Tick.number > 0;
    if (hand->Tick.state == palpate::ServoState::gone || hasEnded)
    {
      const QString problem = QString::fromStdString(hand->Servo->problem());
      this->endHand(*session, tool);
      Q_EMIT this->toolLost(
        tool, QString("Tool %1 has lost its device: %2").arg(tool).arg(problem));
      continue;
    }
    if (hand->Mouse)
    {
      hand->Mouse->Advance(hand->Tick);
    }
    // A device that lacks something is no reason to end the others.
    const QString fault = pqPalpateFault([&] { this->applySettings(*session, *hand); });
    if (!fault.isEmpty())
    {
      this->endHand(*session, tool);
      Q_EMIT this->toolLost(tool, fault);
      continue;
    }
    session->Force = std::max(session->Force, hand->Tick.force.norm());
    session->BodyForce = std::max(session->BodyForce, hand->Tick.contact.force.norm());
  }
  if (this->Running == session)
  {
    this->show(*session);
  }
}

void pqPalpateReducedTouch::show(Session& session)
{
  const palpate::ReducedBodyOutbox::Newest& newest = session.Body->latest();
  const Eigen::VectorXd& y = newest.coordinates;
  std::string text;
  for (std::size_t tool = 0; tool < session.Tools.size(); ++tool)
  {
    const Hand* hand = session.Hands[tool].get();
    palpate::Contact contact;
    if (hand)
    {
      contact = hand->Tick.contact;
    }
    contact.anchor = session.Space.Places[tool];
    // The tool is drawn at the step at which the body is drawn.
    contact.displacement =
      y.segment<3>(session.Space.Model->num_modes + 3 * static_cast<Eigen::Index>(tool));
    session.Tools[tool]->ShowTool(contact, hand != nullptr);
    if (hand && hand->Mouse)
    {
      session.Tools[tool]->MarkMouse();
      text = hand->Mouse->GetHint();
    }
  }
  if (newest.state.trust > palpate::kLargestTrusted)
  {
    text = "Farther than the model was trained for:\nforces are not to be trusted.";
  }
  const bool says = session.Tools.front()->Say(text);
  const bool moved = y != session.Coordinates;
  if (!moved && !says)
  {
    session.BodyView->Rest();
    return;
  }
  if (moved)
  {
    session.Coordinates = y;
    session.BodyView->ShowReduced(y.data(), static_cast<unsigned int>(y.size()));
    // That a server is gone is noticed only when something is sent to it, so that the session may
    // have ended here.
    if (this->Running.get() != &session)
    {
      return;
    }
  }
  session.BodyView->Draw();
}

pqPalpateReducedTouch::Figures pqPalpateReducedTouch::figures()
{
  Figures figures;
  if (!this->Running)
  {
    return figures;
  }
  Session& session = *this->session();
  const palpate::ReducedBodyStatistics statistics = session.Body->statistics();
  const palpate::ReducedState& state = session.Body->latest().state;
  figures.Outcome = QString::fromStdString(palpate::to_string(state.outcome));
  figures.Trust = state.trust;
  figures.IsTrusted = state.trust <= palpate::kLargestTrusted;
  takePace(session, statistics, figures);
  figures.Number = statistics.steps;
  figures.StepTime[0] = microseconds(statistics.step_time.median);
  figures.StepTime[1] = microseconds(statistics.step_time.p99);
  figures.Problem = QString::fromStdString(session.Body->problem());
  for (std::size_t number = 0; number < session.Hands.size(); ++number)
  {
    const std::unique_ptr<Hand>& hand = session.Hands[number];
    ToolFigures tool;
    tool.ActiveNode = session.Space.ActiveNodes[number];
    if (hand)
    {
      const palpate::Tick tick = hand->Servo->latest();
      tool.State = words(palpate::to_string(tick.state)) + ", " + WordsOfHold(tick.contact.status);
      const std::string_view why = palpate::words_for(tick.tripped);
      if (!why.empty())
      {
        tool.State += ". There is no force: " + words(why);
      }
      tool.Force = tick.force.norm();
      tool.BodyForce = tick.contact.force.norm();
      const std::string problem = hand->Servo->problem();
      if (figures.Problem.isEmpty() && !problem.empty())
      {
        figures.Problem = QString("Tool %1: %2").arg(number).arg(QString::fromStdString(problem));
      }
      addRecorded(*hand, figures);
    }
    figures.Tools.push_back(tool);
  }
  return figures;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateTouch.h"

#include <QCoreApplication>
#include <QPointer>
#include <algorithm>
#include <deque>
#include <exception>
#include <stdexcept>
#include <utility>

#include "haptic/servo/servo.h"
#include "pqApplicationCore.h"
#include "pqObjectBuilder.h"
#include "pqOutputPort.h"
#include "pqPalpateDevices.h"
#include "pqPalpateFetch.h"
#include "pqPalpateMouse.h"
#include "pqPalpateToolView.h"
#include "pqPipelineSource.h"
#include "pqProgressManager.h"
#include "pqRenderView.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"
#include "vtkCamera.h"
#include "vtkDataObject.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkPVLogger.h"
#include "vtkSMPVRepresentationProxy.h"
#include "vtkSMParaViewPipelineControllerWithRendering.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"
#include "vtkSMSession.h"
#include "vtkSMSourceProxy.h"
#include "vtkSMTransferFunctionManager.h"
#include "vtkSMTransferFunctionProxy.h"
#include "vtkWeakPointer.h"

using palpate::Mat3;
using palpate::Vec3;

namespace
{
constexpr int FrameInterval = 33; // ms
constexpr float ConnectionPriority = 100;
/// Of the radius of the active nodes: what the device reaches beyond them.
constexpr double Room = 1.3;
/// The simulated hand begins so far above its node, and goes so far into the body, of the
/// half-width of the space.
constexpr double HandHeight = 0.25;
constexpr double HandDepth = 0.6;

/// Smooths the edges of the picture or does not: without graphics hardware that takes most of the
/// time of a frame.
/// @return What it did before.
int SmoothEdges(pqRenderView* view, int smooths)
{
  vtkSMPropertyHelper helper(view->getProxy(), "UseFXAA", true);
  const int before = helper.GetAsInt();
  helper.Set(smooths);
  view->getProxy()->UpdateVTKObjects();
  return before;
}

/// The filter that shows the body; made where there is none.
pqPipelineSource* FindTouchFilter(pqOutputPort* space, double halfWidth, pqRenderView* view)
{
  for (pqPipelineSource* consumer : space->getConsumers())
  {
    if (QString(consumer->getProxy()->GetXMLName()) == "TouchStateSpace")
    {
      return consumer;
    }
  }
  pqPipelineSource* touch = pqApplicationCore::instance()->getObjectBuilder()->createFilter(
    "filters", "TouchStateSpace", space->getSource(), space->getPortNumber());
  if (!touch)
  {
    throw std::runtime_error("The server has no filter Touch State Space: load the plugin Palpate "
                             "on it, too.");
  }
  touch->setModifiedState(pqProxy::UNMODIFIED);
  vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
  vtkSMProxy* shown = controller->Show(touch->getSourceProxy(), 0, view->getViewProxy());
  if (shown && vtkSMPVRepresentationProxy::SetScalarColoring(
      shown, "Displacement", vtkDataObject::POINT))
  {
    // The colours shall not change their meaning from frame to frame.
    vtkSMProxy* colours = vtkSMPropertyHelper(shown, "LookupTable").GetAsProxy();
    vtkSMPropertyHelper(colours, "AutomaticRescaleRangeMode")
      .Set(vtkSMTransferFunctionManager::NEVER);
    colours->UpdateVTKObjects();
    vtkSMTransferFunctionProxy::RescaleTransferFunction(colours, 0, halfWidth);
    vtkSMPVRepresentationProxy::SetScalarBarVisibility(shown, view->getViewProxy(), true);
  }
  return touch;
}

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
  }
  return {};
}

QString Words(palpate::Found found)
{
  switch (found)
  {
    case palpate::Found::no:
      return "nothing found";
    case palpate::Found::inside:
      return "inside the space";
    case palpate::Found::extrapolated:
      return "beyond the space";
    case palpate::Found::marked:
      return "in a marked region";
  }
  return {};
}

double Microseconds(palpate::Duration duration)
{
  return 1e6 * palpate::seconds(duration);
}
}

/// All that there is while it runs.
struct pqPalpateTouch::Session
{
  QPointer<pqOutputPort> Space;
  QPointer<pqPipelineSource> Source;
  QPointer<pqPipelineSource> Touch;
  QPointer<pqRenderView> View;
  QString Device;
  vtkMTimeType DataTime = 0;
  std::shared_ptr<const palpate::Touchable> Body;
  /// Of the active nodes: around them, m.
  Vec3 Centre = Vec3::Zero();
  double Radius = 0;
  /// Where the simulated hand is.
  Vec3 HandCentre = Vec3::Zero();
  Mat3 HandRotation = Mat3::Identity();

  vtkWeakPointer<vtkSMSession> Connection;
  unsigned long ConnectionObserver = 0;

  std::unique_ptr<palpate::Servo> Servo;
  /// The servo's, as last set.
  palpate::ServoSettings ServoSettings;
  palpate::TouchSettings TouchSettings;
  std::shared_ptr<palpate::MouseMotion> Motion;
  std::unique_ptr<pqPalpateMouse> Mouse;
  std::unique_ptr<pqPalpateToolView> Tool;

  /// What is shown.
  int Node = -1;
  Vec3 Displacement = Vec3::Zero();
  Vec3 Place = Vec3::Zero();
  bool Touches = false;
  /// Of the view, before.
  int SmoothsEdges = 0;
  QElapsedTimer Time;
  /// When the last frames were, ms, and how many there were in all.
  std::deque<qint64> Frames;
  quint64 NumberOfFrames = 0;

  /// Takes the client's copy of the space.
  void SetSpace(const palpate::TouchSpace& space)
  {
    this->Body = std::make_shared<const palpate::Touchable>(space);
    Vec3 low = space.sites.front().rest_position;
    Vec3 high = low;
    double halfWidth = 0;
    for (const palpate::TouchSite& site : space.sites)
    {
      low = low.cwiseMin(site.rest_position);
      high = high.cwiseMax(site.rest_position);
      halfWidth = std::max(halfWidth, site.site.half_width);
    }
    this->Centre = (low + high) / 2;
    this->Radius = Room * ((high - low).norm() / 2 + halfWidth);
    vtkSMRenderViewProxy* view = this->View->getRenderViewProxy();
    this->Tool = std::make_unique<pqPalpateToolView>(view, space);
    if (this->Motion)
    {
      this->Mouse = std::make_unique<pqPalpateMouse>(view, space, this->Body, this->Motion);
    }
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
      const palpate::TouchSite& site = space.sites.front();
      const double halfWidth = site.site.half_width;
      const palpate::SurfaceTree surface(space.surface);
      const Vec3 normal = surface.nearest(site.rest_position).normal;
      this->HandCentre = site.rest_position + HandHeight * halfWidth * normal;
      const Vec3 across = normal.unitOrthogonal();
      this->HandRotation << across, normal.cross(across), normal;
      return pqPalpateSimulatedDevice(
        clock, pqPalpateHandMotion((HandHeight + HandDepth) * halfWidth));
    }
    return pqPalpateOpenDevice(this->Device);
  }

  ~Session()
  {
    if (this->Connection)
    {
      this->Connection->RemoveObserver(this->ConnectionObserver);
    }
  }

  bool IsSimulatedHand() const { return this->Device == pqPalpateHandDevice; }
};

pqPalpateTouch::pqPalpateTouch(QObject* parent)
  : QObject(parent)
{
  this->FrameTimer.setInterval(FrameInterval);
  this->FrameTimer.setTimerType(Qt::PreciseTimer);
  QObject::connect(&this->FrameTimer, &QTimer::timeout, this, &pqPalpateTouch::showFrame);

  pqServerManagerModel* model = pqApplicationCore::instance()->getServerManagerModel();
  QObject::connect(model, &pqServerManagerModel::preSourceRemoved, this,
    [this](pqPipelineSource* source)
    {
      if (this->Running && (source == this->Running->Source || source == this->Running->Touch))
      {
        this->end("The state space, or what shows it, was deleted.", Left::View);
      }
    });
  QObject::connect(model, &pqServerManagerModel::preViewRemoved, this,
    [this](pqView* view)
    {
      if (this->Running && view == this->Running->View)
      {
        this->end("The view was closed.", Left::Nothing);
      }
    });
  const auto serverGoes = [this](pqServer* server)
  {
    if (this->Running && (!this->Running->Source || this->Running->Source->getServer() == server))
    {
      this->end("The server was disconnected.", Left::Nothing);
    }
  };
  QObject::connect(model, &pqServerManagerModel::aboutToRemoveServer, this, serverGoes);
  QObject::connect(model, &pqServerManagerModel::preServerRemoved, this, serverGoes);
  QObject::connect(model, &pqServerManagerModel::dataUpdated, this,
    [this](pqPipelineSource* source)
    {
      if (this->Running && source == this->Running->Source)
      {
        this->takeNewData();
      }
    });
  QObject::connect(QCoreApplication::instance(), &QCoreApplication::aboutToQuit, this,
    [this] { this->end({}, Left::Nothing); });
}

pqPalpateTouch::~pqPalpateTouch()
{
  this->end({}, Left::Nothing);
}

QString pqPalpateTouch::device() const
{
  return this->Running ? this->Running->Device : QString();
}

QString pqPalpateTouch::start(pqOutputPort* space, pqRenderView* view, const QString& device)
{
  this->stop();
  try
  {
    const palpate::TouchSpace copy = pqPalpateFetchSpace(space);
    auto session = std::make_unique<Session>();
    session->Space = space;
    session->Source = space->getSource();
    session->View = view;
    session->Device = device;
    session->DataTime = pqPalpateDataTime(space);
    const auto clock = std::make_shared<palpate::MonotonicClock>();
    pqPalpateDevice opened = session->OpenDevice(clock, copy);
    session->SetSpace(copy);
    session->Touch = FindTouchFilter(space, copy.sites.front().site.half_width, view);
    // What is seen of the space itself would hide the touched body.
    vtkNew<vtkSMParaViewPipelineControllerWithRendering> controller;
    controller->Hide(space->getSourceProxy(), space->getPortNumber(), view->getViewProxy());
    session->SmoothsEdges = SmoothEdges(view, 0);
    session->Servo = std::make_unique<palpate::Servo>(
      std::move(opened.Transport), std::move(opened.Profile), clock);
    // The filter that shows the body moves one node, so one node is felt.
    session->TouchSettings.blended = false;
    session->Servo->set_body(session->Body);
    session->Time.start();
    // ParaView opens a dialog when it hears of that, and the device would be left alone with it.
    session->Connection = space->getServer()->session();
    session->ConnectionObserver = session->Connection->AddObserver(vtkPVSessionBase::ConnectionLost,
      this, &pqPalpateTouch::loseConnection, ConnectionPriority);
    this->Running = std::move(session);
    this->applySettings({});
    this->Running->Servo->start();
  }
  catch (const std::exception& error)
  {
    this->end({}, Left::All);
    return error.what();
  }
  this->FrameTimer.start();
  Q_EMIT this->started();
  return {};
}

void pqPalpateTouch::stop()
{
  this->end({}, Left::All);
}

void pqPalpateTouch::loseConnection()
{
  this->end("The connection to the server was lost.", Left::Nothing);
}

void pqPalpateTouch::end(const QString& why, Left left)
{
  if (!this->Running)
  {
    return;
  }
  this->FrameTimer.stop();
  const std::unique_ptr<Session> session = std::move(this->Running);
  const bool ended = session->Servo->stop();
  const palpate::Statistics statistics = session->Servo->statistics();
  vtkVLogF(PARAVIEW_LOG_PLUGIN_VERBOSITY(),
    "touched with %s: %llu ticks, %.1f /s, lateness 50 %% %.0f us, 99 %% %.0f us, 99.9 %% %.0f us, "
    "largest %.0f us, missed %llu, largest force %.3f N, %llu frames, %.1f /s",
    session->Device.toUtf8().constData(), static_cast<unsigned long long>(statistics.ticks),
    statistics.rate(), Microseconds(statistics.lateness.median),
    Microseconds(statistics.lateness.p99), Microseconds(statistics.lateness.p999),
    Microseconds(statistics.lateness.largest),
    static_cast<unsigned long long>(statistics.missed), statistics.largest_force,
    static_cast<unsigned long long>(session->NumberOfFrames),
    1e3 * session->NumberOfFrames / std::max<qint64>(1, session->Time.elapsed()));
  session->Mouse.reset();
  session->Tool.reset();
  if (left != Left::Nothing && session->View)
  {
    SmoothEdges(session->View, session->SmoothsEdges);
  }
  if (left == Left::All && session->Touch && session->View)
  {
    const double zero[3] = { 0, 0, 0 };
    vtkSMPropertyHelper(session->Touch->getProxy(), "Displacement").Set(zero, 3);
    session->Touch->getProxy()->UpdateVTKObjects();
    session->View->render();
  }
  Q_EMIT this->stopped(
    ended ? why : "The device's driver hangs: the device itself has to switch its motors off.");
}

void pqPalpateTouch::setSettings(const Settings& settings)
{
  this->Current = settings;
}

void pqPalpateTouch::applySettings(const palpate::Tick& tick)
{
  Session& session = *this->Running;
  palpate::ServoSettings& servo = session.ServoSettings;
  servo.force_scale = this->Current.ForceScale;
  servo.force_limit = this->Current.ForceLimit;
  session.TouchSettings.bonded = this->Current.Bonded;
  const bool attached = tick.contact.status == palpate::ContactStatus::attached;
  if (session.Mouse)
  {
    servo.workspace_centre = session.Mouse->GetWorkspaceCentre();
    session.TouchSettings.bonded = session.Mouse->IsHolding();
  }
  else if (session.IsSimulatedHand())
  {
    servo.workspace_centre = session.HandCentre;
    servo.workspace_rotation = session.HandRotation;
  }
  // The tool shall not be torn through the body when the camera turns.
  else if (!attached)
  {
    const palpate::Specification& device = session.Servo->specification();
    servo.workspace_centre = session.Centre;
    servo.workspace_scale = this->Current.WorkspaceScale > 0
      ? this->Current.WorkspaceScale
      : session.Radius / device.workspace_radius;
    Vec3 towards = Vec3::UnitZ();
    Vec3 up = Vec3::UnitY();
    if (this->Current.FollowsCamera)
    {
      vtkCamera* camera = session.View->getRenderViewProxy()->GetActiveCamera();
      camera->OrthogonalizeViewUp();
      towards = -Vec3(camera->GetDirectionOfProjection());
      up = Vec3(camera->GetViewUp());
    }
    // The device's x is towards the person, y to the right, z up.
    servo.workspace_rotation << towards, up.cross(towards), up;
  }
  session.TouchSettings.coupling_stiffness = palpate::coupling_stiffness_for(
    session.Servo->specification(), session.Body->largest_stiffness(), servo);
  session.Servo->set_settings(servo);
  session.Servo->set_touch_settings(session.TouchSettings);
}

void pqPalpateTouch::takeNewData()
{
  Session& session = *this->Running;
  const vtkMTimeType time = pqPalpateDataTime(session.Space);
  if (time == session.DataTime)
  {
    return;
  }
  session.DataTime = time;
  try
  {
    session.SetSpace(pqPalpateFetchSpace(session.Space));
    session.Servo->set_body(session.Body);
  }
  catch (const std::exception& error)
  {
    this->end(error.what(), Left::View);
  }
}

void pqPalpateTouch::showFrame()
{
  // Rendering may handle events, a timer's too.
  if (!this->Running || this->IsShowing || this->Running->Source->getServer()->isProgressPending())
  {
    return;
  }
  this->IsShowing = true;
  Session& session = *this->Running;
  const palpate::Tick tick = session.Servo->latest();
  if (tick.state == palpate::ServoState::gone)
  {
    this->IsShowing = false;
    this->end("The device is gone: " + QString::fromStdString(session.Servo->problem()),
      Left::All);
    return;
  }
  if (session.Mouse)
  {
    session.Mouse->Advance(tick);
  }
  try
  {
    this->applySettings(tick);
  }
  catch (const std::exception& error)
  {
    this->IsShowing = false;
    this->end(error.what(), Left::All);
    return;
  }

  const bool touches = tick.contact.status == palpate::ContactStatus::attached;
  const int node = touches ? tick.contact.nodes[0] : session.Node;
  const Vec3 displacement = touches ? tick.contact.displacement : Vec3::Zero();
  const bool moved = node != session.Node || displacement != session.Displacement;
  const bool showsFree = !session.Mouse;
  if (moved || touches != session.Touches || (showsFree && tick.position != session.Place))
  {
    if (moved)
    {
      vtkSMProxy* touch = session.Touch->getProxy();
      vtkSMPropertyHelper(touch, "ActiveNode").Set(static_cast<vtkIdType>(node));
      vtkSMPropertyHelper(touch, "Displacement").Set(displacement.data(), 3);
      touch->UpdateVTKObjects();
    }
    session.Node = node;
    session.Displacement = displacement;
    session.Place = tick.position;
    session.Touches = touches;
    session.Tool->Show(tick, showsFree);
    const QPointer<pqRenderView> view = session.View;
    // The bar of progress would be drawn anew for each frame.
    pqProgressManager* progress = pqApplicationCore::instance()->getProgressManager();
    progress->lockProgress(this);
    view->forceRender();
    progress->unlockProgress(this);
    if (this->Running)
    {
      ++this->Running->NumberOfFrames;
      this->Running->Frames.push_back(this->Running->Time.elapsed());
    }
  }
  this->IsShowing = false;
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
  constexpr qint64 window = 1000;
  while (!session.Frames.empty() && session.Frames.front() < session.Time.elapsed() - window)
  {
    session.Frames.pop_front();
  }
  figures.FrameRate = 1e3 / window * session.Frames.size();
  figures.Lateness[0] = Microseconds(statistics.lateness.median);
  figures.Lateness[1] = Microseconds(statistics.lateness.p99);
  figures.Lateness[2] = Microseconds(statistics.lateness.largest);
  figures.Ticks = statistics.ticks;
  figures.Missed = statistics.missed;
  figures.Force = tick.force.norm();
  figures.BodyForce = tick.contact.force.norm();
  figures.Dissipated = tick.dissipated;
  figures.Damping = tick.added_damping;
  if (tick.contact.status == palpate::ContactStatus::attached)
  {
    figures.Node = tick.contact.nodes[0];
    figures.Found = Words(tick.contact.found);
  }
  figures.Problem = QString::fromStdString(session.Servo->problem());
  return figures;
}

// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateRun.h"

#include <QScopedValueRollback>
#include <utility>

#include "pqApplicationCore.h"
#include "pqPalpateFault.h"
#include "pqServer.h"
#include "pqServerManagerModel.h"

pqPalpateRun::Session::Session(pqOutputPort* port, pqRenderView* view)
  : Port(port)
  , Source(port->getSource())
  , View(view)
{
}

pqPalpateRun::Session::~Session() = default;

pqPalpateRun::pqPalpateRun(QObject* parent)
  : QObject(parent)
{
  this->FrameTimer.setInterval(FrameInterval);
  this->FrameTimer.setTimerType(Qt::PreciseTimer);
  QObject::connect(&this->FrameTimer, &QTimer::timeout, this, &pqPalpateRun::showFrame);
  QObject::connect(&this->Watch, &pqPalpateRunWatch::mustEnd, this, &pqPalpateRun::end);
  QObject::connect(pqApplicationCore::instance()->getServerManagerModel(),
    &pqServerManagerModel::dataUpdated, this,
    [this](pqPipelineSource* source)
    {
      if (this->Running && source == this->Running->Source)
      {
        this->takeNewData();
      }
    });
}

pqPalpateRun::~pqPalpateRun() = default;

void pqPalpateRun::setSettings(const Settings& settings)
{
  if (this->Running && settings.InTissue != this->Current.InTissue)
  {
    this->Running->BodyView->SetColours(settings.InTissue);
  }
  this->Current = settings;
}

void pqPalpateRun::hasBegun()
{
  this->FrameTimer.start();
  Q_EMIT this->started();
}

void pqPalpateRun::end(const QString& why, pqPalpateRunWatch::Left left)
{
  if (!this->Running)
  {
    return;
  }
  this->FrameTimer.stop();
  const std::shared_ptr<Session> session = std::move(this->Running);
  const QString hangs = this->endLoops(*session);
  // The fault that has ended it may come again here.
  const QString fault = pqPalpateFault([&] { session->BodyView->Leave(left); });
  Q_EMIT this->stopped(!hangs.isEmpty() ? hangs : why.isEmpty() ? fault : why);
  // This comes last: any question to a server that is lost ends ParaView, and the message has to
  // come before that.
  this->Watch.end();
}

void pqPalpateRun::closeRecording(
  std::unique_ptr<pqPalpateRecording> recording, const QString& fault)
{
  if (recording)
  {
    const QString ownFault = recording->Close();
    Q_EMIT this->recorded(
      recording->GetFile(), recording->GetWritten(), ownFault.isEmpty() ? fault : ownFault);
  }
}

void pqPalpateRun::showFrame()
{
  const QString fault = pqPalpateFault(
    [this]
    {
      if (this->Watch.hearsEscape())
      {
        this->stop();
      }
      if (this->Running)
      {
        this->tellLives();
      }
      // Rendering may handle events, also those of the timer.
      if (!this->Running || this->IsShowing ||
        this->Running->Source->getServer()->isProgressPending())
      {
        return;
      }
      const QScopedValueRollback<bool> showing(this->IsShowing, true);
      const std::shared_ptr<Session> kept = this->Running;
      this->advance();
      if (this->Running == kept)
      {
        Q_EMIT this->sampled(1e-3 * kept->Time.elapsed(), kept->Force, kept->BodyForce);
      }
    });
  if (!fault.isEmpty())
  {
    this->end(fault, pqPalpateRunWatch::Left::All);
  }
}

pqPalpateDevice pqPalpateRun::open(
  Hand& hand, const std::shared_ptr<palpate::Clock>& clock, const std::function<HandWay()>& way)
{
  if (hand.IsReal())
  {
    return pqPalpateOpenDevice(hand.Device);
  }
  if (hand.IsSimulated())
  {
    const HandWay goes = way();
    const palpate::Vec3 across = goes.Normal.unitOrthogonal();
    hand.Centre = goes.Place + goes.Height * goes.Normal;
    hand.Rotation << across, goes.Normal.cross(across), goes.Normal;
    return pqPalpateSimulatedDevice(clock, pqPalpateHandMotion(goes.Length));
  }
  hand.Motion = std::make_shared<palpate::MouseMotion>();
  return pqPalpateSimulatedDevice(clock, hand.Motion);
}

void pqPalpateRun::findSettings(const Session& session, Hand& hand, bool simulatedGrasps) const
{
  palpate::ServoSettings& servo = hand.Settings;
  const palpate::Specification& device = hand.Servo->specification();
  servo.force_limit = this->Current.ForceLimit;
  servo.dead_man_button =
    hand.IsReal() && this->Current.NeedsButton ? palpate::dead_man_button_of(device) : -1;
  servo.grasp_button = -1;
  if (hand.Mouse)
  {
    servo.workspace_centre = hand.Mouse->GetWorkspaceCentre();
    servo.grasp_button = pqPalpateGraspButton;
    return;
  }
  if (hand.IsSimulated())
  {
    servo.workspace_centre = hand.Centre;
    servo.workspace_rotation = hand.Rotation;
  }
  else if (!palpate::touches(hand.Tick.contact.status))
  {
    servo.workspace_centre = session.Centre;
    servo.workspace_rotation =
      pqPalpateAxesOfDevice(this->Current.FollowsCamera ? session.View.data() : nullptr);
  }
  const int last = device.num_buttons - 1;
  const bool mayGrasp = hand.IsReal() || simulatedGrasps;
  if (mayGrasp && this->Current.GraspsWithButton && last > servo.dead_man_button)
  {
    servo.grasp_button = last;
  }
}

QString pqPalpateRun::words(std::string_view text)
{
  return QString::fromUtf8(text.data(), static_cast<int>(text.size()));
}

void pqPalpateRun::addRecorded(const Hand& hand, Pace& pace)
{
  if (hand.Recording)
  {
    pace.Recorded += hand.Recording->GetWritten();
    pace.NotRecorded += hand.Recording->GetDropped();
  }
}

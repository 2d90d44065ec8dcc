// SPDX-License-Identifier: BSD-3-Clause
#include "pqPalpateExploration.h"

#include <mutex>
#include <stdexcept>
#include <utility>

#include "haptic/exploring/expected_press.h"
#include "haptic/exploring/hand_exploration.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"
#include "pqOutputPort.h"
#include "pqPalpateFault.h"
#include "pqPalpateFetch.h"
#include "vtkPalpateFollowing.h"
#include "vtkPalpatePrecomputeStateSpace.h"
#include "vtkSMSourceProxy.h"

/// What the thread of the exploration hands over to that of the window.
struct pqPalpateExploration::Grown
{
  std::mutex Mutex;
  std::shared_ptr<const palpate::Touchable> Body;
};

namespace
{
/// Whether the hand of a tick loses nothing when this body takes the place of the one that it
/// touches.
bool IsFeltAt(const palpate::Tick& tick, const palpate::Touchable& body)
{
  if (!palpate::touches(tick.contact.status) || !body.force_on_tool())
  {
    return true;
  }
  const palpate::Support support = body.force_on_tool()->evaluate(tick.position).support;
  return support == palpate::Support::inside || support == palpate::Support::marked;
}
}

pqPalpateExploration::pqPalpateExploration(
  pqPipelineSource* source, std::shared_ptr<const vtkPalpateFollowing> following)
  : Source(source)
  , Following(std::move(following))
  , Newest(std::make_shared<Grown>())
{
}

pqPalpateExploration::~pqPalpateExploration()
{
  this->End();
}

std::unique_ptr<pqPalpateExploration> pqPalpateExploration::Of(pqOutputPort* space)
{
  vtkSMSourceProxy* proxy = space->getSourceProxy();
  if (!pqPalpateIsExploredAroundHand(space))
  {
    return nullptr;
  }
  auto* filter = vtkPalpatePrecomputeStateSpace::SafeDownCast(proxy->GetClientSideObject());
  if (!filter)
  {
    throw std::runtime_error(
      "A space is explored around the hand where this window has the pipeline itself, and not a "
      "server. Explorers may be on other machines. Or set Exploration of Precompute State Space to "
      "Whole Space.");
  }
  auto following = filter->GetFollowing();
  if (!following)
  {
    throw std::runtime_error(
      "Press Apply: Precompute State Space has not begun the space that is explored around the "
      "hand.");
  }
  return std::unique_ptr<pqPalpateExploration>(
    new pqPalpateExploration(space->getSource(), std::move(following)));
}

std::vector<char> pqPalpateExploration::Pressable(const palpate::Surface& surface) const
{
  return palpate::may_be_pressed(
    surface, *this->Following->Scene, this->Following->Options.contact->shell);
}

palpate::ExpectedPress pqPalpateExploration::Expected(const palpate::TouchToolSpace& rigid) const
{
  return palpate::expected_press(*this->Following->Scene, rigid.setup);
}

void pqPalpateExploration::Begin(const Explorers& explorers,
  const palpate::TouchableOptions& options, palpate::Servo* servo, Giving giving)
{
  palpate::HandExplorationOptions asked;
  asked.space = this->Following->Options;
  asked.touch = options;
  asked.num_explorers = explorers.Number;
  asked.keys = explorers.Keys.toStdString();
  if (!explorers.Endpoint.isEmpty())
  {
    asked.endpoint = explorers.Endpoint.toStdString();
  }
  const auto where = [servo]() -> std::optional<palpate::HandMotion>
  {
    const palpate::Tick tick = servo->latest();
    if (tick.number == 0)
    {
      return std::nullopt;
    }
    return palpate::HandMotion{ tick.position, tick.velocity };
  };
  const auto take = [servo, newest = this->Newest, waits = giving == Giving::WhereTheHandIs](
                      std::shared_ptr<const palpate::Touchable> body) mutable
  {
    waits = waits && !IsFeltAt(servo->latest(), *body);
    if (waits)
    {
      return;
    }
    servo->set_touch(palpate::make_touch(body, palpate::Relation::changed));
    const std::lock_guard lock(newest->Mutex);
    newest->Body = std::move(body);
  };
  this->Running =
    std::make_shared<palpate::HandExploration>(this->Following->Scene, asked, where, take);
  vtkPalpateSetLiveSpace(this->Following->Options.file.string(), this->Running);
}

std::shared_ptr<const palpate::Touchable> pqPalpateExploration::TakeGrown()
{
  const std::lock_guard lock(this->Newest->Mutex);
  return std::exchange(this->Newest->Body, nullptr);
}

QString pqPalpateExploration::InWords(QString& problem) const
{
  if (!this->Running)
  {
    return {};
  }
  const palpate::HandExploration::Figures figures = this->Running->figures();
  problem = QString::fromStdString(figures.problem);
  const auto& coverage = figures.session.coverage;
  QString text = QString("%1 states").arg(figures.session.num_solved);
  text += QString(", %1 of %2 explorers busy").arg(figures.num_busy).arg(figures.num_explorers);
  if (coverage.needed > 0)
  {
    text += QString(", %1 of %2 cells ahead known").arg(coverage.known).arg(coverage.needed);
  }
  return text;
}

QString pqPalpateExploration::End()
{
  if (!this->Running)
  {
    return {};
  }
  const std::shared_ptr<palpate::HandExploration> ended = std::move(this->Running);
  const QString fault = pqPalpateFault([&] { ended->end(); });
  const std::string file = this->Following->Options.file.string();
  // Another one may explore it already.
  if (vtkPalpateFindLiveSpace(file) == ended)
  {
    vtkPalpateSetLiveSpace(file, nullptr);
  }
  return fault;
}

void pqPalpateExploration::HandOver()
{
  if (!this->Source)
  {
    return;
  }
  vtkSMSourceProxy* proxy = this->Source->getSourceProxy();
  if (auto* filter = vtkObject::SafeDownCast(proxy->GetClientSideObject()))
  {
    filter->Modified();
    proxy->MarkDirty(proxy);
  }
}

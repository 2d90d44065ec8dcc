// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/blade.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kWhole = std::numeric_limits<double>::infinity();
/// The blade is at the front if what is open ends within this share of the whole area.
constexpr double kAtFront = 1e-9;
/// The blade goes after the hand in steps, so that the hand's work in each is right to this share,
/// and in so many at the most.
constexpr double kBalance = 0.004;
constexpr double kMostSubsteps = 8;
/// A step that would make energy is halved so often before it is given up.
constexpr int kMostHalvings = 8;

double spring(double stiffness, const Vec3& stretch) {
  return 0.5 * stiffness * stretch.squaredNorm();
}

}  // namespace

bool Blade::enter(const Touchable& body, const Vec3& hand, double reach, Hold& hold) noexcept {
  const double open = hold.account().area();
  // The first strip is where the cut begins. It need not be as broad everywhere.
  const CutSheet::Nearest near = body.sheet().nearest(hand, std::max(open, body.torn().areas()[1]));
  const CutSheet::Nearest at = body.sheet().nearest(hand, open);
  if (near.triangle < 0 || near.distance > reach || at.triangle < 0) return false;
  is_in_ = true;
  reach_ = reach;
  hand_ = hand;
  on_sheet_ = follow(body, hand);
  place_ = at.point;
  offset_ = on_sheet_.point - place_;
  hold.account().begin(hand);
  return true;
}

CutSheet::Nearest Blade::follow(const Touchable& body, const Vec3& hand) noexcept {
  CutSheet::Nearest at = body.sheet().nearest(hand, kWhole);
  if (at.area < (1 - kAtFront) * body.torn().whole_area() || at.rise.isZero()) return at;
  const Vec3 ahead = at.rise.normalized();
  const double way = ahead.dot(hand - at.point);
  if (way > 0) {
    at.point += way * ahead;
    at.follows += ahead * ahead.transpose();
  }
  return at;
}

Vec3 Blade::goal(const Resistance& against) const noexcept {
  const Vec3 way = stretch();
  const double length = way.norm();
  const double held = against.friction / against.stiffness;
  return length > held ? Vec3(place_ + (1 - held / length) * way) : place_;
}

void Blade::slide(const CutSheet& sheet, const Resistance& against, TearAccount& account) noexcept {
  const CutSheet::Nearest to = sheet.nearest(goal(against), account.area());
  if (to.triangle < 0) return;
  const double released = spring(against.stiffness, stretch()) -
                          spring(against.stiffness, stretch() + place_ - to.point);
  if (!(released > 0)) return;
  account.rub(std::min(against.friction * (to.point - place_).norm(), released));
  place_ = to.point;
}

void Blade::cut(const CutSheet& sheet, const Resistance& against, double most,
                Hold& hold) noexcept {
  TearAccount& account = hold.account();
  const double open = account.area();
  const Vec3 goal = this->goal(against);
  const CutSheet::Nearest at = sheet.nearest(goal, open);
  const double front = at.rise.norm();
  if (at.triangle < 0 || !(front > 0) || at.area < open - kAtFront * most) return;
  const double ahead = (goal - at.point).dot(at.rise) / front;
  const TornResult body = hold.energy_at(open);
  const double resists = (against.toughness - body.release_rate) * front / against.stiffness;
  double step = std::min(front * std::min(ahead, ahead - resists), most);
  for (int k = 0; k < kMostHalvings && step > 0; ++k, step /= 2) {
    const CutSheet::Nearest to = sheet.nearest(goal, open + step);
    const double rubbed = against.friction * (to.point - place_).norm();
    const double lost = spring(against.stiffness, stretch() + place_ - to.point) -
                        spring(against.stiffness, stretch()) + rubbed + against.toughness * step +
                        (hold.energy_at(open + step).touch.energy - body.touch.energy);
    if (lost > 0) continue;
    account.open(open + step, against.toughness);
    account.rub(rubbed);
    place_ = to.point;
    return;
  }
}

Vec3 Blade::force(double stiffness) const noexcept {
  return -stiffness * (on_sheet_.follows * stretch());
}

bool Blade::pull(const Touchable& body, const Vec3& hand) noexcept {
  const CutSheet::Nearest before = on_sheet_;
  on_sheet_ = follow(body, hand);
  if (on_sheet_.triangle < 0 || on_sheet_.distance > reach_) return false;
  const Vec3 way = hand - hand_;
  const Vec3 jump =
      on_sheet_.point - before.point - 0.5 * (before.follows + on_sheet_.follows) * way;
  hand_ = hand;
  if (jump.norm() > reach_) return false;
  offset_ += jump;
  return true;
}

Contact Blade::move(const Touchable& body, const Vec3& hand, const TouchSettings& settings,
                    Hold& hold) noexcept {
  Contact contact = hold.stay(settings.fracture_toughness);
  const Resistance against{
      settings.coupling_stiffness > 0
          ? std::min(settings.coupling_stiffness, settings.blade_stiffness)
          : settings.blade_stiffness,
      settings.blade_friction,
      settings.blade_toughness > 0 ? settings.blade_toughness : settings.fracture_toughness};
  TearAccount& account = hold.account();
  const double whole = body.torn().whole_area();
  double left = whole / kTicksOfTear;
  const Vec3 from = hand_;
  const Vec3 way = hand - from;
  const double resists = against.friction + against.toughness * on_sheet_.rise.norm();
  const double most = against.stiffness * way.norm() / (kBalance * resists);
  const int num_steps = most > 1 ? static_cast<int>(std::ceil(std::min(most, kMostSubsteps))) : 1;
  for (int step = 1; step <= num_steps; ++step) {
    if (!pull(body, step == num_steps ? hand : Vec3(from + step * way / num_steps))) {
      leave();
      return contact;
    }
    // The hand goes first, and then the blade.
    account.follow(hand_, force(against.stiffness));
    slide(body.sheet(), against, account);
    const double before = account.area();
    if (against.toughness > 0) cut(body.sheet(), against, std::min(left, whole - before), hold);
    left -= account.area() - before;
    account.change(force(against.stiffness));
  }
  contact.status = ContactStatus::cutting;
  contact.anchor = place_;
  contact.force = force(against.stiffness);
  contact.stiffness = against.stiffness * on_sheet_.follows;
  contact.energy =
      hold.energy_at(account.area()).touch.energy + spring(against.stiffness, stretch());
  account.tell(contact);
  return contact;
}

}  // namespace palpate

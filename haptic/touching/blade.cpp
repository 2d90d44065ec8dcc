// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/touching/blade.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate {
namespace {

constexpr double kWhole = std::numeric_limits<double>::infinity();
/// Where the sheet is curved, q(x) moves faster than x. Where it moves so many times as fast, or
/// farther than this, m, it has jumped to another part of the sheet.
constexpr double kFastest = 5;
constexpr double kJump = 1e-6;
/// A cut takes so many ticks at the least, as a tear does (hold.cpp).
constexpr double kTicksOfCut = 50;
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
  on_sheet_ = follow(body, hand).point;
  place_ = at.point;
  offset_ = on_sheet_ - place_;
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

Vec3 Blade::goal(const Vec3& pull, const Resistance& against) const noexcept {
  const Vec3 way = pull - place_;
  const double length = way.norm();
  const double held = against.friction / against.stiffness;
  return length > held ? Vec3(pull - held / length * way) : place_;
}

void Blade::slide(const CutSheet& sheet, const Vec3& pull, const Resistance& against,
                  TearAccount& account) noexcept {
  const CutSheet::Nearest to = sheet.nearest(goal(pull, against), account.area());
  if (to.triangle < 0) return;
  const double released =
      spring(against.stiffness, pull - place_) - spring(against.stiffness, pull - to.point);
  if (!(released > 0)) return;
  account.rub(std::min(against.friction * (to.point - place_).norm(), released));
  place_ = to.point;
}

void Blade::cut(const CutSheet& sheet, const Vec3& pull, const Resistance& against, double most,
                Hold& hold) noexcept {
  TearAccount& account = hold.account();
  const double open = account.area();
  const Vec3 goal = this->goal(pull, against);
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
    const double lost = spring(against.stiffness, pull - to.point) -
                        spring(against.stiffness, pull - place_) + rubbed +
                        against.toughness * step +
                        (hold.energy_at(open + step).touch.energy - body.touch.energy);
    if (lost > 0) continue;
    account.open(open + step, against.toughness);
    account.rub(rubbed);
    place_ = to.point;
    return;
  }
}

Vec3 Blade::force(const CutSheet::Nearest& at, double stiffness) const noexcept {
  return -stiffness * (at.follows * (at.point - offset_ - place_));
}

Contact Blade::move(const Touchable& body, const Vec3& hand, const TouchSettings& settings,
                    Hold& hold) noexcept {
  const CutSheet& sheet = body.sheet();
  Contact contact = hold.stay(settings.fracture_toughness);
  const Vec3 way = hand - hand_;
  CutSheet::Nearest at = follow(body, hand);
  if (at.triangle < 0 || at.distance > reach_ ||
      (at.point - on_sheet_).norm() > kFastest * way.norm() + kJump) {
    leave();
    return contact;
  }
  const Resistance against{
      settings.coupling_stiffness > 0 ? settings.coupling_stiffness : body.largest_stiffness(),
      settings.blade_friction,
      settings.blade_toughness > 0 ? settings.blade_toughness : settings.fracture_toughness};
  TearAccount& account = hold.account();
  const double whole = body.torn().whole_area();
  double left = whole / kTicksOfCut;
  const double resists = against.friction + against.toughness * at.rise.norm();
  const double most = against.stiffness * way.norm() / (kBalance * resists);
  const int num_steps = most > 1 ? static_cast<int>(std::ceil(std::min(most, kMostSubsteps))) : 1;
  const Vec3 from = hand_;
  for (int step = 1; step <= num_steps; ++step) {
    hand_ = from + static_cast<double>(step) / num_steps * way;
    if (num_steps > 1) at = follow(body, hand_);
    on_sheet_ = at.point;
    const Vec3 pull = at.point - offset_;
    // The hand goes first, and then the blade.
    account.follow(hand_, force(at, against.stiffness));
    slide(sheet, pull, against, account);
    const double before = account.area();
    if (against.toughness > 0) cut(sheet, pull, against, std::min(left, whole - before), hold);
    left -= account.area() - before;
    account.change(force(at, against.stiffness));
  }
  contact.status = ContactStatus::cutting;
  contact.anchor = place_;
  contact.force = force(at, against.stiffness);
  contact.stiffness = against.stiffness * at.follows;
  contact.energy = hold.energy_at(account.area()).touch.energy +
                   spring(against.stiffness, at.point - offset_ - place_);
  account.tell(contact);
  return contact;
}

}  // namespace palpate

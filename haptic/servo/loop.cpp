// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"
#include "haptic/simulating/simulated_tool.h"

namespace palpate {
namespace {

/// The number of the last button that DeviceState::buttons can hold.
constexpr std::int32_t kLastButton = 31;

/// After a tick that takes longer than the period the loop waits for the period divided by this.
/// Otherwise, with real-time priority, nothing else would run on its processor.
constexpr int kRest = 10;

const ServoOptions& checked(const ServoOptions& options) {
  validate(options);
  return options;
}

[[noreturn]] void refuse(const char* name, double value, const char* unit, const char* range) {
  throw InputError(std::string(name) + " is " + quantity(value, unit) + ". Give " + range + ".");
}

void check_positive(const char* name, Duration value) {
  if (value.count() <= 0) refuse(name, seconds(value), "s", "more than 0");
}

void check_scale(const char* name, double value) {
  if (!(std::isfinite(value) && value > 0)) refuse(name, value, "", "more than 0");
}

void check_not_negative(const char* name, double value, const char* unit) {
  if (!(std::isfinite(value) && value >= 0)) refuse(name, value, unit, "0 or more");
}

void check_button(const char* name, std::int32_t button) {
  if (button >= -1 && button <= kLastButton) return;
  refuse(name, button, "", "the number of a button, from 0 to 31, or -1 for none");
}

bool same_workspace(const ServoSettings& a, const ServoSettings& b) {
  return a.workspace_centre == b.workspace_centre && a.workspace_rotation == b.workspace_rotation &&
         a.workspace_scale == b.workspace_scale;
}

/// Whether energies that were counted under the one and the other settings can be added up. The
/// workspace is not compared, because it changes only where no energy is stored.
bool same_energy(const LoopInbox::Settings& a, const LoopInbox::Settings& b) {
  return a.servo.force_scale == b.servo.force_scale &&
         a.touch.coupling_stiffness == b.touch.coupling_stiffness &&
         a.touch.blade_stiffness == b.touch.blade_stiffness && a.touch.friction == b.touch.friction;
}

}  // namespace

void validate(const ServoOptions& options) {
  check_positive("The period of the servo loop", options.period);
  check_positive("The age at which a report is stale", options.stale_after);
  check_positive("The time without a fresh report after which the tool lets go",
                 options.release_after);
  check_positive("The time to wait for a device in lock-step", options.lock_step_timeout);
  check_positive("The time to wait for the loop to end", options.stop_timeout);
  if (options.priority < 0 || options.priority > 99) {
    refuse("The real-time priority", options.priority, "", "1 to 99, or 0 for none");
  }
}

void validate(const ServoSettings& settings) {
  if (!settings.workspace_centre.allFinite()) {
    throw InputError("The centre of the workspace is not finite.");
  }
  const Mat3& r = settings.workspace_rotation;
  if (!((r.transpose() * r - Mat3::Identity()).norm() < 1e-6) || r.determinant() < 0) {
    throw InputError(
        "The rotation of the workspace is not a rotation: its columns have to be of "
        "unit length, at right angles, and right-handed.");
  }
  check_scale("The scale of the workspace", settings.workspace_scale);
  check_not_negative("The scale of the force", settings.force_scale, "");
  check_not_negative("The force limit", settings.force_limit, "N");
  if (!(settings.slew_limit > 0)) {
    refuse("The slew limit", settings.slew_limit, "N/s", "more than 0");
  }
  check_not_negative("The damping", settings.damping, "N·s/m");
  check_button("The dead-man button", settings.dead_man_button);
  check_button("The button that grasps", settings.grasp_button);
}

void validate(const ServoSettings& settings, const Specification& device) {
  validate(settings);
  const auto check = [&](std::int32_t button, const char* why) {
    if (button < device.num_buttons) return;
    throw InputError("Button " + std::to_string(button) + " is to be held " + why + ", but " +
                     device.model + " has " + std::to_string(device.num_buttons) +
                     " button(s), numbered from 0. Give one of them, or -1 for none.");
  };
  check(settings.dead_man_button, "for forces");
  check(settings.grasp_button, "to grasp");
}

std::int32_t dead_man_button_of(const Specification& device) {
  if (device.num_buttons > 0) return 0;
  if (device.max_linear_force == 0) return -1;
  throw InputError(
      "Forces are wanted only while a button is held, but " + device.model +
      " has motors and no button: it would get forces that nobody commands. Choose a device with a "
      "button, or switch 'Only while the button is held' off.");
}

std::string_view to_string(ServoState state) noexcept {
  switch (state) {
    case ServoState::closed: return "closed";
    case ServoState::ready: return "ready";
    case ServoState::running: return "running";
    case ServoState::stale: return "stale";
    case ServoState::gone: return "gone";
    case ServoState::tripped: return "tripped";
  }
  return "unknown";
}

double largest_force(const Specification& device, double limit) noexcept {
  return limit > 0 ? std::min(limit, device.max_linear_force) : device.max_linear_force;
}

double coupling_stiffness_for(const Specification& device, double body_stiffness,
                              const ServoSettings& settings) {
  const double per_scene = settings.force_scale * settings.workspace_scale;
  const double displayed = device.max_linear_stiffness / per_scene;
  return device.max_linear_stiffness > 0 && body_stiffness > displayed ? displayed : 0;
}

double coupling_stiffness_of_tool(const Specification& device, double wanted,
                                  const ServoSettings& settings) {
  const double displayed = coupling_stiffness_for(device, wanted, settings);
  return displayed > 0 ? displayed : wanted;
}

Loop::Loop(Transport& transport, const Profile& profile, Clock& clock, const ServoOptions& options,
           LoopInbox& inbox, LoopOutbox& outbox)
    : clock_(clock),
      options_(checked(options)),
      specification_(profile.specification()),
      inbox_(inbox),
      outbox_(outbox),
      session_(transport, profile, clock, options) {}

void Loop::tick() noexcept {
  keep_time(clock_.now());
  (void)session_.take_device_time();
  session_.poll();
  take_settings();
  take_touch();
  TickRing* recording = inbox_.recording.take();

  locate(settings_.servo);
  touch(settings_);
  observe_energy(settings_);
  send_force(settings_.servo);

  const Duration in_device = session_.take_device_time();
  const Duration taken = clock_.now() - begin_;
  count();
  outbox_.tick_time.add(taken);
  outbox_.own_time.add(taken - in_device);
  outbox_.newest.write({tick_, counters_});
  if (recording != nullptr) {
    recording->push({tick_, settings_.servo, settings_.touch, session_.received(), session_.sent(),
                     session_.write_failed()});
  }
}

void Loop::wait() noexcept {
  if (specification_.pacing == Pacing::lock_step) {
    // Two reports may be under way where one was thought lost. Waiting lets the next tick read both
    // together, so that it sends one answer again.
    clock_.sleep_until(begin_ + options_.period / 2);
    due_ = begin_ + options_.period;
    return;
  }
  due_ += options_.period;
  const Time now = clock_.now();
  clock_.sleep_until(now > due_ ? now + options_.period / kRest : due_);
}

void Loop::keep_time(Time begin) noexcept {
  if (tick_.number == 0) {
    first_begin_ = due_ = begin;
    interval_ = 0;
  } else {
    outbox_.interval.add(begin - begin_);
    interval_ = seconds(begin - begin_);
  }
  begin_ = begin;
  const Duration late = begin - due_;
  outbox_.lateness.add(late);
  if (late >= options_.period) {
    counters_.missed += static_cast<std::uint64_t>(late / options_.period);
    due_ = begin;
  }
  ++tick_.number;
  tick_.time = begin;
}

// A new workspace would tear a tool that holds the body through it, and could put a free tool into
// it. So it waits until the tool is free, and then the tool lets go until it was outside.
void Loop::take_settings() noexcept {
  energy_goes_on_ = true;
  if (!inbox_.settings.has_new() && !workspace_waits_) return;
  const LoopInbox::Settings& newest = inbox_.settings.read();
  LoopInbox::Settings settings = newest;
  const bool is_other = !same_workspace(settings_.servo, newest.servo);
  workspace_waits_ = is_other && touches(tick_.contact.status);
  if (workspace_waits_) {
    settings.servo.workspace_centre = settings_.servo.workspace_centre;
    settings.servo.workspace_rotation = settings_.servo.workspace_rotation;
    settings.servo.workspace_scale = settings_.servo.workspace_scale;
    // The coupling is as stiff at the device as it was meant to be with the newest scale.
    settings.touch.coupling_stiffness *=
        newest.servo.workspace_scale / settings_.servo.workspace_scale;
  } else if (is_other) {
    release();
  }
  energy_goes_on_ = same_energy(settings_, settings);
  settings_ = settings;
}

void Loop::locate(const ServoSettings& settings) noexcept {
  const Vec3 before = tick_.device.position;
  tick_.device = session_.state();
  tick_.age = session_.age();
  tick_.num_reports = session_.num_received();
  device_moved_ = tick_.device.position - before;
  const Mat3 to_scene = settings.workspace_scale * settings.workspace_rotation;
  tick_.position = settings.workspace_centre + to_scene * tick_.device.position;
  tick_.velocity = to_scene * session_.velocity();
}

// The touch before stays alive until the next call of take().
void Loop::take_touch() noexcept {
  Touch* before = std::exchange(touch_, inbox_.touch.take());
  same_touch_ = touch_ == before;
  touch_goes_on_ = same_touch_;
  if (same_touch_ || touch_ == nullptr) return;
  if (before != nullptr) {
    touch_goes_on_ = touch_->take_over(*before);
  } else {
    touch_->release();
  }
}

void Loop::release() noexcept {
  if (touch_ != nullptr) touch_->release();
}

void Loop::touch(const LoopInbox::Settings& settings) noexcept {
  const auto is_held = [&](std::int32_t button) {
    return (session_.state().buttons >> button & 1U) != 0;
  };
  const std::int32_t dead_man = settings.servo.dead_man_button;
  const bool permitted = settings.servo.engaged && (dead_man < 0 || is_held(dead_man));
  session_.interlock().set(trips::disengaged, !permitted);
  const Time now = clock_.now();
  session_.interlock().set(trips::body, touch_ != nullptr && !touch_->listen(now));
  if (session_.interlock().tripped() != 0) release();
  const std::int32_t grasp = settings.servo.grasp_button;
  const Grasp grasps = grasp < 0 ? Grasp::no_button : is_held(grasp) ? Grasp::closed : Grasp::open;
  // Before the first report there is no place to move the tool to.
  tick_.contact = touch_ != nullptr && session_.known()
                      ? touch_->move({tick_.position, tick_.velocity, grasps, now}, settings.touch)
                      : Contact();
  const bool is_outside =
      tick_.contact.status == ContactStatus::free || tick_.contact.status == ContactStatus::nothing;
  if (is_outside) session_.interlock().rearm();
}

void Loop::observe_energy(const LoopInbox::Settings& settings) noexcept {
  const ServoSettings& servo = settings.servo;
  const double stored = servo.force_scale / servo.workspace_scale * tick_.contact.energy;
  // tick_.state is still that of the tick before. A tick that was not running has sent no force.
  const bool observable = touches(tick_.contact.status) && tick_.state == ServoState::running;
  const ContactStatus observed = observable ? tick_.contact.status : ContactStatus::nothing;
  // A force that was cut says nothing about the stored energy.
  const bool was_cut = (tick_.limited & ~limits::slew) != 0;
  if (!observable || observed != observed_ || was_cut || !touch_goes_on_ || !energy_goes_on_) {
    balance_.begin(stored);
  } else if (!same_touch_) {
    balance_.go_on(stored);
  } else if (tick_.limited != 0) {
    balance_.add_late(session_.force(), device_moved_, stored);
  } else {
    balance_.add(session_.force(), device_moved_, stored);
  }
  observed_ = observed;
  tick_.dissipated = balance_.dissipated();
  tick_.added_damping =
      servo.passivity_control
          ? balance_.damping(session_.velocity(), seconds(options_.period),
                             std::max(specification_.max_linear_damping - servo.damping, 0.0))
          : 0;
}

ServoState Loop::state(const ServoSettings& settings) const noexcept {
  if (session_.gone()) return ServoState::gone;
  if (!session_.fresh()) return ServoState::stale;
  if (!settings.engaged) return ServoState::ready;
  return session_.interlock().tripped() == 0 ? ServoState::running : ServoState::tripped;
}

// Asks for a force. The session limits it, whatever was computed before.
void Loop::send_force(const ServoSettings& settings) noexcept {
  // The state is found as late as possible, because the thread may have been held up since it read
  // the device.
  tick_.state = state(settings);
  tick_.limited = 0;
  if (tick_.state != ServoState::running) {
    session_.send_zero();
  } else {
    Vec3 wanted = Vec3::Zero();
    if (touches(tick_.contact.status)) {
      wanted =
          settings.force_scale * (settings.workspace_rotation.transpose() * tick_.contact.force) -
          (settings.damping + tick_.added_damping) * session_.velocity();
    }
    const bool may_jump =
        touch_ != nullptr && touch_->ends_at_once() && !touches(tick_.contact.status);
    const double step =
        may_jump ? std::numeric_limits<double>::infinity()
                 : settings.slew_limit * std::min(interval_, 2 * seconds(options_.period));
    session_.send(wanted, largest_force(specification_, settings.force_limit), step, tick_.limited);
  }
  tick_.force = settings.workspace_rotation * session_.force();
  count_trips(std::exchange(tick_.tripped, session_.interlock().tripped()));
}

void Loop::count_trips(std::uint32_t before) noexcept {
  const std::uint32_t is_new = tick_.tripped & ~before;
  if (tick_.tripped != 0) ++counters_.tripped_ticks;
  if (is_new & trips::stale) ++counters_.trips_by_stale_reports;
  if (is_new & trips::failed_writes) ++counters_.trips_by_failed_writes;
  if (is_new & trips::disengaged) ++counters_.trips_by_disengaging;
  if (is_new & trips::guardian) ++counters_.trips_by_guardian;
  if (is_new & trips::body) ++counters_.trips_by_body;
}

void Loop::count_mesh_error(const TouchMeshError& error) noexcept {
  if (error.trust == MeshErrorTrust::none) return;
  ++counters_.mesh_error_ticks;
  if (error.trust != MeshErrorTrust::reliable) return;
  ++counters_.reliable_mesh_error_ticks;
  counters_.largest_mesh_error = std::max(counters_.largest_mesh_error, error.bound);
}

void Loop::count() noexcept {
  ++counters_.ticks;
  counters_.running = begin_ - first_begin_;
  session_.count(counters_);
  if (tick_.state == ServoState::stale) ++counters_.stale_ticks;
  if (tick_.limited & limits::magnitude) ++counters_.magnitude_limited;
  if (tick_.limited & limits::slew) ++counters_.slew_limited;
  if (tick_.limited & limits::not_finite) ++counters_.not_finite;
  const double force = tick_.force.norm();
  counters_.largest_force = std::max(counters_.largest_force, force);
  if (touches(tick_.contact.status)) {
    ++counters_.touching_ticks;
    counters_.sum_of_forces += force;
    counters_.least_dissipated = std::min(counters_.least_dissipated, tick_.dissipated);
    if (tick_.added_damping > 0) ++counters_.damped_ticks;
    if (tick_.contact.trust > kLargestTrusted) ++counters_.untrusted_ticks;
    count_mesh_error(tick_.contact.mesh_error);
  }
}

}  // namespace palpate

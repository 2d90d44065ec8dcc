// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/servo/session.h"

#include <algorithm>
#include <utility>

#include "haptic/servo/force_limiter.h"

namespace palpate {
namespace {

using std::chrono::milliseconds;

/// The largest number of reports that one poll reads: more than any queue holds, and finite, so
/// that a device that never falls silent cannot keep the loop from sending forces.
constexpr int kMostReports = 256;

/// The largest drift between two clocks, s/s: crystals keep to 1e-4, trimmed oscillators to 3e-3.
constexpr double kClockDrift = 3e-3;
/// During a gap in the reports the offset grows by no more than in a gap of this length, unless the
/// queue was seen empty meanwhile.
constexpr Duration kLongestDrift = milliseconds(10);

/// The time of a device that has gone back, as by a restart, is believed again after this long.
constexpr Duration kOnTrial = milliseconds(100);

/// The number of attempts at the last zero force, kRetryPause apart. They take 100 ms, half of the
/// time that stop() waits.
constexpr int kLastAttempts = 20;

}  // namespace

DeviceSession::DeviceSession(Transport& transport, const Profile& profile, Clock& clock,
                             const ServoOptions& options)
    : transport_(transport),
      guardian_(transport.guardian()),
      profile_(profile),
      clock_(clock),
      options_(options),
      estimator_(profile.specification().position_resolution) {}

DeviceSession::~DeviceSession() {
  const Report zero = profile_.zero_force(state_);
  for (int attempt = 0; attempt < kLastAttempts && zero.size > 0 && !gone_; ++attempt) {
    write(zero, Vec3::Zero());
    if (!write_failed()) {
      if (guardian_ != nullptr) {
        guardian_->acknowledge();
        guardian_->rest();
      }
      return;
    }
    clock_.sleep_until(clock_.now() + kRetryPause);
  }
}

TransportStatus DeviceSession::read(Report& report, Duration timeout) noexcept {
  const Time before = clock_.now();
  const TransportStatus status = transport_.read(report, timeout);
  device_time_ += clock_.now() - before;
  return status;
}

void DeviceSession::write(const Report& report, const Vec3& force) noexcept {
  const Time before = clock_.now();
  if (guardian_ != nullptr) guardian_->beat(before);
  const TransportStatus status = transport_.write(report);
  const Time after = clock_.now();
  device_time_ += after - before;
  sent_ = report;
  if (!force.isZero(0)) force_until_ = after;
  if (status == TransportStatus::data) {
    written_at_ = before;
    force_ = force;
    failed_writes_ = 0;
    const bool trip_was_seen = (interlock_.tripped() & trips::guardian) != 0;
    if (guardian_ != nullptr && trip_was_seen && force.isZero(0)) guardian_->acknowledge();
  } else if (status == TransportStatus::gone) {
    ++counted_.failed_writes;
    gone_ = true;
  } else {
    ++counted_.failed_writes;
    ++failed_writes_;
    retry_at_ = after + kRetryPause;
    if (force.squaredNorm() > force_.squaredNorm()) force_ = force;
  }
  if (gone_) force_.setZero();
  interlock_.set(trips::failed_writes, failed_writes_ >= kFailedWrites);
}

void DeviceSession::poll() noexcept {
  num_received_ = 0;
  received_ = {};
  if (gone_) return;
  const Time begin = clock_.now();
  if (known_) profile_.advance(state_, begin - polled_at_);
  polled_at_ = begin;
  const bool waits = profile_.specification().pacing == Pacing::lock_step;
  Report report;
  for (int n = 0; n < kMostReports; ++n) {
    const TransportStatus status =
        read(report, waits && n == 0 ? options_.lock_step_timeout : Duration(0));
    if (status == TransportStatus::data) {
      take(report);
      continue;
    }
    if (status == TransportStatus::nothing) last_empty_ = begin;
    if (status == TransportStatus::gone) gone_ = true;
    if (status == TransportStatus::error) ++counted_.failed_reads;
    break;
  }
  // Several reports that came together, without a time, do not say when they were measured.
  const Specification& device = profile_.specification();
  const bool moves_on = device.pacing == Pacing::on_change || read_at_ >= begin;
  if (known_ && !device.has_device_time && moves_on) take_velocity(begin);
  age_ = age_at(clock_.now());
  watch_age();
  watch_guardian();
}

// Trips by the time since the loop last had a fresh state, not by the age of this state: after a
// pause of the host this state may be fresh, though the hand has moved on meanwhile.
void DeviceSession::watch_age() noexcept {
  if (profile_.specification().max_linear_force == 0) return;
  const Time now = clock_.now();
  interlock_.set(trips::stale, fresh_at_ && now - *fresh_at_ > options_.release_after);
  if (age_ > options_.stale_after || gone_) return;
  fresh_at_ = now;
  interlock_.set(trips::stale, false);
}

void DeviceSession::watch_guardian() noexcept {
  const Specification& device = profile_.specification();
  if (device.max_linear_force == 0 || gone_) return;
  const bool is_guarded = guardian_ != nullptr
                              ? guardian_->guarded(clock_.now()) && !guardian_->tripped() &&
                                    guardian_->host() == HostState::living
                              : device.watchdog.count() > 0;
  interlock_.set(trips::guardian, !is_guarded);
}

void DeviceSession::take(const Report& report) noexcept {
  if (num_received_ >= TickRecord::kReports) {
    std::rotate(received_.begin(), received_.begin() + 1, received_.end());
  }
  received_[std::min(num_received_, TickRecord::kReports - 1)] = report;
  ++num_received_;
  ++counted_.reports;
  const DeviceState before = state_;
  if (!profile_.decode(report, state_)) {
    ++counted_.bad_reports;
    return;
  }
  // Reports that waited in the queue before it was ever seen empty may be of any age, and the
  // offset of the clocks cannot be learnt from them.
  if (!last_empty_) return;
  not_before_ = *last_empty_;
  if (!known_ && clock_.now() - not_before_ > options_.stale_after) return;
  const auto gap = static_cast<std::int32_t>(state_.counter - before.counter);
  if (known_ && gap > 1) counted_.lost_reports += static_cast<std::uint64_t>(gap - 1);
  take_device_time_of(before);
  known_ = true;
  if (profile_.specification().has_device_time) take_velocity(state_.device_time);
}

void DeviceSession::take_velocity(Time now) noexcept {
  velocity_ = estimator_.add(state_.position, velocity_at_ ? seconds(now - *velocity_at_) : 0);
  velocity_at_ = now;
}

void DeviceSession::take_device_time_of(const DeviceState& before) noexcept {
  const Time now = clock_.now();
  const Time last = std::exchange(read_at_, now);
  if (!profile_.specification().has_device_time) return;
  const Duration sample = now - state_.device_time;
  if (!known_) {
    offset_ = sample;
  } else if (state_.device_time < before.device_time) {
    restart_ = Restart{now, state_.device_time};
    estimator_.reset();
  } else if (restart_ && now - restart_->at >= kOnTrial) {
    // The time of an old report that comes again and again does not run as the host's clock does.
    const Duration ours = now - restart_->at;
    const Duration theirs = state_.device_time - restart_->device_time;
    if (theirs > ours * 9 / 10 && theirs < ours * 11 / 10) {
      restart_.reset();
      offset_ = sample;
    } else {
      restart_ = Restart{now, state_.device_time};
    }
  }
  // While the queue was seen empty nothing waited in it, and the clocks may have drifted all that
  // time.
  const Duration longest = std::max<Duration>(kLongestDrift, not_before_ - last);
  const double drift = kClockDrift * static_cast<double>(std::min(now - last, longest).count());
  offset_ = std::min(offset_ + Duration(static_cast<Duration::rep>(drift)), sample);
  age_when_read_ = sample - offset_;
}

Duration DeviceSession::age_at(Time now) const noexcept {
  if (!known_ || restart_) return Duration::max();
  if (profile_.specification().pacing == Pacing::on_change) return Duration(0);
  if (profile_.specification().has_device_time) return age_when_read_ + (now - read_at_);
  return now - not_before_;
}

Vec3 DeviceSession::send(const Vec3& wanted, double largest, double step,
                         std::uint32_t& limited) noexcept {
  watch_guardian();
  if (!fresh() || interlock_.tripped() != 0 || write_failed()) {
    send_zero();
    limited |= limits::device;
    return force_;
  }
  // The change is limited from the force that the motors have, which need not be the one that was
  // sent.
  if (may_be_cut()) force_.setZero();
  const Vec3 allowed = limit_force(profile_.on_motors(wanted), force_, largest, step, limited);
  const Report report = profile_.encode(allowed, state_);
  if (report.size > 0) write(report, profile_.displayed(allowed, state_));
  if (force_ != allowed) limited |= limits::device;
  return force_;
}

bool DeviceSession::may_be_cut() const noexcept {
  const Duration watchdog = profile_.specification().watchdog;
  return watchdog.count() > 0 && (!written_at_ || clock_.now() - *written_at_ >= watchdog);
}

bool DeviceSession::is_cut() const noexcept {
  const Duration watchdog = profile_.specification().watchdog;
  return watchdog.count() > 0 && clock_.now() - force_until_ >= watchdog;
}

void DeviceSession::send_zero() noexcept {
  watch_guardian();
  if (gone_ || is_cut()) force_.setZero();
  const Report zero = profile_.zero_force(state_);
  if (zero.size == 0 || gone_) return;
  if (failed_writes_ >= kFailedWrites && clock_.now() < retry_at_) return;
  write(zero, Vec3::Zero());
}

Duration DeviceSession::take_device_time() noexcept {
  return std::exchange(device_time_, Duration(0));
}

void DeviceSession::count(Counters& counters) noexcept {
  counters.reports += counted_.reports;
  counters.bad_reports += counted_.bad_reports;
  counters.lost_reports += counted_.lost_reports;
  counters.failed_reads += counted_.failed_reads;
  counters.failed_writes += counted_.failed_writes;
  counted_ = {};
}

std::string why_motors_stay_off(Transport& transport, const Specification& device) {
  if (device.max_linear_force == 0 || device.watchdog.count() > 0 ||
      transport.guardian() != nullptr) {
    return {};
  }
  return "The motors stay off, because nobody would switch them off when this program is killed: "
         "the device has no watchdog, and no guardian. Let the program palpate-guardian be found "
         "and open the device again, or give the device a watchdog.";
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// What the bytes of a kind of device mean. Pure functions: nothing is kept between calls, nothing
// is read or written; see transport/ for that.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "haptic/profile/device_state.h"
#include "haptic/profile/report.h"
#include "haptic/profile/specification.h"

namespace palpate {

class Profile {
 public:
  virtual ~Profile() = default;
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;

  [[nodiscard]] const Specification& specification() const { return specification_; }

  /// Takes a report into the state.
  /// @param state The last one: what the report does not say stays as it is.
  /// @return Whether the report is one of this profile's, whole and in range; if not the state is
  ///   unchanged.
  /// @note Realtime-safe.
  [[nodiscard]] virtual bool decode(const Report& report, DeviceState& state) const noexcept = 0;

  /// What becomes of the state in a while without a report: where the device tells a rate, the
  /// position moves on.
  /// @note Realtime-safe.
  virtual void advance(DeviceState& state, Duration duration) const noexcept;

  /// A force on the axes that have motors alone.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 on_motors(const Vec3& force) const noexcept;

  /// What the device makes of a force: what it has no motor for is left out, and what its motors
  /// cannot give, or must not yet, is less.
  /// @param force N; not finite, or above max_linear_force: nothing. @return N, no longer.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 displayed(const Vec3& force, const DeviceState& state) const noexcept;

  /// The report of displayed(force), that answers the state.
  /// @return Empty where the device has no motors.
  /// @note Realtime-safe.
  [[nodiscard]] Report encode(const Vec3& force, const DeviceState& state) const noexcept;

  /// Motors off.
  /// @note Realtime-safe.
  [[nodiscard]] virtual Report zero_force(const DeviceState& state) const noexcept = 0;

 protected:
  explicit Profile(Specification specification) : specification_(std::move(specification)) {}

 private:
  /// @param force On the axes that have motors alone.
  [[nodiscard]] virtual Vec3 do_display(const Vec3& force, const DeviceState& state) const noexcept;
  /// @param force As displayed() gives it.
  [[nodiscard]] virtual Report do_encode(const Vec3& force,
                                         const DeviceState& state) const noexcept = 0;

  Specification specification_;
};

/// What the system says of a HID device before it is opened.
struct DeviceInfo {
  std::string path;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  /// Of the top-level collection; 0: not known.
  std::uint16_t usage_page = 0;
  std::uint16_t usage = 0;
  /// Of the USB device; −1: it has none.
  int interface_number = -1;
  std::string manufacturer;
  std::string product;
  std::string serial_number;
};

enum class ProfileKind { palpate_report, wooden_haptics, space_mouse };

/// The profile for a device; none: it is not a device of ours.
[[nodiscard]] std::optional<ProfileKind> match(const DeviceInfo& device) noexcept;

/// Number of the feature report that a profile is made from; none: it needs none.
[[nodiscard]] std::optional<std::uint8_t> feature_report(ProfileKind kind) noexcept;

/// @param feature The answer to feature_report(kind), where there is one.
/// @throws InputError the feature report does not say what it should; the message says which field,
///   and what the board's firmware has to do.
[[nodiscard]] std::unique_ptr<const Profile> make_profile(ProfileKind kind,
                                                          const Report& feature = {});

}  // namespace palpate

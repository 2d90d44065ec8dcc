// SPDX-License-Identifier: BSD-3-Clause
// What the bytes of a kind of device mean. These are pure functions: nothing is kept between calls,
// and nothing is read from a device or written to it; transport/ does that.
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

  /// Puts what a report says into the state.
  /// @param state The last state. Whatever the report does not say stays as it is.
  /// @return Whether the report is one of this profile's, whole and in range. If not, the state is
  ///   unchanged.
  /// @note Realtime-safe.
  [[nodiscard]] virtual bool decode(const Report& report, DeviceState& state) const noexcept = 0;

  /// Moves the state on by a time in which no report came: the position of a device that reports
  /// rates changes.
  /// @note Realtime-safe.
  virtual void advance(DeviceState& state, Duration duration) const noexcept;

  /// The part of a force on the axes that have motors.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 on_motors(const Vec3& force) const noexcept;

  /// The force that the device displays when it is asked for `force`. Axes without a motor are left
  /// out. The force is smaller where the motors cannot give it, or must not give it yet.
  /// @param force N. A force that is not finite, or above max_linear_force, gives zero.
  /// @return N, never longer than `force`.
  /// @note Realtime-safe.
  [[nodiscard]] Vec3 displayed(const Vec3& force, const DeviceState& state) const noexcept;

  /// The report that asks for displayed(force), in answer to the state.
  /// @return The report; empty where the device has no motors.
  /// @note Realtime-safe.
  [[nodiscard]] Report encode(const Vec3& force, const DeviceState& state) const noexcept;

  /// The report that switches the motors off.
  /// @note Realtime-safe.
  [[nodiscard]] virtual Report zero_force(const DeviceState& state) const noexcept = 0;

 protected:
  explicit Profile(Specification specification) : specification_(std::move(specification)) {}

 private:
  /// @param force The force on the axes that have motors alone, N.
  [[nodiscard]] virtual Vec3 do_display(const Vec3& force, const DeviceState& state) const noexcept;
  /// @param force The force as displayed() gives it, N.
  [[nodiscard]] virtual Report do_encode(const Vec3& force,
                                         const DeviceState& state) const noexcept = 0;

  Specification specification_;
};

/// What the system says about a HID device before it is opened.
struct DeviceInfo {
  std::string path;
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  /// Usage page and usage of the top-level collection; 0: not known.
  std::uint16_t usage_page = 0;
  std::uint16_t usage = 0;
  /// Number of the interface of the USB device; −1: there is none.
  int interface_number = -1;
  std::string manufacturer;
  std::string product;
  std::string serial_number;
};

enum class ProfileKind { palpate_report, wooden_haptics, space_mouse };

/// The kind of profile that fits a device; empty: none does.
[[nodiscard]] std::optional<ProfileKind> match(const DeviceInfo& device) noexcept;

/// The number of the feature report that a profile of this kind is made from; empty: it needs none.
[[nodiscard]] std::optional<std::uint8_t> feature_report(ProfileKind kind) noexcept;

/// Makes a profile.
/// @param feature The answer to feature_report(kind), where there is one.
/// @throws InputError the feature report does not say what it should; the message says which field,
///   and what the board's firmware has to do.
[[nodiscard]] std::unique_ptr<const Profile> make_profile(ProfileKind kind,
                                                          const Report& feature = {});

}  // namespace palpate

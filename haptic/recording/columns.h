// SPDX-License-Identifier: BSD-3-Clause
// The columns of a recording, listed once for the writer and the reader.
#pragma once

#include <string>
#include <string_view>

#include "haptic/recording/setup.h"
#include "haptic/servo/record.h"

namespace palpate::recording {

/// The name of a column. It is kept in parts, so that no string is put together for each value.
struct Name {
  std::string_view what;
  std::string_view part = {};
  std::string_view unit = {};
  /// The first version of recordings that has this column or setting. In older ones its value is
  /// the default.
  int version = 1;

  /// The whole name, such as "force_x_N".
  [[nodiscard]] std::string text() const {
    std::string result(what);
    for (const std::string_view more : {part, unit}) {
      if (!more.empty()) result.append("_").append(more);
    }
    return result;
  }
};

inline constexpr std::string_view kAxes[3] = {"x", "y", "z"};
inline constexpr std::string_view kPlaces[4] = {"0", "1", "2", "3"};
inline constexpr std::string_view kEntries[9] = {"xx", "xy", "xz", "yx", "yy",
                                                 "yz", "zx", "zy", "zz"};

template <class Vector, class Visit>
void visit_vector(std::string_view what, std::string_view unit, Vector& vector, Visit&& visit) {
  for (int k = 0; k < 3; ++k) visit(Name{what, kAxes[k], unit}, vector[k]);
}

template <class Matrix, class Visit>
void visit_matrix(std::string_view what, std::string_view unit, Matrix& matrix, Visit&& visit) {
  for (int k = 0; k < 9; ++k) visit(Name{what, kEntries[k], unit}, matrix(k / 3, k % 3));
}

/// Calls visit for each column of a record but the settings.
template <class Record, class Visit>
void visit_columns(Record& record, Visit&& visit) {
  auto& tick = record.tick;
  visit(Name{"tick"}, tick.number);
  visit(Name{"time", "s"}, tick.time);
  visit(Name{"state"}, tick.state);
  visit_vector("position", "m", tick.position, visit);
  visit_vector("velocity", "m_per_s", tick.velocity, visit);
  visit_vector("force", "N", tick.force, visit);
  visit(Name{"limited"}, tick.limited);
  visit(Name{"tripped"}, tick.tripped);
  visit(Name{"dissipated", "J"}, tick.dissipated);
  visit(Name{"added_damping", "Ns_per_m"}, tick.added_damping);

  auto& contact = tick.contact;
  visit(Name{"contact"}, contact.status);
  visit(Name{"distance", "m"}, contact.distance);
  for (std::size_t k = 0; k < 3; ++k) visit(Name{"node", kPlaces[k]}, contact.nodes[k]);
  for (std::size_t k = 0; k < 3; ++k) visit(Name{"weight", kPlaces[k]}, contact.weights[k]);
  visit_vector("anchor", "m", contact.anchor, visit);
  visit_vector("displacement", "m", contact.displacement, visit);
  visit_vector("body_force", "N", contact.force, visit);
  visit_matrix("stiffness", "N_per_m", contact.stiffness, visit);
  visit(Name{"energy", "J"}, contact.energy);
  visit(Name{"found"}, contact.support);

  auto& device = tick.device;
  visit(Name{"age", "s"}, tick.age);
  visit(Name{"reports"}, tick.num_reports);
  visit_vector("device_position", "m", device.position, visit);
  for (int k = 0; k < 4; ++k) {
    visit(Name{"device_rotation", std::string_view("xyzw").substr(static_cast<std::size_t>(k), 1)},
          device.rotation.coeffs()[k]);
  }
  visit(Name{"buttons"}, device.buttons);
  visit(Name{"device_time", "s"}, device.device_time);
  visit(Name{"device_counter"}, device.counter);
  visit_vector("device_rate", "m_per_s", device.rate, visit);
  visit_vector("device_angular_rate", "rad_per_s", device.angular_rate, visit);
  visit_vector("joint", "rad", device.joints, visit);

  for (std::size_t k = 0; k < TickRecord::kReports; ++k) {
    visit(Name{"received", kPlaces[k]}, record.received[k]);
  }
  visit(Name{"sent"}, record.sent);
  visit(Name{"write_failed"}, record.write_failed);
  visit(Name{"trust", {}, {}, 2}, record.tick.contact.trust);
  for (std::size_t k = 0; k < 3; ++k) visit(Name{"body", kPlaces[k], {}, 3}, contact.bodies[k]);
  auto& mesh_error = contact.mesh_error;
  for (int k = 0; k < 3; ++k) visit(Name{"mesh_error", kAxes[k], "N", 4}, mesh_error.force[k]);
  visit(Name{"mesh_error_bound", "N", {}, 4}, mesh_error.bound);
  visit(Name{"mesh_error_trust", {}, {}, 4}, mesh_error.trust);
  visit(Name{"mesh_error_corrected", {}, {}, 4}, mesh_error.is_corrected);
  visit(Name{"torn_area", "m2", {}, 6}, contact.torn_area);
  visit(Name{"torn_work", "J", {}, 6}, contact.torn_work);
  visit(Name{"hand_work", "J", {}, 6}, contact.hand_work);
  visit(Name{"friction_work", "J", {}, 7}, contact.friction_work);
}

/// The version of the recordings that are written.
inline constexpr int kVersion = 7;

/// The name of the last column.
inline constexpr std::string_view kSettings = "settings";

/// Calls visit for each setting that may change from tick to tick.
template <class Record, class Visit>
void visit_settings(Record& record, Visit&& visit) {
  auto& servo = record.settings;
  visit(Name{"engaged"}, servo.engaged);
  visit(Name{"dead_man_button"}, servo.dead_man_button);
  visit(Name{"grasp_button", {}, {}, 2}, servo.grasp_button);
  visit_vector("workspace_centre", "m", servo.workspace_centre, visit);
  visit_matrix("workspace_rotation", {}, servo.workspace_rotation, visit);
  visit(Name{"workspace_scale"}, servo.workspace_scale);
  visit(Name{"force_scale"}, servo.force_scale);
  visit(Name{"force_limit", "N"}, servo.force_limit);
  visit(Name{"slew_limit", "N_per_s"}, servo.slew_limit);
  visit(Name{"damping", "Ns_per_m"}, servo.damping);
  visit(Name{"passivity_control"}, servo.passivity_control);
  auto& touch = record.touch;
  visit(Name{"blended"}, touch.blended);
  visit(Name{"bonded"}, touch.bonded);
  visit(Name{"release_force", "N"}, touch.release_force);
  visit(Name{"reach", "m"}, touch.reach);
  visit(Name{"coupling_stiffness", "N_per_m"}, touch.coupling_stiffness);
  visit(Name{"friction", {}, {}, 2}, touch.friction);
  visit(Name{"grows", {}, {}, 5}, touch.grows);
  visit(Name{"fracture_toughness", "J_per_m2", {}, 6}, touch.fracture_toughness);
  visit(Name{"is_blade", {}, {}, 7}, touch.is_blade);
  visit(Name{"blade_toughness", "J_per_m2", {}, 7}, touch.blade_toughness);
  visit(Name{"blade_stiffness", "N_per_m", {}, 7}, touch.blade_stiffness);
  visit(Name{"blade_friction", "N", {}, 7}, touch.blade_friction);
}

/// Calls visit for each setting that stays as it is during a recording.
template <class Setup, class Visit>
void visit_setup(Setup& setup, Visit&& visit) {
  visit(Name{"device"}, setup.device);
  visit(Name{"profile"}, setup.profile);
  visit(Name{"feature"}, setup.feature);
  visit(Name{"scene"}, setup.scene_hash);
  visit(Name{"method"}, setup.touchable.method);
  visit(Name{"linear_polynomial"}, setup.touchable.interpolation.linear_polynomial);
  visit(Name{"intermediate_states"}, setup.touchable.interpolation.intermediate_states);
  visit(Name{"third_derivatives"}, setup.touchable.interpolation.third_derivatives);
  visit(Name{"correct_mesh_error", {}, {}, 4}, setup.touchable.interpolation.correct_mesh_error);
  visit(Name{"period", "s"}, setup.options.period);
  visit(Name{"stale_after", "s"}, setup.options.stale_after);
  visit(Name{"release_after", "s"}, setup.options.release_after);
  visit(Name{"lock_step_timeout", "s"}, setup.options.lock_step_timeout);
  visit(Name{"stop_timeout", "s"}, setup.options.stop_timeout);
  visit(Name{"priority"}, setup.options.priority);
}

}  // namespace palpate::recording

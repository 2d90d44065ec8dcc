// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/devices.h"

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/printable.h"
#include "base/quantity.h"
#include "haptic/palpate_servo/report.h"
#include "haptic/transport/open_device.h"
#include "haptic/transport/simulated_hand.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// The distance of the workspace's centre above the surface, in radii of the workspace.
constexpr double kClearance = 0.25;

double radius_of(const palpate_report::Feature& feature) {
  return PalpateReport(feature).specification().workspace_radius;
}

/// @param clearance, depth As those of Wish, m at the device.
std::shared_ptr<Motion> wished_motion(HandMotion motion, double clearance, double depth) {
  const Vec3 up = Vec3::Zero();
  const Vec3 down(0, 0, -clearance - depth);
  const Vec3 aside(depth, 0, 0);
  using Waypoints = std::vector<ScriptedMotion::Waypoint>;
  switch (motion) {
    case HandMotion::tap:
      return std::make_shared<ScriptedMotion>(
          Waypoints{{0ms, up}, {400ms, down}, {800ms, up}, {1000ms, up}}, true);
    case HandMotion::press:
      return std::make_shared<ScriptedMotion>(
          Waypoints{{0ms, up}, {1000ms, down}, {3000ms, down}, {4000ms, up}}, true);
    case HandMotion::slide:
      return std::make_shared<ScriptedMotion>(Waypoints{{0ms, up},
                                                        {1000ms, down},
                                                        {2000ms, down + aside},
                                                        {4000ms, down - aside},
                                                        {5000ms, down},
                                                        {6000ms, up}},
                                              true);
    case HandMotion::circle: break;
  }
  // The hand makes one turn a second, and goes down and up again within four seconds.
  return std::make_shared<ScriptedMotion>([=](Time time) {
    const double turn = 2 * M_PI * seconds(time);
    const double part = 0.5 * (1 - std::cos(turn / 4));
    Motion::Pose pose;
    pose.position = part * Vec3(depth * std::cos(turn), depth * std::sin(turn), down.z());
    return pose;
  });
}

}  // namespace

Device simulated_device(const std::shared_ptr<Clock>& clock, const Wish& wish, double scale) {
  Device device;
  const BoardOptions options;
  const double reach = radius_of(options.feature) * scale - wish.clearance;
  if (wish.depth > reach) {
    throw InputError("The simulated hand cannot press " + quantity(wish.depth, "m") +
                     " deep: its workspace ends at " + quantity(reach, "m") +
                     ". Give a smaller --depth, or a larger --scale.");
  }
  const auto motion = wished_motion(wish.motion, wish.clearance / scale, wish.depth / scale);
  auto board =
      std::make_unique<SimulatedBoard>(clock, std::make_shared<SimulatedHand>(motion), options);
  device.board = board.get();
  device.setup.device = kSimulated;
  device.setup.feature = board->feature();
  device.profile = make_profile(device.setup.profile, device.setup.feature);
  device.transport = std::move(board);
  return device;
}

Device opened_device(const std::string& which) {
  OpenedDevice opened = open_device(which);
  Device device;
  device.transport = std::move(opened.transport);
  device.profile = std::move(opened.profile);
  device.setup.device = to_string(opened.info);
  device.setup.profile = opened.kind;
  device.setup.feature = opened.feature;
  device.path = opened.info.path;
  return device;
}

double clearance_of(const Specification& device, double scale) {
  return kClearance * device.workspace_radius * scale;
}

double clearance_of_simulated(double scale) {
  return kClearance * radius_of(BoardOptions().feature) * scale;
}

void place_workspace(const Vec3& place, const Vec3& normal, ServoSettings& settings) {
  settings.workspace_centre = place;
  settings.workspace_rotation =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), normal).toRotationMatrix();
}

void print_devices() {
  const std::vector<ListedDevice> devices = list_devices();
  for (const ListedDevice& device : devices) {
    const char* state = !device.known          ? "no haptic device that is known"
                        : device.fault.empty() ? "can be used"
                                               : device.fault.c_str();
    std::printf("%s: %s\n", printable(to_string(device.info)).c_str(), state);
    if (device.specification) print(*device.specification);
  }
  if (devices.empty()) std::printf("No HID device is plugged in.\n");
  std::printf("simulated: is always there\n");
}

}  // namespace palpate

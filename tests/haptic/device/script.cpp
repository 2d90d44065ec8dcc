// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/device/script.h"

#include <algorithm>
#include <cmath>

namespace palpate::test {
namespace {

/// From 0 to 1 while step goes from first to last, without a jump of the speed.
double ease(int step, int first, int last) {
  const double x = std::clamp(double(step - first) / (last - first), 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

}  // namespace

const char* name(Fault fault) {
  switch (fault) {
    case Fault::none: return "none";
    case Fault::device_pause: return "device_pause";
    case Fault::host_pause: return "host_pause";
    case Fault::wrong_size: return "wrong_size";
    case Fault::doubled: return "doubled";
    case Fault::frozen: return "frozen";
    case Fault::empty: return "empty";
    case Fault::unplug: return "unplug";
    case Fault::stall: return "stall";
    case Fault::stop: return "stop";
    case Fault::leave: return "leave";
  }
  return "?";
}

Vec3 stylus(int stroke, int step) {
  const double height = 0.004;
  const double depth = 0.010 + 0.0003 * stroke;
  // Each stroke somewhere else, and in another direction.
  const double angle = 0.7 * stroke;
  const Vec3 above(0.008 * std::cos(2.1 * stroke), 0.008 * std::sin(2.1 * stroke), height);
  const Vec3 along(0.008 * std::cos(angle), 0.008 * std::sin(angle), 0);
  const double down = ease(step, 40, 120) - ease(step, 400, 460);
  return above + down * Vec3(0, 0, -height - depth) + ease(step, 120, 400) * along;
}

}  // namespace palpate::test

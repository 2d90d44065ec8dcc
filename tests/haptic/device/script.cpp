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
    case Fault::away: return "away";
    case Fault::host_pause: return "host_pause";
    case Fault::kill: return "kill";
    case Fault::crash: return "crash";
    case Fault::interrupt: return "interrupt";
    case Fault::write_error: return "write_error";
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

std::vector<Stroke> script() {
  return {
      {},
      {Fault::device_pause, 100},
      {Fault::host_pause, 200, 600},
      {Fault::wrong_size, 50},
      {Fault::doubled, 50},
      {Fault::frozen, 50},
      {Fault::empty, 50},
      {Fault::away, 2000, 2500},
      {Fault::write_error, 100},
      {Fault::unplug, 100},
      // The kernel waits 5 s for a feature report.
      {Fault::stall, 100, 6000},
      {Fault::stop, 50},
      {},
      {Fault::leave, 50},
  };
}

std::vector<Stroke> trials(int number) {
  std::vector<Stroke> strokes;
  for (int i = 0; i < number; ++i) {
    for (const Fault fault : {Fault::kill, Fault::host_pause, Fault::crash, Fault::interrupt}) {
      strokes.push_back({fault, 100});
    }
  }
  // The last of them shows that there is a force again.
  strokes.push_back({});
  strokes.push_back({Fault::leave, 50});
  return strokes;
}

Vec3 stylus(const Stroke& stroke, int number, int step) {
  const double height = 0.004;
  // Of a long script they repeat.
  const int which = number % 14;
  const double depth = 0.010 + 0.0003 * which;
  // A fault that is long is followed by the way out.
  const int late = stroke.length - Stroke{}.length;
  const double down = ease(step, 40, 120) - ease(step, 400 + late, 460 + late);
  const Vec3 vertical = (height - down * (height + depth)) * Vec3::UnitZ();
  if (stroke.fault == Fault::away) {
    return Vec3(step < Stroke::kFaultFrom + stroke.fault_length ? -0.025 : 0.025, 0, 0) + vertical;
  }
  // Each stroke somewhere else, and in another direction.
  const double angle = 0.7 * which;
  const Vec3 above(0.008 * std::cos(2.1 * which), 0.008 * std::sin(2.1 * which), 0);
  const Vec3 along(0.008 * std::cos(angle), 0.008 * std::sin(angle), 0);
  return above + vertical + ease(step, 120, 400) * along;
}

}  // namespace palpate::test

// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/report.h"

#include <cinttypes>
#include <cstdio>
#include <string>

#include "base/printable.h"

namespace palpate {
namespace {

const char* name_of(Pacing pacing) {
  switch (pacing) {
    case Pacing::free_running: return "free-running";
    case Pacing::lock_step: return "lock-step";
    case Pacing::on_change: return "reports on change";
  }
  return "unknown";
}

void print(const char* what, const Percentiles& p) {
  const auto us = [](Duration duration) { return 1e6 * seconds(duration); };
  std::printf("%-12s median %.1f us, 99 %% %.1f us, 99.9 %% %.1f us, largest %.1f us\n", what,
              us(p.median), us(p.p99), us(p.p999), us(p.largest));
}

void print_realtime(bool priority, bool locked) {
  std::printf("realtime     priority %s, memory locked %s\n", priority ? "yes" : "no",
              locked ? "yes" : "no");
}

void print_problem(const std::string& problem) {
  if (!problem.empty()) std::printf("problem      %s\n", printable_message(problem).c_str());
}

}  // namespace

void print(const Specification& device) {
  std::printf("device       %s%s%s: %s, %d button(s)%s\n", device.manufacturer.c_str(),
              device.manufacturer.empty() ? "" : " ", device.model.c_str(), name_of(device.pacing),
              device.num_buttons, device.senses_rotation ? ", senses rotation" : "");
  std::printf("workspace    radius %.4g m, steps of %.3g m\n", device.workspace_radius,
              device.position_resolution);
  if (device.max_linear_force == 0) {
    std::printf("motors       none\n");
    return;
  }
  std::printf("motors       %s%s%s, up to %.4g N in steps of %.3g N, %.4g N/m, %.4g N s/m, ",
              device.actuated[0] ? "x" : "", device.actuated[1] ? "y" : "",
              device.actuated[2] ? "z" : "", device.max_linear_force, device.force_resolution,
              device.max_linear_stiffness, device.max_linear_damping);
  if (device.watchdog.count() > 0) {
    std::printf("off after %.0f ms of silence\n", 1e3 * seconds(device.watchdog));
  } else {
    std::printf("without a watchdog\n");
  }
}

void print(const Touchable& body, Method method) {
  std::printf("body         %s%zu active node(s), %d triangles, %.2f MB, %s, up to %.4g N/m\n",
              body.force_on_tool() != nullptr ? "a rigid tool, " : "", body.nodes().size(),
              body.surface().num_triangles(), 1e-6 * static_cast<double>(body.bytes()),
              to_string(method).c_str(), body.largest_stiffness());
}

void print(const Counters& c, double limit) {
  Statistics rates;
  static_cast<Counters&>(rates) = c;
  std::printf("ticks        %" PRIu64 " in %.3f s, %.1f Hz, %" PRIu64 " missed\n", c.ticks,
              seconds(c.running), rates.rate(), c.missed);
  std::printf("reports      %" PRIu64 " read, %" PRIu64 " bad, %" PRIu64 " lost, %" PRIu64
              " failed reads, %" PRIu64 " failed writes\n",
              c.reports, c.bad_reports, c.lost_reports, c.failed_reads, c.failed_writes);
  std::printf("states       %" PRIu64 " ticks stale, %" PRIu64 " ticks touching\n", c.stale_ticks,
              c.touching_ticks);
  std::printf("interlock    %" PRIu64 " ticks without force; tripped %" PRIu64
              " times by stale reports, %" PRIu64 " by failed writes, %" PRIu64
              " by disengaging, %" PRIu64 " by the guardian, %" PRIu64
              " by a body that stood still\n",
              c.tripped_ticks, c.trips_by_stale_reports, c.trips_by_failed_writes,
              c.trips_by_disengaging, c.trips_by_guardian, c.trips_by_body);
  std::printf("sent         mean %.4f N while touching, largest %.4f N, limit %.4f N\n",
              rates.mean_force(), c.largest_force, limit);
  std::printf("limiter      %" PRIu64 " ticks by size, %" PRIu64 " by change, %" PRIu64
              " not finite\n",
              c.magnitude_limited, c.slew_limited, c.not_finite);
  std::printf("passivity    least balance %.3g J, damping added in %" PRIu64 " ticks\n",
              c.least_dissipated, c.damped_ticks);
  if (c.mesh_error_ticks > 0) {
    std::printf("mesh         at most %.4g N wrong at the body, reliable in %" PRIu64 " of %" PRIu64
                " ticks\n",
                c.largest_mesh_error, c.reliable_mesh_error_ticks, c.mesh_error_ticks);
  }
}

void print_timing(const Statistics& statistics) {
  print("lateness", statistics.lateness);
  print("interval", statistics.interval);
  print("tick", statistics.tick_time);
  print("own work", statistics.own_time);
  print_realtime(statistics.realtime_priority, statistics.memory_locked);
}

void print_end(Servo& servo, SimulatedBoard* board, double force_limit) {
  const Statistics statistics = servo.statistics();
  print(statistics, largest_force(servo.specification(), force_limit));
  print_timing(statistics);
  if (board != nullptr) {
    std::printf("at the end   motors %s\n", board->status().motors_on ? "on" : "off");
  }
  print_problem(servo.problem());
}

void print(const Recorder& recorder) {
  std::printf("recording    %" PRIu64 " ticks, %" PRIu64 " dropped\n", recorder.written(),
              recorder.dropped());
}

void print_end(ReducedBodyThread& body) {
  const ReducedBodyStatistics statistics = body.statistics();
  std::printf("steps        %" PRIu64 " in %.3f s, %.1f Hz, %" PRIu64 " missed, %" PRIu64
              " longer than the period\n",
              statistics.steps, seconds(statistics.running), statistics.rate(), statistics.missed,
              statistics.too_long);
  print("lateness", statistics.lateness);
  print("step", statistics.step_time);
  std::printf("failed       %" PRIu64 " steps without a balance and %" PRIu64
              " beyond training, in which the body stood still; %" PRIu64 " behind their tools\n",
              statistics.not_converged, statistics.beyond_training, statistics.tools_ahead);
  std::printf("trust        largest %.3g, %" PRIu64 " steps above %g\n", statistics.largest_trust,
              statistics.untrusted, kLargestTrusted);
  print_realtime(statistics.realtime_priority, statistics.memory_locked);
  print_problem(body.problem());
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/space.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

#include "base/error.h"
#include "haptic/palpate_servo/devices.h"
#include "haptic/palpate_servo/report.h"
#include "haptic/palpate_servo/signals.h"
#include "haptic/recording/recorder.h"
#include "haptic/recording/replay.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/body_touch.h"
#include "haptic/touching/pressing_range.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

TouchSpace read_space(const StateSpaceFile& file) {
  TouchSpace space = make_touch_space_without_modes(file);
  if (!space.left_out.empty()) {
    std::fprintf(stderr, "%s This is left out.\n",
                 describe_left_out(file.path(), space.left_out).c_str());
  }
  return space;
}

/// Where the space is touched: at the node of the command line, or at start_place().
StartPlace chosen_place(const TouchSpace& space, const Touchable& body, const CommandLine& line) {
  if (!line.node) return start_place(space, body);
  const std::int32_t place = body.find(*line.node);
  if (place >= 0 && body.force_on_tool() == nullptr) {
    const Vec3& at = body.nodes()[static_cast<std::size_t>(place)].rest_position;
    return {at, body.surface().nearest(at).normal,
            space.find({*line.node, kFirstBody})->setup.depth()};
  }
  if (body.force_on_tool() != nullptr) {
    throw InputError(line.space + " has a rigid tool, which presses anywhere. Leave out --node.");
  }
  std::string active;
  for (const Touchable::Node& node : body.nodes()) {
    // The option names nodes of the first body.
    if (node.body != kFirstBody) continue;
    if (active.size() > 60) {
      active += ", …";
      break;
    }
    active += (active.empty() ? "" : ", ") + std::to_string(node.mesh_point);
  }
  throw InputError("Point " + std::to_string(*line.node) + " is no active node of " + line.space +
                   ". Give one of " + active + ".");
}

/// The body that is touched, the place, and the tool.
struct Touched {
  std::shared_ptr<const Touchable> body;
  StartPlace at;
  /// The tool, in words.
  std::string tool;
};

Touched read_touched(const CommandLine& line, std::optional<StateSpaceFile> file) {
  if (!file) return {};
  const TouchSpace space = read_space(*file);
  Touched touched;
  touched.body = std::make_shared<const Touchable>(space, line.touchable);
  touched.at = chosen_place(space, *touched.body, line);
  if (line.touch.is_blade &&
      (!touched.body->torn().is_cut() || touched.body->force_on_tool() != nullptr)) {
    throw InputError(line.space +
                     " has no cut that a blade could open: that takes active nodes and the stages "
                     "of a cut. Leave out --blade, or compute a space with them.");
  }
  const TouchToolSpace* tool = touched.body->force_on_tool() != nullptr ? space.find_pressing()
                               : line.node ? space.find({*line.node, kFirstBody})
                                           : &space.tool_spaces.front();
  touched.tool = tool->setup.name();
  if (tool->setup.presses() && tool->setup.region) {
    touched.tool = tool->setup.interaction.name() + " in " +
                   std::to_string(space.list_pressing().size()) + " regions";
  }
  return touched;
}

void place_device(const Touched& touched, const Specification& device, CommandLine& line) {
  const double height = clearance_of(device, line.settings.workspace_scale);
  place_workspace(touched.at.place + height * touched.at.normal, touched.at.normal, line.settings);
  if (!line.coupling) {
    line.touch.coupling_stiffness =
        coupling_stiffness_for(device, stiffest(*touched.body, line.touch), line.settings);
  }
  print(*touched.body, line.touchable.method);
  std::printf("touching     %s, coupling %.4g N/m\n", touched.tool.c_str(),
              line.touch.coupling_stiffness);
}

/// @throws InputError an option makes no sense for a state space.
void check(const CommandLine& line) {
  if (line.devices.size() > 1) {
    throw InputError("There are " + std::to_string(line.devices.size()) +
                     " devices, but a state space is touched by one. Give --device once, or "
                     "--reduced with a reduced model, which has a tool for each device.");
  }
  for (const char* option : {"--coupling-damping", "--step"}) {
    if (line.given.count(option) == 0) continue;
    throw InputError(std::string(option) +
                     " is for a reduced model, and a state space is touched here. Leave it out, "
                     "or give --reduced.");
  }
}

}  // namespace

int touch_space(CommandLine line, std::optional<StateSpaceFile> file) {
  check(line);
  const Signals signals;
  // The recording is made first, because without it there is no reason to open a device.
  const auto recorder = line.record.empty() ? nullptr : std::make_unique<Recorder>(line.record);
  const Touched touched = read_touched(line, std::move(file));
  const auto& body = touched.body;
  if (body && line.depth == 0) line.depth = touched.at.depth / 2;
  const auto clock = std::make_shared<MonotonicClock>();
  const std::string& which = line.devices.front();
  const double scale = line.settings.workspace_scale;
  const Wish wish{line.motion, clearance_of_simulated(scale), line.depth};
  Device device = which == kSimulated ? simulated_device(clock, wish, scale) : opened_device(which);
  const Specification& specification = device.profile->specification();
  print(specification);
  const std::string notice = device.transport->problem();
  if (!notice.empty()) std::printf("notice       %s\n", notice.c_str());
  if (body) {
    place_device(touched, specification, line);
  } else {
    std::printf("body         none: no forces are sent\n");
    line.settings.engaged = false;
  }
  std::fflush(stdout);

  if (recorder) {
    if (body) device.setup.scene_hash = body->scene_hash();
    device.setup.touchable = line.touchable;
    device.setup.options = line.options;
    recorder->start(device.setup);
  }
  Servo servo(std::move(device.transport), device.profile, clock, line.options);
  if (body) servo.set_touch(make_touch(body));
  servo.set_settings(line.settings);
  servo.set_touch_settings(line.touch);
  if (recorder) servo.set_recording(recorder->ring());

  const Time begin = clock->now();
  servo.start();
  bool gone = false;
  Time told = begin;
  while (!gone && !signals.wait_for(50ms)) {
    servo.host_lives();
    const Time now = clock->now();
    if (line.seconds > 0 && seconds(now - begin) >= line.seconds) break;
    const Tick tick = servo.latest();
    gone = tick.state == ServoState::gone;
    if (!body && now - told >= 500ms) {
      told = now;
      const Vec3& place = tick.device.position;
      std::printf("position     %8.5f %8.5f %8.5f m, buttons %x, %s\n", place.x(), place.y(),
                  place.z(), tick.device.buttons, to_string(tick.state).data());
      std::fflush(stdout);
    }
  }
  const bool ended = servo.stop();

  print_end(servo, ended ? device.board : nullptr, line.settings.force_limit);
  if (recorder) {
    recorder->close();
    print(*recorder);
  }
  if (gone) throw BackendError("The device is gone. " + servo.problem());
  if (!ended) {
    throw BackendError("The device's driver hangs: its watchdog has to switch the motors off.");
  }
  return EXIT_SUCCESS;
}

int replay_space(CommandLine line, const StateSpaceFile& file) {
  RecordingReader reader(line.replay);
  const RecordedSetup& setup = reader.setup();
  line.touchable = setup.touchable;
  if (setup.scene_hash.empty()) {
    throw InputError("The recording " + line.replay +
                     " is of no state space: of a device alone, or of a reduced model, whose body "
                     "a replay cannot step again. Give a recording of a state space.");
  }
  const auto body = std::make_shared<const Touchable>(read_space(file), line.touchable);
  if (!is_same_space(body->scene_hash(), setup.scene_hash)) {
    throw InputError("The recording " + line.replay + " is of another scene than " + line.space +
                     ". Give the state space that was touched.");
  }
  const auto clock = std::make_shared<VirtualClock>();
  ReplayTransport device(clock);
  const auto profile = make_profile(setup.profile, setup.feature);
  print(profile->specification());
  print(*body, setup.touchable.method);

  LoopInbox inbox;
  LoopOutbox outbox;
  inbox.touch.offer(make_touch(body));
  std::uint64_t num_different = 0;
  double largest_difference = 0;
  double limit = 0;
  {
    Loop loop(device, *profile, *clock, setup.options, inbox, outbox);
    for (TickRecord record; reader.next(record);) {
      inbox.settings.write({record.settings, record.touch});
      limit = std::max(limit, largest_force(profile->specification(), record.settings.force_limit));
      device.play(record);
      loop.tick();
      loop.wait();
      const Vec3 difference = loop.last().force - record.tick.force;
      if (!difference.isZero(0)) ++num_different;
      largest_difference = std::max(largest_difference, difference.norm());
    }
  }
  print(outbox.newest.read().counters, limit);
  std::printf("replay       forces differ in %llu ticks, by up to %.3g N\n",
              static_cast<unsigned long long>(num_different), largest_difference);
  if (!reader.notice().empty()) std::printf("notice       %s\n", reader.notice().c_str());
  return EXIT_SUCCESS;
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// A haptic device touches a state space, from the command line.
//
//   palpate-servo liver.palpate                                  a simulated board and hand
//   palpate-servo --device list                                  what is plugged in
//   palpate-servo --device 1234:0006                             where it is, without forces
//   palpate-servo liver.palpate --device 1234:0006 --seconds 0   a real one, until Ctrl+C
//   palpate-servo liver.palpate --record run.csv                 every tick into a table
//   palpate-servo liver.palpate --replay run.csv                 the same ticks again
//
// Prints a line a subject: the device, the body, how well the loop kept its time, what was sent.
// Ends with 1 and a message on stderr where something is wrong with what was given or the device.
#include <pthread.h>
#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <vector>

#include "base/error.h"
#include "base/memory_error.h"
#include "base/quantity.h"
#include "haptic/palpate_servo/command_line.h"
#include "haptic/palpate_servo/report.h"
#include "haptic/recording/recorder.h"
#include "haptic/recording/replay.h"
#include "haptic/servo/servo.h"
#include "haptic/touching/pressing_range.h"
#include "haptic/transport/open_device.h"
#include "haptic/transport/simulated_board.h"
#include "haptic/transport/simulated_hand.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// Ctrl+C, Ctrl+\ (SIGQUIT), Ctrl+Z (SIGTSTP) and the like, as long as it lasts, for this thread
/// and those that it starts: they are taken by wait_for(), and neither break off nor freeze a loop
/// that sends forces.
class Signals {
 public:
  Signals() {
    sigemptyset(&signals_);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGTSTP}) {
      sigaddset(&signals_, signal);
    }
    pthread_sigmask(SIG_BLOCK, &signals_, &before_);
  }
  ~Signals() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  /// @return Whether one has come.
  [[nodiscard]] bool wait_for(std::chrono::milliseconds time) const {
    const timespec timeout{0, static_cast<long>(time.count()) * 1'000'000};
    return sigtimedwait(&signals_, nullptr, &timeout) > 0;
  }

 private:
  sigset_t signals_{};
  sigset_t before_{};
};

void print_devices() {
  const std::vector<ListedDevice> devices = list_devices();
  for (const ListedDevice& device : devices) {
    const char* state = !device.known          ? "no haptic device that is known"
                        : device.fault.empty() ? "can be used"
                                               : device.fault.c_str();
    std::printf("%s: %s\n", to_string(device.info).c_str(), state);
    if (device.specification) print(*device.specification);
  }
  if (devices.empty()) std::printf("No HID device is plugged in.\n");
  std::printf("simulated: is always there\n");
}

TouchSpace read_space(const std::string& path) {
  TouchSpace space = make_touch_space_without_modes(StateSpaceFile::open_read_only(path));
  if (!space.left_out.empty()) {
    std::fprintf(stderr, "%s This is left out.\n", describe_left_out(path, space.left_out).c_str());
  }
  return space;
}

/// Where the space is touched: at the node of the command line, or where it is best begun.
StartPlace chosen_place(const TouchSpace& space, const Touchable& body, const CommandLine& line) {
  if (!line.node) return start_place(space, body);
  const std::int32_t place = body.find(*line.node);
  if (place >= 0 && body.force_on_tool() == nullptr) {
    const Vec3& at = body.nodes()[static_cast<std::size_t>(place)].rest_position;
    return {at, body.surface().nearest(at).normal, depth_of(space.find(*line.node)->setup)};
  }
  if (body.force_on_tool() != nullptr) {
    throw InputError(line.space + " has a rigid tool, which presses anywhere. Leave out --node.");
  }
  std::string active;
  for (const Touchable::Node& node : body.nodes()) {
    if (active.size() > 60) {
      active += ", …";
      break;
    }
    active += (active.empty() ? "" : ", ") + std::to_string(node.mesh_point);
  }
  throw InputError("Point " + std::to_string(*line.node) + " is no active node of " + line.space +
                   ". Give one of " + active + ".");
}

/// Of the workspace's radius: how far its centre is above the surface.
constexpr double kClearance = 0.25;

/// Puts the device's workspace over a place, its z along the outward normal: down is into the body.
void place_workspace(const StartPlace& at, const Specification& device, ServoSettings& settings) {
  const double height = kClearance * device.workspace_radius * settings.workspace_scale;
  settings.workspace_centre = at.place + height * at.normal;
  settings.workspace_rotation =
      Eigen::Quaterniond::FromTwoVectors(Vec3::UnitZ(), at.normal).toRotationMatrix();
}

/// What a hand wants: from the centre of the workspace down to the node and into the body, again
/// and again.
/// @param clearance From the centre to the surface, m at the device. @param depth The same.
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
  // A turn a second, down and up in four.
  return std::make_shared<ScriptedMotion>([=](Time time) {
    const double turn = 2 * M_PI * seconds(time);
    const double part = 0.5 * (1 - std::cos(turn / 4));
    Motion::Pose pose;
    pose.position = part * Vec3(depth * std::cos(turn), depth * std::sin(turn), down.z());
    return pose;
  });
}

struct Device {
  std::unique_ptr<Transport> transport;
  std::shared_ptr<const Profile> profile;
  RecordedSetup setup;
  /// The same as the transport where it is simulated.
  SimulatedBoard* board = nullptr;
};

/// @param depth Where the hand wants to be in the body, m in the scene.
Device simulated_device(const std::shared_ptr<Clock>& clock, HandMotion motion, double depth,
                        double scale) {
  Device device;
  const BoardOptions options;
  const double radius = PalpateReport(options.feature).specification().workspace_radius;
  const double reach = (1 - kClearance) * radius * scale;
  if (depth > reach) {
    throw InputError("The simulated hand cannot press " + quantity(depth, "m") +
                     " deep: its workspace ends at " + quantity(reach, "m") +
                     ". Give a smaller --depth, or a larger --scale.");
  }
  const auto wish = wished_motion(motion, kClearance * radius, depth / scale);
  auto board =
      std::make_unique<SimulatedBoard>(clock, std::make_shared<SimulatedHand>(wish), options);
  device.board = board.get();
  device.setup.device = "simulated";
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
  return device;
}

/// What is touched, and where.
struct Touched {
  std::shared_ptr<const Touchable> body;
  StartPlace at;
  /// Which tool, in words.
  std::string tool;
};

Touched read_touched(const CommandLine& line) {
  if (line.space.empty()) return {};
  const TouchSpace space = read_space(line.space);
  Touched touched;
  touched.body = std::make_shared<const Touchable>(space, line.touchable);
  touched.at = chosen_place(space, *touched.body, line);
  const TouchToolSpace* tool =
      touched.body->force_on_tool() != nullptr
          ? space.find(kContactToolSpace)
          : space.find(line.node.value_or(space.tool_spaces.front().setup.id));
  touched.tool = tool->setup.name();
  return touched;
}

void place_device(const Touched& touched, const Specification& device, CommandLine& line) {
  place_workspace(touched.at, device, line.settings);
  if (!line.coupling) {
    line.touch.coupling_stiffness =
        coupling_stiffness_for(device, touched.body->largest_stiffness(), line.settings);
  }
  print(*touched.body, line.touchable.method);
  std::printf("touching     %s, coupling %.4g N/m\n", touched.tool.c_str(),
              line.touch.coupling_stiffness);
}

int run(CommandLine line) {
  const Signals signals;
  // First of all: without a place for it there is no reason to open a device.
  const auto recorder = line.record.empty() ? nullptr : std::make_unique<Recorder>(line.record);
  const Touched touched = read_touched(line);
  const auto& body = touched.body;
  if (body && line.depth == 0) line.depth = touched.at.depth / 2;
  const auto clock = std::make_shared<MonotonicClock>();
  Device device = line.device == "simulated" ? simulated_device(clock, line.motion, line.depth,
                                                                line.settings.workspace_scale)
                                             : opened_device(line.device);
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
  servo.set_body(body);
  servo.set_settings(line.settings);
  servo.set_touch_settings(line.touch);
  if (recorder) servo.set_recording(recorder->ring());

  const Time begin = clock->now();
  servo.start();
  bool gone = false;
  Time told = begin;
  while (!gone && !signals.wait_for(50ms)) {
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

  const Statistics statistics = servo.statistics();
  print(statistics, largest_force(specification, line.settings.force_limit));
  print_timing(statistics);
  if (device.board != nullptr && ended) {
    std::printf("at the end   motors %s\n", device.board->status().motors_on ? "on" : "off");
  }
  const std::string problem = servo.problem();
  if (!problem.empty()) std::printf("problem      %s\n", problem.c_str());
  if (recorder) {
    recorder->close();
    std::printf("recording    %llu ticks, %llu dropped\n",
                static_cast<unsigned long long>(recorder->written()),
                static_cast<unsigned long long>(recorder->dropped()));
  }
  if (gone) throw BackendError("The device is gone. " + problem);
  if (!ended) {
    throw BackendError("The device's driver hangs: its watchdog has to switch the motors off.");
  }
  return EXIT_SUCCESS;
}

int replay(CommandLine line) {
  RecordingReader reader(line.replay);
  const RecordedSetup& setup = reader.setup();
  line.touchable = setup.touchable;
  const auto body = std::make_shared<const Touchable>(read_space(line.space), line.touchable);
  if (body->scene_hash() != setup.scene_hash) {
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
  inbox.body.offer(body);
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

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    const auto line = palpate::parse_command_line(argc, argv);
    if (!line) return EXIT_SUCCESS;
    if (line->device == "list") {
      palpate::print_devices();
      return EXIT_SUCCESS;
    }
    return line->replay.empty() ? palpate::run(*line) : palpate::replay(*line);
  } catch (const std::bad_alloc&) {
    char text[palpate::kMemoryTextBytes];
    palpate::describe_memory(nullptr, text);
    std::fprintf(stderr, "palpate-servo: %s\n", text);
    return EXIT_FAILURE;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "palpate-servo: %s\n", error.what());
    return EXIT_FAILURE;
  }
}

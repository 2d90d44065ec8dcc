// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/reduced.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/printable.h"
#include "base/quantity.h"
#include "haptic/palpate_servo/devices.h"
#include "haptic/palpate_servo/report.h"
#include "haptic/palpate_servo/signals.h"
#include "haptic/recording/recorder.h"
#include "haptic/servo/reduced_touch.h"

namespace palpate {
namespace {

using namespace std::chrono_literals;

/// The distance from the tool at which the simulated hand begins, in reaches of the tool, and how
/// far it moves the tool, as a share of what the model was trained for. They are those of
/// ParaView's dock.
constexpr double kHandHeight = 1.2;
constexpr double kHandDepth = 0.6;

bool is_simulated(const std::string& device) { return device == kSimulated; }

/// @throws InputError an option makes no sense for a reduced model.
void check_reduced(const CommandLine& line) {
  if (!line.replay.empty()) {
    throw InputError(
        "A recording of a reduced model cannot be replayed: the steps of its body are not in it, "
        "and cannot be repeated to the bit. Leave out --replay. In ParaView, Simulate Touch leads "
        "the "
        "body along it, as the page of that filter says.");
  }
  for (const char* option : {"--node", "--method", "--bonded", "--release-force", "--no-blending",
                             "--no-mesh-correction", "--friction", "--toughness", "--blade"}) {
    if (line.given.count(option) == 0) continue;
    throw InputError(std::string(option) +
                     " is for a state space, and a reduced model is touched here. Leave it out.");
  }
  const std::vector<std::string>& devices = line.devices;
  const bool all_simulated = std::all_of(devices.begin(), devices.end(), is_simulated);
  for (const char* option : {"--grasp", "--dead-man"}) {
    if (line.given.count(option) == 0 || !all_simulated) continue;
    throw InputError(std::string(option) +
                     " is for a real device: a simulated hand holds its tool without a button. "
                     "Leave it out.");
  }
  for (auto device = devices.begin(); device != devices.end(); ++device) {
    if (is_simulated(*device) || std::find(devices.begin(), device, *device) == device) continue;
    throw InputError("--device " + *device +
                     " is given twice, but a device moves one tool. Give another one by its path; "
                     "palpate-servo --device list says which there are.");
  }
  const double release_after = seconds(line.options.release_after);
  if (!(line.step > 0 && line.step < release_after)) {
    throw InputError("--step is " + quantity(line.step, "s") +
                     ". Give more than 0, and less than --release-after, which is " +
                     quantity(release_after, "s") + ".");
  }
}

/// A device, its settings, and the tool that it moves.
struct Hand {
  Device device;
  ServoSettings settings;
  SimulatedToolOptions tool;
  std::unique_ptr<Recorder> recorder;
};

/// The recorder of a tool: for run.csv it writes run-tool0.csv.
std::unique_ptr<Recorder> make_recorder(const std::string& file, std::size_t tool) {
  if (file.empty()) return nullptr;
  const std::filesystem::path path(file);
  if (is_directory(path)) {
    throw InputError(file + " is a folder. Give the name of a new file in it for the recordings.");
  }
  std::filesystem::path of_tool = path.parent_path() / path.stem();
  of_tool += "-tool" + std::to_string(tool);
  of_tool += path.extension();
  return std::make_unique<Recorder>(of_tool);
}

SimulatedToolOptions options_of_tool(const StartPlace& at, const CommandLine& line) {
  SimulatedToolOptions options;
  options.place = at.place;
  options.reach = at.depth;
  options.coupling_stiffness = line.coupling.value_or(options.coupling_stiffness);
  options.coupling_damping = line.coupling_damping;
  options.release_after = line.options.release_after;
  validate(options);
  return options;
}

/// Opens the device, and puts its workspace over the tool: beyond its reach, so that the hand takes
/// hold when it comes down.
void prepare(Hand& hand, const StartPlace& at, const std::string& which,
             const std::shared_ptr<Clock>& clock, const CommandLine& line) {
  hand.settings = line.settings;
  const double scale = line.settings.workspace_scale;
  double clearance = (kHandHeight - 1) * at.depth;
  if (is_simulated(which)) {
    const double depth = line.depth > 0 ? line.depth : kHandDepth * at.depth;
    hand.device = simulated_device(clock, {line.motion, clearance, depth}, scale);
    hand.settings.dead_man_button = hand.settings.grasp_button = -1;
  } else {
    hand.device = opened_device(which);
    clearance = clearance_of(hand.device.profile->specification(), scale);
  }
  place_workspace(at.place + (at.depth + clearance) * at.normal, at.normal, hand.settings);
  if (!line.coupling) {
    hand.tool.coupling_stiffness = coupling_stiffness_of_tool(
        hand.device.profile->specification(), hand.tool.coupling_stiffness, hand.settings);
  }
}

void check_different(const std::vector<Hand>& hands) {
  for (std::size_t i = 0; i < hands.size(); ++i) {
    const std::string& path = hands[i].device.path;
    for (std::size_t k = 0; k < i && !path.empty(); ++k) {
      if (hands[k].device.path != path) continue;
      throw InputError("The devices of tools " + std::to_string(k) + " and " + std::to_string(i) +
                       " are the same, " + path +
                       ". Give another one by its path; palpate-servo "
                       "--device list says which there are.");
    }
  }
}

void print_begin(const TouchedModel& touched, const std::vector<Hand>& hands,
                 const CommandLine& line) {
  std::printf(
      "body         reduced model %lld: %d modes, %d points, %zu tool(s), a step each %g ms\n",
      static_cast<long long>(touched.number), touched.model->num_modes,
      touched.model->points.num_points(), touched.tools.size(), 1e3 * line.step);
  for (std::size_t tool = 0; tool < touched.tools.size(); ++tool) {
    std::printf("tool %-7zu at point %d, ", tool, touched.nodes[tool]);
    if (tool >= hands.size()) {
      std::printf("without a device: it moves with the body\n");
      continue;
    }
    const Hand& hand = hands[tool];
    std::printf("%s, reach %.4g m, coupling %.4g N/m\n",
                printable(hand.device.setup.device).c_str(), hand.tool.reach,
                hand.tool.coupling_stiffness);
    print(hand.device.profile->specification());
    const std::string notice = hand.device.transport->problem();
    if (!notice.empty()) std::printf("notice       %s\n", printable_message(notice).c_str());
  }
  std::fflush(stdout);
}

std::unique_ptr<ReducedTouch> make_touch(const TouchedModel& touched, std::vector<Hand>& hands,
                                         const std::shared_ptr<Clock>& clock,
                                         const CommandLine& line) {
  ReducedBodyThreadOptions options;
  options.loop.period = Duration(std::llround(1e9 * line.step));
  options.loop.release_after = line.options.release_after;
  if (line.options.priority == 0) options.priority = 0;
  std::vector<SimulatedToolOptions> tools;
  for (std::size_t tool = 0; tool < touched.tools.size(); ++tool) {
    tools.push_back(tool < hands.size() ? hands[tool].tool
                                        : options_of_tool(touched.tools[tool], line));
  }
  auto body = std::make_unique<ReducedBodyThread>(touched.model, tools, clock, options);
  std::vector<std::unique_ptr<Servo>> servos;
  for (Hand& hand : hands) {
    servos.push_back(std::make_unique<Servo>(std::move(hand.device.transport), hand.device.profile,
                                             clock, line.options));
    servos.back()->set_settings(hand.settings);
    if (!hand.recorder) continue;
    hand.device.setup.options = line.options;
    hand.recorder->start(hand.device.setup);
    servos.back()->set_recording(hand.recorder->ring());
  }
  return std::make_unique<ReducedTouch>(std::move(body), std::move(servos));
}

bool contains(const std::vector<Index>& tools, Index tool) {
  return std::find(tools.begin(), tools.end(), tool) != tools.end();
}

/// The name for a message, such as "The device of tool 1 (simulated)".
std::string name_of(Index tool, const std::vector<Hand>& hands) {
  return "The device of tool " + std::to_string(tool) + " (" +
         hands[static_cast<std::size_t>(tool)].device.setup.device + ')';
}

}  // namespace

int touch_reduced(const CommandLine& line, StateSpaceFile file) {
  check_reduced(line);
  const Signals signals;
  const TouchedModel touched = read_touched_model(file, line.reduced);
  file.close();
  if (line.devices.size() > touched.tools.size()) {
    throw InputError("There are " + std::to_string(line.devices.size()) +
                     " devices, but the reduced model has " + std::to_string(touched.tools.size()) +
                     " tool(s). Give --device once for each at the most.");
  }
  // The recordings are made first, because without them there is no reason to open a device. All
  // devices are opened before any is used.
  std::vector<Hand> hands(line.devices.size());
  for (std::size_t tool = 0; tool < hands.size(); ++tool) {
    hands[tool].tool = options_of_tool(touched.tools[tool], line);
    hands[tool].recorder = make_recorder(line.record, tool);
  }
  const auto clock = std::make_shared<MonotonicClock>();
  for (std::size_t tool = 0; tool < hands.size(); ++tool) {
    prepare(hands[tool], touched.tools[tool], line.devices[tool], clock, line);
  }
  check_different(hands);
  print_begin(touched, hands, line);
  const auto touch = make_touch(touched, hands, clock, line);

  const Time begin = clock->now();
  touch->start();
  std::vector<Index> lost;
  while (lost.empty() && !signals.wait_for(50ms)) {
    touch->host_lives();
    if (line.seconds > 0 && seconds(clock->now() - begin) >= line.seconds) break;
    lost = touch->lost();
  }
  const std::vector<Index> hanging = touch->stop();

  std::string wrong;
  const auto add = [&](const std::string& what) { wrong += (wrong.empty() ? "" : " ") + what; };
  for (std::size_t number = 0; number < hands.size(); ++number) {
    const auto tool = static_cast<Index>(number);
    const Hand& hand = hands[number];
    Servo& servo = *touch->servo(tool);
    const bool hangs = contains(hanging, tool);
    std::printf("tool %-7d %s\n", tool, printable(hand.device.setup.device).c_str());
    print_end(servo, hangs ? nullptr : hand.device.board, line.settings.force_limit);
    if (contains(lost, tool)) add(name_of(tool, hands) + " is gone. " + servo.problem());
    if (hangs) {
      add(name_of(tool, hands) +
          " has a driver that hangs: its watchdog has to switch the motors off.");
    }
    if (!hand.recorder) continue;
    try {
      hand.recorder->close();
    } catch (const BackendError& error) {
      add(error.what());
    }
    print(*hand.recorder);
  }
  std::printf("body         reduced model %lld\n", static_cast<long long>(touched.number));
  print_end(touch->body());
  if (!wrong.empty()) throw BackendError(wrong);
  return EXIT_SUCCESS;
}

}  // namespace palpate

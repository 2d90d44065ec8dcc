// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/palpate_servo/command_line.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

/// The methods by their names on the command line, such as "energy-hermite".
std::map<std::string, Method> methods() {
  std::map<std::string, Method> result;
  for (const Method method : all_methods()) {
    std::string name = to_string(method);
    std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
      return c == ' ' ? '-' : static_cast<char>(std::tolower(c));
    });
    result[name] = method;
  }
  return result;
}

template <class Value>
std::string names(const std::map<std::string, Value>& values) {
  std::string text;
  for (const auto& [name, value] : values) text += (text.empty() ? "" : ", ") + name;
  return text;
}

template <class Value>
void add_choice(CLI::App& app, const std::string& option, Value& value,
                const std::map<std::string, Value>& choices, const std::string& meaning,
                const std::string& usual) {
  app.add_option_function<std::string>(
         option,
         [&value, choices, option](const std::string& name) {
           const auto found = choices.find(name);
           if (found == choices.end()) {
             throw CLI::ValidationError(option, '"' + name + "\" is none of " + names(choices));
           }
           value = found->second;
         },
         meaning + ": " + names(choices) + " (" + usual + ")")
      ->type_name("NAME");
}

/// Adds a flag that switches something off.
void add_without(CLI::App& app, const std::string& option, bool& value,
                 const std::string& meaning) {
  app.add_flag_callback(
      option, [&value] { value = false; }, meaning);
}

}  // namespace

std::optional<CommandLine> parse_command_line(int argc, char** argv) {
  CommandLine line;
  ServoSettings& settings = line.settings;
  TouchSettings& touch = line.touch;
  bool realtime = true;
  CLI::App app(
      "Lets a haptic device touch a state space, or several devices a reduced model, and prints "
      "how well the loops kept their time and their safety rules.\nEnds after --seconds, or with "
      "Ctrl+C, Ctrl+\\ or Ctrl+Z.",
      "palpate-servo");
  app.option_defaults()->always_capture_default();
  const CLI::Option* space =
      app.add_option("space", line.space,
                     "The file with the state space or the reduced model (.palpate); none: with "
                     "--device, to see where the device is, without forces")
          ->type_name("FILE");
  const CLI::Option* device =
      app.add_option("--device", line.devices,
                     "simulated; list, to print what is plugged in; or a device by its path "
                     "(/dev/hidraw3) or vendor and product (1234:0006). Give it once for each tool "
                     "of a reduced model, in turn; a tool without a device is free and moves with "
                     "the body")
          ->allow_extra_args(false)
          ->default_str(kSimulated)
          ->type_name("NAME");
  const CLI::Option* reduced =
      app.add_option("--reduced", line.reduced,
                     "Touches this reduced model of the file, from 1, in place of its state space; "
                     "a file with one model and no state space does not need it. --node, --method, "
                     "--bonded, --release-force, --no-blending, --no-mesh-correction, --friction, "
                     "--toughness, --blade and --replay are not for it")
          ->type_name("NUMBER");
  app.add_option("--step", line.step,
                 "From step to step of a reduced body, s: one that misses many needs more");
  add_choice<HandMotion>(app, "--motion", line.motion,
                         {{"tap", HandMotion::tap},
                          {"press", HandMotion::press},
                          {"slide", HandMotion::slide},
                          {"circle", HandMotion::circle}},
                         "What the simulated hand wants to do", "press");
  app.add_option("--depth", line.depth,
                 "How deep the simulated hand wants to be, m; the body holds it up. 0: half of "
                 "what the space reaches, or 0.6 of what the reduced model was trained for");
  app.add_option("--node", line.node,
                 "The active node that is touched (the first); not with a rigid tool")
      ->type_name("POINT");
  app.add_option("--seconds", line.seconds, "How long; 0: until Ctrl+C");
  app.add_option("--record", line.record,
                 "Writes every tick into a new table; of a reduced model into one for each tool "
                 "that a device has, run-tool0.csv for run.csv and so on")
      ->type_name("CSV");
  const CLI::Option* replay =
      app.add_option("--replay", line.replay,
                     "Runs the ticks of a recording again, with its settings, and compares the "
                     "forces")
          ->type_name("CSV");
  add_choice(app, "--method", line.touchable.method, methods(), "Interpolation", "energy-hermite");
  app.add_option("--scale", settings.workspace_scale,
                 "Metres in the scene for a metre at the device");
  app.add_option("--force-scale", settings.force_scale,
                 "Newtons at the device for a newton of the body");
  app.add_option("--force-limit", settings.force_limit,
                 "Largest force, N; 0: that of the device, which is never exceeded");
  app.add_option("--slew-limit", settings.slew_limit,
                 "Largest change of the force in a second, N/s");
  app.add_option("--damping", settings.damping, "Damping of the hand while it touches, N·s/m");
  app.add_option("--coupling", line.coupling,
                 "Stiffness between tool and body, N/m; 0: none (what the device displays, where "
                 "the body is stiffer); between hand and tool of a reduced model more than 0 (300, "
                 "or what the device displays)")
      ->type_name("FLOAT");
  app.add_option("--coupling-damping", line.coupling_damping,
                 "Damping between hand and tool of a reduced model, N·s/m");
  app.add_option(
         "--dead-man", settings.dead_man_button,
         "Forces only while this button of the device is held, from 0; -1: none is required")
      ->type_name("BUTTON");
  app.add_option(
         "--grasp", settings.grasp_button,
         "A rigid tool holds the active node at which it presses while this button of the device "
         "is held, from 0; -1: it presses alone. The tool of a reduced model is held while this "
         "button of a real device is; -1: from when the hand has come within its reach, as a "
         "simulated one does")
      ->type_name("BUTTON");
  app.add_option("--friction", touch.friction, "Coefficient of friction of a rigid tool");
  app.add_option(
      "--toughness", touch.fracture_toughness,
      "The energy that it takes to open a cut whose stages the space has, J/m^2; 0: it does "
      "not tear");
  app.add_flag("--blade", touch.is_blade, "The tool is a blade, which opens such a cut");
  app.add_option("--blade-toughness", touch.blade_toughness,
                 "The energy that it takes the blade to open the cut, J/m^2; 0: --toughness");
  app.add_option("--blade-stiffness", touch.blade_stiffness,
                 "The stiffness of the tissue before the edge of the blade, N/m");
  app.add_option("--blade-friction", touch.blade_friction,
                 "The force that it takes to draw the blade through the cut, N");
  double release_after = seconds(line.options.release_after);
  app.add_option("--release-after", release_after,
                 "Without a fresh report, or a step of the reduced body, for so long the tool "
                 "lets go, s");
  app.add_flag("--bonded", touch.bonded, "The tool also pulls");
  app.add_option("--release-force", touch.release_force,
                 "A bonded tool lets go where it pulls with more than this, N; 0: never");
  add_without(app, "--no-blending", touch.blended,
              "The nearest active node is moved alone, not the three of the triangle");
  add_without(app, "--no-passivity-control", settings.passivity_control,
              "No damping is added when the loop makes energy");
  add_without(app, "--no-mesh-correction", line.touchable.interpolation.correct_mesh_error,
              "The force of a space with estimates of the error of its mesh is not corrected");
  add_without(app, "--no-realtime", realtime, "No real-time priority is asked for");

  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    app.exit(help);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw InputError(std::string(error.what()) + ". palpate-servo --help says what there is.");
  }
  if (!realtime) line.options.priority = 0;
  line.options.release_after = Duration(std::llround(1e9 * release_after));
  if (line.space.empty() && (device->count() == 0 || !line.replay.empty())) {
    throw InputError("Which state space? Give a .palpate file. palpate-servo --help says more.");
  }
  if (line.space.empty() && line.reduced) {
    throw InputError("--reduced is for a reduced model. Give the .palpate file that holds it.");
  }
  for (const CLI::Option* option : app.get_options()) {
    if (option->count() > 0) line.given.insert(option->get_name());
  }
  const bool lists = std::count(line.devices.begin(), line.devices.end(), kList) > 0;
  if (lists && line.devices.size() > 1) {
    throw InputError("--device list prints what is plugged in. Leave the other devices out.");
  }
  if (!line.replay.empty()) {
    for (const CLI::Option* option : app.get_options()) {
      // For a reduced model there is a message of its own.
      if (option->count() == 0 || option == space || option == replay || option == reduced)
        continue;
      throw InputError("--replay and " + option->get_name() +
                       " do not go together: a replay has "
                       "the settings of the recording. Leave one of them out.");
    }
  }
  if (!(std::isfinite(line.seconds) && line.seconds >= 0)) {
    throw InputError("--seconds is " + quantity(line.seconds, "s") + ". Give 0 or more.");
  }
  if (!(std::isfinite(line.depth) && line.depth >= 0)) {
    throw InputError("--depth is " + quantity(line.depth, "m") + ". Give 0 or more.");
  }
  if (line.coupling) touch.coupling_stiffness = *line.coupling;
  validate(line.options);
  validate(settings);
  validate(touch);
  return line;
}

}  // namespace palpate

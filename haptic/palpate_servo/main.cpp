// SPDX-License-Identifier: BSD-3-Clause
// Lets a haptic device touch a state space, or several devices touch a reduced model, from the
// command line.
//
//   palpate-servo liver.palpate                                  a simulated board and hand
//   palpate-servo --device list                                  what is plugged in
//   palpate-servo --device 1234:0006                             where it is, without forces
//   palpate-servo liver.palpate --device 1234:0006 --seconds 0   a real one, until Ctrl+C
//   palpate-servo liver.palpate --record run.csv                 every tick into a table
//   palpate-servo liver.palpate --replay run.csv                 the same ticks again
//   palpate-servo liver.palpate --reduced 1 --device simulated --device simulated
//                                                                two hands hold its reduced model
//
// The program prints a line for each subject: the device, the body, how well the loop kept its
// time, and the forces that were sent. It ends with 1 and a message on stderr where the arguments,
// the file or the device are at fault.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <utility>

#include "base/memory_error.h"
#include "base/printable.h"
#include "haptic/palpate_servo/command_line.h"
#include "haptic/palpate_servo/devices.h"
#include "haptic/palpate_servo/reduced.h"
#include "haptic/palpate_servo/space.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

int run(const CommandLine& line) {
  if (line.devices.front() == kList) {
    print_devices();
    return EXIT_SUCCESS;
  }
  if (line.space.empty()) return touch_space(line, std::nullopt);
  StateSpaceFile file = StateSpaceFile::open_read_only(line.space);
  if (line.reduced || has_only_reduced_models(file)) return touch_reduced(line, std::move(file));
  return line.replay.empty() ? touch_space(line, std::move(file)) : replay_space(line, file);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    const auto line = palpate::parse_command_line(argc, argv);
    return line ? palpate::run(*line) : EXIT_SUCCESS;
  } catch (const std::bad_alloc&) {
    char text[palpate::kMemoryTextBytes];
    palpate::describe_memory(nullptr, text);
    std::fprintf(stderr, "palpate-servo: %s\n", text);
    return EXIT_FAILURE;
  } catch (const std::exception& error) {
    // The message may repeat any bytes that a file has in place of a name.
    std::fprintf(stderr, "palpate-servo: %s\n", palpate::printable_message(error.what()).c_str());
    return EXIT_FAILURE;
  }
}

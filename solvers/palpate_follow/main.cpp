// SPDX-License-Identifier: BSD-3-Clause
// palpate-follow: how fast a hand can be followed by explorers, and how wrong the force is then.
#include <CLI/CLI.hpp>
#include <iostream>
#include <string>
#include <vector>

#include "palpate_follow/follow.h"

namespace {

constexpr double kMillimetre = 1e-3;

void print(const palpate::FollowedRow& row, bool with_names) {
  const auto print_all = [&](const auto& of_column) {
    for (const auto& column : row) {
      std::cout << of_column(column) << (column.first == row.back().first ? "\n" : ",");
    }
  };
  if (with_names) print_all([](const auto& column) { return column.first; });
  print_all([](const auto& column) { return column.second; });
  std::cout.flush();
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app(
      "Follows a hand that palpates a body at random, and prints comma-separated values: the share "
      "of the time in computed cells, how long a cell is waited for and, with explorers on this "
      "machine, the error of the force against solves from where the tool touches nothing, in per "
      "cent of the force that nine tenths of the ticks stay below. The first second does not "
      "count.");
  std::string file;
  std::vector<double> speeds{10, 30, 100};
  std::vector<int> explorers;
  std::vector<int> cores;
  palpate::HandOptions options;
  double extent = options.extent / kMillimetre;
  app.add_option("space", file,
                 "a .palpate file with a space of a rigid tool, of the whole body or of a part of "
                 "it: the body, the tool, and what configurations take")
      ->required()
      ->check(CLI::ExistingFile);
  auto* real = app.add_option("--explorers", explorers,
                              "numbers of explorers on this machine, which follow in real time")
                   ->check(CLI::PositiveNumber);
  auto* simulated =
      app.add_option("--simulated", cores, "numbers of cores, which follow by a virtual clock")
          ->check(CLI::PositiveNumber);
  real->excludes(simulated);
  app.add_option("--speeds", speeds, "of the hand, mm/s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--extent", extent, "how far it goes from the middle of what is pressed, mm")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "how long it palpates")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--between", options.between, "the time between two compared forces, s")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of its way")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    if (explorers.empty() && cores.empty()) explorers = {1};
    options.extent = extent * kMillimetre;
    const palpate::RecordedSpace space(file);
    bool with_names = true;
    for (const int number : cores.empty() ? explorers : cores) {
      for (const double speed : speeds) {
        const double in_metres = speed * kMillimetre;
        print(cores.empty() ? follow_here(space, options, in_metres, number)
                            : simulate_following(space, options, in_metres, number),
              with_names);
        with_names = false;
      }
    }
  } catch (const std::exception& error) {
    std::cerr << "palpate-follow: " << error.what() << '\n';
    return 1;
  }
  return 0;
}

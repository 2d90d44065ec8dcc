// SPDX-License-Identifier: BSD-3-Clause
// A scene, then options with a number each: "--modes 90".
#pragma once

#include <map>
#include <string>
#include <utility>

#include "base/error.h"

namespace palpate {

class Arguments {
 public:
  /// @param defaults Of all options that there are.
  Arguments(int argc, char** argv, std::map<std::string, double> defaults)
      : values_(std::move(defaults)) {
    if (argc < 2 || argc % 2 != 0)
      throw InputError("Give a scene, then options with a value each.");
    scene = argv[1];
    for (int i = 2; i < argc; i += 2)
      values_.at(std::string(argv[i]).substr(2)) = std::stod(argv[i + 1]);
  }
  double operator[](const std::string& name) const { return values_.at(name); }
  std::string scene;

 private:
  std::map<std::string, double> values_;
};

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "materials/rheology.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

void check_not_negative(double value, const std::string& name) {
  if (value >= 0 && std::isfinite(value)) return;
  throw InputError("The " + name + " is " + quantity(value) +
                   "; it must be a number that is not negative.");
}

}  // namespace

bool Rheology::is_viscous() const {
  return viscous_time > 0 ||
         std::any_of(prony_moduli.begin(), prony_moduli.end(), [](double g) { return g > 0; });
}

bool has_density(const std::vector<Rheology>& rheologies) {
  return std::any_of(rheologies.begin(), rheologies.end(),
                     [](const Rheology& of) { return of.density > 0; });
}

void validate(const Rheology& rheology) {
  check_not_negative(rheology.density, "density (Density)");
  check_not_negative(rheology.viscous_time, "viscous time (ViscousTime)");
  double last_time = 0;
  for (int j = 0; j < max_prony_terms; ++j) {
    const std::string number = std::to_string(j + 1);
    check_not_negative(rheology.prony_moduli[j], "ratio " + number + " (PronyModuli)");
    check_not_negative(rheology.prony_times[j], "time " + number + " (PronyTimes)");
    if ((rheology.prony_moduli[j] > 0) != (rheology.prony_times[j] > 0)) {
      throw InputError("Term " + number + " of the Prony series has the ratio " +
                       quantity(rheology.prony_moduli[j]) + " and the time " +
                       quantity(rheology.prony_times[j], "s") + ". Give both above 0, or neither.");
    }
    if (rheology.prony_times[j] == 0) continue;
    if (rheology.prony_times[j] <= last_time) {
      throw InputError("Time " + number + " of the Prony series (PronyTimes) is " +
                       quantity(rheology.prony_times[j], "s") + ", after " +
                       quantity(last_time, "s") +
                       ". Sort the terms by their times, and give each time once.");
    }
    last_time = rheology.prony_times[j];
  }
}

const std::array<std::string, num_rheology_values>& rheology_names() {
  static const auto names = [] {
    std::array<std::string, num_rheology_values> all{"Density", "ViscousTime"};
    for (int j = 0; j < max_prony_terms; ++j) {
      all[2 + 2 * j] = "PronyModulus" + std::to_string(j + 1);
      all[3 + 2 * j] = "PronyTime" + std::to_string(j + 1);
    }
    return all;
  }();
  return names;
}

Rheology make_rheology(const RheologyValues& values) {
  Rheology rheology;
  rheology.density = values[0];
  rheology.viscous_time = values[1];
  for (int j = 0; j < max_prony_terms; ++j) {
    rheology.prony_moduli[j] = values[2 + 2 * j];
    rheology.prony_times[j] = values[3 + 2 * j];
  }
  validate(rheology);
  return rheology;
}

RheologyValues values_of(const Rheology& rheology) {
  RheologyValues values{rheology.density, rheology.viscous_time};
  for (int j = 0; j < max_prony_terms; ++j) {
    values[2 + 2 * j] = rheology.prony_moduli[j];
    values[3 + 2 * j] = rheology.prony_times[j];
  }
  return values;
}

Material scaled(Material material, double factor) {
  const auto& names = parameter_names(material.law);
  for (std::size_t i = 0; i < names.size(); ++i) {
    const bool is_number = names[i] == "PoissonsRatio" || names[i] == "Exponent" ||
                           names[i].rfind("OgdenExponent", 0) == 0;
    if (!is_number) material.parameters[i] *= factor;
  }
  return material;
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/interpolator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "interpolation/energy_hermite.h"
#include "interpolation/linear.h"
#include "interpolation/radial_basis.h"
#include "interpolation/tricubic.h"
#include "interpolation/trilinear.h"

namespace palpate {
namespace {

/// The factor by which the force between configurations may exceed that at them.
constexpr double kBetween = 2;

void limit(TouchResult& result, double size, double most) {
  const Vec3 direction = result.force / size;
  const Mat3 along = direction * (direction.transpose() * result.stiffness);
  result.stiffness = (most / size) * (result.stiffness - along);
  result.force = most * direction;
}

void expand(TouchResult& result, const Vec3& offset) {
  const Vec3 change = result.stiffness * offset;
  result.energy += offset.dot(result.force + 0.5 * change);
  result.force += change;
}

}  // namespace

std::vector<Method> all_methods() {
  return {Method::trilinear, Method::tricubic,       Method::rbf_linear,
          Method::rbf_cubic, Method::energy_hermite, Method::linear};
}

std::string to_string(Method method) {
  switch (method) {
    case Method::trilinear: return "Trilinear";
    case Method::tricubic: return "Tricubic";
    case Method::rbf_linear: return "RBF linear";
    case Method::rbf_cubic: return "RBF cubic";
    case Method::energy_hermite: return "Energy Hermite";
    case Method::linear: return "Linear";
  }
  return "unknown";
}

Interpolator::Interpolator(const TouchToolSpace& tool_space)
    : grid_(tool_space),
      force_limit_(tool_space.setup.policy.force_limit),
      largest_force_(std::numeric_limits<double>::infinity()) {
  take_samples(tool_space.configurations);
}

Interpolator::Interpolator(const Interpolator& before, const TouchToolSpace& tool_space,
                           const std::vector<CheckPoint>& changed, CellTree::Growth& growth)
    : grid_(before.grid_, tool_space, changed, growth),
      force_limit_(tool_space.setup.policy.force_limit),
      largest_force_(std::numeric_limits<double>::infinity()) {
  take_samples(tool_space.configurations);
}

void Interpolator::take_samples(const std::vector<ConfigurationSummary>& configurations) {
  double largest = 0;
  for (std::int32_t n = 0; n < grid_.num_nodes(); ++n) {
    if (!grid_.usable(n)) continue;
    ++num_samples_;
    const ConfigurationSummary& c = configurations[grid_.configuration(n)];
    largest = std::max(largest, c.force.norm());
    if (grid_.reach() == 0) {
      rest_ = {c.force, c.stiffness, c.energy, Support::extrapolated, {}};
    }
  }
  if (grid_.has_extrapolated_nodes()) largest_force_ = std::max(force_limit_, kBetween * largest);
}

void Interpolator::set_linear_from_rest(const TouchResult& rest) {
  rest_ = rest;
  largest_force_ = std::numeric_limits<double>::infinity();
}

void Interpolator::do_smooth_stiffness(const Location& /*at*/, Mat3& /*stiffness*/) const noexcept {
}

TouchResult Interpolator::evaluate(const Vec3& t) const noexcept {
  using Place = CheckPointGrid::Place;
  const Location at = grid_.locate(t);
  TouchResult result;
  result.support = at.support;
  if (at.place == Place::cell) {
    do_evaluate(at, result);
    const double size2 = result.force.squaredNorm();
    if (size2 > largest_force_ * largest_force_) limit(result, std::sqrt(size2), largest_force_);
    return result;
  }
  if (at.place == Place::free) result.mesh_error = mesh_error_of_free_;
  if (at.place == Place::nowhere || at.place == Place::free) return result;
  if (at.place == Place::rest) {
    result = rest_;
  } else {
    do_evaluate(at, result);
    if (result.mesh_error.trust == MeshErrorTrust::reliable) {
      result.mesh_error.trust = MeshErrorTrust::unreliable;
    }
  }
  double size = result.force.norm();
  if (size > largest_force_) {
    result.force *= largest_force_ / size;
    size = largest_force_;
  }
  if (at.place == Place::beside_cell) do_smooth_stiffness(at, result.stiffness);
  expand(result, at.offset);
  if (!std::isfinite(result.energy) || !result.force.allFinite()) return {};
  if (force_limit_ > 0) {
    const double most = std::max(force_limit_, size);
    size = result.force.stableNorm();
    if (size > most) limit(result, size, most);
  }
  return result;
}

std::unique_ptr<Interpolator> make_interpolator(Method method, const TouchToolSpace& tool_space,
                                                const InterpolationOptions& options) {
  if (tool_space.setup.grid.sparse && !serves_sparse_grids(method)) {
    throw InputError("The cells of the tool space at " + tool_space.setup.name() +
                     " do not fill a box, which '" + to_string(method) +
                     "' takes for granted. Choose 'Energy Hermite' or 'Trilinear'.");
  }
  switch (method) {
    case Method::trilinear: return std::make_unique<Trilinear>(tool_space, options);
    case Method::tricubic: return std::make_unique<Tricubic>(tool_space, options);
    case Method::rbf_linear:
    case Method::rbf_cubic: return make_radial_basis(method, tool_space, options);
    case Method::energy_hermite: return std::make_unique<EnergyHermite>(tool_space, options);
    case Method::linear: return std::make_unique<Linear>(tool_space);
  }
  std::string names;
  for (Method known : all_methods()) {
    names += (names.empty() ? "'" : ", '") + to_string(known) + '\'';
  }
  throw InputError("There is no interpolation with the number " +
                   std::to_string(static_cast<int>(method)) + ". There are " + names + '.');
}

std::unique_ptr<Interpolator> make_interpolator(Method method, const TouchToolSpace& tool_space,
                                                const InterpolationOptions& options,
                                                const Interpolator* before,
                                                const std::vector<CheckPoint>& changed) {
  std::unique_ptr<Interpolator> grown;
  if (before != nullptr) grown = before->grown(tool_space, changed);
  return grown != nullptr ? std::move(grown) : make_interpolator(method, tool_space, options);
}

}  // namespace palpate

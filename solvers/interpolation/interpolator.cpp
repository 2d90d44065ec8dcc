// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/interpolator.h"

#include <cmath>

#include "base/error.h"
#include "interpolation/energy_hermite.h"
#include "interpolation/trilinear.h"

namespace palpate {
namespace {

void expand(TouchResult& result, const Vec3& offset) {
  const Vec3 change = result.stiffness * offset;
  result.energy += offset.dot(result.force + 0.5 * change);
  result.force += change;
}

}  // namespace

std::string to_string(Method method) {
  switch (method) {
    case Method::trilinear: return "Trilinear";
    case Method::energy_hermite: return "Energy Hermite";
  }
  return "unknown";
}

TouchResult Interpolator::evaluate(const Vec3& t) const noexcept {
  using Place = CheckPointGrid::Place;
  const CheckPointGrid::Location at = grid_.locate(t);
  TouchResult result;
  switch (at.place) {
    case Place::nowhere: return result;
    case Place::cell:
      result = do_evaluate(grid_.leaf(at.leaf), at.s);
      result.found = at.marked ? Found::marked : Found::inside;
      return result;
    case Place::beside_cell: result = do_evaluate_border(grid_.leaf(at.leaf), at.s); break;
    case Place::check_point: result = do_check_point(at.node); break;
  }
  expand(result, at.offset);
  result.found = Found::extrapolated;
  // So far out that the energy overflows there is nothing to go by.
  return std::isfinite(result.energy) && result.force.allFinite() ? result : TouchResult();
}

std::unique_ptr<Interpolator> make_interpolator(Method method, const TouchSite& site) {
  switch (method) {
    case Method::trilinear: return std::make_unique<Trilinear>(site);
    case Method::energy_hermite: return std::make_unique<EnergyHermite>(site);
  }
  throw InputError("There is no interpolation with the number " +
                   std::to_string(static_cast<int>(method)) +
                   ". Choose 'Trilinear' or 'Energy Hermite'.");
}

}  // namespace palpate

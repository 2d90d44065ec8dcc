// SPDX-License-Identifier: BSD-3-Clause
// The weights of the regions of an organ at a place, a partition of unity:
//
//   W_i(x) = w_i / Σ_j w_j,   w_i = Π_j S(s_ij(x) / b + ½)
//
// s_ij is the distance of x from the plane half-way between the centres i and j, positive on the
// side of i, b the width of the bands, and S(u) = 6u⁵ − 15u⁴ + 10u³ within [0, 1]. The weights have
// continuous second derivatives, and farther than b/2 from all planes one of them is 1.
#pragma once

#include <vector>

#include "base/memory_ranges.h"
#include "state_space/mesh_region.h"

namespace palpate {

class RegionWeights {
 public:
  /// @param regions At least one. All have the same band.
  /// @throws InputError the bands differ, or are not less than the distance of two centres.
  explicit RegionWeights(const std::vector<MeshRegion>& regions);

  [[nodiscard]] int size() const noexcept { return static_cast<int>(centres_.size()); }

  struct Weight {
    int region = 0;
    double value = 0;
    Vec3 gradient = Vec3::Zero();
    Mat3 curvature = Mat3::Zero();
  };

  /// The region whose centre is nearest to a place.
  /// @note Realtime-safe.
  [[nodiscard]] int nearest(const Vec3& x) const noexcept;

  /// Whether a region has a weight somewhere in a cube around a place, with its sides along the
  /// axes; it may say so of one that has none.
  /// @param half Half of the cube's side, m.
  [[nodiscard]] bool may_reach(int region, const Vec3& x, double half) const noexcept;

  /// Calls visit(const Weight&) for each region that has a weight at a place.
  /// @note Realtime-safe.
  template <class Visit>
  void visit(const Vec3& x, Visit&& visit) const noexcept {
    this->visit(
        x, [](int /*region*/) { return true; }, visit);
  }
  /// Does the same with the regions for which counts(region) holds alone, whose weights add up
  /// to 1.
  template <class Counts, class Visit>
  void visit(const Vec3& x, Counts&& counts, Visit&& visit) const noexcept {
    const int first = nearest(x);
    Weight sum;
    for_each_product(x, first, counts, [&](const Weight& w) {
      sum.value += w.value;
      sum.gradient += w.gradient;
      sum.curvature += w.curvature;
    });
    for_each_product(x, first, counts, [&](Weight w) {
      w.value /= sum.value;
      w.gradient = (w.gradient - w.value * sum.gradient) / sum.value;
      const Mat3 mixed = w.gradient * sum.gradient.transpose();
      w.curvature = (w.curvature - mixed - mixed.transpose() - w.value * sum.curvature) / sum.value;
      visit(w);
    });
  }

  void add_memory(MemoryRanges& ranges) const { palpate::add_memory(centres_, ranges); }

 private:
  /// The distance of x from the plane between two centres, m, positive on the side of the first.
  [[nodiscard]] double side(int region, int other, const Vec3& x) const noexcept {
    const Vec3 between = centres_[region] - centres_[other];
    return between.dot(x - 0.5 * (centres_[region] + centres_[other])) / between.norm();
  }
  /// w_i with its derivatives. @returns False: it is 0.
  /// @param first The nearest region, which makes most weights 0.
  [[nodiscard]] bool product(int region, int first, const Vec3& x, Weight& w) const noexcept;
  template <class Counts, class Visit>
  void for_each_product(const Vec3& x, int first, Counts&& counts, Visit&& visit) const noexcept {
    Weight w;
    for (int region = 0; region < size(); ++region) {
      if (product(region, first, x, w) && counts(region)) visit(w);
    }
  }

  std::vector<Vec3> centres_;
  double band_;
};

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/bisection_order.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

namespace palpate {
namespace {

Eigen::AlignedBox3d box_of(const std::vector<Vec3>& places, const Index* first, const Index* last) {
  Eigen::AlignedBox3d box;
  for (const Index* i = first; i != last; ++i) box.extend(places[*i]);
  return box;
}

class Bisection {
 public:
  Bisection(const std::vector<Vec3>& places, Index leaf, const std::vector<char>& goes_first)
      : places_(places), leaf_(leaf), goes_first_(goes_first) {}

  void sort(Index* first, Index* last) const {
    const auto count = static_cast<Index>(last - first);
    if (count <= leaf_) return sort_in_lines(first, last);
    int side = 0;
    box_of(places_, first, last).sizes().maxCoeff(&side);
    Index* middle = first + (count / leaf_ + 1) / 2 * leaf_;
    std::nth_element(first, middle, last, [&](Index a, Index b) {
      return std::make_tuple(places_[a][side], a) < std::make_tuple(places_[b][side], b);
    });
    sort(first, middle);
    sort(middle, last);
  }

 private:
  /// Sorts places into lines along x, and the lines into sheets. Their spacing is the mean spacing
  /// of places that fill the box.
  void sort_in_lines(Index* first, Index* last) const {
    const Eigen::AlignedBox3d box = box_of(places_, first, last);
    const double apart = std::cbrt(box.volume() / static_cast<double>(last - first));
    const auto line_of = [&](Index i, int side) {
      return apart > 0 ? std::floor((places_[i][side] - box.min()[side]) / apart)
                       : places_[i][side];
    };
    const auto key_of = [&](Index i) {
      const bool is_later = goes_first_.empty() || goes_first_[i] == 0;
      return std::make_tuple(is_later, line_of(i, 2), line_of(i, 1), places_[i].x(), i);
    };
    std::sort(first, last, [&](Index a, Index b) { return key_of(a) < key_of(b); });
  }

  const std::vector<Vec3>& places_;
  Index leaf_;
  const std::vector<char>& goes_first_;
};

}  // namespace

std::vector<Index> order_by_bisection(const std::vector<Vec3>& places, Index leaf,
                                      const std::vector<char>& goes_first) {
  std::vector<Index> order(places.size());
  std::iota(order.begin(), order.end(), 0);
  Bisection(places, leaf, goes_first).sort(order.data(), order.data() + order.size());
  return order;
}

}  // namespace palpate

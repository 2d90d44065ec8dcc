// SPDX-License-Identifier: BSD-3-Clause
// The derivatives of the energy by all d coordinates of a tool, of the first three of which, its
// place, a configuration has them by name. The numbers are those of ∂Π/∂q_a, then of ∂²Π/∂q_a∂q_b
// for a ≤ b, then of ∂³Π/∂q_a∂q_b∂q_c for a ≤ b ≤ c, each in ascending order with the last index
// fastest.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <vector>

namespace palpate {

class AllDerivatives {
 public:
  /// The numbers of pairs and triples of n coordinates, in ascending order.
  [[nodiscard]] static constexpr std::size_t pairs(std::size_t n) { return n * (n + 1) / 2; }
  [[nodiscard]] static constexpr std::size_t triples(std::size_t n) {
    return n * (n + 1) * (n + 2) / 6;
  }
  [[nodiscard]] static constexpr std::size_t count(std::size_t d) {
    return d + pairs(d) + triples(d);
  }

  /// @param first [d]. @param second Symmetric [d × d]. @param third [d (d + 1) (d + 2) / 6].
  [[nodiscard]] static std::vector<double> numbers(const Eigen::VectorXd& first,
                                                   const Eigen::MatrixXd& second,
                                                   const Eigen::VectorXd& third) {
    std::vector<double> all(first.begin(), first.end());
    for (Eigen::Index a = 0; a < second.rows(); ++a) {
      for (Eigen::Index b = a; b < second.cols(); ++b) {
        all.push_back(0.5 * (second(a, b) + second(b, a)));
      }
    }
    all.insert(all.end(), third.begin(), third.end());
    return all;
  }

  /// @param numbers [count(d)]; they must outlive this object.
  /// @param d The number of coordinates.
  AllDerivatives(const std::vector<double>& numbers, std::size_t d)
      : numbers_(numbers.data()), d_(d) {
    assert(numbers.size() == count(d));
  }

  [[nodiscard]] double by(std::size_t a) const { return numbers_[a]; }
  [[nodiscard]] double by(std::size_t a, std::size_t b) const {
    if (a > b) std::swap(a, b);
    return numbers_[d_ + pairs(d_) - pairs(d_ - a) + (b - a)];
  }
  [[nodiscard]] double by(std::size_t a, std::size_t b, std::size_t c) const {
    std::array<std::size_t, 3> of{a, b, c};
    std::sort(of.begin(), of.end());
    return numbers_[d_ + pairs(d_) + triples(d_) - triples(d_ - of[0]) + pairs(d_ - of[0]) -
                    pairs(d_ - of[1]) + (of[2] - of[1])];
  }

 private:
  const double* numbers_;
  std::size_t d_;
};

}  // namespace palpate

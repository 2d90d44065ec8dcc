// SPDX-License-Identifier: BSD-3-Clause
// The pattern of the tangent of a body with all that acts on it. It is the pattern of the materials
// together with the pairs of points that energy terms and tools couple.
//
// The pattern grows when a pair is added for which it has no room, and never shrinks. So a term
// whose pairs change from one configuration to the next requires a new analysis only if it couples
// a pair that was never added before. As long as nothing is added, the pattern is that of the
// materials itself, and their values need no map.
#pragma once

#include <array>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/point_pair.h"

namespace palpate {

/// The position in the whole pattern of each value of a pattern that is part of it.
[[nodiscard]] std::vector<Index> positions_in(const SymmetricPattern& whole,
                                              const SymmetricPattern& part);

class SystemPattern {
 public:
  /// @param assembly It must outlive this object.
  explicit SystemPattern(const Assembly& assembly) : assembly_(assembly) {}

  [[nodiscard]] const SymmetricPattern& whole() const {
    return has_grown() ? grown_ : assembly_.pattern();
  }
  /// Whether there are pairs that the materials do not couple.
  [[nodiscard]] bool has_grown() const { return grown_.size > 0; }

  /// Whether there is room for pairs of points.
  [[nodiscard]] bool has_room_for(const std::vector<PointPair>& pairs) const;
  /// Makes room for pairs of points; those of a point that does not move need none.
  /// If the pattern grows, positions in it change.
  /// @throws InputError as require_storable().
  void add(const std::vector<PointPair>& pairs);

  /// Sets `values` on the whole pattern to those of the materials, and to zero beyond them.
  /// @param of_materials The values on Assembly::pattern().
  void spread(const std::vector<double>& of_materials, std::vector<double>& values) const;

 private:
  const Assembly& assembly_;
  /// The pattern with the added pairs; empty as long as nothing was added.
  SymmetricPattern grown_;
  /// The position in grown_ of each value of the materials.
  std::vector<Index> position_;
};

/// The places of the blocks of pairs of points in the values of a tangent.
class PairPlaces {
 public:
  PairPlaces() = default;
  /// @param pairs Pairs that the pattern has room for.
  PairPlaces(std::vector<PointPair> pairs, const Assembly& assembly,
             const SymmetricPattern& pattern);

  [[nodiscard]] const std::vector<PointPair>& pairs() const { return pairs_; }
  /// @param blocks ∂²/∂u_a∂u_b of each pair.
  void add(const std::vector<Mat3>& blocks, std::vector<double>& values) const;

 private:
  struct Place {
    std::array<Index, 3> positions;
    /// The index of the pair.
    std::size_t pair;
    bool is_diagonal;
    /// Whether the block is stored transposed, with the rows of b.
    bool is_transposed;
  };

  std::vector<PointPair> pairs_;
  std::vector<Place> places_;
};

}  // namespace palpate

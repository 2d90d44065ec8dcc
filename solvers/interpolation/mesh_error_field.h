// SPDX-License-Identifier: BSD-3-Clause
// The error of the mesh between the configurations of a tool space that have an estimate of it.
//
// ΔΠ, the energy that a finer mesh would still release, is interpolated as the energy is, with the
// derivatives that are known: ΔΠ and its gradient, minus the error of the force. The higher ones
// are differences (hermite_data.h). So Π + ΔΠ is an energy too, whose gradient does no work around
// a closed loop.
//
// The estimate of a configuration that is not reliable is made smaller until its force is at most
// half of that of the configuration. A configuration without an estimate has the one of the nearest
// that has one, continued to first order, and is not reliable.
#pragma once

#include <vector>

#include "interpolation/hermite_data.h"

namespace palpate {

class MeshErrorField {
 public:
  /// @param configurations Those of the grid, of which at least one that is usable has an estimate,
  ///   see is_known().
  /// @param before The field of the earlier grid, and how the grid has grown from it; null: there
  ///   is none.
  MeshErrorField(const CheckPointGrid& grid,
                 const std::vector<ConfigurationSummary>& configurations,
                 const MeshErrorField* before = nullptr, const CellTree::Growth* growth = nullptr);

  /// Whether a usable configuration of a grid has an estimate.
  [[nodiscard]] static bool is_known(const CheckPointGrid& grid,
                                     const std::vector<ConfigurationSummary>& configurations);

  /// D of ΔΠ [num_nodes], as hermite_data() gives those of Π.
  [[nodiscard]] const std::vector<HermiteNode>& nodes() const { return nodes_; }
  /// Whether the estimates of all corners of a leaf are reliable.
  [[nodiscard]] bool is_reliable(std::int32_t leaf) const noexcept { return reliable_[leaf] != 0; }
  /// Whether Π + ΔΠ may take the place of Π. That is so where an estimate is reliable, and where
  /// each configuration has one whose body is neither inverted nor unstable nor near a fold. The
  /// body at rest must be free of error, which it is not under loads.
  [[nodiscard]] bool corrects() const noexcept { return corrects_; }

  void add_memory(MemoryRanges& ranges) const {
    ranges.push_back({this, sizeof *this});
    palpate::add_memory(nodes_, ranges);
    palpate::add_memory(reliable_, ranges);
  }

 private:
  std::vector<HermiteNode> nodes_;
  std::vector<char> reliable_;
  bool corrects_ = false;
  /// What a field needs that grows from this one; empty unless this one has grown from another.
  HermiteMemory memory_;
};

}  // namespace palpate

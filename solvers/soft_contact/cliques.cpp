// SPDX-License-Identifier: BSD-3-Clause
#include "soft_contact/cliques.h"

#include <algorithm>
#include <cstdint>

namespace palpate {

std::vector<PointPair> Cliques::name_pairs(Index num_points) {
  struct Member {
    std::uint32_t clique;
    std::uint32_t place;
  };
  std::vector<Index> first(static_cast<std::size_t>(num_points) + 1, 0);
  for (const auto& nodes : nodes_) {
    for (const Index node : nodes) ++first[node + 1];
  }
  for (Index p = 0; p < num_points; ++p) first[p + 1] += first[p];
  std::vector<Member> members(static_cast<std::size_t>(first.back()));
  std::vector<Index> next(first.begin(), first.end() - 1);
  pairs_.resize(nodes_.size());
  for (std::size_t c = 0; c < nodes_.size(); ++c) {
    for (std::size_t a = 0; a < nodes_[c].size(); ++a) {
      members[next[nodes_[c][a]]++] = {static_cast<std::uint32_t>(c),
                                       static_cast<std::uint32_t>(a)};
    }
    pairs_[c].resize(nodes_[c].size() * (nodes_[c].size() + 1) / 2);
  }
  std::vector<PointPair> pairs;
  std::vector<Index> pair_of(static_cast<std::size_t>(num_points), -1);
  std::vector<Index> row;
  for (Index low = 0; low < num_points; ++low) {
    row.clear();
    for (Index m = first[low]; m < first[low + 1]; ++m) {
      for (const Index high : nodes_[members[m].clique]) {
        if (high < low || pair_of[high] == low) continue;
        pair_of[high] = low;
        row.push_back(high);
      }
    }
    std::sort(row.begin(), row.end());
    for (const Index high : row) {
      pair_of[high] = static_cast<Index>(pairs.size());
      pairs.push_back({low, high});
    }
    for (Index m = first[low]; m < first[low + 1]; ++m) {
      const auto& [clique, place] = members[m];
      const std::vector<Index>& nodes = nodes_[clique];
      for (std::size_t b = 0; b < nodes.size(); ++b) {
        if (nodes[b] < low) continue;
        const std::size_t less = std::min<std::size_t>(place, b);
        const std::size_t greater = std::max<std::size_t>(place, b);
        pairs_[clique][greater * (greater + 1) / 2 + less] = pair_of[nodes[b]];
      }
    }
    for (const Index high : row) pair_of[high] = -1;
  }
  return pairs;
}

void Cliques::add_blocks(std::size_t clique, const double* lower, std::size_t size,
                         std::vector<Mat3>& blocks) const {
  using Block = Eigen::Map<const Mat3, Eigen::Unaligned, Eigen::OuterStride<>>;
  const std::vector<Index>& nodes = nodes_[clique];
  std::size_t at = 0;
  for (std::size_t a = 0; a < nodes.size(); ++a) {
    for (std::size_t b = 0; b <= a; ++b, ++at) {
      const Block block(lower + 3 * a + 3 * b * size,
                        Eigen::OuterStride<>(static_cast<Eigen::Index>(size)));
      Mat3& sum = blocks[pairs_[clique][at]];
      if (nodes[a] <= nodes[b]) {
        sum += block;
      } else {
        sum += block.transpose();
      }
    }
  }
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/system_pattern.h"

#include <algorithm>
#include <utility>

#include "assembly/point_matrix.h"
#include "base/parallel.h"

namespace palpate {
namespace {

/// The first unknowns of two points that are coupled.
struct Block {
  Index column;
  Index row;
};

bool operator<(const Block& a, const Block& b) {
  return std::pair(a.column, a.row) < std::pair(b.column, b.row);
}
bool operator==(const Block& a, const Block& b) { return a.column == b.column && a.row == b.row; }

/// The blocks of pairs for which a pattern has no room, ascending.
std::vector<Block> find_missing(const std::vector<PointPair>& pairs,
                                const std::vector<Index>& unknown_of_point,
                                const SymmetricPattern& pattern) {
  std::vector<Block> missing;
  for (const PointPair& pair : pairs) {
    const auto [column, row] = std::minmax(unknown_of_point[pair.a], unknown_of_point[pair.b]);
    if (column >= 0 && pattern.find(row, column) < 0) missing.push_back({column, row});
  }
  std::sort(missing.begin(), missing.end());
  missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
  return missing;
}

SymmetricPattern with_blocks(const SymmetricPattern& pattern, const std::vector<Block>& blocks) {
  const std::int64_t num_values =
      pattern.num_values() + 9 * static_cast<std::int64_t>(blocks.size());
  require_storable(num_values);
  SymmetricPattern grown;
  grown.size = pattern.size;
  grown.column_start.reserve(pattern.column_start.size());
  grown.column_start.push_back(0);
  grown.row.reserve(static_cast<std::size_t>(num_values));
  std::vector<Index> added;
  auto next = blocks.begin();
  for (Index column = 0; column < pattern.size; ++column) {
    // The three columns of a point have the same blocks.
    if (next != blocks.end() && next->column == column) {
      added.clear();
      for (; next != blocks.end() && next->column == column; ++next) {
        for (Index r = 0; r < 3; ++r) added.push_back(next->row + r);
      }
    } else if (column % 3 == 0) {
      added.clear();
    }
    const auto first = pattern.row.begin() + pattern.column_start[column];
    const auto last = pattern.row.begin() + pattern.column_start[column + 1];
    std::merge(first, last, added.begin(), added.end(), std::back_inserter(grown.row));
    grown.column_start.push_back(static_cast<Index>(grown.row.size()));
  }
  return grown;
}

}  // namespace

std::vector<Index> positions_in(const SymmetricPattern& whole, const SymmetricPattern& part) {
  std::vector<Index> positions;
  positions.reserve(part.row.size());
  for (Index column = 0; column < part.size; ++column) {
    Index at = whole.column_start[column];
    for (Index i = part.column_start[column]; i < part.column_start[column + 1]; ++i, ++at) {
      while (whole.row[at] != part.row[i]) ++at;
      positions.push_back(at);
    }
  }
  return positions;
}

bool SystemPattern::has_room_for(const std::vector<PointPair>& pairs) const {
  return find_missing(pairs, assembly_.unknown_of_point(), whole()).empty();
}

void SystemPattern::add(const std::vector<PointPair>& pairs) {
  const std::vector<Block> missing = find_missing(pairs, assembly_.unknown_of_point(), whole());
  if (missing.empty()) return;
  grown_ = with_blocks(whole(), missing);
  position_ = positions_in(grown_, assembly_.pattern());
}

void SystemPattern::spread(const std::vector<double>& of_materials,
                           std::vector<double>& values) const {
  values.assign(grown_.row.size(), 0.0);
  for_each_range({static_cast<Index>(position_.size()), kNumbersOfPart},
                 [&](Index first, Index last) {
                   for (Index i = first; i < last; ++i) values[position_[i]] = of_materials[i];
                 });
}

PairPlaces::PairPlaces(std::vector<PointPair> pairs, const Assembly& assembly,
                       const SymmetricPattern& pattern)
    : pairs_(std::move(pairs)) {
  const std::vector<Index>& unknown = assembly.unknown_of_point();
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    const Index a = unknown[pairs_[i].a];
    const Index b = unknown[pairs_[i].b];
    if (a < 0 || b < 0) continue;
    places_.push_back({block_positions(pattern, std::max(a, b), std::min(a, b)), i, a == b, a < b});
  }
}

void PairPlaces::add(const std::vector<Mat3>& blocks, std::vector<double>& values) const {
  for (const Place& place : places_) {
    const Mat3& block = blocks[place.pair];
    for_each_in_block(place.positions, place.is_diagonal, [&](int row, int column, Index position) {
      values[position] += place.is_transposed ? block(column, row) : block(row, column);
    });
  }
}

}  // namespace palpate

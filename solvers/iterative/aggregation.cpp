// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/aggregation.h"

#include <algorithm>
#include <utility>

#include "base/parallel.h"

namespace palpate {
namespace {

/// A motion is linearly dependent if orthogonalisation leaves less than this share of it.
constexpr double kDependentMotion = 1e-8;
/// The least number of rows of a part.
constexpr Index kRowsOfPart = 128;

/// Sums of blocks, by column, while a row is made.
template <class Block>
class RowSums {
 public:
  explicit RowSums(Index num_columns) : place_(num_columns, -1) {}

  Block& at(Index column) {
    if (place_[column] < 0) {
      place_[column] = static_cast<Index>(columns_.size());
      columns_.push_back(column);
      sums_.push_back(Block::Zero());
    }
    return sums_[place_[column]];
  }

  /// Appends the row to a matrix and starts the next row.
  template <class Rows>
  void finish(Rows& rows) {
    std::sort(columns_.begin(), columns_.end());
    for (Index column : columns_) {
      rows.column.push_back(column);
      rows.block.push_back(sums_[place_[column]]);
      place_[column] = -1;
    }
    rows.start.push_back(static_cast<Index>(rows.column.size()));
    columns_.clear();
    sums_.clear();
  }

 private:
  std::vector<Index> place_;
  std::vector<Index> columns_;
  std::vector<Block> sums_;
};

/// Makes the rows of a matrix, in parts that run in parallel.
/// @param make_row Called as make_row(row, sums, rows). It adds blocks to the sums, which finish()
///   appends to the rows.
template <class Rows, class MakeRow>
Rows make_rows(Index num_rows, Index num_columns, MakeRow&& make_row) {
  const Ranges ranges(num_rows, kRowsOfPart);
  std::vector<Rows> of_part(ranges.num_parts());
  for_each_part(ranges.num_parts(), [&](Index part) {
    RowSums<typename decltype(Rows::block)::value_type> sums(num_columns);
    for (Index row = ranges.first(part); row < ranges.first(part + 1); ++row) {
      make_row(row, sums, of_part[part]);
    }
  });
  Rows all = std::move(of_part[0]);
  all.num_columns = num_columns;
  if (ranges.num_parts() == 1) return all;
  std::size_t num_blocks = 0;
  for (const Rows& rows : of_part) num_blocks += rows.column.size();
  num_blocks += all.column.size();
  all.start.reserve(static_cast<std::size_t>(num_rows) + 1);
  all.column.reserve(num_blocks);
  all.block.reserve(num_blocks);
  for (Index part = 1; part < ranges.num_parts(); ++part) {
    Rows& rows = of_part[part];
    const auto before = static_cast<Index>(all.column.size());
    for (Index row = 1; row <= rows.num_rows(); ++row)
      all.start.push_back(before + rows.start[row]);
    all.column.insert(all.column.end(), rows.column.begin(), rows.column.end());
    all.block.insert(all.block.end(), rows.block.begin(), rows.block.end());
    rows = {};
  }
  return all;
}

}  // namespace

ByColumn by_column(Index num_columns, const std::vector<Index>& start,
                   const std::vector<Index>& column) {
  ByColumn result;
  // Counts are stored one index further on, so that the entries of a column begin at start[column +
  // 1] while they are filled in, and at start[column] afterwards.
  result.start.assign(num_columns + 2, 0);
  for (const Index c : column) ++result.start[c + 2];
  for (Index c = 0; c < num_columns; ++c) result.start[c + 2] += result.start[c + 1];
  result.row.resize(column.size());
  result.place.resize(column.size());
  const auto num_rows = static_cast<Index>(start.size()) - 1;
  for (Index row = 0; row < num_rows; ++row) {
    for (Index k = start[row]; k < start[row + 1]; ++k) {
      const Index at = result.start[column[k] + 1]++;
      result.row[at] = row;
      result.place[at] = k;
    }
  }
  result.start.pop_back();
  return result;
}

BlockRows<3, 3> all_blocks(const BlockPattern& pattern, const Neighbourhoods& neighbours,
                           const std::vector<double>& values) {
  BlockRows<3, 3> rows;
  rows.num_columns = pattern.num_nodes;
  rows.start.resize(pattern.num_nodes + 1);
  for (Index node = 0; node <= pattern.num_nodes; ++node) {
    rows.start[node] = neighbours.start[node] + node;
  }
  rows.column.resize(rows.start.back());
  rows.block.resize(rows.start.back());
  for_each_range({pattern.num_nodes, kNodesOfPart}, [&](Index first, Index last) {
    for (Index node = first; node < last; ++node) {
      Index at = rows.start[node];
      bool has_diagonal = false;
      const auto add_diagonal = [&] {
        has_diagonal = true;
        rows.column[at] = node;
        rows.block[at++] = diagonal_block(pattern, values, node);
      };
      for (Index k = neighbours.start[node]; k < neighbours.start[node + 1]; ++k) {
        const auto& [other, place] = neighbours.all[k];
        if (other > node && !has_diagonal) add_diagonal();
        const Mat3 block = block_at(pattern, values, std::min(node, other), place);
        rows.column[at] = other;
        rows.block[at++] = other < node ? block : Mat3(block.transpose());
      }
      if (!has_diagonal) add_diagonal();
    }
  });
  return rows;
}

template <int B>
Aggregates aggregate(const BlockRows<B, B>& matrix, double threshold) {
  const Index num_nodes = matrix.num_rows();
  std::vector<double> size(num_nodes, 0);
  const Ranges ranges(num_nodes, kRowsOfPart);
  for_each_range(ranges, [&](Index first, Index last) {
    for (Index node = first; node < last; ++node) {
      for (Index k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
        if (matrix.column[k] == node) size[node] = matrix.block[k].norm();
      }
    }
  });
  std::vector<char> is_strong(matrix.column.size());
  for_each_range(ranges, [&](Index first, Index last) {
    for (Index node = first; node < last; ++node) {
      for (Index k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
        const Index other = matrix.column[k];
        const double coupling = matrix.block[k].squaredNorm();
        is_strong[k] =
            other != node && coupling > threshold * threshold * size[node] * size[other] ? 1 : 0;
      }
    }
  });
  Aggregates result;
  result.of_node.assign(num_nodes, -1);
  std::vector<Index>& of_node = result.of_node;
  const auto for_strong = [&](Index node, auto&& f) {
    for (Index k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
      if (is_strong[k] != 0) f(matrix.column[k], k);
    }
  };
  // First pass: neighbourhoods none of whose nodes is in an aggregate.
  for (Index node = 0; node < num_nodes; ++node) {
    bool is_free = of_node[node] < 0;
    for_strong(node, [&](Index other, Index) { is_free = is_free && of_node[other] < 0; });
    if (!is_free) continue;
    of_node[node] = result.count;
    for_strong(node, [&](Index other, Index) { of_node[other] = result.count; });
    ++result.count;
  }
  // Second pass: each remaining node has a neighbour in an aggregate, and joins the one to which it
  // is coupled most.
  std::vector<Index> joined = of_node;
  for (Index node = 0; node < num_nodes; ++node) {
    if (of_node[node] >= 0) continue;
    double most = -1;
    for_strong(node, [&](Index other, Index k) {
      if (of_node[other] < 0 || matrix.block[k].squaredNorm() <= most) return;
      most = matrix.block[k].squaredNorm();
      joined[node] = of_node[other];
    });
  }
  of_node = std::move(joined);
  return result;
}

Motions<3> rigid_motions(const std::vector<Vec3>& places) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& x : places) middle += x / static_cast<double>(places.size());
  Motions<3> motions(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec3 x = places[i] - middle;
    motions[i].leftCols<3>().setIdentity();
    motions[i].rightCols<3>() << 0, x.z(), -x.y(), -x.z(), 0, x.x(), x.y(), -x.x(), 0;
  }
  return motions;
}

template <int B>
BlockRows<B, 6> tentative_prolongation(const Aggregates& aggregates, const Motions<B>& motions,
                                       Motions<6>& coarse_motions) {
  const auto num_nodes = static_cast<Index>(motions.size());
  // The nodes of each aggregate.
  std::vector<Index> start(aggregates.count + 2, 0);
  for (Index a : aggregates.of_node) ++start[a + 2];
  for (Index a = 0; a < aggregates.count; ++a) start[a + 2] += start[a + 1];
  std::vector<Index> member(num_nodes);
  for (Index node = 0; node < num_nodes; ++node) {
    member[start[aggregates.of_node[node] + 1]++] = node;
  }
  BlockRows<B, 6> result;
  result.num_columns = aggregates.count;
  result.column = aggregates.of_node;
  result.block.resize(num_nodes);
  result.start.resize(num_nodes + 1);
  for (Index node = 0; node <= num_nodes; ++node) result.start[node] = node;
  coarse_motions.resize(aggregates.count);
  Eigen::Matrix<double, Eigen::Dynamic, 6> local;
  for (Index a = 0; a < aggregates.count; ++a) {
    const Index count = start[a + 1] - start[a];
    local.resize(Eigen::Index{B} * count, 6);
    for (Index i = 0; i < count; ++i) {
      local.template middleRows<B>(B * i) = motions[member[start[a] + i]];
    }
    // The Gram-Schmidt method, done twice, is stable.
    Block<6, 6>& r = coarse_motions[a];
    r.setZero();
    for (int c = 0; c < 6; ++c) {
      const double before = local.col(c).norm();
      for (int round = 0; round < 2; ++round) {
        for (int k = 0; k < c; ++k) {
          const double share = local.col(k).dot(local.col(c));
          r(k, c) += share;
          local.col(c) -= share * local.col(k);
        }
      }
      const double left = local.col(c).norm();
      if (left > kDependentMotion * before) {
        r(c, c) = left;
        local.col(c) /= left;
      } else {
        local.col(c).setZero();
      }
    }
    for (Index i = 0; i < count; ++i) {
      result.block[member[start[a] + i]] = local.template middleRows<B>(B * i);
    }
  }
  return result;
}

template <int B>
BlockRows<B, 6> smoothed_prolongation(const BlockRows<B, B>& matrix,
                                      const std::vector<Block<B, B>>& inverse_diagonal,
                                      double omega, const BlockRows<B, 6>& tentative) {
  return make_rows<BlockRows<B, 6>>(
      matrix.num_rows(), tentative.num_columns,
      [&](Index node, RowSums<Block<B, 6>>& sums, BlockRows<B, 6>& rows) {
        for (Index k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
          const Index other = matrix.column[k];
          sums.at(tentative.column[other]).noalias() -= matrix.block[k] * tentative.block[other];
        }
        const std::size_t first = rows.block.size();
        const Index own = tentative.column[node];
        (void)sums.at(own);
        sums.finish(rows);
        for (std::size_t k = first; k < rows.block.size(); ++k) {
          rows.block[k] = omega * inverse_diagonal[node] * rows.block[k];
          if (rows.column[k] == own) rows.block[k] += tentative.block[node];
        }
      });
}

template <int B>
BlockRows<6, 6> coarse_matrix(const BlockRows<B, B>& matrix, const BlockRows<B, 6>& prolongation) {
  const auto product = make_rows<BlockRows<B, 6>>(  // AP
      matrix.num_rows(), prolongation.num_columns,
      [&](Index node, RowSums<Block<B, 6>>& sums, BlockRows<B, 6>& rows) {
        for (Index k = matrix.start[node]; k < matrix.start[node + 1]; ++k) {
          const Index other = matrix.column[k];
          for (Index i = prolongation.start[other]; i < prolongation.start[other + 1]; ++i) {
            sums.at(prolongation.column[i]).noalias() += matrix.block[k] * prolongation.block[i];
          }
        }
        sums.finish(rows);
      });
  const ByColumn columns =
      by_column(prolongation.num_columns, prolongation.start, prolongation.column);
  return make_rows<BlockRows<6, 6>>(
      prolongation.num_columns, prolongation.num_columns,
      [&](Index aggregate, RowSums<Block<6, 6>>& sums, BlockRows<6, 6>& rows) {
        for (Index e = columns.start[aggregate]; e < columns.start[aggregate + 1]; ++e) {
          const Index node = columns.row[e];
          const auto transposed = prolongation.block[columns.place[e]].transpose();
          for (Index i = product.start[node]; i < product.start[node + 1]; ++i) {
            sums.at(product.column[i]).noalias() += transposed * product.block[i];
          }
        }
        Block<6, 6>& diagonal = sums.at(aggregate);
        const double largest = diagonal.diagonal().cwiseAbs().maxCoeff();
        for (int c = 0; c < 6; ++c) {
          if (diagonal(c, c) == 0) diagonal(c, c) = largest > 0 ? largest : 1;
        }
        sums.finish(rows);
      });
}

template Aggregates aggregate(const BlockRows<3, 3>&, double);
template Aggregates aggregate(const BlockRows<6, 6>&, double);
template BlockRows<3, 6> tentative_prolongation(const Aggregates&, const Motions<3>&, Motions<6>&);
template BlockRows<6, 6> tentative_prolongation(const Aggregates&, const Motions<6>&, Motions<6>&);
template BlockRows<3, 6> smoothed_prolongation(const BlockRows<3, 3>&,
                                               const std::vector<Block<3, 3>>&, double,
                                               const BlockRows<3, 6>&);
template BlockRows<6, 6> smoothed_prolongation(const BlockRows<6, 6>&,
                                               const std::vector<Block<6, 6>>&, double,
                                               const BlockRows<6, 6>&);
template BlockRows<6, 6> coarse_matrix(const BlockRows<3, 3>&, const BlockRows<3, 6>&);
template BlockRows<6, 6> coarse_matrix(const BlockRows<6, 6>&, const BlockRows<6, 6>&);

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// The parts of smoothed aggregation (Vaněk, Mandel & Brezina, Algebraic multigrid by smoothed
// aggregation for second and fourth order elliptic problems, Computing 56, 1996). Nodes that are
// strongly coupled form an aggregate, which moves as a rigid body. The piecewise rigid motions are
// smoothed once by the matrix.
//
// A node has B components: three displacements on the finest level, and on the other levels the six
// motions of an aggregate.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "iterative/block_pattern.h"

namespace palpate {

/// Rows × columns of a block.
template <int R, int C>
using Block = Eigen::Matrix<double, R, C>;

/// A sparse matrix of blocks, row by row, columns ascending.
template <int R, int C>
struct BlockRows {
  Index num_columns = 0;
  std::vector<Index> start{0};
  std::vector<Index> column;
  std::vector<Block<R, C>> block;

  [[nodiscard]] Index num_rows() const { return static_cast<Index>(start.size()) - 1; }
};

/// The blocks of a sparse matrix column by column, rows ascending.
struct ByColumn {
  /// Where each column begins [num_columns + 1].
  std::vector<Index> start;
  /// The row of each block, and its index in the order by rows.
  std::vector<Index> row;
  std::vector<Index> place;
};

/// @param start, column Those of a BlockRows.
[[nodiscard]] ByColumn by_column(Index num_columns, const std::vector<Index>& start,
                                 const std::vector<Index>& column);

/// All blocks of a matrix of which the lower triangle is stored.
[[nodiscard]] BlockRows<3, 3> all_blocks(const BlockPattern& pattern,
                                         const Neighbourhoods& neighbours,
                                         const std::vector<double>& values);

struct Aggregates {
  Index count = 0;
  /// [num_nodes]
  std::vector<Index> of_node;
};

/// Each aggregate is a node and the neighbours to which it is strongly coupled: |A_ij| > threshold
/// √(|A_ii| |A_jj|), in Frobenius's norm. Nodes between such neighbourhoods join one of them.
template <int B>
[[nodiscard]] Aggregates aggregate(const BlockRows<B, B>& matrix, double threshold);

/// The displacement of each node in the six rigid motions of the body.
template <int B>
using Motions = std::vector<Block<B, 6>>;

/// The rigid motions at these places, m: translations, and rotations about their centre.
[[nodiscard]] Motions<3> rigid_motions(const std::vector<Vec3>& places);

/// The motions of each aggregate, orthonormal: P₀ with P₀ᵀP₀ = I. A motion that an aggregate lacks,
/// such as a rotation of a single node, is zero in it.
/// @param coarse_motions Set to the motions of the aggregates: P₀ times them are the motions.
template <int B>
[[nodiscard]] BlockRows<B, 6> tentative_prolongation(const Aggregates& aggregates,
                                                     const Motions<B>& motions,
                                                     Motions<6>& coarse_motions);

/// (I − ω D⁻¹ A) P₀.
/// @param inverse_diagonal D⁻¹ [num_nodes].
template <int B>
[[nodiscard]] BlockRows<B, 6> smoothed_prolongation(
    const BlockRows<B, B>& matrix, const std::vector<Block<B, B>>& inverse_diagonal, double omega,
    const BlockRows<B, 6>& tentative);

/// PᵀAP. A motion that an aggregate lacks gets a stiffness, so that it stays zero.
template <int B>
[[nodiscard]] BlockRows<6, 6> coarse_matrix(const BlockRows<B, B>& matrix,
                                            const BlockRows<B, 6>& prolongation);

}  // namespace palpate

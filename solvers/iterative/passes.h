// SPDX-License-Identifier: BSD-3-Clause
// The innermost loops: passes over a matrix of blocks, and over vectors (node_vectors.h). They are
// compiled for AVX2 too, and the processor decides at run time. None of them allocates memory.
//
// A pass over the lower triangle reads each block once and uses it twice. When it reaches a node,
// the contributions of all earlier nodes have been added, so that the row of this node is complete,
// and no later node reads the vector there. So what follows for the row, such as a step of a
// smoother, is done in the same pass and in place. Passes over a large matrix are divided into
// parts (triangle_parts.h), as passes over vectors are, and the parts run in parallel
// (base/parallel.h).
#pragma once

#include <cstddef>

#include "iterative/block_pattern.h"
#include "iterative/children.h"

namespace palpate {

/// A matrix whose values, of type T, are laid out as block_pattern.h says.
template <class T>
struct BlockMatrixView {
  const BlockPattern* pattern;
  const T* values;
};

// In the following, vectors have `columns` = 1 or 3 columns, and `sums` is work space of
// pattern->num_sums() nodes that is zero before and after.

/// y = A x.
template <class T>
void multiply(const BlockMatrixView<T>& a, int columns, const T* x, T* sums, T* y);

/// y = b − A x. y may be b.
template <class T>
void residual(const BlockMatrixView<T>& a, int columns, const T* b, const T* x, T* sums, T* y);

/// d ← momentum d + step D⁻¹ (b − A x), x ← x + d.
/// @param inverse_diagonal The columns of D⁻¹, each followed by a zero [num_nodes × 12].
struct ChebyshevStep {
  float momentum;
  float step;
};
void chebyshev_step(const BlockMatrixView<float>& a, const float* inverse_diagonal, int columns,
                    ChebyshevStep coefficients, const float* b, float* sums, float* x, float* d);

/// x = d = step D⁻¹ b: the first step, from x = 0.
void chebyshev_start(Index num_nodes, const float* inverse_diagonal, int columns, float step,
                     const float* b, float* x, float* d);

/// fine += P coarse, with the weight ½ or 1 for each parent [num_nodes].
void prolong(const std::vector<std::array<Index, 2>>& parents, int columns, const float* coarse,
             float* fine);
/// coarse = Pᵀ fine.
void restrict_to(const Children& children, int columns, const float* fine, float* coarse);

/// The scalar product of each column [columns].
void dot(Index num_nodes, int columns, const double* a, const double* b, double* products);
/// For vectors of three columns, the scalar products of each column of a with each of b [3 × 3],
/// row by row.
void gram(Index num_nodes, const double* a, const double* b, double* products);
/// y ← y + factor x, column by column.
void add(Index num_nodes, int columns, const double* factors, const double* x, double* y);
/// y ← x + factor y, column by column.
void scale_and_add(Index num_nodes, int columns, const double* factors, const double* x, double* y);
/// y = factor x, column by column, with a conversion of the precision.
void convert(Index num_nodes, int columns, const double* factors, const double* x, float* y);
void convert(Index num_nodes, int columns, const double* factors, const float* x, double* y);

// The following is for matrices of 6 × 6 blocks; their vectors have 6 components and two zeros for
// each node and column.

/// All blocks, row by row, each by columns. Two more numbers follow at the end.
struct SixBlockView {
  Index num_nodes;
  const Index* start;
  const Index* column;
  const float* values;
};

/// y = b − A x.
void residual(const SixBlockView& a, int columns, const float* b, const float* x, float* y);
/// d ← momentum d + step D⁻¹ r, x ← x + d.
/// @param inverse_diagonal [num_nodes × 36], and two more numbers.
void chebyshev_update(Index num_nodes, const float* inverse_diagonal, int columns,
                      ChebyshevStep coefficients, const float* r, float* x, float* d);

/// The prolongation of an aggregation, row by row. Its blocks have as many rows as a node of the
/// finer level has components, 3 or 6, and 6 columns; they are stored by columns. Two more numbers
/// follow at the end.
struct AggregationView {
  int rows;
  Index num_nodes;
  const Index* start;
  const Index* column;
  const float* values;
  /// Pᵀ, by the columns of P: where each column begins, its rows ascending, and the transposed
  /// blocks, which are stored by columns of 6. Two more numbers follow at the end.
  Index num_columns;
  const Index* column_start;
  const Index* row;
  const float* transposed;
};

/// fine += P coarse.
void prolong(const AggregationView& p, int columns, const float* coarse, float* fine);
/// coarse = Pᵀ fine.
void restrict_to(const AggregationView& p, int columns, const float* fine, float* coarse);

}  // namespace palpate

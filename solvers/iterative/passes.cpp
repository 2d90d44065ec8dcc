// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/passes.h"

#include <algorithm>
#include <array>

#include "base/parallel.h"
#include "base/simd.h"

namespace palpate {
namespace {

// Each pass is an object with an inlined operator(), which is compiled for each instruction set.

template <class Pass>
void run_baseline(const Pass& pass) {
  pass();
}

#ifdef PALPATE_X86_SIMD
template <class Pass>
[[gnu::target("avx2,fma")]] void run_avx2(const Pass& pass) {
  pass();
}
#endif

template <class Pass>
void run(const Pass& pass) {
#ifdef PALPATE_X86_SIMD
  static const bool has_avx2 = best_instruction_set() != InstructionSet::baseline;
  if (has_avx2) return run_avx2(pass);
#endif
  run_baseline(pass);
}

/// Calls f with the number of columns as a constant.
template <class F>
void with_columns(int columns, F&& f) {
  columns == 1 ? f(std::integral_constant<int, 1>()) : f(std::integral_constant<int, 3>());
}

template <class T>
struct LanesOf;
template <>
struct LanesOf<float> {
  using type = FourFloats;
};
template <>
struct LanesOf<double> {
  using type = Four;
};
/// A vector of the numbers of a node.
template <class T>
using Lanes = typename LanesOf<T>::type;

template <class V, class T>
[[gnu::always_inline]] inline V loaded(const T* from) {
  V v;
  load(from, v);
  return v;
}

/// What is done with a row of the product. fetch() prefetches the data that this needs.
template <class T>
struct Store {
  T* y;
  [[gnu::always_inline]] void fetch(std::size_t at, Index) const { __builtin_prefetch(y + at, 1); }
  [[gnu::always_inline]] void operator()(std::size_t at, Index, Lanes<T> row) const {
    store(row, y + at);
  }
};

template <class T>
struct StoreResidual {
  const T* b;
  T* y;
  [[gnu::always_inline]] void fetch(std::size_t at, Index) const {
    __builtin_prefetch(b + at);
    __builtin_prefetch(y + at, 1);
  }
  [[gnu::always_inline]] void operator()(std::size_t at, Index, Lanes<T> row) const {
    const auto r = loaded<Lanes<T>>(b + at) - row;
    store(r, y + at);
  }
};

/// D⁻¹ r.
[[gnu::always_inline]] inline FourFloats times_inverse(const float* inverse, FourFloats r) {
  return loaded<FourFloats>(inverse) * r[0] + loaded<FourFloats>(inverse + 4) * r[1] +
         loaded<FourFloats>(inverse + 8) * r[2];
}

struct StepAlong {
  const float* inverse_diagonal;
  const float* b;
  ChebyshevStep coefficients;
  float* x;
  float* d;
  [[gnu::always_inline]] void fetch(std::size_t at, Index node) const {
    __builtin_prefetch(inverse_diagonal + std::size_t{12} * node);
    __builtin_prefetch(inverse_diagonal + std::size_t{12} * node + 8);
    __builtin_prefetch(b + at);
    __builtin_prefetch(x + at, 1);
    __builtin_prefetch(d + at, 1);
  }
  [[gnu::always_inline]] void operator()(std::size_t at, Index node, FourFloats row) const {
    const FourFloats r = loaded<FourFloats>(b + at) - row;
    FourFloats step = coefficients.momentum * loaded<FourFloats>(d + at);
    step += coefficients.step * times_inverse(inverse_diagonal + std::size_t{12} * node, r);
    store(step, d + at);
    const FourFloats moved = loaded<FourFloats>(x + at) + step;
    store(moved, x + at);
  }
};

/// The least number of aggregates in a part: each has thirty blocks of 36 values.
constexpr Index kAggregatesOfPart = 128;

/// The distance between the values that are used and those that are prefetched, some six nodes.
/// Without prefetching a pass takes twice the time.
constexpr int kAhead = 800;

/// A pass over a part of the lower triangle (triangle_parts.h), or over all of it. A load takes the
/// three values of a column of a block and the next value of the matrix, which exists, since the
/// last node has no blocks. The fourth lane is multiplied by the zero of a vector, or is discarded.
template <class T, int N, bool IsWhole, class Finish>
struct TrianglePass {
  const BlockPattern& pattern;
  Index part;
  const T* values;
  const T* x;
  T* sums;
  Finish finish;

  [[gnu::always_inline]] void operator()() const {
    using V = Lanes<T>;
    const Index* start = pattern.start.data();
    const Index* neighbour = pattern.neighbour.data();
    const char* is_late = pattern.parts.is_late.data();
    const Index* sum_of_crossing =
        IsWhole ? nullptr : pattern.parts.sum.data() + pattern.parts.first_sum[part];
    const Index first_node = pattern.parts.nodes.first(part);
    const Index last_node = pattern.parts.nodes.first(part + 1);
    const T* value = values + pattern.first_value(first_node);
    // Local copies: the compiler cannot know that stores do not change the members.
    const T* const from_x = x;
    T* const to_sums = sums;
    for (Index node = first_node; node < last_node; ++node) {
      const Index m = start[node + 1] - start[node];
      const std::size_t at = std::size_t{4 * N} * node;
      const T* v0 = value;
      const T* v1 = v0 + 3 + 3 * m;
      const T* v2 = v1 + 2 + 3 * m;
      value = v2 + 1 + 3 * m;
      const V d0{v0[0], v0[1], v0[2], 0};
      const V d1{v0[1], v1[0], v1[1], 0};
      const V d2{v0[2], v1[1], v2[0], 0};
      v0 += 3;
      v1 += 2;
      v2 += 1;
      V own[N][3] = {};
      V row[N] = {};
      V p0[N] = {};
      V p1[N] = {};
      V p2[N] = {};
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const T* from = from_x + at + 4 * n;
        for (int i = 0; i < 3; ++i) own[n][i] += from[i];
        row[n] = loaded<V>(to_sums + at + 4 * n) + d0 * own[n][0] + d1 * own[n][1] + d2 * own[n][2];
        store(V{}, to_sums + at + 4 * n);
      }
      const Index* other = neighbour + start[node];
      const auto pass_blocks = [&](const Index* sum_of) __attribute__((always_inline)) {
        for (Index k = 0; k < m; ++k) {
          __builtin_prefetch(value + 9 * k + kAhead);
          const V b0 = loaded<V>(v0 + 3 * k);
          const V b1 = loaded<V>(v1 + 3 * k);
          const V b2 = loaded<V>(v2 + 3 * k);
          const std::size_t to = std::size_t{4 * N} * other[k];
          const std::size_t to_sum = std::size_t{4 * N} * sum_of[k];
#pragma GCC unroll 3
          for (int n = 0; n < N; ++n) {
            const V theirs = loaded<V>(from_x + to + 4 * n);
            p0[n] += b0 * theirs;
            p1[n] += b1 * theirs;
            p2[n] += b2 * theirs;
            V sum = loaded<V>(to_sums + to_sum + 4 * n);
            sum += b0 * own[n][0] + b1 * own[n][1] + b2 * own[n][2];
            store(sum, to_sums + to_sum + 4 * n);
          }
        }
      };
      // The loop is written for two cases, so that for most nodes neighbours and sums have the same
      // index.
      if (!IsWhole && m > 0 && other[m - 1] >= last_node) {
        pass_blocks(sum_of_crossing);
        sum_of_crossing += m;
      } else {
        pass_blocks(other);
      }
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const V across{p0[n][0] + p0[n][1] + p0[n][2], p1[n][0] + p1[n][1] + p1[n][2],
                       p2[n][0] + p2[n][1] + p2[n][2], 0};
        V complete = row[n] + across;
        complete[3] = 0;
        if (!IsWhole && is_late[node] != 0) {
          store(complete, to_sums + at + 4 * n);
        } else {
          finish(at + 4 * n, node, complete);
        }
      }
    }
  }
};

/// The distance between the late nodes that are completed and those that are prefetched.
constexpr Index kLateAhead = 12;

/// Completes the rows of the late nodes of a part.
template <class T, int N, class Finish>
struct LatePass {
  const TriangleParts& parts;
  Index part;
  T* sums;
  Finish finish;

  [[gnu::always_inline]] void operator()() const {
    using V = Lanes<T>;
    const auto take = [](T * from) __attribute__((always_inline)) {
      const V sum = loaded<V>(from);
      store(V{}, from);
      return sum;
    };
    const Index last_late = parts.first_late[part + 1];
    for (Index late = parts.first_late[part]; late < last_late; ++late) {
      const Index ahead = parts.late[std::min(late + kLateAhead, last_late - 1)];
      finish.fetch(std::size_t{4 * N} * ahead, ahead);
      __builtin_prefetch(sums + std::size_t{4 * N} * ahead, 1);
      const Index node = parts.late[late];
      const std::size_t at = std::size_t{4 * N} * node;
      for (int n = 0; n < N; ++n) {
        V complete = take(sums + at + 4 * n);
        for (Index i = parts.first_arriving[late]; i < parts.first_arriving[late + 1]; ++i) {
          complete += take(sums + std::size_t{4 * N} * parts.arriving[i] + 4 * n);
        }
        finish(at + 4 * n, node, complete);
      }
    }
  }
};

template <class T, class Finish>
void run_triangle(const BlockMatrixView<T>& a, int columns, const T* x, T* sums,
                  const Finish& finish) {
  const TriangleParts& parts = a.pattern->parts;
  const Index num_parts = parts.nodes.num_parts();
  with_columns(columns, [&](auto n) {
    if (num_parts == 1) {
      return run(TrianglePass<T, n(), true, Finish>{*a.pattern, 0, a.values, x, sums, finish});
    }
    for_each_part(num_parts, [&](Index part) {
      run(TrianglePass<T, n(), false, Finish>{*a.pattern, part, a.values, x, sums, finish});
    });
    for_each_part(num_parts, [&](Index part) {
      run(LatePass<T, n(), Finish>{parts, part, sums, finish});
    });
  });
}

template <int N>
struct StartPass {
  Index first;
  Index last;
  const float* inverse_diagonal;
  float step;
  const float* b;
  float* x;
  float* d;
  [[gnu::always_inline]] void operator()() const {
    for (Index node = first; node < last; ++node) {
      for (int n = 0; n < N; ++n) {
        const std::size_t at = 4 * (std::size_t{N} * node + n);
        const FourFloats moved = step * times_inverse(inverse_diagonal + std::size_t{12} * node,
                                                      loaded<FourFloats>(b + at));
        store(moved, x + at);
        store(moved, d + at);
      }
    }
  }
};

/// Calls f(node, parent, weight) for each parent of the nodes of a range.
template <class F>
[[gnu::always_inline]] inline void for_parents(const std::vector<std::array<Index, 2>>& parents,
                                               Index first, Index last, F&& f) {
  for (Index node = first; node < last; ++node) {
    const auto [a, b] = parents[node];
    if (a == b && a >= 0) {
      f(node, a, 1.0F);
      continue;
    }
    if (a >= 0) f(node, a, 0.5F);
    if (b >= 0) f(node, b, 0.5F);
  }
}

/// y ← f(factor, x, y), one node after the other.
template <int N, class X, class Y, class F>
struct VectorPass {
  Index first;
  Index last;
  const double* factors;
  const X* x;
  Y* y;
  F f;
  [[gnu::always_inline]] void operator()() const {
    for (Index node = first; node < last; ++node) {
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const std::size_t at = 4 * (std::size_t{N} * node + n);
        const Four from = __builtin_convertvector(loaded<Lanes<X>>(x + at), Four);
        const Four to = __builtin_convertvector(loaded<Lanes<Y>>(y + at), Four);
        const Four changed = f(factors[n], from, to);
        store(__builtin_convertvector(changed, Lanes<Y>), y + at);
      }
    }
  }
};

template <class X, class Y, class F>
void run_over_vectors(Index num_nodes, int columns, const double* factors, const X* x, Y* y,
                      const F& f) {
  with_columns(columns, [&](auto n) {
    for_each_range({num_nodes, kNodesOfPart}, [&](Index first, Index last) {
      run(VectorPass<n(), X, Y, F>{first, last, factors, x, y, f});
    });
  });
}

struct Add {
  [[gnu::always_inline]] Four operator()(double factor, Four x, Four y) const {
    return y + factor * x;
  }
};
struct ScaleAndAdd {
  [[gnu::always_inline]] Four operator()(double factor, Four x, Four y) const {
    return x + factor * y;
  }
};
struct Scale {
  [[gnu::always_inline]] Four operator()(double factor, Four x, Four) const { return factor * x; }
};

template <int N>
struct DotPass {
  Index first;
  Index last;
  const double* a;
  const double* b;
  double* products;
  [[gnu::always_inline]] void operator()() const {
    Four sums[N] = {};
    for (Index node = first; node < last; ++node) {
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const std::size_t at = 4 * (std::size_t{N} * node + n);
        sums[n] += loaded<Four>(a + at) * loaded<Four>(b + at);
      }
    }
    for (int n = 0; n < N; ++n) products[n] = sums[n][0] + sums[n][1] + sums[n][2];
  }
};

struct GramPass {
  Index first;
  Index last;
  const double* a;
  const double* b;
  double* products;
  [[gnu::always_inline]] void operator()() const {
    Four sums[3][3] = {};
    for (Index node = first; node < last; ++node) {
      const std::size_t at = std::size_t{12} * node;
#pragma GCC unroll 3
      for (int i = 0; i < 3; ++i) {
        const Four of_a = loaded<Four>(a + at + 4 * i);
#pragma GCC unroll 3
        for (int j = 0; j < 3; ++j) sums[i][j] += of_a * loaded<Four>(b + at + 4 * j);
      }
    }
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        products[3 * i + j] = sums[i][j][0] + sums[i][j][1] + sums[i][j][2];
      }
    }
  }
};

/// Sums the results of `find(first, last, numbers)` over the ranges of a sequence, in their order.
template <std::size_t Size, class Find>
std::array<double, Size> sum_over_ranges(Index count, Find&& find) {
  const Ranges ranges(count, kNodesOfPart);
  std::array<std::array<double, Size>, Ranges::kMostParts> of_part;
  for_each_part(ranges.num_parts(), [&](Index part) {
    find(ranges.first(part), ranges.first(part + 1), of_part[part].data());
  });
  std::array<double, Size> sums = of_part[0];
  for (Index part = 1; part < ranges.num_parts(); ++part) {
    for (std::size_t i = 0; i < Size; ++i) sums[i] += of_part[part][i];
  }
  return sums;
}

/// A pass over 6 × 6 blocks. Loads take two numbers too many, which are discarded.
template <int N>
struct SixBlockPass {
  SixBlockView a;
  Index first;
  Index last;
  const float* b;
  const float* x;
  float* y;
  [[gnu::always_inline]] void operator()() const {
    for (Index row = first; row < last; ++row) {
      EightFloats sums[N] = {};
      for (Index k = a.start[row]; k < a.start[row + 1]; ++k) {
        const float* block = a.values + std::size_t{36} * k;
        const float* from = x + std::size_t{8 * N} * a.column[k];
#pragma GCC unroll 6
        for (int c = 0; c < 6; ++c) {
          const auto column = loaded<EightFloats>(block + 6 * c);
#pragma GCC unroll 3
          for (int n = 0; n < N; ++n) sums[n] += column * from[8 * n + c];
        }
      }
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const std::size_t at = 8 * (std::size_t{N} * row + n);
        EightFloats r = loaded<EightFloats>(b + at) - sums[n];
        r[6] = r[7] = 0;
        store(r, y + at);
      }
    }
  }
};

template <int N>
struct SixUpdatePass {
  Index first;
  Index last;
  const float* inverse_diagonal;
  ChebyshevStep coefficients;
  const float* r;
  float* x;
  float* d;
  [[gnu::always_inline]] void operator()() const {
    for (Index node = first; node < last; ++node) {
      for (int n = 0; n < N; ++n) {
        const std::size_t at = 8 * (std::size_t{N} * node + n);
        EightFloats sum{};
#pragma GCC unroll 6
        for (int c = 0; c < 6; ++c) {
          sum += loaded<EightFloats>(inverse_diagonal + std::size_t{36} * node + 6 * c) * r[at + c];
        }
        EightFloats step =
            coefficients.momentum * loaded<EightFloats>(d + at) + coefficients.step * sum;
        step[6] = step[7] = 0;
        store(step, d + at);
        const EightFloats moved = loaded<EightFloats>(x + at) + step;
        store(moved, x + at);
      }
    }
  }
};

/// A vector type for the R components of a node.
template <int R>
using Components = std::conditional_t<R == 3, FourFloats, EightFloats>;
/// The number of values of a node in a vector, zeros included.
template <int R>
constexpr int kRoom = R == 3 ? 4 : 8;

template <int N, int R>
struct AggregationProlongPass {
  AggregationView p;
  Index first;
  Index last;
  const float* coarse;
  float* fine;
  [[gnu::always_inline]] void operator()() const {
    using V = Components<R>;
    for (Index row = first; row < last; ++row) {
      V sums[N] = {};
      for (Index k = p.start[row]; k < p.start[row + 1]; ++k) {
        const float* block = p.values + std::size_t{6 * R} * k;
        const float* from = coarse + std::size_t{8 * N} * p.column[k];
#pragma GCC unroll 6
        for (int c = 0; c < 6; ++c) {
          const auto column = loaded<V>(block + R * c);
#pragma GCC unroll 3
          for (int n = 0; n < N; ++n) sums[n] += column * from[8 * n + c];
        }
      }
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        float* to = fine + kRoom<R> * (std::size_t{N} * row + n);
        for (int i = R; i < kRoom<R>; ++i) sums[n][i] = 0;
        const V sum = loaded<V>(to) + sums[n];
        store(sum, to);
      }
    }
  }
};

template <int N, int R>
struct AggregationRestrictPass {
  AggregationView p;
  Index first;
  Index last;
  const float* fine;
  float* coarse;
  [[gnu::always_inline]] void operator()() const {
    for (Index column = first; column < last; ++column) {
      EightFloats sums[N] = {};
      for (Index k = p.column_start[column]; k < p.column_start[column + 1]; ++k) {
        const float* block = p.transposed + std::size_t{6 * R} * k;
        const float* from = fine + std::size_t{kRoom<R> * N} * p.row[k];
#pragma GCC unroll 6
        for (int i = 0; i < R; ++i) {
          const auto values = loaded<EightFloats>(block + 6 * i);
#pragma GCC unroll 3
          for (int n = 0; n < N; ++n) sums[n] += values * from[kRoom<R> * n + i];
        }
      }
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        sums[n][6] = sums[n][7] = 0;
        store(sums[n], coarse + 8 * (std::size_t{N} * column + n));
      }
    }
  }
};

/// Calls f with the numbers of columns and rows as constants.
template <class F>
void with_sizes(const AggregationView& p, int columns, F&& f) {
  with_columns(columns, [&](auto n) {
    p.rows == 3 ? f(n, std::integral_constant<int, 3>()) : f(n, std::integral_constant<int, 6>());
  });
}

}  // namespace

template <class T>
void multiply(const BlockMatrixView<T>& a, int columns, const T* x, T* sums, T* y) {
  run_triangle<T>(a, columns, x, sums, Store<T>{y});
}
template void multiply(const BlockMatrixView<float>&, int, const float*, float*, float*);
template void multiply(const BlockMatrixView<double>&, int, const double*, double*, double*);

template <class T>
void residual(const BlockMatrixView<T>& a, int columns, const T* b, const T* x, T* sums, T* y) {
  run_triangle<T>(a, columns, x, sums, StoreResidual<T>{b, y});
}
template void residual(const BlockMatrixView<float>&, int, const float*, const float*, float*,
                       float*);
template void residual(const BlockMatrixView<double>&, int, const double*, const double*, double*,
                       double*);

void chebyshev_step(const BlockMatrixView<float>& a, const float* inverse_diagonal, int columns,
                    ChebyshevStep coefficients, const float* b, float* sums, float* x, float* d) {
  run_triangle<float>(a, columns, x, sums, StepAlong{inverse_diagonal, b, coefficients, x, d});
}

void chebyshev_start(Index num_nodes, const float* inverse_diagonal, int columns, float step,
                     const float* b, float* x, float* d) {
  with_columns(columns, [&](auto n) {
    for_each_range({num_nodes, kNodesOfPart}, [&](Index first, Index last) {
      run(StartPass<n()>{first, last, inverse_diagonal, step, b, x, d});
    });
  });
}

void prolong(const std::vector<std::array<Index, 2>>& parents, int columns, const float* coarse,
             float* fine) {
  const std::size_t length = std::size_t{4} * columns;
  const Ranges ranges(static_cast<Index>(parents.size()), kNodesOfPart);
  for_each_range(ranges, [&](Index first, Index last) {
    for_parents(parents, first, last, [&](std::size_t node, Index parent, float weight) {
      for (std::size_t i = 0; i < length; ++i) {
        fine[length * node + i] += weight * coarse[length * parent + i];
      }
    });
  });
}

void restrict_to(const Children& children, int columns, const float* fine, float* coarse) {
  const std::size_t length = std::size_t{4} * columns;
  for_each_range({children.num_corners(), kNodesOfPart}, [&](Index first, Index last) {
    for (Index corner = first; corner < last; ++corner) {
      float* to = coarse + length * corner;
      std::fill(to, to + length, 0.0F);
      for (Index k = children.start[corner]; k < children.start[corner + 1]; ++k) {
        const float* from = fine + length * children.node[k];
        const float weight = children.node[k] == children.node_of_corner[corner] ? 1.0F : 0.5F;
        for (std::size_t i = 0; i < length; ++i) to[i] += weight * from[i];
      }
    }
  });
}

void dot(Index num_nodes, int columns, const double* a, const double* b, double* products) {
  with_columns(columns, [&](auto n) {
    const auto sums = sum_over_ranges<n()>(num_nodes, [&](Index first, Index last, double* of) {
      run(DotPass<n()>{first, last, a, b, of});
    });
    std::copy(sums.begin(), sums.end(), products);
  });
}

void gram(Index num_nodes, const double* a, const double* b, double* products) {
  const auto sums = sum_over_ranges<9>(num_nodes, [&](Index first, Index last, double* of) {
    run(GramPass{first, last, a, b, of});
  });
  std::copy(sums.begin(), sums.end(), products);
}

void add(Index num_nodes, int columns, const double* factors, const double* x, double* y) {
  run_over_vectors(num_nodes, columns, factors, x, y, Add());
}

void scale_and_add(Index num_nodes, int columns, const double* factors, const double* x,
                   double* y) {
  run_over_vectors(num_nodes, columns, factors, x, y, ScaleAndAdd());
}

void convert(Index num_nodes, int columns, const double* factors, const double* x, float* y) {
  run_over_vectors(num_nodes, columns, factors, x, y, Scale());
}

void convert(Index num_nodes, int columns, const double* factors, const float* x, double* y) {
  run_over_vectors(num_nodes, columns, factors, x, y, Scale());
}

void residual(const SixBlockView& a, int columns, const float* b, const float* x, float* y) {
  with_columns(columns, [&](auto n) {
    for_each_range({a.num_nodes, kAggregatesOfPart}, [&](Index first, Index last) {
      run(SixBlockPass<n()>{a, first, last, b, x, y});
    });
  });
}

void chebyshev_update(Index num_nodes, const float* inverse_diagonal, int columns,
                      ChebyshevStep coefficients, const float* r, float* x, float* d) {
  with_columns(columns, [&](auto n) {
    for_each_range({num_nodes, kAggregatesOfPart}, [&](Index first, Index last) {
      run(SixUpdatePass<n()>{first, last, inverse_diagonal, coefficients, r, x, d});
    });
  });
}

void prolong(const AggregationView& p, int columns, const float* coarse, float* fine) {
  with_sizes(p, columns, [&](auto n, auto r) {
    const Index least = r() == 3 ? kNodesOfPart : kAggregatesOfPart;
    for_each_range({p.num_nodes, least}, [&](Index first, Index last) {
      run(AggregationProlongPass<n(), r()>{p, first, last, coarse, fine});
    });
  });
}

void restrict_to(const AggregationView& p, int columns, const float* fine, float* coarse) {
  with_sizes(p, columns, [&](auto n, auto r) {
    for_each_range({p.num_columns, kAggregatesOfPart}, [&](Index first, Index last) {
      run(AggregationRestrictPass<n(), r()>{p, first, last, fine, coarse});
    });
  });
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/passes.h"

#include "base/simd.h"

namespace palpate {
namespace {

// Each pass is an object with one inlined operator(), which is compiled for each instruction set.

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
/// A node.
template <class T>
using Lanes = typename LanesOf<T>::type;

template <class V, class T>
[[gnu::always_inline]] inline V loaded(const T* from) {
  V v;
  load(from, v);
  return v;
}

/// What a row of the product becomes.
template <class T>
struct Store {
  T* y;
  [[gnu::always_inline]] void operator()(std::size_t at, Index, Lanes<T> row) const {
    store(row, y + at);
  }
};

template <class T>
struct StoreResidual {
  const T* b;
  T* y;
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
  [[gnu::always_inline]] void operator()(std::size_t at, Index node, FourFloats row) const {
    const FourFloats r = loaded<FourFloats>(b + at) - row;
    FourFloats step = coefficients.momentum * loaded<FourFloats>(d + at);
    step += coefficients.step * times_inverse(inverse_diagonal + std::size_t{12} * node, r);
    store(step, d + at);
    const FourFloats moved = loaded<FourFloats>(x + at) + step;
    store(moved, x + at);
  }
};

/// Values between those that are used and those that are fetched meanwhile, some six nodes: without
/// that, a pass takes twice the time.
constexpr int kAhead = 800;

/// A pass over the lower triangle. A load takes the three values of a column of a block and the one
/// behind them, which is another value of the matrix: the last node has no blocks. That lane meets
/// the zero of a vector, or is thrown away.
template <class T, int N, class Finish>
struct TrianglePass {
  const BlockPattern& pattern;
  const T* values;
  const T* x;
  T* sums;
  Finish finish;

  [[gnu::always_inline]] void operator()() const {
    using V = Lanes<T>;
    const Index* start = pattern.start.data();
    const Index* neighbour = pattern.neighbour.data();
    const Index num_nodes = pattern.num_nodes;
    const T* value = values;
    // What is stored may not be these, as far as the compiler knows.
    const T* const from_x = x;
    T* const to_sums = sums;
    for (Index node = 0; node < num_nodes; ++node) {
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
      for (Index k = 0; k < m; ++k) {
        __builtin_prefetch(value + 9 * k + kAhead);
        const V b0 = loaded<V>(v0 + 3 * k);
        const V b1 = loaded<V>(v1 + 3 * k);
        const V b2 = loaded<V>(v2 + 3 * k);
        const std::size_t to = std::size_t{4 * N} * other[k];
#pragma GCC unroll 3
        for (int n = 0; n < N; ++n) {
          const V theirs = loaded<V>(from_x + to + 4 * n);
          p0[n] += b0 * theirs;
          p1[n] += b1 * theirs;
          p2[n] += b2 * theirs;
          V sum = loaded<V>(to_sums + to + 4 * n);
          sum += b0 * own[n][0] + b1 * own[n][1] + b2 * own[n][2];
          store(sum, to_sums + to + 4 * n);
        }
      }
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const V across{p0[n][0] + p0[n][1] + p0[n][2], p1[n][0] + p1[n][1] + p1[n][2],
                       p2[n][0] + p2[n][1] + p2[n][2], 0};
        V complete = row[n] + across;
        complete[3] = 0;
        finish(at + 4 * n, node, complete);
      }
    }
  }
};

template <class T, class Finish>
void run_triangle(const BlockMatrixView<T>& a, int columns, const T* x, T* sums,
                  const Finish& finish) {
  with_columns(columns, [&](auto n) {
    run(TrianglePass<T, n(), Finish>{*a.pattern, a.values, x, sums, finish});
  });
}

template <int N>
struct StartPass {
  Index num_nodes;
  const float* inverse_diagonal;
  float step;
  const float* b;
  float* x;
  float* d;
  [[gnu::always_inline]] void operator()() const {
    for (Index node = 0; node < num_nodes; ++node) {
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

/// Calls f(node, parent, weight) for each parent.
template <class F>
[[gnu::always_inline]] inline void for_parents(const std::vector<std::array<Index, 2>>& parents,
                                               F&& f) {
  for (std::size_t node = 0; node < parents.size(); ++node) {
    const auto [a, b] = parents[node];
    if (a == b && a >= 0) {
      f(node, a, 1.0F);
      continue;
    }
    if (a >= 0) f(node, a, 0.5F);
    if (b >= 0) f(node, b, 0.5F);
  }
}

/// y ← x, y or both, one node after the other.
template <int N, class X, class Y, class F>
struct VectorPass {
  Index num_nodes;
  const double* factors;
  const X* x;
  Y* y;
  F f;
  [[gnu::always_inline]] void operator()() const {
    for (Index node = 0; node < num_nodes; ++node) {
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
    run(VectorPass<n(), X, Y, F>{num_nodes, factors, x, y, f});
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
  Index num_nodes;
  const double* a;
  const double* b;
  double* products;
  [[gnu::always_inline]] void operator()() const {
    Four sums[N] = {};
    for (Index node = 0; node < num_nodes; ++node) {
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) {
        const std::size_t at = 4 * (std::size_t{N} * node + n);
        sums[n] += loaded<Four>(a + at) * loaded<Four>(b + at);
      }
    }
    for (int n = 0; n < N; ++n) products[n] = sums[n][0] + sums[n][1] + sums[n][2];
  }
};

/// Of 6 × 6 blocks. Loads take two numbers too many, which are thrown away.
template <int N>
struct SixBlockPass {
  SixBlockView a;
  const float* b;
  const float* x;
  float* y;
  [[gnu::always_inline]] void operator()() const {
    for (Index row = 0; row < a.num_nodes; ++row) {
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
  Index num_nodes;
  const float* inverse_diagonal;
  ChebyshevStep coefficients;
  const float* r;
  float* x;
  float* d;
  [[gnu::always_inline]] void operator()() const {
    for (Index node = 0; node < num_nodes; ++node) {
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

/// R components of a node in a vector.
template <int R>
using Components = std::conditional_t<R == 3, FourFloats, EightFloats>;
/// They and their zeros.
template <int R>
constexpr int kRoom = R == 3 ? 4 : 8;

template <int N, int R>
struct AggregationProlongPass {
  AggregationView p;
  const float* coarse;
  float* fine;
  [[gnu::always_inline]] void operator()() const {
    using V = Components<R>;
    for (Index row = 0; row < p.num_nodes; ++row) {
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
  const float* fine;
  float* coarse;
  [[gnu::always_inline]] void operator()() const {
    using V = Components<R>;
    for (Index row = 0; row < p.num_nodes; ++row) {
      V own[N];
#pragma GCC unroll 3
      for (int n = 0; n < N; ++n) load(fine + kRoom<R> * (std::size_t{N} * row + n), own[n]);
      for (Index k = p.start[row]; k < p.start[row + 1]; ++k) {
        const float* block = p.values + std::size_t{6 * R} * k;
        float* to = coarse + std::size_t{8 * N} * p.column[k];
#pragma GCC unroll 6
        for (int c = 0; c < 6; ++c) {
          const auto column = loaded<V>(block + R * c);
#pragma GCC unroll 3
          for (int n = 0; n < N; ++n) {
            const V product = column * own[n];
            float sum = product[0];
            for (int i = 1; i < R; ++i) sum += product[i];
            to[8 * n + c] += sum;
          }
        }
      }
    }
  }
};

template <template <int, int> class Pass, class... Arguments>
void run_aggregation(const AggregationView& p, int columns, Arguments... arguments) {
  with_columns(columns, [&](auto n) {
    p.rows == 3 ? run(Pass<n(), 3>{p, arguments...}) : run(Pass<n(), 6>{p, arguments...});
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
    run(StartPass<n()>{num_nodes, inverse_diagonal, step, b, x, d});
  });
}

void prolong(const std::vector<std::array<Index, 2>>& parents, int columns, const float* coarse,
             float* fine) {
  const std::size_t length = std::size_t{4} * columns;
  for_parents(parents, [&](std::size_t node, Index parent, float weight) {
    for (std::size_t i = 0; i < length; ++i) {
      fine[length * node + i] += weight * coarse[length * parent + i];
    }
  });
}

void restrict_to(const std::vector<std::array<Index, 2>>& parents, int columns, const float* fine,
                 float* coarse) {
  const std::size_t length = std::size_t{4} * columns;
  for_parents(parents, [&](std::size_t node, Index parent, float weight) {
    for (std::size_t i = 0; i < length; ++i) {
      coarse[length * parent + i] += weight * fine[length * node + i];
    }
  });
}

void dot(Index num_nodes, int columns, const double* a, const double* b, double* products) {
  with_columns(columns, [&](auto n) { run(DotPass<n()>{num_nodes, a, b, products}); });
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
  with_columns(columns, [&](auto n) { run(SixBlockPass<n()>{a, b, x, y}); });
}

void chebyshev_update(Index num_nodes, const float* inverse_diagonal, int columns,
                      ChebyshevStep coefficients, const float* r, float* x, float* d) {
  with_columns(columns, [&](auto n) {
    run(SixUpdatePass<n()>{num_nodes, inverse_diagonal, coefficients, r, x, d});
  });
}

void prolong(const AggregationView& p, int columns, const float* coarse, float* fine) {
  run_aggregation<AggregationProlongPass>(p, columns, coarse, fine);
}

void restrict_to(const AggregationView& p, int columns, const float* fine, float* coarse) {
  run_aggregation<AggregationRestrictPass>(p, columns, fine, coarse);
}

}  // namespace palpate

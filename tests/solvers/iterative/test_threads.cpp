// SPDX-License-Identifier: BSD-3-Clause
// A body of several parts: what the passes give is right, and the same to the bit for any number of
// threads.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "base/parallel.h"
#include "iterative/conjugate_gradients.h"
#include "iterative/galerkin.h"
#include "iterative/lowest_eigenvalue.h"
#include "iterative/node_vectors.h"
#include "iterative/passes.h"
#include "solvers/iterative/tangents.h"
#include "threads/thread_team.h"

namespace {

/// So many allocations more, and one fails; negative: none does.
std::atomic<long> allocations_left{-1};

}  // namespace

[[gnu::noinline]] void* operator new(std::size_t size) {
  if (allocations_left >= 0 && allocations_left-- == 0) throw std::bad_alloc();
  if (void* memory = std::malloc(size)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}

namespace palpate::test::test_threads {
namespace {

/// Of a sum of some dozen terms of order one.
template <class T>
constexpr double kRounding = std::is_same_v<T, double> ? 1e-13 : 1e-5;

/// 8 820 free nodes.
const Tangent& large_tangent() {
  static const Tangent tangent = [] {
    Tangent made = tangent_of(block_scene(ElementOrder::quadratic, {10, 10, 10}));
    double largest = 0;
    for (double value : made.values) largest = std::max(largest, std::abs(value));
    for (double& value : made.values) value /= largest;
    return made;
  }();
  return tangent;
}

Eigen::MatrixXd random_columns(int count, std::uint64_t seed) {
  const Eigen::Index size = large_tangent().size();
  return Random(seed).vector(size * count, 1).reshaped(size, count);
}

template <class T>
NodeVectors<T> as_vectors(const Eigen::MatrixXd& columns) {
  NodeVectors<T> result;
  result.set_zero(static_cast<Index>(columns.rows() / 3), static_cast<int>(columns.cols()));
  result.assign(columns);
  return result;
}

template <class T>
Eigen::MatrixXd as_columns(const NodeVectors<T>& vectors) {
  Eigen::MatrixXd result(3 * vectors.num_nodes(), vectors.num_columns());
  vectors.copy_to(result);
  return result;
}

template <class T>
NodeVectors<T> room_for_sums(int columns) {
  NodeVectors<T> sums;
  sums.set_zero(large_tangent().pattern->num_sums(), columns);
  return sums;
}

/// K x, one value after the other.
Eigen::MatrixXd plain_product(const Tangent& tangent, const Eigen::MatrixXd& x) {
  Eigen::MatrixXd y = Eigen::MatrixXd::Zero(x.rows(), x.cols());
  const SymmetricPattern& pattern = tangent.scalars;
  for (Index c = 0; c < pattern.size; ++c) {
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      const Index r = pattern.row[i];
      y.row(r) += tangent.values[i] * x.row(c);
      if (r != c) y.row(c) += tangent.values[i] * x.row(r);
    }
  }
  return y;
}

/// Calls f() with 1, 2, 3 and 4 threads, and expects the same of all.
template <class F>
auto same_with_threads(F&& f) {
  const auto alone = f();
  for (const int threads : {2, 3, 4}) {
    const auto team = make_thread_team(threads);
    EXPECT_EQ(with_team(team.get(), f), alone) << threads << " threads";
  }
  return alone;
}

TEST(TriangleParts, EachNodeThatAnotherPartAddsToIsLate) {
  const BlockPattern& pattern = *large_tangent().pattern;
  const TriangleParts& parts = pattern.parts;
  ASSERT_GT(parts.nodes.num_parts(), 1);
  std::vector<int> part_of(pattern.num_nodes);
  for (Index part = 0; part < parts.nodes.num_parts(); ++part) {
    for (Index n = parts.nodes.first(part); n < parts.nodes.first(part + 1); ++n) part_of[n] = part;
  }
  std::vector<char> expected(pattern.num_nodes, 0);
  for (Index node = 0; node < pattern.num_nodes; ++node) {
    for (Index k = pattern.start[node]; k < pattern.start[node + 1]; ++k) {
      if (part_of[pattern.neighbour[k]] != part_of[node]) expected[pattern.neighbour[k]] = 1;
    }
  }
  EXPECT_EQ(parts.is_late, expected);
  EXPECT_EQ(static_cast<Index>(parts.late.size()),
            std::count(expected.begin(), expected.end(), char{1}));
  // Halves of a cube: a layer or two of each.
  EXPECT_LT(parts.late.size(), expected.size() / 4);
  std::vector<Index> rooms = parts.arriving;
  std::sort(rooms.begin(), rooms.end());
  for (Index i = 0; i < parts.num_rooms(); ++i) EXPECT_EQ(rooms[i], pattern.num_nodes + i);
}

template <class T>
class PassesOfParts : public testing::Test {
 protected:
  PassesOfParts()
      : values_(large_tangent().values.begin(), large_tangent().values.end()),
        pattern_(*large_tangent().pattern) {}
  [[nodiscard]] BlockMatrixView<T> view() const { return {&pattern_, values_.data()}; }

  std::vector<T> values_;
  const BlockPattern& pattern_;
};

using Numbers = testing::Types<float, double>;
TYPED_TEST_SUITE(PassesOfParts, Numbers);

TYPED_TEST(PassesOfParts, Products) {
  for (const int count : {1, 3}) {
    const Eigen::MatrixXd x = random_columns(count, 71);
    const Eigen::MatrixXd b = random_columns(count, 72);
    const auto vectors = as_vectors<TypeParam>(x);
    const Eigen::MatrixXd product = same_with_threads([&] {
      auto sums = room_for_sums<TypeParam>(count);
      auto y = as_vectors<TypeParam>(b);
      multiply(this->view(), count, vectors.data(), sums.data(), y.data());
      EXPECT_TRUE(as_columns(sums).isZero(0));
      return as_columns(y);
    });
    const Eigen::MatrixXd expected = plain_product(large_tangent(), x);
    EXPECT_LT((product - expected).norm(), kRounding<TypeParam> * expected.norm());
    const Eigen::MatrixXd rest = same_with_threads([&] {
      auto sums = room_for_sums<TypeParam>(count);
      auto r = as_vectors<TypeParam>(b);
      residual(this->view(), count, r.data(), vectors.data(), sums.data(), r.data());
      return as_columns(r);
    });
    EXPECT_LT((rest - (b - expected)).norm(), kRounding<TypeParam> * expected.norm());
  }
}

TEST(PassesOfVectors, StepsInPlace) {
  const Tangent& tangent = large_tangent();
  const std::vector<float> values(tangent.values.begin(), tangent.values.end());
  std::vector<float> inverse(std::size_t{12} * tangent.pattern->num_nodes, 0);
  for (Index node = 0; node < tangent.pattern->num_nodes; ++node) {
    for (int c = 0; c < 3; ++c) inverse[12 * node + 4 * c + c] = 0.5F;
  }
  for (const int count : {1, 3}) {
    const Eigen::MatrixXd b = random_columns(count, 73);
    const Eigen::MatrixXd x = random_columns(count, 74);
    const Eigen::MatrixXd d = random_columns(count, 75);
    const Eigen::MatrixXd moved = same_with_threads([&] {
      auto sums = room_for_sums<float>(count);
      auto to = as_vectors<float>(x);
      auto along = as_vectors<float>(d);
      chebyshev_step({tangent.pattern.get(), values.data()}, inverse.data(), count, {0.3F, 0.7F},
                     as_vectors<float>(b).data(), sums.data(), to.data(), along.data());
      EXPECT_TRUE(as_columns(sums).isZero(0));
      return as_columns(to);
    });
    const Eigen::MatrixXd expected = x + 0.3 * d + 0.35 * (b - plain_product(tangent, x));
    EXPECT_LT((moved - expected).norm(), kRounding<float> * expected.norm());
    (void)same_with_threads([&] {
      auto to = as_vectors<float>(x);
      auto along = as_vectors<float>(d);
      chebyshev_start(to.num_nodes(), inverse.data(), count, 0.7F, as_vectors<float>(b).data(),
                      to.data(), along.data());
      return as_columns(to);
    });
  }
}

TEST(PassesOfVectors, SumsAndProducts) {
  const Eigen::MatrixXd a = random_columns(3, 76);
  const Eigen::MatrixXd b = random_columns(3, 77);
  const auto of_a = as_vectors<double>(a);
  const auto of_b = as_vectors<double>(b);
  const Eigen::Vector3d dots = same_with_threads([&] {
    Eigen::Vector3d products;
    dot(of_a.num_nodes(), 3, of_a.data(), of_b.data(), products.data());
    return products;
  });
  const Eigen::Matrix3d grams = same_with_threads([&] {
    Eigen::Matrix<double, 3, 3, Eigen::RowMajor> products;
    gram(of_a.num_nodes(), of_a.data(), of_b.data(), products.data());
    return Eigen::Matrix3d(products);
  });
  const Eigen::Matrix3d expected = a.transpose() * b;
  const double rounding = kRounding<double> * a.norm() * b.norm();
  EXPECT_LT((grams - expected).norm(), rounding);
  EXPECT_LT((dots - expected.diagonal()).norm(), rounding);
  const double factors[] = {0.5, -2, 3};
  const Eigen::MatrixXd sum = same_with_threads([&] {
    auto y = of_b;
    add(y.num_nodes(), 3, factors, of_a.data(), y.data());
    scale_and_add(y.num_nodes(), 3, factors, of_a.data(), y.data());
    return as_columns(y);
  });
  const Eigen::DiagonalMatrix<double, 3> f(0.5, -2, 3);
  EXPECT_LT((sum - (a + (b + a * f) * f)).norm(), rounding);
}

TEST(Threads, OfTheStiffnessOfTheCorners) {
  const Tangent& tangent = large_tangent();
  const BlockPattern coarse = coarse_pattern(*tangent.pattern, tangent.levels);
  const Neighbourhoods neighbours = find_neighbourhoods(coarse);
  const auto make = [&](const GalerkinParts& parts) {
    std::vector<double> values;
    galerkin_product(*tangent.pattern, tangent.levels, parts, tangent.values, 1, coarse, neighbours,
                     values);
    return values;
  };
  const auto values = same_with_threads(
      [&] { return make(find_galerkin_parts(*tangent.pattern, tangent.levels)); });
  // Of parts of some hundred corners, and of one.
  for (const Index least : {50, 1 << 30}) {
    EXPECT_EQ(make(find_galerkin_parts(*tangent.pattern, tangent.levels, least)), values);
  }
}

TEST(Threads, OfASolve) {
  const Tangent& tangent = large_tangent();
  const Operator k(tangent.pattern, tangent.values);
  for (const int count : {1, 3}) {
    const Eigen::MatrixXd b = random_columns(count, 78);
    const Eigen::MatrixXd x = same_with_threads([&] {
      const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
      EXPECT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
      KrylovSolver solver({1e-8, 100});
      Eigen::MatrixXd columns = b;
      EXPECT_EQ(solver.solve(k, *preconditioner, columns).status, SolveStatus::converged);
      return columns;
    });
    EXPECT_LT((plain_product(tangent, x) - b).norm(), 2e-8 * b.norm());
  }
  (void)same_with_threads([&] {
    const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
    EXPECT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok);
    const LowestEigenvalue lowest = find_lowest_eigenvalue(k, *preconditioner, {});
    EXPECT_EQ(lowest.status, EigenStatus::converged);
    return lowest.value;
  });
}

// The set-up allocates in its parts.
TEST(Threads, MemoryThatIsUsedUpIsAnException) {
  const Tangent& tangent = large_tangent();
  const auto preconditioner = make_preconditioner(tangent.pattern, tangent.levels);
  for (const int threads : {1, 3}) {
    const auto team = make_thread_team(threads);
    for (long left = 0; left < 1000; left = 2 * left + 1) {
      allocations_left = left;
      EXPECT_THROW(with_team(team.get(), [&] { (void)preconditioner->refresh(tangent.values); }),
                   std::bad_alloc)
          << left;
      allocations_left = -1;
    }
    with_team(team.get(),
              [&] { EXPECT_EQ(preconditioner->refresh(tangent.values).status, SetupStatus::ok); });
  }
}

}  // namespace
}  // namespace palpate::test::test_threads

// SPDX-License-Identifier: BSD-3-Clause
// Every pass beside the dense product that it stands for.
#include "iterative/passes.h"

#include <gtest/gtest.h>

#include "iterative/aggregation.h"
#include "iterative/node_vectors.h"
#include "solvers/iterative/tangents.h"

namespace palpate::test::test_passes {
namespace {

/// Of a product of a few hundred terms of order one, relative to its length.
template <class T>
constexpr double kRounding = std::is_same_v<T, double> ? 1e-14 : 2e-6;

template <class T>
class Passes : public testing::Test {
 protected:
  Passes() {
    tangent_ = tangent_of(block_scene());
    double largest = 0;
    for (double value : tangent_.values) largest = std::max(largest, std::abs(value));
    for (double& value : tangent_.values) value /= largest;
    matrix_ = tangent_.matrix();
    values_.assign(tangent_.values.begin(), tangent_.values.end());
  }
  [[nodiscard]] NodeVectors<T> vectors(const Eigen::MatrixXd& columns) const {
    NodeVectors<T> result;
    result.set_zero(tangent_.pattern->num_nodes, static_cast<int>(columns.cols()));
    result.assign(columns);
    return result;
  }
  [[nodiscard]] static Eigen::MatrixXd columns(const NodeVectors<T>& vectors) {
    Eigen::MatrixXd result(3 * vectors.num_nodes(), vectors.num_columns());
    vectors.copy_to(result);
    return result;
  }
  [[nodiscard]] static bool has_zero_lanes(const NodeVectors<T>& vectors) {
    for (Eigen::Index i = 3; i < vectors.size(); i += 4) {
      if (vectors.data()[i] != 0) return false;
    }
    return true;
  }
  [[nodiscard]] BlockMatrixView<T> view() const { return {tangent_.pattern.get(), values_.data()}; }
  [[nodiscard]] Eigen::MatrixXd random(int num_columns) {
    return random_.vector(Eigen::Index{tangent_.size()} * num_columns, 1)
        .reshaped(tangent_.size(), num_columns);
  }

  Tangent tangent_;
  Eigen::MatrixXd matrix_;
  std::vector<T> values_;
  Random random_{61};
};

using Numbers = testing::Types<float, double>;
TYPED_TEST_SUITE(Passes, Numbers);

TYPED_TEST(Passes, Multiply) {
  for (int c : {1, 3}) {
    const Eigen::MatrixXd x = this->random(c);
    auto y = this->vectors(this->random(c));
    auto sums = this->vectors(Eigen::MatrixXd::Zero(x.rows(), c));
    multiply(this->view(), c, this->vectors(x).data(), sums.data(), y.data());
    const Eigen::MatrixXd expected = this->matrix_ * x;
    EXPECT_LT((this->columns(y) - expected).norm(), kRounding<TypeParam> * expected.norm());
    EXPECT_TRUE(this->has_zero_lanes(y));
    EXPECT_TRUE(this->columns(sums).isZero(0)) << "is not left as it was";
  }
}

TYPED_TEST(Passes, ResidualInPlace) {
  for (int c : {1, 3}) {
    const Eigen::MatrixXd x = this->random(c);
    const Eigen::MatrixXd b = this->random(c);
    auto r = this->vectors(b);
    auto sums = this->vectors(Eigen::MatrixXd::Zero(x.rows(), c));
    residual(this->view(), c, r.data(), this->vectors(x).data(), sums.data(), r.data());
    const Eigen::MatrixXd expected = b - this->matrix_ * x;
    EXPECT_LT((this->columns(r) - expected).norm(), kRounding<TypeParam> * expected.norm());
    EXPECT_TRUE(this->has_zero_lanes(r));
  }
}

class FloatPasses : public Passes<float> {};

TEST_F(FloatPasses, ChebyshevStepsInOnePass) {
  std::vector<float> inverse_diagonal(std::size_t{12} * tangent_.pattern->num_nodes, 0);
  Eigen::MatrixXd inverse = Eigen::MatrixXd::Zero(matrix_.rows(), matrix_.cols());
  for (Index node = 0; node < tangent_.pattern->num_nodes; ++node) {
    const Mat3 block = matrix_.block<3, 3>(3 * node, 3 * node).inverse();
    inverse.block<3, 3>(3 * node, 3 * node) = block;
    for (int c = 0; c < 3; ++c) {
      Eigen::Vector3f::Map(&inverse_diagonal[12 * node + 4 * c]) = block.col(c).cast<float>();
    }
  }
  for (int c : {1, 3}) {
    const Eigen::MatrixXd b = random(c);
    auto x = vectors(random(c));
    auto d = vectors(random(c));
    auto sums = vectors(Eigen::MatrixXd::Zero(b.rows(), c));
    chebyshev_start(tangent_.pattern->num_nodes, inverse_diagonal.data(), c, 0.7F,
                    vectors(b).data(), x.data(), d.data());
    const Eigen::MatrixXd first = 0.7 * inverse * b;
    EXPECT_LT((columns(x) - first).norm(), kRounding<float> * first.norm());
    EXPECT_EQ(columns(x), columns(d));

    chebyshev_step(view(), inverse_diagonal.data(), c, {0.3F, 0.5F}, vectors(b).data(), sums.data(),
                   x.data(), d.data());
    const Eigen::MatrixXd step = 0.3 * first + 0.5 * inverse * (b - matrix_ * first);
    EXPECT_LT((columns(d) - step).norm(), 10 * kRounding<float> * step.norm());
    EXPECT_LT((columns(x) - first - step).norm(), 10 * kRounding<float> * first.norm());
    EXPECT_TRUE(has_zero_lanes(x));
  }
}

TEST_F(FloatPasses, BetweenNodesAndCorners) {
  const Eigen::MatrixXd p = dense_prolongation(tangent_.levels);
  for (int c : {1, 3}) {
    const Eigen::MatrixXd fine = random(c);
    const Eigen::MatrixXd coarse = random_.vector(p.cols() * c, 1).reshaped(p.cols(), c);
    NodeVectors<float> corners;
    corners.set_zero(tangent_.levels.num_corners(), c);
    restrict_to(find_children(tangent_.levels), c, vectors(fine).data(), corners.data());
    EXPECT_LT((columns(corners) - p.transpose() * fine).norm(), kRounding<float> * fine.norm());
    corners.assign(coarse);
    auto nodes = vectors(fine);
    prolong(tangent_.levels.parents, c, corners.data(), nodes.data());
    EXPECT_LT((columns(nodes) - fine - p * coarse).norm(), kRounding<float> * fine.norm());
  }
}

class DoublePasses : public Passes<double> {};

TEST_F(DoublePasses, Vectors) {
  for (int c : {1, 3}) {
    const Eigen::MatrixXd a = random(c);
    const Eigen::MatrixXd b = random(c);
    const Index n = tangent_.pattern->num_nodes;
    const double factors[3] = {2, -0.5, 0.25};
    const auto scaled = [&](const Eigen::MatrixXd& x) {
      return Eigen::MatrixXd(x * Eigen::Vector3d::Map(factors).head(c).asDiagonal());
    };
    double products[3];
    dot(n, c, vectors(a).data(), vectors(b).data(), products);
    for (int i = 0; i < c; ++i) {
      EXPECT_NEAR(products[i], a.col(i).dot(b.col(i)), kRounding<double> * a.norm() * b.norm());
    }
    auto y = vectors(b);
    add(n, c, factors, vectors(a).data(), y.data());
    EXPECT_LT((columns(y) - b - scaled(a)).norm(), kRounding<double> * b.norm());
    y = vectors(b);
    scale_and_add(n, c, factors, vectors(a).data(), y.data());
    EXPECT_LT((columns(y) - a - scaled(b)).norm(), kRounding<double> * b.norm());
    NodeVectors<float> single;
    single.set_zero(n, c);
    convert(n, c, factors, vectors(a).data(), single.data());
    Eigen::MatrixXd back(a.rows(), c);
    single.copy_to(back);
    EXPECT_EQ(back, scaled(a).cast<float>().cast<double>());
    convert(n, c, factors, single.data(), y.data());
    EXPECT_EQ(columns(y), scaled(back));
  }
}

/// A random matrix of blocks, and the same as a dense one.
struct RandomBlocks {
  std::vector<Index> start{0};
  std::vector<Index> column;
  std::vector<float> values;
  Eigen::MatrixXf dense;

  RandomBlocks(Index rows, Index columns, int row_size, Random& random)
      : dense(Eigen::MatrixXf::Zero(row_size * rows, 6 * columns)) {
    for (Index row = 0; row < rows; ++row) {
      for (Index c = row % 2; c < columns; c += 2) {
        const Eigen::MatrixXf block =
            random.vector(row_size * 6, 1).reshaped(row_size, 6).cast<float>();
        dense.block(row_size * row, 6 * c, row_size, 6) = block;
        column.push_back(c);
        values.insert(values.end(), block.data(), block.data() + block.size());
      }
      start.push_back(static_cast<Index>(column.size()));
    }
    values.resize(values.size() + 2);
  }
};

/// Columns with `size` components a node as the passes have them, with `room` for each.
Eigen::VectorXf packed(const Eigen::MatrixXf& columns, int size, int room) {
  const Eigen::Index nodes = columns.rows() / size;
  Eigen::VectorXf result = Eigen::VectorXf::Zero(nodes * room * columns.cols());
  for (Eigen::Index node = 0; node < nodes; ++node) {
    for (Eigen::Index c = 0; c < columns.cols(); ++c) {
      result.segment((node * columns.cols() + c) * room, size) =
          columns.col(c).segment(node * size, size);
    }
  }
  return result;
}

TEST(AggregatePasses, Residual) {
  Random random(62);
  constexpr Index kNodes = 7;
  const RandomBlocks a(kNodes, kNodes, 6, random);
  for (int c : {1, 3}) {
    const Eigen::MatrixXf x =
        random.vector(6 * kNodes * c, 1).reshaped(6 * kNodes, c).cast<float>();
    const Eigen::MatrixXf b =
        random.vector(6 * kNodes * c, 1).reshaped(6 * kNodes, c).cast<float>();
    Eigen::VectorXf r = packed(x, 6, 8);
    residual({kNodes, a.start.data(), a.column.data(), a.values.data()}, c, packed(b, 6, 8).data(),
             packed(x, 6, 8).data(), r.data());
    const Eigen::VectorXf expected = packed(b - a.dense * x, 6, 8);
    EXPECT_LT((r - expected).norm(), kRounding<float> * expected.norm());
  }
}

TEST(AggregatePasses, Update) {
  Random random(63);
  constexpr Index kNodes = 5;
  Eigen::MatrixXf inverse = Eigen::MatrixXf::Zero(6 * kNodes, 6 * kNodes);
  std::vector<float> blocks;
  for (Index node = 0; node < kNodes; ++node) {
    const Eigen::MatrixXf block = random.vector(36, 1).reshaped(6, 6).cast<float>();
    inverse.block<6, 6>(6 * node, 6 * node) = block;
    blocks.insert(blocks.end(), block.data(), block.data() + 36);
  }
  blocks.resize(blocks.size() + 2);
  for (int c : {1, 3}) {
    const auto any = [&] {
      return Eigen::MatrixXf(
          random.vector(6 * kNodes * c, 1).reshaped(6 * kNodes, c).cast<float>());
    };
    const Eigen::MatrixXf r = any(), x = any(), d = any();
    Eigen::VectorXf moved = packed(x, 6, 8);
    Eigen::VectorXf step = packed(d, 6, 8);
    chebyshev_update(kNodes, blocks.data(), c, {0.3F, 0.5F}, packed(r, 6, 8).data(), moved.data(),
                     step.data());
    const Eigen::MatrixXf expected = 0.3F * d + 0.5F * inverse * r;
    EXPECT_LT((step - packed(expected, 6, 8)).norm(), kRounding<float> * expected.norm());
    EXPECT_LT((moved - packed(x + expected, 6, 8)).norm(), kRounding<float> * expected.norm());
  }
}

TEST(AggregatePasses, BetweenLevels) {
  Random random(64);
  constexpr Index kFine = 9;
  constexpr Index kCoarse = 4;
  for (int rows : {3, 6}) {
    const int room = rows == 3 ? 4 : 8;
    const RandomBlocks p(kFine, kCoarse, rows, random);
    const ByColumn by = by_column(kCoarse, p.start, p.column);
    std::vector<float> transposed(p.values.size(), 0);
    for (std::size_t k = 0; k < by.place.size(); ++k) {
      const auto from = Eigen::MatrixXf::Map(&p.values[6 * rows * by.place[k]], rows, 6);
      Eigen::MatrixXf::Map(&transposed[6 * rows * k], 6, rows) = from.transpose();
    }
    const AggregationView view{
        rows,    kFine,           p.start.data(), p.column.data(),  p.values.data(),
        kCoarse, by.start.data(), by.row.data(),  transposed.data()};
    for (int c : {1, 3}) {
      const Eigen::MatrixXf fine =
          random.vector(rows * kFine * c, 1).reshaped(rows * kFine, c).cast<float>();
      const Eigen::MatrixXf coarse =
          random.vector(6 * kCoarse * c, 1).reshaped(6 * kCoarse, c).cast<float>();
      Eigen::VectorXf up = packed(fine, rows, room);
      prolong(view, c, packed(coarse, 6, 8).data(), up.data());
      const Eigen::VectorXf expected_up = packed(fine + p.dense * coarse, rows, room);
      EXPECT_LT((up - expected_up).norm(), kRounding<float> * expected_up.norm());
      Eigen::VectorXf down = Eigen::VectorXf::Zero(8 * kCoarse * c);
      restrict_to(view, c, packed(fine, rows, room).data(), down.data());
      const Eigen::VectorXf expected_down = packed(p.dense.transpose() * fine, 6, 8);
      EXPECT_LT((down - expected_down).norm(), kRounding<float> * expected_down.norm());
    }
  }
}

}  // namespace
}  // namespace palpate::test::test_passes

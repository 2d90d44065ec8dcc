// SPDX-License-Identifier: BSD-3-Clause
// One system on a group of ranks: equal to one rank but for rounding.
#include "linear/group.h"

#include <gtest/gtest.h>
#include <mpi.h>

#include <functional>
#include <stdexcept>

#include "solvers/linear/systems.h"
#include "solvers/support/random.h"

namespace palpate::test::test_group {
namespace {

/// Of a solution on several ranks, relative: ε times the condition number, below 1e5.
constexpr double kRounding = 1e-10;

/// On rank 0 `use` with a solver of all ranks; the others serve meanwhile.
void with_group(const std::function<void(std::unique_ptr<LinearSolver>)>& use) {
  const MPI_Comm world = MPI_COMM_WORLD;
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank == 0) {
    use(make_group_solver(&world));
  } else {
    serve_group_solver(&world);
  }
  MPI_Barrier(world);
}

/// Both solvers say the same of a matrix, and solve it alike.
void expect_equal(LinearSolver& group, LinearSolver& alone, const std::vector<double>& values,
                  Index size) {
  const FactorStatus status = alone.factorise(values);
  EXPECT_EQ(group.factorise(values), status);
  if (status != FactorStatus::ok) return;
  EXPECT_EQ(group.negative_pivots(), alone.negative_pivots());
  Random random(55);
  const Eigen::MatrixXd b = random.vector(3 * size, 1).reshaped(size, 3);
  Eigen::MatrixXd x = b;
  Eigen::MatrixXd y = b;
  alone.solve(x);
  group.solve(y);
  EXPECT_LT((y - x).norm(), kRounding * x.norm());
}

/// Large enough that MUMPS gives every rank a share.
System large() { return body(make_block(Law::linear, {ElementOrder::quadratic, {8, 5, 5}}).scene); }

TEST(Group, SolvesAsOneRankDoes) {
  with_group([](std::unique_ptr<LinearSolver> group) {
    EXPECT_STREQ(group->name(), "MUMPS");
    EXPECT_TRUE(group->pivots());
    const System system = large();
    const auto alone = make_linear_solver("MUMPS");
    group->analyse(system.pattern);
    alone->analyse(system.pattern);
    // The last ones are indefinite: some eigenvalues, and all of them, below zero.
    for (double shift : {0.0, 1.0, -0.05, -0.3, -100.0}) {
      SCOPED_TRACE(shift);
      expect_equal(*group, *alone, system.shifted(shift), system.pattern.size);
    }
  });
}

TEST(Group, TakesSaddlePoints) {
  with_group([](std::unique_ptr<LinearSolver> group) {
    Scene scene;
    scene.body.mesh = make_box(ElementOrder::quadratic, {3, 3, 3}, Vec3(1, 1, 1));
    for (const Vec3& p : scene.body.mesh.points) scene.body.fixed.push_back(p.z() == 0 ? 1 : 0);
    scene.body.touchable.assign(scene.body.fixed.size(), 0);
    scene.organ.materials = {make_isotropic(Law::linear, 1000, 0)};
    const System system = incompressible(scene, 0, 1);
    const auto alone = make_linear_solver("MUMPS");
    group->analyse(system.pattern);
    alone->analyse(system.pattern);
    expect_equal(*group, *alone, system.values, system.pattern.size);
    EXPECT_EQ(group->negative_pivots(), 64);
  });
}

TEST(Group, KnowsABodyThatFloats) {
  with_group([](std::unique_ptr<LinearSolver> group) {
    Scene scene = make_block(Law::linear, {ElementOrder::quadratic, {5, 4, 4}}).scene;
    std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
    const System system = body(scene);
    group->analyse(system.pattern);
    EXPECT_EQ(group->factorise(system.values), FactorStatus::singular);
    EXPECT_EQ(group->factorise(std::vector<double>(system.values.size(), 0.0)),
              FactorStatus::singular);
    EXPECT_EQ(group->factorise(system.shifted(1)), FactorStatus::ok) << "and goes on";
  });
}

TEST(Group, HasSeveralFactors) {
  with_group([](std::unique_ptr<LinearSolver> group) {
    const System system = large();
    group->analyse(system.pattern);
    const auto another = group->another();
    ASSERT_EQ(group->factorise(system.values), FactorStatus::ok);
    ASSERT_EQ(another->factorise(system.shifted(1)), FactorStatus::ok);
    const Eigen::VectorXd x = Random(56).vector(system.pattern.size, 1);
    const System other{system.pattern, system.shifted(1)};
    Eigen::VectorXd column = other.matrix() * x;
    group.reset();  // the ranks serve until the last one is gone
    another->solve(column);
    EXPECT_LT((column - x).norm(), kRounding * x.norm());
    EXPECT_GT(another->factor_bytes(), 8 * system.pattern.num_values());
  });
}

TEST(Group, AnExceptionReleasesTheOthers) {
  const auto fails = [](std::unique_ptr<LinearSolver> group) {
    const System system = block();
    group->analyse(system.pattern);
    ASSERT_EQ(group->factorise(system.values), FactorStatus::ok);
    throw std::runtime_error("the user has pressed a key");
  };
  const MPI_Comm world = MPI_COMM_WORLD;
  int rank = 0;
  MPI_Comm_rank(world, &rank);
  if (rank == 0) {
    EXPECT_THROW(fails(make_group_solver(&world)), std::runtime_error);
  } else {
    serve_group_solver(&world);  // returns
  }
}

TEST(Group, MayEndBeforeItHasBegun) {
  with_group([](std::unique_ptr<LinearSolver>) {});
}

}  // namespace
}  // namespace palpate::test::test_group

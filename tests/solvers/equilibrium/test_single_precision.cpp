// SPDX-License-Identifier: BSD-3-Clause
// Factors in single precision change what is found in the last digits alone.
#include <gtest/gtest.h>

#include <memory>
#include <utility>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "linear/linear_solver.h"
#include "solvers/equilibrium/state.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"

namespace palpate::test::test_single_precision {
namespace {

struct Both {
  Equilibrium full;
  Equilibrium single;
};

/// A way in two steps, the second to a state from which no other starts.
Both solve(const Scene& scene, Index node, const Vec3& t) {
  Both both;
  for (const bool single : {false, true}) {
    EquilibriumOptions options;
    options.single_precision = single;
    EquilibriumSolver solver(scene, options);
    solver.set_interaction(bond_nodes({node}));
    const Equilibrium middle = solver.solve(0.5 * t, solver.rest());
    EXPECT_EQ(middle.outcome, Outcome::converged) << middle.summary.message;
    (single ? both.single : both.full) = solver.solve(t, middle, Tangent::iterated);
  }
  return both;
}

void expect_same(const Both& both) {
  const auto& [full, single] = both;
  ASSERT_EQ(full.outcome, Outcome::converged) << full.summary.message;
  ASSERT_EQ(single.outcome, Outcome::converged) << single.summary.message;
  EXPECT_LE((full.u - single.u).lpNorm<Eigen::Infinity>(), 2e-8 * full.u.lpNorm<Eigen::Infinity>());
  EXPECT_LE((full.v - single.v).norm(), 3e-4 * full.v.norm());
  EXPECT_LE((full.reaction - single.reaction).norm(), 1e-7 * full.reaction.norm());
  EXPECT_LE((full.stiffness - single.stiffness).norm(), 1e-6 * full.stiffness.norm());
  EXPECT_NEAR(full.energy, single.energy, 1e-10 * full.energy);
}

TEST(SinglePrecision, FindsTheSame) {
  for (const Law law : {Law::linear, Law::st_venant_kirchhoff, Law::neo_hookean, Law::mooney_rivlin,
                        Law::fung, Law::ogden}) {
    const test::Block block = test::make_block(law);
    expect_same(solve(block.scene, block.corner, Vec3(0.015, -0.01, 0.008)));
  }
}

TEST(SinglePrecision, SensitivityOfAStartIsRefined) {
  const test::Block block = test::make_block(Law::neo_hookean);
  EquilibriumOptions options;
  std::vector<Equilibrium> states;
  for (const bool single : {false, true}) {
    options.single_precision = single;
    EquilibriumSolver solver(block.scene, options);
    solver.set_interaction(bond_nodes({block.corner}));
    states.push_back(solver.solve(Vec3(0.01, 0.004, 0), solver.rest()));
  }
  EXPECT_LE((states[0].v - states[1].v).norm(), 1e-7 * states[0].v.norm());
  EXPECT_LE((states[0].stiffness - states[1].stiffness).norm(), 1e-8 * states[0].stiffness.norm());
  EXPECT_EQ(states[0].negative_pivots, states[1].negative_pivots);
}

// Where single precision is not enough, or no scene for it, factors are of full precision.
TEST(SinglePrecision, IsLeftAsideWhereItIsNotSafe) {
  test::Block block = test::make_block(Law::neo_hookean);
  block.scene.organ.materials.push_back(make_isotropic(Law::neo_hookean, 3e12, 0.35));
  block.scene.body.material_of_cell.assign(block.scene.body.mesh.num_cells(), 0);
  block.scene.body.material_of_cell[block.scene.body.mesh.num_cells() / 2] = 1;
  expect_same(solve(block.scene, block.corner, Vec3(0.004, -0.002, 0.003)));

  const test::Block mixed =
      test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.499});
  expect_same(solve(mixed.scene, mixed.corner, Vec3(0.01, -0.002, 0.003)));
}

/// A linear solver of which is counted how many factors that might have been of single precision
/// are. Those of tangents with larger entries than at rest are not, whether that would be safe
/// or not: so it does not depend on the linear solver in which of them a pivot is too small.
class Counted final : public LinearSolver {
 public:
  struct Counts {
    int single = 0;
    int full = 0;
    /// Of the first matrix, which is the tangent at rest.
    double largest_entry = 0;
  };
  Counted(std::unique_ptr<LinearSolver> solver, std::shared_ptr<Counts> counts)
      : solver_(std::move(solver)), counts_(std::move(counts)) {}

  [[nodiscard]] const char* name() const override { return solver_->name(); }
  [[nodiscard]] bool pivots() const override { return solver_->pivots(); }
  void analyse(const SymmetricPattern& pattern) override { solver_->analyse(pattern); }
  [[nodiscard]] std::unique_ptr<LinearSolver> another() const override {
    return std::make_unique<Counted>(solver_->another(), counts_);
  }
  [[nodiscard]] FactorStatus factorise(const std::vector<double>& values,
                                       Precision precision) override {
    double largest = 0;
    for (const double value : values) largest = std::max(largest, std::abs(value));
    if (counts_->largest_entry == 0) counts_->largest_entry = largest;
    const bool is_safe = largest <= 1.1 * counts_->largest_entry;
    const FactorStatus status = solver_->factorise(values, is_safe ? precision : Precision::full);
    if (precision != Precision::full) ++(solver_->is_single() ? counts_->single : counts_->full);
    return status;
  }
  [[nodiscard]] bool is_single() const override { return solver_->is_single(); }
  void solve(Eigen::Ref<Eigen::MatrixXd> columns) override { solver_->solve(columns); }
  [[nodiscard]] int negative_pivots() const override { return solver_->negative_pivots(); }
  [[nodiscard]] std::int64_t factor_bytes() const override { return solver_->factor_bytes(); }

 private:
  std::unique_ptr<LinearSolver> solver_;
  std::shared_ptr<Counts> counts_;
};

// On the way into an inverted state there are factors of full precision. What is solved for
// afterwards is what it is when it is solved for first.
TEST(SinglePrecision, ASolveDoesNotDependOnThoseBefore) {
  const test::Block block = test::make_block(Law::st_venant_kirchhoff, {ElementOrder::linear});
  EquilibriumOptions options;
  options.single_precision = true;
  options.third_derivatives = true;
  options.follow_folds = false;
  options.kept_factors = 5;
  const auto counts = std::make_shared<Counted::Counts>();
  const auto make = [&] {
    EquilibriumSolver solver(block.scene, options,
                             std::make_unique<Counted>(make_linear_solver(), counts));
    solver.set_interaction(bond_nodes({block.middle}));
    return solver;
  };
  const Vec3 t(0.01, 0.004, -0.006);
  const Vec3 further(0.016, 0.008, -0.01);
  const Vec3 inverted(-0.06, 0.02, 0);
  for (const Tangent tangent : {Tangent::factorised, Tangent::iterated}) {
    EquilibriumSolver fresh = make();
    const Equilibrium first = fresh.solve(t, fresh.rest(), Tangent::factorised);
    const Equilibrium second = fresh.solve(further, first, tangent);
    ASSERT_EQ(second.outcome, Outcome::converged) << second.summary.message;

    EquilibriumSolver used = make();
    const Equilibrium rest = used.rest();
    counts->single = counts->full = 0;
    const Equilibrium deep = used.solve(inverted, rest, Tangent::factorised);
    ASSERT_EQ(deep.outcome, Outcome::converged) << deep.summary.message;
    EXPECT_GT(counts->full, 0);
    test::expect_same_bits(used.solve(t, rest, Tangent::factorised), first);
    test::expect_same_bits(used.solve(further, first, tangent), second);
    // As on another rank: starts come from elsewhere, and nothing is kept of them.
    test::expect_same_bits(make().solve(further, first, tangent), second);
    test::expect_same_bits(make().solve(t, deep, tangent), used.solve(t, deep, tangent));
  }
}

// The unit has no part.
TEST(SinglePrecision, ScalesByPowersOfTwo) {
  std::vector<Equilibrium> states;
  for (const double unit : {1.0, 0x1p20}) {
    const test::Block block = test::make_block(
        Law::neo_hookean, {ElementOrder::quadratic, {3, 2, 2}, 0.1, 3000 * unit, 0.35});
    EquilibriumOptions options;
    options.single_precision = true;
    EquilibriumSolver solver(block.scene, options);
    solver.set_interaction(bond_nodes({block.corner}));
    states.push_back(solver.solve(Vec3(0.01, 0.004, 0), solver.rest()));
  }
  EXPECT_EQ(states[0].u, states[1].u);
  EXPECT_EQ(0x1p20 * states[0].reaction, states[1].reaction);
}

}  // namespace
}  // namespace palpate::test::test_single_precision

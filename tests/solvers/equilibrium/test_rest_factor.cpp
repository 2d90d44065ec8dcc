// SPDX-License-Identifier: BSD-3-Clause
// One factor of the tangent at rest serves all tool spaces, where it can and is worth it.
#include "equilibrium/rest_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <string>

#include "equilibrium/equilibrium.h"
#include "interaction/bonded_patch.h"
#include "solvers/equilibrium/soundness.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/laws.h"
#include "solvers/support/random.h"
#include "solvers/support/solvable.h"
#include "solvers/support/tangent.h"

namespace palpate::test::test_rest_factor {
namespace {

/// Rounding times a condition number of some 1e5.
constexpr double kRounding = 1e-10;
/// From this many on, one of the factors is that at rest; see EquilibriumOptions::kept_factors.
constexpr int kShares = 3;
constexpr int kDoesNot = 2;

EquilibriumOptions keeping(int factors) {
  EquilibriumOptions options;
  options.kept_factors = factors;
  return options;
}

/// What follows from the dense tangent at rest.
struct Reference {
  /// By unknown [unknowns × coordinates].
  Eigen::MatrixXd v;
  Eigen::MatrixXd stiffness;
};

Reference reference(const Assembly& assembly, const Interaction& tool) {
  const Eigen::MatrixXd k = tangent_at(assembly, NodalVector::Zero(assembly.state_size()));
  Eigen::MatrixXd moved = Eigen::MatrixXd::Zero(k.rows(), tool.num_coordinates());
  std::vector<char> held(k.rows(), 0);
  for (const auto& [point, coordinate] : tool.prescribed_points()) {
    const Index unknown = assembly.unknown_of_point()[point];
    for (int c = 0; c < 3; ++c) {
      moved(unknown + c, coordinate + c) = 1;
      held[unknown + c] = 1;
    }
  }
  std::vector<Index> free;
  for (Index i = 0; i < k.rows(); ++i) {
    if (held[i] == 0) free.push_back(i);
  }
  Reference result;
  result.v = moved;
  const Eigen::MatrixXd k_ii = k(free, free);
  const auto all = Eigen::seqN(0, moved.cols());
  const Eigen::MatrixXd k_ia = (k * moved)(free, all);
  result.v(free, all) = -k_ii.partialPivLu().solve(k_ia);
  result.stiffness = result.v.transpose() * k * result.v;
  return result;
}

void expect_as(const Reference& expected, const Equilibrium& rest, const Assembly& assembly) {
  ASSERT_EQ(rest.outcome, Outcome::converged) << rest.summary.message;
  Eigen::MatrixXd v(expected.v.rows(), expected.v.cols());
  const Index num_displacements = 3 * assembly.num_points();
  for (Index i = 0; i < v.rows(); ++i) {
    const Index place = assembly.state_of_unknown()[i];
    if (place < num_displacements) {
      v.row(i) = rest.v.row(place);
    } else {
      const Index pressure = place - num_displacements;
      v.row(i) = rest.p_v.row(pressure) / assembly.pressure_scale()[pressure];
    }
  }
  EXPECT_LT((v - expected.v).norm(), kRounding * expected.v.norm());
  EXPECT_LT((rest.stiffness - expected.stiffness).norm(), kRounding * expected.stiffness.norm());
  EXPECT_EQ(rest.negative_pivots, 0);
  EXPECT_EQ(rest.flags, 0);
}

Index most_held(const SymmetricPattern& pattern) {
  const auto solver = make_linear_solver();
  solver->analyse(pattern);
  return RestFactor::most_held(*solver, pattern.size);
}

struct Case {
  const char* name;
  Law law;
  ElementOrder order;
  double poissons_ratio;
};

void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

std::string name_of_case(const testing::TestParamInfo<Case>& info) { return info.param.name; }

const Case kCases[] = {
    {"Linear", Law::linear, ElementOrder::quadratic, 0.35},
    {"Displacement", Law::neo_hookean, ElementOrder::quadratic, 0.35},
    {"DisplacementTet4", Law::neo_hookean, ElementOrder::linear, 0.35},
    {"NearlyIncompressible", Law::neo_hookean, ElementOrder::quadratic, 0.499},
    {"Incompressible", Law::mooney_rivlin_incompressible, ElementOrder::quadratic, 0.5},
    {"IncompressibleTet4", Law::mooney_rivlin_incompressible, ElementOrder::linear, 0.5},
};

class SharedFactor : public testing::TestWithParam<Case> {
 protected:
  void SetUp() override {
    const Case& c = GetParam();
    block_ = make_block(c.law, {c.order, {4, 3, 3}, 0.1, 3000, c.poissons_ratio});
    if (!is_solvable(block_.scene)) GTEST_SKIP() << "this build has no solver that pivots";
    const Index side = nearest_point(block_.scene.body.mesh, Vec3(0.06, 0, 0.025));
    nodes_ = {block_.corner, block_.middle, side};
  }

  /// Tools at one node after another, and two at once.
  [[nodiscard]] std::vector<InteractionList> choices(double radius) const {
    const BondedPatches patches(block_.scene.body, radius);
    return {patches.around_each({nodes_[0]}), patches.around_each({nodes_[1]}),
            patches.around_each({nodes_[2]}), patches.around_each({nodes_[0], nodes_[2]})};
  }

  Block block_;
  std::vector<Index> nodes_;
};
INSTANTIATE_TEST_SUITE_P(Each, SharedFactor, testing::ValuesIn(kCases), name_of_case);

TEST_P(SharedFactor, GivesWhatFollowsFromTheTangent) {
  for (const double radius : {0.0, 0.013}) {
    SCOPED_TRACE(radius);
    EquilibriumSolver solver(block_.scene, keeping(kShares));
    const Index most = most_held(solver.assembly().pattern());
    long num_alone = 0;
    for (const InteractionList& tools : choices(radius)) {
      solver.set_interaction(tools);
      expect_as(reference(solver.assembly(), tools), solver.rest(), solver.assembly());
      if (3 * tools.prescribed_points().size() > static_cast<std::size_t>(most)) ++num_alone;
      EXPECT_EQ(solver.work().factorisations, 1 + num_alone);
    }
    EXPECT_LE(num_alone, radius == 0 ? 0 : 1) << "the two tips together may be too large";
    EXPECT_EQ(solver.work().assemblies, 1);
  }
}

TEST_P(SharedFactor, LeadsToTheSameEquilibriumAsAFactorOfItsOwn) {
  const Vec3 t(0.006, -0.004, 0.005);
  for (const InteractionList& tools : choices(0)) {
    if (tools.num_coordinates() > 3) continue;
    std::vector<Equilibrium> ends;
    for (const int kept : {kDoesNot, kShares}) {
      EquilibriumSolver solver(block_.scene, keeping(kept));
      solver.set_interaction(tools);
      ends.push_back(solver.solve(t, solver.rest()));
      EXPECT_EQ(ends.back().outcome, Outcome::converged) << ends.back().summary.message;
      expect_sound(ends.back(), solver, tools);
    }
    // Both ends have the residual that was asked for.
    EXPECT_LT((ends[0].u - ends[1].u).norm(), 1e-8 * ends[0].u.norm());
    EXPECT_LT((ends[0].reaction - ends[1].reaction).norm(), 1e-8 * ends[0].reaction.norm());
    EXPECT_EQ(ends[0].summary.iterations, ends[1].summary.iterations);
  }
}

// From rest its factor is used on, also when the state at rest comes from elsewhere.
TEST_P(SharedFactor, IsThatOfStepsFromRest) {
  EquilibriumSolver elsewhere(block_.scene, keeping(kShares));
  EquilibriumSolver solver(block_.scene, keeping(kShares));
  std::vector<Equilibrium> ends;
  for (EquilibriumSolver* each : {&elsewhere, &solver}) {
    each->set_interaction(bond_nodes({block_.corner}));
    if (each == &elsewhere) ends.push_back(each->rest());
    ends.push_back(each->solve(Vec3(0.001, 0, 0), ends.front()));
  }
  EXPECT_EQ(ends[1].u, ends[2].u);
  // One at rest and, but for a linear body, one at the end.
  const long factorisations = GetParam().law == Law::linear ? 1 : 2;
  EXPECT_EQ(elsewhere.work().factorisations, factorisations);
  EXPECT_LE(solver.work().factorisations, factorisations);
}

TEST_P(SharedFactor, IsNoneWhereFewAreKept) {
  if (GetParam().law == Law::linear) return;  // it has one for all states
  EquilibriumSolver solver(block_.scene, keeping(kDoesNot));
  for (const Index node : nodes_) {
    solver.set_interaction(bond_nodes({node}));
    EXPECT_EQ(solver.rest().outcome, Outcome::converged);
  }
  EXPECT_EQ(solver.work().factorisations, 3);
}

// So many unknowns are held that the solves for them would take longer than a factorisation.
TEST_P(SharedFactor, IsNoneForLargeTips) {
  EquilibriumSolver solver(block_.scene, keeping(kShares));
  const BondedPatches patches(block_.scene.body, 0.05);
  long expected = 0;
  for (const Index node : {block_.corner, block_.middle}) {
    const BondedPatch patch = patches.around(node);
    solver.set_interaction(patch);
    expect_as(reference(solver.assembly(), patch), solver.rest(), solver.assembly());
    EXPECT_EQ(solver.work().factorisations, ++expected);
  }
}

/// The block, fixed at a single point.
Scene hanging_block(Law law) {
  Scene scene = make_block(law).scene;
  bool first = true;
  for (char& fixed : scene.body.fixed) {
    fixed = fixed != 0 && first ? 1 : 0;
    first = first && fixed == 0;
  }
  return scene;
}

// What the tool spaces alone hold has no factor without them.
TEST(RestFactor, OfAFloatingBodyThereIsNone) {
  for (const Law law : {Law::linear, Law::neo_hookean}) {
    const Scene scene = hanging_block(law);
    EquilibriumSolver solver(scene, keeping(kShares));
    const BondedPatches patches(scene.body, 0.02);
    const Block block = make_block(law);
    long expected = 1;  // the attempt
    for (const Index node : {block.corner, block.middle}) {
      const BondedPatch patch = patches.around(node);
      ASSERT_GE(patch.points().size(), 3U);
      solver.set_interaction(patch);
      const Equilibrium rest = solver.rest();
      expect_as(reference(solver.assembly(), patch), rest, solver.assembly());
      EXPECT_EQ(solver.work().factorisations, ++expected);
      const Equilibrium moved = solver.solve(Vec3(0.001, 0.001, 0), rest);
      EXPECT_EQ(moved.outcome, Outcome::converged) << moved.summary.message;
      expect_sound(moved, solver, patch);
      if (law != Law::linear) expected = solver.work().factorisations;
    }
    solver.set_interaction(bond_nodes({block.corner}));
    EXPECT_EQ(solver.rest().outcome, Outcome::tangent_not_factorised);
  }
}

// The softer what carries the body, the more digits does its factor lose beside one of the body
// with its tool spaces held. What is found does not.
TEST(RestFactor, OfABodyOnSoftFeetServesAsFarAsItIsAccurate) {
  for (const double softness : {1e-3, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 1e-15}) {
    SCOPED_TRACE(softness);
    Block block = make_block(Law::neo_hookean, {ElementOrder::quadratic, {4, 3, 3}});
    put_inside(block.scene, scaled(block.scene.organ.materials[0], softness),
               [](const Vec3& p) { return p.x() < 0.02; });
    std::vector<Equilibrium> rests;
    std::vector<long> factorisations;
    for (const int kept : {kDoesNot, kShares}) {
      EquilibriumSolver solver(block.scene, keeping(kept));
      solver.set_interaction(BondedPatches(block.scene.body, 0.013).around(block.middle));
      rests.push_back(solver.rest());
      ASSERT_EQ(rests.back().outcome, Outcome::converged) << rests.back().summary.message;
      factorisations.push_back(solver.work().factorisations);
    }
    EXPECT_LT((rests[0].v - rests[1].v).norm(), kRounding * rests[0].v.norm());
    EXPECT_LT((rests[0].stiffness - rests[1].stiffness).norm(),
              kRounding * rests[0].stiffness.norm());
    EXPECT_EQ(factorisations[0], 1);
    if (softness >= 1e-6 || softness <= 1e-10) {
      EXPECT_EQ(factorisations[1], softness >= 1e-6 ? 1 : 2);
    }
  }
}

// Of any symmetric matrix.
TEST(RestFactor, SolvesWithWhatIsFree) {
  const Block block = make_block(Law::neo_hookean, {ElementOrder::linear, {3, 3, 2}});
  const Assembly assembly(block.scene);
  const SymmetricPattern& pattern = assembly.pattern();
  NodalVector force;
  std::vector<double> values;
  assembly.tangent(NodalVector::Zero(assembly.state_size()), force, values);
  const Eigen::MatrixXd tangent = dense(pattern, values);
  Random random(71);
  for (const double shift : {0.0, -0.05, -0.3}) {  // some eigenvalues below zero, and many
    std::vector<double> shifted = values;
    for (Index c = 0; c < pattern.size; ++c) {
      shifted[pattern.column_start[c]] += shift * tangent.diagonal().mean();
    }
    const Eigen::MatrixXd matrix = dense(pattern, shifted);
    auto solver = make_linear_solver();
    solver->analyse(pattern);
    ASSERT_EQ(solver->factorise(shifted), FactorStatus::ok);
    const int negative = solver->negative_pivots();
    EXPECT_EQ(negative > 0, shift < 0);
    RestFactor factor(std::move(solver), pattern.size);
    for (const std::vector<Index>& held :
         {std::vector<Index>{0}, {7, 3, 20}, {30, 31, 32, 33, 34, 35, 36, 37, 38}}) {
      factor.hold(held);
      std::vector<Index> free;
      for (Index i = 0; i < pattern.size; ++i) {
        if (std::find(held.begin(), held.end(), i) == held.end()) free.push_back(i);
      }
      const Eigen::MatrixXd k_ii = matrix(free, free);
      const Eigen::MatrixXd columns = random.vector(2 * pattern.size, 1).reshaped(pattern.size, 2);
      Eigen::MatrixXd found = columns;
      factor.solve(found);
      const auto all = Eigen::seqN(0, columns.cols());
      const Eigen::MatrixXd right = columns(free, all);
      const Eigen::MatrixXd expected = k_ii.partialPivLu().solve(right);
      EXPECT_LT((found(free, all) - expected).norm(), kRounding * expected.norm());
      EXPECT_TRUE(found(held, all).isZero(0));
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(k_ii, Eigen::EigenvaluesOnly);
      EXPECT_EQ(factor.negative_pivots(), (modes.eigenvalues().array() < 0).count());
    }
  }
}

TEST(RestFactor, IsWorthItForMoreUnknownsTheLargerTheBody) {
  Index last = 0;
  for (const int cells : {2, 4, 8}) {
    const Block block = make_block(Law::neo_hookean, {ElementOrder::linear, {cells, cells, cells}});
    const Index expected = most_held(Assembly(block.scene).pattern());
    EXPECT_GT(expected, last);
    last = expected;
  }
}

}  // namespace
}  // namespace palpate::test::test_rest_factor

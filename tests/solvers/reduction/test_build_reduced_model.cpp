// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include "assembly/assembly.h"
#include "assembly/external_energy.h"
#include "base/error.h"
#include "reduced/model_arrays.h"
#include "reduced/reduced_energy.h"
#include "reduction/build_reduced_model.h"
#include "reduction/hyper_reduction.h"
#include "reduction/path_error.h"
#include "reduction/random_path.h"
#include "reduction/reduced_basis.h"
#include "reduction/training.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"
#include "solvers/support/message_of.h"
#include "solvers/support/supported.h"

namespace palpate::test::test_build_reduced_model {
namespace {

constexpr double kReach = 0.01;  // of a block of 0.1

test::Block make_block(Law law) {
  return test::make_block(law, {ElementOrder::quadratic, {3, 2, 2}});
}

Rheology dense(double prony_modulus = 0) {
  Rheology rheology;
  rheology.density = 1000;
  rheology.viscous_time = 0.01;
  if (prony_modulus > 0) {
    rheology.prony_moduli = {prony_modulus};
    rheology.prony_times = {0.1};
  }
  return rheology;
}

std::vector<BondedPatch> patches_of(const test::Block& block, int num_tools) {
  const BondedPatches patches(block.scene.body, 0.016);
  std::vector<BondedPatch> tools = {patches.around(block.corner)};
  // The opposite corner of the end that is touched.
  Index other = -1;
  double farthest = 0;
  const std::vector<Vec3>& points = block.scene.body.mesh.points;
  for (Index p = 0; p < block.scene.body.mesh.num_points(); ++p) {
    const double distance = (points[p] - points[block.corner]).norm();
    if (block.scene.body.fixed[p] != 0 || points[p].x() < 0.09 || distance < farthest) continue;
    farthest = distance;
    other = p;
  }
  if (num_tools > 1) tools.push_back(patches.around(other));
  return tools;
}

InteractionList as_list(const std::vector<BondedPatch>& tools) {
  InteractionList list;
  for (const BondedPatch& tool : tools) list.add(tool);
  return list;
}

ReductionOptions small_options(Index modes) {
  ReductionOptions options;
  options.modes = modes;
  options.reach = kReach;
  options.training_paths = 2;
  options.path_duration = 1;
  options.all_tools_states = 20;
  return options;
}

PathError error_of_equilibria(Law law, int num_tools, Index modes) {
  const test::Block block = make_block(law);
  const std::vector<BondedPatch> tools = patches_of(block, num_tools);
  const BuiltModel built =
      build_reduced_model(block.scene, {Rheology()}, tools, small_options(modes));
  EXPECT_FALSE(built.model.has_inertia());
  EXPECT_EQ(built.motion_modes, 0);
  EXPECT_EQ(built.model.num_modes, modes);
  EXPECT_TRUE(built.within_tolerance) << built.residual;
  EXPECT_LT(built.model.points.num_points(), 288 / 2);  // of those of the body
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(as_list(tools));
  const PathError error =
      measure_equilibria(built.model, solver, random_places(num_tools, kReach, 20, 12345));
  EXPECT_GE(error.num_compared, 15);
  EXPECT_EQ(error.num_failed, 0);
  EXPECT_LT(error.largest_trust, 1.5);
  return error;
}

constexpr double kTimeStep = 2e-3;

RandomPathOptions path_with_taps(int num_tools) {
  RandomPathOptions path;
  path.num_tools = num_tools;
  path.duration = 0.3;
  path.reach = kReach;
  path.taps = 6;
  return path;
}

ReducedBodyOptions reduced_body_options() {
  ReducedBodyOptions options;
  options.time_step = kTimeStep;
  return options;
}

/// Of a path that it was not trained with: the bounds that a reduced model is to keep in motion.
PathError expect_moves_as_whole_body(const BuiltModel& built, const Scene& scene,
                                     const std::vector<Rheology>& rheologies,
                                     const std::vector<BondedPatch>& tools,
                                     const Vec3& gravity = Vec3::Zero()) {
  const RandomPathOptions path = path_with_taps(static_cast<int>(tools.size()));
  DynamicsOptions options;
  options.time_step = kTimeStep;
  options.gravity = gravity;
  DynamicSolver whole(scene, rheologies, as_list(tools), options);
  const PathError error = measure_motion(built.model, whole, random_path(path, 4321), path.duration,
                                         reduced_body_options());
  EXPECT_EQ(error.num_compared, 150);
  EXPECT_EQ(error.num_failed, 0);
  EXPECT_LT(error.rms, 0.008);
  EXPECT_LT(error.max, 0.03);
  return error;
}

// The bounds are those that a reduced model is to keep (see the benchmark of reduced models); with
// the same number of modes a law that stiffens may have twice the error.

TEST(BuildReducedModel, EquilibriaOfOneTool) {
  EXPECT_LT(error_of_equilibria(Law::neo_hookean, 1, 12).max, 0.002);
  EXPECT_LT(error_of_equilibria(Law::fung, 1, 12).max, 0.004);
}

TEST(BuildReducedModel, EquilibriaOfTwoTools) {
  EXPECT_LT(error_of_equilibria(Law::neo_hookean, 2, 30).max, 0.015);
}

TEST(BuildReducedModel, MotionOfTwoToolsWithTapsAndViscosity) {
  const test::Block block = make_block(Law::neo_hookean);
  const std::vector<Rheology> rheologies = {dense(0.3)};
  const std::vector<BondedPatch> tools = patches_of(block, 2);
  const BuiltModel built = build_reduced_model(block.scene, rheologies, tools, small_options(50));
  EXPECT_TRUE(built.model.has_inertia());
  EXPECT_GT(built.motion_modes, 20);
  const PathError error = expect_moves_as_whole_body(built, block.scene, rheologies, tools);
  EXPECT_LE(error.mean, error.rms);

  // Far beyond training it goes on, and it is as before when it comes back.
  RandomPathOptions path = path_with_taps(2);
  path.reach = 8 * kReach;
  path.duration = 3;
  const ToolPath far = random_path(path, 99);
  ReducedBody body(built.model, reduced_body_options());
  double largest_trust = 0;
  for (int i = 1; i <= 1500; ++i) {
    const Eigen::VectorXd place = far.at(kTimeStep * i);
    largest_trust = std::max(largest_trust, body.step(place.data()).trust);
    ASSERT_TRUE(body.force().allFinite());
    EXPECT_LT(body.force().lpNorm<Eigen::Infinity>(), 100 * error.largest_force);
  }
  EXPECT_GT(largest_trust, 5);
  for (int i = 1; i <= 1500; ++i) {
    const Eigen::VectorXd place = far.at(3) * std::max(0.0, 1 - i / 500.0);
    (void)body.step(place.data());
  }
  EXPECT_EQ(body.state().outcome, ReducedOutcome::converged);
  EXPECT_LT(body.state().trust, 0.05);
  EXPECT_LT(body.force().norm(), 0.05 * error.largest_force);
}

TEST(BuildReducedModel, UnderGravityItCountsFromTheRestThere) {
  const test::Block block = make_block(Law::neo_hookean);
  const std::vector<Rheology> rheologies = {dense()};
  const std::vector<BondedPatch> tools = patches_of(block, 1);
  ReductionOptions options = small_options(30);
  options.gravity = Vec3(1, 0, -9.81);
  const BuiltModel built = build_reduced_model(block.scene, rheologies, tools, options);
  EXPECT_TRUE(built.within_tolerance) << built.residual;
  EquilibriumSolver solver(with_gravity(block.scene, rheologies, options.gravity), {});
  const Equilibrium rest = solver.settled();
  solver.set_interaction(as_list(tools));
  EXPECT_EQ(built.rest, rest.u);
  EXPECT_GT(rest.u.lpNorm<Eigen::Infinity>(), 0.3 * kReach);
  // The basis is orthonormal in the stiffness there.
  const Eigen::MatrixXd modes = built.basis.leftCols(30);
  const Eigen::MatrixXd product =
      modes.transpose() * RestStiffness(solver.assembly(), rest.u).times(built.basis);
  EXPECT_LT((product.leftCols(30) - Eigen::MatrixXd::Identity(30, 30)).lpNorm<Eigen::Infinity>(),
            1e-10);
  // That of a tool's response comes of a factor of single precision, refined to 1e-4 squared.
  const double of_tools = std::sqrt(built.model.tool_stiffness.norm());
  EXPECT_LT(product.rightCols(3).lpNorm<Eigen::Infinity>(), 1e-7 * of_tools);

  const PathError at_rest =
      measure_equilibria(built.model, solver, random_places(1, kReach, 20, 12345));
  EXPECT_GE(at_rest.num_compared, 15);
  EXPECT_EQ(at_rest.num_failed, 0);
  EXPECT_LT(at_rest.max, 0.004);
  (void)expect_moves_as_whole_body(built, block.scene, rheologies, tools, options.gravity);
}

// The bounds are those of a block that is fixed.
TEST(BuildReducedModel, OnSpringsInPlanesAndUnderATractionItIsAsTheWholeBody) {
  test::Block block = make_block(Law::neo_hookean);
  block.scene = test::supported(std::move(block.scene));
  const std::vector<Rheology> rheologies = {dense()};
  const std::vector<BondedPatch> tools = patches_of(block, 1);
  const BuiltModel built = build_reduced_model(block.scene, rheologies, tools, small_options(30));
  EXPECT_TRUE(built.within_tolerance) << built.residual;
  EquilibriumSolver solver(block.scene, {});
  EXPECT_EQ(built.rest, solver.settled().u);
  EXPECT_GT(built.rest.lpNorm<Eigen::Infinity>(), 0.1 * kReach);
  solver.set_interaction(as_list(tools));
  for (std::size_t p = 0; p < block.scene.body.held_directions.size(); ++p) {
    const Eigen::MatrixXd along = block.scene.body.held_directions[p].transpose() *
                                  built.basis.middleRows<3>(3 * static_cast<Eigen::Index>(p));
    // Rounding, of a row of the basis.
    ASSERT_LT(along.norm(), 1e-12 * built.basis.rowwise().norm().maxCoeff());
  }
  const PathError at_rest =
      measure_equilibria(built.model, solver, random_places(1, kReach, 20, 12345));
  EXPECT_GE(at_rest.num_compared, 15);
  EXPECT_EQ(at_rest.num_failed, 0);
  EXPECT_LT(at_rest.max, 0.004);
  (void)expect_moves_as_whole_body(built, block.scene, rheologies, tools);
  // As a file has it.
  const ReducedModel read = model_of(arrays_of(built.model));
  EXPECT_EQ(read.support_stiffness, built.model.support_stiffness);
  EXPECT_GT(read.support_stiffness.norm(), 0);
}

TEST(ReducedEnergy, OfSpringsIsThatOfTheWholeBody) {
  const Scene scene = test::supported(make_block(Law::neo_hookean).scene);
  const Assembly assembly(scene);
  const std::optional<PointMatrix> springs = springs_of(scene.body, assembly);
  ASSERT_TRUE(springs);
  const std::vector<BondedPatch> tools = patches_of(make_block(Law::neo_hookean), 1);
  const BuiltModel built = build_reduced_model(scene, {Rheology()}, tools, small_options(5));
  ReducedModel without = built.model;
  without.support_stiffness.resize(0, 0);
  ReducedEnergy with_springs(built.model);
  ReducedEnergy of_points(without);
  const Eigen::VectorXd y = 0.5 * built.model.trained_tools.maxCoeff() *
                            Eigen::VectorXd::LinSpaced(built.model.num_coordinates(), -1, 1);
  const NodalVector u = built.basis * y;
  const ReducedSums more = with_springs.linearise(y.data());
  const ReducedSums less = of_points.linearise(y.data());
  const NodalVector force = springs->times(u);
  const double energy = 0.5 * u.dot(force);
  constexpr double kRounding = 1e-9;
  EXPECT_NEAR(more.elastic - less.elastic, energy, kRounding * energy);
  EXPECT_NEAR(more.potential - less.potential, energy, kRounding * energy);
  const Eigen::VectorXd expected = built.basis.transpose() * force;
  EXPECT_LT((with_springs.force() - of_points.force() - expected).norm(),
            kRounding * expected.norm());
  const Eigen::VectorXd change =
      (with_springs.tangent() - of_points.tangent()).selfadjointView<Eigen::Lower>() * y;
  EXPECT_LT((change - expected).norm(), 1e-6 * with_springs.tangent().norm() * y.norm());
}

TEST(BuildReducedModel, IsTheSameForASeed) {
  const test::Block block = make_block(Law::neo_hookean);
  const std::vector<BondedPatch> tools = patches_of(block, 2);
  ReductionOptions options = small_options(10);
  const auto build = [&] { return build_reduced_model(block.scene, {dense()}, tools, options); };
  options.path_duration = 0.1;
  const BuiltModel one = build();
  const BuiltModel same = build();
  EXPECT_EQ(one.points, same.points);
  EXPECT_EQ(one.basis, same.basis);
  EXPECT_EQ(one.model.points.weights, same.model.points.weights);
  EXPECT_EQ(one.model.points.gradients, same.model.points.gradients);
  EXPECT_EQ(one.model.mass, same.model.mass);
  EXPECT_EQ(one.model.trained_modes, same.model.trained_modes);
  options.seed = 2;
  const BuiltModel other = build();
  EXPECT_NE(one.points, other.points);
}

TEST(BuildReducedModel, ItsBasisIsOrthonormalInTheStiffnessAtRest) {
  const test::Block block = make_block(Law::neo_hookean);
  const std::vector<BondedPatch> tools = patches_of(block, 2);
  const BuiltModel built = build_reduced_model(block.scene, {Rheology()}, tools, small_options(16));
  const Assembly assembly(block.scene);
  const Eigen::MatrixXd product =
      built.basis.transpose() * RestStiffness(assembly).times(built.basis);
  Eigen::MatrixXd expected = Eigen::MatrixXd::Identity(22, 22);
  expected.bottomRightCorner(6, 6) = built.model.tool_stiffness;
  EXPECT_LT((product - expected).topRows(16).lpNorm<Eigen::Infinity>(), 1e-8);
  EXPECT_LT((product - expected).norm(), 1e-8 * expected.norm());
  for (const BondedPatch& tool : tools) {
    for (const Index p : tool.points()) {
      EXPECT_EQ(built.basis.leftCols(16).middleRows(3 * Eigen::Index{p}, 3).norm(), 0);
    }
  }
}

TEST(HyperReduction, ItsWeightsStandForAllPointsOnTheTrainingStates) {
  const test::Block block = make_block(Law::neo_hookean);
  const std::vector<BondedPatch> tools = patches_of(block, 1);
  EquilibriumSolver solver(block.scene, {});
  solver.set_interaction(as_list(tools));
  const Equilibrium rest = solver.rest();
  const TrainingStates training = find_equilibria(solver, one_tool_places(1, kReach));
  const RestStiffness stiffness(solver.assembly());
  ModeBuilder modes(stiffness, rest.u.size());
  const Eigen::MatrixXd fields = training.u - rest.v * training.tools;
  modes.add(fields, 10);
  Eigen::MatrixXd basis(rest.u.size(), 13);
  basis << modes.modes(), rest.v;
  Eigen::MatrixXd states(13, fields.cols());
  states << modes.coordinates(fields), training.tools;
  const BodyPoints points(block.scene);
  EXPECT_NEAR(points.weights().sum(), volume(block.scene.body.mesh), 1e-12);
  for (const double tolerance : {1e-2, 1e-3}) {
    HyperReductionOptions options;
    options.tolerance = tolerance;
    const HyperReduction chosen =
        hyper_reduce(points, block.scene.organ.materials, basis, rest.stiffness, states, options);
    EXPECT_TRUE(chosen.converged);
    EXPECT_LE(chosen.residual, tolerance);
    EXPECT_LT(chosen.points.size(), 288u / 2);
    EXPECT_GT(chosen.weights.minCoeff(), 0);
    EXPECT_EQ(chosen.num_left_out, 0);
    // The force of the tool at the training states, by the assembly of the whole body.
    const ReducedModel model = make_reduced_model(block.scene, {Rheology()}, basis, rest.stiffness,
                                                  chosen.points, chosen.weights, states);
    ReducedEnergy energy(model.points, model.materials);
    double error = 0;
    double size = 0;
    for (Eigen::Index s = 0; s < states.cols(); ++s) {
      NodalVector force;
      (void)solver.assembly().residual(basis * states.col(s), force);
      const Eigen::VectorXd whole = basis.transpose() * force;
      (void)energy.evaluate(states.col(s).eval().data());
      error += (energy.force() - whole).tail<3>().squaredNorm();
      size += whole.tail<3>().squaredNorm();
    }
    EXPECT_LT(std::sqrt(error / size), 2 * tolerance);
  }
  // Of a body with many points some are drawn, among them those with the largest forces: of 60
  // that were drawn anywhere the residual would be 0.057.
  HyperReductionOptions options;
  options.tolerance = 2e-2;
  for (const Index most : {240, 60}) {
    options.max_candidates = most;
    const HyperReduction chosen =
        hyper_reduce(points, block.scene.organ.materials, basis, rest.stiffness, states, options);
    EXPECT_TRUE(chosen.converged) << chosen.residual;
    EXPECT_TRUE(std::is_sorted(chosen.points.begin(), chosen.points.end()));
    EXPECT_LT(chosen.points.size(), static_cast<std::size_t>(most));
  }
  // No state is left where the law is not defined in any.
  const Eigen::MatrixXd torn = 100 * states;
  EXPECT_THROW(
      (void)hyper_reduce(points, block.scene.organ.materials, basis, rest.stiffness, torn, {}),
      InputError);
}

TEST(BuildReducedModel, SaysWhatIsWrongWithItsInput) {
  const test::Block block = make_block(Law::neo_hookean);
  const std::vector<BondedPatch> tools = patches_of(block, 1);
  const auto build = [&](const Scene& scene, const std::vector<Rheology>& rheologies,
                         const std::vector<BondedPatch>& of, ReductionOptions options) {
    return test::message_of([&] { (void)build_reduced_model(scene, rheologies, of, options); });
  };
  const ReductionOptions options = small_options(5);
  EXPECT_NE(build(block.scene, {dense()}, {}, options).find("tool"), std::string::npos);
  EXPECT_NE(build(block.scene, {}, tools, options).find("rheologies"), std::string::npos);
  Scene mixed = block.scene;
  mixed.organ.materials[0] = make_isotropic(Law::neo_hookean, 5000, 0.49);
  EXPECT_NE(build(mixed, {dense()}, tools, options).find("pressure"), std::string::npos);
  Scene loose = block.scene;
  loose.body.fixed.assign(loose.body.fixed.size(), 0);
  EXPECT_NE(build(loose, {dense()}, tools, options).find("fixed"), std::string::npos);
  Rheology bad = dense();
  bad.density = -1;
  EXPECT_NE(build(block.scene, {bad}, tools, options).find("Density"), std::string::npos);
  EXPECT_NE(build(block.scene, {dense()}, {tools[0], tools[0]}, options), "");

  ReductionOptions heavy = options;
  heavy.gravity = Vec3(0, 0, -9.81);
  EXPECT_NE(build(block.scene, {Rheology()}, tools, heavy).find("no density"), std::string::npos);
  heavy.gravity = Vec3(-1e5, 0, 0);
  EXPECT_NE(build(block.scene, {dense()}, tools, heavy).find("finds no rest"), std::string::npos);
  heavy.gravity[1] = std::nan("");
  EXPECT_NE(build(block.scene, {dense()}, tools, heavy).find("BodyForce"), std::string::npos);

  Scene pressed = block.scene;
  pressed.body.applied_pressure.assign(pressed.body.fixed.size(), 100);
  EXPECT_NE(build(pressed, {dense()}, tools, options).find("AppliedPressure"), std::string::npos);

  ReductionOptions far = options;
  far.reach = 1e300;
  EXPECT_NE(build(block.scene, {dense()}, tools, far).find("Reach"), std::string::npos);
  ReductionOptions tiny = options;
  tiny.reach = 1e-300;
  EXPECT_NE(build(block.scene, {dense()}, tools, tiny).find("Reach is 1e-300 m"),
            std::string::npos);

  using O = ReductionOptions;
  const std::pair<const char*, std::function<void(O&)>> out_of_range[] = {
      {"Modes", [](O& o) { o.modes = 0; }},
      {"Tolerance", [](O& o) { o.tolerance = 0; }},
      {"MaximumPoints", [](O& o) { o.max_points = 0; }},
      {"TrainingPaths", [](O& o) { o.training_paths = 0; }},
      {"Reach", [](O& o) { o.reach = 0; }},
      {"PathDuration", [](O& o) { o.path_duration = -1; }},
      {"Bandwidth", [](O& o) { o.bandwidth = 0; }},
      {"Taps", [](O& o) { o.taps = -1; }},
      {"ShortestTap", [](O& o) { o.shortest_tap = 0; }},
      {"TimeStep", [](O& o) { o.time_step = 0; }},
      // What makes more than can be waited for, or nothing.
      {"TrainingPaths", [](O& o) { o.training_paths = 1'000'000'000; }},
      {"TimeStep", [](O& o) { o.time_step = 1e-9; }},
      {"TimeStep", [](O& o) { o.time_step = 1e-300; }},
      {"TimeStep", [](O& o) { o.time_step = 100; }},
      {"PathDuration", [](O& o) { o.path_duration = 1e9; }},
      {"PathDuration", [](O& o) { o.path_duration = 1e-300; }},
      {"Taps", [](O& o) { o.taps = 1e9; }},
      {"ShortestTap", [](O& o) { o.shortest_tap = 1e-300; }},
      {"ShortestTap", [](O& o) { o.shortest_tap = 1e300; }},
      {"Bandwidth", [](O& o) { o.bandwidth = 1e-300; }},
      {"AllToolsStates", [](O& o) { o.all_tools_states = 0; }}};
  EXPECT_NO_THROW(validate(options));
  for (const auto& [name, change] : out_of_range) {
    ReductionOptions changed = options;
    change(changed);
    EXPECT_NE(test::message_of([&] { validate(changed); }).find(name), std::string::npos) << name;
  }
}

TEST(BuildReducedModel, OfTheLinearLawHasNoModes) {
  const test::Block block = make_block(Law::linear);
  const BuiltModel built =
      build_reduced_model(block.scene, {Rheology()}, patches_of(block, 1), small_options(5));
  EXPECT_EQ(built.model.num_modes, 0);
  EXPECT_EQ(built.model.trained_modes.size(), 0);
  EXPECT_GT(built.model.trained_tools.minCoeff(), 0);
}

TEST(RandomPath, StaysWithinItsReachAndBeginsAtRest) {
  RandomPathOptions options;
  options.num_tools = 2;
  options.reach = 0.02;
  const ToolPath path = random_path(options, 3);
  EXPECT_EQ(path.num_coordinates(), 6);
  EXPECT_EQ(path.at(0), Eigen::VectorXd::Zero(6));
  double largest = 0;
  for (double t = 0; t < options.duration; t += 1e-3) {
    largest = std::max(largest, path.at(t).lpNorm<Eigen::Infinity>());
  }
  EXPECT_LE(largest, options.reach * (1 + 1e-12));
  EXPECT_GT(largest, 0.9 * options.reach);
  EXPECT_EQ(path.at(0.7), random_path(options, 3).at(0.7));
  EXPECT_NE(path.at(0.7), random_path(options, 4).at(0.7));
}

}  // namespace
}  // namespace palpate::test::test_build_reduced_model

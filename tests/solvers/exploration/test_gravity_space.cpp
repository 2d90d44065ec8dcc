// SPDX-License-Identifier: BSD-3-Clause
// Spaces of a body that rests under its weight or other loads: it is touched as it lies.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "base/error.h"
#include "equilibrium/equilibrium.h"
#include "exploration/precompute.h"
#include "exploration/state_solver.h"
#include "interaction/interaction_spec.h"
#include "interpolation/body_field.h"
#include "interpolation/display_field.h"
#include "interpolation/interpolator.h"
#include "solvers/exploration/equal_spaces.h"
#include "solvers/support/block.h"
#include "solvers/support/communicators.h"
#include "solvers/support/message_of.h"
#include "solvers/support/world_folder.h"
#include "storage/field_cache.h"
#include "storage/sqlite.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate::test::test_gravity_space {
namespace {

namespace fs = std::filesystem;

using test::expect_equal;

const Vec3 kGravity(1, 0, -9.81);

Scene heavy(const Scene& scene, double density, const Vec3& gravity = kGravity) {
  Rheology rheology;
  rheology.density = density;
  return with_gravity(scene, {rheology}, gravity);
}

class GravitySpace : public testing::Test {
 protected:
  void SetUp() override {
    scene_ = heavy(block_.scene, 400);
    options_.active_nodes = {block_.corner};
    options_.half_width = 0.01;
    options_.resolution = 5;
    options_.history = History::flat;
    options_.equilibrium.third_derivatives = true;
  }

  PrecomputeResult run(Communicator& communicator) const {
    return precompute(scene_, options_, communicator, progress_);
  }

  /// A run that ends before it is complete, and what another one makes of its file.
  PrecomputeResult run_in_two(Progress first) {
    progress_ = std::move(first);
    EXPECT_FALSE(run(*world_).report.complete);
    progress_ = nullptr;
    PrecomputeResult rest = run(*world_);
    EXPECT_TRUE(rest.report.complete);
    EXPECT_GT(rest.report.num_reused, 0);
    return rest;
  }

  /// The space of a run that was interrupted is that of one that was not, and so is what its file
  /// gives to who touches it.
  /// @returns On rank 0, the scene of the file.
  Scene expect_goes_on_from_its_file() {
    options_.keep = Keep::all;
    const PrecomputeResult whole = run(*world_);
    options_.file = folder_ / "space.palpate";
    const PrecomputeResult rest =
        run_in_two([](const ProgressState& state) { return state.share() < 0.5; });
    if (world_->rank() != 0) return {};
    expect_equal(rest.space, whole.space);
    const StateSpaceFile file = StateSpaceFile::open_read_only(options_.file);
    Scene read = file.read_scene();
    EXPECT_EQ(hash(read), hash(scene_));
    EXPECT_EQ(file.read_rest().u, whole.bodies[0].at_rest.u);
    const TouchSpace touched = make_touch_space(file);
    EXPECT_EQ(touched.surface.points, whole.space.surface.points);
    expect_equal(touched, whole.space);
    return read;
  }

  /// The message of the error that a run ends with.
  std::string error() const {
    return test::message_of([&] { (void)run(*world_); });
  }

  /// A rigid tool on the middle of the top.
  void press() {
    block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {5, 3, 3}});
    scene_ = heavy(block_.scene, 200);
    options_.active_nodes.clear();
    options_.contact.emplace();
    options_.contact->tool.radius = 0.015;
    // Smooth enough for these cells, also where contact begins.
    options_.contact->tool.law.thickness = 0.003;
    options_.contact->spacing = 0.005;
    options_.contact->shell.depth = 0.006;
    const NodalVector sag = aim();
    ASSERT_GT(sag.lpNorm<Eigen::Infinity>(), 0.005);
  }

  /// At where that middle is at rest. @returns The displacement there, m.
  NodalVector aim() {
    const Vec3 middle(0.065, 0.03, 0.05);
    Index on_top = 0;
    for (Index p = 0; p < scene_.body.mesh.num_points(); ++p) {
      const auto& points = scene_.body.mesh.points;
      if ((points[p] - middle).norm() < (points[on_top] - middle).norm()) on_top = p;
    }
    const EquilibriumSolver solver(scene_, {});
    const SettledBody at_rest{solver.settled().u, solver.settled().p};
    pressed_ = place_at_rest(scene_.body.mesh, at_rest, on_top);
    options_.contact->shell.region = [place = pressed_](const Vec3& at) {
      return (at - place).norm() < 0.012;
    };
    return at_rest.u;
  }

  /// The same equilibria, to the solver's tolerance.
  static void expect_alike(const TouchToolSpace& a, const TouchToolSpace& b) {
    constexpr double kAgreement = 1e-7;
    ASSERT_EQ(a.configurations.size(), b.configurations.size());
    const double largest = largest_force(a.configurations);
    for (std::size_t i = 0; i < a.configurations.size(); ++i) {
      EXPECT_LE((a.configurations[i].force - b.configurations[i].force).norm(),
                kAgreement * largest);
    }
  }

  /// The surface of the space is that of the body at rest.
  void expect_rest(const PrecomputeResult& result, const Equilibrium& rest) const {
    EXPECT_LT((result.bodies[0].at_rest.u - rest.u).lpNorm<Eigen::Infinity>(), 1e-12);
    const Surface& surface = result.space.surface;
    for (Index p = 0; p < surface.num_points(); ++p) {
      const Index point = surface.mesh_points[p];
      const Vec3 place =
          scene_.body.mesh.points[point] + rest.u.segment<3>(3 * Eigen::Index{point});
      EXPECT_LT((surface.points[p] - place).norm(), 1e-12);
    }
  }

  std::unique_ptr<Communicator> world_ = test::make_world();
  test::WorldFolder folder_{*world_};
  std::unique_ptr<Communicator> serial_ = make_serial_communicator();
  test::Block block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {4, 2, 2}});
  Scene scene_;
  Vec3 pressed_ = Vec3::Zero();
  PrecomputeOptions options_;
  Progress progress_;
};

TEST_F(GravitySpace, SeveralRanksGiveTheSpaceOfOneToTheBit) {
  const PrecomputeResult parallel = run(*world_);
  EXPECT_TRUE(parallel.report.complete);
  if (world_->rank() != 0) return;
  const PrecomputeResult serial = run(*serial_);
  expect_equal(parallel.space, serial.space);
}

// At displacements that were not computed, against the body under its weight itself.
TEST_F(GravitySpace, GivesForceAndShapeOfTheBodyThatSags) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  const PrecomputeResult result = run(*world_);
  EquilibriumSolver solver(scene_, {});
  const NodalVector sag = solver.settled().u;
  EXPECT_GT(sag.lpNorm<Eigen::Infinity>(), 0.5 * options_.half_width);
  expect_rest(result, solver.settled());
  const TouchToolSpace& space = result.space.tool_spaces.front();
  EXPECT_EQ(
      space.setup.interaction.material_point,
      scene_.body.mesh.points[block_.corner] + sag.segment<3>(3 * Eigen::Index{block_.corner}));
  const auto interpolator = make_interpolator(Method::energy_hermite, space);
  const DisplayField field(space);
  Eigen::VectorXf coefficients(field.num_modes());
  Eigen::VectorXf shown(space.modes.rows());
  solver.set_interaction(*InteractionFactory(scene_.body, {}).make(space.setup.interaction));
  const Equilibrium rest = solver.rest();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(-1, 1);
  double largest_force = 0;
  double force_error = 0;
  double shape_error = 0;
  for (int i = 0; i < 20; ++i) {
    const Vec3 t = options_.half_width * Vec3(share(random), share(random), share(random));
    const Equilibrium exact = solver.solve(t, rest);
    ASSERT_EQ(exact.outcome, Outcome::converged) << exact.summary.message;
    const TouchResult touch = interpolator->evaluate(t);
    largest_force = std::max(largest_force, exact.reaction.norm());
    force_error = std::max(force_error, (touch.force - exact.reaction).norm());
    EXPECT_EQ(field.coefficients(t, coefficients.data()), Support::inside);
    apply_modes(space.modes, coefficients.data(), shown.data());
    for (Index p = 0; p < result.space.surface.num_points(); ++p) {
      const Eigen::Index at = 3 * Eigen::Index{result.space.surface.mesh_points[p]};
      const Vec3 from_rest = (exact.u - sag).segment<3>(at);
      shape_error = std::max(
          shape_error, (from_rest - shown.segment<3>(3 * Eigen::Index{p}).cast<double>()).norm());
    }
  }
  // The bounds are those that the same body without weight keeps.
  EXPECT_LT(force_error, 0.002 * largest_force);
  EXPECT_LT(shape_error, 0.01 * options_.half_width);
  EXPECT_LT(interpolator->evaluate(Vec3::Zero()).force.norm(), 1e-7 * largest_force);
}

TEST_F(GravitySpace, GoesOnFromItsFileAndNoOtherBodyForceDoes) {
  const Scene read = expect_goes_on_from_its_file();
  if (world_->rank() == 0) {
    EXPECT_EQ(read.organ.body_force, kGravity);
    EXPECT_EQ(read.organ.densities, scene_.organ.densities);
  }
  const Scene right = scene_;
  for (const Vec3& other : {Vec3(0, 0, -9.81), Vec3(0, 0, 0)}) {
    scene_ = heavy(block_.scene, 400, other);
    EXPECT_NE(error().find("another scene"), std::string::npos) << error();
    EXPECT_NE(error().find("BodyForce"), std::string::npos) << error();
  }
  scene_ = heavy(block_.scene, 300);
  EXPECT_NE(error().find("another scene"), std::string::npos);
  scene_ = right;
  EXPECT_EQ(run(*world_).report.num_solved, 0);
  if (world_->rank() == 0) {
    const sqlite::Database database(options_.file, sqlite::Access::read_write);
    database.execute("UPDATE body_force SET checksum = checksum + 1");
  }
  agree(*world_, [] {});
  EXPECT_NE(error().find("damaged"), std::string::npos) << error();
}

// What is left of the fields is brought back to equilibria of the body that sags.
TEST_F(GravitySpace, AFinishedSpaceIsEnlarged) {
  const PrecomputeResult whole = run(*world_);
  for (const Keep keep : {Keep::touch, Keep::surface}) {
    options_.keep = keep;
    options_.file = folder_ / (std::string(name_of(keep)) + ".palpate");
    options_.half_width = 0.005;
    options_.resolution = 3;
    EXPECT_TRUE(run(*world_).report.complete);
    options_.half_width = 0.01;
    options_.resolution = 5;
    const PrecomputeResult larger = run(*world_);
    EXPECT_EQ(larger.report.num_reused, 27);
    EXPECT_EQ(larger.report.num_not_reached, 0);
    if (world_->rank() != 0) continue;
    expect_alike(larger.space.tool_spaces.front(), whole.space.tool_spaces.front());
    EXPECT_LE(larger.space.displacement_error,
              2 * kDefaultTouchBound * larger.space.largest_displacement);
  }
}

TEST_F(GravitySpace, OfMixedCellsHasThePressuresOfTheRest) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::linear, {3, 2, 2}, 0.1, 3000, 0.495});
  scene_ = heavy(block_.scene, 400);
  options_.active_nodes = {block_.corner};
  options_.resolution = 3;
  options_.keep = Keep::all;
  options_.file = folder_ / "space.palpate";
  const PrecomputeResult result = run(*world_);
  EXPECT_GT(result.bodies[0].at_rest.p.lpNorm<Eigen::Infinity>(), 0);
  FieldCache fields(options_.file, result.space.scene_hash);
  EXPECT_EQ(fields.read_body(kFirstBody).at_rest.p, result.bodies[0].at_rest.p);
  const TouchToolSpace& space = result.space.tool_spaces.front();
  EquilibriumSolver solver(scene_, {});
  solver.set_interaction(*InteractionFactory(scene_.body, {}).make(space.setup.interaction));
  const Vec3 t(0.01, 0, 0);
  const Equilibrium exact = solver.solve(t, solver.rest());
  ASSERT_EQ(exact.outcome, Outcome::converged);
  NodalVector u;
  NodalVector p;
  EXPECT_EQ(BodyField(space).evaluate(t, fields, Keep::all, u, p), Support::inside);
  EXPECT_LT((u + result.bodies[0].at_rest.u - exact.u).norm(), 1e-6 * exact.u.norm());
  EXPECT_LT((p + result.bodies[0].at_rest.p - exact.p).norm(), 1e-6 * exact.p.norm());
}

TEST_F(GravitySpace, ARigidToolPressesTheBodyThatSags) {
  press();
  options_.keep = Keep::all;
  options_.file = folder_ / "space.palpate";
  const PrecomputeResult result = run(*world_);
  EXPECT_TRUE(result.report.complete);
  EXPECT_EQ(result.report.num_not_reached, 0);
  if (world_->rank() != 0) return;
  EquilibriumSolver solver(scene_, {});
  expect_rest(result, solver.settled());
  const SettledBody& at_rest = result.bodies[0].at_rest;
  const TouchToolSpace& space = result.space.tool_spaces.front();
  const auto interpolator = make_interpolator(Method::energy_hermite, space);
  const BodyField field(space, interpolator->grid());
  FieldCache fields(options_.file, result.space.scene_hash);
  InteractionFactory tools(scene_.body, at_rest);
  const InteractionSpec& spec = space.setup.interaction;
  const auto clearance = tools.clearance(spec);
  solver.set_interaction(*tools.make(spec));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(-1, 1);
  double largest = 0;
  double force_error = 0;
  double shape_error = 0;
  double shape = 0;
  int num_pressed = 0;
  for (int i = 0; i < 60; ++i) {
    const Vec3 q = pressed_ + Vec3(0.01 * share(random), 0.01 * share(random),
                                   0.0125 + 0.0075 * share(random));
    const auto approach = clearance->approach(q);
    if (approach.depth > options_.contact->shell.depth ||
        !options_.contact->shell.region(approach.touched)) {
      continue;
    }
    const TouchResult touch = interpolator->evaluate(q);
    const Equilibrium exact = solver.solve(q, solver.rest(clearance->start_for(q)));
    ASSERT_EQ(exact.outcome, Outcome::converged);
    largest = std::max(largest, exact.reaction.norm());
    force_error = std::max(force_error, (exact.reaction - touch.force).norm());
    NodalVector u;
    NodalVector p;
    if (field.evaluate(q, fields, Keep::all, u, p) == Support::none) u = 0 * exact.u;
    shape_error = std::max(shape_error, (u + result.bodies[0].at_rest.u - exact.u).norm());
    shape = std::max(shape, (exact.u - result.bodies[0].at_rest.u).norm());
    if (approach.depth > 0) ++num_pressed;
  }
  EXPECT_GT(num_pressed, 10);
  // The bounds are those of the body without weight.
  EXPECT_LT(force_error, 0.02 * largest);
  EXPECT_LT(shape_error, 0.05 * shape);
  // Where the tool is clear of the body as it sags, though not of its mesh.
  Vec3 away = pressed_;
  while (clearance->clearance(away) <= 0) away.z() += 0.0005;
  EXPECT_LT(InteractionFactory(scene_.body, {}).clearance(spec)->clearance(away), 0);
  EXPECT_LT(interpolator->evaluate(away).force.norm(), 0.02 * largest);
}

TEST_F(GravitySpace, AToolThatIsJustClearOfTheBodyThatSagsTouchesNothing) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  block_ = test::make_block(Law::neo_hookean, {ElementOrder::quadratic, {4, 2, 2}});
  const Scene scene = heavy(block_.scene, 400);
  EquilibriumSolver solver(scene, {});
  const SettledBody at_rest{solver.settled().u, solver.settled().p};
  ASSERT_GT(at_rest.u.lpNorm<Eigen::Infinity>(), 0.01);
  RigidTool tool;
  tool.radius = 0.015;
  InteractionFactory tools(scene.body, at_rest);
  const InteractionSpec spec = rigid_contact_spec(with_defaults(tool, scene));
  solver.set_interaction(*tools.make(spec));
  const auto clearance = tools.clearance(spec);
  int num_tested = 0;
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    // The face that is held is not felt: the tool would be inside the body there.
    if (scene.body.fixed[p] != 0) continue;
    const Vec3 on_body = place_at_rest(scene.body.mesh, at_rest, p);
    const std::optional<Vec3> start = clearance->find_start(on_body);
    if (!start) continue;
    Vec3 touches = on_body;
    Vec3 clear = *start;
    for (int i = 0; i < 30; ++i) {
      const Vec3 middle = 0.5 * (touches + clear);
      (clearance->clearance(middle) > 0 ? clear : touches) = middle;
    }
    EXPECT_NO_THROW((void)solver.rest(clear)) << clear.transpose();
    ++num_tested;
  }
  EXPECT_GT(num_tested, 50);
}

// Older files have the fields of such a state, and as its energy what rounding has left.
TEST_F(GravitySpace, AStateThatTouchesNothingIsFoundAgainFromWhatOlderFilesHaveOfIt) {
  if (test::is_repetition(*world_)) GTEST_SKIP() << "it is the same on any number of ranks";
  press();
  EquilibriumSolver solver(scene_, {});
  const SettledBody at_rest{solver.settled().u, solver.settled().p};
  InteractionFactory tools(scene_.body, at_rest);
  ToolSpaceSetup setup;
  setup.id = kContactToolSpace;
  setup.interaction = rigid_contact_spec(with_defaults(options_.contact->tool, scene_));
  const SpaceBody body = make_space_body(scene_, at_rest);
  InteractionSolver states(body, solver, tools);
  const Vec3 away = tools.clearance(setup.interaction)->start_for(pressed_);
  Equilibrium near = states.begin(setup, away, Tangent::factorised);
  EXPECT_EQ(near.flags, flags::touches_nothing);
  EXPECT_EQ(near.energy, 0);
  near.flags = 0;
  near.energy = 1e-17;
  const Equilibrium found = states.restore(setup, near, Keep::touch);
  EXPECT_EQ(found.outcome, Outcome::converged) << found.summary.message;
  EXPECT_LT((found.u - at_rest.u).norm(), 1e-8 * at_rest.u.norm());
  near.reaction = Vec3(0, 0, -1);
  EXPECT_EQ(states.restore(setup, near, Keep::touch).outcome, Outcome::not_converged);
}

TEST_F(GravitySpace, ARigidToolGoesOnFromItsFile) {
  press();
  options_.contact->spacing = 0.0075;
  const PrecomputeResult whole = run(*world_);
  options_.file = folder_ / "space.palpate";
  const PrecomputeResult rest =
      run_in_two([](const ProgressState& state) { return state.num_solved < 20; });
  if (world_->rank() == 0) {
    expect_alike(rest.space.tool_spaces.front(), whole.space.tool_spaces.front());
  }
}

TEST_F(GravitySpace, ABodyWithoutDensityOrRestIsOneClearError) {
  options_.file = folder_ / "space.palpate";
  scene_ = heavy(block_.scene, 0);
  EXPECT_NE(error().find("no density"), std::string::npos) << error();
  scene_ = heavy(block_.scene, 1e6);
  EXPECT_NE(error().find("finds no rest"), std::string::npos) << error();
  EXPECT_NE(error().find("BodyForce"), std::string::npos) << error();
  EXPECT_FALSE(fs::exists(options_.file));
}

/// Springs below, a pressure from all sides, a pull above, and points that slide in planes.
Scene with_surface_loads(Scene scene) {
  const std::size_t n = scene.body.mesh.points.size();
  scene.body.applied_pressure.assign(n, 60);
  scene.body.support_stiffness.assign(n, 0);
  scene.body.applied_traction.assign(n, Vec3::Zero());
  scene.body.held_directions.assign(n, HeldDirections::Zero());
  // The block is warped by less than this.
  constexpr double kNear = 0.004;
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    if (x.z() < kNear) scene.body.support_stiffness[p] = 2e4;
    if (x.z() > 0.05 - kNear) scene.body.applied_traction[p] = Vec3(20, 10, -60);
    if (x.y() < kNear) scene.body.held_directions[p].col(0) = Vec3(0, 1, 0.1);
  }
  check(scene);
  return scene;
}

class LoadedSpace : public GravitySpace {
 protected:
  void SetUp() override {
    GravitySpace::SetUp();
    scene_ = with_surface_loads(block_.scene);
  }
};

TEST_F(LoadedSpace, SeveralRanksGiveTheSpaceOfOneToTheBit) {
  const PrecomputeResult parallel = run(*world_);
  EXPECT_TRUE(parallel.report.complete);
  EXPECT_EQ(parallel.report.num_not_reached, 0);
  if (world_->rank() != 0) return;
  const PrecomputeResult serial = run(*serial_);
  expect_equal(parallel.space, serial.space);
  EquilibriumSolver solver(scene_, {});
  expect_rest(serial, solver.settled());
  // In between, against the body itself.
  const TouchToolSpace& space = serial.space.tool_spaces.front();
  solver.set_interaction(*InteractionFactory(scene_.body, {}).make(space.setup.interaction));
  const Vec3 t(0.004, -0.006, 0.003);
  const Equilibrium exact = solver.solve(t, solver.rest());
  const auto interpolator = make_interpolator(Method::energy_hermite, space);
  EXPECT_LT((interpolator->evaluate(t).force - exact.reaction).norm(),
            0.002 * exact.reaction.norm());
}

TEST_F(LoadedSpace, GoesOnFromItsFileAndNoOtherLoadDoes) {
  const Scene read = expect_goes_on_from_its_file();
  if (world_->rank() == 0) {
    EXPECT_EQ(read.body.held_directions, scene_.body.held_directions);
    EXPECT_EQ(read.body.support_stiffness, scene_.body.support_stiffness);
    EXPECT_EQ(read.body.applied_pressure, scene_.body.applied_pressure);
    EXPECT_EQ(read.body.applied_traction, scene_.body.applied_traction);
  }
  const Scene right = scene_;
  for (int change = 0; change < 4; ++change) {
    scene_ = right;
    if (change == 0) scene_.body.applied_pressure.assign(scene_.body.applied_pressure.size(), 61);
    if (change == 1) scene_.body.applied_traction.clear();
    if (change == 2)
      scene_.body.support_stiffness.assign(scene_.body.support_stiffness.size(), 1e4);
    if (change == 3) scene_.body.held_directions.clear();
    EXPECT_NE(error().find("another scene"), std::string::npos) << error();
  }
  scene_ = right;
  EXPECT_EQ(run(*world_).report.num_solved, 0);
  for (const char* damage :
       {"UPDATE boundary_array SET checksum = checksum + 1 WHERE name = 'AppliedPressure'",
        "UPDATE boundary_array SET numbers = NULL, checksum = 0 WHERE name = 'RestDisplacement'",
        "DELETE FROM boundary_array"}) {
    if (world_->rank() == 0) {
      const sqlite::Database database(options_.file, sqlite::Access::read_write);
      database.execute(damage);
    }
    agree(*world_, [] {});
    EXPECT_NE(error().find("damaged"), std::string::npos) << error();
  }
}

// With its weight too.
TEST_F(LoadedSpace, ARigidToolPressesTheBodyAsItLies) {
  press();
  scene_ = with_surface_loads(scene_);
  EXPECT_GT(aim().lpNorm<Eigen::Infinity>(), 0.001);
  options_.contact->spacing = 0.0075;
  options_.file = folder_ / "space.palpate";
  const PrecomputeResult result = run(*world_);
  EXPECT_TRUE(result.report.complete);
  EXPECT_EQ(result.report.num_not_reached, 0);
  if (world_->rank() != 0) return;
  EquilibriumSolver solver(scene_, {});
  expect_rest(result, solver.settled());
  const TouchToolSpace& space = result.space.tool_spaces.front();
  const SettledBody& at_rest = result.bodies[0].at_rest;
  InteractionFactory tools(scene_.body, at_rest);
  const InteractionSpec& spec = space.setup.interaction;
  solver.set_interaction(*tools.make(spec));
  const double largest = largest_force(space.configurations);
  int num_pressed = 0;
  for (const auto& configuration : space.configurations) {
    if (configuration.force.norm() < 0.3 * largest) continue;
    const Equilibrium exact = solver.solve(
        configuration.t, solver.rest(tools.clearance(spec)->start_for(configuration.t)));
    ASSERT_EQ(exact.outcome, Outcome::converged);
    EXPECT_LT((exact.reaction - configuration.force).norm(), 1e-6 * largest);
    if (++num_pressed == 5) break;
  }
  EXPECT_EQ(num_pressed, 5);
  EXPECT_EQ(hash(StateSpaceFile::open_read_only(options_.file).read_scene()), hash(scene_));
}

TEST(HashOfGravity, TakesInForceAndDensitiesWhereThereIsOne) {
  const Scene scene = test::make_block(Law::neo_hookean, {ElementOrder::linear, {2, 1, 1}}).scene;
  EXPECT_EQ(hash(heavy(scene, 400, Vec3::Zero())), hash(scene));
  const std::string one = hash(heavy(scene, 400));
  EXPECT_NE(one, hash(scene));
  EXPECT_NE(one, hash(heavy(scene, 401)));
  EXPECT_NE(one, hash(heavy(scene, 400, Vec3(0, 0, -9.81))));
  EXPECT_EQ(one, hash(heavy(scene, 400)));
}

}  // namespace
}  // namespace palpate::test::test_gravity_space

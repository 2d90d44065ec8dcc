// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/transfer.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "base/error.h"
#include "solvers/support/block.h"

namespace palpate::test::test_transfer {
namespace {

template <class T>
bool is_refused(const Bytes& bytes) {
  try {
    (void)Unpacker(bytes).take<T>();
  } catch (const BackendError&) {
    return true;
  }
  return false;
}

/// The first number of the bytes is a size; it is replaced.
Bytes with_size(Bytes bytes, std::size_t place, std::int64_t size) {
  std::memcpy(bytes.data() + place * sizeof size, &size, sizeof size);
  return bytes;
}

template <class T>
Bytes bytes_of(const T& value) {
  Packer packer;
  packer.put(value);
  return packer.take();
}

template <class T>
void expect_bounded(const T& value, std::size_t num_sizes) {
  const Bytes whole = bytes_of(value);
  EXPECT_EQ(Unpacker(whole).take<T>(), value);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_TRUE(is_refused<T>(Bytes(whole.begin(), whole.begin() + static_cast<int>(size))))
        << size;
  }
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  for (std::size_t place = 0; place < num_sizes; ++place) {
    for (const std::int64_t size : {kMost, kMost / 2 + 1, std::int64_t{1} << 40, std::int64_t{-1},
                                    std::numeric_limits<std::int64_t>::min()}) {
      EXPECT_TRUE(is_refused<T>(with_size(whole, place, size))) << place << ' ' << size;
    }
  }
}

// Nothing is read beyond the end, and nothing is made of a size that the bytes have not.
TEST(Transfer, WhatIsDamagedIsRefused) {
  expect_bounded(std::vector<double>{1, 2, 3}, 1);
  expect_bounded(std::vector<std::vector<int>>{{1}, {2, 3}}, 2);
  expect_bounded(std::map<int, double>{{1, 2.0}, {3, 4.0}}, 1);
  expect_bounded(Eigen::MatrixXd(Eigen::MatrixXd::Random(3, 2)), 2);
  expect_bounded(Eigen::VectorXd(Eigen::VectorXd::Random(3)), 2);
  expect_bounded(std::int64_t{7}, 0);
}

TEST(Transfer, AMatrixWithoutValuesHasBoundsToo) {
  const Eigen::MatrixXd none(0, 3);
  const Bytes bytes = bytes_of(none);
  const auto back = Unpacker(bytes).take<Eigen::MatrixXd>();
  EXPECT_EQ(back.cols(), 3);
  EXPECT_TRUE(is_refused<Eigen::MatrixXd>(with_size(bytes, 1, std::int64_t{1} << 62)));
  // A vector has one column.
  EXPECT_TRUE(is_refused<Eigen::VectorXd>(bytes));
}

TEST(Transfer, AMapIsInItsOrder) {
  const Bytes bytes = bytes_of(std::map<std::int64_t, std::int64_t>{{1, 2}, {3, 4}});
  EXPECT_TRUE((is_refused<std::map<std::int64_t, std::int64_t>>(with_size(bytes, 3, 1))));
}

TEST(Transfer, WhatIsNoValueOfItsTypeIsRefused) {
  EXPECT_TRUE(is_refused<bool>({std::byte{2}}));
  Bytes outcome = bytes_of(Outcome::converged);
  EXPECT_FALSE(is_refused<Outcome>(outcome));
  outcome.front() = std::byte{100};
  EXPECT_TRUE(is_refused<Outcome>(outcome));
}

/// A number for each member that has room for it, so that none is like another.
ConfigurationSummary some_summary() {
  ConfigurationSummary c;
  c.check_point = {1, -2, 3};
  c.parent = {0, -2, 3};
  c.t = Vec3(1e-3, 2e-3, 3e-3);
  c.energy = 4;
  c.force = Vec3(5, 6, 7);
  c.stiffness = 8 * Mat3::Identity();
  c.third_derivative.setConstant(9);
  c.outcome = Outcome::converged;
  c.flags = flags::unstable;
  c.signature = Vec3(10, 11, 12);
  c.reached[5] = 13;
  c.seconds = 14;
  return c;
}

Configuration some_configuration() {
  Configuration c;
  static_cast<ConfigurationSummary&>(c) = some_summary();
  c.u = Eigen::VectorXd::LinSpaced(12, 0, 1);
  c.v = Eigen::MatrixXd::Constant(12, 3, 2);
  c.p = Eigen::VectorXd::Ones(2);
  c.p_v = Eigen::MatrixXd::Ones(2, 3);
  return c;
}

ToolSpaceSetup some_setup() {
  ToolSpaceSetup setup;
  setup.id = -1;
  setup.interaction.kind = InteractionKind::rigid_contact;
  setup.interaction.tool.shape = ToolShape::surface;
  setup.interaction.tool.points = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY()};
  setup.interaction.tool.triangles = {{0, 1, 2}};
  setup.grid = {0.01, 5, 2, Vec3(1, 2, 3), true};
  setup.policy.history = History::levels;
  return setup;
}

TestPoint some_test_point() {
  TestPoint point;
  point.kind = TestKind::walk;
  point.number = 3;
  point.displacement = Eigen::VectorXf::Ones(6);
  return point;
}

FieldBasis some_basis() {
  FieldBasis basis;
  basis.keep = Keep::surface;
  basis.modes = Eigen::MatrixXf::Ones(6, 2);
  basis.pressure_modes = Eigen::MatrixXf::Ones(2, 1);
  return basis;
}

/// Every beginning of the message is refused, and of bytes that were changed anything is made, or
/// they are refused: nothing else is thrown, as there would be for want of memory.
template <class T>
void expect_robust(const T& value) {
  const Bytes whole = bytes_of(value);
  EXPECT_EQ(bytes_of(Unpacker(whole).take<T>()), whole);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_TRUE(is_refused<T>(Bytes(whole.begin(), whole.begin() + static_cast<int>(size))))
        << size;
  }
  std::mt19937 random(5);
  for (std::size_t place = 0; place < whole.size(); ++place) {
    for (const unsigned value_of_byte :
         {0U, 1U, 0x7fU, 0x80U, 0xffU, static_cast<unsigned>(random() % 256U)}) {
      Bytes changed = whole;
      changed[place] = static_cast<std::byte>(value_of_byte);
      ASSERT_NO_THROW((void)is_refused<T>(changed)) << place << ' ' << value_of_byte;
    }
  }
}

TEST(Transfer, EveryMessageIsRobust) {
  expect_robust(some_summary());
  expect_robust(some_configuration());
  expect_robust(std::vector<Configuration>{some_configuration(), some_configuration()});
  expect_robust(some_setup());
  expect_robust(std::vector<ToolSpaceSetup>{some_setup()});
  expect_robust(std::vector<std::vector<TestPoint>>{{some_test_point()}, {}});
  expect_robust(std::vector<IntermediateState>(2));
  expect_robust(std::vector<LevelTransition>(2));
  expect_robust(std::vector<StateKey>(2));
  expect_robust(std::vector<FieldScale>(2));
  expect_robust(some_basis());
  expect_robust(Snapshots(2, 1, 1));
  expect_robust(std::map<Outcome, std::int64_t>{{Outcome::converged, 1}});
  expect_robust(SettledBody{NodalVector::Ones(3), NodalVector::Ones(1)});
}

// The mesh has the lists of lists; a small one will do.
TEST(Transfer, AScene) {
  Scene scene;
  scene.body.mesh.points = {Vec3::Zero(), Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};
  scene.body.mesh.cells = {0, 1, 2, 3};
  scene.organ.materials = {make_isotropic(Law::neo_hookean, 1e4, 0.3)};
  scene.body.material_of_cell = {0};
  scene.body.fixed = {1, 1, 1, 0};
  scene.body.touchable = {0, 0, 0, 1};
  scene.organ.densities = {1000};
  expect_robust(scene);
  expect_robust(std::vector<Rheology>(2));
}

}  // namespace
}  // namespace palpate::test::test_transfer

// SPDX-License-Identifier: BSD-3-Clause
// A body that is assembled in several sets of packets: f and K are derivatives of the energy, and
// the same to the bit for any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "assembly/assembly.h"
#include "assembly/packet_sets.h"
#include "solvers/support/block.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"
#include "threads/thread_team.h"

namespace palpate::test::test_threads {
namespace {

/// Of a central difference with steps of a thousandth of an edge, relative to what it stands for.
constexpr double kDifference = 1e-5;

/// Of sums over some thousand cells.
constexpr double kRounding = 1e-12;

/// Two tissues, the one above the other.
Scene layered_scene(ElementOrder order, std::array<int, 3> cells, Law above,
                    Formulation formulation = Formulation::displacement) {
  BlockOptions options;
  options.order = order;
  options.cells = cells;
  Scene scene = make_block(Law::neo_hookean, options).scene;
  Material other = make_isotropic(above, 9e3, 0.4);
  scene.organ.materials = {with_formulation(scene.organ.materials.front(), formulation),
                           with_formulation(other, formulation)};
  scene.body.material_of_cell.resize(static_cast<std::size_t>(scene.body.mesh.num_cells()));
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    const double height = scene.body.mesh.points[scene.body.mesh.cell(c)[0]].z();
    scene.body.material_of_cell[c] = height > scene.body.mesh.points.back().z() / 2 ? 1 : 0;
  }
  return scene;
}

struct Derivatives {
  double energy;
  double minimum_det_f;
  NodalVector force;
  std::vector<double> values;
  /// Those of residual(), whose kernel may round otherwise.
  double energy_alone;
  NodalVector force_alone;
  bool operator==(const Derivatives& other) const {
    return energy == other.energy && minimum_det_f == other.minimum_det_f && force == other.force &&
           values == other.values && energy_alone == other.energy_alone &&
           force_alone == other.force_alone;
  }
};

Derivatives derivatives_at(const Assembly& assembly, const NodalVector& state) {
  Derivatives result;
  const auto [energy, least] = assembly.tangent(state, result.force, result.values);
  result.energy = energy;
  result.minimum_det_f = least;
  result.energy_alone = assembly.residual(state, result.force_alone).energy;
  EXPECT_NEAR(result.energy_alone, energy, kRounding * energy);
  EXPECT_LT((result.force_alone - result.force).norm(), kRounding * result.force.norm());
  return result;
}

void expect_right(const Scene& scene) {
  const Assembly assembly(scene);
  Random random(81);
  const double step = 1e-3 * assembly.mean_edge();
  const NodalVector state = 20 * step * random.vector(assembly.state_size(), 1);
  const Derivatives alone = derivatives_at(assembly, state);
  for (const int threads : {2, 3, 4}) {
    const auto team = make_thread_team(threads);
    EXPECT_TRUE(with_team(team.get(), [&] { return derivatives_at(assembly, state); }) == alone)
        << threads << " threads";
    EXPECT_EQ(with_team(team.get(), [&] { return assembly.minimum_det_f_of_cells(state); }),
              assembly.minimum_det_f_of_cells(state));
    EXPECT_EQ(with_team(team.get(), [&] { return assembly.stress_sums(state); }),
              assembly.stress_sums(state));
  }
  // Along a random direction of the unknowns.
  const auto& places = assembly.state_of_unknown();
  const Eigen::VectorXd along = random.vector(static_cast<Eigen::Index>(places.size()), 1);
  NodalVector direction = NodalVector::Zero(state.size());
  for (std::size_t i = 0; i < places.size(); ++i) direction[places[i]] = along[i];
  const Derivatives before = derivatives_at(assembly, state - step * direction);
  const Derivatives after = derivatives_at(assembly, state + step * direction);
  const double slope = (after.energy - before.energy) / (2 * step);
  EXPECT_NEAR(slope, alone.force.dot(direction),
              kDifference * alone.force.norm() * direction.norm());
  const NodalVector change = (after.force - before.force) / (2 * step);
  const SymmetricPattern& pattern = assembly.pattern();
  Eigen::VectorXd product = Eigen::VectorXd::Zero(pattern.size);
  Eigen::VectorXd expected(pattern.size);
  for (Index c = 0; c < pattern.size; ++c) {
    expected[c] = change[places[c]];
    for (Index i = pattern.column_start[c]; i < pattern.column_start[c + 1]; ++i) {
      product[pattern.row[i]] += alone.values[i] * along[c];
      if (pattern.row[i] != c) product[c] += alone.values[i] * along[pattern.row[i]];
    }
  }
  EXPECT_LT((product - expected).norm(), 10 * kDifference * expected.norm());
}

TEST(Threads, OfQuadraticCells) {
  expect_right(layered_scene(ElementOrder::quadratic, {10, 10, 10}, Law::st_venant_kirchhoff));
}

TEST(Threads, OfMixedCells) {
  expect_right(
      layered_scene(ElementOrder::quadratic, {10, 10, 10}, Law::neo_hookean, Formulation::mixed));
}

TEST(Threads, OfLinearCells) {
  expect_right(layered_scene(ElementOrder::linear, {20, 20, 21}, Law::st_venant_kirchhoff));
}

TEST(PacketSets, OfOneColourShareNoPoint) {
  const Scene scene = layered_scene(ElementOrder::quadratic, {8, 8, 8}, Law::neo_hookean);
  const TetMesh& mesh = scene.body.mesh;
  constexpr Index kPacket = 8;
  const Index num_packets = mesh.num_cells() / kPacket;
  ASSERT_EQ(num_packets * kPacket, mesh.num_cells());
  const Index per_packet = kPacket * nodes_per_cell(mesh.order);
  const PacketSets sets = make_coloured_sets(num_packets, mesh.cells, mesh.num_points());
  EXPECT_EQ(sets.start.back(), num_packets);
  std::vector<Index> seen;
  for (const std::vector<Index>& colour : sets.colours) {
    std::vector<Index> taken(mesh.num_points(), -1);
    for (const Index set : colour) {
      seen.push_back(set);
      for (Index i = sets.start[set] * per_packet; i < sets.start[set + 1] * per_packet; ++i) {
        Index& by = taken[mesh.cells[i]];
        EXPECT_TRUE(by == -1 || by == set);
        by = set;
      }
    }
  }
  std::sort(seen.begin(), seen.end());
  for (Index set = 0; set < sets.num_sets(); ++set) EXPECT_EQ(seen[set], set);
}

TEST(PacketSets, ASmallBodyIsOne) {
  const PacketSets sets = make_one_set(7);
  EXPECT_EQ(sets.start, (std::vector<Index>{0, 7}));
  EXPECT_EQ(sets.colours, (std::vector<std::vector<Index>>{{0}}));
}

}  // namespace
}  // namespace palpate::test::test_threads

// SPDX-License-Identifier: BSD-3-Clause
// Every instruction set that this processor has gives the same results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/simd.h"
#include "soft_contact/contact_neighbours.h"
#include "soft_contact/kernels.h"
#include "solvers/support/random.h"
#include "solvers/support/two_blocks.h"

namespace palpate {

namespace baseline {
const ContactKernels& contact_kernels();
}
#if defined(__x86_64__)
namespace avx2 {
const ContactKernels& contact_kernels();
}
namespace avx512 {
const ContactKernels& contact_kernels();
}
#endif

namespace test::test_contact_instruction_sets {
namespace {

/// Fused multiplication and addition rounds once where the baseline rounds twice.
constexpr double kRounding = 1e-12;

struct Results {
  std::vector<double> points;
  std::vector<double> sums;
  std::vector<unsigned char> rows;
  std::vector<double> gradient;
  std::vector<double> of_nodes;
  std::vector<char> seen;
  std::vector<double> tangent;
};

/// Two blocks, the upper one a little inside the lower one, with random derivatives by the sums.
Results run(const ContactKernels& kernels, double turn) {
  TwoBlocksOptions options;
  options.order = ElementOrder::quadratic;
  const Scene scene = make_two_blocks(options);
  constexpr double kSpacing = 0.001;
  constexpr double kReach = 2.8 * kSpacing;
  const std::size_t num_faces = boundary_triangles(scene.body.mesh).size();
  std::vector<double> reaches(num_faces, kReach);
  for (std::size_t f = 0; f < num_faces; f += 2) reaches[f] = 1.3 * kReach;
  const ContactPoints surface(scene.body, std::vector<double>(num_faces, kSpacing), reaches);
  const TouchRule rule(surface, TouchingParts::others);
  Random random(3);
  const auto size = 3 * static_cast<Eigen::Index>(surface.rest().size());
  const NodalVector state = random.vector(size, turn);
  const ContactNeighbours near = find_neighbours(surface, rule, state, 0.5 * kReach);
  const NearPacketsView view = near.view();
  const int per_face = surface.nodes_per_face();

  std::vector<std::int32_t> nodes;
  std::vector<const ShapePacket*> shapes;
  std::vector<double> all_areas;
  for (Index p = 0; p < surface.num_points(); ++p) all_areas.push_back(surface.area(p));
  std::vector<const double*> areas;
  std::vector<double> reaches_near;
  for (const Index face : near.faces) {
    nodes.insert(nodes.end(), surface.nodes(face), surface.nodes(face) + per_face);
    shapes.push_back(surface.shapes(face));
    areas.push_back(&all_areas[surface.first_point(face)]);
    reaches_near.push_back(reaches[face]);
  }
  const ContactFacesView faces{static_cast<std::int32_t>(near.faces.size()),
                               per_face,
                               nodes.data(),
                               near.first_packet.data(),
                               shapes.data(),
                               areas.data(),
                               reaches_near.data()};
  NodalVector places(size);
  for (std::size_t n = 0; n < surface.rest().size(); ++n) {
    places.segment<3>(3 * static_cast<Eigen::Index>(n)) =
        surface.node_place(static_cast<Index>(n), state);
  }
  std::vector<PointPacket> points(near.num_packets());
  kernels.features(faces, places.data(), points.data());

  const std::size_t num_points = near.num_packets() * kPacketSize;
  std::vector<double> s(num_points);
  std::vector<double> p(num_points);
  Results results;
  results.rows.assign(near.others.size(), 0);
  kernels.sums(points.data(), view, 1, s.data(), p.data(), results.rows.data());
  std::vector<char> acts(num_points, 0);
  std::vector<double> jet(5 * num_points, 0.0);
  for (std::size_t i = 0; i < num_points; ++i) {
    if (points[i / kPacketSize].area[i % kPacketSize] == 0) continue;
    results.sums.push_back(s[i]);
    results.sums.push_back(p[i]);
    acts[i] = i % 3 != 0 ? 1 : 0;
    for (int k = 0; k < 5 && acts[i] != 0; ++k) {
      jet[k * num_points + i] = random.uniform(0.5, 1) * (k < 2 ? -1 : 1);
    }
  }
  const JetView jets{&jet[0], &jet[num_points], &jet[2 * num_points], &jet[3 * num_points],
                     &jet[4 * num_points]};
  results.gradient.resize(6 * num_points);
  kernels.gradient(points.data(), view, results.rows.data(), jets, results.gradient.data());
  results.of_nodes.assign(static_cast<std::size_t>(size), 0.0);
  kernels.to_nodes(faces, points.data(), results.gradient.data(), results.of_nodes.data());
  results.seen.assign(near.others.size(), 0);
  kernels.find_seen(points.data(), view, 1, acts.data(), results.seen.data());

  // The first packet that sees some, with a clique in which each face has nodes of its own.
  std::vector<CurvaturePacket> curvature(near.num_packets(), CurvaturePacket{});
  for (std::size_t packet = 0; packet < near.num_packets() && results.tangent.empty(); ++packet) {
    std::vector<std::int32_t> others;
    std::vector<const ShapePacket*> shapes_seen;
    std::vector<std::uint64_t> allowed;
    std::vector<std::int32_t> face_seen;
    std::int32_t last_face = -1;
    for (std::size_t k = near.first[packet]; k < near.first[packet + 1]; ++k) {
      if (results.seen[k] == 0) continue;
      const std::int32_t face = near.face_of[near.others[k]];
      face_seen.push_back(face == last_face ? face_seen.back()
                                            : (face_seen.empty() ? 1 : face_seen.back() + 1));
      last_face = face;
      others.push_back(near.others[k]);
      shapes_seen.push_back(surface.shapes(near.faces[face]) + near.others[k] -
                            near.first_packet[face]);
      allowed.push_back(near.allowed[k]);
    }
    if (others.empty()) continue;
    const std::int32_t num_nodes = (1 + face_seen.back()) * per_face;
    std::vector<std::uint16_t> in_clique;
    for (std::int32_t n = 0; n < num_nodes; ++n) in_clique.push_back(static_cast<std::uint16_t>(n));
    const std::int32_t face = near.face_of[packet];
    const auto rows = clique_rows(static_cast<std::size_t>(num_nodes));
    std::vector<double> room(group_room(static_cast<std::size_t>(num_nodes)));
    std::vector<double> matrix(rows * rows);
    kernels.couple({static_cast<std::int32_t>(packet), per_face,
                    surface.shapes(near.faces[face]) + packet - near.first_packet[face],
                    static_cast<std::int32_t>(others.size()), others.data(), shapes_seen.data(),
                    allowed.data(), face_seen.data(), in_clique.data(), num_nodes},
                   points.data(), jets, curvature.data(), room.data(), matrix.data());
    for (std::size_t column = 0; column < rows; ++column) {
      for (std::size_t row = column; row < rows; ++row) {
        results.tangent.push_back(matrix[column * rows + row]);
      }
    }
    const std::int32_t first = near.first_packet[face];
    double of_face[9 * kMostFaceNodes * kMostFaceNodes];
    kernels.of_face(near.first_packet[face + 1] - first, surface.shapes(near.faces[face]),
                    &points[first], &curvature[first],
                    &results.gradient[6 * kPacketSize * static_cast<std::size_t>(first)], of_face);
    results.tangent.insert(results.tangent.end(), std::begin(of_face), std::end(of_face));
  }
  for (const PointPacket& packet : points) {
    for (const auto& normal : packet.normal) {
      results.points.insert(results.points.end(), std::begin(normal), std::end(normal));
    }
  }
  return results;
}

void expect_equal(const std::vector<double>& a, const std::vector<double>& b) {
  ASSERT_EQ(a.size(), b.size());
  double scale = 0;
  for (double x : a) scale = std::max(scale, std::abs(x));
  ASSERT_GT(scale, 0);
  for (std::size_t i = 0; i < a.size(); ++i) ASSERT_NEAR(a[i], b[i], kRounding * scale) << i;
}

void expect_equal_kernels(const ContactKernels& kernels) {
  // Faces that are nearly flat and face each other fully, and rough ones.
  for (const double turn : {1e-5, 1e-3}) {
    const Results expected = run(baseline::contact_kernels(), turn);
    const Results found = run(kernels, turn);
    expect_equal(expected.points, found.points);
    expect_equal(expected.sums, found.sums);
    EXPECT_EQ(expected.rows, found.rows);
    expect_equal(expected.gradient, found.gradient);
    expect_equal(expected.of_nodes, found.of_nodes);
    EXPECT_EQ(expected.seen, found.seen);
    expect_equal(expected.tangent, found.tangent);
  }
}

TEST(ContactInstructionSets, Baseline) { expect_equal_kernels(best_contact_kernels()); }

#if defined(__x86_64__)
TEST(ContactInstructionSets, Avx2) {
  if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) GTEST_SKIP();
  expect_equal_kernels(avx2::contact_kernels());
}

TEST(ContactInstructionSets, Avx512) {
  if (!__builtin_cpu_supports("avx512f") || !__builtin_cpu_supports("avx512dq")) GTEST_SKIP();
  expect_equal_kernels(avx512::contact_kernels());
}
#endif

}  // namespace
}  // namespace test::test_contact_instruction_sets
}  // namespace palpate

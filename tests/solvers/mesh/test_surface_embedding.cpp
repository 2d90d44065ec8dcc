// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/surface_embedding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <utility>

#include "base/error.h"
#include "solvers/support/surfaces.h"

namespace palpate::test::test_surface_embedding {
namespace {

constexpr double kRadius = 0.05;

using Field = std::function<Vec3(const Vec3&)>;

Eigen::VectorXf sampled(const std::vector<Vec3>& points, const Field& field) {
  Eigen::VectorXf u(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t p = 0; p < points.size(); ++p) {
    u.segment<3>(3 * static_cast<Eigen::Index>(p)) = field(points[p]).cast<float>();
  }
  return u;
}

/// The largest angle between the normals of neighbouring triangles of a displaced surface, degrees.
double largest_crease(const test::Surface& surface, const Eigen::VectorXf& u) {
  std::vector<Vec3> points = surface.points;
  for (std::size_t p = 0; p < points.size(); ++p) {
    points[p] += u.segment<3>(3 * static_cast<Eigen::Index>(p)).cast<double>();
  }
  std::map<std::pair<Index, Index>, Vec3> normals;
  double least = 1;
  for (const auto& [a, b, c] : surface.triangles) {
    const Vec3 normal = (points[b] - points[a]).cross(points[c] - points[a]).normalized();
    for (const auto& side : {std::minmax(a, b), std::minmax(b, c), std::minmax(a, c)}) {
      const auto [other, is_first] = normals.try_emplace(side, normal);
      if (!is_first) least = std::min(least, other->second.dot(normal));
    }
  }
  return std::acos(least) * 180 / M_PI;
}

/// A dent of the size of a tool of 10 mm.
Vec3 dent(const Vec3& x) {
  const Vec3 at(0.3 * kRadius, 0.2 * kRadius, std::sqrt(1 - 0.13) * kRadius);
  const double r = (x - at).norm() / 0.012;
  return -0.006 * std::exp(-r * r) * at.normalized();
}

TEST(SurfaceEmbedding, NoFacetOfTheCarrierIsSeen) {
  const test::Surface coarse = icosphere(kRadius, 3);
  const test::Surface fine = icosphere(kRadius, 6);
  const SurfaceEmbedding embedding(coarse.points, coarse.triangles, fine.points);
  const Eigen::VectorXf u = sampled(coarse.points, dent);
  const Eigen::VectorXf exact = sampled(fine.points, dent);
  const Eigen::VectorXf carried = embedding.displacement(u);
  Eigen::VectorXf by_facets(carried.size());
  for (Eigen::Index p = 0; p < embedding.num_points(); ++p) {
    const auto& [points, weights] = embedding.nearest()[static_cast<std::size_t>(p)];
    by_facets.segment<3>(3 * p).setZero();
    for (int k = 0; k < 3; ++k) {
      by_facets.segment<3>(3 * p) +=
          static_cast<float>(weights[k]) *
          u.segment<3>(3 * Eigen::Index{points[static_cast<std::size_t>(k)]});
    }
  }
  const double right = largest_crease(fine, exact);
  std::printf(
      "largest angle between neighbours: exact %.2f, carried %.2f, by facets %.2f degrees; "
      "error %.3f and %.3f of the dent\n",
      right, largest_crease(fine, carried), largest_crease(fine, by_facets),
      (carried - exact).lpNorm<Eigen::Infinity>() / 0.006,
      (by_facets - exact).lpNorm<Eigen::Infinity>() / 0.006);
  EXPECT_LT(largest_crease(fine, carried), 1.3 * right);
  EXPECT_GT(largest_crease(fine, by_facets), 3 * right);
  EXPECT_LT((carried - exact).lpNorm<Eigen::Infinity>(),
            0.2 * (by_facets - exact).lpNorm<Eigen::Infinity>());
}

TEST(SurfaceEmbedding, PassesThroughCommonPointsAndMovesWithTheBody) {
  const test::Surface coarse = icosphere(kRadius, 3);
  const test::Surface fine = icosphere(kRadius, 5);
  const SurfaceEmbedding embedding(coarse.points, coarse.triangles, fine.points);
  const Eigen::VectorXf dented = embedding.displacement(sampled(coarse.points, dent));
  // The first points of the finer sphere are those of the coarser one.
  const Eigen::VectorXf common = sampled(coarse.points, dent);
  EXPECT_LT((dented.head(common.size()) - common).lpNorm<Eigen::Infinity>(), 1e-8F);
  const Field shift = [](const Vec3&) { return Vec3(0.01, -0.02, 0.03); };
  EXPECT_LT((embedding.displacement(sampled(coarse.points, shift)) - sampled(fine.points, shift))
                .lpNorm<Eigen::Infinity>(),
            1e-7F);
  Mat3 gradient;
  gradient << 0.1, 0.4, -0.2, -0.5, 0.2, 0.3, 0.1, -0.3, -0.2;
  const Field linear = [&](const Vec3& x) { return Vec3(gradient * x); };
  EXPECT_LT((embedding.displacement(sampled(coarse.points, linear)) - sampled(fine.points, linear))
                .lpNorm<Eigen::Infinity>(),
            2e-6 * kRadius);
}

TEST(SurfaceEmbedding, OneSideOfAThinSheetDoesNotFollowTheOther) {
  const Vec3 size(0.08, 0.08, 0.002);
  const test::Surface coarse = test::box_surface(size, {16, 16, 1});
  const test::Surface fine = test::box_surface(size, {40, 40, 1});
  const SurfaceEmbedding embedding(coarse.points, coarse.triangles, fine.points);
  const Field lifted = [&](const Vec3& x) {
    return x[2] > 0.001 ? Vec3(0, 0, 0.01) : Vec3(Vec3::Zero());
  };
  const Eigen::VectorXf carried = embedding.displacement(sampled(coarse.points, lifted));
  for (std::size_t p = 0; p < fine.points.size(); ++p) {
    const Vec3& x = fine.points[p];
    const bool is_inside = (x.head<2>() - size.head<2>() / 2).lpNorm<Eigen::Infinity>() < 0.012;
    if (!is_inside) continue;
    EXPECT_NEAR(carried[3 * static_cast<Eigen::Index>(p) + 2], lifted(x)[2], 1e-6) << x.transpose();
  }
}

TEST(SurfaceEmbedding, TellsHowFarItIsFromItsCarrier) {
  const test::Surface coarse = icosphere(kRadius, 3);
  test::Surface fine = icosphere(kRadius, 4);
  for (Vec3& point : fine.points) point *= 1.1;
  fine.points.front() *= 1.5;
  const SurfaceEmbedding embedding(coarse.points, coarse.triangles, fine.points);
  EXPECT_NEAR(embedding.median_distance(), 0.1 * kRadius, 0.01 * kRadius);
  EXPECT_NEAR(embedding.largest_distance(), 0.65 * kRadius, 0.01 * kRadius);
  // Points that are off the carrier follow it as well.
  const Eigen::VectorXf carried = embedding.displacement(sampled(coarse.points, dent));
  EXPECT_TRUE(carried.allFinite());
  EXPECT_LT(carried.lpNorm<Eigen::Infinity>(), 0.009F);
}

TEST(SurfaceEmbedding, TrianglesWithoutAreaDoNoHarm) {
  test::Surface coarse = test::box_surface({0.04, 0.04, 0.04}, {2, 2, 2});
  coarse.triangles.push_back({0, 0, 1});
  coarse.points.push_back(coarse.points.front());
  const auto last = static_cast<Index>(coarse.points.size()) - 1;
  coarse.triangles.push_back({0, last, last});
  const test::Surface fine = test::box_surface({0.04, 0.04, 0.04}, {8, 8, 8});
  const SurfaceEmbedding embedding(coarse.points, coarse.triangles, fine.points);
  const Field shift = [](const Vec3&) { return Vec3(0.01, -0.02, 0.03); };
  EXPECT_LT((embedding.displacement(sampled(coarse.points, shift)) - sampled(fine.points, shift))
                .lpNorm<Eigen::Infinity>(),
            1e-7F);
  EXPECT_THROW(SurfaceEmbedding({}, {}, fine.points), InputError);
}

}  // namespace
}  // namespace palpate::test::test_surface_embedding

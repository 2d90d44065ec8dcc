// SPDX-License-Identifier: BSD-3-Clause
// Exact predicates, self-intersections, checks and shells of surfaces.
#include <chrono>
#include <random>

#include <gtest/gtest.h>

#include "base/error.h"
#include "filters/surfaces.h"
#include "vtkCellData.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPalpateCompartments.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceShells.h"
#include "vtkPalpateTriangleIntersection.h"
#include "vtkStringArray.h"
#include "vtkStripper.h"
#include "vtkTriangle.h"

using namespace palpate::test;

namespace {
vtkPalpateSurface Surface(vtkPolyData* polydata) { return vtkPalpateSurfaceFromPolyData(polydata); }

int SignOf(__int128 value) { return (value > 0) - (value < 0); }

/// Sign of det [a − d; b − d; c − d] of whole numbers.
int ExactSign(const std::array<std::array<long, 3>, 4>& p) {
  __int128 m[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      m[i][j] = p[i][j] - p[3][j];
    }
  }
  return SignOf(m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]));
}
}  // namespace

TEST(ExactPredicates, SignOfFourPointsInOrNearAPlane) {
  // Large whole numbers, whose determinants need 120 bits, on a plane or one unit off it.
  std::mt19937_64 random(1);
  std::uniform_int_distribution<long> coordinate(-(1L << 38), 1L << 38), few(-3, 3), unit(-1, 1);
  int zeros = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    std::array<std::array<long, 3>, 4> p;
    for (int j = 0; j < 3; ++j) {
      p[0][j] = coordinate(random);
      p[1][j] = coordinate(random);
      p[2][j] = coordinate(random);
    }
    const long u = few(random), v = few(random);
    for (int j = 0; j < 3; ++j) {
      p[3][j] = p[0][j] + u * (p[1][j] - p[0][j]) + v * (p[2][j] - p[0][j]) + unit(random);
    }
    std::array<vtkPalpatePoint, 4> x;
    for (int i = 0; i < 4; ++i) {
      // A power of two keeps the digits.
      x[i] = {std::ldexp(p[i][0], -40), std::ldexp(p[i][1], -40), std::ldexp(p[i][2], -40)};
    }
    const int expected = ExactSign(p);
    zeros += expected == 0;
    ASSERT_EQ(vtkPalpateOrient3D(x[0], x[1], x[2], x[3]), expected) << "trial " << trial;
    ASSERT_EQ(vtkPalpateOrient3D(x[1], x[0], x[2], x[3]), -expected) << "trial " << trial;
  }
  EXPECT_GT(zeros, 0);
}

TEST(ExactPredicates, SignOfThreePointsOnOrNearALine) {
  const vtkPalpatePoint a = {0.1, 0.1, 7}, b = {0.3, 0.3, -2};
  for (int axis = 0; axis < 3; ++axis) {
    const auto turned = [axis](const vtkPalpatePoint& x) {
      vtkPalpatePoint y;
      for (int i = 0; i < 3; ++i) {
        y[(i + axis + 1) % 3] = x[i];
      }
      return y;
    };
    const vtkPalpatePoint on = {0.7, 0.7, 1};
    const vtkPalpatePoint left = {0.7, std::nextafter(0.7, 1), 1};
    const vtkPalpatePoint right = {0.7, std::nextafter(0.7, 0), 1};
    EXPECT_EQ(vtkPalpateOrient2D(turned(a), turned(b), turned(on), axis), 0);
    EXPECT_EQ(vtkPalpateOrient2D(turned(a), turned(b), turned(left), axis), 1);
    EXPECT_EQ(vtkPalpateOrient2D(turned(a), turned(b), turned(right), axis), -1);
  }
}

TEST(TriangleIntersection, EqualsABruteForceTestOnRandomTriangles) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> place(0, 1), size(-0.15, 0.15);
  vtkPalpateSurface soup;
  for (vtkIdType i = 0; i < 600; ++i) {
    const vtkPalpatePoint centre = {place(random), place(random), place(random)};
    for (int corner = 0; corner < 3; ++corner) {
      soup.Points.push_back(
          {centre[0] + size(random), centre[1] + size(random), centre[2] + size(random)});
    }
    soup.Triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  std::vector<std::array<vtkIdType, 2>> expected;
  for (vtkIdType i = 0; i < 600; ++i) {
    for (vtkIdType j = i + 1; j < 600; ++j) {
      auto* p = soup.Points.data();
      if (vtkTriangle::TrianglesIntersect(p[3 * i].data(), p[3 * i + 1].data(), p[3 * i + 2].data(),
                                          p[3 * j].data(), p[3 * j + 1].data(),
                                          p[3 * j + 2].data())) {
        expected.push_back({i, j});
      }
    }
  }
  EXPECT_GT(expected.size(), 100u);
  EXPECT_EQ(vtkPalpateIntersectingTriangles(soup), expected);
}

TEST(TriangleIntersection, NeighboursMeetOnlyWhereTheyFoldOrPierce) {
  const std::vector<vtkPalpatePoint> base = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const auto meets = [&base](std::vector<vtkPalpatePoint> more, std::array<vtkIdType, 3> second) {
    vtkPalpateSurface surface;
    surface.Points = base;
    surface.Points.insert(surface.Points.end(), more.begin(), more.end());
    surface.Triangles = {{0, 1, 2}, second};
    const bool forwards = vtkPalpateTrianglesIntersect(surface, 0, 1);
    EXPECT_EQ(forwards, vtkPalpateTrianglesIntersect(surface, 1, 0));
    return forwards;
  };
  // A common edge: flat beyond it, bent, bent almost back, folded flat.
  EXPECT_FALSE(meets({{1, 1, 0}}, {2, 1, 3}));
  EXPECT_FALSE(meets({{0.2, 0.2, 1}}, {2, 1, 3}));
  EXPECT_FALSE(meets({{0.2, 0.2, 1e-300}}, {2, 1, 3}));
  EXPECT_TRUE(meets({{0.2, 0.2, 0}}, {2, 1, 3}));
  // A common corner: apart, piercing, overlapping in the plane, along an edge.
  EXPECT_FALSE(meets({{-1, 0, 0}, {-1, 1, 1}}, {0, 3, 4}));
  EXPECT_TRUE(meets({{0.2, 0.2, 1}, {0.2, 0.2, -1}}, {0, 3, 4}));
  EXPECT_TRUE(meets({{0.5, 0.2, 0}, {0.2, 0.5, 0}}, {0, 3, 4}));
  EXPECT_TRUE(meets({{2, 0, 0}, {2, 0, 1}}, {0, 3, 4}));
  EXPECT_FALSE(meets({{0, 0, 1}, {-1, 0, 1}}, {0, 3, 4}));
  // Nothing in common: a corner on the other's face, an edge across an edge, just beside, coplanar.
  EXPECT_TRUE(meets({{0.2, 0.2, 0}, {0, 0, 1}, {1, 0, 1}}, {3, 4, 5}));
  EXPECT_TRUE(meets({{0.5, -1, 0}, {0.5, 1, 0}, {0.5, 0, 1}}, {3, 4, 5}));
  EXPECT_FALSE(meets({{0.2, 0.2, 1e-300}, {0, 0, 1}, {1, 0, 1}}, {3, 4, 5}));
  EXPECT_TRUE(meets({{0.1, 0.1, 0}, {0.2, 0.1, 0}, {0.1, 0.2, 0}}, {3, 4, 5}));
  EXPECT_FALSE(meets({{1, 1, 0}, {2, 1, 0}, {1, 2, 0}}, {3, 4, 5}));
}

TEST(TriangleIntersection, LargeSurfaceIsCheckedInTime) {
  const auto surface = Surface(Sphere(1, {0, 0, 0}, 224));
  ASSERT_GT(surface.Triangles.size(), 99000u);
  const auto start = std::chrono::steady_clock::now();
  EXPECT_TRUE(vtkPalpateIntersectingTriangles(surface).empty());
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  // 0.2 s on a 2.6 GHz-class core: room for a loaded machine, none for a quadratic search
  // (minutes).
  EXPECT_LT(time.count(), 10);
}

TEST(SurfaceFromPolyData, MeetsStripsQuadsAndDoubledPoints) {
  const auto cube = Surface(Cube(2));
  EXPECT_EQ(cube.Points.size(), 8u);
  EXPECT_EQ(cube.Triangles.size(), 12u);
  EXPECT_NEAR(vtkPalpateVolume(cube), 8, 1e-12);

  vtkNew<vtkStripper> stripper;
  stripper->SetInputData(Triangles(Sphere(1)));
  stripper->Update();
  ASSERT_GT(stripper->GetOutput()->GetNumberOfStrips(), 0);
  const auto strips = Surface(stripper->GetOutput());
  const auto sphere = Surface(Sphere(1));
  EXPECT_EQ(strips.Triangles.size(), sphere.Triangles.size());
  // The area of strips is summed in another order.
  EXPECT_NEAR(vtkPalpateVolume(strips), vtkPalpateVolume(sphere), 1e-6);
}

TEST(SurfaceFromPolyData, RemovesTrianglesWithoutAnArea) {
  // A tetrahedron with a point in the middle of an edge that only one of its triangles knows: the
  // crack is closed by a triangle whose corners lie on a line.
  const auto polydata =
      FromArrays({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0, 0}},
                 {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {0, 1, 4}, {1, 2, 3}, {0, 3, 2}});
  const auto surface = Surface(polydata);
  EXPECT_TRUE(vtkPalpateCheckSurface(surface).None());
  EXPECT_EQ(surface.Triangles.size(), 6u);
  EXPECT_NEAR(vtkPalpateVolume(surface), 1.0 / 6, 1e-15);
}

TEST(SurfaceFromPolyData, RejectsNothingAndNaN) {
  vtkNew<vtkPolyData> empty;
  EXPECT_THROW(Surface(empty), palpate::InputError);
  EXPECT_THROW(Surface(nullptr), palpate::InputError);
  EXPECT_THROW(Surface(FromArrays({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {{0, 1, 2}})),
               palpate::InputError);
  auto sphere = Sphere(1);
  sphere->GetPoints()->SetPoint(5, 0, std::nan(""), 0);
  try {
    Surface(sphere);
    FAIL() << "NaN was taken";
  } catch (const palpate::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("Point 5"), std::string::npos) << error.what();
  }
}

TEST(SurfaceFromPolyData, IgnoresPointsThatNothingUses) {
  auto sphere = Sphere(1);
  sphere->GetPoints()->InsertNextPoint(1e30, std::nan(""), 0);
  EXPECT_TRUE(vtkPalpateCheckSurface(Surface(sphere)).None());
}

TEST(SurfaceCheck, FindsNothingOnGoodSurfaces) {
  EXPECT_TRUE(vtkPalpateCheckSurface(Surface(Sphere(1))).None());
  EXPECT_TRUE(vtkPalpateCheckSurface(Surface(Cube(1))).None());
  EXPECT_TRUE(vtkPalpateCheckSurface(Surface(InsideOut(Sphere(1)))).None());
  const auto two = Surface(Append({Sphere(1), Cube(1, {5, 0, 0})}));
  const auto faults = vtkPalpateCheckSurface(two);
  EXPECT_TRUE(faults.None());
  EXPECT_EQ(vtkPalpateDescribeFaults(two, faults), "");
}

TEST(SurfaceCheck, CountsAndLocatesOpenEdges) {
  const auto surface = Surface(Without(Cube(2), {0}));  // without the face at x = -1
  const auto faults = vtkPalpateCheckSurface(surface);
  EXPECT_EQ(faults.OpenEdges.size(), 4u);
  EXPECT_TRUE(faults.NonManifoldEdges.empty());
  EXPECT_TRUE(faults.InconsistentEdges.empty());
  EXPECT_TRUE(faults.IntersectingPairs.empty());
  const auto text = vtkPalpateDescribeFaults(surface, faults);
  EXPECT_NE(text.find("4 open edges, near (-1, "), std::string::npos) << text;
}

TEST(SurfaceCheck, CountsNonManifoldEdges) {
  // Two cubes that share an edge.
  const auto surface = Surface(Append({Cube(1), Cube(1, {1, 1, 0})}));
  const auto faults = vtkPalpateCheckSurface(surface);
  EXPECT_EQ(faults.NonManifoldEdges.size(), 1u);
  EXPECT_TRUE(faults.OpenEdges.empty());
}

TEST(SurfaceCheck, CountsEdgesOfOppositeNormals) {
  auto surface = Surface(Cube(1));
  std::swap(surface.Triangles[3][0], surface.Triangles[3][1]);
  const auto faults = vtkPalpateCheckSurface(surface);
  EXPECT_EQ(faults.InconsistentEdges.size(), 3u);
  EXPECT_EQ(vtkPalpateMakeConsistent(surface), 1);
  EXPECT_TRUE(vtkPalpateCheckSurface(surface).None());
  EXPECT_NEAR(vtkPalpateVolume(surface), 1, 1e-15);
}

TEST(SurfaceCheck, CountsPairsThatCrossOnceEach) {
  const auto surface = Surface(Append({Cube(1), Cube(1, {0.3, 0.4, 0.5})}));
  const auto faults = vtkPalpateCheckSurface(surface);
  std::size_t expected = 0;
  for (vtkIdType i = 0; i < 12; ++i) {
    for (vtkIdType j = 12; j < 24; ++j) {
      double p[6][3];
      for (int corner = 0; corner < 3; ++corner) {
        std::copy_n(surface.Points[surface.Triangles[i][corner]].data(), 3, p[corner]);
        std::copy_n(surface.Points[surface.Triangles[j][corner]].data(), 3, p[3 + corner]);
      }
      expected += vtkTriangle::TrianglesIntersect(p[0], p[1], p[2], p[3], p[4], p[5]);
    }
  }
  EXPECT_GT(expected, 6u);
  EXPECT_EQ(faults.IntersectingPairs.size(), expected);

  vtkNew<vtkPolyData> shown;
  vtkPalpateFaultsToPolyData(surface, faults, shown);
  auto* fault = vtkIntArray::SafeDownCast(shown->GetCellData()->GetArray("SurfaceFault"));
  auto* names = vtkStringArray::SafeDownCast(shown->GetFieldData()->GetAbstractArray("FaultName"));
  auto* counts = vtkIdTypeArray::SafeDownCast(shown->GetFieldData()->GetArray("FaultCount"));
  ASSERT_TRUE(fault && names && counts);
  constexpr int kind = vtkPalpateSurfaceFaults::IntersectingTriangle;
  EXPECT_EQ(fault->GetValue(0), kind);
  EXPECT_EQ(names->GetValue(kind), "pairs of triangles that cross each other");
  EXPECT_EQ(counts->GetValue(kind), static_cast<vtkIdType>(expected));
}

TEST(Compartments, CavitiesRegionsAndBodiesWithinCavities) {
  constexpr int empty = vtkPalpateCompartments::Empty;
  const auto regions_of = [](vtkPolyData* polydata) {
    const auto found = vtkPalpateFindCompartments(vtkPalpateUniteWalls(Surface(polydata)));
    EXPECT_TRUE(found.Overlaps.empty() && found.Doubtful.empty() && found.Hinges.empty());
    return std::vector<int>(found.Region.begin() + 1, found.Region.end());
  };
  const auto hollow = Append({Sphere(3), InsideOut(Sphere(2)), Sphere(1)});
  const std::vector<int> expected = {0, empty, 1};
  EXPECT_EQ(regions_of(hollow), expected);
  EXPECT_EQ(regions_of(InsideOut(hollow)), expected);
  EXPECT_EQ(regions_of(Append({Sphere(3), Sphere(2), Sphere(1)})), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(regions_of(Append({Sphere(1), InsideOut(Sphere(1, {5, 0, 0}))})),
            (std::vector<int>{0, 1}));
  EXPECT_EQ(regions_of(Append({InsideOut(Sphere(1)), Sphere(3)})), (std::vector<int>{empty, 0}));
}

TEST(Compartments, SidesAndVolumesOfNestedShells) {
  const auto walls = vtkPalpateUniteWalls(Surface(Append({Cube(1), Cube(3)})));
  const auto found = vtkPalpateFindCompartments(walls);
  ASSERT_EQ(found.Count(), 3);
  EXPECT_NEAR(found.Volume[1], 1, 1e-12);
  EXPECT_NEAR(found.Volume[2], 26, 1e-12);
  EXPECT_EQ(found.Sides.front(), (std::array<int, 2>{1, 2}));
  EXPECT_EQ(found.Sides.back(), (std::array<int, 2>{2, vtkPalpateCompartments::Outside}));
  EXPECT_EQ(vtkPalpateCompartmentOf(found, {0.1, 0.2, 0.3}), 1);
  EXPECT_EQ(vtkPalpateCompartmentOf(found, {1.1, 0.2, 0.3}), 2);
  EXPECT_EQ(vtkPalpateCompartmentOf(found, {5, 0, 0}), vtkPalpateCompartments::Outside);
}

// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "base/error.h"
#include "filters/surfaces.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateSurfaceCheck.h"
#include "vtkPalpateSurfaceRepair.h"

using namespace palpate::test;

namespace {
vtkPalpateRepairedSurface Repair(vtkPolyData* polydata, int resolution = 80) {
  vtkPalpateRepairOptions options;
  options.Resolution = resolution;
  auto repaired = vtkPalpateRepairSurface(vtkPalpateSurfaceFromPolyData(polydata), options);
  EXPECT_TRUE(vtkPalpateCheckSurface(repaired.Surface).None());
  return repaired;
}
}  // namespace

TEST(SurfaceRepair, LeavesAGoodSurfaceAlone) {
  const auto before = vtkPalpateSurfaceFromPolyData(Sphere(1));
  const auto repaired = Repair(Sphere(1));
  EXPECT_EQ(repaired.Report, "none needed");
  EXPECT_EQ(repaired.Surface.Points, before.Points);
  EXPECT_EQ(repaired.Surface.Triangles, before.Triangles);
}

TEST(SurfaceRepair, FillsHolesWithoutTouchingTheRest) {
  const auto cube = Repair(Without(Cube(2), {0}));
  EXPECT_FALSE(cube.Resampled);
  EXPECT_NEAR(vtkPalpateVolume(cube.Surface), 8, 1e-12);
  EXPECT_NE(cube.Report.find("filled holes with 2 triangles"), std::string::npos) << cube.Report;

  const auto sphere = Repair(Without(Sphere(1), {3, 50, 51}));
  EXPECT_FALSE(sphere.Resampled);
}

TEST(SurfaceRepair, TurnsTrianglesAndRemovesDoubledOnes) {
  auto broken = vtkPalpateSurfaceFromPolyData(Cube(1));
  std::swap(broken.Triangles[5][0], broken.Triangles[5][1]);
  broken.Triangles.push_back(broken.Triangles[0]);
  const auto repaired = vtkPalpateRepairSurface(broken, {});
  EXPECT_TRUE(vtkPalpateCheckSurface(repaired.Surface).None());
  EXPECT_FALSE(repaired.Resampled);
  EXPECT_NEAR(vtkPalpateVolume(repaired.Surface), 1, 1e-12);
  EXPECT_NE(repaired.Report.find("removed 1 triangles"), std::string::npos) << repaired.Report;
  EXPECT_NE(repaired.Report.find("turned 1 triangles"), std::string::npos) << repaired.Report;
}

TEST(SurfaceRepair, BodiesThatCrossBecomeTheirUnion) {
  // Two balls of radius 1 at distance 1: each loses a cap of height 1/2.
  const auto repaired = Repair(Append({Sphere(1, {0, 0, 0}, 48), Sphere(1, {1, 0, 0}, 48)}));
  EXPECT_TRUE(repaired.Resampled);
  constexpr double pi = 3.14159265358979;
  const double cap = pi * 0.25 * (3 - 0.5) / 3;
  const double exact = 2 * (4 * pi / 3 - cap);
  // Facets of the spheres and rounding of the crease, each below 1 %.
  EXPECT_NEAR(vtkPalpateVolume(repaired.Surface) / exact, 1, 0.015);
}

TEST(SurfaceRepair, KeepsWhatHasNoFault) {
  const auto clean = Sphere(0.1, {5, 0, 0});
  const auto repaired = Repair(Append({Sphere(1, {0, 0, 0}, 24), Sphere(1, {1, 0, 0}, 24), clean}));
  const auto small = vtkPalpateSurfaceFromPolyData(clean);
  const auto& points = repaired.Surface.Points;
  for (const auto& point : small.Points) {
    EXPECT_NE(std::find(points.begin(), points.end(), point), points.end());
  }
}

TEST(SurfaceRepair, LoosePiecesAreJoined) {
  // Faces of a cube with gaps between them: no edge is shared.
  std::vector<vtkSmartPointer<vtkPolyData>> faces;
  const auto cube = Cube(2);
  for (vtkIdType face = 0; face < 6; ++face) {
    std::vector<vtkIdType> others;
    for (vtkIdType i = 0; i < 6; ++i) {
      if (i != face) {
        others.push_back(i);
      }
    }
    const auto alone = Without(cube, others);
    faces.push_back(Scaled(alone, 1));
    const int axis = static_cast<int>(face) / 2;
    for (vtkIdType i = 0; i < faces.back()->GetNumberOfPoints(); ++i) {
      double x[3];
      faces.back()->GetPoint(i, x);
      x[axis] *= 1.01;
      faces.back()->GetPoints()->SetPoint(i, x);
    }
  }
  const auto repaired = Repair(Append(faces), 60);
  EXPECT_TRUE(repaired.Resampled);
  EXPECT_NEAR(vtkPalpateVolume(repaired.Surface) / 8, 1, 0.05);
}

TEST(SurfaceRepair, AnyUnitAndPlace) {
  const auto crossing = Append({Sphere(1, {0, 0, 0}, 24), Sphere(1, {1, 0, 0}, 24)});
  const double unit = vtkPalpateVolume(Repair(crossing).Surface);
  for (const double factor : {1e-6, 1e6}) {
    const auto repaired = Repair(Scaled(crossing, factor, 10 * factor));
    EXPECT_NEAR(vtkPalpateVolume(repaired.Surface) / (factor * factor * factor * unit), 1, 2e-3);
  }
}

TEST(SurfaceRepair, InsideOutSurfacesStayInsideOut) {
  const auto crossing = Append({Sphere(1, {0, 0, 0}, 24), Sphere(1, {1, 0, 0}, 24)});
  const double outwards = vtkPalpateVolume(Repair(crossing).Surface);
  const double inwards = vtkPalpateVolume(Repair(InsideOut(crossing)).Surface);
  EXPECT_NEAR(inwards / outwards, -1, 2e-3);
}

TEST(SurfaceRepair, SaysSoWhereThereIsNoInside) {
  const auto sheet = FromArrays({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2, 3}});
  EXPECT_THROW(Repair(sheet), palpate::InputError);
}

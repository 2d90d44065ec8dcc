// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <thread>

#include <sys/stat.h>
#include <unistd.h>

#include <gtest/gtest.h>

#include "filters/surfaces.h"
#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkGenericCell.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkIntArray.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkPalpateSurface.h"
#include "vtkPalpateTetrahedralizeSurface.h"
#include "vtkPalpateWallMatch.h"
#include "vtkPartitionedDataSetCollection.h"
#include "vtkPlane.h"
#include "vtkPointData.h"
#include "vtkSTLReader.h"
#include "vtkSphere.h"
#include "vtkStringArray.h"
#include "vtkStripper.h"

using namespace palpate::test;

namespace {
using Filter = vtkPalpateTetrahedralizeSurface;
using Settings = std::function<void(Filter*)>;

struct Result {
  vtkSmartPointer<vtkUnstructuredGrid> Body;
  vtkSmartPointer<vtkPolyData> Faults;
  std::vector<std::string> Errors, Warnings;
  unsigned long ErrorCode;
  std::string Repair;
};

Result MeshedAll(const std::vector<vtkSmartPointer<vtkDataObject>>& inputs,
                 const Settings& settings = nullptr) {
  CaughtMessages messages;
  vtkNew<Filter> filter;
  for (const auto& input : inputs) {
    filter->AddInputDataObject(0, input);
  }
  if (settings) {
    settings(filter);
  }
  filter->Update();
  Result result;
  result.Body = filter->GetOutput();
  result.Faults = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(1));
  result.Errors = messages.Errors();
  result.Warnings = messages.Others();
  result.ErrorCode = filter->GetErrorCode();
  if (auto* text =
          vtkStringArray::SafeDownCast(result.Body->GetFieldData()->GetAbstractArray("Repair"))) {
    result.Repair = text->GetValue(0);
  }
  return result;
}

Result Meshed(vtkPolyData* surface, const Settings& settings = nullptr) {
  const auto result = MeshedAll({surface}, settings);
  EXPECT_TRUE(result.Warnings.empty()) << result.Warnings.front();
  return result;
}

/// All that holds for every mesh.
void ExpectGood(const Result& result, double volume, double tolerance = 1e-9) {
  ASSERT_TRUE(result.Errors.empty()) << result.Errors.front();
  EXPECT_EQ(result.ErrorCode, static_cast<unsigned long>(vtkErrorCode::NoError));
  ASSERT_GT(result.Body->GetNumberOfCells(), 0);
  const auto volumes = Volumes(result.Body);
  EXPECT_GT(*std::min_element(volumes.begin(), volumes.end()), 0);
  EXPECT_NEAR(TotalVolume(result.Body) / volume, 1, tolerance);
  ASSERT_TRUE(vtkIntArray::SafeDownCast(result.Body->GetCellData()->GetArray("Region")));
  std::vector<char> used(result.Body->GetNumberOfPoints(), 0);
  for (vtkIdType i = 0; i < result.Body->GetNumberOfCells(); ++i) {
    vtkIdType size;
    const vtkIdType* ids;
    result.Body->GetCellPoints(i, size, ids);
    for (vtkIdType j = 0; j < size; ++j) {
      used[ids[j]] = 1;
    }
  }
  EXPECT_EQ(std::count(used.begin(), used.end(), 0), 0) << "points that nothing uses";
}

/// One message, with the words in it, and no body.
void ExpectError(const Result& result, const std::vector<std::string>& words) {
  ASSERT_EQ(result.Errors.size(), 1u);
  for (const auto& word : words) {
    EXPECT_NE(result.Errors[0].find(word), std::string::npos)
        << "no \"" << word << "\" in: " << result.Errors[0];
  }
  EXPECT_EQ(result.Body->GetNumberOfCells(), 0);
  EXPECT_EQ(result.Body->GetNumberOfPoints(), 0);
  EXPECT_NE(result.ErrorCode, static_cast<unsigned long>(vtkErrorCode::NoError));
}

std::set<int> Regions(vtkUnstructuredGrid* body) {
  auto* region = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("Region"));
  std::set<int> result;
  for (vtkIdType i = 0; i < region->GetNumberOfValues(); ++i) {
    result.insert(region->GetValue(i));
  }
  return result;
}

double RegionVolume(vtkUnstructuredGrid* body, int number) {
  auto* region = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("Region"));
  const auto volumes = Volumes(body);
  double total = 0;
  for (std::size_t i = 0; i < volumes.size(); ++i) {
    total += region->GetValue(static_cast<vtkIdType>(i)) == number ? volumes[i] : 0;
  }
  return total;
}

double SurfaceVolume(vtkPolyData* surface) { return TotalVolume(Meshed(surface).Body); }

/// A box from the origin to (side, side, ·), whose horizontal faces are n × n squares, cut along
/// one diagonal or the other.
vtkSmartPointer<vtkPolyData> Slab(double bottom, double top, int n = 2, double side = 4,
                                  double shift = 0, bool other_diagonal = false) {
  std::vector<std::array<double, 3>> points;
  std::vector<std::vector<vtkIdType>> cells;
  std::map<std::array<int, 3>, vtkIdType> ids;
  const auto point = [&](int i, int j, int k) {
    const auto [entry, is_new] = ids.emplace(std::array<int, 3>{i, j, k}, ids.size());
    if (is_new) {
      points.push_back({shift + side * i / n, side * j / n, k ? top : bottom});
    }
    return entry->second;
  };
  const auto quad = [&](vtkIdType a, vtkIdType b, vtkIdType c, vtkIdType d) {
    if (other_diagonal) {
      cells.insert(cells.end(), {{a, b, d}, {b, c, d}});
    } else {
      cells.insert(cells.end(), {{a, b, c}, {a, c, d}});
    }
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      quad(point(i, j, 1), point(i + 1, j, 1), point(i + 1, j + 1, 1), point(i, j + 1, 1));
      quad(point(i, j, 0), point(i, j + 1, 0), point(i + 1, j + 1, 0), point(i + 1, j, 0));
    }
    quad(point(i, 0, 0), point(i + 1, 0, 0), point(i + 1, 0, 1), point(i, 0, 1));
    quad(point(i + 1, n, 0), point(i, n, 0), point(i, n, 1), point(i + 1, n, 1));
    quad(point(0, i + 1, 0), point(0, i, 0), point(0, i, 1), point(0, i + 1, 1));
    quad(point(n, i, 0), point(n, i + 1, 0), point(n, i + 1, 1), point(n, i, 1));
  }
  return FromArrays(points, cells);
}

vtkSmartPointer<vtkPolyData> Labelled(vtkPolyData* surface, int region,
                                      const char* name = "Region") {
  auto result = vtkSmartPointer<vtkPolyData>::New();
  result->DeepCopy(surface);
  vtkNew<vtkIntArray> array;
  array->SetName(name);
  array->SetNumberOfValues(surface->GetNumberOfCells());
  array->FillValue(region);
  result->GetCellData()->AddArray(array);
  return result;
}

/// Of triangles at the same place the first alone: walls once.
vtkSmartPointer<vtkPolyData> WallsOnce(vtkPolyData* surface) {
  std::set<std::set<std::array<double, 3>>> known;
  std::vector<vtkIdType> again;
  for (vtkIdType i = 0; i < surface->GetNumberOfCells(); ++i) {
    std::set<std::array<double, 3>> corners;
    for (vtkIdType k = 0; k < 3; ++k) {
      std::array<double, 3> x;
      surface->GetPoint(surface->GetCell(i)->GetPointId(k), x.data());
      corners.insert(x);
    }
    if (!known.insert(corners).second) {
      again.push_back(i);
    }
  }
  return Without(surface, again);
}

/// The regions have these volumes, they share the points of their walls, and no other points lie at
/// the same place.
void ExpectRegions(const Result& result, const std::map<int, double>& volumes,
                   double tolerance = 1e-9) {
  double total = 0;
  std::set<int> numbers;
  for (const auto& [number, volume] : volumes) {
    total += volume;
    numbers.insert(number);
  }
  ExpectGood(result, total, tolerance);
  EXPECT_TRUE(result.Warnings.empty()) << result.Warnings.front();
  ASSERT_EQ(Regions(result.Body), numbers);
  auto* number = result.Body->GetFieldData()->GetArray("RegionNumber");
  auto* volume = result.Body->GetFieldData()->GetArray("RegionVolume");
  ASSERT_TRUE(number && volume);
  ASSERT_EQ(number->GetNumberOfTuples(), static_cast<vtkIdType>(volumes.size()));
  vtkIdType row = 0;
  for (const auto& [value, wanted] : volumes) {
    EXPECT_NEAR(RegionVolume(result.Body, value) / wanted, 1, tolerance) << value;
    EXPECT_EQ(number->GetTuple1(row), value);
    EXPECT_NEAR(volume->GetTuple1(row) / wanted, 1, tolerance);
    ++row;
  }
  std::set<std::array<double, 3>> places;
  for (vtkIdType i = 0; i < result.Body->GetNumberOfPoints(); ++i) {
    std::array<double, 3> x;
    result.Body->GetPoint(i, x.data());
    EXPECT_TRUE(places.insert(x).second) << "two points at one place";
  }
}

/// How many faces lie between two regions.
int FacesBetween(vtkUnstructuredGrid* body, int a, int b) {
  auto* region = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("Region"));
  std::map<std::array<vtkIdType, 3>, std::set<int>> faces;
  for (vtkIdType i = 0; i < body->GetNumberOfCells(); ++i) {
    vtkIdType size;
    const vtkIdType* ids;
    body->GetCellPoints(i, size, ids);
    for (int out = 0; out < 4; ++out) {
      std::array<vtkIdType, 3> face = {ids[(out + 1) % 4], ids[(out + 2) % 4], ids[(out + 3) % 4]};
      std::sort(face.begin(), face.end());
      faces[face].insert(region->GetValue(i));
    }
  }
  return static_cast<int>(std::count_if(faces.begin(), faces.end(), [&](const auto& face) {
    return face.second == std::set<int>{a, b};
  }));
}

/// A program in the place of palpate-tetgen while it lives.
class FakeTetGen {
 public:
  explicit FakeTetGen(const std::string& script)
      : Path(std::filesystem::temp_directory_path() /
             ("palpate-fake-tetgen-" + std::to_string(getpid()))) {
    std::ofstream(Path) << "#!/bin/sh\n" << script << "\n";
    chmod(Path.c_str(), 0755);
    setenv("PALPATE_TETGEN", Path.c_str(), 1);
  }
  ~FakeTetGen() {
    unsetenv("PALPATE_TETGEN");
    std::filesystem::remove(Path);
  }

 private:
  std::filesystem::path Path;
};

/// A folder for temporary files that nobody else uses, while it lives.
class TemporaryFolder {
 public:
  TemporaryFolder()
      : Path(std::filesystem::temp_directory_path() /
             ("palpate-test-folder-" + std::to_string(getpid()))) {
    std::filesystem::create_directory(Path);
    setenv("TMPDIR", Path.c_str(), 1);
  }
  ~TemporaryFolder() {
    unsetenv("TMPDIR");
    std::filesystem::remove_all(Path);
  }
  bool Empty() const { return std::filesystem::is_empty(Path); }

  const std::filesystem::path Path;
};
}  // namespace

TEST(TetrahedralizeSurface, CubeOfQuads) {
  const auto result = Meshed(Cube(0.1));
  ExpectGood(result, 1e-3);
  EXPECT_EQ(result.Body->GetCellType(0), VTK_TETRA);
  EXPECT_EQ(Regions(result.Body), std::set<int>{0});
  EXPECT_EQ(result.Faults->GetNumberOfCells(), 0);
  EXPECT_EQ(result.Repair, "none");
}

TEST(TetrahedralizeSurface, SphereInTrianglesAndStrips) {
  const auto sphere = Sphere(0.05, {0.1, 0.2, 0.3}, 24);
  const auto result = Meshed(sphere);
  ExpectGood(result, 4.0 / 3 * 3.14159265 * 0.05 * 0.05 * 0.05, 0.03);
  vtkNew<vtkStripper> stripper;
  stripper->SetInputData(sphere);
  stripper->Update();
  ASSERT_GT(stripper->GetOutput()->GetNumberOfStrips(), 0);
  ExpectGood(Meshed(stripper->GetOutput()), TotalVolume(result.Body), 1e-6);
}

TEST(TetrahedralizeSurface, SameInputSameMesh) {
  const auto first = Meshed(Sphere(1)), second = Meshed(Sphere(1));
  ASSERT_EQ(first.Body->GetNumberOfPoints(), second.Body->GetNumberOfPoints());
  ASSERT_EQ(first.Body->GetNumberOfCells(), second.Body->GetNumberOfCells());
  for (vtkIdType i = 0; i < first.Body->GetNumberOfPoints(); ++i) {
    double x[3], y[3];
    first.Body->GetPoint(i, x);
    second.Body->GetPoint(i, y);
    ASSERT_TRUE(std::equal(x, x + 3, y));
  }
}

TEST(TetrahedralizeSurface, QuadraticHasMiddlesInTheOrderOfVTK) {
  const auto linear = Meshed(Sphere(1));
  const auto result = Meshed(Sphere(1), [](Filter* f) { f->SetElementOrder(Filter::Quadratic); });
  ExpectGood(result, TotalVolume(linear.Body));
  ASSERT_EQ(result.Body->GetNumberOfCells(), linear.Body->GetNumberOfCells());
  vtkNew<vtkGenericCell> cell;
  for (vtkIdType i = 0; i < result.Body->GetNumberOfCells(); ++i) {
    ASSERT_EQ(result.Body->GetCellType(i), VTK_QUADRATIC_TETRA);
    result.Body->GetCell(i, cell);
    for (int edge = 0; edge < 6; ++edge) {
      // VTK gives an edge as its ends and its middle.
      double ends[2][3], middle[3];
      auto* points = cell->GetEdge(edge)->GetPoints();
      points->GetPoint(0, ends[0]);
      points->GetPoint(1, ends[1]);
      points->GetPoint(2, middle);
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_EQ(middle[axis], (ends[0][axis] + ends[1][axis]) / 2);
      }
    }
  }
  // Euler's formula for a ball: points − edges + faces − cells = 1. With it, middles are not
  // doubled.
  const vtkIdType cells = linear.Body->GetNumberOfCells();
  const vtkIdType corners = linear.Body->GetNumberOfPoints();
  const vtkIdType edges = result.Body->GetNumberOfPoints() - corners;
  std::set<std::array<vtkIdType, 3>> faces;
  for (vtkIdType i = 0; i < cells; ++i) {
    vtkIdType size;
    const vtkIdType* ids;
    linear.Body->GetCellPoints(i, size, ids);
    for (int out = 0; out < 4; ++out) {
      std::array<vtkIdType, 3> face = {ids[(out + 1) % 4], ids[(out + 2) % 4], ids[(out + 3) % 4]};
      std::sort(face.begin(), face.end());
      faces.insert(face);
    }
  }
  EXPECT_EQ(corners - edges + static_cast<vtkIdType>(faces.size()) - cells, 1);
}

TEST(TetrahedralizeSurface, MaximumVolumeHolds) {
  const auto result = Meshed(Cube(1), [](Filter* f) { f->SetMaximumVolume(1e-3); });
  ExpectGood(result, 1);
  const auto volumes = Volumes(result.Body);
  EXPECT_LE(*std::max_element(volumes.begin(), volumes.end()), 1e-3 * (1 + 1e-9));
}

TEST(TetrahedralizeSurface, RadiusEdgeRatioMakesADifference) {
  const auto coarse = Meshed(Sphere(1), [](Filter* f) { f->SetMaximumRadiusEdgeRatio(3); });
  const auto fine = Meshed(Sphere(1), [](Filter* f) { f->SetMaximumRadiusEdgeRatio(1.2); });
  ExpectGood(coarse, TotalVolume(fine.Body));
  EXPECT_LT(coarse.Body->GetNumberOfCells(), fine.Body->GetNumberOfCells());
}

TEST(TetrahedralizeSurface, PreserveSurfaceAddsNoPointsToIt) {
  const auto sphere = Sphere(1);
  const auto result = Meshed(sphere, [](Filter* f) { f->PreserveSurfaceOn(); });
  ExpectGood(result, SurfaceVolume(sphere));
  // Faces of one tetrahedron alone are the surface: as many as there were, on the same points.
  std::map<std::array<vtkIdType, 3>, int> uses;
  for (vtkIdType i = 0; i < result.Body->GetNumberOfCells(); ++i) {
    vtkIdType size;
    const vtkIdType* ids;
    result.Body->GetCellPoints(i, size, ids);
    for (int out = 0; out < 4; ++out) {
      std::array<vtkIdType, 3> face = {ids[(out + 1) % 4], ids[(out + 2) % 4], ids[(out + 3) % 4]};
      std::sort(face.begin(), face.end());
      ++uses[face];
    }
  }
  std::set<std::array<double, 3>> given;
  for (vtkIdType i = 0; i < sphere->GetNumberOfPoints(); ++i) {
    std::array<double, 3> x;
    sphere->GetPoint(i, x.data());
    given.insert(x);
  }
  vtkIdType surface_faces = 0;
  for (const auto& [face, count] : uses) {
    if (count != 1) {
      continue;
    }
    ++surface_faces;
    for (const vtkIdType id : face) {
      std::array<double, 3> x;
      result.Body->GetPoint(id, x.data());
      EXPECT_TRUE(given.count(x));
    }
  }
  EXPECT_EQ(surface_faces, sphere->GetNumberOfPolys());
}

TEST(TetrahedralizeSurface, RefinesTowardsARegion) {
  vtkNew<vtkSphere> region;
  region->SetCenter(0.5, 0.5, 0.5);
  region->SetRadius(0.3);
  const auto refine = [&region](Filter* f) {
    f->SetRefineRegion(region);
    f->SetRefineVolume(1e-4);
  };
  const auto coarse = Meshed(Cube(1));
  const auto result = Meshed(Cube(1), refine);
  ExpectGood(result, 1);
  EXPECT_GT(result.Body->GetNumberOfCells(), 4 * coarse.Body->GetNumberOfCells());
  double greatest_inside = 0, greatest = 0;
  const auto volumes = Volumes(result.Body);
  for (vtkIdType i = 0; i < result.Body->GetNumberOfCells(); ++i) {
    double centre[3] = {0, 0, 0};
    vtkIdType size;
    const vtkIdType* ids;
    result.Body->GetCellPoints(i, size, ids);
    for (vtkIdType j = 0; j < 4; ++j) {
      double x[3];
      result.Body->GetPoint(ids[j], x);
      for (int axis = 0; axis < 3; ++axis) {
        centre[axis] += x[axis] / 4;
      }
    }
    greatest = std::max(greatest, volumes[i]);
    if (region->EvaluateFunction(centre) < 0) {
      greatest_inside = std::max(greatest_inside, volumes[i]);
    }
  }
  EXPECT_LE(greatest_inside, 1e-4 * (1 + 1e-9));
  EXPECT_GT(greatest, 1e-3) << "refined elsewhere as well";
}

TEST(TetrahedralizeSurface, RefinesTowardsARegionSmallerThanATetrahedron) {
  vtkNew<vtkSphere> region;
  region->SetCenter(0.11, 0.07, 0.05);
  region->SetRadius(0.06);
  const auto coarse = Meshed(Cube(1));
  const auto result = Meshed(Cube(1), [&region](Filter* f) {
    f->SetRefineRegion(region);
    f->SetRefineVolume(1e-5);
    f->SetElementOrder(Filter::Quadratic);
  });
  ExpectGood(result, 1);
  EXPECT_GT(result.Body->GetNumberOfCells(), coarse.Body->GetNumberOfCells() + 50);
}

TEST(TetrahedralizeSurface, MovingTheRegionMeshesAgain) {
  vtkNew<vtkPlane> region;
  vtkNew<Filter> filter;
  filter->SetInputData(Cube(1));
  filter->SetRefineRegion(region);
  const auto before = filter->GetMTime();
  region->SetOrigin(1, 0, 0);
  EXPECT_EQ(filter->GetMTime(), before) << "a region that refines nothing";
  filter->SetRefineVolume(1e-3);
  const auto after = filter->GetMTime();
  region->SetOrigin(2, 0, 0);
  EXPECT_GT(filter->GetMTime(), after);
}

TEST(TetrahedralizeSurface, InsideOutSurface) {
  ExpectGood(Meshed(InsideOut(Sphere(1))), SurfaceVolume(Sphere(1)));
}

TEST(TetrahedralizeSurface, BodiesAreRegionsInTheOrderOfTheInput) {
  const auto result = Meshed(Append({Cube(1), Cube(2, {5, 0, 0}), InsideOut(Cube(3, {0, 9, 0}))}));
  ExpectGood(result, 1 + 8 + 27);
  EXPECT_EQ(Regions(result.Body), (std::set<int>{0, 1, 2}));
  EXPECT_NEAR(RegionVolume(result.Body, 0), 1, 1e-9);
  EXPECT_NEAR(RegionVolume(result.Body, 1), 8, 1e-9);
  EXPECT_NEAR(RegionVolume(result.Body, 2), 27, 1e-9);
}

TEST(TetrahedralizeSurface, NestedSurfacesAreCavitiesOrRegionsByTheirSense) {
  const auto hollow = Meshed(Append({Cube(3), InsideOut(Cube(1))}));
  ExpectGood(hollow, 26);
  EXPECT_EQ(Regions(hollow.Body), std::set<int>{0});

  const auto filled = Meshed(Append({Cube(3), Cube(1)}));
  ExpectGood(filled, 27);
  EXPECT_NEAR(RegionVolume(filled.Body, 0), 26, 1e-9);
  EXPECT_NEAR(RegionVolume(filled.Body, 1), 1, 1e-9);

  const auto floating = Meshed(Append({Cube(1), InsideOut(Cube(2)), Cube(3)}));
  ExpectGood(floating, 1 + 27 - 8);
  EXPECT_NEAR(RegionVolume(floating.Body, 0), 1, 1e-9);
  EXPECT_NEAR(RegionVolume(floating.Body, 1), 19, 1e-9);
}

TEST(TetrahedralizeSurface, BodiesThatTouchInAPoint) {
  const auto result = Meshed(Append({Cube(1), Cube(1, {1, 1, 1})}));
  ExpectGood(result, 2);
  EXPECT_EQ(Regions(result.Body), (std::set<int>{0, 1}));
}

TEST(SharedWalls, LayersOnceAndTwice) {
  const std::map<int, double> volumes = {{0, 16}, {1, 24}, {2, 8}};
  const auto twice = Append({Slab(0, 1), Slab(1, 2.5), Slab(2.5, 3)});
  const auto once = WallsOnce(twice);
  ASSERT_EQ(once->GetNumberOfCells(), twice->GetNumberOfCells() - 16);
  for (const auto& surface : {once, twice, InsideOut(once), InsideOut(twice)}) {
    for (const bool repair : {false, true}) {
      const auto result = Meshed(surface, [repair](Filter* f) { f->SetRepairSurface(repair); });
      ExpectRegions(result, volumes);
      EXPECT_EQ(result.Repair, repair ? "none needed" : "none");
      EXPECT_EQ(result.Faults->GetNumberOfCells(), 0);
      EXPECT_GE(FacesBetween(result.Body, 0, 1), 8);
      EXPECT_GE(FacesBetween(result.Body, 1, 2), 8);
      EXPECT_EQ(FacesBetween(result.Body, 0, 2), 0);
    }
  }
  ExpectRegions(Meshed(twice, [](Filter* f) { f->PreserveSurfaceOn(); }), volumes);
  ExpectRegions(Meshed(twice, [](Filter* f) { f->SetElementOrder(Filter::Quadratic); }), volumes);
}

TEST(SharedWalls, OneSurfaceIsInsideOut) {
  ExpectRegions(Meshed(Append({Slab(0, 1), InsideOut(Slab(1, 2.5)), Slab(2.5, 3)})),
                {{0, 16}, {1, 24}, {2, 8}});
  ExpectRegions(MeshedAll({InsideOut(Slab(0, 1)), Slab(1, 2.5), InsideOut(Slab(2.5, 3))}),
                {{0, 16}, {1, 24}, {2, 8}});
}

TEST(SharedWalls, SinglePrecisionFarFromTheOrigin) {
  // In mm, half a metre away, with walls that are off by their rounding.
  const auto rounded = [](vtkPolyData* surface, float jitter) {
    auto result = vtkSmartPointer<vtkPolyData>::New();
    result->DeepCopy(surface);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToFloat();
    for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i) {
      double x[3];
      surface->GetPoint(i, x);
      for (double& coordinate : x) {
        coordinate = static_cast<float>(500.1 + 10 * coordinate) * (1 + jitter);
      }
      points->InsertNextPoint(x);
    }
    result->SetPoints(points);
    return result;
  };
  for (const bool append : {false, true}) {
    const auto lower = rounded(Slab(0, 1, 5), 0), upper = rounded(Slab(1, 2, 5), 1e-7F);
    const auto in_mm = [](Filter* f) { f->SetUnit(2); };
    const auto result =
        append ? Meshed(Append({lower, upper}), in_mm) : MeshedAll({lower, upper}, in_mm);
    ExpectRegions(result, {{0, 1.6e-5}, {1, 1.6e-5}}, 1e-5);
    EXPECT_GE(FacesBetween(result.Body, 0, 1), 50);
  }
}

TEST(SharedWalls, DoubledPointsAndTrianglesWithoutAnArea) {
  const auto lower = Slab(0, 1), upper = Slab(1, 2);
  // On the rim of the wall: one of its edges has a point in its middle in one tissue alone.
  auto spoilt = vtkSmartPointer<vtkPolyData>::New();
  spoilt->DeepCopy(upper);
  double placeOfA[] = {0, 0, 1}, placeOfB[] = {2, 0, 1};
  const vtkIdType a = spoilt->FindPoint(placeOfA), b = spoilt->FindPoint(placeOfB);
  const vtkIdType middle = spoilt->GetPoints()->InsertNextPoint(1, 0, 1);
  vtkNew<vtkCellArray> triangles;
  int split = 0;
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < upper->GetNumberOfCells(); ++i) {
    upper->GetCellPoints(i, ids);
    for (int k = 0; k < 3; ++k) {
      const bool forward = ids->GetId(k) == a && ids->GetId((k + 1) % 3) == b;
      if (forward) {
        triangles->InsertNextCell({a, middle, b});
        ++split;
      }
    }
    triangles->InsertNextCell(ids);
    if (i % 7 == 0) {
      triangles->InsertNextCell({ids->GetId(0), ids->GetId(1), ids->GetId(1)});
    }
  }
  ASSERT_EQ(split, 1);
  // The triangle without an area closes the surface where the others leave it open.
  for (vtkIdType i = 0; i < triangles->GetNumberOfCells(); ++i) {
    triangles->GetCellAtId(i, ids);
    if (ids->GetId(1) == middle) {
      triangles->ReplaceCellAtId(i, {a, b, middle});
      triangles->InsertNextCell({a, middle, b});
      break;
    }
  }
  spoilt->SetPolys(triangles);
  ExpectRegions(MeshedAll({lower, spoilt}), {{0, 16}, {1, 16}});
  ExpectRegions(MeshedAll({spoilt, lower}), {{0, 16}, {1, 16}});
}

TEST(SharedWalls, TheRegionArrayNamesThem) {
  const auto labelled = Append({Labelled(Slab(0, 1), 7), Labelled(Slab(1, 2.5), -3)});
  ExpectRegions(Meshed(labelled), {{-3, 24}, {7, 16}});
  // The wall has the number of one of the two alone, and the surface of the other is open.
  ExpectRegions(Meshed(WallsOnce(labelled)), {{-3, 24}, {7, 16}});
  ExpectRegions(Meshed(labelled, [](Filter* f) { f->SetRegionArray("None"); }), {{0, 16}, {1, 24}});
  // Two bodies of one tissue, and a tumour within a third.
  ExpectRegions(Meshed(Append({Labelled(Cube(1), 4), Labelled(Cube(1, {5, 0, 0}), 4),
                               Labelled(Cube(3, {0, 9, 0}), 1), Labelled(Cube(1, {0, 9, 0}), 2)})),
                {{1, 26}, {2, 1}, {4, 2}});
  const auto solids = Append(
      {Labelled(Slab(0, 1), 0, "STLSolidLabeling"), Labelled(Slab(1, 2), 1, "STLSolidLabeling")});
  ExpectRegions(Meshed(solids, [](Filter* f) { f->SetRegionArray("STLSolidLabeling"); }),
                {{0, 16}, {1, 16}});
  ExpectError(Meshed(labelled, [](Filter* f) { f->SetRegionArray("Tissue"); }),
              {"RegionArray", "Tissue"});
  auto broken = Labelled(Cube(1), 1);
  vtkNew<vtkDoubleArray> halves;
  halves->SetName("Region");
  halves->SetNumberOfValues(broken->GetNumberOfCells());
  halves->FillValue(0.5);
  broken->GetCellData()->AddArray(halves);
  ExpectError(Meshed(broken), {"0.5", "Region", "whole number", "RegionArray"});
  // Fewer or more values than there are triangles.
  for (const int number : {3, 3000}) {
    halves->SetNumberOfValues(number);
    ExpectError(Meshed(broken), {"cell array 'Region'", std::to_string(number) + " values"});
  }
}

TEST(SharedWalls, NumbersWithoutAWallBetweenThemAreTold) {
  auto skin = Labelled(Cube(1), 0);
  vtkIntArray::SafeDownCast(skin->GetCellData()->GetArray("Region"))->SetValue(0, 1);
  const auto result = MeshedAll({skin});
  ExpectGood(result, 1);
  EXPECT_EQ(Regions(result.Body), std::set<int>{0});
  ASSERT_EQ(result.Warnings.size(), 1u);
  EXPECT_NE(result.Warnings[0].find("no wall between"), std::string::npos) << result.Warnings[0];
  EXPECT_NE(result.Warnings[0].find("Region 1"), std::string::npos) << result.Warnings[0];
}

TEST(SharedWalls, CollectionsAreRegionsWithNames) {
  vtkNew<vtkMultiBlockDataSet> tissues, group;
  tissues->SetBlock(0, Slab(0, 1));
  tissues->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), "skin");
  group->SetBlock(0, Slab(1, 2.5));
  group->GetMetaData(0u)->Set(vtkCompositeDataSet::NAME(), "fat");
  tissues->SetBlock(1, group);
  const auto result = MeshedAll({tissues});
  ExpectRegions(result, {{0, 16}, {1, 24}});
  auto* names =
      vtkStringArray::SafeDownCast(result.Body->GetFieldData()->GetAbstractArray("RegionName"));
  ASSERT_TRUE(names);
  EXPECT_EQ(names->GetValue(0), "skin");
  EXPECT_EQ(names->GetValue(1), "fat");

  vtkNew<vtkPartitionedDataSetCollection> sets;
  sets->SetPartition(0, 0, Without(Slab(0, 1), {0, 1, 2}));
  const auto rest = Slab(0, 1);
  std::vector<vtkIdType> others;
  for (vtkIdType i = 3; i < rest->GetNumberOfCells(); ++i) {
    others.push_back(i);
  }
  sets->SetPartition(0, 1, Without(rest, others));
  sets->SetPartition(1, 0, Slab(1, 2.5));
  ExpectRegions(MeshedAll({sets}), {{0, 16}, {1, 24}});

  vtkNew<vtkMultiBlockDataSet> wrong;
  wrong->SetBlock(0, Slab(0, 1));
  wrong->SetBlock(1, result.Body);
  wrong->GetMetaData(1u)->Set(vtkCompositeDataSet::NAME(), "filled");
  ExpectError(MeshedAll({wrong}), {"'filled'", "vtkUnstructuredGrid", "Extract Surface"});
}

TEST(SharedWalls, TissuesThatEncloseTheSameSpaceAreRefused) {
  // The walls fit each other: nothing crosses, but the middle belongs to both.
  const auto twice = MeshedAll({Slab(0, 1), Slab(0, 1)});
  ExpectError(twice, {"The regions 0 and 1 overlap", "16 m³", "(2, 2, 0.5)", "WallTolerance"});
  EXPECT_EQ(twice.Faults->GetNumberOfCells(), 32);
  const auto crossing = MeshedAll({Slab(0, 1.1), Slab(1, 2)});
  ExpectError(crossing, {"cross each other", "0 and 1 reach into each other by 0.1 m"});
  EXPECT_EQ(crossing.Errors[0].find("RepairSurface"), std::string::npos) << crossing.Errors[0];
  // Without numbers, and where nothing crosses, the parts of the input tell.
  const auto nameless = Meshed(Append({Slab(0, 2, 2), Slab(0, 2, 2, 4, 2)}));
  ExpectError(nameless, {"overlap"});
  EXPECT_GT(crossing.Faults->GetNumberOfCells(), 0);
}

TEST(SharedWalls, ATumourMayReachTheSkin) {
  // The wall on the skin is there twice, with the same normals.
  const auto organ = WallsOnce(Append({Slab(0, 1), Slab(1, 3)}));
  auto whole = Append({Slab(0, 1), Slab(1, 3)});
  std::vector<vtkIdType> wall;
  for (vtkIdType i = 0; i < whole->GetNumberOfCells(); ++i) {
    double b[6];
    whole->GetCell(i)->GetBounds(b);
    if (b[4] == 1 && b[5] == 1) {
      wall.push_back(i);
    }
  }
  ExpectRegions(MeshedAll({Without(whole, wall), Slab(1, 3)}), {{0, 16}, {1, 32}});
}

TEST(SharedWalls, ACavityAtAWall) {
  // Two tissues around a hole: its walls hang together with theirs, and are there once.
  std::vector<vtkSmartPointer<vtkPolyData>> boxes;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k) {
        if (i != 1 || j != 1 || k != 1) {
          boxes.push_back(Labelled(Triangles(Cube(1, {1. * i, 1. * j, 1. * k})), i == 0 ? 5 : 6));
        }
      }
    }
  }
  // Walls within a tissue divide it, but not its number.
  const auto result = Meshed(Append(boxes));
  ExpectRegions(result, {{5, 9}, {6, 17}});
  EXPECT_GT(FacesBetween(result.Body, 5, 6), 0);
}

TEST(SharedWalls, TriangulatedOtherwise) {
  const std::map<int, double> volumes = {{0, 16}, {1, 24}};
  // Another diagonal, other squares, both; a wall that is one of two copies of a wall already.
  for (const int n : {2, 3, 4}) {
    for (const bool diagonal : {false, true}) {
      const auto lower = Slab(0, 1), upper = Slab(1, 2.5, n, 4, 0, diagonal);
      SCOPED_TRACE(n + 100 * diagonal);
      ExpectRegions(MeshedAll({lower, upper}), volumes);
      ExpectRegions(Meshed(Append({lower, upper})), volumes);
      ExpectRegions(MeshedAll({upper, lower}), {{0, 24}, {1, 16}});
    }
  }
}

TEST(SharedWalls, OfDifferentSize) {
  // Each has a part of its face in contact, and cuts the triangles of the other.
  const auto lower = Slab(0, 1), shifted = Slab(1, 2, 3, 3, 1.1);
  ExpectRegions(MeshedAll({lower, shifted}), {{0, 16}, {1, 9}});
  ExpectRegions(MeshedAll({shifted, lower}), {{0, 9}, {1, 16}});
  const auto small = Cube(0.5, {1.3, 1.2, 1.25});
  ExpectRegions(MeshedAll({lower, small}), {{0, 16}, {1, 0.125}});
  ExpectRegions(MeshedAll({small, lower}), {{0, 0.125}, {1, 16}});
}

TEST(SharedWalls, ApartOrOverlappingByLessThanTheTolerance) {
  const auto lower = Slab(0, 1);
  const auto tolerant = [](Filter* f) { f->SetWallTolerance(2e-3); };
  for (const int n : {2, 3}) {
    for (const double z : {1 - 1e-3, 1 + 1e-3}) {
      const auto result = MeshedAll({lower, Slab(z, 2, n)}, tolerant);
      // The first keeps its shape, the second reaches up to it.
      ExpectRegions(result, {{0, 16}, {1, 16}});
      EXPECT_GT(FacesBetween(result.Body, 0, 1), 0);
      EXPECT_NE(result.Repair.find("at most 0.001 m away"), std::string::npos) << result.Repair;
      const auto parts = Meshed(Append({lower, Slab(z, 2, n)}), tolerant);
      ExpectRegions(parts, {{0, 16}, {1, 16}});
    }
    ExpectError(MeshedAll({lower, Slab(1 - 1e-3, 2, n)}),
                {"0 and 1 reach into each other by 0.001 m", "WallTolerance"});
  }
  ExpectError(MeshedAll({lower}, [](Filter* f) { f->SetWallTolerance(-1); }), {"WallTolerance"});
}

/// What a message says the walls of surfaces to be apart, m.
double ToleranceOf(const Result& result) {
  const std::string words = "Walls lie up to ";
  const auto& text = result.Errors.empty() ? "" : result.Errors.front();
  const std::size_t place = text.find(words);
  return place == std::string::npos ? 0 : std::stod(text.substr(place + words.size()));
}

// The advice is what helps: of walls that are apart at one end and cross at the other, also where a
// smaller tolerance was given, it is their largest distance and not the depth of the overlap.
TEST(SharedWalls, TheToleranceThatIsAdvisedHelps) {
  for (const auto& [low, high] : {std::pair(-1e-3, 4e-3), {-4e-3, 1e-3}, {0.0, 4e-3}}) {
    auto tilted = Slab(1, 2, 3);
    for (vtkIdType i = 0; i < tilted->GetNumberOfPoints(); ++i) {
      double x[3];
      tilted->GetPoint(i, x);
      if (x[2] != 1) continue;
      x[2] += low + (high - low) * x[0] / 4;
      tilted->GetPoints()->SetPoint(i, x);
    }
    for (const double given : {0.0, 5e-4, 2e-3}) {
      const auto result =
          Meshed(Append({Slab(0, 1), tilted}), [&](Filter* f) { f->SetWallTolerance(given); });
      ExpectError(result, {"WallTolerance", "RepairSurface would join them to one region"});
      const double advised = ToleranceOf(result);
      EXPECT_NEAR(advised, 4e-3, 1e-4);
      if (given > 0) continue;
      const auto mended = Meshed(Append({Slab(0, 1), tilted}),
                                 [&](Filter* f) { f->SetWallTolerance(1.01 * advised); });
      EXPECT_TRUE(mended.Errors.empty());
      EXPECT_GT(FacesBetween(mended.Body, 0, 1), 0);
    }
  }
}

// Their outline has a new point where any two edges meet: it would take minutes to draw.
TEST(SharedWalls, SurfacesThatCrossEachOtherAreNotDrawnIntoEachOther) {
  const auto surface =
      vtkPalpateSurfaceFromPolyData(Triangles(Append({Cube(0.3), Sphere(0.1, {0, 0, 0.06}, 180)})));
  const auto matched = vtkPalpateMatchWalls(surface, 4e-4);
  EXPECT_TRUE(matched.IsGivenUp);
  EXPECT_EQ(matched.Replaced, 0);
  EXPECT_EQ(matched.Surfaces.Triangles, surface.Triangles);
}

TEST(SharedWalls, BodiesWithAGapBetweenThemAreTold) {
  const auto apart = MeshedAll({Slab(0, 1), Slab(1.001, 2, 3)});
  ExpectGood(apart, 16 + 15.984);
  ASSERT_EQ(apart.Warnings.size(), 1u);
  EXPECT_NE(apart.Warnings[0].find("a distance of 0.001 m, near ("), std::string::npos)
      << apart.Warnings[0];
  EXPECT_NE(apart.Warnings[0].find("WallTolerance"), std::string::npos);
  // Not where they are far from each other.
  ExpectRegions(MeshedAll({Slab(0, 1), Slab(1.1, 2, 3)}), {{0, 16}, {1, 14.4}});
}

// A dent in the wall of one region, which the other does not have, is a void that nobody meant:
// TetGen fills what is around it with cells as small as it is thin, or gives up.
TEST(SharedWalls, AThinVoidBetweenRegionsIsTold) {
  const auto lower = Slab(0, 1, 8);
  const auto dented = [](double depth) {
    auto slab = Slab(1, 2, 8);
    for (vtkIdType i = 0; i < slab->GetNumberOfPoints(); ++i) {
      double x[3];
      slab->GetPoint(i, x);
      if (std::abs(x[0] - 2) > 0.6 || std::abs(x[1] - 2) > 0.6 || x[2] > 1.5) continue;
      slab->GetPoints()->SetPoint(i, x[0], x[1], 1 + depth);
    }
    return slab;
  };
  const auto expect_told = [](const std::vector<std::string>& messages, const std::string& depth) {
    ASSERT_EQ(messages.size(), 1u);
    for (const std::string& words :
         {std::string("close in a void"), "set WallTolerance to a little more than " + depth}) {
      EXPECT_NE(messages[0].find(words), std::string::npos) << messages[0];
    }
  };
  const auto meshed =
      MeshedAll({lower, dented(0.005)}, [](Filter* f) { f->SetMaximumRadiusEdgeRatio(20); });
  EXPECT_TRUE(meshed.Errors.empty());
  expect_told(meshed.Warnings, "0.005 m");
  const auto stopped = MeshedAll({lower, dented(1e-4)}, [](Filter* f) { f->SetTimeOut(0.02); });
  expect_told(stopped.Errors, "0.0001 m");
  const auto mended =
      MeshedAll({lower, dented(0.005)}, [](Filter* f) { f->SetWallTolerance(0.0051); });
  ExpectRegions(mended, {{0, 16}, {1, 16}}, 1e-3);
  EXPECT_TRUE(mended.Warnings.empty());
}

TEST(SharedWalls, CurvedWallsTriangulatedOtherwise) {
  // A core in a shell: facets of 24 and of 20 meridians lie up to 1 % of the radius apart.
  const auto hull = Append({Sphere(2, {0, 0, 0}, 24), InsideOut(Sphere(1, {0, 0, 0}, 24))});
  const auto core = Sphere(1, {0, 0, 0}, 20);
  const auto result = MeshedAll({hull, core}, [](Filter* f) { f->SetWallTolerance(0.03); });
  const double inner = vtkPalpateVolume(vtkPalpateSurfaceFromPolyData(Sphere(1, {0, 0, 0}, 24)));
  const double outer = vtkPalpateVolume(vtkPalpateSurfaceFromPolyData(Sphere(2, {0, 0, 0}, 24)));
  ExpectRegions(result, {{0, outer - inner}, {1, inner}}, 1e-6);
  EXPECT_NEAR(inner / vtkPalpateVolume(vtkPalpateSurfaceFromPolyData(core)), 1, 0.02);
  ExpectError(MeshedAll({hull, core}),
              {"regions 0 and 1 reach into each other by 0.0", "near (", "WallTolerance"});
}

TEST(SharedWalls, RepairKeepsThem) {
  const auto repair = [](Filter* f) { f->RepairSurfaceOn(); };
  // A hole in the skin of one, and a triangle the wrong way round in the other.
  const auto mended = Meshed(Append({Without(Slab(0, 1), {0}), Slab(1, 2)}), repair);
  ExpectRegions(mended, {{0, 16}, {1, 16}});
  const auto open = MeshedAll({Without(Slab(0, 1), {2}), Slab(1, 2)}, repair);
  ExpectRegions(open, {{0, 16}, {1, 16}});
  EXPECT_NE(open.Repair.find("filled holes"), std::string::npos) << open.Repair;
  // What cannot be mended without joining them is refused, with the volume of each.
  ExpectError(MeshedAll({Slab(0, 1.1), Slab(1, 2)}, repair),
              {"joins the regions", "0 (17.6 m³), 1 (16 m³)", "near ("});
  ExpectError(Meshed(Append({Slab(0, 1), Slab(1, 2), Slab(1.5, 3)}), repair),
              {"joins the regions", "0 (16 m³), 1 (16 m³)", "near ("});
}

TEST(TetrahedralizeSurface, AnyUnitAndPlace) {
  const double unit = SurfaceVolume(Sphere(1));
  for (const double factor : {1e-9, 1e-3, 1e9}) {
    const auto result = Meshed(Scaled(Sphere(1), factor, 5 * factor));
    ExpectGood(result, factor * factor * factor * unit, 1e-6);
    const double most = 1e-3 * factor * factor * factor;
    const auto bounded =
        Meshed(Scaled(Sphere(1), factor), [most](Filter* f) { f->SetMaximumVolume(most); });
    const auto volumes = Volumes(bounded.Body);
    EXPECT_LE(*std::max_element(volumes.begin(), volumes.end()), most * (1 + 1e-9));
  }
}

TEST(TetrahedralizeSurface, BadSurfacesAreOneErrorAndAPicture) {
  vtkNew<vtkPolyData> empty;
  ExpectError(Meshed(empty), {"no triangles"});

  auto nan = Sphere(1);
  nan->GetPoints()->SetPoint(7, std::nan(""), 0, 0);
  ExpectError(Meshed(nan), {"Point 7", "not finite"});

  const auto open = Meshed(Without(Cube(2), {0}));
  ExpectError(open, {"4 open edges", "(-1, ", "RepairSurface"});
  EXPECT_EQ(open.Faults->GetNumberOfLines(), 4);

  const auto shared_edge = Meshed(Append({Cube(1), Cube(1, {1, 1, 0})}));
  ExpectError(shared_edge, {"1 edge of more than two triangles", "RepairSurface"});

  const auto inconsistent = Meshed(FromArrays({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                                              {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 2, 3}}));
  ExpectError(inconsistent, {"3 edges of two triangles with opposite normals", "RepairSurface"});

  const auto crossing = Meshed(Append({Cube(1), Cube(1, {0.3, 0.4, 0.5})}));
  ExpectError(crossing, {"pairs of triangles that cross each other", "near (", "RepairSurface"});
  EXPECT_GT(crossing.Faults->GetNumberOfPolys(), 0);
}

TEST(TetrahedralizeSurface, BadPropertiesAreOneError) {
  const auto bad = [](const Settings& settings, const char* name) {
    ExpectError(Meshed(Cube(1), settings), {name});
  };
  const double nan = std::nan("");
  bad([](Filter* f) { f->SetElementOrder(3); }, "ElementOrder");
  bad([](Filter* f) { f->SetMaximumRadiusEdgeRatio(0.9); }, "MaximumRadiusEdgeRatio");
  bad([nan](Filter* f) { f->SetMaximumRadiusEdgeRatio(nan); }, "MaximumRadiusEdgeRatio");
  bad([](Filter* f) { f->SetMaximumVolume(-1); }, "MaximumVolume");
  bad([](Filter* f) { f->SetMaximumVolume(1e-12); }, "MaximumVolume");
  bad([](Filter* f) { f->SetRefineVolume(-1); }, "RefineVolume");
  bad([](Filter* f) { f->SetRepairResolution(3); }, "RepairResolution");
  bad([](Filter* f) { f->SetRepairResolution(100000); }, "RepairResolution");
  bad([](Filter* f) { f->SetTimeOut(-1); }, "TimeOut");
}

TEST(TetrahedralizeSurface, RepairClosesAHole) {
  const auto result = Meshed(Without(Cube(2), {0}), [](Filter* f) { f->RepairSurfaceOn(); });
  ExpectGood(result, 8);
  EXPECT_NE(result.Repair.find("filled holes"), std::string::npos) << result.Repair;
  EXPECT_EQ(result.Faults->GetNumberOfLines(), 4) << "the faults of the surface as it came";
}

TEST(TetrahedralizeSurface, RepairJoinsBodiesThatCross) {
  const auto result = MeshedAll({Append({Sphere(1, {0, 0, 0}, 24), Sphere(1, {1, 0, 0}, 24)})},
                                [](Filter* f) { f->RepairSurfaceOn(); });
  ASSERT_EQ(result.Warnings.size(), 1u);
  EXPECT_NE(result.Warnings[0].find("before 0 (4.12182 m³), 1 (4.12182 m³); after 0 (6.9"),
            std::string::npos)
      << result.Warnings[0];
  EXPECT_NE(result.Repair.find("joined or dropped regions"), std::string::npos) << result.Repair;
  ExpectGood(result, 2 * (4 * 3.14159265 / 3 - 3.14159265 * 0.625 / 3), 0.03);
  EXPECT_EQ(Regions(result.Body), std::set<int>{0});
}

TEST(TetrahedralizeSurface, TheSharedLiver) {
  if (std::string(PALPATE_SHARED_DATA).empty()) {
    GTEST_SKIP() << "no shared data";
  }
  vtkNew<vtkSTLReader> reader;
  reader->SetFileName(PALPATE_SHARED_DATA "/liver.stl");
  reader->Update();
  const auto bare = Meshed(reader->GetOutput());
  ExpectError(bare,
              {"7 pairs of triangles that cross each other", "near (-0.0060", "RepairSurface"});
  EXPECT_EQ(bare.Faults->GetNumberOfPolys(), 8);
  for (const bool preserve : {false, true}) {
    const auto repaired = Meshed(reader->GetOutput(), [preserve](Filter* f) {
      f->RepairSurfaceOn();
      f->SetPreserveSurface(preserve);
    });
    ExpectGood(repaired, 1.206e-3, 0.02);
  }
}

TEST(TetGenProcess, FailureCrashAndGarbageAreOneErrorWithItsLastWords) {
  const TemporaryFolder folder;
  {
    FakeTetGen fake("echo first; echo the last words >&2; exit 3");
    ExpectError(Meshed(Cube(1)), {"exit code 3", "the last words", "RepairSurface"});
  }
  {
    FakeTetGen fake("echo oh no >&2; kill -ABRT $$");
    ExpectError(Meshed(Cube(1)), {"signal 6", "oh no"});
  }
  {
    FakeTetGen fake("echo this is no mesh");
    ExpectError(Meshed(Cube(1)), {"no readable mesh"});
  }
  {
    FakeTetGen fake("echo '<?xml version=\"1.0\"?><VTKFile type=\"UnstructuredGrid\"><Unstr'");
    ExpectError(Meshed(Cube(1)), {"no readable mesh"});
  }
  {
    FakeTetGen fake("exec cat");  // a data set, but the surface itself
    ExpectError(Meshed(Cube(1)), {"no readable mesh"});
  }
  EXPECT_TRUE(folder.Empty());
}

TEST(TetGenProcess, HangIsStoppedWithAllThatItStarted) {
  const TemporaryFolder folder;
  const auto mark = folder.Path / "still-alive";
  {
    FakeTetGen fake("echo waiting >&2; (sleep 1; touch " + mark.string() + ") & wait; sleep 60");
    const auto start = std::chrono::steady_clock::now();
    ExpectError(Meshed(Cube(1), [](Filter* f) { f->SetTimeOut(0.2); }), {"TimeOut", "waiting"});
    const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
    EXPECT_LT(time.count(), 30);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));
  EXPECT_FALSE(std::filesystem::exists(mark)) << "what it started lives on";
  EXPECT_TRUE(folder.Empty());
}

TEST(TetGenProcess, AbortStopsItWithoutAnError) {
  FakeTetGen fake("sleep 60");
  CaughtMessages messages;
  vtkNew<Filter> filter;
  filter->SetInputData(Cube(1));
  vtkNew<vtkCallbackCommand> abort;
  abort->SetCallback([](vtkObject* caller, unsigned long, void*, void*) {
    auto* algorithm = static_cast<vtkAlgorithm*>(caller);
    if (algorithm->GetProgress() > 0.4) {
      algorithm->SetAbortExecute(1);
    }
  });
  filter->AddObserver(vtkCommand::ProgressEvent, abort);
  const auto start = std::chrono::steady_clock::now();
  filter->Update();
  const std::chrono::duration<double> time = std::chrono::steady_clock::now() - start;
  EXPECT_LT(time.count(), 30);
  EXPECT_TRUE(messages.Errors().empty());
  EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 0);
}

TEST(TetGenProcess, MissingProgramIsOneError) {
  setenv("PALPATE_TETGEN", "/nowhere/palpate-tetgen", 1);
  ExpectError(Meshed(Cube(1)), {"PALPATE_TETGEN", "/nowhere/palpate-tetgen"});
  unsetenv("PALPATE_TETGEN");
}

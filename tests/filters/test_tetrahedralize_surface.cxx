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
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkGenericCell.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkPalpateTetrahedralizeSurface.h"
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
  std::vector<std::string> Errors;
  unsigned long ErrorCode;
  std::string Repair;
};

Result Meshed(vtkPolyData* surface, const Settings& settings = nullptr) {
  CaughtMessages messages;
  vtkNew<Filter> filter;
  filter->SetInputData(surface);
  if (settings) {
    settings(filter);
  }
  filter->Update();
  Result result;
  result.Body = filter->GetOutput();
  result.Faults = vtkPolyData::SafeDownCast(filter->GetOutputDataObject(1));
  result.Errors = messages.Errors();
  result.ErrorCode = filter->GetErrorCode();
  if (auto* text =
          vtkStringArray::SafeDownCast(result.Body->GetFieldData()->GetAbstractArray("Repair"))) {
    result.Repair = text->GetValue(0);
  }
  EXPECT_TRUE(messages.Others().empty()) << messages.Others().front();
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
  const auto result = Meshed(Append({Sphere(1, {0, 0, 0}, 24), Sphere(1, {1, 0, 0}, 24)}),
                             [](Filter* f) { f->RepairSurfaceOn(); });
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

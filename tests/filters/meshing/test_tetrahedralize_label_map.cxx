// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "vtkCallbackCommand.h"
#include "vtkCellData.h"
#include "vtkCommand.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkIntArray.h"
#include "vtkMath.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPalpateTetrahedralizeLabelMap.h"
#include "vtkPalpateUnit.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"
#include "vtkUnstructuredGrid.h"

namespace {
constexpr double Millimetre = 1e-3;

/// What a filter says, as long as this is there.
class Messages {
 public:
  std::string Errors;
  std::string Warnings;

  explicit Messages(vtkObject* of) : Of(of) {
    vtkNew<vtkCallbackCommand> command;
    command->SetClientData(this);
    command->SetCallback([](vtkObject*, unsigned long kind, void* self, void* text) {
      auto* messages = static_cast<Messages*>(self);
      (kind == vtkCommand::ErrorEvent ? messages->Errors : messages->Warnings) +=
          static_cast<const char*>(text);
    });
    Tags = {of->AddObserver(vtkCommand::ErrorEvent, command),
            of->AddObserver(vtkCommand::WarningEvent, command)};
  }
  ~Messages() {
    for (const unsigned long tag : Tags) {
      Of->RemoveObserver(tag);
    }
  }
  Messages(const Messages&) = delete;
  Messages& operator=(const Messages&) = delete;

 private:
  vtkObject* Of;
  std::array<unsigned long, 2> Tags{};
};

/// Labels by their place in voxels.
vtkSmartPointer<vtkImageData> MakeImage(const std::array<int, 3>& size,
                                        const std::function<int(double, double, double)>& label) {
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(size.data());
  vtkNew<vtkIntArray> labels;
  labels->SetName("labels");
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) {
        labels->InsertNextValue(label(i, j, k));
      }
    }
  }
  image->GetPointData()->SetScalars(labels);
  return image;
}

/// What is to be true of each body.
struct Body {
  vtkSmartPointer<vtkUnstructuredGrid> Grid;
  std::map<int, double> Volumes;  ///< of the tetrahedra of each label, m³
  std::map<int, double> Error;    ///< as told, relative to the image
  /// Triangles between two labels, the smaller one first.
  std::map<std::pair<int, int>, int> Walls;

  explicit Body(vtkUnstructuredGrid* grid) : Grid(vtkSmartPointer<vtkUnstructuredGrid>::New()) {
    // The filter's own is another one after its next run.
    Grid->ShallowCopy(grid);
    auto* region = grid->GetCellData()->GetArray("RegionId");
    constexpr int faces[4][3] = {{0, 1, 2}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    std::map<std::array<vtkIdType, 3>, std::vector<int>> labels_at;
    for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
      vtkIdType size;
      const vtkIdType* ids;
      grid->GetCellPoints(cell, size, ids);
      double x[4][3];
      for (int i = 0; i < 4; ++i) {
        grid->GetPoint(ids[i], x[i]);
      }
      double u[3], v[3], w[3];
      vtkMath::Subtract(x[1], x[0], u);
      vtkMath::Subtract(x[2], x[0], v);
      vtkMath::Subtract(x[3], x[0], w);
      const double volume = vtkMath::Determinant3x3(u, v, w) / 6;
      EXPECT_GT(volume, 0) << "cell " << cell;
      const int label = static_cast<int>(region->GetTuple1(cell));
      Volumes[label] += volume;
      for (const auto& face : faces) {
        std::array<vtkIdType, 3> corners = {ids[face[0]], ids[face[1]], ids[face[2]]};
        std::sort(corners.begin(), corners.end());
        labels_at[corners].push_back(label);
      }
    }
    for (auto& [corners, labels] : labels_at) {
      EXPECT_LE(labels.size(), 2U);
      labels.resize(2, 0);
      if (labels[0] != labels[1]) {
        ++Walls[std::minmax(labels[0], labels[1])];
      }
    }
    auto* told = grid->GetFieldData();
    for (vtkIdType i = 0; i < told->GetArray("Label")->GetNumberOfTuples(); ++i) {
      const int label = static_cast<int>(told->GetArray("Label")->GetTuple1(i));
      const double mesh = told->GetArray("MeshVolume")->GetTuple1(i);
      // TetGen takes facets for plane that are so to its tolerance.
      EXPECT_NEAR(mesh, Volumes[label], 1e-3 * mesh) << "label " << label;
      Error[label] = mesh / told->GetArray("ImageVolume")->GetTuple1(i) - 1;
    }
  }
};

/// A connected part of a label by faces of voxels, found in another way than the filter's.
struct ImagePart {
  int Label;
  double Volume;                 ///< m³
  std::array<double, 3> Middle;  ///< m
  std::vector<vtkIdType> Voxels;
};

/// All of labels above 0.
std::vector<ImagePart> PartsOf(vtkImageData* image) {
  int n[3];
  image->GetDimensions(n);
  vtkDataArray* labels = image->GetPointData()->GetScalars();
  const double* spacing = image->GetSpacing();
  const double voxel = spacing[0] * spacing[1] * spacing[2] * std::pow(Millimetre, 3);
  std::vector<char> seen(static_cast<std::size_t>(image->GetNumberOfPoints()), 0);
  std::vector<ImagePart> parts;
  for (vtkIdType first = 0; first < image->GetNumberOfPoints(); ++first) {
    const double label = labels->GetTuple1(first);
    if (label <= 0 || seen[first] != 0) {
      continue;
    }
    ImagePart part{static_cast<int>(label), 0, {}, {first}};
    seen[first] = 1;
    for (std::size_t next = 0; next < part.Voxels.size(); ++next) {
      const vtkIdType at = part.Voxels[next];
      const int ijk[3] = {static_cast<int>(at % n[0]), static_cast<int>(at / n[0] % n[1]),
                          static_cast<int>(at / n[0] / n[1])};
      const vtkIdType stride[3] = {1, n[0], static_cast<vtkIdType>(n[0]) * n[1]};
      for (int axis = 0; axis < 3; ++axis) {
        for (const int step : {-1, 1}) {
          const bool inside = ijk[axis] + step >= 0 && ijk[axis] + step < n[axis];
          const vtkIdType to = at + step * stride[axis];
          if (inside && seen[to] == 0 && labels->GetTuple1(to) == label) {
            seen[to] = 1;
            part.Voxels.push_back(to);
          }
        }
      }
      double x[3];
      image->GetPoint(at, x);
      for (int axis = 0; axis < 3; ++axis) {
        part.Middle[axis] += Millimetre * x[axis];
      }
    }
    for (double& x : part.Middle) {
      x /= static_cast<double>(part.Voxels.size());
    }
    part.Volume = voxel * static_cast<double>(part.Voxels.size());
    parts.push_back(part);
  }
  return parts;
}

/// "(1, 2, 3) m", as messages have places.
std::string PlaceText(const std::array<double, 3>& x) {
  std::ostringstream text;
  text.precision(3);
  text << '(' << x[0] << ", " << x[1] << ", " << x[2] << ") m";
  return text.str();
}

struct PartFigures {
  int Parts = 0;
  int Kept = 0;         ///< to 2 % of their volume
  int Lost = 0;         ///< and named
  int Off = 0;          ///< kept, but not to 2 %, and named
  int Split = 0;        ///< in pieces, and named
  int Joined = 0;       ///< with another one, and named
  double Worst = 0;     ///< error of the volume of those kept to 2 %
  double Farthest = 0;  ///< of those kept, from the place in the image, in millimetres
};

/// Each part is kept with its volume, apart from others and in one piece, or is named.
void ExpectPartsKeptOrNamed(vtkImageData* image, vtkUnstructuredGrid* grid,
                            const std::string& warnings, PartFigures& figures) {
  const std::vector<ImagePart> parts = PartsOf(image);
  vtkDataArray* told_label = grid->GetFieldData()->GetArray("PartLabel");
  vtkDataArray* told_image = grid->GetFieldData()->GetArray("PartImageVolume");
  vtkDataArray* told_mesh = grid->GetFieldData()->GetArray("PartMeshVolume");
  vtkDataArray* told_centre = grid->GetFieldData()->GetArray("PartCentre");
  vtkDataArray* number = grid->GetCellData()->GetArray("Part");
  vtkDataArray* region = grid->GetCellData()->GetArray("RegionId");
  ASSERT_EQ(static_cast<std::size_t>(told_label->GetNumberOfTuples()), parts.size());
  std::vector<double> volumes(parts.size(), 0);
  std::vector<std::array<double, 3>> middles(parts.size(), {0, 0, 0});
  std::vector<std::set<vtkIdType>> points_of(parts.size());
  std::vector<std::vector<std::array<vtkIdType, 4>>> cells_of(parts.size());
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell) {
    const auto part = static_cast<std::size_t>(number->GetTuple1(cell));
    ASSERT_EQ(region->GetTuple1(cell), told_label->GetTuple1(static_cast<vtkIdType>(part)));
    vtkIdType size;
    const vtkIdType* ids;
    grid->GetCellPoints(cell, size, ids);
    double x[4][3];
    for (int i = 0; i < 4; ++i) {
      grid->GetPoint(ids[i], x[i]);
      points_of[part].insert(ids[i]);
    }
    cells_of[part].push_back({ids[0], ids[1], ids[2], ids[3]});
    double u[3][3];
    for (int i = 0; i < 3; ++i) {
      vtkMath::Subtract(x[i + 1], x[0], u[i]);
    }
    const double volume = vtkMath::Determinant3x3(u[0], u[1], u[2]) / 6;
    volumes[part] += volume;
    for (int c = 0; c < 3; ++c) {
      middles[part][c] += volume * (x[0][c] + x[1][c] + x[2][c] + x[3][c]) / 4;
    }
  }
  std::vector<std::size_t> row_of(parts.size());
  for (std::size_t p = 0; p < parts.size(); ++p) {
    const ImagePart& part = parts[p];
    // The row of the field arrays that is of this part.
    vtkIdType row = 0;
    const auto is_it = [&](vtkIdType i) {
      double x[3];
      told_centre->GetTuple(i, x);
      return told_label->GetTuple1(i) == part.Label &&
             std::abs(told_image->GetTuple1(i) / part.Volume - 1) < 1e-9 &&
             vtkMath::Distance2BetweenPoints(x, part.Middle.data()) < 1e-18;
    };
    while (row < told_label->GetNumberOfTuples() && !is_it(row)) {
      ++row;
    }
    ASSERT_LT(row, told_label->GetNumberOfTuples()) << PlaceText(part.Middle);
    row_of[p] = static_cast<std::size_t>(row);
    const double volume = volumes[row_of[p]];
    // TetGen takes facets for plane that are so to its tolerance.
    EXPECT_NEAR(told_mesh->GetTuple1(row), volume, 2e-3 * volume);
    const double error = std::abs(volume / part.Volume - 1);
    const bool named = warnings.find(PlaceText(part.Middle)) != std::string::npos;
    EXPECT_TRUE(error <= 0.02 || named)
        << "label " << part.Label << ", " << part.Volume << " m³ at " << PlaceText(part.Middle)
        << ": " << 100 * error << " % off";
    ++figures.Parts;
    figures.Kept += error <= 0.02;
    figures.Lost += volume == 0;
    figures.Off += volume > 0 && error > 0.02;
    if (error <= 0.02) {
      figures.Worst = std::max(figures.Worst, error);
      for (int c = 0; c < 3; ++c) {
        middles[row_of[p]][c] /= volume;
      }
      figures.Farthest =
          std::max(figures.Farthest, std::sqrt(vtkMath::Distance2BetweenPoints(
                                         middles[row_of[p]].data(), part.Middle.data())) /
                                         Millimetre);
    }
    // Pieces: points are joined by cells.
    std::map<vtkIdType, vtkIdType> parent;
    const std::function<vtkIdType(vtkIdType)> find = [&](vtkIdType of) {
      const auto entry = parent.emplace(of, of).first;
      return entry->second == of ? of : entry->second = find(entry->second);
    };
    for (const auto& cell : cells_of[row_of[p]]) {
      for (const vtkIdType id : cell) {
        parent[find(id)] = find(cell[0]);
      }
    }
    std::set<vtkIdType> pieces;
    for (const vtkIdType id : points_of[row_of[p]]) {
      pieces.insert(find(id));
    }
    EXPECT_TRUE(pieces.size() <= 1 || named) << pieces.size() << " pieces";
    figures.Split += pieces.size() > 1;
  }
  int n[3];
  image->GetDimensions(n);
  for (std::size_t a = 0; a < parts.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      const auto& of_a = points_of[row_of[a]];
      const auto& of_b = points_of[row_of[b]];
      const bool share =
          parts[a].Label == parts[b].Label &&
          std::any_of(of_a.begin(), of_a.end(), [&](vtkIdType id) { return of_b.count(id) > 0; });
      if (!share) {
        continue;
      }
      // They may where they do so in the image, by an edge or a corner.
      const std::set<vtkIdType> voxels(parts[b].Voxels.begin(), parts[b].Voxels.end());
      const bool touch =
          std::any_of(parts[a].Voxels.begin(), parts[a].Voxels.end(), [&](vtkIdType at) {
            for (int step = 0; step < 27; ++step) {
              const vtkIdType i = at % n[0] + step % 3 - 1;
              const vtkIdType j = at / n[0] % n[1] + step / 3 % 3 - 1;
              const vtkIdType k = at / n[0] / n[1] + step / 9 - 1;
              if (i >= 0 && j >= 0 && i < n[0] && j < n[1] &&
                  voxels.count((k * n[1] + j) * n[0] + i) > 0) {
                return true;
              }
            }
            return false;
          });
      const bool named = warnings.find("Grown together") != std::string::npos &&
                         (warnings.find(PlaceText(parts[a].Middle)) != std::string::npos ||
                          warnings.find(PlaceText(parts[b].Middle)) != std::string::npos);
      EXPECT_TRUE(touch || named) << "label " << parts[a].Label << ": "
                                  << PlaceText(parts[a].Middle) << " and "
                                  << PlaceText(parts[b].Middle) << " have grown together";
      figures.Joined += !touch;
    }
  }
}

class LabelMap : public testing::Test {
 protected:
  LabelMap() { this->Filter->SetUnit(vtkPalpateUnit::Millimetre); }

  Body Run(vtkImageData* image) {
    Messages messages(this->Filter);
    this->Filter->SetInputData(image);
    this->Filter->Update();
    EXPECT_EQ(messages.Errors, "");
    return Body(this->Filter->GetOutput());
  }

  /// The words are in the one error.
  void Fails(vtkImageData* image, const std::vector<std::string>& words) {
    Messages messages(this->Filter);
    this->Filter->SetInputData(image);
    this->Filter->Update();
    for (const std::string& word : words) {
      EXPECT_NE(messages.Errors.find(word), std::string::npos)
          << word << " is missing in: " << messages.Errors;
    }
    EXPECT_EQ(this->Filter->GetOutput()->GetNumberOfCells(), 0);
    EXPECT_NE(this->Filter->GetErrorCode(), 0U);
  }

  std::string Report() {
    return vtkStringArray::SafeDownCast(
               this->Filter->GetOutput()->GetFieldData()->GetAbstractArray("Report"))
        ->GetValue(0);
  }

  vtkNew<vtkPalpateTetrahedralizeLabelMap> Filter;
};

/// A ball of radius r voxels in one of radius R.
vtkSmartPointer<vtkImageData> Balls(int size, double outer, double inner) {
  const double c = 0.5 * (size - 1);
  return MakeImage({size, size, size}, [=](double x, double y, double z) {
    const double r = std::hypot(x - c, y - c, z - c);
    return r < inner ? 5 : r < outer ? 2 : 0;
  });
}

double Ball(double radius) { return 4.0 / 3 * vtkMath::Pi() * std::pow(radius * Millimetre, 3); }

TEST_F(LabelMap, NestedBallsKeepTheirVolumesAndShareTheirWall) {
  for (const double size : {0.0, 0.002, 0.004}) {
    this->Filter->SetElementSize(size);
    const Body body = this->Run(Balls(41, 18.2, 9.1));
    EXPECT_NEAR(body.Volumes.at(5), Ball(9.1), 0.02 * Ball(9.1)) << size;
    const double shell = Ball(18.2) - Ball(9.1);
    EXPECT_NEAR(body.Volumes.at(2), shell, 0.02 * shell) << size;
    for (const auto& [label, error] : body.Error) {
      EXPECT_LT(std::abs(error), 0.002) << size << ", label " << label;
    }
    EXPECT_EQ(body.Walls.size(), 2U) << size;
    EXPECT_GT(body.Walls.at({2, 5}), 50) << size;
    EXPECT_NE(this->Report().find("smallest angle"), std::string::npos);
  }
}

TEST_F(LabelMap, TheImageIsPlacedByItsUnitSpacingOriginAndDirection) {
  const auto image = Balls(25, 10.3, 5.2);
  image->SetSpacing(2, 1, 3);
  image->SetOrigin(-7, 100, 30);
  const double angle = 0.7;
  // The second one is left-handed.
  for (const double sign : {1.0, -1.0}) {
    image->SetDirectionMatrix(std::cos(angle), -std::sin(angle), 0, std::sin(angle),
                              std::cos(angle), 0, 0, 0, sign);
    double centre[3];
    image->TransformContinuousIndexToPhysicalPoint(12, 12, 12, centre);
    const Body body = this->Run(image);
    for (const auto& [label, error] : body.Error) {
      EXPECT_LT(std::abs(error), 0.02) << "label " << label;
    }
    const double expected = 6 * Ball(10.3);
    EXPECT_NEAR(body.Volumes.at(2) + body.Volumes.at(5), expected, 0.02 * expected);
    double b[6];
    body.Grid->GetBounds(b);
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR((b[2 * c] + b[2 * c + 1]) / 2, Millimetre * centre[c], Millimetre) << c;
    }
    EXPECT_NEAR(b[5] - b[4], 61.8 * Millimetre, 6 * Millimetre);
  }
}

TEST_F(LabelMap, BoxesThatTouchShareOneWallAndHaveTheirVolumesExactlyUnsmoothed) {
  // Three boxes side by side, the first two apart from the third by label alone.
  const auto image = MakeImage({14, 10, 9}, [](double x, double y, double z) {
    const bool inside = x > 0 && x < 13 && y > 0 && y < 9 && z > 0 && z < 8;
    return !inside ? 0 : x < 5 ? 1 : y < 5 ? 2 : 7;
  });
  this->Filter->SetElementSize(0.001);
  for (const int smoothing : {0, 20}) {
    this->Filter->SetSmoothing(smoothing);
    const Body body = this->Run(image);
    for (const auto& [label, error] : body.Error) {
      EXPECT_LT(std::abs(error), smoothing == 0 ? 1e-12 : 0.02) << "label " << label;
    }
    // Each touches each, and the outside.
    EXPECT_EQ(body.Walls.size(), 6U);
  }
}

TEST_F(LabelMap, AThinShellKeepsItsVolumeOrIsNamed) {
  for (const double thickness : {1.0, 3.0}) {
    const auto image = MakeImage({23, 23, 23}, [=](double x, double y, double z) {
      const double r = std::hypot(x - 11, y - 11, z - 11);
      return r < 9.2 - thickness ? 1 : r < 9.2 ? 2 : 0;
    });
    this->Filter->SetElementSize(0.001);
    Messages messages(this->Filter);
    const Body body = this->Run(image);
    for (const auto& [label, error] : body.Error) {
      EXPECT_LT(std::abs(error), 0.2) << thickness << ", label " << label;
    }
    PartFigures figures;
    ExpectPartsKeptOrNamed(image, body.Grid, messages.Warnings, figures);
    EXPECT_EQ(figures.Off > 0, messages.Warnings.find("Volumes that are off") != std::string::npos)
        << messages.Warnings;
    EXPECT_EQ(body.Walls.count({0, 2}), 1U);
    EXPECT_EQ(body.Walls.count({1, 2}), 1U);
  }
}

TEST_F(LabelMap, BridgesOfOneVoxelAndVoxelsThatTouchByAnEdgeOrCorner) {
  // Two cubes joined by a bar of one voxel; two that touch by an edge, two by a corner.
  const auto image = MakeImage({20, 8, 8}, [](int x, int y, int z) {
    const auto in = [](int a, int low, int high) { return a >= low && a < high; };
    const bool cubes = (in(x, 1, 5) || in(x, 8, 12)) && in(y, 1, 5) && in(z, 1, 5);
    const bool bar = in(x, 5, 8) && y == 2 && z == 3;
    const bool byEdge = in(x, 12, 15) && in(y, 5, 8) && in(z, 2, 5);
    const bool byCorner = in(x, 15, 18) && in(y, 2, 5) && in(z, 5, 8);
    return cubes || bar ? 3 : byEdge || byCorner ? 4 : 0;
  });
  this->Filter->SetElementSize(0.001);
  const Body body = this->Run(image);
  EXPECT_LT(std::abs(body.Error.at(3)), 0.05);
  EXPECT_LT(std::abs(body.Error.at(4)), 0.05);
}

TEST_F(LabelMap, LabelsAreChosenAndHaveTheirSizes) {
  const auto image = Balls(41, 18.2, 9.1);
  this->Filter->SetElementSize(0.004);
  const vtkIdType coarse = this->Run(image).Grid->GetNumberOfCells();
  this->Filter->AddLabelSize(5, 0.002);
  const Body fine = this->Run(image);
  std::map<int, int> cells;
  for (vtkIdType cell = 0; cell < fine.Grid->GetNumberOfCells(); ++cell) {
    ++cells[static_cast<int>(fine.Grid->GetCellData()->GetArray("RegionId")->GetTuple1(cell))];
  }
  EXPECT_GT(fine.Grid->GetNumberOfCells(), coarse);
  // Of equal volumes the finer one has more, though the other one has two walls.
  EXPECT_GT(cells[5] / fine.Volumes.at(5), 1.2 * cells[2] / fine.Volumes.at(2));

  this->Filter->ClearLabelSizes();
  this->Filter->AddLabel(5);
  const Body inner = this->Run(image);
  EXPECT_EQ(inner.Volumes.size(), 1U);
  EXPECT_NEAR(inner.Volumes.at(5), Ball(9.1), 0.02 * Ball(9.1));
  // The shell alone has a cavity.
  this->Filter->ClearLabels();
  this->Filter->AddLabel(2);
  const double shell = Ball(18.2) - Ball(9.1);
  EXPECT_NEAR(this->Run(image).Volumes.at(2), shell, 0.02 * shell);
  // Which may be filled.
  this->Filter->FillHolesOn();
  EXPECT_NEAR(this->Run(image).Volumes.at(2), Ball(18.2), 0.02 * Ball(18.2));
  EXPECT_NE(this->Report().find("1 holes were filled"), std::string::npos) << this->Report();
}

TEST_F(LabelMap, IslandsAreKeptOrGivenToWhatIsAround) {
  const auto image = MakeImage({20, 20, 20}, [](double x, double y, double z) {
    const bool speck = x == 10 && y == 10 && z == 10;
    const bool apart = x == 1 && y == 1 && z == 1;
    const bool half = x > 3 && x < 16 && y > 3 && y < 16 && z > 3 && z < 16;
    const bool other = x > 12;
    return speck ? 9 : apart ? 1 : half ? (other ? 9 : 1) : 0;
  });
  this->Filter->SetElementSize(0.001);
  const Body all = this->Run(image);
  this->Filter->SetSmallestIsland(2e-9);
  const Body cleaned = this->Run(image);
  EXPECT_NE(this->Report().find("1 islands of label 1"), std::string::npos) << this->Report();
  EXPECT_NE(this->Report().find("1 islands of label 9"), std::string::npos) << this->Report();
  EXPECT_GT(all.Walls.at({0, 1}), 0);
  double b[6];
  cleaned.Grid->GetBounds(b);
  EXPECT_GT(b[0], 3 * Millimetre);
  all.Grid->GetBounds(b);
  EXPECT_LT(b[0], 1.5 * Millimetre);
}

TEST_F(LabelMap, QuadraticOnesHavePointsInTheMiddleOfEdges) {
  this->Filter->SetElementOrder(2);
  const Body body = this->Run(Balls(21, 8.2, 4.1));
  EXPECT_EQ(body.Grid->GetCellType(0), VTK_QUADRATIC_TETRA);
}

TEST_F(LabelMap, LabelsOfCellsAreThoseBetweenThePoints) {
  const auto image = Balls(21, 8.2, 4.1);
  vtkNew<vtkImageData> cells;
  cells->SetDimensions(22, 22, 22);
  cells->SetOrigin(-0.5, -0.5, -0.5);
  cells->GetCellData()->AddArray(image->GetPointData()->GetScalars());
  const Body of_points = this->Run(image);
  this->Filter->SetLabelArray("labels");
  const Body of_cells = this->Run(cells);
  ASSERT_EQ(of_cells.Grid->GetNumberOfPoints(), of_points.Grid->GetNumberOfPoints());
  double x[3], y[3];
  of_points.Grid->GetPoint(7, x);
  of_cells.Grid->GetPoint(7, y);
  EXPECT_LT(vtkMath::Distance2BetweenPoints(x, y), 1e-20);
}

// Noise of several densities, and blobs: a body or one clear error.
TEST_F(LabelMap, TwoHundredRandomMaps) {
  int bodies = 0;
  for (int number = 0; number < 200; ++number) {
    std::mt19937 random(number);
    std::uniform_real_distribution<double> uniform(0, 1);
    const int size = 4 + number % 5;
    const int labels = 1 + number % 4;
    const double density = 0.1 + 0.8 * uniform(random);
    const bool blobs = number % 2 == 0;
    std::vector<std::array<double, 4>> centres;
    for (int i = 0; i < 2 * labels; ++i) {
      centres.push_back({size * uniform(random), size * uniform(random), size * uniform(random),
                         (0.1 + 0.3 * uniform(random)) * size});
    }
    const auto image = MakeImage({size, size + 1, size}, [&](double x, double y, double z) {
      if (!blobs) {
        return uniform(random) < density ? 1 + static_cast<int>(labels * uniform(random)) : 0;
      }
      for (std::size_t i = 0; i < centres.size(); ++i) {
        const auto& c = centres[i];
        if (std::hypot(x - c[0], y - c[1], z - c[2]) < c[3]) {
          return 1 + static_cast<int>(i) % labels;
        }
      }
      return 0;
    });
    image->SetSpacing(1, 1 + uniform(random), 1);
    vtkNew<vtkPalpateTetrahedralizeLabelMap> filter;
    filter->SetUnit(vtkPalpateUnit::Millimetre);
    filter->SetElementSize(number % 3 == 0 ? 0 : 0.001);
    filter->SetTimeOut(30);
    Messages messages(filter);
    filter->SetInputData(image);
    filter->Update();
    if (filter->GetErrorCode() == 0) {
      EXPECT_EQ(messages.Errors, "") << number;
      const Body body(filter->GetOutput());
      EXPECT_GT(body.Grid->GetNumberOfCells(), 0) << number;
      ++bodies;
    } else {
      EXPECT_GT(messages.Errors.size(), 20U) << number;
      EXPECT_EQ(filter->GetOutput()->GetNumberOfCells(), 0) << number;
      std::cout << number << ": " << messages.Errors << std::endl;
    }
  }
  std::cout << bodies << " bodies" << std::endl;
  EXPECT_GT(bodies, 190);
}

/// Up to three labels of up to six balls, boxes or single voxels each, one over the other, some
/// over the border of the image: of any type, with any spacing, origin, extent and direction.
vtkSmartPointer<vtkImageData> RandomParts(int seed) {
  std::mt19937 random(seed);
  const auto uniform = [&](double low, double high) {
    return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
  };
  const auto whole = [&](int low, int high) { return static_cast<int>(uniform(low, high + 1)); };
  const std::array<int, 3> n = {whole(14, 30), whole(14, 30), whole(14, 30)};
  auto image = vtkSmartPointer<vtkImageData>::New();
  const int first[3] = {whole(-5, 5), whole(0, 9), whole(-20, 0)};
  image->SetExtent(first[0], first[0] + n[0] - 1, first[1], first[1] + n[1] - 1, first[2],
                   first[2] + n[2] - 1);
  image->SetOrigin(uniform(-90, 90), uniform(-90, 90), uniform(-90, 90));
  const double spacing = uniform(0.5, 2);
  image->SetSpacing(spacing, spacing * uniform(1, 1.3), spacing * uniform(0.8, 2.5));
  const double c = std::cos(0.7);
  const double s = std::sin(0.7);
  const double directions[4][9] = {{1, 0, 0, 0, 1, 0, 0, 0, 1},
                                   {c, -s, 0, s, c, 0, 0, 0, 1},
                                   {-1, 0, 0, 0, 1, 0, 0, 0, 1},
                                   {0, 0, 1, 1, 0, 0, 0, 1, 0}};
  image->SetDirectionMatrix(directions[seed % 4]);
  constexpr int types[] = {VTK_UNSIGNED_CHAR, VTK_SHORT, VTK_FLOAT, VTK_LONG_LONG};
  const auto labels = vtk::TakeSmartPointer(vtkDataArray::CreateDataArray(types[seed / 3 % 4]));
  labels->SetName("labels");
  labels->SetNumberOfTuples(image->GetNumberOfPoints());
  labels->Fill(0);
  struct Shape {
    int Label;
    bool IsBall;
    std::array<double, 3> Middle;
    std::array<double, 3> Half;
  };
  std::vector<Shape> shapes;
  if (whole(0, 3) > 0) {
    shapes.push_back({1, true, {}, {}});
    for (int axis = 0; axis < 3; ++axis) {
      shapes.back().Middle[axis] = 0.5 * (n[axis] - 1);
      shapes.back().Half[axis] = n[axis] * uniform(0.3, 0.5);
    }
  }
  const int number = whole(1, 3);
  for (int label = 1; label <= number; ++label) {
    for (int part = whole(1, 6); part > 0; --part) {
      Shape shape{shapes.empty() ? label : label + 1, whole(0, 2) > 0, {}, {}};
      const double size = whole(0, 5) == 0 ? 0.1 : uniform(0.8, 7);
      for (int axis = 0; axis < 3; ++axis) {
        shape.Middle[axis] = uniform(0, n[axis] - 1);
        shape.Half[axis] = size * uniform(0.8, 1.2);
        if (size < 0.5) {
          shape.Middle[axis] = std::round(shape.Middle[axis]);
        }
      }
      shapes.push_back(shape);
    }
  }
  for (const Shape& shape : shapes) {
    for (vtkIdType at = 0; at < image->GetNumberOfPoints(); ++at) {
      const double x[3] = {static_cast<double>(at % n[0]), static_cast<double>(at / n[0] % n[1]),
                           static_cast<double>(at / n[0] / n[1])};
      double distance = 0;
      for (int axis = 0; axis < 3; ++axis) {
        const double away = std::abs(x[axis] - shape.Middle[axis]) / shape.Half[axis];
        distance = shape.IsBall ? distance + away * away : std::max(distance, away);
      }
      if (distance < 1) {
        labels->SetTuple1(at, shape.Label);
      }
    }
  }
  image->GetPointData()->SetScalars(labels);
  return image;
}

// PALPATE_LABEL_MAPS=200 for as many of them, see tests/benchmark/README.md.
TEST_F(LabelMap, EachPartKeepsItsVolumeOrIsNamed) {
  const char* asked = std::getenv("PALPATE_LABEL_MAPS");
  const int number = asked ? std::stoi(asked) : 8;
  PartFigures figures;
  int bodies = 0;
  for (int seed = 0; seed < number; ++seed) {
    SCOPED_TRACE("map " + std::to_string(seed));
    const auto image = RandomParts(seed);
    vtkNew<vtkPalpateTetrahedralizeLabelMap> filter;
    filter->SetUnit(vtkPalpateUnit::Millimetre);
    const double* spacing = image->GetSpacing();
    constexpr double factors[] = {0, 1, 1.5, 2.5};
    filter->SetElementSize(factors[seed % 16 / 4] * Millimetre * spacing[0]);
    filter->SetTimeOut(0);
    Messages messages(filter);
    filter->SetInputData(image);
    filter->Update();
    if (filter->GetErrorCode() != 0) {
      std::cout << seed << ": " << messages.Errors << std::endl;
      continue;
    }
    ++bodies;
    ExpectPartsKeptOrNamed(image, filter->GetOutput(), messages.Warnings, figures);
  }
  std::cout << bodies << " bodies of " << number << " maps, " << figures.Parts
            << " parts: " << figures.Kept << " kept to 2 % (at the worst " << 100 * figures.Worst
            << " %, " << figures.Farthest << " mm away), " << figures.Lost << " lost, "
            << figures.Off << " off, " << figures.Split << " in pieces, " << figures.Joined
            << " grown together" << std::endl;
  EXPECT_GE(bodies, 0.98 * number);
  EXPECT_GE(figures.Kept, 0.8 * figures.Parts);
}

TEST_F(LabelMap, NegativeLabelsAreNoTissueUnlessTheyAreNamed) {
  const auto image = MakeImage({15, 15, 15}, [](int x, int y, int z) {
    const bool inside = x > 2 && x < 12 && y > 2 && y < 12 && z > 2 && z < 12;
    return !inside ? (z == 0 ? -1000 : -1) : x < 7 ? 4 : 6;
  });
  this->Filter->SetElementSize(0.001);
  Messages messages(this->Filter);
  EXPECT_EQ(this->Run(image).Volumes.size(), 2U);
  EXPECT_NE(messages.Warnings.find("-1000 (225 voxels), -1 ("), std::string::npos)
      << messages.Warnings;
  messages.Warnings.clear();
  // Who names labels knows.
  this->Filter->AddLabel(4);
  EXPECT_EQ(this->Run(image).Volumes.size(), 1U);
  EXPECT_EQ(messages.Warnings, "");
  this->Filter->AddLabel(-1);
  const Body body = this->Run(image);
  EXPECT_EQ(body.Volumes.size(), 2U);
  EXPECT_EQ(body.Volumes.count(-1), 1U);
  this->Filter->ClearLabels();
  this->Fails(MakeImage({5, 5, 5}, [](double, double, double) { return -1; }), {"or less"});
}

TEST_F(LabelMap, WhatIsNearlyAWholeNumberIsThatNumber) {
  const auto whole = Balls(21, 8.2, 4.1);
  const Body expected = this->Run(whole);
  for (const double off : {1e-7, 9e-4, -9e-4, 1.1e-3}) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(21, 21, 21);
    image->AllocateScalars(VTK_FLOAT, 1);
    for (vtkIdType at = 0; at < image->GetNumberOfPoints(); ++at) {
      image->GetPointData()->GetScalars()->SetTuple1(
          at, whole->GetPointData()->GetScalars()->GetTuple1(at) + off);
    }
    if (off > 1e-3) {
      this->Fails(image, {"not one of labels", "0.0011", "0.001"});
    } else {
      EXPECT_EQ(this->Run(image).Volumes, expected.Volumes) << off;
    }
  }
}

// Four nodules of one label, of which three are smaller than the elements.
TEST_F(LabelMap, NodulesOfOneLabelKeepTheirPlacesAndVolumes) {
  struct Nodule {
    double X, Y, Diameter;
  };
  constexpr Nodule nodules[] = {{35, 45, 20}, {60, 45, 12}, {85, 45, 8}, {60, 65, 6}};
  for (const bool alone : {false, true}) {
    const auto image = MakeImage({61, 46, 41}, [=](double x, double y, double z) {
      for (const Nodule& of : nodules) {
        if (std::hypot(2 * x - of.X, 2 * y - of.Y, 2 * z - 40) < of.Diameter / 2) {
          return 2;
        }
      }
      const double r = std::hypot((2 * x - 60) / 55, (2 * y - 45) / 40, (2 * z - 40) / 35);
      return !alone && r < 1 ? 1 : 0;
    });
    image->SetSpacing(2, 2, 2);
    for (const double size : {0.0, 0.01, 0.006}) {
      SCOPED_TRACE(std::to_string(alone) + ", " + std::to_string(size));
      this->Filter->SetElementSize(size);
      Messages messages(this->Filter);
      const Body body = this->Run(image);
      PartFigures figures;
      ExpectPartsKeptOrNamed(image, body.Grid, messages.Warnings, figures);
      EXPECT_EQ(figures.Kept, alone ? 4 : 5);
      EXPECT_LT(figures.Farthest, 1.5);
      EXPECT_EQ(messages.Warnings, "");
    }
    // Of 20 mm: two are less than a twentieth of a cube, one is nearer to another than a cube.
    this->Filter->SetElementSize(0.02);
    Messages messages(this->Filter);
    const Body body = this->Run(image);
    PartFigures figures;
    ExpectPartsKeptOrNamed(image, body.Grid, messages.Warnings, figures);
    EXPECT_EQ(figures.Lost, 3);
    EXPECT_NE(messages.Warnings.find("Lost"), std::string::npos) << messages.Warnings;
    EXPECT_NE(this->Report().find("lost."), std::string::npos) << this->Report();
  }
}

// The wall of a bladder, thinner than half of an element, stays closed: the cavity keeps its
// volume, and so does a hole of one voxel. Two lobes are held apart by a fissure of one voxel.
TEST_F(LabelMap, ThinWallsAndGapsStay) {
  const auto bladder = MakeImage({48, 48, 48}, [](double x, double y, double z) {
    const double r = std::hypot(x - 23.5, y - 23.5, z - 23.5);
    return r > 16 && r < 18 ? 1 : 0;
  });
  this->Filter->SetElementSize(0.005);
  {
    Messages messages(this->Filter);
    const Body body = this->Run(bladder);
    EXPECT_EQ(messages.Warnings, "");
    double b[6];
    body.Grid->GetBounds(b);
    EXPECT_NEAR(b[1] - b[0], 36 * Millimetre, 3 * Millimetre);
    EXPECT_NEAR(body.Error.at(1), 0, 0.02);
  }
  const auto lobes = MakeImage({40, 24, 24}, [](int x, int y, int z) {
    const bool inside = x > 2 && x < 37 && y > 2 && y < 21 && z > 2 && z < 21;
    return inside && x != 19 ? 3 : 0;
  });
  Messages messages(this->Filter);
  const Body body = this->Run(lobes);
  PartFigures figures;
  ExpectPartsKeptOrNamed(lobes, body.Grid, messages.Warnings, figures);
  EXPECT_EQ(figures.Kept, 2);
  EXPECT_EQ(figures.Joined, 0);
  EXPECT_EQ(messages.Warnings, "");
}

TEST_F(LabelMap, WhatIsWrongIsSaid) {
  const auto good = Balls(21, 8.2, 4.1);
  this->Filter->SetUnit(vtkPalpateUnit::NotSaid);
  this->Fails(good, {"Unit", "20 × 20 × 20", "0.02 ×", "mm"});
  this->Filter->SetUnit(7);
  this->Fails(good, {"Unit is 7"});
  this->Filter->SetUnit(vtkPalpateUnit::Millimetre);

  vtkNew<vtkImageData> bare;
  bare->SetDimensions(5, 5, 5);
  this->Fails(bare, {"no scalars"});
  this->Fails(MakeImage({5, 5, 1}, [](double, double, double) { return 1; }),
              {"5 × 5 × 1", "single layer"});
  this->Fails(MakeImage({5, 5, 5}, [](double, double, double) { return 0; }), {"0 throughout"});
  vtkNew<vtkImageData> grey;
  grey->SetDimensions(4, 4, 4);
  grey->AllocateScalars(VTK_FLOAT, 1);
  for (vtkIdType i = 0; i < 64; ++i) {
    grey->GetPointData()->GetScalars()->SetTuple1(i, 0.5 * i);
  }
  this->Fails(grey, {"not one of labels", "voxel 1", "0.5"});
  vtkNew<vtkImageData> colours;
  colours->SetDimensions(4, 4, 4);
  colours->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
  this->Fails(colours, {"3 components"});
  vtkNew<vtkImageData> huge;
  huge->SetDimensions(1000, 1000, 200);
  vtkNew<vtkIntArray> few;
  few->SetName("few");
  huge->GetPointData()->SetScalars(few);
  this->Fails(huge, {"2e+08 voxels"});
  // More or fewer values than voxels.
  for (const int number : {0, 5, 9000}) {
    few->SetNumberOfValues(number);
    few->FillValue(1);
    vtkNew<vtkImageData> other;
    other->SetDimensions(20, 20, 20);
    other->GetPointData()->SetScalars(few);
    this->Fails(other, {"array 'few'", std::to_string(number) + " values", "8000 points"});
    vtkNew<vtkImageData> of_cells;
    of_cells->SetDimensions(21, 21, 21);
    of_cells->GetCellData()->SetScalars(few);
    this->Fails(of_cells, {"array 'few'", std::to_string(number) + " values", "8000 cells"});
  }
  // An array without a name.
  few->SetName(nullptr);
  vtkNew<vtkImageData> nameless;
  nameless->SetDimensions(20, 20, 20);
  nameless->GetPointData()->SetScalars(few);
  this->Fails(nameless, {"array without a name", "9000 values"});
  colours->GetPointData()->GetScalars()->SetName(nullptr);
  this->Fails(colours, {"array without a name", "3 components"});
  grey->GetPointData()->GetScalars()->SetName(nullptr);
  this->Fails(grey, {"array without a name", "not one of labels"});

  this->Filter->SetLabelArray("nowhere");
  this->Fails(good, {"no array 'nowhere'"});
  this->Filter->SetLabelArray("None");
  this->Filter->AddLabel(3);
  this->Fails(good, {"Labels has 3", "2, 5"});
  this->Filter->ClearLabels();
  this->Filter->AddLabel(0);
  this->Fails(good, {"Labels has 0"});
  this->Filter->ClearLabels();
  this->Filter->AddLabelSize(4, 0.001);
  this->Fails(good, {"LabelSizes", "4"});
  this->Filter->ClearLabelSizes();
  this->Filter->AddLabelSize(5, -1);
  this->Fails(good, {"LabelSizes", "-1"});
  this->Filter->ClearLabelSizes();
  this->Filter->SetElementSize(0.02);
  this->Fails(good, {"vanishes", "ElementSize"});
  this->Filter->SetElementSize(1e-6);
  this->Fails(good, {"tetrahedra", "ElementSize"});
  this->Filter->SetElementSize(-1);
  this->Fails(good, {"ElementSize is -1"});
  this->Filter->SetElementSize(0);
  this->Filter->SetSmallestIsland(1);
  this->Fails(good, {"SmallestIsland"});
  this->Filter->SetSmallestIsland(0);
  this->Filter->SetSmoothing(-2);
  this->Fails(good, {"Smoothing is -2"});
  this->Filter->SetSmoothing(20);
  this->Run(good);
}
}  // namespace

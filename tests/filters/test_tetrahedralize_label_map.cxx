// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <map>
#include <random>
#include <set>
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

/// What a filter says.
struct Messages {
  std::string Errors;
  std::string Warnings;

  explicit Messages(vtkObject* of) {
    for (const unsigned long event : {vtkCommand::ErrorEvent, vtkCommand::WarningEvent}) {
      vtkNew<vtkCallbackCommand> command;
      command->SetClientData(this);
      command->SetCallback([](vtkObject*, unsigned long kind, void* self, void* text) {
        auto* messages = static_cast<Messages*>(self);
        (kind == vtkCommand::ErrorEvent ? messages->Errors : messages->Warnings) +=
            static_cast<const char*>(text);
      });
      of->AddObserver(event, command);
    }
  }
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
      const bool named =
          messages.Warnings.find("Label " + std::to_string(label)) != std::string::npos;
      EXPECT_EQ(std::abs(error) > 0.02, named) << thickness << ", label " << label << ": " << error;
      EXPECT_LT(std::abs(error), 0.2) << thickness << ", label " << label;
    }
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

// SPDX-License-Identifier: BSD-3-Clause
// Hexahedra, wedges, pyramids, cells of Lagrange's kind, and what is no solid, as a body of
// tetrahedra.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "base/error.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDoubleArray.h"
#include "vtkGenericCell.h"
#include "vtkIdTypeArray.h"
#include "vtkIntArray.h"
#include "vtkLagrangeHexahedron.h"
#include "vtkLagrangeTetra.h"
#include "vtkMath.h"
#include "vtkNew.h"
#include "vtkPalpateBodyCells.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

namespace {
using Place = std::array<double, 3>;

/// A straight block of 2 × 3 × 2 cubes, sheared.
constexpr std::array<int, 3> Cubes = {2, 3, 2};
constexpr double CubeVolume = 0.1 * 0.2 * 0.05;

Place Sheared(const Place& x) {
  return {0.1 * x[0] + 0.03 * x[1], 0.2 * x[1], 0.05 * x[2] + 0.01 * x[0]};
}

/// A grid whose points are numbered at random, so that no diagonal is that of another number.
class Block {
 public:
  explicit Block(Place (*map)(const Place&) = Sheared) : Map(map) {
    Grid->SetPoints(Points);
    Points->SetDataTypeToDouble();
    Cube->SetName("Cube");
    Grid->GetCellData()->AddArray(Cube);
  }

  /// @param nodes Of a cell, in cubes.
  void Add(int type, const std::vector<Place>& nodes, int cube) {
    Cells.push_back({type, {}});
    for (const Place& node : nodes) {
      std::array<long, 3> key{};
      for (int c = 0; c < 3; ++c) {
        key[c] = std::lround(60 * node[c]);  // Halves, thirds, quarters and fifths are whole.
      }
      const auto [entry, is_new] = Ids.emplace(key, static_cast<vtkIdType>(Places.size()));
      if (is_new) {
        Places.push_back(node);
      }
      Cells.back().second.push_back(entry->second);
    }
    Cube->InsertNextValue(cube);
  }

  vtkUnstructuredGrid* Finish() {
    std::vector<vtkIdType> order(Places.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(7));
    Points->SetNumberOfPoints(static_cast<vtkIdType>(Places.size()));
    vtkNew<vtkDoubleArray> field;
    field->SetName("Field");
    field->SetNumberOfValues(Points->GetNumberOfPoints());
    vtkNew<vtkIntArray> low;
    low->SetName("Low");
    low->SetNumberOfValues(Points->GetNumberOfPoints());
    for (std::size_t i = 0; i < Places.size(); ++i) {
      const Place x = Map(Places[i]);
      Points->SetPoint(order[i], x.data());
      field->SetValue(order[i], Linear(x));
      low->SetValue(order[i], Places[i][2] < 1e-9 ? 1 : 0);
    }
    Grid->GetPointData()->AddArray(field);
    Grid->GetPointData()->AddArray(low);
    for (auto& [type, ids] : Cells) {
      for (vtkIdType& id : ids) {
        id = order[static_cast<std::size_t>(id)];
      }
      Grid->InsertNextCell(type, static_cast<vtkIdType>(ids.size()), ids.data());
    }
    return Grid;
  }

  static double Linear(const Place& x) { return 1 + 2 * x[0] - 3 * x[1] + 5 * x[2]; }

  Place (*Map)(const Place&);
  vtkNew<vtkUnstructuredGrid> Grid;
  vtkNew<vtkPoints> Points;
  vtkNew<vtkIntArray> Cube;
  std::map<std::array<long, 3>, vtkIdType> Ids;
  std::vector<Place> Places;
  std::vector<std::pair<int, std::vector<vtkIdType>>> Cells;
};

/// Nodes of a cell in its own coordinates.
std::vector<Place> NodesOf(int type) {
  const auto cell = vtkSmartPointer<vtkCell>::Take(vtkGenericCell::InstantiateCell(type));
  const double* places = cell->GetParametricCoords();
  std::vector<Place> nodes;
  for (vtkIdType i = 0; i < cell->GetNumberOfPoints(); ++i) {
    nodes.push_back({places[3 * i], places[3 * i + 1], places[3 * i + 2]});
  }
  return nodes;
}

std::vector<Place> NodesOfLagrange(int order) {
  std::vector<Place> nodes(static_cast<std::size_t>(std::pow(order + 1, 3) + 0.5));
  const int orders[4] = {order, order, order, static_cast<int>(nodes.size())};
  for (int k = 0; k <= order; ++k) {
    for (int j = 0; j <= order; ++j) {
      for (int i = 0; i <= order; ++i) {
        nodes[static_cast<std::size_t>(vtkLagrangeHexahedron::PointIndexFromIJK(i, j, k, orders))] =
            {static_cast<double>(i) / order, static_cast<double>(j) / order,
             static_cast<double>(k) / order};
      }
    }
  }
  return nodes;
}

template <class Use>
void ForEachCube(Use&& use) {
  int number = 0;
  for (int k = 0; k < Cubes[2]; ++k) {
    for (int j = 0; j < Cubes[1]; ++j) {
      for (int i = 0; i < Cubes[0]; ++i) {
        use(Place{double(i), double(j), double(k)}, number++);
      }
    }
  }
}

void AddHexahedron(Block& block, int type, const std::vector<Place>& nodes, const Place& at,
                   int cube) {
  std::vector<Place> moved = nodes;
  for (Place& node : moved) {
    for (int c = 0; c < 3; ++c) {
      node[c] += at[c];
    }
  }
  block.Add(type, moved, cube);
}

/// A cube of two wedges.
void AddWedges(Block& block, int type, const Place& at, int cube) {
  for (const bool other : {false, true}) {
    std::vector<Place> nodes = NodesOf(type);
    for (Place& node : nodes) {
      node = {at[0] + (other ? 1 - node[0] : node[0]), at[1] + (other ? 1 - node[1] : node[1]),
              at[2] + node[2]};
    }
    block.Add(type, nodes, cube);
  }
}

/// A cube of six pyramids around its middle.
void AddPyramids(Block& block, int type, const Place& at, int cube) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 1}) {
      std::vector<Place> nodes = NodesOf(type);
      for (Place& node : nodes) {
        // VTK has the apex at (0, 0, 1) of coordinates that shrink towards it.
        const double t = node[2];
        const bool of_base = t == 0;
        const double u = of_base ? node[0] : (t == 1 ? 0.5 : (node[0] > 0.4 ? 0.75 : 0.25));
        const double v = of_base ? node[1] : (t == 1 ? 0.5 : (node[1] > 0.4 ? 0.75 : 0.25));
        Place x{};
        x[axis] = side == 0 ? 0.5 * t : 1 - 0.5 * t;
        x[(axis + 1) % 3] = side == 0 ? u : v;
        x[(axis + 2) % 3] = side == 0 ? v : u;
        node = {at[0] + x[0], at[1] + x[1], at[2] + x[2]};
      }
      block.Add(type, nodes, cube);
    }
  }
}

double Volume(vtkUnstructuredGrid* body, const vtkIdType* ids) {
  double x[4][3];
  for (int i = 0; i < 4; ++i) {
    body->GetPoint(ids[i], x[i]);
  }
  for (int i = 1; i < 4; ++i) {
    vtkMath::Subtract(x[i], x[0], x[i]);
  }
  return vtkMath::Determinant3x3(x[1], x[2], x[3]) / 6;
}

/// What is true of the tetrahedra of every straight block: they fill each of its cubes, have their
/// cube's data, are positive, and share their faces with their neighbours, midside nodes included.
void ExpectBlock(vtkUnstructuredGrid* input, const vtkPalpateBodyCells& cells, bool quadratic) {
  vtkUnstructuredGrid* body = cells.Body;
  EXPECT_EQ(cells.LeftOut, "");
  constexpr int faces[4][6] = {
      {0, 1, 2, 4, 5, 6}, {0, 1, 3, 4, 8, 7}, {1, 2, 3, 5, 9, 8}, {2, 0, 3, 6, 7, 9}};
  std::map<std::set<vtkIdType>, std::pair<int, double>> faces_of;  // of how many, and area
  std::map<int, double> volumes;
  auto* cube = vtkIntArray::SafeDownCast(body->GetCellData()->GetArray("Cube"));
  ASSERT_TRUE(cube);
  for (vtkIdType cell = 0; cell < body->GetNumberOfCells(); ++cell) {
    ASSERT_EQ(body->GetCellType(cell), quadratic ? VTK_QUADRATIC_TETRA : VTK_TETRA);
    vtkIdType size;
    const vtkIdType* ids;
    body->GetCellPoints(cell, size, ids);
    const double volume = Volume(body, ids);
    EXPECT_GT(volume, 0) << cell;
    volumes[cube->GetValue(cell)] += volume;
    for (const auto& face : faces) {
      std::set<vtkIdType> nodes;
      for (int i = 0; i < (quadratic ? 6 : 3); ++i) {
        nodes.insert(ids[face[i]]);
      }
      double x[3][3];
      for (int i = 0; i < 3; ++i) {
        body->GetPoint(ids[face[i]], x[i]);
      }
      double u[3], v[3], n[3];
      vtkMath::Subtract(x[1], x[0], u);
      vtkMath::Subtract(x[2], x[0], v);
      vtkMath::Cross(u, v, n);
      auto& of = faces_of[nodes];
      ++of.first;
      of.second = vtkMath::Norm(n) / 2;
    }
  }
  for (const auto& [number, volume] : volumes) {
    EXPECT_NEAR(volume, CubeVolume, 1e-12 * CubeVolume) << number;
  }
  EXPECT_EQ(volumes.size(), 12U);
  double area = 0;
  for (const auto& [nodes, of] : faces_of) {
    EXPECT_LE(of.first, 2);
    area += of.first == 1 ? of.second : 0;
  }
  // The skin of the block: were a diagonal not shared, faces within it would count.
  const Place o = Sheared({0, 0, 0});
  double edges[3][3];
  for (int axis = 0; axis < 3; ++axis) {
    Place end{};
    end[axis] = Cubes[axis];
    end = Sheared(end);
    vtkMath::Subtract(end.data(), o.data(), edges[axis]);
  }
  double skin = 0;
  for (int axis = 0; axis < 3; ++axis) {
    double n[3];
    vtkMath::Cross(edges[axis], edges[(axis + 1) % 3], n);
    skin += 2 * vtkMath::Norm(n);
  }
  EXPECT_NEAR(area, skin, 1e-12 * skin);
  // Points keep their ids and data, new ones have it, too.
  ASSERT_EQ(body->GetNumberOfPoints(),
            input->GetNumberOfPoints() + static_cast<vtkIdType>(cells.Added.size()));
  for (vtkIdType point = 0; point < body->GetNumberOfPoints(); ++point) {
    Place x;
    body->GetPoint(point, x.data());
    if (point < input->GetNumberOfPoints()) {
      Place y;
      input->GetPoint(point, y.data());
      EXPECT_EQ(x, y);
    }
    EXPECT_NEAR(body->GetPointData()->GetArray("Field")->GetTuple1(point), Block::Linear(x), 1e-12);
    const double height = (x[2] - 0.1 * (x[0] - 0.15 * x[1])) / 0.05;
    EXPECT_EQ(body->GetPointData()->GetArray("Low")->GetTuple1(point), height < 1e-9 ? 1 : 0);
  }
  if (quadratic) {
    for (vtkIdType cell = 0; cell < body->GetNumberOfCells(); ++cell) {
      vtkIdType size;
      const vtkIdType* ids;
      body->GetCellPoints(cell, size, ids);
      constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
      for (int edge = 0; edge < 6; ++edge) {
        double a[3], b[3], m[3];
        body->GetPoint(ids[ends[edge][0]], a);
        body->GetPoint(ids[ends[edge][1]], b);
        body->GetPoint(ids[4 + edge], m);
        for (int c = 0; c < 3; ++c) {
          EXPECT_NEAR(m[c], (a[c] + b[c]) / 2, 1e-12);
        }
      }
    }
  }
}

TEST(BodyCells, HexahedraOfEachKindFillTheirBlock) {
  const std::vector<std::pair<int, std::vector<Place>>> kinds = {
      {VTK_VOXEL, NodesOf(VTK_VOXEL)},
      {VTK_HEXAHEDRON, NodesOf(VTK_HEXAHEDRON)},
      {VTK_QUADRATIC_HEXAHEDRON, NodesOf(VTK_QUADRATIC_HEXAHEDRON)},
      {VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON, NodesOf(VTK_BIQUADRATIC_QUADRATIC_HEXAHEDRON)},
      {VTK_TRIQUADRATIC_HEXAHEDRON, NodesOf(VTK_TRIQUADRATIC_HEXAHEDRON)},
      {VTK_LAGRANGE_HEXAHEDRON, NodesOfLagrange(1)},
      {VTK_LAGRANGE_HEXAHEDRON, NodesOfLagrange(2)}};
  for (const auto& [type, nodes] : kinds) {
    SCOPED_TRACE(vtkPalpateCellTypeName(type) + ' ' + std::to_string(nodes.size()));
    Block block;
    ForEachCube([&, type = type, &nodes = nodes](const Place& at, int cube) {
      AddHexahedron(block, type, nodes, at, cube);
    });
    vtkUnstructuredGrid* grid = block.Finish();
    const vtkPalpateBodyCells cells = vtkPalpateToTetrahedra(grid);
    ExpectBlock(grid, cells, nodes.size() > 8);
    // With all of its nodes a cell needs no new point.
    EXPECT_EQ(cells.Added.empty(), nodes.size() != 20 && nodes.size() != 24);
  }
}

TEST(BodyCells, PyramidsBesideHexahedraAndWedgesShareTheirFaces) {
  for (const bool quadratic : {false, true}) {
    Block block;
    ForEachCube([&](const Place& at, int cube) {
      const int hexahedron = quadratic ? VTK_QUADRATIC_HEXAHEDRON : VTK_HEXAHEDRON;
      if (cube % 3 == 1) {
        AddPyramids(block, quadratic ? VTK_QUADRATIC_PYRAMID : VTK_PYRAMID, at, cube);
      } else {
        AddHexahedron(block, hexahedron, NodesOf(hexahedron), at, cube);
      }
    });
    SCOPED_TRACE(quadratic);
    vtkUnstructuredGrid* grid = block.Finish();
    ExpectBlock(grid, vtkPalpateToTetrahedra(grid), quadratic);
  }
  for (const int type : {VTK_WEDGE, VTK_QUADRATIC_WEDGE, VTK_BIQUADRATIC_QUADRATIC_WEDGE}) {
    SCOPED_TRACE(vtkPalpateCellTypeName(type));
    Block block;
    ForEachCube([&](const Place& at, int cube) { AddWedges(block, type, at, cube); });
    vtkUnstructuredGrid* grid = block.Finish();
    ExpectBlock(grid, vtkPalpateToTetrahedra(grid), type != VTK_WEDGE);
  }
}

// A corner that is there twice: hexahedra as wedges, as many meshers write them.
TEST(BodyCells, CollapsedHexahedraHaveTheVolumeOfWhatTheyAre) {
  Block block;
  ForEachCube([&](const Place& at, int cube) {
    for (const bool other : {false, true}) {
      std::vector<Place> nodes = NodesOf(VTK_HEXAHEDRON);
      for (Place& node : nodes) {
        if (node[0] == 1 && node[1] == 1) {
          node[0] = 0;
        }
        node = {at[0] + (other ? 1 - node[0] : node[0]), at[1] + (other ? 1 - node[1] : node[1]),
                at[2] + node[2]};
      }
      block.Add(VTK_HEXAHEDRON, nodes, cube);
    }
  });
  vtkUnstructuredGrid* grid = block.Finish();
  ExpectBlock(grid, vtkPalpateToTetrahedra(grid), false);
}

TEST(BodyCells, MiddlesOfCurvedEdgesStayOnThem) {
  const auto bent = [](const Place& x) -> Place {
    return {x[0], x[1] + 0.1 * x[0] * (2 - x[0]), x[2] - 0.05 * x[0] * x[1]};
  };
  for (const int type : {VTK_QUADRATIC_HEXAHEDRON, VTK_TRIQUADRATIC_HEXAHEDRON}) {
    Block block(bent);
    ForEachCube(
        [&](const Place& at, int cube) { AddHexahedron(block, type, NodesOf(type), at, cube); });
    vtkUnstructuredGrid* grid = block.Finish();
    const vtkPalpateBodyCells cells = vtkPalpateToTetrahedra(grid);
    for (std::size_t i = 0; i < cells.Added.size(); ++i) {
      // The bending is of the second order, which the nodes hold: so is the middle of a diagonal.
      const auto original = [&](vtkIdType id) {
        Place x;
        grid->GetPoint(id, x.data());
        x[2] += 0.05 * x[0] * (x[1] - 0.1 * x[0] * (2 - x[0]));
        x[1] -= 0.1 * x[0] * (2 - x[0]);
        return x;
      };
      const Place a = original(cells.Added[i][0]);
      const Place b = original(cells.Added[i][1]);
      const Place expected = bent({(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, (a[2] + b[2]) / 2});
      Place x;
      cells.Body->GetPoint(grid->GetNumberOfPoints() + static_cast<vtkIdType>(i), x.data());
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(x[c], expected[c], 1e-12);
      }
    }
  }
}

TEST(BodyCells, LagrangesTetrahedraBecomeThoseOfTheirOrder) {
  for (int order = 1; order <= 4; ++order) {
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    const int size = (order + 1) * (order + 2) * (order + 3) / 6;
    std::vector<vtkIdType> ids;
    for (vtkIdType i = 0; i < size; ++i) {
      vtkIdType b[4];
      vtkHigherOrderTetra::BarycentricIndex(i, b, order);
      points->InsertNextPoint(0.1 * b[0] / order, 0.2 * b[1] / order, 0.3 * b[2] / order);
      ids.push_back(i);
    }
    grid->SetPoints(points);
    grid->InsertNextCell(VTK_LAGRANGE_TETRAHEDRON, size, ids.data());
    const vtkPalpateBodyCells cells = vtkPalpateToTetrahedra(grid);
    ASSERT_EQ(cells.Body->GetNumberOfCells(), 1) << order;
    EXPECT_EQ(cells.Body->GetCellType(0), order == 1 ? VTK_TETRA : VTK_QUADRATIC_TETRA);
    vtkIdType number;
    const vtkIdType* corners;
    cells.Body->GetCellPoints(0, number, corners);
    EXPECT_NEAR(std::abs(Volume(cells.Body, corners)), 0.001, 1e-15) << order;
    // An even order has the middles of its edges.
    EXPECT_EQ(cells.Added.size(), order == 3 ? 6U : 0U);
    EXPECT_EQ(cells.LeftOut.find("1 cells of an order above 2") != std::string::npos, order > 2);
    for (int edge = 0; order > 1 && edge < 6; ++edge) {
      constexpr int ends[6][2] = {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}};
      double a[3], b[3], m[3];
      cells.Body->GetPoint(corners[ends[edge][0]], a);
      cells.Body->GetPoint(corners[ends[edge][1]], b);
      cells.Body->GetPoint(corners[4 + edge], m);
      for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(m[c], (a[c] + b[c]) / 2, 1e-15) << order << ' ' << edge;
      }
    }
  }
}

TEST(BodyCells, ABodyOfTetrahedraIsTakenAsItIs) {
  Block block;
  block.Add(VTK_TETRA, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 0);
  vtkUnstructuredGrid* grid = block.Finish();
  EXPECT_EQ(vtkPalpateToTetrahedra(grid).Body, grid);
}

TEST(BodyCells, WhatIsNoSolidIsLeftOutAndCounted) {
  Block block;
  block.Add(VTK_VERTEX, {{0, 0, 0}}, 5);
  block.Add(VTK_TRIANGLE, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 6);
  block.Add(VTK_TETRA, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 7);
  block.Add(VTK_TRIANGLE, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, 8);
  block.Add(VTK_LINE, {{0, 0, 0}, {9, 9, 9}}, 9);
  vtkUnstructuredGrid* grid = block.Finish();
  vtkNew<vtkIdTypeArray> ids;
  ids->SetName("GlobalIds");
  for (vtkIdType point = 0; point < grid->GetNumberOfPoints(); ++point) {
    ids->InsertNextValue(100 + point);
  }
  grid->GetPointData()->SetGlobalIds(ids);
  const vtkPalpateBodyCells cells = vtkPalpateToTetrahedra(grid);
  ASSERT_EQ(cells.Body->GetNumberOfCells(), 1);
  EXPECT_EQ(cells.Body->GetCellData()->GetArray("Cube")->GetTuple1(0), 7);
  EXPECT_EQ(cells.Body->GetNumberOfPoints(), grid->GetNumberOfPoints());
  EXPECT_EQ(cells.Body->GetPointData()->GetGlobalIds(), ids.Get());
  EXPECT_EQ(cells.LeftOut,
            "Cells that are no solids are left out: 1 vtkVertex, 1 vtkLine, 2 vtkTriangle.");
}

void ExpectRefused(vtkUnstructuredGrid* grid, const std::vector<std::string>& words) {
  try {
    (void)vtkPalpateToTetrahedra(grid);
    FAIL() << words.front();
  } catch (const palpate::InputError& error) {
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
}

TEST(BodyCells, WhatIsNoBodyIsRefused) {
  const std::vector<Place> corners = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Block triangles;
  triangles.Add(VTK_TRIANGLE, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 6);
  ExpectRefused(triangles.Finish(), {"no solid cells", "1 vtkTriangle"});
  Block unknown;
  unknown.Add(VTK_TETRA, corners, 0);
  unknown.Add(VTK_CONVEX_POINT_SET, corners, 0);
  ExpectRefused(unknown.Finish(), {"Cell 1", "vtkConvexPointSet", "filter Tetrahedralize"});
  Block mixed;
  mixed.Add(VTK_HEXAHEDRON, NodesOf(VTK_HEXAHEDRON), 0);
  mixed.Add(VTK_QUADRATIC_TETRA, NodesOf(VTK_QUADRATIC_TETRA), 0);
  ExpectRefused(mixed.Finish(), {"Cell 1", "vtkQuadraticTetra", "10 points", "mixed"});
}

TEST(BodyCells, AChoiceHasTheNewPointsBetweenItsEnds) {
  vtkPalpateBodyCells cells;
  cells.Added = {{0, 1}, {1, 2}, {0, 2}};
  EXPECT_EQ(vtkPalpateExtendChoice(cells, {1, 0, 1}), (std::vector<char>{1, 0, 1, 0, 0, 1}));
}
}  // namespace

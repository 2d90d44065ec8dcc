// SPDX-License-Identifier: BSD-3-Clause
// A scene as VTK's data, and back.
#include <gtest/gtest.h>

#include <algorithm>

#include "assembly/scene.h"
#include "base/error.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

namespace
{
using palpate::Law;
using palpate::Scene;

/// Two tetrahedra on a common face, each of its own material, held at one corner.
Scene TwoTetrahedra(palpate::ElementOrder order)
{
  Scene scene;
  scene.mesh.order = order;
  scene.mesh.points = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { 1, 1, 1 } };
  const std::vector<std::array<palpate::Index, 4>> corners = { { 0, 1, 2, 3 }, { 1, 2, 3, 4 } };
  constexpr int edges[6][2] = { { 0, 1 }, { 1, 2 }, { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
  for (const auto& cell : corners)
  {
    scene.mesh.cells.insert(scene.mesh.cells.end(), cell.begin(), cell.end());
    for (const auto& edge : edges)
    {
      if (order == palpate::ElementOrder::quadratic)
      {
        auto& points = scene.mesh.points;
        const palpate::Vec3 middle = (points[cell[edge[0]]] + points[cell[edge[1]]]) / 2;
        const auto known = std::find(points.begin(), points.end(), middle);
        scene.mesh.cells.push_back(static_cast<palpate::Index>(known - points.begin()));
        if (known == points.end())
        {
          points.push_back(middle);
        }
      }
    }
  }
  // Values that no binary fraction holds: what comes back is to be the same to the last bit.
  scene.materials = { palpate::make_isotropic(Law::neo_hookean, 10000.1, 0.45),
    palpate::make_mooney_rivlin(1293.1, 431.03, 33333.3) };
  scene.material_of_cell = { 0, 1 };
  scene.fixed.assign(scene.mesh.points.size(), 0);
  scene.fixed[0] = 1;
  scene.touchable.assign(scene.mesh.points.size(), 0);
  scene.touchable[4] = 1;
  palpate::check(scene);
  return scene;
}

class SceneAsData : public testing::TestWithParam<palpate::ElementOrder>
{
};

TEST_P(SceneAsData, ComesBackTheSame)
{
  const Scene scene = TwoTetrahedra(GetParam());
  const auto grid = vtkPalpateGridFromScene(scene);
  EXPECT_EQ(grid->GetCellType(1),
    GetParam() == palpate::ElementOrder::linear ? VTK_TETRA : VTK_QUADRATIC_TETRA);
  const Scene back = vtkPalpateSceneFromGrid(grid);
  EXPECT_EQ(palpate::hash(back), palpate::hash(scene));
  EXPECT_EQ(back.materials, scene.materials);
  EXPECT_EQ(back.touchable, scene.touchable);
}

TEST_P(SceneAsData, WithoutTouchableTheFreeCornersOfTheSurfaceAre)
{
  const Scene scene = TwoTetrahedra(GetParam());
  const auto grid = vtkPalpateGridFromScene(scene);
  grid->GetPointData()->RemoveArray(vtkPalpateArray::Touchable);
  std::vector<char> corners(scene.mesh.points.size(), 0);
  std::fill_n(corners.begin() + 1, 4, 1);
  EXPECT_EQ(vtkPalpateSceneFromGrid(grid).touchable, corners);
}

TEST_P(SceneAsData, OneMaterialForAllCells)
{
  Scene scene = TwoTetrahedra(GetParam());
  scene.materials.resize(1);
  scene.material_of_cell.clear();
  const auto grid = vtkPalpateGridFromScene(scene);
  EXPECT_FALSE(grid->GetCellData()->HasArray(vtkPalpateArray::C10));
  const Scene back = vtkPalpateSceneFromGrid(grid);
  EXPECT_EQ(back.materials, scene.materials);
  EXPECT_EQ(palpate::hash(back), palpate::hash(scene));
}

TEST_P(SceneAsData, NamesTheArrayThatIsMissing)
{
  for (const char* name : { vtkPalpateArray::Law, vtkPalpateArray::PoissonsRatio,
         vtkPalpateArray::BulkModulus, vtkPalpateArray::Fixed })
  {
    const auto grid = vtkPalpateGridFromScene(TwoTetrahedra(GetParam()));
    grid->GetCellData()->RemoveArray(name);
    grid->GetPointData()->RemoveArray(name);
    try
    {
      static_cast<void>(vtkPalpateSceneFromGrid(grid));
      FAIL() << name;
    }
    catch (const palpate::InputError& error)
    {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, SceneAsData,
  testing::Values(palpate::ElementOrder::linear, palpate::ElementOrder::quadratic),
  [](const auto& order)
  { return order.param == palpate::ElementOrder::linear ? "Tet4" : "Tet10"; });
}

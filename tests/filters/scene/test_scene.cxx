// SPDX-License-Identifier: BSD-3-Clause
// A scene as VTK's data, and back.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>

#include "assembly/scene.h"
#include "base/error.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkDataArray.h"
#include "vtkPalpateMaterials.h"
#include "vtkPalpateScene.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

namespace {
using palpate::Law;
using palpate::Scene;

/// Two tetrahedra on a common face, each of its own material, held at one corner.
Scene TwoTetrahedra(palpate::ElementOrder order) {
  Scene scene;
  scene.body.mesh.order = order;
  scene.body.mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
  const std::vector<std::array<palpate::Index, 4>> corners = {{0, 1, 2, 3}, {1, 2, 3, 4}};
  constexpr int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (const auto& cell : corners) {
    scene.body.mesh.cells.insert(scene.body.mesh.cells.end(), cell.begin(), cell.end());
    for (const auto& edge : edges) {
      if (order == palpate::ElementOrder::quadratic) {
        auto& points = scene.body.mesh.points;
        const palpate::Vec3 middle = (points[cell[edge[0]]] + points[cell[edge[1]]]) / 2;
        const auto known = std::find(points.begin(), points.end(), middle);
        scene.body.mesh.cells.push_back(static_cast<palpate::Index>(known - points.begin()));
        if (known == points.end()) {
          points.push_back(middle);
        }
      }
    }
  }
  // Values that no binary fraction holds: what comes back is to be the same to the last bit.
  scene.organ.materials = {palpate::make_isotropic(Law::neo_hookean, 10000.1, 0.45),
                           palpate::make_mooney_rivlin(1293.1, 431.03, 33333.3)};
  scene.body.material_of_cell = {0, 1};
  scene.body.fixed.assign(scene.body.mesh.points.size(), 0);
  scene.body.fixed[0] = 1;
  scene.body.touchable.assign(scene.body.mesh.points.size(), 0);
  scene.body.touchable[4] = 1;
  palpate::check(scene);
  return scene;
}

class SceneAsData : public testing::TestWithParam<palpate::ElementOrder> {};

TEST_P(SceneAsData, ComesBackTheSame) {
  const Scene scene = TwoTetrahedra(GetParam());
  const auto grid = vtkPalpateGridFromScene(scene);
  EXPECT_EQ(grid->GetCellType(1),
            GetParam() == palpate::ElementOrder::linear ? VTK_TETRA : VTK_QUADRATIC_TETRA);
  const Scene back = vtkPalpateSceneFromGrid(grid);
  EXPECT_EQ(palpate::hash(back), palpate::hash(scene));
  EXPECT_EQ(back.organ.materials, scene.organ.materials);
  EXPECT_EQ(back.body.touchable, scene.body.touchable);
}

TEST_P(SceneAsData, WithoutTouchableTheFreeCornersOfTheSurfaceAre) {
  const Scene scene = TwoTetrahedra(GetParam());
  const auto grid = vtkPalpateGridFromScene(scene);
  grid->GetPointData()->RemoveArray(vtkPalpateArray::Touchable);
  std::vector<char> corners(scene.body.mesh.points.size(), 0);
  std::fill_n(corners.begin() + 1, 4, 1);
  EXPECT_EQ(vtkPalpateSceneFromGrid(grid).body.touchable, corners);
}

TEST_P(SceneAsData, OneMaterialForAllCells) {
  Scene scene = TwoTetrahedra(GetParam());
  scene.organ.materials.resize(1);
  scene.body.material_of_cell.clear();
  const auto grid = vtkPalpateGridFromScene(scene);
  EXPECT_FALSE(grid->GetCellData()->HasArray("C10"));
  const Scene back = vtkPalpateSceneFromGrid(grid);
  EXPECT_EQ(back.organ.materials, scene.organ.materials);
  EXPECT_EQ(palpate::hash(back), palpate::hash(scene));
}

/// A material of each law, then some in the formulation that does not suit them.
std::vector<palpate::Material> AllMaterials() {
  using palpate::make_material;
  std::vector<palpate::Material> all = {
      make_material(Law::linear, {1000.1, 0.3}),
      make_material(Law::st_venant_kirchhoff, {1000.1, 0.3}),
      make_material(Law::neo_hookean, {1000.1, 0.49}),
      make_material(Law::mooney_rivlin, {100.1, 10.3, 500.7}),
      make_material(Law::mooney_rivlin_polynomial,
                    {3000.7, 100.1, -10.3, 1.1, 2.2, 3.3, 4.4, 5.5, 6.6, 7.7}),
      make_material(Law::fung, {1000.1, 0.3, 2.7}),
      make_material(Law::neo_hookean_incompressible, {1000.1}),
      make_material(Law::mooney_rivlin_incompressible, {100.1, 0})};
  all.push_back(palpate::with_formulation(all[3], palpate::Formulation::mixed));
  all.push_back(palpate::with_formulation(all[2], palpate::Formulation::displacement));
  return all;
}

TEST_P(SceneAsData, AnyTwoMaterialsComeBackTheSame) {
  const std::vector<palpate::Material> all = AllMaterials();
  for (const palpate::Material& first : all) {
    for (const palpate::Material& second : all) {
      Scene scene = TwoTetrahedra(GetParam());
      scene.organ.materials = {first, second};
      const auto grid = vtkPalpateGridFromScene(scene);
      const Scene back = vtkPalpateSceneFromGrid(grid);
      EXPECT_EQ(palpate::hash(back), palpate::hash(scene));

      // The arrays are those that the two laws need, and no others.
      std::set<std::string> needed = {vtkPalpateArray::Law};
      for (const palpate::Material& material : {first, second}) {
        const auto& names = palpate::parameter_names(material.law);
        needed.insert(names.begin(), names.end());
        if (!(palpate::make_material(material.law, material.parameters) == material)) {
          needed.insert(vtkPalpateArray::Formulation);
        }
      }
      std::set<std::string> present;
      for (int i = 0; i < grid->GetCellData()->GetNumberOfArrays(); ++i) {
        present.insert(grid->GetCellData()->GetArrayName(i));
      }
      EXPECT_EQ(present, needed);
    }
  }
}

TEST_P(SceneAsData, ACellWithoutMaterialOrOfAnUnknownOneIsNamed) {
  const auto error = [](const char* array, double value) {
    Scene scene = TwoTetrahedra(GetParam());
    scene.organ.materials[1] = palpate::with_formulation(palpate::make_mooney_rivlin(100, 10, 500),
                                                         palpate::Formulation::mixed);
    const auto grid = vtkPalpateGridFromScene(scene);
    grid->GetCellData()->GetArray(array)->SetComponent(1, 0, value);
    try {
      static_cast<void>(vtkPalpateSceneFromGrid(grid));
    } catch (const palpate::InputError& thrown) {
      return std::string(thrown.what());
    }
    return std::string();
  };
  EXPECT_EQ(error(vtkPalpateArray::Law, 3), "");
  EXPECT_EQ(error(vtkPalpateArray::Law, -1).rfind("Cell 1 has no material.", 0), 0U);
  EXPECT_EQ(error(vtkPalpateArray::Law, 9).rfind("Cell 1 has Law 9;", 0), 0U);
  EXPECT_EQ(error(vtkPalpateArray::Formulation, 3).rfind("Cell 1 has Formulation 3;", 0), 0U);
  EXPECT_EQ(error("C01", -5).rfind("Material of cell 1: C01 is -5;", 0), 0U);
}

TEST_P(SceneAsData, NamesTheArrayThatIsMissing) {
  for (const char* name :
       {vtkPalpateArray::Law, "PoissonsRatio", "BulkModulus", vtkPalpateArray::Fixed}) {
    const auto grid = vtkPalpateGridFromScene(TwoTetrahedra(GetParam()));
    grid->GetCellData()->RemoveArray(name);
    grid->GetPointData()->RemoveArray(name);
    try {
      static_cast<void>(vtkPalpateSceneFromGrid(grid));
      FAIL() << name;
    } catch (const palpate::InputError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, SceneAsData,
                         testing::Values(palpate::ElementOrder::linear,
                                         palpate::ElementOrder::quadratic),
                         [](const auto& order) {
                           return order.param == palpate::ElementOrder::linear ? "Tet4" : "Tet10";
                         });
}  // namespace

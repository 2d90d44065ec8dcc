// SPDX-License-Identifier: BSD-3-Clause
#include "assembly/scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "base/error.h"
#include "solvers/support/block.h"
#include "solvers/support/laws.h"

namespace palpate::test::test_scene {
namespace {

Scene good_scene() {
  Scene scene = make_block(Law::neo_hookean).scene;
  scene.organ.materials.push_back(make_material(Law::linear, 100, 0.1));
  scene.body.material_of_cell.assign(scene.body.mesh.num_cells(), 0);
  return scene;
}

std::string error_of(Scene scene) {
  try {
    check(scene);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

#define EXPECT_ERROR(scene, part) \
  EXPECT_NE(error_of(scene).find(part), std::string::npos) << "message: " << error_of(scene)

TEST(CheckScene, AGoodOnePasses) { EXPECT_EQ(error_of(good_scene()), ""); }

TEST(CheckScene, TheMeshIsChecked) {
  Scene scene = good_scene();
  scene.body.mesh.cells.clear();
  EXPECT_ERROR(scene, "no tetrahedra");
}

TEST(CheckScene, Materials) {
  Scene scene = good_scene();
  scene.body.material_of_cell.pop_back();
  EXPECT_ERROR(scene, "71 of them have a material");
  scene = good_scene();
  for (Index bad : {-1, 2}) {
    scene.body.material_of_cell[5] = bad;
    EXPECT_ERROR(scene, "material " + std::to_string(bad));
  }
  scene = good_scene();
  scene.organ.materials.clear();
  EXPECT_ERROR(scene, "no material");
  scene = good_scene();
  scene.body.material_of_cell.clear();  // then all is of the first
  EXPECT_EQ(error_of(scene), "");
}

TEST(CheckScene, Boundary) {
  Scene scene = good_scene();
  scene.body.fixed.pop_back();
  EXPECT_ERROR(scene, "one value for each");
  scene = good_scene();
  scene.body.touchable.push_back(0);
  EXPECT_ERROR(scene, "one value for each");
  scene = good_scene();
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
  EXPECT_ERROR(scene, "No point of the body is fixed");
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 1);
  EXPECT_ERROR(scene, "nothing can move");
}

TEST(CheckScene, APointOfNoCellHoldsNothing) {
  Scene scene = good_scene();
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
  scene.body.mesh.points.push_back(Vec3::Zero());
  scene.body.fixed.push_back(1);
  scene.body.touchable.push_back(0);
  EXPECT_ERROR(scene, "No point of the body is fixed");
}

TEST(HashOfScene, IsOfWhatDecidesTheEquilibria) {
  const Scene scene = good_scene();
  const std::string original = hash(scene);
  EXPECT_EQ(original.size(), 32U);
  EXPECT_EQ(original.find_first_not_of("0123456789abcdef"), std::string::npos);
  EXPECT_EQ(hash(good_scene()), original);

  Scene other = scene;
  other.body.mesh.points[3].y() += 1e-16;
  EXPECT_NE(hash(other), original) << "a coordinate";
  other = scene;
  std::swap(other.body.mesh.cells[0], other.body.mesh.cells[1]);
  EXPECT_NE(hash(other), original) << "a cell";
  other = scene;
  other.organ.materials[0].parameters[0] *= 1.0000001;
  EXPECT_NE(hash(other), original) << "a parameter";
  other = scene;
  other.organ.materials[0].parameters.back() = 1;
  EXPECT_NE(hash(other), original) << "the last parameter";
  other = scene;
  other.organ.materials[0].formulation = Formulation::mixed;
  EXPECT_NE(hash(other), original) << "the formulation";
  const std::string mixed = hash(other);
  other.organ.materials[0].formulation = Formulation::mixed_fine;
  EXPECT_NE(hash(other), original) << "the formulation";
  EXPECT_NE(hash(other), mixed) << "the rule of quadrature";
  other = scene;
  other.organ.materials[0].law = Law::st_venant_kirchhoff;
  EXPECT_NE(hash(other), original) << "the law";
  other = scene;
  other.body.material_of_cell.back() = 1;
  EXPECT_NE(hash(other), original) << "the material of a cell";
  other = scene;
  other.body.fixed.back() = static_cast<char>(1 - other.body.fixed.back());
  EXPECT_NE(hash(other), original) << "a fixed point";

  other = scene;
  std::fill(other.body.touchable.begin(), other.body.touchable.end(), 0);
  EXPECT_EQ(hash(other), original) << "touchable points change no equilibrium";
  other.body.material_of_cell.clear();
  EXPECT_EQ(hash(other), original) << "the same materials, said in another way";
}

}  // namespace
}  // namespace palpate::test::test_scene

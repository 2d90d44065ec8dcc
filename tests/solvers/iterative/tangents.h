// SPDX-License-Identifier: BSD-3-Clause
// Tangents of bodies with what the iterative solver must know of them.
#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "assembly/assembly.h"
#include "assembly/node_levels.h"
#include "iterative/block_pattern.h"
#include "iterative/operator.h"
#include "iterative/preconditioner.h"
#include "solvers/support/block.h"
#include "solvers/support/bodies.h"
#include "solvers/support/box_mesh.h"
#include "solvers/support/random.h"
#include "solvers/support/tangent.h"

namespace palpate::test {

struct Tangent {
  SymmetricPattern scalars;
  std::shared_ptr<const BlockPattern> pattern;
  NodeLevels levels;
  std::vector<double> values;

  [[nodiscard]] Index size() const { return scalars.size; }
  [[nodiscard]] Eigen::MatrixXd matrix() const { return dense(scalars, values); }
  /// Adds it to the diagonal.
  void shift(double stiffness) {
    for (Index c = 0; c < size(); ++c) values[scalars.column_start[c]] += stiffness;
  }
};

/// At a state, which is rest where none is given.
inline Tangent tangent_of(const Scene& scene, NodalVector state = {}) {
  const Assembly assembly(scene);
  if (state.size() == 0) state.setZero(assembly.state_size());
  Tangent tangent;
  tangent.scalars = assembly.pattern();
  tangent.pattern = std::make_shared<const BlockPattern>(make_block_pattern(tangent.scalars));
  tangent.levels = make_node_levels(scene.body.mesh, assembly.unknown_of_point());
  NodalVector force;
  assembly.tangent(state, force, tangent.values);
  return tangent;
}

inline Scene block_scene(ElementOrder order = ElementOrder::quadratic,
                         std::array<int, 3> cells = {4, 3, 3}, double poissons_ratio = 0.45) {
  BlockOptions options;
  options.order = order;
  options.cells = cells;
  options.poissons_ratio = poissons_ratio;
  Scene scene = make_block(Law::neo_hookean, options).scene;
  for (Material& material : scene.organ.materials) {
    material = with_formulation(material, Formulation::displacement);
  }
  return scene;
}

/// A body of which dense matrices are small.
inline Scene small_scene() { return block_scene(ElementOrder::quadratic, {3, 2, 2}); }

/// Stretched along x by this share, with waves of which the gradients reach a tenth of it. Under
/// tension the tangent stays definite.
inline NodalVector stretched(const Scene& scene, double share) {
  constexpr double kWave = 80;  // 1/m
  NodalVector u = NodalVector::Zero(3 * Eigen::Index{scene.body.mesh.num_points()});
  for (Index p = 0; p < scene.body.mesh.num_points(); ++p) {
    const Vec3& x = scene.body.mesh.points[p];
    const Vec3 waves(std::sin(kWave * x.y()), std::cos(kWave * x.x()),
                     std::sin(kWave * (x.y() + x.z())));
    u.segment<3>(3 * p) =
        share * Vec3(x.x(), -0.25 * x.y(), -0.25 * x.z()) + 0.1 * share / kWave * waves;
  }
  return u;
}

/// Nothing of the body is held.
inline Scene floating(Scene scene) {
  std::fill(scene.body.fixed.begin(), scene.body.fixed.end(), 0);
  return scene;
}

/// The six rigid motions of the nodes of some places [3 n × 6].
inline Eigen::MatrixXd rigid_motions_of(const std::vector<Vec3>& places) {
  Eigen::MatrixXd motions = Eigen::MatrixXd::Zero(3 * places.size(), 6);
  for (std::size_t i = 0; i < places.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      motions(3 * i + k, k) = 1;
      motions.block<3, 1>(3 * i, 3 + k) = Vec3::Unit(k).cross(places[i]);
    }
  }
  return motions;
}

/// P, as node_levels.h defines it [3 num_nodes × 3 num_corners].
inline Eigen::MatrixXd dense_prolongation(const NodeLevels& levels) {
  Eigen::MatrixXd p = Eigen::MatrixXd::Zero(3 * levels.num_nodes(), 3 * levels.num_corners());
  for (Index node = 0; node < levels.num_nodes(); ++node) {
    for (Index parent : levels.parents[node]) {
      if (parent >= 0) p.block<3, 3>(3 * node, 3 * parent).diagonal().array() += 0.5;
    }
  }
  return p;
}

/// M x for each column, one by one.
inline Eigen::MatrixXd apply(Preconditioner& preconditioner, const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd result(columns.rows(), columns.cols());
  preconditioner.reserve(1);
  NodeVectors<double> r;
  NodeVectors<double> z;
  r.set_zero(static_cast<Index>(columns.rows() / 3), 1);
  z.set_zero(static_cast<Index>(columns.rows() / 3), 1);
  for (Eigen::Index c = 0; c < columns.cols(); ++c) {
    r.assign(columns.col(c));
    preconditioner.apply(r, z);
    z.copy_to(result.col(c));
  }
  return result;
}

/// The dimension of the null space, up to rounding.
inline Eigen::Index kernel_size(const Eigen::MatrixXd& matrix) {
  constexpr double kRounding = 1e-10;
  Eigen::FullPivLU<Eigen::MatrixXd> factor(matrix);
  factor.setThreshold(kRounding);
  return factor.dimensionOfKernel();
}

/// Every kind of preconditioner.
struct Kind {
  const char* name;
  std::function<std::unique_ptr<Preconditioner>(const Tangent&)> make;
  /// Bounds of the eigenvalues of MK. The smoother alone is one half of a cycle, and takes a mode
  /// up to 1.43 times too far; it hardly knows the low ones. A cycle is no more than exact.
  double least = 0.05;
  double greatest = 1.1;

  /// Whether it is as good for large bodies as for small ones.
  [[nodiscard]] bool is_multigrid() const { return least > 0; }
};

inline std::vector<Kind> kinds() {
  return {
      {"Smoother",
       [](const Tangent& t) {
         return make_preconditioner(t.pattern, make_smoother_cycle(t.pattern));
       },
       0, 1.45},
      {"Aggregation",
       [](const Tangent& t) {
         std::vector<Vec3> places(t.levels.num_nodes(), Vec3::Zero());
         for (Index node = 0; node < t.levels.num_nodes(); ++node) {
           for (Index parent : t.levels.parents[node]) {
             if (parent >= 0) places[node] += t.levels.corners[parent] / 2;
           }
         }
         return make_preconditioner(t.pattern, make_aggregation_cycle(t.pattern, places));
       },
       0.02},
      {"LevelsWithAggregation",
       [](const Tangent& t) {
         return make_preconditioner(t.pattern, t.levels, CoarseSolver::aggregation);
       }},
      {"LevelsWithFactor",
       [](const Tangent& t) {
         return make_preconditioner(t.pattern, t.levels, CoarseSolver::factor);
       }},
  };
}

/// Those for bodies that are large or difficult.
inline std::vector<Kind> multigrid_kinds() {
  std::vector<Kind> all = kinds();
  all.erase(std::remove_if(all.begin(), all.end(), [](const Kind& k) { return !k.is_multigrid(); }),
            all.end());
  return all;
}

}  // namespace palpate::test

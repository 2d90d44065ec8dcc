// SPDX-License-Identifier: BSD-3-Clause
// Touches that are solved for on one mesh after the other: what each says of a mesh, and where it
// begins on the next.
#pragma once

#include <optional>
#include <vector>

#include "discretisation/mesh_adaptation.h"
#include "discretisation/mesh_error_estimate.h"
#include "equilibrium/equilibrium.h"
#include "mesh/tet_mesh.h"

namespace palpate {

class CarriedTouches {
 public:
  explicit CarriedTouches(std::size_t num_touches) : found_(num_touches) {}

  /// The equilibrium of a touch that is near that on the mesh before.
  /// @param t The coordinates of the tool [d], m.
  /// @param solver Of the mesh, with the tool of the touch.
  /// @returns Nothing: none is known on the mesh before, or none is found near it.
  [[nodiscard]] std::optional<Equilibrium> settle(std::size_t touch, const Eigen::VectorXd& t,
                                                  const MeshHints& hints,
                                                  EquilibriumSolver& solver) const;

  /// What the equilibrium of a touch says of the mesh; the next mesh begins from it.
  /// @param state Null where the tool finds no way.
  [[nodiscard]] TouchOnMesh tell(std::size_t touch, const Equilibrium* state,
                                 const MeshErrorEstimator& estimator, const Interaction& tool,
                                 const TetMesh& mesh);

  /// All touches were told on this mesh.
  void end(const TetMesh& mesh) { mesh_ = mesh; }

 private:
  /// The mesh before, and the displacement of each touch on it that was found and has a small
  /// error.
  TetMesh mesh_;
  std::vector<NodalVector> found_;
};

}  // namespace palpate

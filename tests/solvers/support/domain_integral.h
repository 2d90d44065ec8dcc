// SPDX-License-Identifier: BSD-3-Clause
// The energy release rate of a plane cut by Eshelby's domain integral, which takes the state at one
// stage of the cut alone:
//
//   G = −(1/L) [ ∫ Σ : ∇(w d) dV − ∫_S W w d·N dS ],   Σ = W I − Hᵀ P
//
// with the gradient H of the displacement, the direction d in which the front grows, its length L,
// and a weight w that is 1 at the front and 0 where the body is held, moved or has another tissue.
// (Eshelby, J. Elasticity 5, 1975; Shih, Moran and Nakamura, Int. J. Fract. 30, 1986.)
#pragma once

#include <functional>

#include "assembly/scene.h"

namespace palpate::test {

/// The front of a cut at its stage.
struct CutFront {
  /// Its edges, by the corners [edges].
  std::vector<std::pair<Vec3, Vec3>> edges;
  /// In which it grows: in the sheet and across the edges in the mean.
  Vec3 direction = Vec3::Zero();
  /// Its length across the direction, m.
  double length = 0;

  [[nodiscard]] double distance(const Vec3& place) const;
};

/// @param closed The mesh at stage 0.
[[nodiscard]] CutFront find_front(const TetMesh& closed, const std::vector<OpenedFaces>& faces,
                                  int stage);

/// G, J/m².
/// @param scene The body at its stage, of one tissue without a pressure unknown.
/// @param u Displacement [3 × num_points], m.
/// @param reach The distance from the front at which w has fallen to 0, m. It is 1 up to half of
/// it.
[[nodiscard]] double release_rate(const Scene& scene, const NodalVector& u, const CutFront& front,
                                  double reach);

}  // namespace palpate::test

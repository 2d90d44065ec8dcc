// SPDX-License-Identifier: BSD-3-Clause
// The fields of the configurations of a finished space, reduced to what touching needs: on a part
// of the points alone, and by a few modes in place of every number.
//
//   u ≈ M c,   ∂u/∂t_a ≈ M ∂c/∂t_a,   p ≈ P d,   ∂p/∂t_a ≈ P ∂d/∂t_a
//
// with a basis of modes M [3 × points kept, r] and P [pressures, s] for the configurations of a
// tool space in a box of check-points: all those of an active node, or of a rigid tool those where
// it is near one place of the surface, since no small basis serves a whole organ. See pod.h.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include "fields/pod.h"
#include "mesh/tet_mesh.h"
#include "state_space/configuration.h"
#include "state_space/surface.h"

namespace palpate {

/// What a finished space keeps of the fields. The numbers are stored: keep them.
enum class Keep : std::int32_t {
  /// Displacements of the points of the surface: it is touched and shown.
  touch = 0,
  /// Displacements of all points of the cells that have a point on the surface, and pressures: the
  /// stress of the surface is known too.
  surface = 1,
  /// Every number as it was computed.
  all = 2,
};

/// "Touch", "Surface", "All".
[[nodiscard]] const char* name_of(Keep keep);

/// The points of a mesh whose fields are kept: first those of the surface in their order there,
/// then the others, ascending.
[[nodiscard]] std::vector<Index> kept_points(const TetMesh& mesh, const Surface& surface,
                                             Keep keep);

/// The default bound of a point's error, as a share of the largest displacement.
inline constexpr double kDefaultTouchBound = 1e-3;

/// What is known of a basis besides its modes.
struct BasisHead {
  /// The check-points whose configurations it serves.
  CheckPointBox box;
  Keep keep = Keep::touch;
  /// Of the configurations that it was made for: the largest displacement of a point that is kept,
  /// the largest error of a point's u, and of spacing · ∂u/∂t, m.
  double largest_displacement = 0;
  double displacement_error = 0;
  double sensitivity_error = 0;
};

struct FieldBasis : BasisHead {
  /// [3 × kept points, r], by kept_points().
  Eigen::MatrixXf modes;
  /// [num_pressures, s]; without columns where nothing is mixed, or pressures are not kept.
  Eigen::MatrixXf pressure_modes;
  /// Of each mode, then of each pressure mode [r + s]: all its numbers are multiples of this step;
  /// 0: they are any numbers. See packed_basis.h.
  Eigen::VectorXf steps;
};

/// The fields of a configuration by the modes of a basis.
struct ReducedFields {
  /// c [r], m.
  Eigen::VectorXf u;
  /// ∂c/∂t [r, 3], without unit.
  Eigen::MatrixXf v;
  /// d [s], Pa, and ∂d/∂t [s, 3], Pa/m.
  Eigen::VectorXf p;
  Eigen::MatrixXf p_v;
};

/// The fields of a configuration as a file has them.
struct StoredFields {
  /// Null: they are whole.
  std::shared_ptr<const FieldBasis> basis;
  ReducedFields reduced;
  Configuration whole;
};

/// Gives a configuration the fields that the modes make, and zero at the points that are not kept.
/// @param points As kept_points() of what the basis keeps.
void expand(const FieldBasis& basis, const ReducedFields& reduced, const std::vector<Index>& points,
            Index num_points, Configuration& configuration);

/// What of some configurations' fields is reduced, in single precision.
struct Snapshots {
  /// [3 × kept points, n], m.
  Eigen::MatrixXf u;
  /// step · ∂u/∂t [3 × kept points, 3 n], three columns a configuration, m.
  Eigen::MatrixXf w;
  /// [num_pressures, n], Pa, and step · ∂p/∂t [num_pressures, 3 n], Pa.
  Eigen::MatrixXf p;
  Eigen::MatrixXf p_w;

  Snapshots() = default;
  /// Makes room. @param num_pressures That are kept.
  Snapshots(Eigen::Index num_points, Eigen::Index num_pressures, Eigen::Index count);
  /// Takes the fields of a configuration for those of the given number.
  /// @param points As kept_points(). @param step Gives ∂u/∂t the unit of u, m.
  void set(Eigen::Index number, const Configuration& from, const std::vector<Index>& points,
           double step);
  /// Takes those of one configuration of others for those of the given number.
  void set(Eigen::Index number, const Snapshots& others, Eigen::Index of_others);
};

/// How large the fields are that a basis is made for: what its bound is a share of.
struct FieldScale {
  /// The largest displacement of a kept point, and of w, m; the largest |p| and |step · ∂p/∂t|, Pa.
  double u = 0;
  double w = 0;
  double p = 0;
  double p_w = 0;

  /// Takes in what is in some snapshots.
  void take(const Snapshots& snapshots);
  void take(const FieldScale& other);
};

/// What is reduced: the coefficients are in the order in which the configurations came.
struct Reduction {
  FieldBasis basis;
  std::vector<ReducedFields> fields;
};

/// Makes a basis for configurations that come batch by batch, see PodBasis.
class FieldReducer {
 public:
  /// @param begin Its modes stay as they are, so that what was reduced by them is served further;
  ///   null: there is none.
  /// @param scale Of all that will come.
  /// @param bound The largest error of a point's u, as a share of the largest; where all are zero,
  ///   that of w; and of a pressure.
  /// @throws InputError a bound that cannot be kept, see validate_pod_bound().
  FieldReducer(Eigen::Index num_points, Eigen::Index num_pressures, const FieldScale& scale,
               double step, double bound, const FieldBasis* begin);
  ~FieldReducer();

  void add(const Snapshots& batch);

  /// The box and what is kept are those of the basis it began with, if there is one, else to be
  /// set. The modes are rounded to multiples of steps that are as large as the bound allows.
  /// @throws BackendError rounding is larger than the bound.
  [[nodiscard]] Reduction finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The number of configurations whose snapshots are in memory at a time.
[[nodiscard]] Eigen::Index batch_size(Eigen::Index num_points, Eigen::Index num_pressures);

}  // namespace palpate

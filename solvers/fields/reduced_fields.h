// SPDX-License-Identifier: BSD-3-Clause
// The fields of the configurations of a finished space, reduced to what touching needs: on a part
// of the points alone, and by a few modes in place of every number.
//
//   u ≈ M c,   ∂u/∂t_a ≈ M ∂c/∂t_a,   p ≈ P d,   ∂p/∂t_a ≈ P ∂d/∂t_a
//
// with a basis of modes M [3 × points kept, r] and P [pressures, s] for the configurations of a
// tool space in a box of check-points. For an active node the box holds all configurations. For a
// rigid tool it holds those near one place of the surface, since no small basis serves a whole
// organ. See pod.h.
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

/// The part of the fields that a finished space keeps. The numbers are stored: keep them.
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

/// The properties of a basis besides its modes.
struct BasisHead {
  /// The check-points whose configurations it serves.
  CheckPointBox box;
  Keep keep = Keep::touch;
  /// Figures over the configurations that it was made for: the largest displacement of a kept
  /// point, the largest error of a point's u, and that of spacing · ∂u/∂t, m.
  double largest_displacement = 0;
  double displacement_error = 0;
  double sensitivity_error = 0;
};

struct FieldBasis : BasisHead {
  /// M [3 × kept points, r], in the order of kept_points().
  Eigen::MatrixXf modes;
  /// P [num_pressures, s]; without columns if no cell is mixed, or pressures are not kept.
  Eigen::MatrixXf pressure_modes;
  /// The step of each mode, then of each pressure mode [r + s]: all numbers of a mode are multiples
  /// of its step; 0: they are any numbers. See packed_basis.h.
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

/// The fields of a configuration as they are stored in a file.
struct StoredFields {
  /// Null: the fields are whole.
  std::shared_ptr<const FieldBasis> basis;
  ReducedFields reduced;
  Configuration whole;
};

/// Gives a configuration the fields that the modes make, and zero at the points that are not kept.
/// @param points The result of kept_points() for what the basis keeps.
void expand(const FieldBasis& basis, const ReducedFields& reduced, const std::vector<Index>& points,
            Index num_points, Configuration& configuration);

/// The fields of some configurations that are to be reduced, in single precision.
struct Snapshots {
  /// [3 × kept points, n], m.
  Eigen::MatrixXf u;
  /// step · ∂u/∂t [3 × kept points, 3 n], three columns a configuration, m.
  Eigen::MatrixXf w;
  /// [num_pressures, n], Pa, and step · ∂p/∂t [num_pressures, 3 n], Pa.
  Eigen::MatrixXf p;
  Eigen::MatrixXf p_w;

  Snapshots() = default;
  /// Makes room for `count` configurations. @param num_pressures The number of kept pressures.
  Snapshots(Eigen::Index num_points, Eigen::Index num_pressures, Eigen::Index count);
  /// Takes the fields of a configuration for those of the given number.
  /// @param points The result of kept_points().
  /// @param step The factor that gives ∂u/∂t the unit of u, m.
  void set(Eigen::Index number, const Configuration& from, const std::vector<Index>& points,
           double step);
  /// Copies the fields of one configuration from other snapshots, for the configuration of the
  /// given number.
  void set(Eigen::Index number, const Snapshots& others, Eigen::Index of_others);
};

/// The scale of the fields that a basis is made for. Its bound is a share of this scale.
struct FieldScale {
  /// The largest displacement of a kept point, and of w, m; the largest |p| and |step · ∂p/∂t|, Pa.
  double u = 0;
  double w = 0;
  double p = 0;
  double p_w = 0;

  /// Takes some snapshots into account.
  void take(const Snapshots& snapshots);
  void take(const FieldScale& other);
};

/// The result of a reduction. The coefficients are in the order in which the configurations came.
struct Reduction {
  FieldBasis basis;
  std::vector<ReducedFields> fields;
};

/// Makes a basis for configurations that come batch by batch, see PodBasis.
class FieldReducer {
 public:
  /// @param begin A basis that is extended. Its modes stay as they are, so that fields that were
  ///   reduced by them stay valid; null: there is none.
  /// @param scale The scale of all fields that will come.
  /// @param bound The largest error of a point's u (of w where all u are zero), and that of a
  ///   pressure, each as a share of the largest one.
  /// @throws InputError the bound cannot be kept, see validate_pod_bound().
  FieldReducer(Eigen::Index num_points, Eigen::Index num_pressures, const FieldScale& scale,
               double step, double bound, const FieldBasis* begin);
  ~FieldReducer();

  void add(const Snapshots& batch);

  /// Finishes the basis. Its box and Keep are those of the basis that it extends; without one, the
  /// caller sets them. The modes are rounded to multiples of steps that are as large as the bound
  /// allows.
  /// @throws BackendError rounding alone exceeds the bound.
  [[nodiscard]] Reduction finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The number of configurations whose snapshots are in memory at a time.
[[nodiscard]] Eigen::Index batch_size(Eigen::Index num_points, Eigen::Index num_pressures);

}  // namespace palpate

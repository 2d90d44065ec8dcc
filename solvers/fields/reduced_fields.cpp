// SPDX-License-Identifier: BSD-3-Clause
#include "fields/reduced_fields.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

using Eigen::MatrixXf;
using Eigen::VectorXf;

/// The memory that the snapshots of a batch take, bytes.
constexpr double kBytesOfBatch = 64e6;
/// The largest number of configurations in a batch.
constexpr double kMostInBatch = 1024;
/// Rounding of a field to single precision, relative to the largest displacement.
constexpr double kSinglePrecision = 6e-8;
/// The step is chosen such that rounding takes between this share of the remaining error and all of
/// it.
constexpr double kRoundingShare = 0.8;
/// A number of steps is exact in single precision, and found again when divided by the step.
constexpr float kMostSteps = 1 << 20;
constexpr int kMostTries = 8;
/// The share of the remaining error that the next try aims at.
constexpr double kAim = 0.92;
/// A limit for fields that are all zero.
constexpr double kAnyLimit = 1;

/// Modes that are rounded to multiples of steps.
struct RoundedModes {
  MatrixXf modes;
  VectorXf steps;
  /// The largest errors that rounding makes at any point, in the bound fields and in those that
  /// follow.
  double bound_error = 0;
  double following_error = 0;
};

RoundedModes round_modes(const PodFit& fit, int components, const VectorXf& steps) {
  RoundedModes rounded{fit.modes, steps, 0, 0};
  for (Eigen::Index m = 0; m < steps.size(); ++m) {
    auto mode = rounded.modes.col(m);
    const bool is_rounded =
        std::isfinite(steps[m]) && mode.cwiseAbs().maxCoeff() < kMostSteps * steps[m];
    if (!is_rounded) rounded.steps[m] = 0;
    if (is_rounded) mode = steps[m] * (mode / steps[m]).array().round().matrix();
  }
  const MatrixXf difference = fit.modes - rounded.modes;
  rounded.bound_error = largest_product_at_a_point(difference, fit.bound, components);
  rounded.following_error = largest_product_at_a_point(difference, fit.following, components);
  return rounded;
}

/// Rounds the modes as coarsely as an error allows, all of them to the same error: the step of a
/// mode goes with the inverse of its largest coefficient.
/// @param given The steps of the first modes, which stay as they are.
RoundedModes round_modes(const PodFit& fit, int components, const VectorXf& given, double allowed) {
  VectorXf shape = VectorXf::Zero(fit.modes.cols());
  for (Eigen::Index m = given.size(); m < shape.size(); ++m) {
    float largest = fit.bound.cols() > 0 ? fit.bound.row(m).cwiseAbs().maxCoeff() : 0;
    if (fit.following.cols() > 0) {
      largest = std::max(largest, fit.following.row(m).cwiseAbs().maxCoeff());
    }
    if (largest > 0) shape[m] = 1 / largest;
  }
  RoundedModes best{fit.modes, VectorXf::Zero(shape.size()), 0, 0};
  // The errors of the modes are independent: they add up as the root of their number.
  double error = allowed / std::sqrt(static_cast<double>(shape.size() + 1));
  for (int tries = 0; tries < kMostTries && allowed > 0; ++tries) {
    RoundedModes next = round_modes(fit, components, static_cast<float>(error) * shape);
    if (next.bound_error <= allowed) {
      best = std::move(next);
      if (best.bound_error >= kRoundingShare * allowed || best.bound_error == 0) break;
      error *= kAim * allowed / best.bound_error;
    } else {
      error *= kAim * allowed / next.bound_error;
    }
  }
  best.steps.head(given.size()) = given;
  return best;
}

/// Drops modes that rounding has made zero, since a basis that has such a mode cannot be extended.
/// What they would have added is in the errors.
/// @param given The number of first modes, which stay.
void drop_zero_modes(Eigen::Index given, PodFit& fit, RoundedModes& rounded) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index m = 0; m < rounded.modes.cols(); ++m) {
    if (m < given || !rounded.modes.col(m).isZero(0)) kept.push_back(m);
  }
  if (static_cast<Eigen::Index>(kept.size()) == rounded.modes.cols()) return;
  rounded.modes = rounded.modes(Eigen::seqN(0, rounded.modes.rows()), kept).eval();
  rounded.steps = rounded.steps(kept).eval();
  fit.bound = fit.bound(kept, Eigen::seqN(0, fit.bound.cols())).eval();
  fit.following = fit.following(kept, Eigen::seqN(0, fit.following.cols())).eval();
}

/// Displacements, or pressures: a field f and g = step · ∂f/∂t.
class Part {
 public:
  Part(Eigen::Index num_rows, int components, double scale, double scale_of_slopes, double bound,
       MatrixXf begin, VectorXf begin_steps)
      : components_(components),
        moves_(scale > 0),
        scale_(moves_ ? scale : scale_of_slopes),
        bound_(bound),
        begin_steps_(std::move(begin_steps)),
        pod_(num_rows, components, limit(), std::move(begin)) {}

  void add(const MatrixXf& f, const MatrixXf& g) { moves_ ? pod_.add(f, g) : pod_.add(g, f); }

  /// Modes, coefficients of f and g, and their errors.
  struct Result {
    MatrixXf modes;
    VectorXf steps;
    MatrixXf f;
    MatrixXf g;
    double error = 0;
    double slope_error = 0;
  };
  [[nodiscard]] Result finish() {
    PodFit fit = pod_.finish();
    RoundedModes rounded = round_modes(fit, components_, begin_steps_, limit() - fit.bound_error);
    fit.bound_error += rounded.bound_error;
    fit.following_error += rounded.following_error;
    drop_zero_modes(begin_steps_.size(), fit, rounded);
    const double of_single = kSinglePrecision * scale_;
    if (scale_ > 0 && fit.bound_error + of_single > bound_ * scale_) {
      throw BackendError("The modes of the fields keep " + quantity(fit.bound_error / scale_) +
                         " of the bound " + quantity(bound_) + ". Give a larger bound.");
    }
    Result result{std::move(rounded.modes),    std::move(rounded.steps),
                  std::move(fit.bound),        std::move(fit.following),
                  fit.bound_error + of_single, fit.following_error + of_single};
    if (!moves_) {
      std::swap(result.f, result.g);
      std::swap(result.error, result.slope_error);
    }
    return result;
  }

 private:
  [[nodiscard]] double limit() const {
    return scale_ > 0 ? (bound_ - kSinglePrecision) * scale_ : kAnyLimit;
  }

  int components_;
  /// Whether any f differs from zero: then the bound is one of f.
  bool moves_;
  double scale_;
  double bound_;
  /// The steps of the modes that it began with, which are not rounded again.
  VectorXf begin_steps_;
  PodBasis pod_;
};

}  // namespace

const char* name_of(Keep keep) {
  switch (keep) {
    case Keep::touch: return "Touch";
    case Keep::surface: return "Surface";
    default: return "All";
  }
}

std::vector<Index> kept_points(const TetMesh& mesh, const Surface& surface, Keep keep) {
  std::vector<Index> points = surface.mesh_points;
  if (keep == Keep::touch) return points;
  std::vector<char> on_surface(mesh.points.size(), 0);
  for (const Index p : surface.mesh_points) on_surface[static_cast<std::size_t>(p)] = 1;
  std::vector<char> beside(mesh.points.size(), keep == Keep::all ? 1 : 0);
  const Index nodes = nodes_per_cell(mesh.order);
  for (Index c = 0; c < mesh.num_cells(); ++c) {
    const Index* cell = mesh.cell(c);
    if (std::none_of(cell, cell + nodes,
                     [&](Index p) { return on_surface[static_cast<std::size_t>(p)] != 0; })) {
      continue;
    }
    for (Index a = 0; a < nodes; ++a) beside[static_cast<std::size_t>(cell[a])] = 1;
  }
  for (Index p = 0; p < mesh.num_points(); ++p) {
    const auto i = static_cast<std::size_t>(p);
    if (beside[i] != 0 && on_surface[i] == 0) points.push_back(p);
  }
  return points;
}

void expand(const FieldBasis& basis, const ReducedFields& reduced, const std::vector<Index>& points,
            Index num_points, Configuration& configuration) {
  // A configuration that was reduced before modes were added has no share of these.
  const Eigen::Index rank = reduced.u.size();
  Eigen::MatrixXf coefficients(rank, 4);
  coefficients << reduced.u, reduced.v;
  const MatrixXf fields = basis.modes.leftCols(rank) * coefficients;
  configuration.u.setZero(3 * Eigen::Index{num_points});
  configuration.v.setZero(3 * Eigen::Index{num_points}, 3);
  Eigen::Index row = 0;
  for (const Index point : points) {
    const Eigen::Index at = 3 * Eigen::Index{point};
    configuration.u.segment<3>(at) = fields.block<3, 1>(row, 0).cast<double>();
    configuration.v.block<3, 3>(at, 0) = fields.block<3, 3>(row, 1).cast<double>();
    row += 3;
  }
  const auto pressures = basis.pressure_modes.leftCols(reduced.p.size());
  configuration.p = (pressures * reduced.p).cast<double>();
  configuration.p_v = (pressures * reduced.p_v).cast<double>();
}

Snapshots::Snapshots(Eigen::Index num_points, Eigen::Index num_pressures, Eigen::Index count)
    : u(3 * num_points, count),
      w(3 * num_points, 3 * count),
      p(num_pressures, count),
      p_w(num_pressures, 3 * count) {}

void Snapshots::set(Eigen::Index number, const Configuration& from,
                    const std::vector<Index>& points, double step) {
  Eigen::Index row = 0;
  for (const Index point : points) {
    const Eigen::Index at = 3 * Eigen::Index{point};
    u.block<3, 1>(row, number) = from.u.segment<3>(at).cast<float>();
    w.block<3, 3>(row, 3 * number) = (step * from.v.block<3, 3>(at, 0)).cast<float>();
    row += 3;
  }
  if (p.rows() == 0) return;
  p.col(number) = from.p.cast<float>();
  p_w.middleCols<3>(3 * number) = (step * from.p_v).cast<float>();
}

void Snapshots::set(Eigen::Index number, const Snapshots& others, Eigen::Index of_others) {
  u.col(number) = others.u.col(of_others);
  w.middleCols<3>(3 * number) = others.w.middleCols<3>(3 * of_others);
  p.col(number) = others.p.col(of_others);
  p_w.middleCols<3>(3 * number) = others.p_w.middleCols<3>(3 * of_others);
}

void FieldScale::take(const Snapshots& snapshots) {
  take(FieldScale{largest_at_a_point(snapshots.u, 3), largest_at_a_point(snapshots.w, 3),
                  largest_at_a_point(snapshots.p, 1), largest_at_a_point(snapshots.p_w, 1)});
}

void FieldScale::take(const FieldScale& other) {
  u = std::max(u, other.u);
  w = std::max(w, other.w);
  p = std::max(p, other.p);
  p_w = std::max(p_w, other.p_w);
}

struct FieldReducer::Impl {
  FieldBasis basis;
  double step;
  Part displacements;
  Part pressures;
};

FieldReducer::FieldReducer(Eigen::Index num_points, Eigen::Index num_pressures,
                           const FieldScale& scale, double step, double bound,
                           const FieldBasis* begin) {
  validate_pod_bound(bound);
  FieldBasis basis = begin == nullptr ? FieldBasis() : *begin;
  basis.largest_displacement = std::max(basis.largest_displacement, scale.u);
  impl_ = std::make_unique<Impl>(
      Impl{basis, step,
           Part(3 * num_points, 3, scale.u, scale.w, bound, basis.modes,
                basis.steps.head(basis.modes.cols())),
           Part(num_pressures, 1, scale.p, scale.p_w, bound, basis.pressure_modes,
                basis.steps.tail(basis.pressure_modes.cols()))});
}

FieldReducer::~FieldReducer() = default;

void FieldReducer::add(const Snapshots& batch) {
  impl_->displacements.add(batch.u, batch.w);
  impl_->pressures.add(batch.p, batch.p_w);
}

Reduction FieldReducer::finish() {
  Part::Result of_u = impl_->displacements.finish();
  Part::Result of_p = impl_->pressures.finish();
  Reduction reduction{std::move(impl_->basis), {}};
  FieldBasis& basis = reduction.basis;
  basis.displacement_error = std::max(basis.displacement_error, of_u.error);
  basis.sensitivity_error = std::max(basis.sensitivity_error, of_u.slope_error);
  const auto per_metre = static_cast<float>(1 / impl_->step);
  for (Eigen::Index c = 0; c < of_u.f.cols(); ++c) {
    reduction.fields.push_back({of_u.f.col(c), per_metre * of_u.g.middleCols<3>(3 * c),
                                of_p.f.col(c), per_metre * of_p.g.middleCols<3>(3 * c)});
  }
  basis.modes = std::move(of_u.modes);
  basis.pressure_modes = std::move(of_p.modes);
  basis.steps.resize(of_u.steps.size() + of_p.steps.size());
  basis.steps << of_u.steps, of_p.steps;
  return reduction;
}

Eigen::Index batch_size(Eigen::Index num_points, Eigen::Index num_pressures) {
  const double of_one = 4 * sizeof(float) * static_cast<double>(3 * num_points + num_pressures);
  return static_cast<Eigen::Index>(std::clamp(kBytesOfBatch / of_one, 1.0, kMostInBatch));
}

}  // namespace palpate

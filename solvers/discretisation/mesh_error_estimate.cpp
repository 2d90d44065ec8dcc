// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/mesh_error_estimate.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "base/simd.h"
#include "elements/tetrahedron.h"

namespace palpate {
namespace {

/// c, see the head of the header.
constexpr double kCorrection = 1.4;
/// The step of the central difference, in mean edges: its error is of second order, 1e-10, and
/// rounding is as small.
constexpr double kStep = 1e-5;
/// The largest share of the force that its error may be.
constexpr double kMostReliable = 0.5;

constexpr Eigen::Index kTensor = 9 * Eigen::Index{kPacketSize};

/// Lays tensors out for the kernels [packets × 9 × 8].
std::vector<double> packed(const Gradients& tensors, const std::vector<Index>& points) {
  std::vector<double> result(9 * points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double* packet = result.data() + static_cast<Eigen::Index>(i / kPacketSize) * kTensor;
    for (int m = 0; m < 9; ++m) {
      packet[m * kPacketSize + static_cast<int>(i % kPacketSize)] = tensors(m, points[i]);
    }
  }
  return result;
}

}  // namespace

MeshErrorEstimator::MeshErrorEstimator(const Scene& scene, const Assembly& assembly)
    : recovery_(scene.body.mesh, scene.body.material_of_cell),
      order_(scene.body.mesh.order),
      mean_edge_(assembly.mean_edge()),
      pressures_of_corners_(assembly.pressures_of_corners()) {
  std::map<std::pair<Law, bool>, Group> groups;
  const int points_per_cell = recovery_.points_per_cell();
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    const Material& material = scene.material_of(c);
    const bool mixed = is_mixed(material.formulation);
    Group& group = groups[{law_of_energy(material.law), mixed}];
    group.norm = &best_tangent_norm(law_of_energy(material.law), mixed);
    group.is_mixed = mixed;
    has_mixed_ = has_mixed_ || mixed;
    for (int q = 0; q < points_per_cell; ++q) {
      group.points.push_back(c * points_per_cell + q);
      group.weights.push_back(recovery_.weights()[group.points.back()]);
    }
  }
  for (auto& [kind, group] : groups) {
    while (group.points.size() % kPacketSize != 0) {
      group.points.push_back(group.points.back());
      group.weights.push_back(0);
    }
    const auto count = static_cast<std::size_t>(group.norm->num_constants);
    group.constants.resize(count * group.points.size());
    for (std::size_t i = 0; i < group.points.size(); ++i) {
      const auto constants = law_constants(scene.material_of(group.points[i] / points_per_cell));
      for (std::size_t k = 0; k < count; ++k) {
        group.constants[(i / kPacketSize * count + k) * kPacketSize + i % kPacketSize] =
            constants[k];
      }
    }
    groups_.push_back(std::move(group));
  }
}

NodalVector MeshErrorEstimator::at_points(const Eigen::Ref<const NodalVector>& pressures) const {
  if (pressures.size() == 0) return {};
  const std::vector<QuadraturePoint>& rule = quadrature(order_);
  NodalVector result = NodalVector::Zero(recovery_.num_points());
  for (Eigen::Index point = 0; point < result.size(); ++point) {
    const auto q = static_cast<std::size_t>(point) % rule.size();
    const std::size_t cell = static_cast<std::size_t>(point) / rule.size();
    const Eigen::VectorXd shares = shape_values(ElementOrder::linear, rule[q].xi);
    for (int a = 0; a < 4; ++a) {
      const Index pressure = pressures_of_corners_[4 * cell + static_cast<std::size_t>(a)];
      if (pressure >= 0) result[point] += shares[a] * pressures[pressure];
    }
  }
  return result;
}

std::vector<double> MeshErrorEstimator::norms(const Group& group, const Gradients& h,
                                              const Gradients& d,
                                              const NodalVector& pressure) const {
  std::vector<double> pressures;
  if (group.is_mixed) {
    for (const Index point : group.points) pressures.push_back(pressure[point]);
  }
  std::vector<double> norms(group.points.size());
  group.norm->evaluate(static_cast<int>(group.points.size() / kPacketSize), group.constants.data(),
                       packed(h, group.points).data(), packed(d, group.points).data(),
                       pressures.data(), norms.data());
  for (std::size_t i = 0; i < norms.size(); ++i) norms[i] *= group.weights[i];
  return norms;
}

double MeshErrorEstimator::integral(const Gradients& h, const Gradients& d,
                                    const NodalVector& pressure) const {
  double sum = 0;
  for (const Group& group : groups_) {
    for (const double norm : norms(group, h, d, pressure)) sum += norm;
  }
  return sum;
}

MeshErrorEstimate MeshErrorEstimator::estimate(const LinearisedState& at) const {
  const Gradients h = recovery_.gradients(at.u);
  const Gradients d = recovery_.recover(h) - h;
  const NodalVector pressure = at_points(at.p);
  const double squared = integral(h, d, pressure);
  MeshErrorEstimate estimate;
  estimate.energy = -kCorrection * squared;
  estimate.force.resize(at.v.cols());
  const double step = kStep * mean_edge_;
  for (Eigen::Index c = 0; c < at.v.cols(); ++c) {
    const Gradients of_h = recovery_.gradients(at.v.col(c));
    const Gradients of_d = recovery_.recover(of_h) - of_h;
    const NodalVector of_pressure = at.p_v.size() > 0 ? at_points(at.p_v.col(c)) : NodalVector();
    const auto moved = [&](double by) {
      return integral(h + by * of_h, d + by * of_d, pressure + by * of_pressure);
    };
    estimate.force[c] = kCorrection * (moved(step) - moved(-step)) / (2 * step);
  }
  estimate.is_reliable = order_ == ElementOrder::quadratic && !has_mixed_ &&
                         std::isfinite(squared) && squared >= 0 && estimate.force.allFinite() &&
                         estimate.force.norm() <= kMostReliable * at.reaction.norm();
  return estimate;
}

std::vector<double> MeshErrorEstimator::energy_of_cells(const LinearisedState& at) const {
  const Gradients h = recovery_.gradients(at.u);
  const Gradients d = recovery_.recover(h) - h;
  const NodalVector pressure = at_points(at.p);
  std::vector<double> of_cells(static_cast<std::size_t>(recovery_.num_points()) /
                               static_cast<std::size_t>(recovery_.points_per_cell()));
  for (const Group& group : groups_) {
    const std::vector<double> of_points = norms(group, h, d, pressure);
    for (std::size_t i = 0; i < of_points.size(); ++i) {
      of_cells[group.points[i] / recovery_.points_per_cell()] += kCorrection * of_points[i];
    }
  }
  return of_cells;
}

}  // namespace palpate

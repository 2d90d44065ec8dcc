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
constexpr double kBondedCorrection = 3;
/// The step of the central difference, in mean edges: its error is of second order, 1e-10, and
/// rounding is as small.
constexpr double kStep = 1e-5;
/// The largest share of the force that its error may be; under a bonded tip it may be larger by as
/// much as the factor is, but is not called reliable then.
constexpr double kMost = 0.5;
/// By how much the squared norm may change, as a share of it, if the tangent is that at the
/// recovered gradient. At random touches of two livers it changed by 8 % at the most where the
/// estimate was good, and by 20 to 70 % where it was not, as in a law that stiffens steeply.
constexpr double kMostChange = 0.15;
/// A tool that has moved by no more than this share of an edge is at rest.
constexpr double kRest = 1e-6;

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
      pressures_(scene.body.mesh, assembly.pressures_of_corners(), assembly.num_pressures()),
      mesh_(scene.body.mesh),
      mean_edge_(assembly.mean_edge()),
      has_contact_(scene.has_contact()) {
  std::map<std::pair<Law, bool>, Group> groups;
  const int points_per_cell = recovery_.points_per_cell();
  for (Index c = 0; c < scene.body.mesh.num_cells(); ++c) {
    const Material& material = scene.material_of(c);
    const bool mixed = is_mixed(material.formulation);
    Group& group = groups[{law_of_energy(material.law), mixed}];
    group.norm = &best_tangent_norm(law_of_energy(material.law), mixed);
    group.is_mixed = mixed;
    for (int q = 0; q < points_per_cell; ++q) {
      group.points.push_back(c * points_per_cell + q);
      group.compliances.push_back(mixed ? volumetric_compliance(material) : 0);
      group.weights.push_back(recovery_.weights()[group.points.back()]);
    }
  }
  for (auto& [kind, group] : groups) {
    while (group.points.size() % kPacketSize != 0) {
      group.points.push_back(group.points.back());
      group.compliances.push_back(group.compliances.back());
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

MeshErrorEstimator::Field MeshErrorEstimator::field(const Eigen::Ref<const NodalVector>& u,
                                                    const Eigen::Ref<const NodalVector>& p) const {
  Field field;
  field.h = recovery_.gradients(u);
  field.d = recovery_.recover(field.h) - field.h;
  if (p.size() > 0) {
    field.pressure = pressures_.at_points(p);
    field.pressure_error = pressures_.errors(p);
  }
  return field;
}

std::vector<double> MeshErrorEstimator::norms(const Group& group, const Field& field) const {
  std::vector<double> pressures;
  if (group.is_mixed) {
    pressures.resize(3 * group.points.size());
    for (std::size_t i = 0; i < group.points.size(); ++i) {
      double* packet = pressures.data() + 3 * (i / kPacketSize * kPacketSize) + i % kPacketSize;
      packet[0] = field.pressure[group.points[i]];
      packet[kPacketSize] = field.pressure_error[group.points[i]];
      packet[2 * kPacketSize] = group.compliances[i];
    }
  }
  std::vector<double> norms(group.points.size());
  group.norm->evaluate(static_cast<int>(group.points.size() / kPacketSize), group.constants.data(),
                       packed(field.h, group.points).data(), packed(field.d, group.points).data(),
                       pressures.data(), norms.data());
  for (std::size_t i = 0; i < norms.size(); ++i) norms[i] *= group.weights[i];
  return norms;
}

double MeshErrorEstimator::integral(const Field& field) const {
  double sum = 0;
  for (const Group& group : groups_) {
    for (const double norm : norms(group, field)) sum += norm;
  }
  return sum;
}

bool MeshErrorEstimator::has_mixed_cells() const {
  return std::any_of(groups_.begin(), groups_.end(),
                     [](const Group& group) { return group.is_mixed; });
}

int MeshErrorEstimator::num_held_faces(const Interaction& tool) const {
  std::vector<char> is_held(mesh_.points.size(), 0);
  for (const PrescribedPoint& held : tool.prescribed_points()) is_held[held.point] = 1;
  int count = 0;
  for (Index c = 0; c < mesh_.num_cells(); ++c) {
    const Index* corners = mesh_.cell(c);
    // The corners of a face are all but one.
    const auto num_held = std::count_if(corners, corners + 4, [&](Index p) { return is_held[p]; });
    if (num_held == 3) ++count;
  }
  return count;
}

MeshErrorEstimate MeshErrorEstimator::estimate(const LinearisedState& at,
                                               const Interaction& tool) const {
  const Field here = field(at.u, at.p);
  MeshErrorEstimate estimate;
  estimate.is_bonded = !tool.prescribed_points().empty();
  estimate.is_bonded_to_few = estimate.is_bonded && num_held_faces(tool) < kFewestHeldFaces;
  const double correction = estimate.is_bonded ? kBondedCorrection : kCorrection;
  estimate.energy_of_cells.resize(static_cast<std::size_t>(recovery_.num_points()) /
                                  static_cast<std::size_t>(recovery_.points_per_cell()));
  double squared = 0;
  for (const Group& group : groups_) {
    const std::vector<double> of_points = norms(group, here);
    for (std::size_t i = 0; i < of_points.size(); ++i) {
      squared += of_points[i];
      estimate.energy_of_cells[group.points[i] / recovery_.points_per_cell()] +=
          correction * of_points[i];
    }
  }
  estimate.energy = -correction * squared;
  estimate.force.resize(at.v.cols());
  const double step = kStep * mean_edge_;
  for (Eigen::Index c = 0; c < at.v.cols(); ++c) {
    const Field change =
        field(at.v.col(c), at.p_v.size() > 0 ? NodalVector(at.p_v.col(c)) : NodalVector());
    const auto moved = [&](double by) {
      return integral({here.h + by * change.h, here.d + by * change.d,
                       here.pressure + by * change.pressure,
                       here.pressure_error + by * change.pressure_error});
    };
    estimate.force[c] = correction * (moved(step) - moved(-step)) / (2 * step);
  }
  // At rest, both are rounding.
  const double largest = std::max(at.reaction.norm(), kRest * mean_edge_ * at.stiffness.norm());
  const double share = estimate.force.norm() / largest;
  estimate.is_small = (at.flags & flags::inverted) == 0 && std::isfinite(squared) && squared >= 0 &&
                      estimate.force.allFinite() && share <= kMost * correction / kCorrection;
  estimate.is_mixed = has_mixed_cells();
  const auto hardly_changes = [&] {
    const double at_recovered =
        integral({here.h + here.d, here.d, here.pressure, here.pressure_error});
    return std::abs(at_recovered - squared) <= kMostChange * squared;
  };
  estimate.is_reliable = estimate.is_small && share <= kMost && !estimate.is_bonded_to_few &&
                         !estimate.is_mixed && !has_contact_ &&
                         mesh_.order == ElementOrder::quadratic && hardly_changes();
  return estimate;
}

}  // namespace palpate

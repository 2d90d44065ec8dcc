// SPDX-License-Identifier: BSD-3-Clause
#include "reduced/reduced_energy.h"

#include <algorithm>
#include <array>
#include <limits>

#include "base/simd.h"

namespace palpate {
namespace {

int num_constants(Law law) {
  switch (law) {
    case Law::mooney_rivlin_polynomial: return 1 + num_polynomial_terms;
    case Law::ogden: return 1 + 2 * max_ogden_terms;
    case Law::mooney_rivlin:
    case Law::fung: return 3;
    default: return 2;
  }
}

}  // namespace

ReducedEnergy::ReducedEnergy(const ReducedPoints& points, const std::vector<Material>& materials)
    : points_(points),
      kernels_(best_reduced_kernels()),
      single_gradients_(points.gradients.cast<float>()) {
  for (const ReducedPoints::Group& group : points.groups) {
    const int count = num_constants(group.law);
    std::vector<double>& constants = constants_.emplace_back(
        static_cast<std::size_t>(group.last_packet - group.first_packet) * count * kPacketSize);
    for (Index at = kPacketSize * group.first_packet; at < kPacketSize * group.last_packet; ++at) {
      const std::array<double, max_parameters> of_law =
          law_constants(materials[points.material[at]]);
      const Index packet = at / kPacketSize - group.first_packet;
      for (int i = 0; i < count; ++i) {
        constants[(packet * count + i) * kPacketSize + at % kPacketSize] = of_law[i];
      }
    }
  }
  const std::size_t num_points = points.material.size();
  gradients_.resize(9 * num_points);
  stress_.resize(9 * num_points);
  law_stress_.resize(6 * num_points);
  strain_.resize(6 * num_points);
  tangent_of_points_.resize(45 * num_points);
  const Eigen::Index n = points.gradients.cols();
  room_.resize(static_cast<std::size_t>(reduced_room(n)));
  force_.setZero(n);
  tangent_.setZero(n, n);
  if (points.rest_gradients.size() == 0) return;
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(n);
  const ReducedSums at_rest = evaluate(rest.data(), nullptr);
  rest_elastic_ = at_rest.elastic;
  rest_stress_ = Eigen::Map<const Eigen::VectorXd>(stress_.data(), points.rest_gradients.size());
}

ReducedEnergy::ReducedEnergy(const ReducedModel& model)
    : ReducedEnergy(model.points, model.materials) {
  if (model.support_stiffness.size() == 0) return;
  support_stiffness_ = &model.support_stiffness;
  of_springs_.setZero(force_.size());
}

ReducedSums ReducedEnergy::evaluate(const double* y, float* tangent_of_points) noexcept {
  const std::int64_t num_packets = points_.num_packets();
  const std::int64_t n = force_.size();
  const double* g = points_.gradients.data();
  kernels_.gradients(g, num_packets, n, y, gradients_.data());
  const Eigen::Index num_rest = points_.rest_gradients.size();
  Eigen::Map<Eigen::VectorXd>(gradients_.data(), num_rest) += points_.rest_gradients;
  ReducedSums sums{0, 0, std::numeric_limits<double>::max()};
  for (std::size_t i = 0; i < points_.groups.size(); ++i) {
    const ReducedPoints::Group& group = points_.groups[i];
    const ReducedPointsView view{group.first_packet,     group.last_packet, constants_[i].data(),
                                 points_.weights.data(), gradients_.data(), memory_.factors,
                                 memory_.stress,         memory_.moduli};
    const ReducedSums of_group =
        kernels_.evaluate(static_cast<int>(group.law), view,
                          {stress_.data(), law_stress_.data(), strain_.data(), tangent_of_points});
    sums.potential += of_group.potential;
    sums.elastic += of_group.elastic;
    sums.minimum_det_f = std::min(sums.minimum_det_f, of_group.minimum_det_f);
  }
  if (rest_stress_.size() > 0) take_weight(sums);
  kernels_.force(g, num_packets, n, stress_.data(), force_.data());
  if (support_stiffness_ != nullptr) add_springs(y, sums);
  return sums;
}

void ReducedEnergy::add_springs(const double* y, ReducedSums& sums) noexcept {
  const Eigen::Map<const Eigen::VectorXd> at(y, of_springs_.size());
  of_springs_.noalias() = *support_stiffness_ * at;
  const double energy = 0.5 * at.dot(of_springs_);
  sums.potential += energy;
  sums.elastic += energy;
  force_ += of_springs_;
}

void ReducedEnergy::take_weight(ReducedSums& sums) noexcept {
  const Eigen::Index size = rest_stress_.size();
  const Eigen::Map<const Eigen::VectorXd> gradients(gradients_.data(), size);
  const double work = rest_stress_.dot(gradients - points_.rest_gradients);
  sums.potential -= work;
  sums.elastic -= rest_elastic_ + work;
  Eigen::Map<Eigen::VectorXd>(stress_.data(), size) -= rest_stress_;
}

ReducedSums ReducedEnergy::linearise(const double* y) noexcept {
  const ReducedSums sums = evaluate(y, tangent_of_points_.data());
  kernels_.tangent(single_gradients_.data(), points_.num_packets(), force_.size(),
                   tangent_of_points_.data(), room_.data(), tangent_.data());
  if (support_stiffness_ != nullptr) {
    tangent_.triangularView<Eigen::Lower>() += *support_stiffness_;
  }
  return sums;
}

void ReducedEnergy::add_memory(MemoryRanges& ranges) const {
  palpate::add_memory(constants_, ranges);
  for (const std::vector<double>& constants : constants_) palpate::add_memory(constants, ranges);
  palpate::add_memory(gradients_, ranges);
  palpate::add_memory(stress_, ranges);
  palpate::add_memory(law_stress_, ranges);
  palpate::add_memory(strain_, ranges);
  palpate::add_memory(of_springs_, ranges);
  palpate::add_memory(rest_stress_, ranges);
  palpate::add_memory(single_gradients_, ranges);
  palpate::add_memory(tangent_of_points_, ranges);
  palpate::add_memory(room_, ranges);
  palpate::add_memory(force_, ranges);
  palpate::add_memory(tangent_, ranges);
}

}  // namespace palpate

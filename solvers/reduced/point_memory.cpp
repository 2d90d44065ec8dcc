// SPDX-License-Identifier: BSD-3-Clause
#include "reduced/point_memory.h"

#include <algorithm>

#include "base/simd.h"
#include "materials/prony.h"

namespace palpate {

template <class F>
void PointMemory::for_each_point(F&& f) const noexcept {
  const std::vector<Index>& materials = model_.points.material;
  for (std::size_t point = 0; point < materials.size(); ++point) {
    const auto number = static_cast<std::size_t>(materials[point]);
    if (!model_.rheologies[number].is_viscous()) continue;
    f(point, point / kPacketSize * 6 * kPacketSize + point % kPacketSize, number);
  }
}

PointMemory::PointMemory(const ReducedModel& model) : model_(model) {
  for (std::size_t m = 0; m < model.materials.size(); ++m) {
    const Rheology& rheology = model.rheologies[m];
    is_viscous_ = is_viscous_ || rheology.is_viscous();
    for (int j = 0; j < max_prony_terms; ++j) {
      if (rheology.prony_moduli[j] > 0) num_terms_ = std::max(num_terms_, j + 1);
    }
    const double mu = shear_modulus(model.materials[m]);
    OfMaterial& of = materials_.emplace_back();
    of.lambda = bulk_modulus(model.materials[m]) - 2 * mu / 3;
    of.mu = mu;
  }
  if (!is_viscous_) return;
  const std::size_t num_points = model.points.material.size();
  factors_.assign(num_points, 1);
  stress_.assign(6 * num_points, 0);
  moduli_.assign(2 * num_points, 0);
  term_stress_.assign(static_cast<std::size_t>(num_terms_), stress_);
  law_stress_ = strain_ = strain_before_ = viscous_ = rest_law_stress_ = rest_strain_ = stress_;
}

void PointMemory::set_rest(const std::vector<double>& law_stress,
                           const std::vector<double>& strain) {
  if (!is_viscous_) return;
  rest_law_stress_ = law_stress;
  rest_strain_ = strain;
  forget();
}

void PointMemory::forget() noexcept {
  for (std::vector<double>& term : term_stress_) std::fill(term.begin(), term.end(), 0.0);
  std::copy(rest_law_stress_.begin(), rest_law_stress_.end(), law_stress_.begin());
  for (std::vector<double>* of : {&strain_, &strain_before_}) {
    std::copy(rest_strain_.begin(), rest_strain_.end(), of->begin());
  }
  std::fill(viscous_.begin(), viscous_.end(), 0.0);
  work_ = stored_ = 0;
}

void PointMemory::begin_step(double h, const Vec3& rate) noexcept {
  rate_ = rate;
  for (std::size_t m = 0; m < materials_.size(); ++m) {
    const Rheology& rheology = model_.rheologies[m];
    for (int j = 0; j < num_terms_; ++j) {
      if (rheology.prony_moduli[j] == 0) continue;
      const double x = h / rheology.prony_times[j];
      materials_[m].decay[j] = std::exp(-x);
      materials_[m].share[j] = rheology.prony_moduli[j] * mean_decay(x);
    }
  }
  for_each_point([&](std::size_t point, std::size_t at, std::size_t number) {
    const OfMaterial& of = materials_[number];
    const double tau = model_.rheologies[number].viscous_time;
    Tensor6 memory{};
    const Tensor6 stress = load_tensor(law_stress_.data() + at);
    factors_[point] = 1;
    for (int j = 0; j < num_terms_; ++j) {
      factors_[point] += of.share[j];
      add(of.decay[j], load_tensor(term_stress_[j].data() + at), memory);
      add(-of.share[j], stress, memory);
    }
    Tensor6 past{};
    add(rate[1], load_tensor(strain_.data() + at), past);
    add(rate[2], load_tensor(strain_before_.data() + at), past);
    add(tau, isotropic(of.lambda, of.mu, past), memory);
    store_tensor(memory, stress_.data() + at);
    const std::size_t place = point / kPacketSize * 2 * kPacketSize + point % kPacketSize;
    moduli_[place] = tau * rate[0] * of.lambda;
    moduli_[place + kPacketSize] = tau * rate[0] * of.mu;
  });
}

void PointMemory::end_step(const double* law_stress, const double* strain) noexcept {
  stored_ = 0;
  for_each_point([&](std::size_t point, std::size_t at, std::size_t number) {
    const Rheology& rheology = model_.rheologies[number];
    const OfMaterial& of = materials_[number];
    const double weight = model_.points.weights[static_cast<Eigen::Index>(point)];
    Tensor6 viscous{};
    Tensor6 law_change = load_tensor(law_stress + at);
    add(-1, load_tensor(law_stress_.data() + at), law_change);
    for (int j = 0; j < num_terms_; ++j) {
      if (of.share[j] == 0) continue;
      Tensor6 term{};
      add(of.decay[j], load_tensor(term_stress_[j].data() + at), term);
      add(of.share[j], law_change, term);
      store_tensor(term, term_stress_[j].data() + at);
      add(1, term, viscous);
      stored_ +=
          weight * compliance_energy(of.lambda, of.mu, term) / (2 * rheology.prony_moduli[j]);
    }
    const Tensor6 now = load_tensor(strain + at);
    const Tensor6 then = load_tensor(strain_.data() + at);
    Tensor6 change{};
    add(rate_[0], now, change);
    add(rate_[1], then, change);
    add(rate_[2], load_tensor(strain_before_.data() + at), change);
    add(rheology.viscous_time, isotropic(of.lambda, of.mu, change), viscous);
    Tensor6 both = load_tensor(viscous_.data() + at);
    add(1, viscous, both);
    Tensor6 step = now;
    add(-1, then, step);
    work_ += 0.5 * weight * contract(both, step);
    store_tensor(viscous, viscous_.data() + at);
    store_tensor(load_tensor(law_stress + at), law_stress_.data() + at);
    store_tensor(then, strain_before_.data() + at);
    store_tensor(now, strain_.data() + at);
  });
}

void PointMemory::add_memory(MemoryRanges& ranges) const {
  palpate::add_memory(materials_, ranges);
  palpate::add_memory(term_stress_, ranges);
  for (const std::vector<double>& stress : term_stress_) palpate::add_memory(stress, ranges);
  for (const std::vector<double>* values :
       {&factors_, &stress_, &moduli_, &law_stress_, &strain_, &strain_before_, &viscous_,
        &rest_law_stress_, &rest_strain_}) {
    palpate::add_memory(*values, ranges);
  }
}

}  // namespace palpate

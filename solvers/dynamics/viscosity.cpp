// SPDX-License-Identifier: BSD-3-Clause
#include "dynamics/viscosity.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/simd.h"
#include "materials/prony.h"

namespace palpate {
namespace {

Tensor6 load(const std::vector<double>& from, std::size_t at) {
  return load_tensor(from.data() + at);
}

void store(const Tensor6& tensor, std::vector<double>& to, std::size_t at) {
  store_tensor(tensor, to.data() + at);
}

}  // namespace

template <class F>
void Viscosity::for_each_point(F&& f) const {
  const auto weights = assembly_.weights_of_groups();
  for (std::size_t g = 0; g < cells_.size(); ++g) {
    const std::size_t num_packets = cells_[g].size() / kPacketSize;
    const std::size_t num_points = weights[g]->size() / cells_[g].size();
    for (std::size_t p = 0; p < num_packets; ++p) {
      for (std::size_t q = 0; q < num_points; ++q) {
        for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
          const Index cell = cells_[g][p * kPacketSize + lane];
          const Index material = scene_.body.material_of(cell);
          const OfMaterial& of = materials_[material];
          if (!of.rheology.is_viscous()) continue;
          const std::size_t point = p * num_points + q;
          f(g, point * 6 * kPacketSize + lane, of, (*weights[g])[point * kPacketSize + lane]);
        }
      }
    }
  }
}

Viscosity::Viscosity(const Scene& scene, const std::vector<Rheology>& rheologies,
                     Assembly& assembly, const NodalVector& state)
    : scene_(scene), assembly_(assembly), cells_(assembly.cells_of_groups()) {
  for (std::size_t m = 0; m < scene.organ.materials.size(); ++m) {
    const Material& material = scene.organ.materials[m];
    OfMaterial& of = materials_.emplace_back();
    of.rheology = rheologies[m];
    of.mu = shear_modulus(material);
    of.lambda = (is_mixed(material.formulation) ? 0 : bulk_modulus(material)) - 2 * of.mu / 3;
    for (int j = 0; j < max_prony_terms; ++j) {
      if (of.rheology.prony_moduli[j] > 0) num_terms_ = std::max(num_terms_, j + 1);
    }
  }
  factors_.assign(scene.organ.materials.size(), 1);
  memory_.stress = assembly.make_point_tensors();
  for (const std::vector<Index>& of_group : cells_)
    memory_.moduli.emplace_back(2 * of_group.size());
  term_stress_.assign(static_cast<std::size_t>(num_terms_), assembly.make_point_tensors());
  stress_ = assembly.make_point_tensors();
  strain_ = assembly.make_point_tensors();
  viscous_ = memory_;
  if (num_terms_ > 0) law_stress(state, stress_);
  assembly_.strain_at_points(state, strain_);
  strain_before_ = strain_;
}

void Viscosity::law_stress(const NodalVector& state, PointTensors& stress) {
  // The assembly gives the stress of the law times the factors.
  assembly_.stress_at_points(state, stress);
  for_each_point([&](std::size_t g, std::size_t at, const OfMaterial& of, double) {
    const double factor = factors_[static_cast<std::size_t>(&of - materials_.data())];
    for (std::size_t m = 0; m < 6; ++m) stress[g][at + m * kPacketSize] /= factor;
  });
}

bool Viscosity::begin_step(double h, const Vec3& rate) {
  std::vector<double> factors;
  for (const OfMaterial& of : materials_) {
    double factor = 1;
    for (int j = 0; j < num_terms_; ++j) {
      if (of.rheology.prony_moduli[j] == 0) continue;
      factor += of.rheology.prony_moduli[j] * mean_decay(h / of.rheology.prony_times[j]);
    }
    factors.push_back(factor);
  }
  const bool changes = factors != factors_ || rate[0] != last_rate_;
  if (factors != factors_) {
    factors_ = std::move(factors);
    assembly_.scale_energy(scene_, factors_);
  }
  last_rate_ = rate[0];
  for_each_point([&](std::size_t g, std::size_t at, const OfMaterial& of, double) {
    Tensor6 memory{};
    const Tensor6 stress = load(stress_[g], at);
    for (int j = 0; j < num_terms_; ++j) {
      const double modulus = of.rheology.prony_moduli[j];
      if (modulus == 0) continue;
      const double x = h / of.rheology.prony_times[j];
      add(std::exp(-x), load(term_stress_[j][g], at), memory);
      add(-modulus * mean_decay(x), stress, memory);
    }
    if (of.rheology.viscous_time > 0) {
      Tensor6 past{};
      add(rate[1], load(strain_[g], at), past);
      add(rate[2], load(strain_before_[g], at), past);
      add(of.rheology.viscous_time, isotropic(of.lambda, of.mu, past), memory);
    }
    store(memory, memory_.stress[g], at);
  });
  for (std::size_t g = 0; g < cells_.size(); ++g) {
    for (std::size_t place = 0; place < cells_[g].size(); ++place) {
      const Index cell = cells_[g][place];
      const OfMaterial& of = materials_[scene_.body.material_of(cell)];
      const std::size_t at = place / kPacketSize * 2 * kPacketSize + place % kPacketSize;
      const double factor = of.rheology.viscous_time * rate[0];
      memory_.moduli[g][at] = factor * of.lambda;
      memory_.moduli[g][at + kPacketSize] = factor * of.mu;
    }
  }
  return changes;
}

void Viscosity::end_step(double h, const Vec3& rate, const NodalVector& state) {
  PointTensors strain = assembly_.make_point_tensors();
  assembly_.strain_at_points(state, strain);
  PointTensors stress = assembly_.make_point_tensors();
  if (num_terms_ > 0) law_stress(state, stress);
  stored_ = 0;
  for_each_point([&](std::size_t g, std::size_t at, const OfMaterial& of, double weight) {
    Tensor6 viscous{};
    Tensor6 law_change = load(stress[g], at);
    add(-1, load(stress_[g], at), law_change);
    for (int j = 0; j < num_terms_; ++j) {
      const double modulus = of.rheology.prony_moduli[j];
      if (modulus == 0) continue;
      const double x = h / of.rheology.prony_times[j];
      Tensor6 term{};
      add(std::exp(-x), load(term_stress_[j][g], at), term);
      add(modulus * mean_decay(x), law_change, term);
      store(term, term_stress_[j][g], at);
      add(1, term, viscous);
      stored_ += weight * compliance_energy(of.lambda, of.mu, term) / (2 * modulus);
    }
    const Tensor6 now = load(strain[g], at);
    const Tensor6 then = load(strain_[g], at);
    if (of.rheology.viscous_time > 0) {
      Tensor6 change{};
      add(rate[0], now, change);
      add(rate[1], then, change);
      add(rate[2], load(strain_before_[g], at), change);
      add(of.rheology.viscous_time, isotropic(of.lambda, of.mu, change), viscous);
    }
    Tensor6 mean = load(viscous_.stress[g], at);
    add(1, viscous, mean);
    Tensor6 step = now;
    add(-1, then, step);
    work_ += 0.5 * weight * contract(mean, step);
    store(viscous, viscous_.stress[g], at);
  });
  stress_ = std::move(stress);
  strain_before_ = std::exchange(strain_, std::move(strain));
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "storage/field_cache.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <utility>

#include "base/error.h"
#include "state_space/space_hash.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

/// Spacings that differ by less than this share, and origins by less than this share of a spacing,
/// are equal but for rounding.
constexpr double kGridRounding = 1e-9;

bool is_same_grid(const ToolSpaceSetup& a, const ToolSpaceSetup& b) {
  return a.interaction == b.interaction &&
         std::abs(a.grid.spacing() - b.grid.spacing()) <= kGridRounding * a.grid.spacing() &&
         (a.grid.origin - b.grid.origin).norm() <= kGridRounding * a.grid.spacing();
}

std::size_t bytes_of(const StoredFields& fields) {
  return bytes_of_fields(fields.whole) + bytes_of_fields(fields.reduced);
}

std::size_t bytes_of(const FieldBasis& basis) {
  return static_cast<std::size_t>(basis.modes.size() + basis.pressure_modes.size()) * sizeof(float);
}

/// The coefficients of a field by the modes of a basis.
struct Coefficients {
  Eigen::VectorXf u;
  Eigen::VectorXf p;
};

/// Adds a f + g d, where f may have fewer coefficients.
void add(const Eigen::VectorXf& f, const Eigen::MatrixXf& g, double a, const Vec3& d,
         Eigen::VectorXf& sum) {
  sum.head(f.size()) += static_cast<float>(a) * f + g * d.cast<float>();
}

}  // namespace

void FieldCache::add_up(const ToolSpaceSetup& setup, const std::vector<FieldShare>& shares,
                        Keep needed, NodalVector& u, NodalVector& p) {
  ++uses_;
  std::vector<ConfigurationSummary> missing;
  for (const FieldShare& share : shares) {
    const auto found = entries_.find(key_of(setup.key(), share.configuration));
    if (found == entries_.end()) {
      missing.push_back(share.configuration);
    } else {
      found->second.last_use = uses_;
    }
  }
  if (!missing.empty()) {
    read(setup, missing);
    forget_old_ones();
  }
  const OfBody& body = bodies_.at(setup.body);
  u.setZero(3 * static_cast<Eigen::Index>(body.points.at(Keep::all).size()));
  p.resize(0);
  std::map<const FieldBasis*, Coefficients> reduced;
  for (const FieldShare& share : shares) {
    const StoredFields& fields = entries_.at(key_of(setup.key(), share.configuration)).fields;
    if (fields.basis == nullptr) {
      add_share(share, fields.whole, u, p);
      continue;
    }
    const FieldBasis& basis = *fields.basis;
    if (basis.keep < needed) {
      throw InputError(
          path_.string() + " keeps the displacement of the " +
          (basis.keep == Keep::touch ? "points of the surface" : "cells at the surface") +
          " alone (Keep is " + name_of(basis.keep) + "). Compute the state space " + "with Keep " +
          name_of(needed) + " for what is asked for.");
    }
    const auto [sum, is_new] = reduced.try_emplace(&basis);
    if (is_new) {
      sum->second.u.setZero(basis.modes.cols());
      sum->second.p.setZero(basis.pressure_modes.cols());
    }
    add(fields.reduced.u, fields.reduced.v, share.a, share.d, sum->second.u);
    add(fields.reduced.p, fields.reduced.p_v, share.a, share.d, sum->second.p);
  }
  for (const auto& [basis, sum] : reduced) {
    const std::vector<Index>& points = body.points.at(needed);
    const Eigen::VectorXf at_points =
        basis->modes.topRows(3 * static_cast<Eigen::Index>(points.size())) * sum.u;
    for (std::size_t i = 0; i < points.size(); ++i) {
      u.segment<3>(3 * Eigen::Index{points[i]}) +=
          at_points.segment<3>(3 * static_cast<Eigen::Index>(i)).cast<double>();
    }
    if (basis->pressure_modes.cols() == 0) continue;
    if (p.size() == 0) p.setZero(basis->pressure_modes.rows());
    p += (basis->pressure_modes * sum.p).cast<double>();
  }
}

SpaceBody FieldCache::read_body(BodyId number) const {
  const StateSpaceFile file = open();
  SpaceBody body;
  body.number = number;
  body.scene = std::make_shared<const Scene>(file.read_scene(number));
  body.hash = file.scene_hash(number);
  body.at_rest = file.read_rest(number);
  return body;
}

void FieldCache::fail(const std::string& what) const {
  throw InputError(path_.string() + " no longer holds the state space that is touched: " + what +
                   ". Read or compute the state space again.");
}

StateSpaceFile FieldCache::open() const {
  StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  if (!is_same_space(scene_hash_, file.scene_hashes())) {
    fail("its scene is " + file.scene_hashes() + ", not " + scene_hash_);
  }
  return file;
}

void FieldCache::read(const ToolSpaceSetup& setup,
                      const std::vector<ConfigurationSummary>& missing) {
  StateSpaceFile file = open();
  file.share(known_);
  if (bodies_.count(setup.body) == 0) {
    OfBody body;
    const Body scene = file.read_scene(setup.body).body;
    const Surface surface = make_surface(scene);
    for (const Keep keep : {Keep::touch, Keep::surface, Keep::all}) {
      body.points[keep] = kept_points(scene.mesh, surface, keep);
    }
    body.at_rest = file.read_rest(setup.body);
    bodies_.emplace(setup.body, std::move(body));
  }
  const SettledBody& at_rest = bodies_.at(setup.body).at_rest;
  const std::vector<ToolSpace> there = file.read_tool_spaces();
  if (std::none_of(there.begin(), there.end(), [&](const ToolSpace& s) {
        return s.setup.body == setup.body && is_same_grid(s.setup, setup);
      })) {
    fail(setup.name() + " has another tip or grid there");
  }
  for (const ConfigurationSummary& summary : missing) {
    StoredFields fields;
    if (!file.read_stored(setup.key(), summary, fields)) fail("a configuration is damaged there");
    const bool is_whole = fields.basis == nullptr;
    if (is_whole &&
        (fields.whole.u.size() == 0 || fields.whole.v.rows() != fields.whole.u.size())) {
      fail("a configuration has no displacement, or no derivative of it, there");
    }
    if (is_whole) count_from_rest(at_rest, fields.whole);
    const auto [entry, is_new] =
        entries_.try_emplace(key_of(setup.key(), summary), Entry{std::move(fields), uses_});
    if (is_new) entry_bytes_ += bytes_of(entry->second.fields);
  }
}

std::size_t FieldCache::bytes() const {
  std::size_t sum = entry_bytes_;
  for (const auto& [key, basis] : known_.bases) sum += bytes_of(*basis);
  return sum;
}

/// The entries that were used longest ago go first, and a basis goes with the last entry that needs
/// it.
void FieldCache::forget_old_ones() {
  while (bytes() > most_bytes_) {
    const auto oldest = std::min_element(
        entries_.begin(), entries_.end(),
        [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; });
    if (oldest->second.last_use == uses_) return;
    const std::uint64_t old = oldest->second.last_use;
    for (auto entry = entries_.begin(); entry != entries_.end();) {
      if (entry->second.last_use != old) {
        ++entry;
        continue;
      }
      entry_bytes_ -= bytes_of(entry->second.fields);
      entry = entries_.erase(entry);
    }
    auto& bases = known_.bases;
    for (auto known = bases.begin(); known != bases.end();) {
      const bool is_needed = known->second.use_count() > 1;
      known = is_needed ? std::next(known) : bases.erase(known);
    }
  }
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "state_space/field_cache.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.h"
#include "state_space/state_space_file.h"

namespace palpate {
namespace {

/// Spacings that differ by less than this share, and origins by less than this share of a spacing,
/// are equal but for rounding.
constexpr double kSpacingRounding = 1e-9;

bool is_same_grid(const ToolSpaceSetup& a, const ToolSpaceSetup& b) {
  return a.interaction == b.interaction &&
         std::abs(a.grid.spacing() - b.grid.spacing()) <= kSpacingRounding * a.grid.spacing() &&
         (a.grid.origin - b.grid.origin).norm() <= kSpacingRounding * a.grid.spacing();
}

std::size_t bytes_of(const Configuration& c) {
  std::size_t bytes = 0;
  for_each_field(c, [&](const auto& field) {
    bytes += static_cast<std::size_t>(field.size()) * sizeof(double);
  });
  return bytes;
}

}  // namespace

std::vector<const Configuration*> FieldCache::get(const ToolSpaceSetup& setup,
                                                  const std::vector<ConfigurationSummary>& wanted) {
  ++uses_;
  std::vector<ConfigurationSummary> missing;
  for (const ConfigurationSummary& c : wanted) {
    const auto found = entries_.find(key_of(setup.id, c));
    if (found == entries_.end()) {
      missing.push_back(c);
    } else {
      found->second.last_use = uses_;
    }
  }
  if (!missing.empty()) {
    read(setup, missing);
    forget_old_ones();
  }
  std::vector<const Configuration*> fields;
  for (const ConfigurationSummary& c : wanted) {
    fields.push_back(&entries_.at(key_of(setup.id, c)).configuration);
  }
  return fields;
}

Scene FieldCache::read_scene() const { return open().read_scene(); }

void FieldCache::fail(const std::string& what) const {
  throw InputError(path_.string() + " no longer holds the state space that is touched: " + what +
                   ". Read or compute the state space again.");
}

StateSpaceFile FieldCache::open() const {
  StateSpaceFile file = StateSpaceFile::open_read_only(path_);
  if (file.scene_hash() != scene_hash_) {
    fail("its scene is " + file.scene_hash() + ", not " + scene_hash_);
  }
  return file;
}

void FieldCache::read(const ToolSpaceSetup& setup,
                      const std::vector<ConfigurationSummary>& missing) {
  const StateSpaceFile file = open();
  const std::vector<ToolSpace> there = file.read_tool_spaces();
  if (std::none_of(there.begin(), there.end(),
                   [&](const ToolSpace& s) { return is_same_grid(s.setup, setup); })) {
    fail(setup.name() + " has another tip or grid there");
  }
  for (const ConfigurationSummary& summary : missing) {
    Configuration c;
    static_cast<ConfigurationSummary&>(c) = summary;
    if (!file.read_fields(setup.id, c)) fail("a configuration is damaged there");
    if (c.u.size() == 0 || c.v.rows() != c.u.size()) {
      fail("a configuration has no displacement, or no derivative of it, there");
    }
    bytes_ += bytes_of(c);
    entries_[key_of(setup.id, c)] = {std::move(c), uses_};
  }
}

void FieldCache::forget_old_ones() {
  while (bytes_ > most_bytes_) {
    const auto oldest = std::min_element(
        entries_.begin(), entries_.end(),
        [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; });
    if (oldest->second.last_use == uses_) return;
    bytes_ -= bytes_of(oldest->second.configuration);
    entries_.erase(oldest);
  }
}

}  // namespace palpate

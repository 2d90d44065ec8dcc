// SPDX-License-Identifier: BSD-3-Clause
#include "interpolation/body_field.h"

#include <iterator>
#include <utility>

#include "interpolation/field_weights.h"

namespace palpate {

BodyField::BodyField(const TouchToolSpace& tool_space, CheckPointGrid grid)
    : setup_(tool_space.setup), configurations_(tool_space.configurations), grid_(std::move(grid)) {
  const auto& nodes = grid_.hanging_nodes();
  for (std::size_t i = 0; i < nodes.size(); ++i) hanging_.emplace(nodes[i].node, i);
  for (std::int32_t n = 0; n < grid_.num_nodes() && any_touching_ < 0; ++n) {
    if (grid_.usable(n) && touches(grid_.configuration(n))) any_touching_ = grid_.configuration(n);
  }
}

bool BodyField::touches(std::int32_t configuration) const {
  return (configurations_[static_cast<std::size_t>(configuration)].flags &
          flags::touches_nothing) == 0;
}

// The recursion ends, since a node hangs on a leaf that is larger than those it is a corner of.
void BodyField::add_node(std::int32_t node, double a, const Vec3& d, Weights& weights) const {
  if (const auto found = hanging_.find(node); found != hanging_.end()) {
    const CheckPointGrid::HangingNode& hanging = grid_.hanging_nodes()[found->second];
    for_each_corner(grid_, grid_.leaf(hanging.leaf), hanging.s, a, d,
                    [&](std::int32_t corner, double of_u, const Vec3& of_v) {
                      if (of_u != 0 || !of_v.isZero(0)) add_node(corner, of_u, of_v, weights);
                    });
    return;
  }
  visit_configuration(grid_, node, a, d,
                      [&](std::int32_t configuration, double of_u, const Vec3& of_v) {
                        Weight& weight = weights[configuration];
                        weight.a += of_u;
                        weight.d += of_v;
                      });
}

Support BodyField::find_weights(const Vec3& t, const NearStates* near, Weights& weights) const {
  const CheckPointGrid::Location at = grid_.locate(t);
  if (near != nullptr && near->serves(at, t)) {
    near->visit(t, [&](std::int32_t configuration, double a, const Vec3& d) {
      weights[configuration] = {a, a * d};
    });
    return Support::extrapolated;
  }
  if (at.support == Support::none) return Support::none;
  for_each_node(grid_, at, [&](std::int32_t node, double a, const Vec3& d) {
    if (a != 0 || !d.isZero(0)) add_node(node, a, d, weights);
  });
  return at.support;
}

Support BodyField::evaluate(const Vec3& t, FieldSource& fields, Keep needed, NodalVector& u,
                            NodalVector& p, const NearStates* near) const {
  u.resize(0);
  p.resize(0);
  Weights weights;
  const Support support = find_weights(t, near, weights);
  if (support == Support::none) return Support::none;
  for (auto weight = weights.begin(); weight != weights.end();) {
    weight = touches(weight->first) ? std::next(weight) : weights.erase(weight);
  }
  // A body at rest takes the sizes of its fields from any configuration that has them.
  if (weights.empty() && any_touching_ >= 0) weights[any_touching_] = {};
  if (weights.empty()) return Support::none;
  std::vector<FieldShare> shares;
  for (const auto& [configuration, weight] : weights) {
    shares.push_back(
        {configurations_[static_cast<std::size_t>(configuration)], weight.a, weight.d});
  }
  fields.add_up(setup_, shares, needed, u, p);
  // So far out, the extrapolation overflows, and there is no answer.
  if (!u.allFinite() || !p.allFinite()) {
    u.resize(0);
    p.resize(0);
    return Support::none;
  }
  return support;
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/bonded_patch.h"

#include <cctype>
#include <map>
#include <string>
#include <utility>

#include "base/error.h"
#include "base/quantity.h"

namespace palpate {
namespace {

std::string place(const Vec3& x) { return " at " + quantity(x, "m"); }

std::string capitalised(std::string name) {
  name.front() = static_cast<char>(std::toupper(static_cast<unsigned char>(name.front())));
  return name;
}

}  // namespace

std::unique_ptr<Interaction> BondedPatch::clone() const {
  return std::make_unique<BondedPatch>(*this);
}

std::vector<PrescribedPoint> BondedPatch::prescribed_points() const {
  std::vector<PrescribedPoint> prescribed;
  prescribed.reserve(points_.size());
  for (const Index point : points_) prescribed.push_back({point, 0});
  return prescribed;
}

double BondedPatch::displacement_scale(const Eigen::VectorXd& q) const {
  return q.lpNorm<Eigen::Infinity>();
}

std::string BondedPatch::describe(const Eigen::VectorXd& q) const {
  return "a displacement of " + quantity(q.norm(), "m");
}

InteractionList bond_nodes(const std::vector<Index>& nodes) {
  InteractionList tools;
  for (const Index node : nodes) tools.add(BondedPatch({node}));
  return tools;
}

BondedPatches::BondedPatches(const Body& body, double radius, std::string name)
    : radius_(radius),
      name_(std::move(name)),
      points_(body.mesh.points),
      fixed_(body.fixed),
      used_(points_in_use(body.mesh)),
      patches_(body.mesh) {}

InteractionList BondedPatches::around_each(const std::vector<Index>& nodes) const {
  if (nodes.empty()) throw InputError("No " + name_ + " is given. Name a point on the surface.");
  InteractionList tools;
  std::map<Index, Index> node_of_point;
  for (const Index node : nodes) {
    const BondedPatch patch = around(node);
    for (const Index point : patch.points()) {
      const auto [other, is_new] = node_of_point.emplace(point, node);
      if (!is_new && other->second == node) {
        throw InputError(capitalised(name_) + ' ' + std::to_string(node) + " is named twice.");
      }
      if (!is_new) {
        throw InputError("The tips at the " + name_ + "s " + std::to_string(other->second) +
                         " and " + std::to_string(node) + ", of radius " + quantity(radius_, "m") +
                         ", share point " + std::to_string(point) + place(points_[point]) +
                         ". Choose nodes that are farther apart, or a smaller tip radius.");
      }
    }
    tools.add(patch);
  }
  return tools;
}

BondedPatch BondedPatches::around(Index node) const {
  const std::string name = capitalised(name_) + ' ' + std::to_string(node);
  if (node < 0 || node >= static_cast<Index>(points_.size())) {
    throw InputError(name + " does not exist: the body has " + std::to_string(points_.size()) +
                     " points, counted from 0.");
  }
  if (used_[node] == 0) {
    throw InputError(name + place(points_[node]) +
                     " belongs to no cell, so that nothing moves with it. Choose another.");
  }
  if (!patches_.on_surface(node)) {
    throw InputError(name + place(points_[node]) +
                     " lies inside the body, where nothing can touch "
                     "it. Choose a point on the surface.");
  }
  if (fixed_[node] != 0) {
    throw InputError(name + place(points_[node]) +
                     " is fixed, so that it cannot be moved. Choose another.");
  }
  std::vector<Index> points = patches_.around(node, radius_);
  for (const Index point : points) {
    if (fixed_[point] == 0) continue;
    throw InputError("The tip of radius " + quantity(radius_, "m") + " at " + name_ + ' ' +
                     std::to_string(node) + place(points_[node]) + " reaches point " +
                     std::to_string(point) + place(points_[point]) +
                     ", which is fixed. Choose a node that is farther from the fixed points, or a "
                     "smaller tip radius.");
  }
  return BondedPatch(std::move(points));
}

}  // namespace palpate

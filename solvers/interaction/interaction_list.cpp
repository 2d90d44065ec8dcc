// SPDX-License-Identifier: BSD-3-Clause
#include "interaction/interaction_list.h"

#include <algorithm>
#include <limits>

namespace palpate {
namespace {

/// Calls visit(tool, its first coordinate) for each of the tools.
template <class Tools, class Visit>
void for_each_tool(const Tools& tools, Visit&& visit) {
  Index first = 0;
  for (const auto& tool : tools) {
    visit(*tool, first);
    first += tool->num_coordinates();
  }
}

Eigen::VectorXd coordinates_of(const Interaction& tool, Index first, const Eigen::VectorXd& q) {
  return q.segment(first, tool.num_coordinates());
}

/// A tool that was let go, and so acts on nothing.
class LetGo final : public Interaction {
 public:
  LetGo(Index num_coordinates, double displacement_scale)
      : num_coordinates_(num_coordinates), displacement_scale_(displacement_scale) {}

  [[nodiscard]] std::unique_ptr<Interaction> clone() const override {
    return std::make_unique<LetGo>(*this);
  }
  [[nodiscard]] Index num_coordinates() const override { return num_coordinates_; }
  [[nodiscard]] double displacement_scale(const Eigen::VectorXd& /*q*/) const override {
    return displacement_scale_;
  }
  [[nodiscard]] std::string describe(const Eigen::VectorXd& /*q*/) const override {
    return "a tool that was let go";
  }

 private:
  Index num_coordinates_;
  double displacement_scale_;
};

}  // namespace

InteractionList::InteractionList(const InteractionList& other) : Interaction(other) {
  for (const auto& tool : other.tools_) add(*tool);
}

InteractionList& InteractionList::operator=(const InteractionList& other) {
  return *this = InteractionList(other);
}

void InteractionList::add(const Interaction& tool) { tools_.push_back(tool.clone()); }

void InteractionList::let_go(Index number, const Eigen::VectorXd& q) {
  const Interaction& tool = *tools_[number];
  tools_[number] = std::make_unique<LetGo>(tool.num_coordinates(), tool.displacement_scale(q));
}

std::unique_ptr<Interaction> InteractionList::clone() const {
  return std::make_unique<InteractionList>(*this);
}

Index InteractionList::num_coordinates() const {
  Index number = 0;
  for (const auto& tool : tools_) number += tool->num_coordinates();
  return number;
}

std::vector<PrescribedPoint> InteractionList::prescribed_points() const {
  std::vector<PrescribedPoint> all;
  for_each_tool(tools_, [&](const Interaction& tool, Index first) {
    for (const PrescribedPoint& p : tool.prescribed_points()) {
      all.push_back({p.point, first + p.coordinate});
    }
  });
  return all;
}

double InteractionList::displacement_scale(const Eigen::VectorXd& q) const {
  double scale = 0;
  for_each_tool(tools_, [&](const Interaction& tool, Index first) {
    scale = std::max(scale, tool.displacement_scale(coordinates_of(tool, first, q)));
  });
  return scale;
}

double InteractionList::longest_step() const {
  double longest = std::numeric_limits<double>::infinity();
  for (const auto& tool : tools_) longest = std::min(longest, tool->longest_step());
  return longest;
}

std::string InteractionList::describe(const Eigen::VectorXd& q) const {
  std::string text;
  for_each_tool(tools_, [&](const Interaction& tool, Index first) {
    text += (first > 0 ? " and " : "") + tool.describe(coordinates_of(tool, first, q));
  });
  return text;
}

std::vector<Vec3> InteractionList::inner_places(const Eigen::VectorXd& q) const {
  std::vector<Vec3> places;
  for_each_tool(tools_, [&](const Interaction& tool, Index first) {
    const std::vector<Vec3> of_tool = tool.inner_places(coordinates_of(tool, first, q));
    places.insert(places.end(), of_tool.begin(), of_tool.end());
  });
  return places;
}

bool InteractionList::has_potential() const {
  return std::any_of(tools_.begin(), tools_.end(),
                     [](const auto& tool) { return tool->has_potential(); });
}

double InteractionList::potential(const Eigen::VectorXd& q, const NodalVector& state,
                                  NodalVector& force, Eigen::VectorXd& of_q) const {
  double sum = 0;
  for_each_tool(tools_, [&](const Interaction& tool, Index first) {
    Eigen::VectorXd of_tool = Eigen::VectorXd::Zero(tool.num_coordinates());
    sum += tool.potential(coordinates_of(tool, first, q), state, force, of_tool);
    of_q.segment(first, of_tool.size()) += of_tool;
  });
  return sum;
}

std::vector<PointPair> InteractionList::couplings() const {
  std::vector<PointPair> all;
  for (const auto& tool : tools_) {
    const std::vector<PointPair> of_tool = tool->couplings();
    all.insert(all.end(), of_tool.begin(), of_tool.end());
  }
  return all;
}

void InteractionList::add_hessian(const Eigen::VectorXd& q, const NodalVector& state,
                                  PotentialHessian& hessian) const {
  for_each_tool(tools_, [&](const Interaction& tool, Index first) {
    const Index size = tool.num_coordinates();
    PotentialHessian of_tool;
    of_tool.of_coordinates.setZero(size, size);
    tool.add_hessian(coordinates_of(tool, first, q), state, of_tool);
    hessian.of_points.insert(hessian.of_points.end(), of_tool.of_points.begin(),
                             of_tool.of_points.end());
    for (PotentialHessian::Mixed mixed : of_tool.mixed) {
      mixed.coordinate += first;
      hessian.mixed.push_back(mixed);
    }
    hessian.of_coordinates.block(first, first, size, size) += of_tool.of_coordinates;
  });
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// A liver in motion against GetFEM on the same mesh, with the same law and time step
// (tests/reference/make_motion_reference.py).
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dynamics/dynamic_solver.h"
#include "interaction/bonded_patch.h"

namespace palpate::test::test_motion_reference {
namespace {

/// Of the largest change. The methods of both codes are of second order, and not the same: a step
/// of a millisecond leaves 0.3 % with BDF2, a quarter of that with half of it.
constexpr double kRelative = 0.005;
/// GetFEM's figures at rest have nine digits behind the point, of 0.1 m and 1 N.
constexpr double kAtRest = 1e-6;

Vec3 vector(const nlohmann::json& numbers) {
  return {numbers[0].get<double>(), numbers[1].get<double>(), numbers[2].get<double>()};
}

class MotionReference : public testing::TestWithParam<TimeIntegrator> {
 protected:
  MotionReference() {
    std::ifstream file(std::string(PALPATE_TEST_DATA) + "/motion.json");
    data_ = nlohmann::json::parse(file);
    scene_.body.mesh.order = ElementOrder::quadratic;
    for (const auto& point : data_.at("points")) scene_.body.mesh.points.push_back(vector(point));
    for (const auto& cell : data_.at("cells")) {
      for (const auto& node : cell) scene_.body.mesh.cells.push_back(node);
    }
    for (const auto& fixed : data_.at("fixed")) scene_.body.fixed.push_back(fixed.get<char>());
    scene_.body.touchable.assign(scene_.body.mesh.points.size(), 1);
    const auto& parameters = data_.at("parameters");
    scene_.organ.materials = {make_isotropic(Law::neo_hookean, parameters[0], parameters[1])};
  }

  [[nodiscard]] ToolPath path() const {
    const auto& way = data_.at("way");
    std::vector<double> times;
    Eigen::MatrixXd places(3, way.size());
    for (std::size_t i = 0; i < way.size(); ++i) {
      times.push_back(static_cast<double>(i) * time_step());
      places.col(static_cast<Eigen::Index>(i)) = vector(way[i]);
    }
    return {times, places};
  }
  [[nodiscard]] double time_step() const { return data_.at("time_step"); }

  nlohmann::json data_;
  Scene scene_;
};

TEST_P(MotionReference, ForceAndDisplacementsAreThoseOfAnotherCode) {
  const auto& steps = data_.at("steps");
  DynamicsOptions options;
  options.integrator = GetParam();
  options.spectral_radius = 0.9;
  options.time_step = time_step();
  options.gravity = vector(data_.at("gravity"));
  Rheology rheology;
  rheology.density = data_.at("density");
  rheology.viscous_time = data_.at("viscous_time");
  const std::vector<Index> samples = data_.at("samples");
  std::vector<Eigen::VectorXd> ours;
  DynamicSolver solver(scene_, {rheology}, BondedPatch(data_.at("patch").get<std::vector<Index>>()),
                       options);
  const DynamicState end = solver.run(
      path(), static_cast<double>(steps.size() - 1) * time_step(), [&](const DynamicState& state) {
        Eigen::VectorXd figures(3 + 3 * samples.size());
        figures.head<3>() = state.force;
        for (std::size_t s = 0; s < samples.size(); ++s) {
          figures.segment<3>(3 + 3 * static_cast<Eigen::Index>(s)) =
              state.motion.u.segment<3>(3 * Eigen::Index{samples[s]});
        }
        ours.push_back(figures);
        return true;
      });
  ASSERT_EQ(end.outcome, Outcome::converged) << end.message;
  ASSERT_EQ(ours.size(), steps.size());

  std::vector<Eigen::VectorXd> theirs;
  for (const auto& step : steps) {
    Eigen::VectorXd figures(ours.front().size());
    figures.head<3>() = vector(step.at("force"));
    for (std::size_t s = 0; s < samples.size(); ++s) {
      figures.segment<3>(3 + 3 * static_cast<Eigen::Index>(s)) =
          vector(step.at("displacements")[s]);
    }
    theirs.push_back(figures);
  }
  EXPECT_LT((ours.front() - theirs.front()).lpNorm<Eigen::Infinity>(), kAtRest);
  for (Eigen::Index figure = 0; figure < ours.front().size(); figure += 3) {
    double largest = 0;
    double error = 0;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      const auto of = [&](const Eigen::VectorXd& figures) { return figures.segment<3>(figure); };
      largest = std::max(largest, (of(theirs[i]) - of(theirs[0])).norm());
      error = std::max(error, (of(ours[i]) - of(theirs[i])).norm());
    }
    EXPECT_LT(error, kRelative * largest) << figure << " of " << largest;
    RecordProperty("error_" + std::to_string(figure), std::to_string(error / largest));
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, MotionReference,
                         testing::Values(TimeIntegrator::bdf2, TimeIntegrator::generalised_alpha),
                         [](const auto& of) {
                           return of.param == TimeIntegrator::bdf2 ? "Bdf" : "Alpha";
                         });

}  // namespace
}  // namespace palpate::test::test_motion_reference

// SPDX-License-Identifier: BSD-3-Clause
// What a tool feels where it slides from one region of an organ into the next, whose mesh is
// another: steps of the force, the force that comes from the blending alone, what a switch from one
// region to the other would jump by, and the energy that closed slides make.
//
//   palpate_benchmark_region_borders space.palpate <depth, m>
//
// All pairs of check-points of neighbouring regions that are near each other are joined by straight
// slides, and all triples of them by closed ones. Check-points beyond the force limit are left out.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "interpolation/tool_force.h"
#include "storage/state_space_file.h"
#include "storage/stored_touch_space.h"

namespace palpate {
namespace {

/// The farthest that the ends of a slide are apart, in sides of the coarsest cells.
constexpr double kReach = 1.5;
/// A step of the tool in which the force of a body hardly changes, m, and one of a hand of 100 mm/s
/// in a tick.
constexpr double kShort = 1e-6;
constexpr double kTick = 1e-4;
/// Points of the quadrature along one side of a closed slide.
constexpr int kPoints = 200;

/// A place where the tool presses, in the middle of its region or in a band.
struct Place {
  Vec3 at;
  int region;
};

/// What was found on the slides between two regions.
struct Border {
  /// Shares of the largest force on the same slide.
  double step = 0;
  double of_blending = 0;
  double switched = 0;
  double told = 0;
};

class Slides {
 public:
  Slides(const TouchSpace& space, double depth)
      : parts_(space.list_pressing()), force_(parts_, Method::energy_hermite) {
    const std::optional<RegionWeights> weights = region_weights(parts_);
    if (!weights) throw InputError("The space has no regions.");
    for (const TouchToolSpace* part : parts_) {
      for (const ConfigurationSummary& c : part->configurations) {
        const Vec3 at = c.t;
        if (!c.leads_on() || c.force.isZero(0) || part->clearance(at) < -depth) continue;
        const int region = weights->nearest(at);
        if (parts_[static_cast<std::size_t>(region)] == part) places_.push_back({at, region});
      }
    }
    const Grid& grid = parts_.front()->setup.grid;
    reach_ = kReach * grid.coarsest * grid.spacing();
  }

  void print_borders() const {
    std::vector<Border> borders;
    std::set<std::pair<int, int>> pairs;
    int outside = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      for (std::size_t j = i + 1; j < places_.size(); ++j) {
        const auto [first, second] = std::minmax(places_[i].region, places_[j].region);
        if (first == second || (places_[i].at - places_[j].at).norm() > reach_) continue;
        const auto slid = slide(places_[i].at, places_[j].at);
        if (!slid) {
          ++outside;
          continue;
        }
        pairs.insert({first, second});
        borders.push_back(*slid);
      }
    }
    const auto percent = [&](const char* name, double Border::*figure) {
      std::vector<double> values;
      for (const Border& border : borders) values.push_back(100 * border.*figure);
      std::sort(values.begin(), values.end());
      const auto at = [&](double share) {
        return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
      };
      std::printf("| %s | %.3f | %.3f | %.3f | %.3f |\n", name, at(0.5), at(0.9), at(0.99),
                  values.back());
    };
    std::printf("%zu slides over %zu borders of %zu regions, %d more leave the space\n\n",
                borders.size(), pairs.size(), parts_.size(), outside);
    if (borders.empty()) return;
    std::printf("| %% of the largest force of the slide | median | 90 %% | 99 %% | largest |\n");
    std::printf("|---|---|---|---|---|\n");
    percent("step of the force within 1 µm", &Border::step);
    percent("force that the blending adds", &Border::of_blending);
    percent("what a switch would jump by", &Border::switched);
    percent("bound of the error of the mesh", &Border::told);
  }

  void print_loops() const {
    double largest = 0;
    double of_scale = 0;
    double highest = 0;
    int loops = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      for (std::size_t j = i + 1; j < places_.size(); ++j) {
        if ((places_[i].at - places_[j].at).norm() > reach_) continue;
        for (std::size_t k = j + 1; k < places_.size(); ++k) {
          const std::array<Place, 3> ends = {places_[i], places_[j], places_[k]};
          if (ends[0].region == ends[1].region && ends[1].region == ends[2].region) continue;
          if ((ends[0].at - ends[2].at).norm() > reach_) continue;
          if ((ends[1].at - ends[2].at).norm() > reach_) continue;
          double work = 0;
          double energy = 0;
          bool is_inside = true;
          for (std::size_t side = 0; side < 3; ++side) {
            is_inside = is_inside && add_work(ends[side].at, ends[(side + 1) % 3].at, work, energy);
          }
          if (!is_inside) continue;
          ++loops;
          largest = std::max(largest, std::abs(work));
          highest = std::max(highest, energy);
          of_scale = std::max(of_scale, std::abs(work) / energy);
        }
      }
    }
    std::printf(
        "\n%d closed slides over borders: energy made %.3g µJ at the most, %.2g %% of the largest "
        "energy of the slide, which is up to %.3g µJ\n",
        loops, 1e6 * largest, 100 * of_scale, 1e6 * highest);
  }

 private:
  [[nodiscard]] std::optional<Border> slide(const Vec3& a, const Vec3& b) const {
    Border border;
    double largest = 0;
    const Vec3 along = (b - a).normalized();
    for (Vec3 x = a; (x - a).norm() < (b - a).norm(); x += kTick * along) {
      const TouchResult here = force_.evaluate(x);
      const TouchResult next = force_.evaluate(x + kShort * along);
      if (here.support != Support::inside || next.support != Support::inside) return std::nullopt;
      largest = std::max(largest, here.force.norm());
      const double expected = (here.stiffness * along).norm() * kShort;
      border.step = std::max(border.step, (next.force - here.force).norm() - expected);
      border.told = std::max(border.told, here.mesh_error.bound);
      Vec3 sum = Vec3::Zero();
      std::vector<Vec3> forces;
      force_.visit_weights(x, [&](std::size_t part, double weight) {
        forces.push_back(force_.part(part).evaluate(x).force);
        sum += weight * forces.back();
      });
      border.of_blending = std::max(border.of_blending, (here.force - sum).norm());
      for (const Vec3& one : forces) {
        border.switched = std::max(border.switched, (one - forces.front()).norm());
      }
    }
    for (double* figure : {&border.step, &border.of_blending, &border.switched, &border.told}) {
      *figure /= largest;
    }
    return border;
  }

  /// Adds the work of a slide, by Simpson's rule. @returns False: it leaves the space.
  [[nodiscard]] bool add_work(const Vec3& a, const Vec3& b, double& work, double& energy) const {
    const Vec3 step = (b - a) / kPoints;
    for (int i = 0; i <= kPoints; ++i) {
      const TouchResult here = force_.evaluate(a + i * step);
      if (here.support != Support::inside) return false;
      const double weight = i == 0 || i == kPoints ? 1 : (i % 2 == 1 ? 4 : 2);
      work += weight / 3 * here.force.dot(step);
      energy = std::max(energy, std::abs(here.energy));
    }
    return true;
  }

  std::vector<const TouchToolSpace*> parts_;
  ToolForce force_;
  std::vector<Place> places_;
  double reach_ = 0;
};

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
  try {
    if (argc < 3) throw palpate::InputError("Give the file of a space of regions and a depth.");
    const palpate::TouchSpace space =
        palpate::make_touch_space_without_modes(palpate::StateSpaceFile::open_read_only(argv[1]));
    const palpate::Slides slides(space, std::atof(argv[2]));
    slides.print_borders();
    slides.print_loops();
    return EXIT_SUCCESS;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return EXIT_FAILURE;
  }
}

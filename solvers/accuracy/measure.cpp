// SPDX-License-Identifier: BSD-3-Clause
#include "accuracy/measure.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <random>
#include <utility>

#include "accuracy/coarsen.h"
#include "accuracy/draw.h"
#include "accuracy/statistics.h"
#include "equilibrium/work.h"
#include "interpolation/body_field.h"
#include "interpolation/display_field.h"
#include "interpolation/solution_branches.h"

namespace palpate {
namespace {

constexpr int kLoops = 20;
constexpr int kFacePoints = 1000;
/// The number of timed calls, so large that a thousandth of them is a few.
constexpr std::size_t kTimedCalls = 8192;

/// A tool space with its branches, and one interpolator for each that is needed.
class Subject {
 public:
  Subject(const TouchToolSpace& tool_space, const Variant& variant)
      : tool_space_(tool_space), variant_(variant), branches_(tool_space) {
    (void)on(0);
  }

  /// The branch that the body is on when it is moved, see SolutionBranches::move.
  [[nodiscard]] int move(int branch, const Vec3& from, const Vec3& to) const {
    return branches_.move(branch, from, to);
  }

  [[nodiscard]] const Interpolator& on(int branch) { return *part_on(branch).interpolator; }
  [[nodiscard]] const DisplayField& field_on(int branch) {
    Part& here = part_on(branch);
    if (!here.field) here.field = std::make_unique<DisplayField>(space_on(branch));
    return *here.field;
  }
  /// The fields of a rigid tool, which has one branch.
  [[nodiscard]] const BodyField& body_field() {
    if (!body_field_) body_field_ = std::make_unique<BodyField>(tool_space_);
    return *body_field_;
  }

 private:
  /// The objects that belong to a branch.
  struct Part {
    std::unique_ptr<Interpolator> interpolator;
    std::unique_ptr<DisplayField> field;
  };

  [[nodiscard]] TouchToolSpace space_on(int branch) const {
    return palpate::on_branch(tool_space_, branches_, branch);
  }

  Part& part_on(int branch) {
    parts_.resize(static_cast<std::size_t>(branches_.size()));
    Part& here = parts_[static_cast<std::size_t>(branch)];
    if (!here.interpolator) {
      // The linear method takes the stiffness at rest, which is on branch 0.
      const int of = variant_.method == Method::linear ? 0 : branch;
      InterpolationOptions options = variant_.options;
      // The forces that are compared are those of the same mesh.
      options.correct_mesh_error = false;
      here.interpolator = make_interpolator(variant_.method, space_on(of), options);
    }
    return here;
  }

  const TouchToolSpace& tool_space_;
  const Variant& variant_;
  SolutionBranches branches_;
  std::vector<Part> parts_;
  std::unique_ptr<BodyField> body_field_;
};

double largest_stiffness(const TouchToolSpace& tool_space) {
  double largest = 0;
  for (const ConfigurationSummary& c : tool_space.configurations) {
    if (c.leads_on()) largest = std::max(largest, c.stiffness.norm());
  }
  return largest;
}

PointClass class_of(const TestPoint& point, Support support) {
  if (point.outcome != Outcome::converged) return PointClass::failed;
  if (!point.regular()) return PointClass::irregular;
  switch (support) {
    case Support::inside: return PointClass::inside;
    case Support::marked: return PointClass::marked;
    default: return PointClass::extrapolated;
  }
}

/// Evaluates the displayed displacement of the body.
class Shown {
 public:
  /// @param points The test points. For a rigid tool, their displacements give the largest one.
  Shown(const TouchSpace& space, const TouchToolSpace& tool_space, FieldCache* fields,
        const std::vector<TestPoint>& points)
      : space_(space),
        of_space_(space.find(tool_space.setup.key())),
        presses_(tool_space.setup.presses()),
        fields_(fields),
        samples_(sample_points(space.surface)),
        largest_(space.largest_displacement) {
    if (!presses_) return;
    for (const TestPoint& point : points) {
      for (Eigen::Index s = 0; s + 2 < point.displacement.size(); s += 3) {
        largest_ = std::max(largest_, static_cast<double>(point.displacement.segment<3>(s).norm()));
      }
    }
  }

  /// Adds the largest error of the displacement at the sample points, if it can be evaluated.
  void add_error(Subject& subject, int branch, const TestPoint& point,
                 std::vector<double>& errors) {
    const auto size = 3 * static_cast<Eigen::Index>(samples_.size());
    if (point.displacement.size() != size || !evaluate(subject, branch, point.t)) return;
    double largest = 0;
    for (Eigen::Index s = 0; s < size; s += 3) {
      const Eigen::Vector3f error = u_.segment<3>(s) - point.displacement.segment<3>(s);
      largest = std::max(largest, static_cast<double>(error.norm()));
    }
    errors.push_back(largest_ > 0 ? largest / largest_ : largest);
  }

 private:
  /// @returns Whether the displacement can be evaluated.
  bool evaluate(Subject& subject, int branch, const Vec3& t) {
    u_.resize(3 * static_cast<Eigen::Index>(samples_.size()));
    if (!presses_) {
      const DisplayField& field = subject.field_on(branch);
      Eigen::VectorXf c(field.num_modes());
      field.coefficients(t, c.data());
      for (std::size_t s = 0; s < samples_.size(); ++s) {
        u_.segment<3>(3 * static_cast<Eigen::Index>(s)) =
            of_space_->modes.middleRows<3>(3 * Eigen::Index{samples_[s]}) * c;
      }
      return true;
    }
    if (fields_ == nullptr || of_space_->setup.body != kFirstBody) return false;
    NodalVector u;
    NodalVector p;
    (void)subject.body_field().evaluate(t, *fields_, Keep::touch, u, p);
    if (u.size() == 0) return false;
    for (std::size_t s = 0; s < samples_.size(); ++s) {
      const Eigen::Index point = space_.surface.mesh_points[samples_[s]];
      u_.segment<3>(3 * static_cast<Eigen::Index>(s)) = u.segment<3>(3 * point).cast<float>();
    }
    return true;
  }

  const TouchSpace& space_;
  /// The tool space with its modes; the measured one is a part of it.
  const TouchToolSpace* of_space_;
  bool presses_;
  FieldCache* fields_;
  std::vector<Index> samples_;
  double largest_;
  /// The displayed displacement at the sample points.
  Eigen::VectorXf u_;
};

void measure_errors(const TouchSpace& space, const TouchToolSpace& tool_space, Subject& subject,
                    const SolvedPoints& points, FieldCache* fields, std::vector<PointError>& errors,
                    Measurement& result) {
  const double floor = kErrorFloor * largest_force(tool_space.configurations);
  const double stiffness_floor = kErrorFloor * largest_stiffness(tool_space);
  const bool presses = tool_space.setup.presses();
  Shown shown(space, tool_space, fields, points.exact);
  int branch = 0;
  Vec3 at = Vec3::Zero();
  for (std::size_t i = 0; i < points.exact.size(); ++i) {
    const TestPoint& point = points.exact[i];
    const bool goes_on = point.kind == TestKind::walk && point.number % kWalkLength != 0;
    if (!goes_on) {
      branch = 0;
      at.setZero();
    }
    if (point.kind == TestKind::uniform) {
      const Vec3 anchor = anchor_of(point.t, tool_space.setup.grid.half_width);
      branch = subject.move(branch, at, anchor);
      at = anchor;
    }
    branch = subject.move(branch, at, point.t);
    at = point.t;
    const TouchResult touch = subject.on(branch).evaluate(point.t);
    PointError& error = errors.emplace_back();
    error.support = touch.support;
    error.point_class = class_of(point, touch.support);
    ++result.points[static_cast<std::size_t>(error.point_class)];
    error.error = std::numeric_limits<double>::quiet_NaN();
    if (error.point_class == PointClass::failed) continue;
    const double absolute = (touch.force - point.force).norm();
    error.error =
        absolute / std::max({point.force.norm(), floor, std::numeric_limits<double>::min()});
    if (error.point_class == PointClass::irregular) continue;
    if (point.kind == TestKind::near_rest) result.near_rest.push_back(error.error);
    if (error.point_class == PointClass::marked) result.marked.push_back(error.error);
    if (error.point_class == PointClass::extrapolated) result.extrapolated.push_back(error.error);
    if (error.point_class != PointClass::inside) continue;
    result.absolute.push_back(absolute);
    result.largest_force = std::max(result.largest_force, point.force.norm());
    const bool is_reliable = touch.mesh_error.trust == MeshErrorTrust::reliable;
    if (touch.mesh_error.trust != MeshErrorTrust::none) {
      result.mesh.push_back(touch.mesh_error.force.norm());
      if (is_reliable) ++result.reliable_mesh;
    }
    if (const std::optional<Vec3>& finer = points.finer[i]) {
      const Vec3 of_mesh = point.force - *finer;
      result.measured_mesh.push_back(of_mesh.norm());
      if (is_reliable) result.left_mesh.push_back((of_mesh - touch.mesh_error.force).norm());
    }
    shown.add_error(subject, branch, point, result.displacement);
    if (presses && point.kind == TestKind::near_rest) continue;
    result.relative.push_back(error.error);
    result.stiffness.push_back(
        (touch.stiffness - point.stiffness).norm() /
        std::max({point.stiffness.norm(), stiffness_floor, std::numeric_limits<double>::min()}));
  }
}

/// Gauss-Legendre quadrature on [0, 1], exact up to degree 15; the derivative of a triquintic along
/// a straight line has degree 14.
struct Gauss {
  static constexpr int kPoints = 8;
  std::array<double, kPoints> x{};
  std::array<double, kPoints> weight{};

  Gauss() {
    constexpr std::array<double, 4> at{0.1834346424956498, 0.5255324099163290, 0.7966664774136267,
                                       0.9602898564975363};
    constexpr std::array<double, 4> of{0.3626837833783620, 0.3137066458778873, 0.2223810344533745,
                                       0.1012285362903763};
    for (std::size_t i = 0; i < 4; ++i) {
      x[i] = 0.5 * (1 - at[i]);
      x[7 - i] = 0.5 * (1 + at[i]);
      weight[i] = weight[7 - i] = 0.5 * of[i];
    }
  }
};

bool is_beyond(const TouchResult& touch) {
  return touch.support == Support::extrapolated || touch.support == Support::none;
}

/// ∫ h·dt along a straight line, cell by cell.
/// @param peak Raised to the largest energy on the line, J.
/// @returns NaN: a part of the line is extrapolated.
double work_along(const Interpolator& interpolator, const Grid& grid, const Vec3& from,
                  const Vec3& to, double& peak) {
  static const Gauss gauss;
  const Vec3 way = to - from;
  std::vector<double> cuts{0, 1};
  for (int k = 0; k < 3; ++k) {
    if (way[k] == 0) continue;
    for (std::int32_t i = -grid.reach(); i <= grid.reach(); ++i) {
      const double s = (i * grid.spacing() - (from[k] - grid.origin[k])) / way[k];
      if (s > 0 && s < 1) cuts.push_back(s);
    }
  }
  std::sort(cuts.begin(), cuts.end());
  double work = 0;
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const double length = cuts[i] - cuts[i - 1];
    for (int q = 0; q < Gauss::kPoints; ++q) {
      const auto p = static_cast<std::size_t>(q);
      const TouchResult touch =
          interpolator.evaluate(from + (cuts[i - 1] + length * gauss.x[p]) * way);
      if (is_beyond(touch)) {
        return std::numeric_limits<double>::quiet_NaN();
      }
      work += length * gauss.weight[p] * touch.force.dot(way);
      peak = std::max(peak, std::abs(touch.energy));
    }
  }
  return work;
}

/// Random places in the box, or in the cells of a sparse grid; the same for every method.
class Places {
 public:
  explicit Places(const TouchToolSpace& tool_space)
      : grid_(tool_space.setup.grid), uniform_(-grid_.half_width, grid_.half_width) {
    if (!grid_.sparse) return;
    const CellTree tree(grid_, tool_space.configurations);
    for (const CellTree::Leaf& leaf : tree.leaves()) cells_.push_back(leaf.cell);
  }

  Vec3 operator()() {
    if (grid_.sparse) return in(any_cell());
    const double x = uniform_(random_);
    const double y = uniform_(random_);
    return {x, y, uniform_(random_)};
  }

  /// A random point on a side between cells.
  Vec3 on_side(int axis) {
    const std::int32_t reach = grid_.reach();
    if (grid_.sparse) {
      const Cell& cell = any_cell();
      Vec3 t = in(cell);
      t[axis] = grid_.place(cell.first)[axis];
      return t;
    }
    Vec3 t = (*this)();
    t[axis] = grid_.spacing() *
              std::uniform_int_distribution<std::int32_t>(1 - reach, reach - 1)(random_);
    return t;
  }

  int any_axis() { return std::uniform_int_distribution<int>(0, 2)(random_); }

 private:
  const Cell& any_cell() {
    return cells_[std::uniform_int_distribution<std::size_t>(0, cells_.size() - 1)(random_)];
  }
  Vec3 in(const Cell& cell) {
    const double side = cell.side * grid_.spacing();
    Vec3 t = grid_.place(cell.first);
    for (double& x : t) x += side * std::uniform_real_distribution<double>(0, 1)(random_);
    return t;
  }

  Grid grid_;
  std::mt19937_64 random_{2008};
  std::uniform_real_distribution<double> uniform_;
  /// The cells of a sparse grid.
  std::vector<Cell> cells_;
};

/// A closed path by its corners.
using Loop = std::vector<Vec3>;

/// Quadrilaterals in the box.
std::vector<Loop> loops_in_box(Places place) {
  std::vector<Loop> loops;
  for (int i = 0; i < kLoops; ++i) loops.push_back({place(), place(), place(), place()});
  return loops;
}

/// Each slide of a rigid tool, returning with the tool lifted off by the side of a coarsest cell.
std::vector<Loop> loops_over_surface(const Grid& grid, const std::vector<TestPoint>& points) {
  const double lift = grid.coarsest * grid.spacing();
  std::map<std::int32_t, std::pair<Loop, Loop>> slides;
  for (const TestPoint& point : points) {
    if (point.kind != TestKind::walk || !point.regular() || point.force.isZero(0)) continue;
    auto& [there, back] = slides[point.number / kWalkLength];
    there.push_back(point.t);
    back.push_back(point.t - lift * point.force.normalized());
  }
  std::vector<Loop> loops;
  for (auto& [number, slide] : slides) {
    auto& [there, back] = slide;
    there.insert(there.end(), back.rbegin(), back.rend());
    loops.push_back(std::move(there));
  }
  return loops;
}

void measure_loops(const Interpolator& interpolator, const Grid& grid,
                   const std::vector<Loop>& loops, Measurement& result) {
  for (const Loop& corners : loops) {
    double peak = 0;
    double work = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      work += work_along(interpolator, grid, corners[i], corners[(i + 1) % corners.size()], peak);
    }
    if (std::isfinite(work) && peak > 0) result.loop_work.push_back(std::abs(work) / peak);
  }
}

void measure_jumps(const Interpolator& interpolator, const TouchToolSpace& tool_space, Places place,
                   Measurement& result) {
  const Grid& grid = tool_space.setup.grid;
  if (grid.reach() < 1) return;
  const double force = largest_force(tool_space.configurations);
  const double stiffness = largest_stiffness(tool_space);
  if (!(force > 0 && stiffness > 0)) return;
  for (int i = 0; i < kFacePoints; ++i) {
    const int axis = place.any_axis();
    const Vec3 t = place.on_side(axis);
    const double apart = 4 * std::numeric_limits<double>::epsilon() *
                         std::max(grid.half_width, t.lpNorm<Eigen::Infinity>());
    const Vec3 step = apart * Vec3::Unit(axis);
    const TouchResult a = interpolator.evaluate(t - step);
    const TouchResult b = interpolator.evaluate(t + step);
    if (grid.sparse && (is_beyond(a) || is_beyond(b))) continue;
    result.force_jump.push_back((b.force - a.force).norm() / force);
    result.stiffness_jump.push_back((b.stiffness - a.stiffness).norm() / stiffness);
  }
}

/// Times single calls at random places, without the time of reading the clock.
void measure_time(const Interpolator& interpolator, Places place, Measurement& result) {
  std::vector<Vec3> places(kTimedCalls);
  for (Vec3& t : places) t = place();
  const auto nanoseconds = [](SteadyClock::time_point a, SteadyClock::time_point b) {
    return std::chrono::duration<double, std::nano>(b - a).count();
  };
  std::vector<double> of_clock;
  double sum = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto a = SteadyClock::now();
    of_clock.push_back(nanoseconds(a, SteadyClock::now()));
    sum += interpolator.evaluate(places[static_cast<std::size_t>(i)]).energy;  // warms up
  }
  const double overhead = quantile(of_clock, 0.5);
  for (const Vec3& t : places) {
    const auto a = SteadyClock::now();
    const TouchResult touch = interpolator.evaluate(t);
    const auto b = SteadyClock::now();
    sum += touch.energy;
    result.nanoseconds.push_back(std::max(nanoseconds(a, b) - overhead, 0.0));
  }
  // The sum is used, or the compiler could leave the calls out.
  volatile double used = sum;
  (void)used;
}

template <class Values>
void append(Values& to, const Values& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

Measurement& Measurement::operator+=(const Measurement& other) {
  samples += other.samples;
  precompute_seconds += other.precompute_seconds;
  setup_seconds += other.setup_seconds;
  bytes += other.bytes;
  resolution = std::max(resolution, other.resolution);
  spacing = std::max(spacing, other.spacing);
  tool_spaces += other.tool_spaces;
  for (std::size_t i = 0; i < points.size(); ++i) points[i] += other.points[i];
  append(relative, other.relative);
  append(absolute, other.absolute);
  largest_force = std::max(largest_force, other.largest_force);
  append(mesh, other.mesh);
  reliable_mesh += other.reliable_mesh;
  append(measured_mesh, other.measured_mesh);
  append(left_mesh, other.left_mesh);
  append(stiffness, other.stiffness);
  append(displacement, other.displacement);
  append(marked, other.marked);
  append(near_rest, other.near_rest);
  append(extrapolated, other.extrapolated);
  append(loop_work, other.loop_work);
  append(force_jump, other.force_jump);
  append(stiffness_jump, other.stiffness_jump);
  append(nanoseconds, other.nanoseconds);
  return *this;
}

std::string to_string(const Variant& variant) {
  std::string name = to_string(variant.method);
  const InterpolationOptions& o = variant.options;
  if (!o.linear_polynomial) name += ", no polynomial";
  if (!o.intermediate_states) name += ", no intermediate states";
  if (!o.third_derivatives) name += ", no third derivatives";
  return name;
}

std::vector<Variant> variants(const TouchToolSpace& tool_space,
                              const std::vector<Method>& methods) {
  const auto& all = tool_space.configurations;
  const bool has_third = std::any_of(all.begin(), all.end(), [](const ConfigurationSummary& c) {
    return c.has_third_derivative();
  });
  const bool has_rest = std::any_of(all.begin(), all.end(), [](const ConfigurationSummary& c) {
    return c.check_point == CheckPoint{} && c.usable();
  });
  std::vector<Variant> result;
  for (const Method method : methods.empty() ? all_methods() : methods) {
    if (tool_space.setup.grid.sparse && !serves_sparse_grids(method)) continue;
    for (const std::int32_t factor :
         coarsening_factors(tool_space.setup.grid, smallest_side(tool_space))) {
      if (method == Method::tricubic && tool_space.setup.grid.coarsest > factor) continue;
      // The stiffness at rest is the same on every grid.
      if (method == Method::linear && (factor != 1 || !has_rest)) continue;
      const bool is_rbf = method == Method::rbf_linear || method == Method::rbf_cubic;
      Variant variant{method, {}, factor};
      // A coarser grid has no intermediate states.
      if (is_rbf && factor != 1) {
        variant.options.intermediate_states = tool_space.intermediate_states.empty();
      }
      result.push_back(variant);
      if (is_rbf && factor == 1) {
        variant.options.linear_polynomial = false;
        result.push_back(variant);
        variant.options.linear_polynomial = true;
        variant.options.intermediate_states = false;
        if (!tool_space.intermediate_states.empty()) result.push_back(variant);
      }
      if (method == Method::energy_hermite && has_third) {
        variant.options.third_derivatives = false;
        result.push_back(variant);
      }
    }
  }
  return result;
}

Measurement measure(const TouchSpace& space, const TouchToolSpace& whole, const Variant& variant,
                    const SolvedPoints& points, std::vector<PointError>& errors,
                    FieldCache* fields) {
  const TouchToolSpace tool_space = coarsened(whole, variant.factor);
  Measurement result;
  result.tool_spaces = 1;
  const Grid& grid = tool_space.setup.grid;
  const std::int32_t side = smallest_side(tool_space);
  result.resolution = 2 * (grid.reach() / side) + 1;
  result.spacing = side * grid.spacing();
  const auto start = SteadyClock::now();
  Subject subject(tool_space, variant);
  result.setup_seconds = seconds_since(start);
  const Interpolator& interpolator = subject.on(0);
  result.samples = static_cast<double>(interpolator.num_samples());
  result.bytes = static_cast<double>(interpolator.bytes());
  for (const ConfigurationSummary& c : tool_space.configurations) {
    const bool counts =
        variant.method != Method::linear || (c.check_point == CheckPoint{} && c.level == 0);
    if (counts) result.precompute_seconds += c.seconds;
  }
  const bool is_rbf = variant.method == Method::rbf_linear || variant.method == Method::rbf_cubic;
  if (is_rbf && variant.options.intermediate_states) {
    for (const IntermediateState& s : tool_space.intermediate_states) {
      result.precompute_seconds += s.seconds;
    }
  }
  measure_errors(space, tool_space, subject, points, fields, errors, result);
  const Places places(tool_space);
  measure_loops(interpolator, grid,
                grid.sparse ? loops_over_surface(grid, points.exact) : loops_in_box(places),
                result);
  measure_jumps(interpolator, tool_space, places, result);
  measure_time(interpolator, places, result);
  return result;
}

}  // namespace palpate

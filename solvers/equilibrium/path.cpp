// SPDX-License-Identifier: BSD-3-Clause
#include "equilibrium/path.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/error.h"
#include "equilibrium/linearisation.h"

namespace palpate {
namespace {

/// The largest number of iterations of a step along the path; a step that needs more is halved.
constexpr int kMaxStepIterations = 20;
/// A step with this number of iterations keeps its length.
constexpr double kUsualIterations = 8;
/// A factor is used as long as an iteration leaves at most this share of the residual.
constexpr double kContraction = 0.25;
/// The least cosine between the tangents at the ends of a step; below it, the step may have left
/// its branch.
constexpr double kLeastTurnCosine = 0.9;
/// The shortest step, as a share of the first.
constexpr double kShortestStep = 1e-4;

/// A point (x, λ) of the path, or a direction there; x is a whole state, with the points that the
/// tool prescribes.
struct Vector {
  NodalVector x;
  double way = 0;
};

class Follower {
 public:
  Follower(CondensedSystem& system, const EquilibriumOptions& options,
           const PathOptions& path_options, const Interruption& interruption,
           const Equilibrium& start, Eigen::VectorXd target)
      : system_(system),
        options_(options),
        path_options_(path_options),
        interruption_(interruption),
        t_0_(start.t),
        target_(std::move(target)),
        at_(start),
        here_{system.vector_of(start), 0} {
    const NodalVector along = system.sensitivity_of(start) * (target_ - t_0_);
    weight_ = along.squaredNorm();
    tangent_ = tangent_at(start);
    add_point(start, 0);
    first_length_ = path_options_.first_step / tangent_.way;
    length_ = first_length_;
  }

  Path run() {
    Outcome outcome = Outcome::converged;
    while (here_.way < 1 && outcome == Outcome::converged) {
      outcome = static_cast<int>(path_.points.size()) < path_options_.max_points
                    ? interruption_()
                    : Outcome::budget_used_up;
      if (outcome != Outcome::converged) break;
      if (advance()) continue;
      if (goes_through_) {
        outcome = Outcome::tool_inside;
        break;
      }
      length_ *= 0.5;
      if (length_ < kShortestStep * first_length_) outcome = Outcome::not_converged;
    }
    land();
    at_.outcome = outcome;
    at_.summary.folds = path_.folds;
    if (!path_.folds.empty()) at_.flags |= flags::near_fold;
    at_.summary.iterations = iterations_;
    path_.end = std::move(at_);
    return std::move(path_);
  }

 private:
  [[nodiscard]] Eigen::VectorXd t_at(double way) const {
    return way == 1 ? target_ : Eigen::VectorXd(t_0_ + way * (target_ - t_0_));
  }

  [[nodiscard]] double product(const Vector& a, const Vector& b) const {
    return a.x.dot(b.x) + weight_ * a.way * b.way;
  }

  /// The tangent of unit length along which λ increases.
  [[nodiscard]] Vector tangent_at(const Equilibrium& equilibrium) const {
    Vector tangent{system_.sensitivity_of(equilibrium) * (target_ - t_0_), 1};
    const double length = std::sqrt(product(tangent, tangent));
    tangent.x /= length;
    tangent.way /= length;
    return tangent;
  }

  void add_point(const Equilibrium& equilibrium, double way) {
    path_.points.push_back({way, equilibrium.energy, equilibrium.reaction,
                            equilibrium.minimum_det_f, equilibrium.negative_pivots});
  }

  /// Does one step of the present length. It returns false if the step has to be shorter.
  bool advance() {
    Vector next{here_.x + length_ * tangent_.x, here_.way + length_ * tangent_.way};
    int iterations = 0;
    double residual = 0;
    if (!correct_across(false, next, iterations, residual)) return false;
    const bool arrives = next.way >= 1;
    if (arrives) {
      const double share = (1 - here_.way) / (next.way - here_.way);
      next.x = here_.x + share * (next.x - here_.x);
      next.way = 1;
      if (!correct_across(true, next, iterations, residual)) return false;
    }
    goes_through_ = system_.tool_is_inside(t_at(next.way), next.x);
    if (goes_through_) return false;
    Equilibrium equilibrium;
    std::optional<Linearisation> at_next = linearise(system_, t_at(next.way), next.x);
    if (!at_next) return false;
    static_cast<LinearisedState&>(equilibrium) = std::move(at_next->state);
    Vector tangent = tangent_at(equilibrium);
    const double cosine = product(tangent, tangent_);
    if (std::abs(cosine) < kLeastTurnCosine) return false;
    if (cosine < 0) {
      tangent.x = -tangent.x;
      tangent.way = -tangent.way;
    }
    equilibrium.summary.residual = residual;
    add_point(equilibrium, next.way);
    if (tangent_.way > 0 && tangent.way < 0) add_fold(equilibrium, next, tangent);
    at_ = std::move(equilibrium);
    at_.summary.steps = static_cast<int>(path_.points.size());
    here_ = std::move(next);
    tangent_ = std::move(tangent);
    length_ *= std::clamp(std::sqrt(kUsualIterations / std::max(iterations, 1)), 0.5, 2.0);
    length_ = std::min(length_, path_options_.largest_step * first_length_);
    return true;
  }

  /// Corrects a predicted point to the path, in the plane normal to the tangent or at constant λ,
  /// by Newton's method with a factor that is kept as long as it contracts.
  bool correct_across(bool at_its_way, Vector& point, int& iterations, double& residual) {
    TangentFactor* factor = system_.find_factor(at_.t, here_.x);
    if (factor == nullptr) factor = system_.factorise(at_.t, here_.x);
    NodalVector along = system_.sensitivity_of(at_) * (target_ - t_0_);
    double last_norm = 0;
    Eigen::VectorXd r;
    for (int i = 0;; ++i, ++iterations, ++iterations_) {
      const Eigen::VectorXd t = t_at(point.way);
      system_.prescribe(t, point.x);
      const Evaluation at = system_.evaluate(t, point.x);
      if (!at.is_finite()) return false;
      r = system_.residual(at);
      const double norm = system_.norm(r);
      residual = norm / system_.displacement_scale(t);
      if (residual <= options_.tolerance) return true;
      if (!std::isfinite(norm) || i == kMaxStepIterations) return false;
      if (factor == nullptr || (i > 0 && norm > kContraction * last_norm)) {
        const auto tangent = system_.tangent(t, point.x);
        factor = system_.factorise(*tangent);
        if (factor == nullptr) return false;
        Eigen::VectorXd w = -tangent->mixed * (target_ - t_0_);
        system_.solve(*factor, w);
        along = system_.as_state(w);
        system_.prescribe_change(target_ - t_0_, along);
      }
      last_norm = norm;
      system_.solve(*factor, r);
      const NodalVector y = -system_.as_state(r);
      double change = 0;
      if (!at_its_way) {
        change = -tangent_.x.dot(y) / (tangent_.x.dot(along) + weight_ * tangent_.way);
        if (!std::isfinite(change)) return false;
      }
      point.x += y + change * along;
      point.way += change;
    }
  }

  /// Adds the fold at the maximum of λ(s) between the present point and the next one, where the
  /// slopes are known.
  void add_fold(const Equilibrium& next, const Vector& point, const Vector& tangent) {
    const double s =
        std::sqrt((point.x - here_.x).squaredNorm() + weight_ * std::pow(point.way - here_.way, 2));
    const double slope_0 = tangent_.way * s;
    const double slope_1 = tangent.way * s;
    const double rise = point.way - here_.way;
    // The derivative of the cubic λ is a x² + b x + c on [0, 1], positive at 0 and negative at 1.
    const double a = 3 * (slope_0 + slope_1 - 2 * rise);
    const double b = 2 * (3 * rise - 2 * slope_0 - slope_1);
    const double c = slope_0;
    const double root = std::sqrt(std::max(0.0, b * b - 4 * a * c));
    const double x = std::clamp(2 * c / (-b + root), 0.0, 1.0);
    Fold fold;
    fold.way = here_.way + x * (c + x * (b / 2 + x * a / 3));
    fold.t = t_at(fold.way);
    fold.energy = at_.energy + x * (next.energy - at_.energy);
    fold.reaction = at_.reaction + x * (next.reaction - at_.reaction);
    path_.folds.push_back(std::move(fold));
    fold_after_.push_back(path_.points.size() - 1);
  }

  /// Finds for each fold the point at which the path reaches its λ again, with λ increasing.
  void land() {
    for (std::size_t f = 0; f < path_.folds.size(); ++f) {
      Fold& fold = path_.folds[f];
      for (std::size_t i = fold_after_[f] + 1; i < path_.points.size() && !fold.lands; ++i) {
        const PathPoint& a = path_.points[i - 1];
        const PathPoint& b = path_.points[i];
        if (!(a.way < fold.way && b.way >= fold.way)) continue;
        const double share = (fold.way - a.way) / (b.way - a.way);
        fold.lands = true;
        fold.landing_energy = a.energy + share * (b.energy - a.energy);
        fold.landing_reaction = a.reaction + share * (b.reaction - a.reaction);
      }
    }
  }

  CondensedSystem& system_;
  const EquilibriumOptions& options_;
  const PathOptions& path_options_;
  const Interruption& interruption_;
  Eigen::VectorXd t_0_;
  Eigen::VectorXd target_;
  /// The weight of λ in the arc length: at the start, λ counts as much as x.
  double weight_ = 1;

  /// The last point, as an equilibrium and as a vector, and the tangent there.
  Equilibrium at_;
  Vector here_;
  Vector tangent_;
  double first_length_ = 0;
  double length_ = 0;
  /// Whether the tool has passed through the surface of the body in the step that was tried last.
  bool goes_through_ = false;
  int iterations_ = 0;
  Path path_;
  /// Index of the first point behind each fold.
  std::vector<std::size_t> fold_after_;
};

}  // namespace

void validate(const PathOptions& options) {
  if (!(options.first_step > 0 && options.first_step <= 1)) {
    throw InputError("first_step must be above 0 and at most 1.");
  }
  if (!(options.largest_step >= 1)) throw InputError("largest_step must be at least 1.");
  if (options.max_points < 2) throw InputError("max_points must be at least 2.");
}

Path follow_path(CondensedSystem& system, const EquilibriumOptions& options,
                 const PathOptions& path_options, const Interruption& interruption,
                 const Equilibrium& start, const Eigen::VectorXd& target) {
  return Follower(system, options, path_options, interruption, start, target).run();
}

}  // namespace palpate

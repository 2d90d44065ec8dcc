// SPDX-License-Identifier: BSD-3-Clause
#include "discretisation/mesh_adaptation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "assembly/refined_scene.h"
#include "base/error.h"
#include "base/quantity.h"
#include "interaction/mesh_error.h"

namespace palpate {
namespace {

/// The divided cells have at least this share of the error, and at most that.
constexpr double kLeastShare = 0.2;
constexpr double kLargestShare = 0.6;
/// A divided quadratic cell keeps little of its error.
constexpr double kShareForError = 1.15;

/// Near the largest number of cells fewer are divided, but a mesh that has not so many times the
/// cells of the one before is not worth its solves.
constexpr double kLeastGrowth = 1.1;

/// A touch without a known error on so many meshes, one after the other, is given up; the second,
/// where it was known on a coarser one: finer ones will not help, as at the rim of what is held,
/// where strains are infinite.
constexpr int kMostUnknown = 3;
constexpr int kMostUnknownAgain = 2;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void check(const AdaptationOptions& options) {
  if (!(options.tolerance > 0)) {
    throw InputError("The largest error of the force that the mesh may cause is " +
                     quantity(options.tolerance, "") + " of it. Give a share above 0.");
  }
  if (options.max_cells < 1) {
    throw InputError("A mesh of at most " + std::to_string(options.max_cells) +
                     " cells was asked for. Give at least 1.");
  }
}

double of_cell(const TouchOnMesh& touch, std::size_t cell) {
  const double energy = touch.energy_of_cells[cell];
  return std::isfinite(energy) && energy > 0 ? energy : 0;
}

/// Whether the error of a touch is within the tolerance.
bool is_exact(const AdaptationRound& round, std::size_t touch, const AdaptationOptions& options) {
  // The first mesh has none before it.
  const bool has_changed = round.changes[touch] > options.tolerance;
  return round.is_known[touch] != 0 && !has_changed &&
         largest_error(round, touch, options.is_corrected) <= options.tolerance;
}
/// Whether the mesh is not refined for a touch any further.
bool is_done(const AdaptationRound& round, std::size_t touch, const AdaptationOptions& options) {
  if (round.is_given_up[touch] != 0) return true;
  return round.is_coarse[touch] == 0 && is_exact(round, touch, options);
}

/// Marks the cells that are divided in any case, and those that have most of the error of the
/// touches beyond the tolerance.
/// @param part Of the cells that would be divided if there were no largest number of cells.
std::vector<char> choose_cells(const std::vector<TouchOnMesh>& touches,
                               const AdaptationRound& round, const AdaptationOptions& options,
                               double part) {
  // The share that a cell has of the error of some touch.
  std::vector<double> shares(static_cast<std::size_t>(round.num_cells), 0);
  std::vector<char> is_coarse(shares.size(), 0);
  double wanted = kLeastShare;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    if (is_done(round, i, options)) continue;
    for (const Index c : touches[i].coarse_cells) is_coarse[static_cast<std::size_t>(c)] = 1;
    if (is_exact(round, i, options)) continue;
    double sum = 0;
    for (std::size_t c = 0; c < shares.size(); ++c) sum += of_cell(touches[i], c);
    for (std::size_t c = 0; c < shares.size() && sum > 0; ++c) {
      shares[c] = std::max(shares[c], of_cell(touches[i], c) / sum);
    }
    const double kept = options.tolerance / largest_error(round, i, options.is_corrected);
    const double needed = round.is_known[i] != 0 ? kShareForError * (1 - kept) : kLargestShare;
    wanted = std::clamp(needed, wanted, kLargestShare);
  }
  std::vector<std::size_t> order(shares.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return shares[a] > shares[b]; });
  const double all = std::accumulate(shares.begin(), shares.end(), 0.0);
  const auto num_coarse =
      static_cast<double>(std::count(is_coarse.begin(), is_coarse.end(), char{1}));
  std::vector<char> chosen(shares.size(), 0);
  double sum = 0;
  double coarse = 0;
  for (const std::size_t c : order) {
    const bool has_error = sum < part * wanted * all;
    const bool is_too_large = is_coarse[c] != 0 && coarse < part * num_coarse;
    if (!has_error && !is_too_large) continue;
    chosen[c] = 1;
    sum += shares[c];
    coarse += is_coarse[c];
  }
  return chosen;
}

/// A finer mesh that has no more than the largest number of cells, or nothing.
/// @param chosen Is set to the cells that were chosen for it.
std::optional<Refinement> finer(const TetMesh& mesh, const std::vector<TouchOnMesh>& touches,
                                const AdaptationRound& round, const AdaptationOptions& options,
                                std::vector<char>& chosen) {
  const double least = kLeastGrowth * mesh.num_cells();
  for (double part = 1;; part /= 2) {
    chosen = choose_cells(touches, round, options, part);
    Refinement refinement = refine(mesh, chosen);
    const Index num_cells = refinement.mesh.num_cells();
    if (num_cells <= options.max_cells && (part == 1 || num_cells >= least)) return refinement;
    if (num_cells < least) return std::nullopt;
  }
}

/// @param before The touches on the mesh before; empty: there is none.
AdaptationRound summary(const std::vector<TouchOnMesh>& touches,
                        const std::vector<TouchOnMesh>& before, Index num_cells) {
  AdaptationRound round;
  round.num_cells = num_cells;
  for (std::size_t i = 0; i < touches.size(); ++i) {
    const TouchOnMesh& touch = touches[i];
    const double force = touch.force.size() > 0 ? touch.force.norm() : 0;
    round.forces.push_back(touch.force);
    round.corrected_forces.push_back(touch.force - touch.error);
    round.errors.push_back(force > 0 ? touch.error.norm() / force : kNaN);
    const bool may_compare = force > 0 && !before.empty() && before[i].is_known && touch.is_known;
    round.changes.push_back(
        may_compare
            ? (round.corrected_forces[i] - (before[i].force - before[i].error)).norm() / force
            : kNaN);
    // A tool that feels nothing has found its way between the points of a coarse surface.
    round.is_known.push_back(touch.is_known && force > 0 ? 1 : 0);
    round.is_reliable.push_back(touch.is_reliable ? 1 : 0);
    round.is_coarse.push_back(touch.coarse_cells.empty() ? 0 : 1);
  }
  return round;
}

/// Takes over what was found for a touch on the mesh before.
void keep(const AdaptationRound& before, std::size_t touch, AdaptationRound& now) {
  now.forces[touch] = before.forces[touch];
  now.corrected_forces[touch] = before.corrected_forces[touch];
  now.errors[touch] = before.errors[touch];
  now.changes[touch] = before.changes[touch];
  now.is_known[touch] = before.is_known[touch];
  now.is_reliable[touch] = before.is_reliable[touch];
  now.is_coarse[touch] = before.is_coarse[touch];
}

/// Whether no touch that needs a finer mesh says which cells have an error.
bool says_nothing(const std::vector<TouchOnMesh>& touches, const AdaptationRound& round,
                  const AdaptationOptions& options) {
  for (std::size_t i = 0; i < touches.size(); ++i) {
    if (is_done(round, i, options)) continue;
    if (!touches[i].coarse_cells.empty()) return false;
    for (std::size_t c = 0; c < touches[i].energy_of_cells.size(); ++c) {
      if (of_cell(touches[i], c) > 0) return false;
    }
  }
  return true;
}

/// Gives up the touches whose error was not known on the last meshes.
void give_up(std::vector<AdaptationRound>& rounds) {
  AdaptationRound& last = rounds.back();
  last.is_given_up.assign(last.is_known.size(), 0);
  for (std::size_t i = 0; i < last.is_known.size(); ++i) {
    const auto is_known = [&](const AdaptationRound& round) { return round.is_known[i] != 0; };
    const auto num_unknown =
        std::find_if(rounds.rbegin(), rounds.rend(), is_known) - rounds.rbegin();
    const bool was_known = num_unknown < static_cast<std::ptrdiff_t>(rounds.size());
    if (num_unknown >= (was_known ? kMostUnknownAgain : kMostUnknown)) last.is_given_up[i] = 1;
  }
}

/// Goes back to the finest of the meshes on which most touches are exact, and of these, known.
/// @param start The scene on the first mesh.
void leave_unknown_meshes(const Scene& start, const AdaptationOptions& options,
                          AdaptedMesh& adapted) {
  const auto score = [&](const AdaptationRound& round) {
    std::ptrdiff_t exact = 0;
    for (std::size_t i = 0; i < round.is_known.size(); ++i) exact += is_exact(round, i, options);
    const auto known = std::count(round.is_known.begin(), round.is_known.end(), char{1});
    return std::pair(exact, known);
  };
  auto& rounds = adapted.rounds;
  const auto best = std::max_element(
      rounds.rbegin(), rounds.rend(),
      [&](const AdaptationRound& a, const AdaptationRound& b) { return score(a) < score(b); });
  const auto kept = static_cast<std::size_t>(rounds.rend() - best);
  if (kept == rounds.size()) return;
  const auto first_left = rounds.begin() + static_cast<std::ptrdiff_t>(kept);
  adapted.left.assign(first_left, rounds.end());
  rounds.resize(kept);
  adapted.refinements.resize(kept - 1);
  adapted.chosen.resize(kept - 1);
  adapted.scene = start;
  for (const Refinement& refinement : adapted.refinements) {
    adapted.scene = refined(adapted.scene, refinement);
  }
}

}  // namespace

double largest_error(const AdaptationRound& round, std::size_t touch, bool is_corrected) {
  const bool is_reliable = round.is_reliable[touch] != 0;
  const double of_corrected = is_reliable ? kMostOfCorrected : kMostOfUnreliableCorrected;
  const double of_estimate = is_reliable ? kMostOfEstimate : kMostOfUnreliable;
  return (is_corrected ? of_corrected : of_estimate) * round.errors[touch];
}

AdaptedMesh adapt_mesh(const Scene& scene, const AdaptationOptions& options,
                       const TouchMesh& touch) {
  check(options);
  AdaptedMesh adapted;
  adapted.scene = scene;
  std::vector<TouchOnMesh> before;
  for (;;) {
    MeshHints hints;
    if (!adapted.refinements.empty()) hints.refinement = &adapted.refinements.back();
    std::vector<char>& needed = hints.needed;
    if (!options.touches_again && !before.empty()) {
      for (std::size_t i = 0; i < before.size(); ++i) {
        needed.push_back(is_done(adapted.rounds.back(), i, options) ? 0 : 1);
      }
    }
    std::vector<TouchOnMesh> touches = touch(adapted.scene, hints);
    if (touches.empty()) {
      adapted.end = AdaptationEnd::stopped;
      return adapted;
    }
    const Index num_cells = adapted.scene.body.mesh.num_cells();
    AdaptationRound found = summary(touches, before, num_cells);
    for (std::size_t i = 0; i < needed.size(); ++i) {
      if (needed[i] == 0) keep(adapted.rounds.back(), i, found);
    }
    adapted.rounds.push_back(std::move(found));
    give_up(adapted.rounds);
    const AdaptationRound& round = adapted.rounds.back();
    bool all_done = true;
    for (std::size_t i = 0; i < touches.size(); ++i) {
      all_done = all_done && is_done(round, i, options);
    }
    const bool all_known = std::all_of(round.is_given_up.begin(), round.is_given_up.end(),
                                       [](char is_given_up) { return is_given_up == 0; });
    if (all_done && all_known) return adapted;
    if (all_done || says_nothing(touches, round, options)) {
      adapted.end = AdaptationEnd::not_known;
      leave_unknown_meshes(scene, options, adapted);
      return adapted;
    }
    std::vector<char> chosen;
    std::optional<Refinement> refinement =
        finer(adapted.scene.body.mesh, touches, round, options, chosen);
    if (!refinement) {
      adapted.end = AdaptationEnd::too_many_cells;
      return adapted;
    }
    adapted.scene = refined(adapted.scene, *refinement);
    adapted.refinements.push_back(std::move(*refinement));
    adapted.chosen.push_back(std::move(chosen));
    before = std::move(touches);
  }
}

}  // namespace palpate

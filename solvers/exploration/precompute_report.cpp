// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/precompute_report.h"

#include <algorithm>
#include <type_traits>

#include "exploration/transfer.h"

namespace palpate {

template <class Visit>
void for_each_part(Work& work, Visit&& visit) {
  visit(work.residuals);
  visit(work.assemblies);
  visit(work.analyses);
  visit(work.factorisations);
  visit(work.right_hand_sides);
  visit(work.krylov_iterations);
  visit(work.residual_seconds);
  visit(work.assembly_seconds);
  visit(work.analysis_seconds);
  visit(work.factorisation_seconds);
  visit(work.solve_seconds);
}

namespace {

/// Adds the figure of another rank.
template <class T>
void add(T& all, const T& one) {
  all += one;
}
template <class Key>
void add(std::map<Key, std::int64_t>& all, const std::map<Key, std::int64_t>& one) {
  for (const auto& [key, number] : one) all[key] += number;
}

/// Calls visit(figure, combine) for each figure of a report that is combined over the ranks;
/// combine(all, one) takes in the figure of one more rank.
template <class Visit>
void for_each_figure(PrecomputeReport& report, Visit&& visit) {
  constexpr auto sum = [](auto& all, const auto& one) { add(all, one); };
  constexpr auto largest = [](auto& all, const auto& one) { all = std::max(all, one); };
  visit(report.num_solved, sum);
  visit(report.num_reused, sum);
  visit(report.num_by_outcome, sum);
  visit(report.num_by_flag, sum);
  visit(report.num_expected, sum);
  visit(report.num_transitions, sum);
  visit(report.num_levels, sum);
  visit(report.num_beyond_most_levels, sum);
  visit(report.iterations, sum);
  visit(report.num_states_given, sum);
  visit(report.num_intermediate_states, sum);
  visit(report.num_intermediate_states_failed, sum);
  visit(report.intermediate_seconds, sum);
  visit(report.work, sum);
  visit(report.num_rounds, largest);
  visit(report.complete, largest);
  visit(report.num_unknowns, largest);
  visit(report.num_cells, largest);
  visit(report.exploration_seconds, largest);
  visit(report.finishing_seconds, largest);
}

/// Packs the figures of a report.
Bytes packed(PrecomputeReport report) {
  Packer figures;
  for_each_figure(report, [&](auto& figure, auto /*combine*/) { figures.put(figure); });
  return figures.take();
}

void take_in(PrecomputeReport& report, const Bytes& figures) {
  Unpacker one(figures);
  for_each_figure(report, [&](auto& figure, auto combine) {
    combine(figure, one.take<std::decay_t<decltype(figure)>>());
  });
}

}  // namespace

void combine(PrecomputeReport& report, Communicator& communicator) {
  const Bytes mine = packed(report);
  for_each_figure(report, [](auto& figure, auto /*combine*/) { figure = {}; });
  for (const Bytes& figures : communicator.all_gather(mine)) take_in(report, figures);
  report.schedule = sum(communicator, report.schedule);
  report.num_not_reached = report.num_expected - report.num_solved - report.num_reused;
}

void add_earlier(PrecomputeReport& report, const PrecomputeReport& earlier) {
  PrecomputeReport figures = earlier;
  // Combined over ranks the largest counts, but one exploration comes after the other.
  report.exploration_seconds += earlier.exploration_seconds;
  report.finishing_seconds += earlier.finishing_seconds;
  figures.complete = false;
  take_in(report, packed(figures));
  report.schedule += earlier.schedule;
}

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// An explorer makes the transitions that it is asked for, one after the other. It knows neither the
// strategy nor the record: it is told of the space once, and with each transition of its start. So
// it may be anywhere, and nothing is lost with it but the transition that it makes.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "assembly/scene.h"
#include "exploration/exploration_strategy.h"
#include "fields/reduced_fields.h"
#include "schedule/communicator.h"
#include "state_space/configuration.h"
#include "state_space/tool_space.h"

namespace palpate {

/// What an explorer is to know of a space.
struct ExplorerJob {
  /// The body, and its rest under its loads.
  std::shared_ptr<const Scene> scene;
  SettledBody at_rest;
  ToolSpaceSetup setup;
  /// One of tangent_solver_names(); empty: the one that suits the body.
  std::string linear_solver;
  /// Of each solve, see EquilibriumOptions.
  double tolerance = 0;
  double max_seconds = 0;
  bool single_precision = false;
  bool estimate_mesh_error = false;
};

struct ExplorerTask {
  /// The number by which the result is known again.
  std::int64_t number = 0;
  Transition transition;
  /// The configuration at the start with its fields; nothing: the transition needs none.
  std::optional<Configuration> start;
  /// The part of the fields that the start has.
  Keep kept = Keep::all;
  /// Whether further transitions are likely to start from what is found.
  bool leads_on = true;
};

struct ExplorerResult {
  std::int64_t number = 0;
  /// What was found; its outcome says whether.
  Configuration found;
  /// Why this body or tool cannot be solved for at all; empty: it can.
  std::string refusal;
  /// What went wrong in this transition alone, as memory that is full; empty: nothing.
  std::string failure;
};

class Explorer {
 public:
  /// @param abort_requested Called within a solve; true ends it with Outcome::aborted.
  /// @throws InputError, BackendError the body cannot be solved for.
  explicit Explorer(const ExplorerJob& job, std::function<bool()> abort_requested = {});
  ~Explorer();
  Explorer(const Explorer&) = delete;
  Explorer& operator=(const Explorer&) = delete;

  [[nodiscard]] ExplorerResult make(const ExplorerTask& task);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// As bytes, for an explorer in another process.
[[nodiscard]] Bytes pack(const ExplorerJob& job);
[[nodiscard]] Bytes pack(const ExplorerTask& task);
[[nodiscard]] Bytes pack(const ExplorerResult& result);
/// @throws BackendError the bytes are not such a value.
[[nodiscard]] ExplorerJob unpack_job(const Bytes& bytes);
[[nodiscard]] ExplorerTask unpack_task(const Bytes& bytes);
[[nodiscard]] ExplorerResult unpack_result(const Bytes& bytes);

}  // namespace palpate

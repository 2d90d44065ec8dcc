// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/settle.h"

#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/printable.h"
#include "exploration/transfer.h"
#include "storage/state_space_file.h"

namespace palpate {
namespace {

/// @throws InputError the body has no rest, or the run was aborted.
SettledBody find_rest(const Scene& scene, const EquilibriumSolver& solver,
                      const std::filesystem::path& path) {
  require_rest(solver);
  const Equilibrium& rest = solver.settled();
  if (rest.outcome == Outcome::aborted) {
    throw InputError("The run was aborted before the body had come to rest under its load.");
  }
  if (!path.empty() && std::filesystem::exists(path)) {
    const StateSpaceFile file = StateSpaceFile::open_read_only(path);
    if (const std::optional<BodyId> body = file.find_body(hash(scene))) {
      SettledBody settled = file.read_rest(*body);
      if (settled.p.size() == rest.p.size()) return settled;
      throw InputError(
          quoted(path) +
          " is damaged: the pressures of the body at rest under its load are not "
          "those of its cells. Take a copy that is whole, or give another file name and "
          "compute it again.");
    }
  }
  return {rest.u, rest.p};
}

}  // namespace

SettledBody settle(const Scene& scene, const EquilibriumSolver& solver,
                   const std::filesystem::path& file, Communicator& communicator) {
  if (!scene.has_load()) return {};
  SettledBody rest;
  agree(communicator, [&] {
    if (communicator.rank() == 0) rest = find_rest(scene, solver, file);
  });
  return of_first(rest, communicator);
}

}  // namespace palpate

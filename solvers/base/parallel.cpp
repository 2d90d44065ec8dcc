// SPDX-License-Identifier: BSD-3-Clause
#include "base/parallel.h"

namespace palpate {
namespace {

thread_local Team* current_team = nullptr;

}  // namespace

void run_with(Team* team, Team::DoWork do_work, void* work) {
  struct Scope {
    Team* before;
    ~Scope() { current_team = before; }
  } const scope{current_team};
  current_team = team;
  if (team == nullptr) return do_work(work);
  team->serve(do_work, work);
}

void run_parts(Index num_parts, Team::RunPart run_part, void* loop) {
  if (current_team != nullptr) return current_team->run(num_parts, run_part, loop);
  for (Index part = 0; part < num_parts; ++part) run_part(loop, part);
}

}  // namespace palpate

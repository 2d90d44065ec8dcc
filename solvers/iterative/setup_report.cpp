// SPDX-License-Identifier: BSD-3-Clause
#include "iterative/setup_report.h"

namespace palpate {

std::string to_string(const SetupReport& report) {
  switch (report.status) {
    case SetupStatus::ok: return "ready";
    case SetupStatus::not_finite: return "a value of the tangent is no number";
    case SetupStatus::indefinite_block:
      return "at " + std::to_string(report.num_indefinite_blocks) +
             " nodes the tangent is not positive definite by itself, the first is node " +
             std::to_string(report.node);
    case SetupStatus::indefinite:
      return "the tangent has at least " + std::to_string(report.negative_at_least) +
             " negative eigenvalues";
    case SetupStatus::singular: return "a part of the body can move freely";
  }
  return "unknown";
}

}  // namespace palpate

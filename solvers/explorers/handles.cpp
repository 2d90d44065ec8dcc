// SPDX-License-Identifier: BSD-3-Clause
#include "explorers/handles.h"

#include <cstdlib>

namespace palpate {

void prepare_messages() {
  static const bool done = [] {
    setenv("ZSYS_SIGHANDLER", "false", 1);
    return zsys_init() != nullptr;
  }();
  (void)done;
}

}  // namespace palpate

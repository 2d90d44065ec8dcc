// SPDX-License-Identifier: BSD-3-Clause
// An explorer that serves a hub: it goes there, or waits for it, and makes what it is asked for.
#pragma once

#include <atomic>
#include <filesystem>
#include <string>

namespace palpate {

struct ServeOptions {
  /// The folder with the keys, see keys.h.
  std::filesystem::path keys;
  /// "tcp://host:port" of the hub or, with `listens`, of this explorer.
  std::string endpoint;
  bool listens = false;
  /// Once the hub has said nothing for this time, the explorer ends, s; 0: it waits for it.
  double patience = 0;
  /// The process that has started this one, with which it ends; 0: it ends with none.
  int parent = 0;
};

/// Serves until the hub ends it or `stop` is set.
/// @throws InputError the keys cannot be read, the address is none, or the hub refuses this
///   explorer.
void serve_explorer(const ServeOptions& options, const std::atomic<bool>& stop);

}  // namespace palpate

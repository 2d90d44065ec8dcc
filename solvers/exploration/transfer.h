// SPDX-License-Identifier: BSD-3-Clause
// Configurations as bytes, between ranks of one run.
#pragma once

#include <vector>

#include "schedule/communicator.h"
#include "state_space/configuration.h"

namespace palpate {

/// A configuration of an active node.
struct FoundConfiguration {
  Index active_node = 0;
  Configuration configuration;
};

/// Adds a configuration, with or without fields, to the end.
void append(Bytes& bytes, Index active_node, const Configuration& configuration);

/// The same without fields.
void append(Bytes& bytes, Index active_node, const ConfigurationSummary& summary);

/// All that was appended.
[[nodiscard]] std::vector<FoundConfiguration> read_configurations(const Bytes& bytes);

}  // namespace palpate

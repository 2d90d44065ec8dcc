// SPDX-License-Identifier: BSD-3-Clause
#include "exploration/transfer.h"

#include <array>
#include <cstdint>
#include <cstring>

namespace palpate {
namespace {

std::size_t num_bytes(Eigen::Index doubles) {
  return static_cast<std::size_t>(doubles) * sizeof(double);
}

}  // namespace

void Packer::put(const void* data, std::size_t size) {
  const auto* first = static_cast<const std::byte*>(data);
  bytes_.insert(bytes_.end(), first, first + size);
}

void Packer::put(const ConfigurationSummary& summary) { put(&summary, sizeof summary); }

void Packer::put(const Configuration& configuration) {
  put(static_cast<const ConfigurationSummary&>(configuration));
  for_each_field(configuration, [&](const auto& field) {
    put(std::array<std::int64_t, 2>{field.rows(), field.cols()});
    put(field.data(), num_bytes(field.size()));
  });
}

void Packer::put(const IntermediateState& state) { put(&state, sizeof state); }

void Unpacker::take(void* data, std::size_t size) {
  if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
  at_ += size;
}

ConfigurationSummary Unpacker::take_summary() {
  ConfigurationSummary summary;
  take(static_cast<void*>(&summary), sizeof summary);
  return summary;
}

Configuration Unpacker::take_configuration() {
  Configuration configuration;
  static_cast<ConfigurationSummary&>(configuration) = take_summary();
  for_each_field(configuration, [&](auto& field) {
    const auto shape = take<std::array<std::int64_t, 2>>();
    field.resize(shape[0], shape[1]);
    take(field.data(), num_bytes(field.size()));
  });
  return configuration;
}

IntermediateState Unpacker::take_intermediate_state() {
  IntermediateState state;
  take(static_cast<void*>(&state), sizeof state);
  return state;
}

}  // namespace palpate

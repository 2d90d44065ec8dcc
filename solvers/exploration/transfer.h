// SPDX-License-Identifier: BSD-3-Clause
// What ranks of one run tell each other, as bytes: put in, and taken out in the same order.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

#include "schedule/communicator.h"
#include "state_space/configuration.h"

namespace palpate {

class Packer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(&value, sizeof value);
  }
  /// Without fields.
  void put(const ConfigurationSummary& summary);
  /// With fields, which may be empty.
  void put(const Configuration& configuration);
  void put(const IntermediateState& state);

  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  void put(const void* data, std::size_t size);

  Bytes bytes_;
};

/// Of bytes that outlive it.
class Unpacker {
 public:
  explicit Unpacker(const Bytes& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  template <class T>
  [[nodiscard]] T take() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    take(&value, sizeof value);
    return value;
  }
  [[nodiscard]] ConfigurationSummary take_summary();
  [[nodiscard]] Configuration take_configuration();
  [[nodiscard]] IntermediateState take_intermediate_state();

 private:
  void take(void* data, std::size_t size);

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

}  // namespace palpate

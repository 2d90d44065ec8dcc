// SPDX-License-Identifier: BSD-3-Clause
// What the ranks of a run send each other, as bytes. Values are taken out in the order in which
// they were put in.
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>
#include <vector>

#include "schedule/communicator.h"
#include "state_space/configuration.h"
#include "state_space/test_point.h"

namespace palpate {

class Packer {
 public:
  template <class T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    put(&value, sizeof value);
  }
  template <class A, class B>
  void put(const std::pair<A, B>& both) {
    put(both.first);
    put(both.second);
  }
  /// Puts in a configuration without its fields.
  void put(const ConfigurationSummary& summary);
  /// Puts in a configuration with its fields, which may be empty.
  void put(const Configuration& configuration);
  void put(const IntermediateState& state);
  void put(const TestPoint& point);
  /// Puts in the number of values, then one after the other.
  /// @param list Any container of values that can be put in.
  template <class List>
  void put_list(const List& list) {
    put(list.size());
    for (const auto& value : list) put(value);
  }

  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  void put(const void* data, std::size_t size);
  template <class Matrix>
  void put_matrix(const Matrix& matrix);

  Bytes bytes_;
};

/// Takes values out of bytes that outlive it.
class Unpacker {
 public:
  explicit Unpacker(const Bytes& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  template <class T>
  [[nodiscard]] T take() {
    T value;
    take(value);
    return value;
  }
  /// Takes what Packer::put_list() has put in, into a container that the caller chooses.
  template <class List>
  [[nodiscard]] List take_list() {
    List list;
    for (auto left = take<std::size_t>(); left > 0; --left) {
      list.push_back(take<typename List::value_type>());
    }
    return list;
  }

 private:
  template <class T>
  void take(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    take(&value, sizeof value);
  }
  template <class A, class B>
  void take(std::pair<A, B>& both) {
    take(both.first);
    take(both.second);
  }
  void take(ConfigurationSummary& summary);
  void take(Configuration& configuration);
  void take(IntermediateState& state);
  void take(TestPoint& point);
  void take(void* data, std::size_t size);
  template <class Matrix>
  void take_matrix(Matrix& matrix);

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// Appends the lists of the other ranks, by rank, to that of rank 0, and empties them.
/// @note Collective
template <class T>
void gather(std::vector<T>& list, Communicator& communicator) {
  Packer mine;
  if (communicator.rank() != 0) mine.put_list(std::exchange(list, {}));
  std::vector<Bytes> all = communicator.gather(mine.take());
  agree(communicator, [&] {
    for (Bytes& bytes : all) {
      if (bytes.empty()) continue;
      for (T& value : Unpacker(bytes).take_list<std::vector<T>>()) list.push_back(std::move(value));
      bytes = {};
    }
  });
}

}  // namespace palpate

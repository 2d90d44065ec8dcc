// SPDX-License-Identifier: BSD-3-Clause
// Values as bytes, for messages between ranks. They are taken in the order in which they were put.
//
// What is sent of a struct, the function for_each_part(value, visit) says in the namespace of the
// struct: it calls visit for each member. So no byte is sent that no member has, and both sides
// agree. An enum needs a function is_sound(value) beside it, which tells the numbers that it has.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/types.h"
#include "schedule/communicator.h"

namespace palpate {

/// Whether values of a type are sent as their bytes in memory: numbers, and arrays of them. Neither
/// a bool is one nor an enum, because not all bytes are a value of these.
template <class T>
struct IsPlain : std::bool_constant<std::is_arithmetic_v<T> && !std::is_same_v<T, bool>> {};
template <>
struct IsPlain<std::byte> : std::true_type {};
template <class T, std::size_t size>
struct IsPlain<std::array<T, size>> : IsPlain<T> {};

template <class A, class B, class Visit>
void for_each_part(std::pair<A, B>& both, Visit&& visit) {
  visit(both.first);
  visit(both.second);
}

/// The least number of bytes that a value takes in a message.
template <class T>
struct LeastBytes : std::integral_constant<std::size_t, IsPlain<T>::value ? sizeof(T) : 1> {};
template <class T>
struct LeastBytes<std::vector<T>> : std::integral_constant<std::size_t, sizeof(std::size_t)> {};
template <class Scalar, int rows, int columns>
struct LeastBytes<Eigen::Matrix<Scalar, rows, columns>>
    : std::integral_constant<std::size_t, 2 * sizeof(std::int64_t)> {};

class Packer {
 public:
  template <class T>
  void put(const T& value) {
    if constexpr (IsPlain<T>::value || std::is_enum_v<T>) {
      put(&value, sizeof value);
    } else if constexpr (std::is_same_v<T, bool>) {
      put(static_cast<std::uint8_t>(value ? 1 : 0));
    } else {
      // The same visitor reads and writes the parts.
      for_each_part(const_cast<T&>(value), [this](const auto& part) { put(part); });
    }
  }
  template <class Scalar, int rows, int columns>
  void put(const Eigen::Matrix<Scalar, rows, columns>& matrix) {
    put(std::array<std::int64_t, 2>{matrix.rows(), matrix.cols()});
    put(matrix.data(), static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }
  template <class Key, class T>
  void put(const std::map<Key, T>& map) {
    put_list(map);
  }
  template <class T>
  void put(const std::vector<T>& list) {
    if constexpr (IsPlain<T>::value) {
      put(list.size());
      put(list.data(), list.size() * sizeof(T));
    } else {
      put_list(list);
    }
  }
  /// Packs the number of values, then each value.
  /// @param list Any container of values that can be packed.
  template <class List>
  void put_list(const List& list) {
    put(list.size());
    for (const auto& value : list) put(value);
  }

  [[nodiscard]] Bytes take() { return std::move(bytes_); }

 private:
  void put(const void* data, std::size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), first, first + size);
  }

  Bytes bytes_;
};

/// Takes values out of bytes, which must outlive it. A size is checked against the bytes that are
/// left before memory is allocated for it, so that damaged bytes cost no more memory than a few
/// times their own size.
/// @throws BackendError the bytes do not hold such a value.
class Unpacker {
 public:
  explicit Unpacker(const Bytes& bytes) : bytes_(bytes) {}

  [[nodiscard]] bool at_end() const { return at_ == bytes_.size(); }

  /// @throws BackendError it is not good: what was taken cannot have been sent.
  static void require(bool good) {
    if (good) return;
    throw BackendError("What a rank of the run has sent is damaged. Start the run again.");
  }

  template <class T>
  [[nodiscard]] T take() {
    T value{};
    take(value);
    return value;
  }
  template <class T>
  void take(T& value) {
    if constexpr (IsPlain<T>::value) {
      take(static_cast<void*>(&value), sizeof value);
    } else if constexpr (std::is_enum_v<T>) {
      std::underlying_type_t<T> number{};
      take(static_cast<void*>(&number), sizeof number);
      value = static_cast<T>(number);
      require(is_sound(value));
    } else if constexpr (std::is_same_v<T, bool>) {
      const auto number = take<std::uint8_t>();
      require(number <= 1);
      value = number == 1;
    } else {
      for_each_part(value, [this](auto& part) { take(part); });
    }
  }
  template <class Scalar, int rows, int columns>
  void take(Eigen::Matrix<Scalar, rows, columns>& matrix) {
    const auto shape = take<std::array<std::int64_t, 2>>();
    require((rows < 0 || shape[0] == rows) && (columns < 0 || shape[1] == columns));
    require(shape[0] >= 0 && shape[1] >= 0);
    // A matrix without values may have any number of rows or columns that a matrix can have.
    const auto most = static_cast<std::int64_t>(std::numeric_limits<Index>::max());
    require(shape[0] <= most && shape[1] <= most);
    require_left(static_cast<std::size_t>(shape[0] * shape[1]), sizeof(Scalar));
    matrix.resize(shape[0], shape[1]);
    take(static_cast<void*>(matrix.data()),
         static_cast<std::size_t>(matrix.size()) * sizeof(Scalar));
  }
  template <class Key, class T>
  void take(std::map<Key, T>& map) {
    map.clear();
    const auto count = take<std::size_t>();
    require_left(count, LeastBytes<Key>::value + LeastBytes<T>::value);
    for (std::size_t i = 0; i < count; ++i) {
      auto entry = take<std::pair<Key, T>>();
      // They were put in their order.
      require(map.empty() || map.rbegin()->first < entry.first);
      map.insert(map.end(), std::move(entry));
    }
  }
  template <class T>
  void take(std::vector<T>& list) {
    if constexpr (IsPlain<T>::value) {
      const auto count = take<std::size_t>();
      require_left(count, sizeof(T));
      list.resize(count);
      take(static_cast<void*>(list.data()), list.size() * sizeof(T));
    } else {
      list = take_list<std::vector<T>>();
    }
  }
  /// Takes what Packer::put_list() has packed, into a list that the caller chooses.
  template <class List>
  [[nodiscard]] List take_list() {
    using Value = typename List::value_type;
    List list;
    const auto count = take<std::size_t>();
    require_left(count, LeastBytes<Value>::value);
    for (std::size_t i = 0; i < count; ++i) list.push_back(take<Value>());
    return list;
  }

 private:
  void require_left(std::size_t count, std::size_t size) const {
    require(count <= (bytes_.size() - at_) / size);
  }
  void take(void* data, std::size_t size) {
    require_left(size, 1);
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  const Bytes& bytes_;
  std::size_t at_ = 0;
};

/// The value of rank 0, on every rank.
/// @note Collective
template <class T>
[[nodiscard]] T of_first(const T& value, Communicator& communicator) {
  Packer mine;
  if (communicator.rank() == 0) mine.put(value);
  const std::vector<Bytes> all = communicator.all_gather(mine.take());
  return Unpacker(all.front()).take<T>();
}

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

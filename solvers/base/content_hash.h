// SPDX-License-Identifier: BSD-3-Clause
// A hash of all that a result depends on, by which one that was kept is known to be still right.
//
// Numbers count by their bits, and what is of no fixed length counts with it, so that two lists
// cannot be taken for two others. Everything is added in full: a sum of an array, or what it is at
// some places, is the same for another array.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <Eigen/Core>

namespace palpate {

class ContentHash {
 public:
  ContentHash();
  ~ContentHash();
  ContentHash(const ContentHash&) = delete;
  ContentHash& operator=(const ContentHash&) = delete;

  template <class Number>
  std::enable_if_t<std::is_arithmetic_v<Number> || std::is_enum_v<Number>, ContentHash&> add(
      Number number) {
    return add_bytes(&number, sizeof number);
  }
  /// A text of any length.
  ContentHash& add(std::string_view text);
  /// A list of numbers, or of arrays of numbers.
  template <class Item>
  ContentHash& add(const std::vector<Item>& items) {
    static_assert(!std::is_same_v<Item, bool>);
    add(items.size());
    for (const Item& item : items) add(item);
    return *this;
  }
  template <class Derived>
  ContentHash& add(const Eigen::DenseBase<Derived>& matrix) {
    const auto values = matrix.derived().eval();
    add(values.rows()).add(values.cols());
    return add_bytes(values.data(),
                     static_cast<std::size_t>(values.size()) * sizeof(typename Derived::Scalar));
  }
  template <class Number, std::size_t size>
  ContentHash& add(const std::array<Number, size>& numbers) {
    for (const Number& number : numbers) add(number);
    return *this;
  }

  /// Of all that was added so far: 128 bits (XXH3), hexadecimal.
  [[nodiscard]] std::string text() const;

 private:
  ContentHash& add_bytes(const void* bytes, std::size_t size);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate

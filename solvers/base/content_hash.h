// SPDX-License-Identifier: BSD-3-Clause
// A hash of everything that a result depends on, by which a stored result is known to be valid.
//
// Numbers are hashed by their bits, and a list or a text together with its length, so that two
// lists are not mistaken for two others. Arrays are hashed in full: their sum, or a sample of them,
// could be equal for different arrays.
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

  /// The hash of all that was added so far: 128 bits (XXH3), hexadecimal.
  [[nodiscard]] std::string text() const;

 private:
  ContentHash& add_bytes(const void* bytes, std::size_t size);

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpate

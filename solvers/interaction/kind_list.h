// SPDX-License-Identifier: BSD-3-Clause
// A list of the known kinds of something, such as a shape. Each kind is found by the number under
// which it is stored in files.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"

namespace palpate {

/// @tparam Kind A class with number(), an enumeration.
template <class Kind>
class KindList {
 public:
  using Number = decltype(std::declval<const Kind&>().number());

  /// @param what What the kinds are, for messages: "a shape of a tool".
  /// @param unknown The words before an unknown number, for messages: "A rigid tool has the unknown
  ///   shape".
  /// @param kinds The kinds that are always known.
  template <class... Kinds>
  KindList(std::string what, std::string unknown, Kinds... kinds)
      : what_(std::move(what)), unknown_(std::move(unknown)) {
    (kinds_.push_back(std::move(kinds)), ...);
  }

  /// The kind of a number; null: there is none.
  [[nodiscard]] const Kind* find(Number number) const {
    for (const auto& kind : kinds_) {
      if (kind->number() == number) return kind.get();
    }
    return nullptr;
  }

  /// @throws InputError there is no such kind.
  [[nodiscard]] const Kind& get(Number number) const {
    if (const Kind* kind = find(number)) return *kind;
    throw InputError(unknown_ + ' ' + std::to_string(static_cast<int>(number)) +
                     ". The file was damaged, or made by a later version.");
  }

  /// @throws InputError the number is taken.
  void add(std::unique_ptr<const Kind> kind) {
    if (find(kind->number()) != nullptr) {
      throw InputError("There is " + what_ + " with the number " +
                       std::to_string(static_cast<int>(kind->number())) + " already.");
    }
    kinds_.push_back(std::move(kind));
  }

 private:
  std::string what_;
  std::string unknown_;
  std::vector<std::unique_ptr<const Kind>> kinds_;
};

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
// The owner rank of a state [TDS]: it decides what follows from the state.
//
// [TDS] Romein, Plaat, Bal, Schaeffer, Transposition Table Driven Work Scheduling in Distributed
// Search, AAAI 1999.
#pragma once

#include <cstdint>

namespace palpate {

/// A bijection of the 64-bit numbers in which each bit of the result depends on all of the key:
/// one step of SplitMix64 (Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators,
/// OOPSLA 2014).
[[nodiscard]] constexpr std::uint64_t mix(std::uint64_t key) {
  key += 0x9e3779b97f4a7c15u;
  key = (key ^ (key >> 30)) * 0xbf58476d1ce4e5b9u;
  key = (key ^ (key >> 27)) * 0x94d049bb133111ebu;
  return key ^ (key >> 31);
}

/// The owner rank of a key, the same on all ranks. Any keys are spread evenly, also consecutive
/// ones.
[[nodiscard]] constexpr int owner_of(std::uint64_t key, int num_ranks) {
  return static_cast<int>(mix(key) % static_cast<std::uint64_t>(num_ranks));
}

}  // namespace palpate

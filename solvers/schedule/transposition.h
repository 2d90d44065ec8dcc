// SPDX-License-Identifier: BSD-3-Clause
// Where a state is at home, and the table there that knows it again [TDS].
//
// [TDS] Romein, Plaat, Bal, Schaeffer, Transposition Table Driven Work Scheduling in Distributed
// Search, AAAI 1999.
#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "schedule/network.h"

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

/// The same on all ranks; spreads any keys evenly, also neighbouring ones.
[[nodiscard]] constexpr int home_of(std::uint64_t key, int num_ranks) {
  return static_cast<int>(mix(key) % static_cast<std::uint64_t>(num_ranks));
}

/// Of a key of any length (FNV-1a, mixed).
[[nodiscard]] inline std::uint64_t hash_of(const Bytes& key) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  for (const std::byte b : key) hash = (hash ^ std::to_integer<std::uint64_t>(b)) * 0x100000001b3u;
  return mix(hash);
}

struct HashOfBytes {
  [[nodiscard]] std::size_t operator()(const Bytes& key) const { return hash_of(key); }
};

/// What is known of the states that are at home on this rank, by the whole of their keys: states
/// whose hashes collide stay apart.
template <class Value>
using TranspositionTable = std::unordered_map<Bytes, Value, HashOfBytes>;

}  // namespace palpate

// SPDX-License-Identifier: BSD-3-Clause
#include "base/content_hash.h"

#include <xxhash.h>

#include <cstdio>
#include <new>

namespace palpate {

struct ContentHash::State {
  XXH3_state_t* hash = XXH3_createState();
  State() {
    if (hash == nullptr) throw std::bad_alloc();
    XXH3_128bits_reset(hash);
  }
  ~State() { XXH3_freeState(hash); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
};

ContentHash::ContentHash() : state_(std::make_unique<State>()) {}
ContentHash::~ContentHash() = default;

ContentHash& ContentHash::add(std::string_view text) {
  add(text.size());
  return add_bytes(text.data(), text.size());
}

ContentHash& ContentHash::add_bytes(const void* bytes, std::size_t size) {
  XXH3_128bits_update(state_->hash, bytes, size);
  return *this;
}

std::string ContentHash::text() const {
  const XXH128_hash_t digest = XXH3_128bits_digest(state_->hash);
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(digest.high64),
                static_cast<unsigned long long>(digest.low64));
  return text;
}

}  // namespace palpate

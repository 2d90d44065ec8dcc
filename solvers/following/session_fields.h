// SPDX-License-Identifier: BSD-3-Clause
// The fields of the configurations that a session has found. They are read when they are first
// asked for, and kept, since the same few are needed again and again while the body is shown.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <mutex>

#include "fields/field_source.h"
#include "following/follow_session.h"

namespace palpate {

class SessionFields final : public FieldSource {
 public:
  static constexpr std::size_t default_bytes = std::size_t{256} << 20;

  /// @param session, mutex They must outlive this object. Whoever uses the session on another
  ///   thread holds the mutex.
  /// @param bytes The memory of the fields that are kept: those that were used last.
  SessionFields(const FollowSession& session, std::mutex& mutex, std::size_t bytes = default_bytes)
      : session_(session), mutex_(mutex), most_bytes_(bytes) {}

  /// @note Only one thread at a time.
  void add_up(const ToolSpaceSetup& setup, const std::vector<FieldShare>& shares, Keep needed,
              NodalVector& u, NodalVector& p) override;

 private:
  struct Entry {
    /// Counted from rest.
    Configuration configuration;
    Keep kept = Keep::all;
    std::uint64_t last_use = 0;
  };

  [[nodiscard]] const Entry& get(const ConfigurationSummary& summary);
  void forget_old_ones();

  const FollowSession& session_;
  std::mutex& mutex_;
  std::size_t most_bytes_;
  std::size_t bytes_ = 0;
  std::uint64_t uses_ = 0;
  std::map<CheckPoint, Entry> entries_;
};

}  // namespace palpate

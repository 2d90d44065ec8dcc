// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "haptic/transport/transport.h"

namespace palpate::test {

/// A device that has a guardian, and whose writes can fail.
class GuardedTransport final : public Transport {
 public:
  GuardedTransport(Transport& board, GuardianChannel* channel) : board_(board), channel_(channel) {}
  TransportStatus read(Report& report, Duration timeout) noexcept override {
    return board_.read(report, timeout);
  }
  TransportStatus write(const Report& report) noexcept override {
    return fails ? TransportStatus::error : board_.write(report);
  }
  GuardianChannel* guardian() noexcept override { return channel_; }
  std::string problem() const override { return board_.problem(); }

  bool fails = false;

 private:
  Transport& board_;
  GuardianChannel* channel_;
};

}  // namespace palpate::test

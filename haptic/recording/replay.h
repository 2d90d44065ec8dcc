// SPDX-License-Identifier: BSD-3-Clause
// A recording in place of a device: the loop reads the same reports again at the same times, so
// that it computes the same.
//
//   RecordingReader reader(path);
//   ReplayTransport device(clock);
//   for (TickRecord record; reader.next(record);) {
//     device.play(record);
//     loop.tick();
//     loop.wait();
//   }
//
// Forces are equal to the bit where the recording begins with the loop and has every tick, and
// where no tick read more than TickRecord::kReports reports. Reports were read some microseconds
// after their tick began, but are replayed at its beginning. So a report that was just too old may
// be just fresh in the replay, and a device that reports rates is elsewhere by that much. A body
// that was replaced meanwhile is not in the recording; the recording has the hash of the scene of
// the first one.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "haptic/recording/setup.h"
#include "haptic/servo/record.h"
#include "haptic/transport/transport.h"

namespace palpate {

/// Reads a recording from its beginning, a tick at a time.
class RecordingReader {
 public:
  /// @throws InputError the file is missing or is no recording, or as next() does.
  explicit RecordingReader(const std::filesystem::path& path);
  ~RecordingReader();
  RecordingReader(const RecordingReader&) = delete;
  RecordingReader& operator=(const RecordingReader&) = delete;

  [[nodiscard]] const RecordedSetup& setup() const;

  /// Reads the next tick.
  /// @return false: there is no further tick.
  /// @throws InputError a row is damaged, or its settings are out of range; the message says which
  ///   row.
  [[nodiscard]] bool next(TickRecord& record);

  /// What is missing in the part that was read, in words: ticks, or the end of the last row; empty:
  /// nothing.
  [[nodiscard]] std::string notice() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

class ReplayTransport final : public Transport {
 public:
  explicit ReplayTransport(std::shared_ptr<VirtualClock> clock) : clock_(std::move(clock)) {}

  /// Sets the clock to the time of a tick, and gives its reports to the calls of read() that
  /// follow.
  void play(const TickRecord& record) noexcept;

  [[nodiscard]] TransportStatus read(Report& report, Duration timeout) noexcept override;
  [[nodiscard]] TransportStatus write(const Report& report) noexcept override;
  [[nodiscard]] GuardianChannel* guardian() noexcept override { return &guardian_; }
  [[nodiscard]] std::string problem() const override;

  /// The last report that was written.
  [[nodiscard]] const Report& written() const { return written_; }

 private:
  std::shared_ptr<VirtualClock> clock_;
  std::array<Report, TickRecord::kReports> reports_{};
  std::size_t next_ = 0;
  bool gone_ = false;
  bool write_fails_ = false;
  /// This guardian trips as the real one did in the recording.
  GuardianChannel guardian_;
  Report written_;
};

}  // namespace palpate

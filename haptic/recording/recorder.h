// SPDX-License-Identifier: BSD-3-Clause
// Writes every tick of a servo loop into a file, on a thread of its own.
//
// The file is a table of comma-separated values: a header row with names and units, then a row for
// each tick, of about 700 bytes; columns.h says which. ParaView opens it as a table: numbers are
// numbers, and a report is the letter x and its bytes in hexadecimal.
//
// The settings that a replay also needs are in the last column, `settings`, as "name=value;" with
// numbers as in the other columns: all of them in the first row, and later those of the tick in
// each row where one has changed. So there is a single file, which is complete from the first row
// on and has no line that a reader of tables would fail at.
//
// Every 20 ms the rows are handed to the system. A process that is killed loses no more than that,
// and at most the last row is cut short. A loss of power may take the rows that the system has not
// yet written, which is some seconds.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "haptic/recording/setup.h"
#include "haptic/servo/record.h"

namespace palpate {

class Recorder {
 public:
  /// Makes the file.
  /// @throws InputError there is such a file (a recording cannot be made again), or it cannot be
  ///   made.
  explicit Recorder(const std::filesystem::path& path);
  /// Closes the file, and says nothing when that fails: call close() to know. A recorder that was
  /// never started leaves no file.
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Begins to write what is in the ring. Call this once.
  void start(const RecordedSetup& setup);

  /// The ring for the servo loop. It has room for eight seconds at 1 kHz.
  [[nodiscard]] std::shared_ptr<TickRing> ring() const;

  /// Writes what is in the ring and closes the file; then it is on the disk.
  /// @throws BackendError not all could be written, for example because the disk is full. The
  ///   message says how much is in the file; that is whole rows.
  void close();

  /// The number of ticks that are in the file.
  [[nodiscard]] std::uint64_t written() const;
  /// The number of ticks that are not in the file, because the ring was full or the file cannot be
  /// written any more.
  [[nodiscard]] std::uint64_t dropped() const;
  /// Why the file cannot be written any more; empty: it can.
  [[nodiscard]] std::string problem() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate

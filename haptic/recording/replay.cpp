// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/recording/replay.h"

#include <csv.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/printable.h"
#include "base/read_file.h"
#include "haptic/recording/columns.h"
#include "haptic/recording/text.h"
#include "haptic/servo/interlock.h"

namespace palpate {
namespace {

/// Splits a line into its cells.
class Cells {
 public:
  Cells() {
    if (csv_init(&parser_, CSV_STRICT) != 0) throw BackendError("libcsv cannot be started.");
  }
  ~Cells() { csv_free(&parser_); }
  Cells(const Cells&) = delete;
  Cells& operator=(const Cells&) = delete;

  /// @param line The line, with its end.
  /// @return What is wrong, in words; empty: nothing.
  [[nodiscard]] std::string split(const std::string& line) {
    cells_.clear();
    const auto add = [](void* cell, std::size_t size, void* cells) {
      static_cast<std::vector<std::string>*>(cells)->emplace_back(static_cast<char*>(cell), size);
    };
    if (csv_parse(&parser_, line.data(), line.size(), add, nullptr, &cells_) != line.size()) {
      return csv_strerror(csv_error(&parser_));
    }
    return {};
  }
  [[nodiscard]] const std::vector<std::string>& cells() const { return cells_; }

 private:
  csv_parser parser_{};
  std::vector<std::string> cells_;
};

std::vector<std::string> column_names(int version) {
  std::vector<std::string> names;
  const TickRecord any;
  recording::visit_columns(any, [&](const recording::Name& name, const auto&) {
    if (name.version <= version) names.push_back(name.text());
  });
  names.emplace_back(recording::kSettings);
  return names;
}

}  // namespace

struct RecordingReader::Impl {
  explicit Impl(const std::filesystem::path& path)
      : name(quoted(path)), stream(open_to_read(path)), names(column_names(version)) {
    const bool has_header = read_cells();
    while (has_header && version > 1 && cells.cells() != names) names = column_names(--version);
    if (!has_header || cells.cells() != names) {
      throw InputError(name +
                       " is no recording, or of another version: its first row does not name"
                       " the columns " +
                       names.front() + ", " + names[1] + ", …, " + names.back() +
                       ". Give a file that was written with --record.");
    }
    if (!read_record(first.emplace())) {
      throw InputError("The recording " + name + " holds no tick.");
    }
  }

  /// @return Whether there was another whole line.
  bool read_cells() {
    if (!std::getline(stream, line) || stream.eof()) {
      cut_short = cut_short || !line.empty();
      return false;
    }
    ++row;
    const std::string wrong = cells.split(line + '\n');
    if (!wrong.empty()) throw error(wrong);
    return true;
  }

  bool read_record(TickRecord& record) {
    if (!read_cells()) return false;
    const std::vector<std::string>& texts = cells.cells();
    if (texts.size() != names.size()) {
      throw error("it has " + std::to_string(texts.size()) + " values where there are " +
                  std::to_string(names.size()) + " columns");
    }
    std::size_t column = 0;
    recording::visit_columns(record, [&](const recording::Name& what, auto& value) {
      if (what.version > version) return;
      if (!recording::parse(texts[column], value)) {
        throw error('"' + printable(texts[column]) + "\" is no value of the column " +
                    names[column]);
      }
      ++column;
    });
    // The first row must have settings.
    if (row == 2 || !texts.back().empty()) take_settings(texts.back());
    record.settings = settings.settings;
    record.touch = settings.touch;
    if (row == 2 ? record.tick.number != 1 : record.tick.number != last_number + 1) {
      num_missing += record.tick.number - 1 - last_number;
    }
    last_number = record.tick.number;
    return true;
  }

  /// @param text The settings as "name=value;".
  void take_settings(const std::string& text) {
    const auto take = [&](const recording::Name& what, auto& value) {
      const std::string key = what.text() + '=';
      // A name is at the beginning of the text, or follows the end of another setting.
      std::size_t begin = text.rfind(key, 0);
      if (begin == text.npos) {
        begin = text.find(';' + key);
        if (begin == text.npos && what.version > 1) return;
        if (begin == text.npos) {
          throw error("its settings lack " + what.text() +
                      (row == 2 ? ", and the first row of ticks has to have all of them; the "
                                  "beginning of the recording may be missing"
                                : ""));
        }
        ++begin;
      }
      begin += key.size();
      const std::size_t end = std::min(text.find(';', begin), text.size());
      if (!recording::parse(std::string_view(text).substr(begin, end - begin), value)) {
        throw error('"' + printable(std::string_view(text).substr(begin, end - begin)) +
                    "\" is no value of the setting " + what.text());
      }
    };
    if (row == 2) recording::visit_setup(setup, take);
    recording::visit_settings(settings, take);
    try {
      validate(setup.options);
      validate(settings.settings);
      validate(settings.touch);
    } catch (const InputError& wrong) {
      throw error(wrong.what());
    }
  }

  [[nodiscard]] InputError error(const std::string& what) const {
    return InputError("Row " + std::to_string(row) + " of the recording " + name +
                      " cannot be used: " + what + (what.back() == '.' ? "" : "."));
  }

  std::string name;
  std::ifstream stream;
  /// The version of the recording.
  int version = recording::kVersion;
  std::vector<std::string> names;
  Cells cells;
  std::string line;
  /// The number of the last row that was read; the header is 1.
  std::uint64_t row = 0;
  RecordedSetup setup;
  TickRecord settings;
  std::optional<TickRecord> first;
  std::uint64_t last_number = 0;
  std::uint64_t num_missing = 0;
  bool cut_short = false;
};

RecordingReader::RecordingReader(const std::filesystem::path& path)
    : impl_(std::make_unique<Impl>(path)) {}

RecordingReader::~RecordingReader() = default;

const RecordedSetup& RecordingReader::setup() const { return impl_->setup; }

bool RecordingReader::next(TickRecord& record) {
  if (impl_->first) {
    record = *std::exchange(impl_->first, std::nullopt);
    return true;
  }
  return impl_->read_record(record);
}

std::string RecordingReader::notice() const {
  std::string text;
  if (impl_->num_missing > 0) {
    text = std::to_string(impl_->num_missing) +
           " ticks are missing in the recording: forces may differ after them.";
  }
  if (impl_->cut_short) {
    text += std::string(text.empty() ? "" : " ") +
            "The last row of the recording is cut short, and was left out.";
  }
  return text;
}

void ReplayTransport::play(const TickRecord& record) noexcept {
  clock_->sleep_until(record.tick.time);
  reports_ = record.received;
  next_ = 0;
  gone_ = record.tick.state == ServoState::gone;
  write_fails_ = record.write_failed;
  guardian_.look(record.tick.time);
  if ((record.tick.tripped & trips::guardian) != 0) guardian_.trip();
}

TransportStatus ReplayTransport::read(Report& report, Duration) noexcept {
  while (next_ < reports_.size()) {
    if (reports_[next_++].size == 0) continue;
    report = reports_[next_ - 1];
    return TransportStatus::data;
  }
  return gone_ ? TransportStatus::gone : TransportStatus::nothing;
}

TransportStatus ReplayTransport::write(const Report& report) noexcept {
  written_ = report;
  return write_fails_ ? TransportStatus::error : TransportStatus::data;
}

std::string ReplayTransport::problem() const {
  return gone_ ? "The device was unplugged in the recording." : "";
}

}  // namespace palpate

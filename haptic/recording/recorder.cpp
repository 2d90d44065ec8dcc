// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/recording/recorder.h"

#include <csv.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <thread>

#include "base/error.h"
#include "base/printable.h"
#include "haptic/recording/columns.h"
#include "haptic/recording/text.h"

namespace palpate {
namespace {

constexpr std::size_t kRoom = 8192;
constexpr auto kInterval = std::chrono::milliseconds(20);

/// Puts values together as "name=value;".
class SettingsText {
 public:
  template <class Value>
  void operator()(const recording::Name& name, const Value& value) {
    text_.append(name.text()).push_back('=');
    recording::append(text_, value);
    text_.push_back(';');
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  std::string text_;
};

std::string settings_text(const TickRecord& record) {
  SettingsText settings;
  recording::visit_settings(record, settings);
  return settings.text();
}

std::string setup_text(const RecordedSetup& setup) {
  SettingsText text;
  recording::visit_setup(setup, text);
  return text.text();
}

std::string header() {
  std::string row;
  const TickRecord any;
  recording::visit_columns(any, [&](const recording::Name& name, const auto&) {
    row.append(name.text()).push_back(',');
  });
  return row.append(recording::kSettings).append("\n");
}

void append_quoted(std::string& row, const std::string& text) {
  const std::size_t begin = row.size();
  // The text doubles where each character is a quotation mark.
  row.resize(begin + 2 * text.size() + 2);
  row.resize(begin + csv_write(&row[begin], row.size() - begin, text.data(), text.size()));
}

/// Why no file of that name can be made, in words.
std::string refusal(const std::filesystem::path& path, int error) {
  const std::string name = quoted(path);
  std::error_code ignored;
  const std::filesystem::file_status there = std::filesystem::status(path, ignored);
  if (is_directory(there)) {
    return name + " is a folder. Give the name of a new file in it for the recording.";
  }
  if (is_other(there)) {
    return name + " is a device or the like. Give the name of a new file for the recording.";
  }
  if (error == EEXIST) {
    return "There is a file " + name + " already. Choose another name for the recording.";
  }
  return "The recording " + name + " cannot be made: " + std::strerror(error) +
         ". Choose another place.";
}

}  // namespace

struct Recorder::Impl {
  explicit Impl(std::filesystem::path where)
      : path(std::move(where)), ring(std::make_shared<TickRing>(kRoom)) {
    file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (file < 0) throw InputError(refusal(path, errno));
  }

  ~Impl() {
    finish();
    ::close(file);
    if (!started) ::unlink(path.c_str());
  }

  void start(const RecordedSetup& setup) {
    started = true;
    setup_of_first_row = setup_text(setup);
    rows = header();
    thread = std::thread([this] { run(); });
  }

  void run() {
    std::unique_lock<std::mutex> lock(mutex);
    for (bool last = false; !last;) {
      stop_asked.wait_for(lock, kInterval, [this] { return stop; });
      last = stop;
      lock.unlock();
      drain();
      lock.lock();
    }
  }

  /// Writes what is in the ring to the file.
  void drain() {
    std::uint64_t num_ticks = 0;
    while (ring->pop(record)) {
      ++num_ticks;
      if (failed) continue;
      add_row();
      if (rows.size() >= kBlock) {
        write_rows(num_ticks);
        num_ticks = 0;
      }
    }
    write_rows(num_ticks);
  }

  void add_row() {
    recording::visit_columns(record, [this](const recording::Name&, const auto& value) {
      recording::append(rows, value);
      rows.push_back(',');
    });
    std::string settings = settings_text(record);
    if (settings != last_settings) {
      append_quoted(rows, setup_of_first_row + settings);
      setup_of_first_row.clear();
      last_settings = std::move(settings);
    }
    rows.push_back('\n');
  }

  void write_rows(std::uint64_t num_ticks) {
    std::size_t done = 0;
    while (!failed && done < rows.size()) {
      const ssize_t count = ::write(file, rows.data() + done, rows.size() - done);
      if (count >= 0) {
        done += static_cast<std::size_t>(count);
      } else if (errno != EINTR) {
        fail(std::strerror(errno));
      }
    }
    // The part that was written may end in the middle of a row.
    const std::size_t whole = done > 0 ? rows.rfind('\n', done - 1) + 1 : 0;
    if (whole < done) (void)!::ftruncate(file, static_cast<off_t>(size + whole));
    auto num_rows = static_cast<std::uint64_t>(
        std::count(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(whole), '\n'));
    // The header does not count as a tick.
    if (size == 0 && num_rows > 0) --num_rows;
    size += whole;
    written += num_rows;
    unwritten += num_ticks - num_rows;
    rows.clear();
  }

  void fail(const char* why) {
    failed = true;
    const std::lock_guard<std::mutex> lock(mutex);
    problem = "The recording " + path.string() + " cannot be written any more: " + why;
  }

  /// Writes what is left in the ring, and ends the thread.
  void finish() {
    if (!thread.joinable()) return;
    {
      const std::lock_guard<std::mutex> lock(mutex);
      stop = true;
    }
    stop_asked.notify_one();
    thread.join();
    if (!failed && ::fsync(file) != 0) fail(std::strerror(errno));
  }

  static constexpr std::size_t kBlock = 1 << 20;

  std::filesystem::path path;
  int file = -1;
  bool started = false;
  std::shared_ptr<TickRing> ring;
  std::thread thread;
  std::atomic<std::uint64_t> written{0};
  std::atomic<std::uint64_t> unwritten{0};

  std::mutex mutex;
  std::condition_variable stop_asked;
  bool stop = false;
  std::string problem;

  // The thread alone uses these.
  bool failed = false;
  TickRecord record;
  std::string rows;
  /// The number of bytes in the file.
  std::size_t size = 0;
  std::string setup_of_first_row;
  std::string last_settings;
};

Recorder::Recorder(const std::filesystem::path& path) : impl_(std::make_unique<Impl>(path)) {}

Recorder::~Recorder() = default;

void Recorder::start(const RecordedSetup& setup) { impl_->start(setup); }

std::shared_ptr<TickRing> Recorder::ring() const { return impl_->ring; }

void Recorder::close() {
  impl_->finish();
  if (impl_->problem.empty()) return;
  throw BackendError(impl_->problem + ". It holds the first " + std::to_string(written()) +
                     " ticks; " + std::to_string(dropped()) +
                     " are not in it. Make room, or choose another place.");
}

std::uint64_t Recorder::written() const { return impl_->written; }

std::uint64_t Recorder::dropped() const { return impl_->unwritten + impl_->ring->dropped(); }

std::string Recorder::problem() const {
  const std::lock_guard<std::mutex> lock(impl_->mutex);
  return impl_->problem;
}

}  // namespace palpate

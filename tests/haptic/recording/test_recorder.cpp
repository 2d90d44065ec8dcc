// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/recording/recorder.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <random>
#include <thread>

#include "base/error.h"
#include "haptic/recording/columns.h"
#include "haptic/recording/folder.h"

namespace palpate::test::test_recorder {
namespace {

using test::text_of;
using test::ticks_of;

class Recording : public test::RecordingTest {};

/// Values of all sizes, the ends of the ranges and what is not finite among them.
class AnyValue {
 public:
  template <class Value>
  void operator()(const recording::Name&, Value& value) {
    if constexpr (std::is_same_v<Value, double>) {
      constexpr double kSpecial[] = {0,        -0.0,      5e-324, 1.7976931348623157e308,
                                     HUGE_VAL, -HUGE_VAL, 0.1,    1.0 / 3};
      const std::uint64_t bits = random_();
      std::memcpy(&value, &bits, sizeof value);
      if (std::isnan(value) || bits % 4 == 0) value = kSpecial[random_() % 8];
    } else if constexpr (std::is_same_v<Value, Report>) {
      value.size = random_() % (Report::kCapacity + 1);
      for (std::size_t i = 0; i < value.size; ++i) {
        value.data[i] = static_cast<std::uint8_t>(random_());
      }
    } else if constexpr (std::is_same_v<Value, Duration>) {
      value = Duration(static_cast<std::int64_t>(random_() % 2'000'000'000'000'000'000U) -
                       1'000'000'000'000'000'000);
    } else if constexpr (std::is_same_v<Value, bool>) {
      value = random_() % 2 == 0;
    } else if constexpr (std::is_enum_v<Value>) {
      value = static_cast<Value>(random_() % 3);
    } else if constexpr (std::is_integral_v<Value>) {
      value = static_cast<Value>(random_());
    } else {
      value = "a board, of \"ours\";\nprofile=none";
    }
  }

 private:
  std::mt19937_64 random_{7};
};

/// A reader refuses settings that are out of range.
class InRange {
 public:
  template <class Value>
  void operator()(const recording::Name&, Value& value) const {
    if constexpr (std::is_same_v<Value, double>) {
      value = std::isfinite(value) && value != 0 ? std::abs(value) : 1;
    } else if constexpr (std::is_same_v<Value, Duration>) {
      value = std::max(std::chrono::abs(value), Duration(1));
    } else if constexpr (std::is_same_v<Value, int>) {
      value = value & 31;
    }
  }
};

/// Of both, value by value; a double by its bits.
template <class Visit, class Thing>
void expect_equal(Visit&& visit, const Thing& a, const Thing& b) {
  std::vector<std::string> values[2];
  for (int i = 0; i < 2; ++i) {
    visit(i == 0 ? a : b, [&](const recording::Name& name, const auto& value) {
      using Value = std::decay_t<decltype(value)>;
      std::string& text = values[i].emplace_back(name.text() + " ");
      if constexpr (std::is_same_v<Value, Report>) {
        text.append(reinterpret_cast<const char*>(value.data.data()), value.size);
      } else if constexpr (std::is_same_v<Value, std::string>) {
        text += value;
      } else {
        text.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    });
  }
  EXPECT_EQ(values[0], values[1]);
}

TEST_F(Recording, EveryValueComesBack) {
  AnyValue any;
  RecordedSetup setup;
  recording::visit_setup(setup, any);
  recording::visit_setup(setup, InRange());
  std::vector<TickRecord> records(200);
  for (std::size_t i = 0; i < records.size(); ++i) {
    recording::visit_columns(records[i], any);
    records[i].tick.number = i + 1;
    if (i % 10 == 0) {
      recording::visit_settings(records[i], any);
      recording::visit_settings(records[i], InRange());
      records[i].settings.workspace_rotation =
          Eigen::AngleAxisd(static_cast<double>(i), Vec3(1, 2, 3).normalized()).toRotationMatrix();
    } else {
      records[i].settings = records[i - 1].settings;
      records[i].touch = records[i - 1].touch;
    }
  }
  Recorder recorder(file("a.csv"));
  recorder.start(setup);
  for (const TickRecord& record : records) recorder.ring()->push(record);
  recorder.close();
  EXPECT_EQ(recorder.written(), 200U);
  EXPECT_EQ(recorder.dropped(), 0U);

  RecordingReader reader(file("a.csv"));
  RecordedSetup expected = setup;
  // In one piece, on one line.
  expected.device = expected.scene_hash = "a board, of  ours   profile=none";
  expect_equal([](const auto& s, auto&& v) { recording::visit_setup(s, v); }, reader.setup(),
               expected);
  TickRecord record;
  for (const TickRecord& written : records) {
    ASSERT_TRUE(reader.next(record));
    expect_equal([](const auto& r, auto&& v) { recording::visit_columns(r, v); }, record, written);
    expect_equal([](const auto& r, auto&& v) { recording::visit_settings(r, v); }, record, written);
  }
  EXPECT_FALSE(reader.next(record));
  EXPECT_EQ(reader.notice(), "");
}

TEST_F(Recording, ANumberThatIsNoneIsToldAndComesBackAsOne) {
  TickRecord record;
  record.tick.number = 1;
  record.tick.contact.distance = -std::nan("");
  Recorder recorder(file("a.csv"));
  recorder.start({});
  recorder.ring()->push(record);
  recorder.close();
  EXPECT_TRUE(std::isnan(ticks_of(file("a.csv")).at(0).tick.contact.distance));
  // ParaView takes that for a number, "-nan" for a word.
  EXPECT_EQ(text_of(file("a.csv")).find("-nan"), std::string::npos);
}

TEST_F(Recording, IsNotWrittenOverAnother) {
  test::write_text(file("a.csv"), "precious");
  try {
    const Recorder recorder(file("a.csv"));
    FAIL() << "nothing was thrown";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(file("a.csv")), std::string::npos) << error.what();
  }
  EXPECT_EQ(text_of(file("a.csv")), "precious");
}

TEST_F(Recording, IsAFileAndNothingElse) {
  const std::pair<std::filesystem::path, const char*> others[] = {{file(""), "is a folder"},
                                                                  {"/dev/full", "is a device"}};
  for (const auto& [path, what] : others) {
    try {
      const Recorder recorder(path);
      ADD_FAILURE() << path << " was taken";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  }
}

TEST_F(Recording, ThatWasNeverStartedLeavesNoFile) {
  {
    const Recorder recorder(file("a.csv"));
    EXPECT_TRUE(std::filesystem::exists(file("a.csv")));
  }
  EXPECT_FALSE(std::filesystem::exists(file("a.csv")));
}

TEST_F(Recording, NeedsAFolder) { EXPECT_THROW(Recorder(file("none") / "a.csv"), InputError); }

TickRecord numbered(std::uint64_t number) {
  TickRecord record;
  record.tick.number = number;
  record.tick.force.setConstant(1.0 / static_cast<double>(number));
  return record;
}

TEST_F(Recording, WhatFindsNoPlaceInTheRingIsCounted) {
  Recorder recorder(file("a.csv"));
  recorder.start({});
  std::uint64_t pushed = 0;
  while (recorder.dropped() == 0 && pushed < 10'000'000) recorder.ring()->push(numbered(++pushed));
  ASSERT_GT(recorder.dropped(), 0U);
  // With one more that is kept, so that the gap is seen.
  while (recorder.written() + recorder.dropped() < pushed) std::this_thread::yield();
  const std::uint64_t dropped = recorder.dropped();
  recorder.ring()->push(numbered(++pushed));
  recorder.close();
  EXPECT_EQ(recorder.dropped(), dropped);
  EXPECT_EQ(recorder.written() + dropped, pushed);
  std::string notice;
  EXPECT_EQ(ticks_of(file("a.csv"), &notice).size(), recorder.written());
  EXPECT_EQ(notice.rfind(std::to_string(dropped) + " ticks are missing", 0), 0U) << notice;
}

TEST_F(Recording, AFullDiskIsToldAndWhatWasWrittenStays) {
  // A limit on the size of files stands in for the disk.
  const auto before = std::signal(SIGXFSZ, SIG_IGN);
  rlimit limit{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &limit), 0);
  const rlimit small{1'000'000, limit.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  Recorder recorder(file("a.csv"));
  recorder.start({});
  // In any number of blocks: also if the first is larger than the disk.
  std::uint64_t pushed = 0;
  while (recorder.problem().empty() && pushed < 100'000) {
    for (int i = 0; i < 100; ++i) recorder.ring()->push(numbered(++pushed));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::string told;
  try {
    recorder.close();
  } catch (const BackendError& error) {
    told = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, before);

  EXPECT_NE(told.find(file("a.csv")), std::string::npos) << told;
  EXPECT_NE(told.find(std::to_string(recorder.written()) + " ticks"), std::string::npos) << told;
  EXPECT_GT(recorder.written(), 100U);
  EXPECT_EQ(recorder.written() + recorder.dropped(), pushed);
  const std::vector<TickRecord> ticks = ticks_of(file("a.csv"));
  ASSERT_EQ(ticks.size(), recorder.written());
  // No row that there was room for is missing.
  const std::string text = text_of(file("a.csv"));
  EXPECT_LT(1'000'000 - text.size(), text.size() - text.rfind('\n', text.size() - 2) + 100);
  EXPECT_EQ(ticks.back().tick.force.x(), 1.0 / static_cast<double>(ticks.size()));
}

TEST_F(Recording, OutlivesTheDeathOfTheProcess) {
  constexpr std::uint64_t kTicks = 500;
  const pid_t child = fork();
  if (child == 0) {
    Recorder recorder(file("a.csv"));
    recorder.start({});
    for (std::uint64_t i = 1; i <= kTicks; ++i) recorder.ring()->push(numbered(i));
    while (recorder.written() < kTicks) std::this_thread::yield();
    raise(SIGKILL);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFSIGNALED(status));
  EXPECT_EQ(ticks_of(file("a.csv")).size(), kTicks);
}

}  // namespace
}  // namespace palpate::test::test_recorder

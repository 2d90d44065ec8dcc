// SPDX-License-Identifier: BSD-3-Clause
#include "haptic/recording/replay.h"

#include <sys/stat.h>

#include <algorithm>
#include <sstream>

#include "base/error.h"
#include "haptic/recording/folder.h"
#include "haptic/servo/loop.h"
#include "haptic/support/analytic_body.h"
#include "haptic/support/guarded_transport.h"
#include "haptic/touching/body_touch.h"
#include "haptic/transport/simulated_board.h"

namespace palpate::test::test_replay {
namespace {

using namespace std::chrono_literals;
using test::text_of;
using test::ticks_of;
using test::write_text;

class Replay : public test::RecordingTest {
 protected:
  /// A hand that comes down on the box, slides and leaves; the loop wakes up late as on a busy
  /// machine, reports and forces take their time, the board is silent for a while, and the guardian
  /// trips.
  Counters record(const std::string& name, int num_ticks) const {
    const auto clock = std::make_shared<VirtualClock>();
    clock->advance(12345678901234567ns);
    const auto hand = std::make_shared<ScriptedMotion>(
        std::vector<ScriptedMotion::Waypoint>{{0ms, {0, 0, 0.02}},
                                              {400ms, {0, 0, -0.006}},
                                              {700ms, {0.004, 0.003, -0.004}},
                                              {1100ms, {0, 0, 0.02}}});
    BoardOptions options;
    options.report_delay = 700us;
    options.force_delay = 300us;
    options.clock_drift = 1e-4;
    options.faults.silent = {500ms, 520ms};
    SimulatedBoard board(clock, hand, options);
    GuardianChannel guardian;
    test::GuardedTransport device(board, &guardian);

    RecordedSetup setup;
    setup.feature = board.feature();
    setup.scene_hash = body_->scene_hash();
    Recorder recorder(file(name));
    recorder.start(setup);
    const auto profile = make_profile(setup.profile, setup.feature);
    LoopInbox inbox;
    LoopOutbox outbox;
    inbox.touch.offer(make_touch(body_));
    inbox.recording.offer(recorder.ring());
    LoopInbox::Settings settings;
    settings.servo.workspace_centre = {0.045, 0.037, test::kBox[2]};
    settings.servo.damping = 2;
    inbox.settings.write(settings);
    {
      Loop loop(device, *profile, *clock, setup.options, inbox, outbox);
      std::mt19937 random(3);
      for (int i = 0; i < num_ticks; ++i) {
        if (i == num_ticks / 2) {
          settings.servo.force_scale = 1.5;
          settings.touch.bonded = true;
          inbox.settings.write(settings);
        }
        guardian.look(clock->now());
        if (i == kTrip) guardian.trip();
        loop.tick();
        loop.wait();
        const bool late = random() % 50 == 0;
        clock->advance(Duration(random() % (late ? 2'500'000 : 100'000)));
      }
    }
    recorder.close();
    EXPECT_EQ(recorder.dropped(), 0U);
    return outbox.newest.read().counters;
  }

  /// The ticks of a recording again, recorded.
  /// @return What was counted.
  Counters replay(const std::string& from, const std::string& to) const {
    RecordingReader reader(file(from));
    const RecordedSetup& setup = reader.setup();
    const auto clock = std::make_shared<VirtualClock>();
    ReplayTransport device(clock);
    const auto profile = make_profile(setup.profile, setup.feature);
    Recorder recorder(file(to));
    recorder.start(setup);
    LoopInbox inbox;
    LoopOutbox outbox;
    inbox.touch.offer(make_touch(body_));
    inbox.recording.offer(recorder.ring());
    {
      Loop loop(device, *profile, *clock, setup.options, inbox, outbox);
      for (TickRecord record; reader.next(record);) {
        inbox.settings.write({record.settings, record.touch});
        device.play(record);
        loop.tick();
        loop.wait();
        EXPECT_EQ(device.written(), record.sent) << "tick " << record.tick.number;
      }
    }
    recorder.close();
    return outbox.newest.read().counters;
  }

  /// In which tick of a recording.
  static constexpr int kTrip = 720;

  std::shared_ptr<const Touchable> body_ = test::box_body();
};

TEST_F(Replay, GivesTheSameToTheBit) {
  const Counters first = record("a.csv", 1200);
  const std::vector<TickRecord> ticks = ticks_of(file("a.csv"));
  ASSERT_EQ(ticks.size(), 1200U);
  // It is no quiet run: there are forces, states and limits of all kinds.
  const auto count = [&](auto&& holds) { return std::count_if(ticks.begin(), ticks.end(), holds); };
  EXPECT_GT(count([](const TickRecord& r) { return r.tick.force.norm() > 0.1; }), 300);
  EXPECT_GT(count([](const TickRecord& r) { return r.tick.state == ServoState::stale; }), 10);
  EXPECT_GT(count([](const TickRecord& r) { return r.tick.limited != 0; }), 0);
  const auto by_guardian = [](const TickRecord& r) {
    return (r.tick.tripped & trips::guardian) != 0;
  };
  EXPECT_GT(count(by_guardian), 10);
  EXPECT_FALSE(by_guardian(ticks.back()));
  EXPECT_GT(count([](const TickRecord& r) { return r.tick.num_reports > 1; }), 0);
  EXPECT_GT(count([](const TickRecord& r) { return r.touch.bonded; }), 500);
  EXPECT_GT(count([](const TickRecord& r) { return r.tick.contact.nodes[2] >= 0; }), 100);

  const Counters second = replay("a.csv", "b.csv");
  EXPECT_TRUE(text_of(file("a.csv")) == text_of(file("b.csv"))) << "the recordings differ";
  EXPECT_GT(first.missed, 0U);
  EXPECT_EQ(second.missed, first.missed);
}

// Such as were written before there were reduced bodies.
TEST_F(Replay, ARecordingWithoutNewerColumnsIsRead) {
  (void)record("a.csv", 600);
  std::vector<std::string> rows;
  std::istringstream whole(text_of(file("a.csv")));
  for (std::string row; std::getline(whole, row);) rows.push_back(row);
  const std::vector<TickRecord> expected = ticks_of(file("a.csv"));
  const auto place_of = [](const std::string& row, std::ptrdiff_t column) {
    std::size_t begin = 0;
    for (; column > 0; --column) begin = row.find(',', begin) + 1;
    return begin;
  };
  // The versions before, of which each had fewer columns before the settings.
  for (const char* first : {",friction_work_J,", ",torn_area_m2,", ",mesh_error_x_N,",
                            ",body_0,body_1,body_2,", ",trust,body_0,body_1,body_2,"}) {
    const std::size_t at = rows[0].find(first);
    ASSERT_NE(at, std::string::npos);
    const auto begin = static_cast<std::ptrdiff_t>(at);
    const std::ptrdiff_t before = std::count(rows[0].begin(), rows[0].begin() + begin, ',') + 1;
    const std::ptrdiff_t settings = std::count(rows[0].begin(), rows[0].end(), ',');
    std::string older;
    for (const std::string& row : rows) {
      older += row.substr(0, place_of(row, before)) + row.substr(place_of(row, settings)) + '\n';
    }
    write_text(file("older.csv"), older);
    const std::vector<TickRecord> read = ticks_of(file("older.csv"));
    ASSERT_EQ(read.size(), expected.size());
    EXPECT_EQ(read.back().tick.force, expected.back().tick.force);
    EXPECT_EQ(read.back().tick.contact.bodies[2], kFirstBody);
    EXPECT_EQ(read.back().settings.damping, 2);
  }
}

TEST_F(Replay, AnUnpluggedDeviceIsGoneAgain) {
  const auto clock = std::make_shared<VirtualClock>();
  ReplayTransport device(clock);
  TickRecord record;
  record.tick.time = 5ms;
  record.received[0].size = 1;
  device.play(record);
  EXPECT_EQ(clock->now(), 5ms);
  Report report;
  EXPECT_EQ(device.read(report, 1ms), TransportStatus::data);
  EXPECT_EQ(device.read(report, 1ms), TransportStatus::nothing);
  record.tick.state = ServoState::gone;
  device.play(record);
  EXPECT_EQ(device.read(report, 1ms), TransportStatus::data);
  EXPECT_EQ(device.read(report, 1ms), TransportStatus::gone);
  EXPECT_FALSE(device.problem().empty());
}

TEST_F(Replay, ALastRowThatWasCutShortIsLeftOutAndTold) {
  (void)record("a.csv", 3);
  const std::string whole = text_of(file("a.csv"));
  const std::size_t last_row = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t size = last_row; size < whole.size(); ++size) {
    write_text(file("cut.csv"), whole.substr(0, size));
    std::string notice;
    ASSERT_EQ(ticks_of(file("cut.csv"), &notice).size(), 2U);
    if (size == last_row) {
      EXPECT_EQ(notice, "");
    } else {
      ASSERT_NE(notice.find("cut short"), std::string::npos) << size;
    }
  }
}

TEST_F(Replay, TicksThatAreMissingAreTold) {
  (void)record("a.csv", 6);
  std::string text = text_of(file("a.csv"));
  std::size_t row = 0;
  for (int i = 0; i < 3; ++i) row = text.find('\n', row) + 1;
  text.erase(row, text.find('\n', row) + 1 - row);
  write_text(file("b.csv"), text);
  std::string notice;
  EXPECT_EQ(ticks_of(file("b.csv"), &notice).size(), 5U);
  EXPECT_EQ(notice.rfind("1 ticks are missing", 0), 0U) << notice;
}

TEST_F(Replay, RefusesWhatIsNoRecording) {
  (void)record("a.csv", 3);
  const std::string whole = text_of(file("a.csv"));
  const auto error_of = [&](const std::string& text) -> std::string {
    write_text(file("bad.csv"), text);
    try {
      (void)ticks_of(file("bad.csv"));
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  const auto with = [&](const std::string& what, const std::string& instead) {
    std::string text = whole;
    const std::size_t place = text.find(what);
    EXPECT_NE(place, std::string::npos) << what;
    return text.replace(place, what.size(), instead);
  };
  const auto expect = [&](const std::string& text, std::initializer_list<const char*> words) {
    const std::string error = error_of(text);
    for (const char* word : words) EXPECT_NE(error.find(word), std::string::npos) << error;
    EXPECT_NE(error.find(file("bad.csv")), std::string::npos) << error;
  };
  EXPECT_THROW(RecordingReader(file("none.csv")), InputError);
  EXPECT_THROW(RecordingReader(file("")), InputError);
  expect("", {"no recording"});
  expect(whole.substr(0, 100), {"no recording"});
  expect("a,b\n1,2\n", {"no recording"});
  expect(with("tick,", "tock,"), {"no recording"});
  expect(whole.substr(0, whole.find('\n') + 1), {"no tick"});
  expect(with("\n2,", "\ntwo,"), {"Row 3", "\"two\"", "column tick"});
  expect(with("\n2,", "\n2.5,"), {"Row 3", "\"2.5\""});
  expect(with("\n2,", "\n,"), {"Row 3", "\"\""});
  expect(with("\n2,", "\n2,0,"), {"Row 3", "column"});
  expect(with("\n2,", "\n\"2\"2,"), {"Row 3"});
  expect(with("\n2,", "\n\n2,"), {"Row 3"});
  expect(with(",x02", ",02"), {"Row 3", "column received_0"});
  expect(with(",x02", ",x0z"), {"Row 3", "column received_0"});
  expect(with("damping_Ns_per_m=2;", "damping_Ns_per_m=much;"), {"Row 2", "\"much\"", "damping"});
  expect(with(";bonded=0;", ";"), {"Row 2", "bonded"});
  expect(with(";workspace_scale=1;", ";workspace_scale=nan;"),
         {"Row 2", "The scale of the workspace is nan. Give"});
  expect(with(";coupling_stiffness_N_per_m=0;", ";coupling_stiffness_N_per_m=-1;"),
         {"Row 2", "coupling is -1 N/m"});
  expect(with(";period_s=0.001000000;", ";period_s=0.000000000;"), {"Row 2", "period"});
  // Without the first row; the second one has settings that have changed, the third one none.
  const std::size_t first_row = whole.find('\n') + 1;
  std::string beheaded = whole;
  for (int i = 0; i < 2; ++i) {
    beheaded.erase(first_row, beheaded.find('\n', first_row) + 1 - first_row);
    expect(beheaded, {"Row 2", "settings lack device", "first row", "beginning"});
  }
  expect(with("profile=palpate_report", "profile=glove"), {"Row 2", "\"glove\"", "profile"});
  // A message is shown in a terminal.
  expect(with("\n2,", "\n\x1b]0;,"), {"Row 3", "\"\\x1b]0;\""});
  expect(with("profile=palpate_report", "profile=\x1b["), {"Row 2", "\"\\x1b[\""});
  ASSERT_EQ(mkfifo(file("pipe.csv").c_str(), 0600), 0);
  EXPECT_THROW(RecordingReader(file("pipe.csv")), InputError);
}

}  // namespace
}  // namespace palpate::test::test_replay

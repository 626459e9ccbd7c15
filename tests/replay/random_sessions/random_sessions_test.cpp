// Random racks with masters, people and web pages at them, recorded; the recording is replayed, and
// the replay is recorded: nothing differs, and both files are equal to the byte. So all that a rack
// gives out follows from what is recorded, in the order in which it is recorded.
//
//   STATOR_SEQUENCES=1000     that many instead of some dozens, for a nightly run
//   STATOR_SEQUENCE_SEED=n    this one alone; its recordings stay in the temporary folder
//   STATOR_SEQUENCE_STATISTICS=1    tells how much was replayed

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "replay/random_sessions/live_run.hpp"
#include "replay/random_sessions/random_rack.hpp"
#include "sanitized.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/session_recorder.hpp"

namespace stator::tests {
namespace {

using base::SimDuration;
using base::SimTime;

constexpr std::uint64_t kInEveryRun = kSanitized ? 12 : 60;

/// Each of them a test of its own, so that none takes long.
constexpr std::uint64_t kParts = 4;
/// Of the simulated time of a run.
constexpr SimDuration kShortest{20'000'000};
constexpr std::uint64_t kFurtherMilliseconds = 60;

std::uint64_t number(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

/// A file that goes with its object, unless one seed alone is looked at.
struct ScratchFile {
  ScratchFile(std::uint64_t seed, const char* what)
      : path(fmt::format("{}session-{}-{}-{}.stator", ::testing::TempDir(), ::getpid(), seed,
                         what)) {}
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  ~ScratchFile() {
    if (std::getenv("STATOR_SEQUENCE_SEED") == nullptr) {
      std::filesystem::remove(path);
    }
  }
  std::string path;
};

/// A rack as its seed has it, being recorded.
struct RecordedRack {
  RecordedRack(const rack::RackConfiguration& configuration, const std::string& path)
      : rack(configuration, log), recorder(rack, path, {.program = "test"}) {}
  rack::EventLog log;
  rack::Rack rack;
  replay::SessionRecorder recorder;
};

std::string text_of(const replay::Difference& difference) {
  return fmt::format(
      "the first difference is at {:.9f} s, step {}, {}:\n  recorded: {}\n  now:      {}",
      difference.time.seconds(), difference.step, difference.place, difference.expected,
      difference.got);
}

std::string content(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Of two recordings that are not equal to the byte.
std::string first_other_step(const std::string& path, const std::string& again) {
  replay::RecordingReader one(path);
  replay::RecordingReader other(again);
  replay::Step step;
  replay::Step step_again;
  while (one.next(step)) {
    if (!other.next(step_again) || step.kind != step_again.kind || step.time != step_again.time ||
        step.bytes != step_again.bytes) {
      return fmt::format(
          ": step {} is of kind {} at {:.9f} s, {} bytes, and of kind {} at {:.9f} s, {} bytes",
          step.number, static_cast<int>(step.kind), step.time.seconds(), step.bytes.size(),
          static_cast<int>(step_again.kind), step_again.time.seconds(), step_again.bytes.size());
    }
  }
  return "";
}

/// What was replayed, so that nobody believes in sessions in which nothing happens.
struct Totals {
  std::uint64_t frames = 0;
  std::uint64_t can_frames = 0;
  std::uint64_t bytes = 0;
  std::uint64_t answered = 0;  ///< bytes of devices on serial lines
  double simulated = 0.0;
};

/// Replays `path` and records it anew in `again`; what differs, or empty.
std::string replay_again(const rack::RackConfiguration& configuration, const std::string& path,
                         const std::string& again, base::Random& random, Totals& totals) {
  RecordedRack replayed(configuration, again);
  // Who computes other signals from a recording looks more often than anybody did before.
  rack::SignalTap tap(replayed.rack.signals(),
                      SimDuration(static_cast<std::int64_t>(50'000 + random.below(4'000'000))), 8);
  if (random.uniform() < 0.5) {
    replayed.rack.add(tap, {});
  }
  replay::RecordingReader reader(path);
  {
    replay::Player player(reader, replayed.rack, configuration);
    if (const auto difference = player.play(SimTime::never())) {
      return text_of(*difference);
    }
    totals.frames += player.counts().frames;
    totals.can_frames += player.counts().can_frames;
    totals.bytes += player.counts().bytes;
    totals.simulated += player.now().seconds();
  }
  for (std::size_t line = 0; line < replayed.rack.line_count(); ++line) {
    totals.answered += replayed.rack.line(line).statistics().bytes_out;
  }
  replayed.recorder.finish();
  if (reader.ending() != replay::RecordingEnding::finished) {
    return reader.damage();
  }
  return content(path) == content(again)
             ? ""
             : "the recording of the replay is another file" + first_other_step(path, again);
}

/// Goes back to a mark of `path` and on from there another way, recorded in `branch`.
std::string branch_off(const rack::RackConfiguration& configuration, const std::string& path,
                       const std::string& mark, const std::string& branch, std::uint64_t seed) {
  RecordedRack restored(configuration, branch);
  SimTime start;
  {
    replay::RecordingReader reader(path);
    replay::Player player(reader, restored.rack, configuration);
    if (const auto difference = player.play(SimTime::never(), mark)) {
      return "going back: " + text_of(*difference);
    }
    if (!player.at_mark()) {
      return "going back: the mark is not there";
    }
    restored.rack.execute({rack::command::ReplacePorts{}});
    start = player.now();
  }
  {
    LiveRun run(restored.rack, configuration, seed, start);
    run.run(kShortest);
  }
  restored.recorder.finish();
  return "";
}

/// What is wrong with the session of this seed; empty: nothing.
std::string try_session(std::uint64_t seed, Totals& totals) {
  const rack::RackConfiguration configuration = random_rack(seed);
  base::Random random(~seed);
  const ScratchFile live(seed, "live");
  const ScratchFile again(seed, "again");
  std::vector<std::string> marks;
  {
    RecordedRack recorded(configuration, live.path);
    {
      LiveRun run(recorded.rack, configuration, random.next());
      run.run(kShortest + SimDuration(1'000'000) *
                              static_cast<std::int64_t>(random.below(kFurtherMilliseconds)));
      marks = run.marks();
    }
    recorded.recorder.finish();
    if (recorded.recorder.broken_off() != SimTime::never()) {
      return "the recording has broken off";
    }
  }
  if (std::string wrong = replay_again(configuration, live.path, again.path, random, totals);
      !wrong.empty() || marks.empty()) {
    return wrong;
  }
  const ScratchFile branch(seed, "branch");
  const ScratchFile branch_again(seed, "branch-again");
  const std::string& mark = marks[random.below(marks.size())];
  if (std::string wrong = branch_off(configuration, live.path, mark, branch.path, random.next());
      !wrong.empty()) {
    return wrong;
  }
  const std::string wrong =
      replay_again(configuration, branch.path, branch_again.path, random, totals);
  return wrong.empty() ? "" : "the branch: " + wrong;
}

class RandomSessions : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(RandomSessions, AreReplayedToTheBitAndRecordedAnewToTheByte) {
  const std::uint64_t only = number("STATOR_SEQUENCE_SEED", 0);
  const std::uint64_t last = only != 0 ? only : number("STATOR_SEQUENCES", kInEveryRun);
  Totals totals;
  for (std::uint64_t seed = only != 0 ? only : 1; seed <= last; ++seed) {
    if (seed % kParts != GetParam()) {
      continue;
    }
    const std::string wrong = try_session(seed, totals);
    EXPECT_EQ(wrong, "") << "STATOR_SEQUENCE_SEED=" << seed;
  }
  if (only == 0) {
    EXPECT_GT(totals.frames, 0U);
    EXPECT_GT(totals.can_frames, 0U);
    EXPECT_GT(totals.answered, 0U);
  }
  if (std::getenv("STATOR_SEQUENCE_STATISTICS") != nullptr) {
    fmt::print("{:.2f} s replayed, {} EtherCAT frames, {} CAN frames, {} bytes in, {} bytes out\n",
               totals.simulated, totals.frames, totals.can_frames, totals.bytes, totals.answered);
  }
}

INSTANTIATE_TEST_SUITE_P(Part, RandomSessions, ::testing::Range(std::uint64_t{0}, kParts));

}  // namespace
}  // namespace stator::tests

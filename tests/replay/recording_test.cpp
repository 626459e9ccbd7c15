// Recordings played again bit by bit, from snapshots and branches too, and damaged or foreign ones.
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "stator/bench/local_port.hpp"
#include "stator/can/port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcc160/tmcc160.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/networks/can_network.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/session_recorder.hpp"

namespace stator::replay {
namespace {

using namespace base::literals;
using base::SimTime;
using ::testing::HasSubstr;

constexpr const char* kLine = "pty:/tmp/none";

/// A stepper drive on a segment, a servo on a CAN bus with one port, a module on a serial line, and
/// a load that comes at 30 ms.
rack::RackConfiguration mixed_rack(double load = 0.1) {
  rack::RackConfiguration configuration =
      rack::single_device_rack("tmcm-3315", devices::products());
  configuration.segments[0].devices[0].name = "drive";
  configuration.buses = rack::single_device_rack("tmcc160", devices::products()).buses;
  configuration.buses[0].devices[0].name = "servo";
  configuration.buses[0].devices[0].setup.as<devices::Tmcc160Configuration>().boot_time = 5_ms;
  configuration.buses[0].ports = {"slcan:/tmp/none"};
  rack::BusConfiguration lines = rack::bus_without_wire();
  lines.devices = rack::single_device_rack("tmcm-142", devices::products()).buses[0].devices;
  lines.devices[0].name = "module";
  lines.devices[0].serial = {{.interface = "rs485", .line = kLine}};
  configuration.buses.push_back(lines);
  configuration.events.push_back(
      {30_ms, rack::InputEvent{.device = {}, .input = "axis0.load_torque", .value = load}});
  return configuration;
}

/// One run of a rack with its masters.
class Bench {
 public:
  explicit Bench(const rack::RackConfiguration& configuration)
      : configuration_(configuration), rack_(configuration_, log_) {}

  rack::Rack& rack() { return rack_; }
  rack::EventLog& log() { return log_; }
  const rack::RackConfiguration& configuration() const { return configuration_; }

 private:
  rack::RackConfiguration configuration_;
  rack::EventLog log_;
  rack::Rack rack_;
};

/// The masters of a bench, all of them.
class Masters {
 public:
  explicit Masters(rack::Rack& rack)
      : rack_(rack), segment_(rack, 0, 1_ms, 50_us), master_(segment_), port_(rack, 0) {
    rack_.connect_line(0, rack::SerialLine::Output::bind<&Masters::hear>(*this));
  }
  ~Masters() { rack_.connect_line(0, {}); }

  void start() {
    ASSERT_TRUE(master_.scan());
    ASSERT_EQ(master_.slaves().size(), 1U);
  }
  /// A bit of everything, and then 20 ms.
  void talk() {
    ASSERT_TRUE(master_.scan());
    ask_servo(0x6041);
    send({std::byte{1}, std::byte{6}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{0},
          std::byte{0}, std::byte{0}, std::byte{8}});  // GAP 1, 0 of module 1
    rack_.apply(
        rack::InputEvent{
            .device = {0, 0, rack::NetworkKind::bus}, .input = "axis0.load_torque", .value = 0.01},
        segment_.now());
    const dictionary::Entry* mode = rack_.device({}).object_dictionary()->find(0x6060, 0);
    ASSERT_NE(mode, nullptr);
    const std::vector<std::byte> value{std::byte{3}};
    ASSERT_TRUE(rack_.write_object({}, *mode, value, segment_.now()));
    for (const SimTime begin = segment_.now(); segment_.now() < begin + 20_ms;) {
      segment_.wait(300_us);
      while (port_.take()) {
        ++can_frames_;
      }
    }
  }
  [[nodiscard]] std::size_t can_frames() const { return can_frames_; }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }

 private:
  void ask_servo(unsigned index) {
    const can::Frame ask =
        can::data_frame(0x601, {0x40, index & 0xFFU, index >> 8U, 0x00, 0x00, 0x00, 0x00, 0x00});
    ASSERT_TRUE(port_.put(ask));
  }
  void send(const std::vector<std::byte>& bytes) { rack_.put(0, bytes, segment_.now()); }
  void hear(std::span<const std::byte> bytes) { bytes_ += bytes.size(); }

  rack::Rack& rack_;
  bench::LocalPort segment_;
  master::Master master_;
  rack::BusPort port_;
  std::size_t can_frames_ = 0;
  std::size_t bytes_ = 0;
};

class RecordingTest : public ::testing::Test {
 protected:
  RecordingTest()
      : path_(::testing::TempDir() + "recording-" + std::to_string(::getpid()) + ".stator") {}
  ~RecordingTest() override {
    std::filesystem::remove(path_);
    std::filesystem::remove(path_ + "2");
  }

  /// Records three talks with a mark after the second.
  void record(const std::string& path) {
    Bench bench(mixed_rack());
    SessionRecorder recorder(bench.rack(), path, {.program = "test"});
    {
      Masters masters(bench.rack());
      ASSERT_NO_FATAL_FAILURE(masters.start());
      for (int i = 0; i < 3; ++i) {
        ASSERT_NO_FATAL_FAILURE(masters.talk());
        if (i == 1) {
          recorder.mark("middle");
        }
      }
      EXPECT_GT(masters.can_frames(), 2U);  // boot-up and answers
      EXPECT_GE(masters.bytes(), 27U);
    }
    recorder.finish();
    EXPECT_EQ(recorder.broken_off(), SimTime::never());
  }

  /// Plays all of `path` on a rack with this load.
  static std::optional<Difference> play(const std::string& path, double load = 0.1) {
    Bench bench(mixed_rack(load));
    RecordingReader reader(path);
    Player player(reader, bench.rack(), bench.configuration());
    auto difference = player.play(SimTime::never());
    if (!difference) {
      EXPECT_EQ(reader.damage(), "");
      EXPECT_GT(player.counts().frames, 100U);
      EXPECT_EQ(player.counts().can_frames, 3U);
      EXPECT_EQ(player.counts().bytes, 27U);
    }
    return difference;
  }

  std::string path_;
};

TEST_F(RecordingTest, PlaysTheSameToTheLastBit) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  const auto difference = play(path_);
  EXPECT_FALSE(difference) << difference->place << ": " << difference->expected << " / "
                           << difference->got;
}

TEST_F(RecordingTest, TellsTheFirstDifference) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  const auto difference = play(path_, 0.2);
  ASSERT_TRUE(difference);
  EXPECT_GE(difference->time, SimTime(30_ms));
  EXPECT_NE(difference->expected, difference->got);
}

TEST_F(RecordingTest, ARestoredSnapshotGoesOnAlike) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  Bench bench(mixed_rack());
  RecordingReader reader(path_);
  {
    Player player(reader, bench.rack(), bench.configuration());
    ASSERT_FALSE(player.play(SimTime::never(), "middle"));
    EXPECT_TRUE(player.at_mark());
    const SimTime middle = player.now();
    EXPECT_FALSE(player.play(SimTime::never()));
    EXPECT_GT(player.now(), middle);
  }
  EXPECT_EQ(reader.damage(), "");
}

TEST_F(RecordingTest, ABranchHasItsOwnRecordingFromPowerOn) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  const std::string branch = path_ + "2";
  {
    Bench bench(mixed_rack());
    SessionRecorder recorder(bench.rack(), branch, {.program = "test"});
    RecordingReader reader(path_);
    {
      Player player(reader, bench.rack(), bench.configuration());
      ASSERT_FALSE(player.play(SimTime::never(), "middle"));
    }
    bench.rack().execute({rack::command::ReplacePorts{}});
    const SimTime middle = recorder.time();
    rack::BusPort port(bench.rack(), 0);
    for (int i = 1; i <= 50; ++i) {
      port.put(can::data_frame(0x601, {0x40, 0x64, 0x60, 0, 0, 0, 0, 0}));
      bench.rack().advance(middle + 1_ms * i);
      while (port.take()) {
      }
    }
    recorder.finish();
  }
  Bench bench(mixed_rack());
  RecordingReader reader(branch);
  Player player(reader, bench.rack(), bench.configuration());
  const auto difference = player.play(SimTime::never());
  EXPECT_FALSE(difference) << difference->place << ": " << difference->expected << " / "
                           << difference->got;
  EXPECT_EQ(player.counts().can_frames, 52U);
}

// Programs come to a bus and leave it whenever they like: what they find, and the number of a place
// that was free again, is the same when it is played.
TEST_F(RecordingTest, PortsThatOpenAndCloseLaterArePlayed) {
  const can::Frame ask = can::data_frame(0x601, {0x40, 0x64, 0x60, 0, 0, 0, 0, 0});
  {
    Bench bench(mixed_rack());
    rack::BusPort before(bench.rack(), 0);  // belongs to what the recording begins with
    SessionRecorder recorder(bench.rack(), path_, {.program = "test"});
    bench.rack().advance(SimTime(500_ms));
    std::optional<rack::BusPort> late(std::in_place, bench.rack(), 0);
    EXPECT_EQ(late->number(), 1U);
    ASSERT_TRUE(late->put(ask));
    bench.rack().advance(SimTime(510_ms));
    EXPECT_TRUE(late->take());
    EXPECT_TRUE(before.take());
    late.reset();
    rack::BusPort again(bench.rack(), 0, {.hears_errors = false, .lossy = true});
    EXPECT_EQ(again.number(), 1U);
    EXPECT_EQ(again.waiting(), 0U);
    ASSERT_TRUE(again.put(ask));
    bench.rack().advance(SimTime(520_ms));
    while (again.take()) {
    }
    recorder.finish();
  }
  Bench bench(mixed_rack());
  RecordingReader reader(path_);
  Player player(reader, bench.rack(), bench.configuration());
  const auto difference = player.play(SimTime(515_ms));
  ASSERT_FALSE(difference) << difference->place << ": " << difference->got;
  const auto open = rack::BusPort::all(bench.rack());
  ASSERT_EQ(open.size(), 2U);
  EXPECT_TRUE(open[1].options.lossy);
  EXPECT_FALSE(open[1].options.hears_errors);
  // Who goes on from here gets a place with what waits in it, or none where there is none.
  const auto taken = player.take_port(0, 0);
  ASSERT_NE(taken, nullptr);
  EXPECT_GT(taken->waiting(), 0U);
  EXPECT_EQ(player.take_port(0, 0), nullptr);
  EXPECT_EQ(player.take_port(0, 7), nullptr);
}

TEST_F(RecordingTest, AFileThatIsCutOffIsGoodUpToThere) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  std::filesystem::resize_file(path_, std::filesystem::file_size(path_) - 7);
  Bench bench(mixed_rack());
  RecordingReader reader(path_);
  Player player(reader, bench.rack(), bench.configuration());
  EXPECT_FALSE(player.play(SimTime::never()));
  EXPECT_THAT(reader.damage(), HasSubstr("cut off"));
}

TEST_F(RecordingTest, AChangedByteIsFound) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  {
    std::fstream file(path_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(-40, std::ios::end);
    file.put('?');
  }
  Bench bench(mixed_rack());
  RecordingReader reader(path_);
  Player player(reader, bench.rack(), bench.configuration());
  EXPECT_FALSE(player.play(SimTime::never()));
  EXPECT_THAT(reader.damage(), HasSubstr("damaged"));
}

TEST_F(RecordingTest, OtherFilesAndVersionsAreRefused) {
  const auto refusal = [this](const std::string& content) -> std::string {
    std::ofstream(path_, std::ios::binary) << content;
    try {
      RecordingReader reader(path_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "none";
  };
  EXPECT_THAT(refusal("time,axis0\n"), HasSubstr("is no recording"));
  EXPECT_THAT(refusal("StatorRn"), HasSubstr("empty recording"));
  const std::string version_5("\x01\x00\x00\x00\x02\x1B\x68\xA2\x05", 9);
  EXPECT_THAT(refusal("StatorRn" + version_5), HasSubstr("version 5"));
  EXPECT_THROW(RecordingReader("/no/such.stator"), std::runtime_error);
}

TEST_F(RecordingTest, AnotherRackIsRefused) {
  ASSERT_NO_FATAL_FAILURE(record(path_));
  Bench bench(rack::single_device_rack("tmcm-3315", devices::products()));
  RecordingReader reader(path_);
  EXPECT_THROW(Player(reader, bench.rack(), bench.configuration()), std::runtime_error);
}

}  // namespace
}  // namespace stator::replay

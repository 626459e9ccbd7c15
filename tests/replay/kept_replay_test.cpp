// Recordings of racks that keep things: the completions are in them.

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/standard/frame.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/named_device.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/session_recorder.hpp"

namespace stator::replay {
namespace {

using namespace base::literals;
using Completions = rack::DeviceStorage::Completions;
using Bytes = std::vector<std::byte>;

constexpr unsigned kBusy = 0x8000;
constexpr unsigned kNoAcknowledge = 0x2000;

std::string content_of(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

/// A TMC8670 that keeps things in a folder of its own, and the frames of a master.
class Bench {
 public:
  explicit Bench(std::optional<Completions> completions = {})
      : rack(configuration(folder_.path() + "/state"), log), port_(rack, 0, 1_ms, 50_us) {
    if (completions) {
      rack.storage()->set_completions(*completions);
    }
  }
  static rack::RackConfiguration configuration(const std::string& state) {
    rack::RackConfiguration result = rack::single_device_rack("tmc8670", devices::products());
    result.state = state;
    return result;
  }

  /// Orders a word to be written.
  void order(std::uint16_t value) {
    Bytes registers(8);
    base::store_le(registers, 0, std::uint16_t{0x0201});
    base::store_le(registers, 2, std::uint32_t{0x60});
    base::store_le(registers, 6, value);
    transfer(ethercat::Command::apwr, 0x0502, registers);
  }
  unsigned status() {
    const Bytes status = transfer(ethercat::Command::aprd, 0x0502, Bytes(2));
    return base::load_le<std::uint16_t>(status) & 0xE000U;
  }
  /// Looks `polls` times, and lets the device hear from the disk then.
  void finish(int polls) {
    for (int i = 0; i < polls; ++i) {
      EXPECT_EQ(status(), kBusy);
    }
    while (rack.storage()->busy()) {
      rack.hand_over_completions(port_.now());
    }
    wait(1_ms);
  }
  void wait(base::SimDuration duration) { port_.wait(duration); }
  void store_parameters() {
    write_object(0x2030, 3, 77, 2);
    write_object(0x1010, 1, 0x65766173, 4);
  }
  void power_cycle() {
    rack.apply(rack::PowerEvent{.device = {}, .on = false}, port_.now());
    wait(10_ms);
    rack.apply(rack::PowerEvent{.device = {}, .on = true}, port_.now());
    wait(10_ms);
  }
  [[nodiscard]] std::uint64_t parameter() {
    return rack.device({}).object_dictionary()->find(0x2030, 3)->value();
  }
  [[nodiscard]] unsigned word() {
    return base::load_le<std::uint16_t>(rack.slave({}).controller().sii(), 0xC0);
  }
  void take_directory_away() {
    std::filesystem::create_directory(folder_.path() + "/state/tmc8670.eeprom.new");
    std::filesystem::rename(folder_.path() + "/state", folder_.path() + "/away");
  }
  void bring_directory_back() {
    std::filesystem::rename(folder_.path() + "/away", folder_.path() + "/state");
    std::filesystem::remove(folder_.path() + "/state/tmc8670.eeprom.new");
  }

 private:
  void write_object(std::uint16_t index, std::uint8_t subindex, std::uint32_t value,
                    std::size_t length) {
    Bytes bytes(4);
    base::store_le(bytes, 0, value);
    bytes.resize(length);
    const dictionary::Entry& entry = *rack.device({}).object_dictionary()->find(index, subindex);
    EXPECT_TRUE(rack.write_object({}, entry, bytes, port_.now()));
  }
  Bytes transfer(ethercat::Command command, std::uint16_t address, const Bytes& data) {
    std::array<std::byte, ethercat::kMaximumFrameLength> request{};
    std::array<std::byte, ethercat::kMaximumFrameLength> reply{};
    ethercat::FrameBuilder builder(request, {2, 0, 0, 0, 0, 1});
    builder.append(command, 0, ethercat::physical_address(0, address), data);
    const auto length = port_.exchange(builder.finish(), reply, 1_ms);
    EXPECT_TRUE(length);
    const auto datagram = ethercat::DatagramCursor(std::span(reply).first(*length)).next();
    return {datagram->data, datagram->data + datagram->length};
  }

  tests::TemporaryDirectory folder_;

 public:
  rack::EventLog log;
  rack::Rack rack;

 private:
  bench::LocalPort port_;
};

class KeptReplay : public ::testing::Test {
 protected:
  void SetUp() override { path_ = folder_.path() + "/run.stator"; }
  /// Plays the recording on `bench` and records that once more.
  void replay(Bench& bench) {
    {
      RecordingReader reader(path_);
      SessionRecorder again(bench.rack, path_ + "2",
                            {.version = reader.header().version, .program = "test"});
      Player player(reader, bench.rack, Bench::configuration("x"));
      const auto difference = player.play(base::SimTime::never());
      EXPECT_FALSE(difference) << difference->place << ": " << difference->expected << " but "
                               << difference->got;
    }
    EXPECT_EQ(content_of(path_), content_of(path_ + "2"));
  }

  tests::TemporaryDirectory folder_;
  std::string path_;
};

TEST_F(KeptReplay, WordsAndParameters_AreReplayedToTheBitHoweverQuickTheDiskWas) {
  Bench live(Completions::when_durable);
  {
    const SessionRecorder recorder(live.rack, path_, {.program = "test"});
    for (const int polls : {0, 3, 40}) {
      live.order(static_cast<std::uint16_t>(0x1000 + polls));
      live.finish(polls);
      EXPECT_EQ(live.status(), 0U);
    }
    live.store_parameters();
    live.power_cycle();
    EXPECT_NE(live.parameter(), 77U) << "not kept yet";
    live.finish(0);
    live.power_cycle();
    EXPECT_EQ(live.parameter(), 77U);
  }
  Bench replayed;
  replay(replayed);
  EXPECT_EQ(replayed.word(), 0x1028U);
  EXPECT_EQ(replayed.parameter(), 77U);
}

TEST_F(KeptReplay, WordThatCouldNotBeKept_FailsInTheReplayToo) {
  Bench live(Completions::when_durable);
  {
    const SessionRecorder recorder(live.rack, path_, {.program = "test"});
    live.order(1);
    live.finish(5);
    live.take_directory_away();
    live.order(2);
    live.finish(5);
    EXPECT_EQ(live.status(), kNoAcknowledge);
    live.bring_directory_back();
  }
  Bench replayed;
  replay(replayed);
  EXPECT_EQ(replayed.word(), 1U);
  EXPECT_EQ(replayed.status(), kNoAcknowledge);
}

TEST_F(KeptReplay, LockstepRun_IsReplayedToTheBit) {
  Bench live;
  {
    const SessionRecorder recorder(live.rack, path_, {.program = "test"});
    for (std::uint16_t i = 1; i < 20; ++i) {
      live.order(i);
      int polls = 0;
      while (live.status() != 0) {
        ++polls;
      }
      EXPECT_EQ(polls, 9) << "500 us in steps of 50 us";
    }
    live.store_parameters();
    live.wait(30_ms);
    live.power_cycle();
  }
  Bench replayed;
  replay(replayed);
  EXPECT_EQ(replayed.word(), 19U);
  EXPECT_EQ(replayed.parameter(), 77U);
}

TEST_F(KeptReplay, OrderUnderWayAtTheEnd_EndsOnceInTheRunThatGoesOn) {
  Bench live(Completions::when_durable);
  {
    const SessionRecorder recorder(live.rack, path_, {.program = "test"});
    live.order(1);
    live.finish(1);
    live.order(2);
    live.wait(5_ms);
  }
  Bench restored(Completions::when_durable);
  replay(restored);
  EXPECT_TRUE(restored.rack.storage()->busy());
  EXPECT_EQ(restored.word(), 1U);
  restored.finish(1);
  EXPECT_EQ(restored.word(), 2U);
  EXPECT_EQ(restored.status(), 0U);
  restored.rack.storage()->flush({});
  EXPECT_TRUE(restored.rack.storage()->take_completions({}).empty());
}

TEST_F(KeptReplay, RecordingOfFormat1_HasNoCompletionsAndNeedsNone) {
  Bench live(Completions::at_once);
  {
    const SessionRecorder recorder(live.rack, path_, {.version = 1, .program = "test"});
    live.order(1);
    EXPECT_EQ(live.status(), kBusy);
    live.wait(1_ms);
    EXPECT_EQ(live.status(), 0U);
    live.store_parameters();
    live.power_cycle();
    EXPECT_EQ(live.parameter(), 77U);
  }
  Bench replayed;
  replay(replayed);
  EXPECT_EQ(replayed.word(), 1U);
  EXPECT_EQ(replayed.parameter(), 77U);
}

}  // namespace
}  // namespace stator::replay

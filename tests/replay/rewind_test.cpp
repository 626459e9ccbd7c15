// Benches that a recording brings back to an earlier moment.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "stator/bench/bench.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/master/cia402/cia402_client.hpp"
#include "stator/rack/core/bus_port.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/session_recorder.hpp"

namespace stator::replay {
namespace {

using namespace base::literals;

settings::Table drive_and_node() {
  const settings::Table drive{{"type", "tmcm-3315"}, {"name", "x"}};
  const settings::Table node{{"type", "tmcc160"}, {"name", "spindle"}};
  return {{"segment", settings::List{settings::Table{{"device", settings::List{drive}}}}},
          {"bus", settings::List{settings::Table{{"device", settings::List{node}}}}}};
}

/// Plays a recording up to a mark.
class Recorded final : public bench::Bench::Past {
 public:
  Recorded(const std::string& path, std::string mark, const rack::RackConfiguration& configuration)
      : reader_(path), mark_(std::move(mark)), configuration_(configuration) {}

  void play(rack::Rack& rack) override {
    player_.emplace(reader_, rack, configuration_);
    EXPECT_FALSE(player_->play(base::SimTime::never(), mark_));
    EXPECT_TRUE(player_->at_mark());
  }
  std::unique_ptr<rack::BusPort> take_port(std::size_t bus, std::size_t number) override {
    return player_->take_port(bus, number);
  }
  void end() override { player_.reset(); }

 private:
  RecordingReader reader_;
  std::string mark_;
  const rack::RackConfiguration& configuration_;
  std::optional<Player> player_;
};

std::vector<double> values_of(rack::Rack& rack) {
  std::vector<double> values;
  for (const product::Signal& signal : rack.signals()) {
    values.push_back(signal.read());
  }
  return values;
}

TEST(Rewind, TheSameWayFromAMomentHasTheSameBitsAndMastersKnowWhatTheyKnew) {
  const std::string path =
      ::testing::TempDir() + "rewind-" + std::to_string(::getpid()) + ".stator";
  bench::Bench bench(bench::load(drive_and_node(), devices::products()));
  std::optional<SessionRecorder> recorder(std::in_place, bench.rack(), path,
                                          RecordingHeader{.program = "test"});
  const auto x = bench.find("x").value();
  const auto spindle = bench.find("spindle").value();
  ASSERT_TRUE(bench.go_operational());
  master::Cia402Client axis(*bench.drive(x).value(), 0);
  ASSERT_TRUE(axis.enable());
  ASSERT_TRUE(axis.set_mode(master::OperationMode::profile_position));
  const auto frames = bench.frames(0).size();
  recorder->mark("enabled");
  const auto memory = bench.remember();
  const base::SimTime moment = bench.now();
  const std::uint16_t controlword = axis.controlword();
  const std::vector<double> then = values_of(bench.rack());
  const std::uint64_t cycles = bench.scanned(0).value()->cycle_statistics().cycles;

  const auto way = [&] {
    EXPECT_TRUE(axis.start_move({.target = 10'000, .velocity = 200'000}));
    EXPECT_TRUE(bench.upload(spindle, {0x1000, 0}));
    bench.pass(100_ms);
    return values_of(bench.rack());
  };
  const std::vector<double> first = way();
  EXPECT_NE(first, then);
  ASSERT_TRUE(bench.scan(0));  // all slaves to Init, what was configured is forgotten
  recorder->finish();
  recorder.reset();

  for (int i = 0; i < 2; ++i) {
    Recorded past(path, "enabled", bench.configuration());
    bench.rewind(*memory, past);
    axis.assume_controlword(controlword);
    EXPECT_EQ(bench.now(), moment);
    EXPECT_EQ(values_of(bench.rack()), then);
    EXPECT_EQ(bench.frames(0).size(), frames);
    const master::Master& master = *bench.scanned(0).value();
    EXPECT_TRUE(master.operational());
    EXPECT_EQ(master.cycle_statistics().cycles, cycles);
    EXPECT_EQ(way(), first);
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace stator::replay

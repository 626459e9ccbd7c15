// Answers over several serial lines: in which order they come, and in which they are recorded.

#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "rack/test_serial_device.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/networks/serial_line.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/observe/signal_tap.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/session_recorder.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::replay {
namespace {

using namespace base::literals;
using base::SimTime;
using ::testing::ElementsAre;

/// Two modules, each with a bus and a line of its own: the first answers after 5 ms, the second
/// after 2 ms. Beside them a chip on a segment, and something that happens at 10 ms.
rack::RackConfiguration two_lines() {
  rack::RackConfiguration configuration = rack::single_device_rack("tmc8461", devices::products());
  for (const std::uint8_t pause : {std::uint8_t{5}, std::uint8_t{2}}) {
    const std::string line = "pty:/tmp/line" + std::to_string(configuration.buses.size());
    configuration.buses.push_back(tests::rack_with_line(line, {{.pause = pause}}).buses[0]);
    configuration.buses.back().devices[0].name = line;
  }
  configuration.events.push_back(
      {10_ms, rack::CableEvent{.device = {}, .port = 1, .intact = true}});
  return configuration;
}

class Bench {
 public:
  Bench() : configuration_(two_lines()), rack_(configuration_, log_) {}
  ~Bench() {
    for (std::size_t line = 0; line < hosts_.size(); ++line) {
      rack_.connect_line(line, {});
    }
  }
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;

  rack::Rack& rack() { return rack_; }
  const rack::RackConfiguration& configuration() const { return configuration_; }
  /// Numbers of the lines that answered, in their order.
  const std::vector<std::size_t>& answers() const { return answers_; }

  void listen() {
    for (std::size_t line = 0; line < rack_.line_count(); ++line) {
      hosts_.push_back(std::make_unique<Host>(Host{answers_, line}));
      rack_.connect_line(line, rack::SerialLine::Output::bind<&Host::hear>(*hosts_.back()));
    }
  }
  /// Asks both at 1 ms.
  void ask() {
    rack_.advance(SimTime(1_ms));
    for (std::size_t line = 0; line < rack_.line_count(); ++line) {
      rack_.put(line, tmcl::encode(tmcl::Request{.address = 1, .command = 6, .type = 1}),
                SimTime(1_ms));
    }
  }

 private:
  struct Host {
    std::vector<std::size_t>& answers;
    std::size_t line;
    void hear(std::span<const std::byte> /*bytes*/) { answers.push_back(line); }
  };

  rack::RackConfiguration configuration_;
  rack::EventLog log_;
  rack::Rack rack_;
  std::vector<std::size_t> answers_;
  std::vector<std::unique_ptr<Host>> hosts_;
};

TEST(SerialOrder, AnswersOfSeveralLinesComeByTheirTimes) {
  Bench bench;
  bench.listen();
  bench.ask();
  bench.rack().advance(SimTime(20_ms));
  EXPECT_THAT(bench.answers(), ElementsAre(1, 0));
}

TEST(SerialOrder, IsTheSameWhateverLooksAtTheRack) {
  Bench bench;
  bench.listen();
  rack::SignalTap tap(bench.rack().signals(), 700_us, 4);
  bench.rack().add(tap, {});
  bench.ask();
  bench.rack().advance(SimTime(20_ms));
  EXPECT_THAT(bench.answers(), ElementsAre(1, 0));
  bench.rack().remove(tap);
}

TEST(SerialOrder, AnswersWithinAFrameAreRecordedAnewWithinIt) {
  const std::string first = ::testing::TempDir() + "order-" + std::to_string(::getpid());
  const std::string second = first + "-again";
  {
    Bench bench;
    SessionRecorder recorder(bench.rack(), first, {.program = "test"});
    bench.listen();
    bench.ask();
    // The event lies before the frame, so that all devices are brought to it within its call.
    std::vector<std::byte> frame(60);
    static_cast<void>(bench.rack().process_frame(0, frame, SimTime(12_ms)));
    EXPECT_THAT(bench.answers(), ElementsAre(1, 0));
    bench.rack().handle_bus_events(0, SimTime(12_ms));
    bench.rack().advance(SimTime(13_ms));
    recorder.finish();
  }
  const auto replay = [](const std::string& from, const std::string& to) {
    Bench bench;
    SessionRecorder recorder(bench.rack(), to, {.program = "test"});
    RecordingReader reader(from);
    Player player(reader, bench.rack(), bench.configuration());
    const auto difference = player.play(SimTime::never());
    EXPECT_FALSE(difference) << difference->place << ": " << difference->expected << " / "
                             << difference->got;
    EXPECT_EQ(reader.ending(), RecordingEnding::finished);
    recorder.finish();
  };
  const auto content = [](const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(file), {});
  };
  replay(first, second);
  EXPECT_EQ(content(first), content(second));
  std::filesystem::remove(first);
  std::filesystem::remove(second);
}

}  // namespace
}  // namespace stator::replay

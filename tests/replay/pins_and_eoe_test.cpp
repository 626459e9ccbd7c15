// Recordings of what comes to the pins of a chip from the controller beside it, and over Ethernet
// from the network behind a device.

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <unistd.h>

#include "stator/bench/local_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/eoe/eoe.hpp"
#include "stator/master/mailbox_client.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/device_making.hpp"
#include "stator/rack/core/host_pins.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/networks/eoe_port.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/replay/player.hpp"
#include "stator/replay/session_recorder.hpp"

namespace stator::replay {
namespace {

using namespace base::literals;
using base::SimTime;
using Bytes = std::vector<std::byte>;

const rack::DeviceAddress kDrive{0, 0, rack::NetworkKind::segment};
const rack::DeviceAddress kChip{1, 0, rack::NetworkKind::segment};

/// A drive whose EoE is bridged, and on another segment a chip without firmware of its own.
rack::RackConfiguration drive_and_chip() {
  rack::RackConfiguration configuration =
      rack::single_device_rack("tmcm-3315", devices::products());
  auto& drive = configuration.segments[0].devices[0];
  drive.setup.as<devices::Tmcm3315Configuration>().coe.ethernet_over_ethercat = true;
  drive.eoe_interface = "eoe0";
  configuration.segments.push_back(
      rack::single_device_rack("tmc8461", devices::products()).segments[0]);
  return configuration;
}

Bytes frame_of(std::size_t length, unsigned seed) {
  Bytes frame(length);
  for (std::size_t i = 0; i < length; ++i) {
    frame[i] = static_cast<std::byte>(i * 7 + seed);
  }
  return frame;
}

class PinsAndEoe : public ::testing::Test {
 protected:
  PinsAndEoe() : path_(::testing::TempDir() + "pins-" + std::to_string(::getpid()) + ".stator") {}
  ~PinsAndEoe() override { std::filesystem::remove(path_); }

  void record() {
    rack::EventLog log;
    rack::Rack rack(configuration_, log);
    SessionRecorder recorder(rack, path_, {.program = "test"});
    talk_at_pins(rack);
    ASSERT_NO_FATAL_FAILURE(talk_over_eoe(rack));
    recorder.finish();
  }

  /// Reads the chip's identity, then writes and reads back a register, by SPI.
  void talk_at_pins(rack::Rack& rack) {
    rack::HostPins pins(rack, kChip);
    for (const unsigned command : {0x02U, 0x03U, 0x02U}) {
      rack.advance(now_ += 100_us);
      const Bytes mosi{std::byte{0},    static_cast<std::byte>(command),
                       std::byte{0xFF}, std::byte{0xFF},
                       std::byte{0},    std::byte{0}};
      Bytes miso(mosi.size());
      pins.exchange(product::HostSpi::pdi, mosi, miso);
      answers_.insert(answers_.end(), miso.begin(), miso.end());
    }
    pins.set_pin(product::HostPin::latch0, true);
    rack.advance(now_ += 1_ms);
  }

  void talk_over_eoe(rack::Rack& rack) {
    std::vector<Bytes> to_network;
    ASSERT_TRUE(rack.connect_eoe(kDrive, {.frame =
                                              [&to_network](std::span<const std::byte> frame) {
                                                to_network.emplace_back(frame.begin(), frame.end());
                                              },
                                          .ip_parameters = {}}));
    bench::LocalPort port(rack, 0, 1_ms, 50_us);
    port.wait(now_ - SimTime());
    master::Master master(port);
    const auto scanned = master.scan();
    ASSERT_TRUE(scanned) << scanned.error().text;
    const auto started = master.start_mailbox(0);
    ASSERT_TRUE(started) << started.error().text;
    const master::MasterOptions options;
    master::Bus bus(port, options);
    const master::Slave& slave = master.slaves()[0];
    const master::Station station{slave.position, slave.station_address};
    const master::Idle idle;
    master::MailboxClient mailbox(bus, station, slave.information, idle);
    Bytes fragment(ethercat::EoeHeader::kSize);
    ethercat::EoeHeader{.last_fragment = true, .offset = 2}.encode(fragment);
    const Bytes frame = frame_of(60, 1);
    fragment.insert(fragment.end(), frame.begin(), frame.end());
    const auto sent = mailbox.send(ethercat::MailboxType::eoe, fragment);
    ASSERT_TRUE(sent) << sent.error().text;
    port.wait(5_ms);
    ASSERT_EQ(to_network, std::vector<Bytes>{frame});

    rack.put_eoe_frame(kDrive, frame_of(64, 2));
    port.wait(5_ms);
    const auto received = mailbox.receive(ethercat::MailboxType::eoe, port.now() + 50_ms);
    ASSERT_TRUE(received) << received.error().text;
    EXPECT_EQ(Bytes(received->begin() + ethercat::EoeHeader::kSize, received->end()),
              frame_of(64, 2));
    ASSERT_TRUE(rack.connect_eoe(kDrive, {}));
  }

  std::optional<Difference> play(const rack::RackConfiguration& configuration) {
    rack::EventLog log;
    rack::Rack rack(configuration, log);
    RecordingReader reader(path_);
    Player player(reader, rack, configuration);
    auto difference = player.play(SimTime::never());
    if (!difference) {
      EXPECT_EQ(reader.damage(), "");
    }
    return difference;
  }

  std::string path_;
  rack::RackConfiguration configuration_ = drive_and_chip();
  SimTime now_;
  Bytes answers_;
};

TEST_F(PinsAndEoe, PlayTheSameToTheLastBit) {
  ASSERT_NO_FATAL_FAILURE(record());
  EXPECT_NE(answers_, Bytes(answers_.size())) << "the chip has said something";
  const auto difference = play(configuration_);
  EXPECT_FALSE(difference) << difference->place << ": " << difference->expected << " / "
                           << difference->got;
}

TEST_F(PinsAndEoe, AChipThatAnswersOtherwiseIsTheDifference) {
  ASSERT_NO_FATAL_FAILURE(record());
  rack::RackConfiguration other = configuration_;
  other.events.push_back({150_us, rack::PowerEvent{.device = kChip, .on = false}});
  const auto difference = play(other);
  ASSERT_TRUE(difference);
  EXPECT_EQ(difference->place, "answer at the pins of a chip");
  EXPECT_EQ(difference->time, SimTime(200_us));
}

TEST_F(PinsAndEoe, ABridgeThatIsNotThereIsSaid) {
  ASSERT_NO_FATAL_FAILURE(record());
  rack::RackConfiguration other = configuration_;
  other.segments[0].devices[0].eoe_interface.clear();
  EXPECT_THROW(static_cast<void>(play(other)), std::runtime_error);
}

}  // namespace
}  // namespace stator::replay

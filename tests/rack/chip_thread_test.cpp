// Firmware of one's own at the socket of a chip, as a program in C beside this one: the example
// "io_slave", from Init to Operational with process data, by our own master over UDP.

#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/child_process.hpp"
#include "ethercat/raw_frame.hpp"
#include "rack/text_log.hpp"
#include "source_paths.hpp"
#include "stator/bench/link_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/tmcm_3315/product.hpp"
#include "stator/link/ethernet/open_link.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/rack/observe/event_log.hpp"
#include "stator/rack/run/runner.hpp"
#include "stator_chip.h"

namespace stator::rack {
namespace {

using base::SimDuration;
using ethercat::AlState;
using ::testing::HasSubstr;

std::uint16_t free_port() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  EXPECT_TRUE(probe) << probe.error().text;
  return probe ? (*probe)->local_port() : std::uint16_t{0};
}

/// The rack of racks/tmc8461.toml on a UDP link and a socket of this test's own.
RackConfiguration chip_rack(ClockKind clock) {
  static int number = 0;
  RackConfiguration configuration =
      load_rack_file(std::string(STATOR_SOURCE_DIR) + "/racks/tmc8461.toml", devices::products());
  configuration.clock = clock;
  configuration.segments[0].link = {link::LinkKind::udp, "127.0.0.1", free_port()};
  configuration.segments[0].devices[0].host_link = "unix:" + ::testing::TempDir() +
                                                   "/stator-rack-" + std::to_string(::getpid()) +
                                                   "-" + std::to_string(++number);
  return configuration;
}

/// A running rack with a master.
struct Plant {
  explicit Plant(ClockKind clock = ClockKind::real)
      : configuration(chip_rack(clock)),
        rack(configuration, log),
        runner(rack, configuration, tests::no_log()) {
    runner.start();
    auto opened = link::open_link(configuration.segments[0].link, link::LinkEnd::master, {});
    EXPECT_TRUE(opened) << opened.error().text;
    cable = std::move(*opened);
    port.emplace(*cable);
    master.emplace(*port);
  }
  ~Plant() { runner.stop(); }
  [[nodiscard]] std::string socket() { return runner.chip(0).name(); }

  RackConfiguration configuration;
  EventLog log;
  Rack rack;
  Runner runner;
  std::unique_ptr<link::EthernetLink> cable;
  std::optional<bench::LinkPort> port;
  std::optional<master::Master> master;
};

/// The example as a program of its own.
class IoSlave {
 public:
  explicit IoSlave(const std::string& address)
      : process_(tests::ChildProcess::run({STATOR_IO_SLAVE, address})) {}
  ~IoSlave() {
    process_.signal(SIGTERM);
    process_.wait();
  }
  IoSlave(const IoSlave&) = delete;
  IoSlave& operator=(const IoSlave&) = delete;

 private:
  tests::ChildProcess process_;
};

void wait_for_program(Plant& plant) {
  const std::uint64_t enough = plant.runner.chip(0).statistics().requests + 5;
  for (int i = 0; i < 500 && plant.runner.chip(0).statistics().requests < enough; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void bring_io_slave_to_operational(Plant& plant) {
  const IoSlave slave(plant.socket());
  wait_for_program(plant);
  master::Master& master = *plant.master;
  ASSERT_TRUE(master.scan());
  ASSERT_EQ(master.slaves().size(), 1U);
  const auto configured = master.configure_process_data();
  ASSERT_TRUE(configured) << configured.error().text;
  const auto operational = master.go_operational();
  ASSERT_TRUE(operational) << operational.error().text;
  ASSERT_EQ(master.outputs(0).size(), 4U);
  ASSERT_EQ(master.inputs(0).size(), 4U);
  int answered = 0;
  for (unsigned cycle = 1; cycle < 2000 && answered < 50; ++cycle) {
    master.outputs(0)[0] = static_cast<std::byte>(cycle);
    master.outputs(0)[1] = static_cast<std::byte>(cycle * 3);
    ASSERT_TRUE(master.run_cycle());
    const auto inputs = master.inputs(0);
    if (inputs[0] != std::byte{0} &&
        inputs[1] == static_cast<std::byte>(std::to_integer<unsigned>(inputs[0]) * 3)) {
      ++answered;
    }
  }
  EXPECT_EQ(answered, 50) << "outputs come back as inputs, both bytes of one frame";
  EXPECT_NE(master.inputs(0)[2], std::byte{0}) << "frames are counted";
}

TEST(FirmwareOnASocket, ExampleReachesOperationalWithProcessData) {
  Plant plant;
  bring_io_slave_to_operational(plant);
}

TEST(FirmwareOnASocket, InLockstepToo) {
  Plant plant(ClockKind::lockstep);
  bring_io_slave_to_operational(plant);
}

TEST(FirmwareOnASocket, ExampleStartedAnewTakesTheMasterBackToInit) {
  Plant plant;
  bring_io_slave_to_operational(plant);
  master::Master& master = *plant.master;
  const auto left = master.al_status(0);
  ASSERT_TRUE(left);
  EXPECT_EQ(left->state, AlState::operational) << "nobody is there to change it";
  {
    const IoSlave slave(plant.socket());
    AlState state = left->state;
    for (int i = 0; i < 500 && state != AlState::init; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      const auto status = master.al_status(0);
      ASSERT_TRUE(status);
      state = status->state;
    }
    EXPECT_EQ(state, AlState::init);
    const auto exchanged = master.exchange_process_data();
    ASSERT_FALSE(exchanged) << "process data must not pass for those of a live program";
    EXPECT_EQ(exchanged.error().code, master::ErrorCode::working_counter);
  }
  bring_io_slave_to_operational(plant);
}

/// The client library against the real socket.
class Client : public ::testing::Test {
 protected:
  Client() {
    std::array<char, 320> error{};
    chip = stator_chip_open(plant.socket().c_str(), error.data(), error.size());
    EXPECT_NE(chip, nullptr) << error.data();
  }
  ~Client() override { stator_chip_close(chip); }

  Plant plant;
  stator_chip* chip = nullptr;
};

TEST_F(Client, ReadsAndWritesOverSpi) {
  EXPECT_STREQ(stator_chip_name(chip), "chip");
  const std::array<std::uint8_t, 5> identify{0x00, 0x03, 0xFF, 0x00, 0xFF};
  std::array<std::uint8_t, 5> answer{};
  ASSERT_EQ(stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, identify.data(), answer.data(), 5), 5);
  EXPECT_THAT(answer, ::testing::ElementsAre(0, 0, 0, 0xD0, 0x61));
  EXPECT_EQ(stator_chip_spi_transfer(chip, STATOR_CHIP_MFC, nullptr, nullptr, 2), 2);
  EXPECT_EQ(stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, nullptr, nullptr, 4097),
            STATOR_CHIP_MISUSE);
  EXPECT_EQ(stator_chip_spi_transfer(chip, 5, nullptr, nullptr, 2), STATOR_CHIP_REFUSED);
  EXPECT_THAT(stator_chip_error(chip), HasSubstr("SPI port 0 is the PDI"));
  EXPECT_EQ(stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, nullptr, nullptr, 4096), 4096);
}

TEST_F(Client, PieceByPieceIsOneDatagram) {
  const std::array<std::uint8_t, 2> header{0x00, 0x02};
  const std::uint8_t more = 0x00;
  const std::uint8_t last = 0xFF;
  std::array<std::uint8_t, 2> answer{};
  stator_chip_spi_piece(chip, STATOR_CHIP_PDI, header.data(), nullptr, 2, 1);
  stator_chip_spi_piece(chip, STATOR_CHIP_PDI, &more, answer.data(), 1, 1);
  stator_chip_spi_piece(chip, STATOR_CHIP_PDI, &last, &answer[1], 1, 0);
  EXPECT_THAT(answer, ::testing::ElementsAre(0xD0, 0x61));
}

TEST_F(Client, ReadPauseIsTold) {
  const std::array<std::uint8_t, 3> read{0x00, 0x02, 0xFF};
  const std::array<std::uint8_t, 4> errors{0x18, 0x6B, 0xFF, 0xFF};
  std::array<std::uint8_t, 4> answer{};
  stator_chip_set_read_pause(chip, 100);
  stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, read.data(), nullptr, 3);
  stator_chip_set_read_pause(chip, -1);
  stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, read.data(), nullptr, 3);
  stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, errors.data(), answer.data(), 4);
  EXPECT_EQ(answer[3], 1U);
}

TEST_F(Client, MastersRequestRaisesTheInterruptAndPowerFalls) {
  ASSERT_EQ(stator_chip_watch(chip, STATOR_LINE_IRQ | STATOR_LINE_POWER), 0);
  // Nobody answers the request, so this is no master but a frame: Pre-Operational into AL control.
  ethercat::testing::RawFrame frame;
  frame.append(ethercat::Command::apwr, ethercat::physical_address(0, 0x0120),
               {std::byte{2}, std::byte{0}});
  ASSERT_TRUE(plant.cable->send(frame.finish()));
  const std::array<std::uint8_t, 3> nop{0, 6, 0};
  stator_chip_spi_transfer(chip, STATOR_CHIP_PDI, nop.data(), nullptr, 3);
  stator_chip_event event{};
  ASSERT_EQ(stator_chip_wait_event(chip, &event, 5000), 1);
  EXPECT_NE(event.rose & STATOR_LINE_IRQ, 0U);
  while (stator_chip_wait_event(chip, &event, 0) == 1) {
  }
  ASSERT_EQ(stator_chip_power(chip, 0), 0);
  ASSERT_EQ(stator_chip_wait_event(chip, &event, 5000), 1);
  EXPECT_NE(event.fell & STATOR_LINE_POWER, 0U);
  std::uint16_t levels = 0xFFFF;
  ASSERT_EQ(stator_chip_levels(chip, &levels), 0);
  EXPECT_EQ(levels, 0U);
  ASSERT_EQ(stator_chip_power(chip, 1), 0);
  ASSERT_EQ(stator_chip_levels(chip, &levels), 0);
  EXPECT_NE(levels & STATOR_LINE_PROM_INIT, 0);
  EXPECT_EQ(levels & STATOR_LINE_IRQ, 0) << "it has forgotten the request";
}

TEST_F(Client, WaitingEndsWhenItsTimeIsUp) {
  stator_chip_event event{};
  EXPECT_EQ(stator_chip_wait_event(chip, &event, 0), 0);
  EXPECT_EQ(stator_chip_wait_event(chip, &event, 20), 0);
}

TEST_F(Client, ResetIsALowPulse) {
  EXPECT_EQ(stator_chip_watch(chip, STATOR_LINE_PROM_INIT), 0);
  EXPECT_EQ(stator_chip_reset(chip), 0);
  stator_chip_event event{};
  ASSERT_EQ(stator_chip_wait_event(chip, &event, 5000), 1);
  EXPECT_NE(event.fell & STATOR_LINE_PROM_INIT, 0);
  EXPECT_EQ(stator_chip_set_pin(chip, 9, 1), STATOR_CHIP_REFUSED);
}

TEST_F(Client, SecondOneIsToldThatTheChipIsTaken) {
  std::array<char, 320> error{};
  EXPECT_EQ(stator_chip_open(plant.socket().c_str(), error.data(), error.size()), nullptr);
  EXPECT_THAT(error.data(), HasSubstr("another program has this chip"));
}

TEST(ChipClient, WrongAddressesAreExplained) {
  std::array<char, 320> error{};
  EXPECT_EQ(stator_chip_open("spidev0.0", error.data(), error.size()), nullptr);
  EXPECT_THAT(error.data(), HasSubstr("unix:PATH or tcp:HOST:PORT"));
  EXPECT_EQ(stator_chip_open("unix:/nonexistent/chip", error.data(), error.size()), nullptr);
  EXPECT_THAT(error.data(), HasSubstr("No such file"));
}

TEST(ChipThread, DeviceWithFirmwareOfItsOwnHasNoSocket) {
  RackConfiguration configuration = chip_rack(ClockKind::real);
  configuration.segments[0].devices[0].setup = devices::tmcm_3315_product()->defaults();
  EventLog log;
  Rack rack(configuration, log);
  try {
    const Runner runner(rack, configuration, tests::no_log());
    FAIL() << "opened a socket";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("has its own firmware"));
  }
}

}  // namespace
}  // namespace stator::rack

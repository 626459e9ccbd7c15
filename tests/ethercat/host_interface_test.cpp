// When a slave controller is dead to its host: without a loaded EEPROM, or with one that names
// another host interface; and how a master brings it back.

#include <array>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ethercat/stack_fixture.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_ms;
using ::testing::AllOf;
using testing::Bytes;
using testing::bytes;
using ::testing::HasSubstr;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::valid_sii;

Bytes with_type(unsigned type, unsigned configuration = 0) {
  Bytes image = valid_sii();
  image[0] = static_cast<std::byte>(type);
  image[1] = static_cast<std::byte>(configuration);
  image[14] = std::byte{sii_checksum(image)};
  return image;
}
Bytes damaged() {
  Bytes image = valid_sii();
  image[14] ^= std::byte{0xFF};
  return image;
}

class HostInterface : public ::testing::Test {
 protected:
  HostInterface() { slave.set_event_reporter(base::EventReporter(&log, 0)); }

  unsigned bus_read(std::uint16_t address, std::size_t length = 2) {
    return static_cast<unsigned>(number(bus.read(0, address, length).data));
  }
  unsigned bus_write(std::uint16_t address, const Bytes& data) {
    return bus.write(0, address, data).working_counter;
  }
  /// As eepromtool does, then the command that loads the configuration area.
  void write_word(unsigned word, unsigned value) {
    bus_write(0x0502, bytes({0x81, 0x02, word, 0, 0, 0, value & 0xFFU, value >> 8U}));
    bus.wait(1_ms);
  }
  void reload() {
    bus_write(0x0502, bytes({0x00, 0x04, 0, 0, 0, 0}));
    bus.wait(2_ms);
  }
  void expect_dead() {
    EXPECT_FALSE(slave.answers());
    EXPECT_EQ(number(host_read(slave, 0x0000, 4)), 0U) << "reads give nothing";
    host_write(slave, 0x0134, bytes({0x11, 0x00}));
    host_write(slave, 0x0130, bytes({0x02, 0x00}));
    EXPECT_EQ(bus_read(0x0130), 0x0001U) << "writes do nothing";
    EXPECT_EQ(bus_read(0x0134), 0U);
    EXPECT_EQ(slave.al_event_request(), 0U);
    EXPECT_FALSE(slave.host_interrupt());
  }

  TestBus bus;
  SlaveController& slave = bus.slave();
  test::EventLog log;
};

TEST_F(HostInterface, IsDeadWithoutAValidEepromAndNobodyAnswersAlControl) {
  slave.load_sii(damaged());
  expect_dead();
  EXPECT_EQ(bus_write(0x0120, bytes({0x02, 0x00})), 1U) << "the register takes the first request";
  expect_dead();
  EXPECT_EQ(bus_write(0x0120, bytes({0x02, 0x00})), 0U) << "which nobody has read";
  EXPECT_EQ(bus_read(0x0110) & 3U, 0U) << "PDI not operational, its watchdog not served";
  EXPECT_EQ(bus_read(0x014E), 0U) << "not configured";
}

TEST_F(HostInterface, IsDeadWithABlankEepromAndWithoutAny) {
  for (const Bytes& image : {Bytes(2048, std::byte{0xFF}), Bytes(2048), Bytes()}) {
    slave.load_sii(image);
    expect_dead();
    EXPECT_EQ(bus_read(0x0110) & 1U, 0U);
  }
}

TEST_F(HostInterface, IsDeadWithAnotherTypeThanTheOneThatIsBuilt) {
  for (const unsigned type : {0x00U, 0x04U, 0x08U, 0x80U}) {
    slave.load_sii(with_type(type));
    expect_dead();
    EXPECT_EQ(bus_read(0x0140, 1), type);
    EXPECT_EQ(bus_read(0x014E, 1), 0x0AU) << "configured and invalid";
    EXPECT_EQ(bus_read(0x0110) & 3U, 1U) << "the EEPROM is loaded, the host's watchdog not served";
    EXPECT_EQ(bus_write(0x1000, bytes({1})), 1U) << "so the bus reaches process memory";
  }
}

TEST_F(HostInterface, MasterWritesTheEepromAndReloadsIt) {
  slave.load_sii(damaged());
  bus_write(0x0120, bytes({0x02, 0x00}));
  write_word(7, std::to_integer<unsigned>(valid_sii()[14]));
  expect_dead();
  reload();
  EXPECT_TRUE(slave.answers());
  EXPECT_EQ(bus_read(0x0110) & 3U, 3U);
  EXPECT_EQ(number(host_read(slave, 0x0000, 1)), 0xD0U);
  EXPECT_EQ(slave.al_event_request() & al_event::kAlControl, al_event::kAlControl)
      << "the request still waits";
  EXPECT_EQ(number(host_read(slave, 0x0120, 2)), 0x02U);
}

TEST_F(HostInterface, MasterWritesTheEepromAndResetsTheController) {
  slave.load_sii(with_type(0x08));
  write_word(0, 0x0005);
  write_word(7, sii_checksum(slave.sii()));
  expect_dead();
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    bus_write(0x0040, bytes({key}));
  }
  EXPECT_TRUE(slave.answers());
  host_write(slave, 0x0130, bytes({0x02, 0x00}));
  EXPECT_EQ(bus_read(0x0130), 0x02U);
}

TEST_F(HostInterface, PowerThatReturnsLoadsWhatWasWritten) {
  slave.load_sii(damaged());
  bus.segment().set_power(0, false);
  bus.segment().set_power(0, true);
  expect_dead();
  write_word(7, std::to_integer<unsigned>(valid_sii()[14]));
  bus.segment().set_power(0, false);
  bus.segment().set_power(0, true);
  EXPECT_TRUE(slave.answers());
}

TEST_F(HostInterface, AReloadThatFailsClosesItWhileItRuns) {
  host_write(slave, 0x0130, bytes({0x08, 0x00}));
  write_word(7, 0);
  reload();
  EXPECT_FALSE(slave.answers());
  EXPECT_EQ(number(host_read(slave, 0x0000, 1)), 0U);
  EXPECT_EQ(bus_read(0x0130), 0x08U) << "AL status stays as the host left it";
}

TEST_F(HostInterface, OneLineAtTheLoadSaysWhyItIsClosedAndWhatToDo) {
  slave.load_sii(damaged());
  ASSERT_EQ(log.events.size(), 1U);
  EXPECT_THAT(log.sentences()[0], AllOf(HasSubstr("EEPROM not loaded"), HasSubstr("word 7"),
                                        HasSubstr("writes a valid image and reloads it")));
  slave.load_sii({});
  ASSERT_EQ(log.events.size(), 2U);
  EXPECT_THAT(log.sentences()[1], HasSubstr("none answers"));
  slave.load_sii(with_type(0x08));
  ASSERT_EQ(log.events.size(), 3U);
  EXPECT_THAT(log.sentences()[2],
              AllOf(HasSubstr("type 08h"), HasSubstr("only 05h (SPI slave) is built")));
  slave.load_sii(valid_sii());
  EXPECT_EQ(log.events.size(), 3U);
}

// A coupler needs no host.
TEST_F(HostInterface, NoneOnPurposeIsNotWorthALine) {
  slave.load_sii(with_type(0x00, 0x01));
  EXPECT_TRUE(log.events.empty()) << log.sentences().front();
  EXPECT_EQ(bus_write(0x0120, bytes({0x08, 0x00})), 1U);
  EXPECT_EQ(bus_read(0x0130), 0x08U);
}

TEST_F(HostInterface, EachRequestThatNobodyAnswersHasOneLineWithItsReason) {
  slave.load_sii(damaged());
  log.events.clear();
  for (const unsigned request : {0x02U, 0x04U, 0x01U}) {
    bus_write(0x0120, bytes({request, 0x00}));
  }
  ASSERT_EQ(log.events.size(), 3U);
  for (const std::string& sentence : log.sentences()) {
    EXPECT_THAT(sentence,
                AllOf(HasSubstr("stays unanswered: the host interface is closed"),
                      HasSubstr("its EEPROM is not loaded"), HasSubstr("write a valid image")));
  }
  slave.load_sii(with_type(0x08));
  log.events.clear();
  bus_write(0x0120, bytes({0x02, 0x00}));
  ASSERT_EQ(log.events.size(), 1U);
  EXPECT_THAT(log.sentences()[0], HasSubstr("names another one than SPI"));
}

TEST_F(HostInterface, ThatNothingHasEverUsedSaysThatThereIsNoFirmware) {
  bus_write(0x0120, bytes({0x02, 0x00}));
  bus_write(0x0120, bytes({0x02, 0x00}));
  ASSERT_EQ(log.events.size(), 2U);
  for (const std::string& sentence : log.sentences()) {
    EXPECT_THAT(sentence, AllOf(HasSubstr("AL control 0002h stays unanswered"),
                                HasSubstr("no firmware is attached"),
                                HasSubstr("\"device_emulation = true\""), HasSubstr("\"spi\"")));
  }
  log.events.clear();
  host_read(slave, 0x0120, 2);
  bus_write(0x0120, bytes({0x02, 0x00}));
  EXPECT_TRUE(log.events.empty()) << "it has come, and will answer";
  bus_write(0x0120, bytes({0x04, 0x00}));
  ASSERT_EQ(log.events.size(), 1U);
  EXPECT_THAT(log.sentences()[0], HasSubstr("the host has not read the request before"));
}

TEST_F(HostInterface, InDeviceEmulationStatesAreToldAsThoseOfAStack) {
  slave.load_sii(with_type(0x05, 0x01));
  for (const unsigned request : {0x11U, 0x02U, 0x02U, 0x04U, 0x08U, 0x01U}) {
    bus_write(0x0120, bytes({request, 0x00}));
  }
  EXPECT_THAT(log.sentences(), ::testing::ElementsAre("state Init -> Pre-Operational",
                                                      "state Pre-Operational -> Safe-Operational",
                                                      "state Safe-Operational -> Operational",
                                                      "state Operational -> Init"));
}

}  // namespace
}  // namespace stator::ethercat

// The SPI slave protocol byte for byte: the vectors of the TMC8461's document and those that follow
// from its rules, at the process data interface and on memory that records its accesses.

#include "stator/ethercat/controller/spi_slave_port.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"
#include "stator/base/random.hpp"
#include "stator/ethercat/controller/controller_spi_memory.hpp"
#include "stator/ethercat/units/sii_interface.hpp"

namespace stator::ethercat {
namespace {

using base::SimDuration;
using base::SimTime;
using ::testing::ElementsAre;

using Bytes = std::vector<std::byte>;

Bytes bytes(std::initializer_list<unsigned> values) {
  Bytes result;
  for (const unsigned value : values) {
    result.push_back(static_cast<std::byte>(value));
  }
  return result;
}

std::vector<unsigned> numbers(const Bytes& values) {
  std::vector<unsigned> result;
  for (const std::byte value : values) {
    result.push_back(std::to_integer<unsigned>(value));
  }
  return result;
}

/// 64 KB of memory that keeps what was done with it.
class RecordingMemory final : public SpiSlaveMemory {
 public:
  struct Access {
    char kind;  ///< r, w or n
    std::uint16_t address;
    std::size_t length;
    friend bool operator==(const Access&, const Access&) = default;
  };

  [[nodiscard]] bool operational() const override { return open; }
  [[nodiscard]] std::array<std::byte, 3> header_reply() const override {
    return {std::byte{0x0E}, std::byte{0x1E}, std::byte{0x2E}};
  }
  void touch() override { accesses.push_back({'n', 0, 0}); }
  void read(std::uint16_t address, std::span<std::byte> out) override {
    accesses.push_back({'r', address, out.size()});
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = content[address + i];
    }
  }
  void write(std::uint16_t address, std::span<const std::byte> data) override {
    accesses.push_back({'w', address, data.size()});
    for (std::size_t i = 0; i < data.size(); ++i) {
      content[address + i] = data[i];
    }
  }
  void count_error(std::uint8_t code) override { errors.push_back(code); }

  Bytes content = Bytes(0x10000);
  bool open = true;
  std::vector<Access> accesses;
  std::vector<unsigned> errors;
};

class SpiProtocol : public ::testing::Test {
 protected:
  std::vector<unsigned> exchange(std::initializer_list<unsigned> mosi,
                                 const SpiTiming& timing = {}) {
    const Bytes out = bytes(mosi);
    Bytes in(out.size(), std::byte{0xAA});
    port.exchange(out, in, timing);
    return numbers(in);
  }
  std::vector<unsigned> transfer(std::initializer_list<unsigned> mosi) {
    const Bytes out = bytes(mosi);
    Bytes in(out.size(), std::byte{0xAA});
    port.transfer(out, in);
    return numbers(in);
  }

  RecordingMemory memory;
  SpiSlavePort port{memory};
};

TEST_F(SpiProtocol, ShortHeaderReachesTheLowestEightKilobytes) {
  memory.content[0x1FFF] = std::byte{0x5A};
  EXPECT_THAT(exchange({0xFF, 0xFB, 0xFF, 0xFF}), ElementsAre(0x0E, 0x1E, 0, 0x5A));
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'r', 0x1FFF, 1}));
}

TEST_F(SpiProtocol, LongHeaderReachesEveryAddress) {
  for (unsigned address = 0; address < 0x10000; address += 0x0123) {
    memory.accesses.clear();
    memory.content[address] = static_cast<std::byte>(address * 7);
    const auto reply = exchange({address >> 5U & 0xFFU, (address & 0x1FU) << 3U | 6U,
                                 (address >> 13U) << 5U | 3U << 2U, 0xFF, 0xFF});
    ASSERT_THAT(reply, ElementsAre(0x0E, 0x1E, 0x2E, 0, address * 7 & 0xFFU)) << address;
    ASSERT_EQ(memory.accesses.size(), 1U);
  }
  EXPECT_TRUE(memory.errors.empty());
}

TEST_F(SpiProtocol, RepeatedThirdBytesPadTheHeader) {
  exchange({0x10, 0x06, 0x58, 0x58, 0x58, 0x50, 0x4C, 0x48});
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'w', 0x4200, 2}));
  EXPECT_EQ(memory.content[0x4200], std::byte{0x4C});
  EXPECT_EQ(memory.content[0x4201], std::byte{0x48});
}

TEST_F(SpiProtocol, OnlyTheFirstThirdByteIsAnsweredByAnEvent) {
  EXPECT_THAT(exchange({0x10, 0x06, 0x58, 0x58, 0x50}), ElementsAre(0x0E, 0x1E, 0x2E, 0, 0));
}

TEST_F(SpiProtocol, NopTouchesNothingAndIgnoresWhatFollows) {
  EXPECT_THAT(exchange({0, 0, 0x12, 0x34}), ElementsAre(0x0E, 0x1E, 0, 0));
  EXPECT_THAT(exchange({0, 6, 0}), ElementsAre(0x0E, 0x1E, 0x2E));
  EXPECT_THAT(memory.accesses,
              ElementsAre(RecordingMemory::Access{'n', 0, 0}, RecordingMemory::Access{'n', 0, 0}));
  EXPECT_TRUE(memory.errors.empty());
}

TEST_F(SpiProtocol, ReservedCommandsDoNothingAndCountAnError) {
  for (const unsigned command : {1U, 5U, 7U}) {
    memory.errors.clear();
    exchange({0x08, command, 0x12, 0xFF});
    EXPECT_TRUE(memory.accesses.empty()) << command;
    EXPECT_THAT(memory.errors, ElementsAre(command >> 1U << 6U)) << command;
  }
}

TEST_F(SpiProtocol, WholeDatagramIsOneAccess) {
  exchange({0x80, 0x03, 0xFF, 0, 0, 0, 0xFF});
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'r', 0x1000, 4}));
}

TEST_F(SpiProtocol, DatagramInPiecesWalksOnWhileChipSelectLasts) {
  for (unsigned i = 0; i < 4; ++i) {
    memory.content[0x1000 + i] = static_cast<std::byte>(0x41 + i);
  }
  port.select();
  EXPECT_THAT(transfer({0x80}), ElementsAre(0x0E));
  EXPECT_THAT(transfer({0x03, 0xFF}), ElementsAre(0x1E, 0));
  EXPECT_THAT(transfer({0, 0}), ElementsAre(0x41, 0x42));
  EXPECT_THAT(transfer({0, 0xFF}), ElementsAre(0x43, 0x44));
  port.deselect();
  EXPECT_TRUE(memory.errors.empty());
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'r', 0x1000, 2},
                                           RecordingMemory::Access{'r', 0x1002, 2}));
}

TEST_F(SpiProtocol, AddressesWrapAfterTheHighestOne) {
  memory.content[0xFFFF] = std::byte{0x11};
  memory.content[0x0000] = std::byte{0x22};
  EXPECT_THAT(exchange({0xFF, 0xFE, 0xEC, 0xFF, 0, 0xFF}),
              ElementsAre(0x0E, 0x1E, 0x2E, 0, 0x11, 0x22));
}

TEST_F(SpiProtocol, MissingTerminationIsAnError) {
  EXPECT_THAT(exchange({0x09, 0x02, 0, 0}), ElementsAre(0x0E, 0x1E, 0, 0));
  EXPECT_THAT(memory.errors, ElementsAre(0x50));
}

TEST_F(SpiProtocol, ReadWithoutAnyDataIsNotTerminatedEither) {
  exchange({0x09, 0x02});
  exchange({0x09, 0x03});
  EXPECT_THAT(memory.errors, ElementsAre(0x50, 0x50));
  EXPECT_TRUE(memory.accesses.empty());
}

TEST_F(SpiProtocol, BytesAfterTheTerminationAreNotRead) {
  memory.content[0x0120] = std::byte{0x11};
  memory.content[0x0121] = std::byte{0x22};
  EXPECT_THAT(exchange({0x09, 0x02, 0xFF, 0x00}), ElementsAre(0x0E, 0x1E, 0x11, 0));
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'r', 0x0120, 1}));
  EXPECT_THAT(memory.errors, ElementsAre(0x60));
}

TEST_F(SpiProtocol, DataTooSoonAfterTheHeaderAreABusyViolation) {
  memory.content[0x0120] = std::byte{0x11};
  EXPECT_THAT(exchange({0x09, 0x02, 0xFF}, {.read_pause = SimDuration(239)}),
              ElementsAre(0x0E, 0x1E, 0));
  EXPECT_THAT(memory.errors, ElementsAre(0x48));
  EXPECT_THAT(exchange({0x09, 0x02, 0xFF}, {.read_pause = SimDuration(240)}),
              ElementsAre(0x0E, 0x1E, 0x11));
  EXPECT_EQ(memory.errors.size(), 1U);
}

TEST_F(SpiProtocol, WaitStateAndSilenceOnTimingLeaveEnoughTime) {
  exchange({0x09, 0x03, 0xFF, 0xFF}, {.read_pause = SimDuration(0)});
  exchange({0x09, 0x02, 0xFF});
  EXPECT_TRUE(memory.errors.empty());
}

TEST_F(SpiProtocol, SurplusClocksAreCountedModuloEight) {
  exchange({0x09, 0x04, 0x12}, {.surplus_clocks = 3});
  EXPECT_THAT(memory.errors, ElementsAre(0x83));
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'w', 0x0120, 1}));
}

TEST_F(SpiProtocol, OneDatagramCountsOneErrorWithAllItsCauses) {
  exchange({0x09, 0x02, 0, 0xFF, 0}, {.read_pause = SimDuration(0), .surplus_clocks = 5});
  EXPECT_THAT(memory.errors, ElementsAre(0x6D));
}

TEST_F(SpiProtocol, WithoutChipSelectNothingHappens) {
  EXPECT_THAT(transfer({0x09, 0x04, 0x12}), ElementsAre(0, 0, 0));
  port.deselect(3);
  EXPECT_TRUE(memory.accesses.empty());
  EXPECT_TRUE(memory.errors.empty());
}

TEST_F(SpiProtocol, ChipSelectAnewForgetsTheDatagramBefore) {
  port.select();
  transfer({0x09, 0x04});
  port.select();
  transfer({0x80, 0x04, 0x12});
  port.deselect();
  EXPECT_THAT(memory.accesses, ElementsAre(RecordingMemory::Access{'w', 0x1000, 1}));
}

TEST_F(SpiProtocol, ClosedInterfaceAnswersNothing) {
  memory.open = false;
  EXPECT_THAT(exchange({0x09, 0x02, 0, 0}), ElementsAre(0, 0, 0, 0));
  EXPECT_THAT(exchange({0x09, 0x04, 1}), ElementsAre(0, 0, 0));
  EXPECT_TRUE(memory.accesses.empty());
  EXPECT_TRUE(memory.errors.empty());
}

TEST_F(SpiProtocol, AnyBytesInAnyPiecesKeepWithinTheMemory) {
  base::Random random(8461);
  for (int round = 0; round < 2000; ++round) {
    port.select();
    std::size_t total = 0;
    for (std::uint64_t pieces = random.below(4); pieces > 0; --pieces) {
      Bytes out(random.below(12));
      for (std::byte& each : out) {
        each = static_cast<std::byte>(random.below(256));
      }
      Bytes in(out.size());
      port.transfer(out, in, SimDuration(static_cast<std::int64_t>(random.below(500))));
      total += out.size();
    }
    port.deselect(static_cast<unsigned>(random.below(8)));
    std::size_t accessed = 0;
    for (const RecordingMemory::Access& access : memory.accesses) {
      ASSERT_LE(std::size_t{access.address} + access.length, 0x10000U);
      accessed += access.length;
    }
    ASSERT_LE(accessed + (accessed != 0 ? 2 : 0), total);
    memory.accesses.clear();
  }
}

/// The EEPROM content of a chip with an SPI host interface.
Bytes eeprom(unsigned pdi_type = 0x05) {
  Bytes image(2048, std::byte{0});
  image[0] = static_cast<std::byte>(pdi_type);
  image[1] = std::byte{0x0C};
  image[2] = std::byte{0x03};
  image[14] = std::byte{sii_checksum(image)};
  image[0x80] = image[0x81] = std::byte{0xFF};
  return image;
}

class PdiSpi : public ::testing::Test {
 protected:
  PdiSpi() { controller().load_sii(eeprom()); }

  SlaveController& controller() { return bus.slave(); }
  std::vector<unsigned> exchange(std::initializer_list<unsigned> mosi,
                                 const SpiTiming& timing = {}) {
    const Bytes out = bytes(mosi);
    Bytes in(out.size());
    port.exchange(out, in, timing);
    return numbers(in);
  }
  unsigned at(std::uint16_t address) {
    std::array<std::byte, 1> value{};
    controller().peek(address, value);
    return std::to_integer<unsigned>(value[0]);
  }
  unsigned bus_read(std::uint16_t address) {
    return std::to_integer<unsigned>(bus.read(0, address, 1).data[0]);
  }
  void put(std::uint16_t address, std::initializer_list<unsigned> values) {
    controller().write(address, bytes(values));
  }
  /// The master writes to a register or to memory.
  bool bus_write(std::uint16_t address, std::initializer_list<unsigned> values) {
    return bus.write(0, address, bytes(values)).working_counter == 1;
  }

  stator::ethercat::testing::TestBus bus{1, stator::ethercat::testing::controller_of("tmc8461")};
  ControllerSpiMemory memory{controller()};
  SpiSlavePort port{memory};
};

// Vector PDI-1 (L1042).
TEST_F(PdiSpi, NopShowsTheEventRequest) {
  bus_write(0x0120, {0x08, 0});
  EXPECT_THAT(exchange({0, 0}), ElementsAre(0x01, 0x00));
  EXPECT_THAT(exchange({0, 6, 0}), ElementsAre(0x01, 0x00, 0x00));
}

// Vector PDI-2 (L1058), with what follows from L3240-L3257.
TEST_F(PdiSpi, ReadOfAlControlAnswersAndAcknowledges) {
  bus_write(0x0120, {0x08, 0});
  EXPECT_FALSE(bus_write(0x0120, {0x04, 0})) << "locked";
  EXPECT_THAT(exchange({0x09, 0x02, 0x00, 0xFF}), ElementsAre(0x01, 0x00, 0x08, 0x00));
  EXPECT_THAT(exchange({0, 0}), ElementsAre(0, 0)) << "acknowledged";
  EXPECT_TRUE(bus_write(0x0120, {0x04, 0}));
  EXPECT_EQ(at(0x030D), 0U);
}

// Vector PDI-3 (L1067).
TEST_F(PdiSpi, ReadWithWaitStateByLongAddress) {
  put(0x3400, {0x44, 0x41, 0x54, 0x41});
  EXPECT_THAT(exchange({0xA0, 0x06, 0x2C, 0xFF, 0x00, 0x00, 0x00, 0xFF}),
              ElementsAre(0, 0, 0, 0, 0x44, 0x41, 0x54, 0x41));
}

// Vectors PDI-4 and PDI-5 (L1078, L1097).
TEST_F(PdiSpi, WriteByLongAddressPlainAndPadded) {
  exchange({0x10, 0x06, 0x50, 0x4C, 0x48});
  EXPECT_EQ(at(0x4200), 0x4CU);
  EXPECT_EQ(at(0x4201), 0x48U);
  put(0x4200, {0, 0});
  exchange({0x10, 0x06, 0x58, 0x58, 0x58, 0x50, 0x4C, 0x48});
  EXPECT_EQ(at(0x4200), 0x4CU);
  EXPECT_EQ(at(0x4201), 0x48U);
  EXPECT_EQ(at(0x030D), 0U);
}

// Vectors PDI-6 to PDI-8, which follow from the rules.
TEST_F(PdiSpi, EventRequestIsInTheHeaderAndAtItsAddress) {
  bus_write(0x0120, {0x08, 0});
  EXPECT_THAT(exchange({0x11, 0x02, 0xFF}), ElementsAre(0x01, 0x00, 0x01));
  EXPECT_THAT(exchange({0x09, 0x03, 0xFF, 0x00, 0xFF}), ElementsAre(0x01, 0x00, 0, 0x08, 0x00));
}

TEST_F(PdiSpi, EventBytesAreThoseOfAllThreeRegisterBytes) {
  // Sync managers 0 and 7 are buffers the master fills, with an interrupt for the host.
  for (const unsigned channel : {0U, 7U}) {
    const unsigned start = 0x1000U + 0x100U * channel;
    bus_write(static_cast<std::uint16_t>(0x0800U + 8U * channel),
              {0, start >> 8U, 2, 0, 0x24, 0, 1, 0});
  }
  exchange({0x40, 0x32, 0xFF});  // the sync managers' activation is seen
  EXPECT_TRUE(bus_write(0x1000, {1, 1}));
  EXPECT_TRUE(bus_write(0x1700, {1, 1}));
  EXPECT_THAT(exchange({0, 6, 0}), ElementsAre(0x10, 0x81, 0x00))
      << "sync manager 7 was switched on and that has not been seen";
}

// Vector PDI-9 (L1051, L4006).
TEST_F(PdiSpi, MissingTerminationIsCountedWithItsCommand) {
  exchange({0x09, 0x02, 0x00, 0x00});
  EXPECT_EQ(at(0x030D), 1U);
  EXPECT_EQ(at(0x030E), 0x50U);
  bus_write(0x030D, {0});
  EXPECT_EQ(at(0x030D), 0U);
  EXPECT_EQ(at(0x030E), 0U);
}

TEST_F(PdiSpi, EveryErrorHasItsBitAndTheLastOneIsKept) {
  exchange({0x09, 0x02, 0xFF, 0xFF});
  EXPECT_EQ(at(0x030E), 0x60U);
  exchange({0x09, 0x04, 0x00}, {.surplus_clocks = 7});
  EXPECT_EQ(at(0x030E), 0x87U);
  exchange({0x09, 0x02, 0xFF}, {.read_pause = SimDuration(100)});
  EXPECT_EQ(at(0x030E), 0x48U);
  EXPECT_EQ(at(0x030D), 3U);
  for (int i = 0; i < 300; ++i) {
    exchange({0x09, 0x07});
  }
  EXPECT_EQ(at(0x030D), 0xFFU) << "counting stops there";
  EXPECT_EQ(at(0x030E), 0xC0U);
}

TEST_F(PdiSpi, EveryDatagramRestartsTheWatchdog) {
  controller().set_host_polling(false);
  const auto expired = [this] { return (at(0x0110) & 2U) == 0; };
  SimTime now;
  const auto pass = [&](std::int64_t milliseconds) {
    now += SimDuration(milliseconds * 1'000'000);
    controller().advance(now);
  };
  pass(99);
  EXPECT_FALSE(expired());
  exchange({0, 0});
  pass(99);
  EXPECT_FALSE(expired()) << "a NOP counts";
  exchange({0x09, 0x03, 0xFF, 0xFF});
  pass(99);
  EXPECT_FALSE(expired());
  exchange({0x80, 0x04, 0});
  pass(99);
  EXPECT_FALSE(expired());
  pass(2);
  EXPECT_TRUE(expired());
}

TEST_F(PdiSpi, IsSilentUntilTheEepromIsLoaded) {
  Bytes image = eeprom();
  image[14] ^= std::byte{1};
  controller().load_sii(image);
  EXPECT_THAT(exchange({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0)) << "type register";
  exchange({0x80, 0x04, 0x12});
  EXPECT_EQ(at(0x1000), 0U);
  controller().load_sii(eeprom());
  EXPECT_THAT(exchange({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0xD0));
}

TEST_F(PdiSpi, IsSilentWhenTheEepromNamesAnotherInterface) {
  controller().load_sii(eeprom(0x08));
  EXPECT_THAT(exchange({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0));
}

TEST_F(PdiSpi, BufferIsTakenAndReleasedByOneDatagram) {
  bus_write(0x0800, {0x00, 0x10, 4, 0, 0x24, 0, 1, 0});  // three buffers, the master writes
  bus_write(0x1000, {1, 2, 3, 4});
  EXPECT_THAT(exchange({0x80, 0x03, 0xFF, 0, 0, 0, 0xFF}), ElementsAre(0x10, 0x01, 0, 1, 2, 3, 4));
  EXPECT_EQ(exchange({0, 0})[1], 0U) << "the event went with the last byte";
}

// In pieces the datagram reads the same buffer to its end, whatever the master writes meanwhile.
TEST_F(PdiSpi, BufferReadInPiecesIsConsistent) {
  bus_write(0x0800, {0x00, 0x10, 4, 0, 0x24, 0, 1, 0});
  bus_write(0x1000, {1, 2, 3, 4});
  const Bytes head = bytes({0x80, 0x03, 0xFF, 0, 0});
  Bytes first(head.size());
  port.select();
  port.transfer(head, first);
  bus_write(0x1000, {5, 6, 7, 8});
  const Bytes tail = bytes({0, 0xFF});
  Bytes second(tail.size());
  port.transfer(tail, second);
  port.deselect();
  EXPECT_THAT(numbers(second), ElementsAre(3, 4));
  EXPECT_THAT(exchange({0x80, 0x03, 0xFF, 0, 0, 0, 0xFF})[3], 5U);
}

// L5753: bytes of a time read one after another in one access belong to one moment, and the
// acknowledgement of its latch comes once.
TEST_F(PdiSpi, LatchTimeOfEightBytesIsAcknowledgedByItsDatagram) {
  put(0x0204, {0x02, 0, 0, 0});
  bus_write(0x0980, {0x10});  // the host controls latch unit 0
  put(0x09A8, {0x01});        // one rising edge is kept
  controller().advance(SimTime() + SimDuration(1000));
  controller().set_latch_input(0, true);
  EXPECT_EQ(bus_read(0x09AE) & 1U, 1U);
  exchange({0x4D, 0x83, 0xFF, 0, 0, 0, 0, 0, 0, 0, 0xFF});  // 09B0h, 8 bytes
  EXPECT_EQ(bus_read(0x09AE) & 1U, 0U);
}

}  // namespace
}  // namespace stator::ethercat

// What EEPROMs on a board keep in a state directory.

#include "stator/rack/kept/board_memory.hpp"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/temporary_directory.hpp"
#include "board/bench.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"
#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/observe/event_log.hpp"

namespace stator::rack {
namespace {

using namespace base::literals;
using board::Bench;
using testing::AllOf;
using testing::HasSubstr;

board::PeripheralConfiguration spi_eeprom(const char* name = "eeprom") {
  return board::part(name, board::kSpiEeprom,
                     {{"sck", board::kSckLine},
                      {"mosi", board::kMosiLine},
                      {"miso", board::kMisoLine},
                      {"cs", board::kCsLine}});
}

/// A chip's board with a storage, as a process has them; destroying it is the orderly end.
struct Process {
  explicit Process(const std::string& directory) : bench({spi_eeprom()}), storage(directory) {
    log.set_device_names({"chip"});
    for (const board::KeptPart& part : bench.board.kept_parts()) {
      storage.add(std::make_unique<BoardMemory>(storage, "chip", "TMC8461-BA", part,
                                                base::EventReporter(&log, 0)));
    }
  }

  void write(unsigned word) {
    bench.spi(0x06, 8);
    bench.spi(0x02'1234'0000 | word, 40);
  }
  /// What is ordered ends, and the write time of the part too.
  void settle() {
    for (const StorageCompletion& each : storage.wait_for_completions(bench.board.time())) {
      storage.complete(each, bench.board.time());
    }
    bench.wait(5_ms);
  }
  [[nodiscard]] unsigned status() { return bench.spi(0x0500, 16) & 0xFFU; }
  [[nodiscard]] unsigned read() { return bench.spi(0x03'1234'0000, 40) & 0xFFFFU; }

  EventLog log;
  Bench bench;
  DeviceStorage storage;
};

struct BoardMemoryTest : testing::Test {
  [[nodiscard]] std::filesystem::path file() const {
    return std::filesystem::path(directory.path()) / "chip.eeprom.memory";
  }
  tests::TemporaryDirectory directory;
};

TEST_F(BoardMemoryTest, AnEepromOutlivesTheProcess) {
  {
    Process process(directory.path());
    process.write(0xCAFE);
    process.settle();
    EXPECT_TRUE(std::filesystem::exists(file())) << "before the end";
  }
  Process process(directory.path());
  EXPECT_EQ(process.read(), 0xCAFEU);
  EXPECT_EQ(process.log.count("storage-board-memory-restored"), 1U);
}

TEST_F(BoardMemoryTest, AnEepromThatWasNotBusyAnyMoreIsOnTheDisk) {
  Process process(directory.path());
  process.write(0xCAFE);
  process.bench.wait(1_s);
  EXPECT_EQ(process.status(), 0x01U) << "nobody has handed the end over";
  process.settle();
  EXPECT_EQ(process.status(), 0x00U);
  std::ifstream stored(file(), std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stored), {}};
  EXPECT_NE(bytes.find("\xCA\xFE"), std::string::npos);
}

TEST_F(BoardMemoryTest, AWriteThatFailsLeavesTheOldContentAndSaysSo) {
  Process process(directory.path());
  std::filesystem::create_directory(file());
  process.write(0xCAFE);
  process.settle();
  EXPECT_EQ(process.status(), 0x00U);
  EXPECT_EQ(process.read(), 0xFFFFU);
  EXPECT_EQ(process.log.count("storage-not-written"), 1U);
  std::filesystem::remove(file());
  process.write(0xBEEF);
  process.settle();
  EXPECT_EQ(process.read(), 0xBEEFU);
}

TEST_F(BoardMemoryTest, AFileOfAnotherSizeIsRefusedWithItsPath) {
  {
    Process process(directory.path());
    process.write(0xCAFE);
    process.settle();
  }
  Bench other({board::part("eeprom", board::kI2cEeprom,
                           {{"scl", board::kSclLine}, {"sda", board::kSdaLine}})});
  DeviceStorage storage(directory.path());
  try {
    const BoardMemory memory(storage, "chip", "TMC8461-BA", other.board.kept_parts().at(0), {});
    FAIL() << "was taken";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("chip.eeprom.memory"),
                                    HasSubstr("32769 bytes, its part \"eeprom\" has 8193")));
  }
}

TEST_F(BoardMemoryTest, PartsAndDevicesWithPointsInTheirNamesHaveFilesOfTheirOwn) {
  Bench bench({spi_eeprom("b.c")});
  Bench other({spi_eeprom("c")});
  DeviceStorage storage(directory.path());
  const board::KeptPart part = bench.board.kept_parts().at(0);
  storage.add(
      std::make_unique<BoardMemory>(storage, "a", "TMC8461-BA", part, base::EventReporter()));
  bench.spi(0x06, 8);
  bench.spi(0x02'0000'55, 32);
  static_cast<void>(storage.wait_for_completions({}));
  storage.add(std::make_unique<BoardMemory>(storage, "a.b", "TMC8461-BA",
                                            other.board.kept_parts().at(0), base::EventReporter()));
  EXPECT_EQ(other.spi(0x03'0000'00, 32) & 0xFFU, 0xFFU);
}

TEST_F(BoardMemoryTest, EveryPartOfAChipsBoardIsAttachedWithTheChip) {
  devices::Tmc8461Configuration configuration;
  configuration.board.peripherals.push_back(spi_eeprom());
  devices::Tmc8461 chip(configuration);
  ASSERT_EQ(chip.kept_parts().size(), 1U);
  DeviceStorage storage(directory.path());
  storage.attach("chip", chip, {});
  // As the chip's SPI master does it: write enable, then two bytes.
  board::SpiSlave& part = *chip.board().find("eeprom")->spi();
  const auto exchange = [&part](std::uint64_t sent, std::uint8_t bits) {
    mfc::SpiTransfer transfer;
    transfer.clock_period = 1_us;
    transfer.bits = bits;
    transfer.sent = sent;
    part.select({});
    static_cast<void>(part.exchange(transfer));
    part.deselect({});
  };
  exchange(0x06, 8);
  exchange(0x02'0000'CAFE, 40);
  EXPECT_TRUE(storage.busy());
  storage.flush({});
  EXPECT_TRUE(std::filesystem::exists(file()));
}

}  // namespace
}  // namespace stator::rack

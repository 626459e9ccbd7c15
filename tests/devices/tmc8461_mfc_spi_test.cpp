// The second SPI slave of the TMC8461, MFC CTRL: the vectors that follow from its address rule, and
// what its accesses do to the registers of the I/O block.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/tmc8461_board.hpp"
#include "stator/devices/tmc8461/tmc8461.hpp"

namespace stator::devices {
namespace {

using ethercat::AlState;
using mfc::OutsideDrive;
using ::testing::ElementsAre;
using tests::ChipBoard;
using namespace base::literals;

std::vector<unsigned> mfc(ChipBoard& board, std::initializer_list<unsigned> mosi) {
  return board.spi(product::HostSpi::mfc, mosi);
}

/// Registers whose value a write leaves readable, by the vectors MFC-1 and MFC-7.
TEST(MfcSpi, ShortAndLongHeadersReachTheSameRegister) {
  ChipBoard board;
  mfc(board, {0x00, 0x04, 0x21, 0x01});  // ENC_MODE
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0x21, 0x01));
  EXPECT_THAT(mfc(board, {0x00, 0x03, 0xFF, 0x00, 0xFF}), ElementsAre(0, 0, 0, 0x21, 0x01));
  EXPECT_THAT(mfc(board, {0x00, 0x06, 0x0C, 0xFF, 0x00, 0xFF}),
              ElementsAre(0, 0, 0, 0, 0x21, 0x01));
  mfc(board, {0x00, 0x06, 0x10, 0x00, 0x00});
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0, 0));
}

TEST(MfcSpi, BytesAreLittleEndianAndWalkUp) {
  ChipBoard board;
  mfc(board, {0x17, 0x84, 0x00, 0x55, 0xFF, 0x00});  // GPO = 00FF5500h
  EXPECT_THAT(mfc(board, {0x17, 0x83, 0xFF, 0, 0, 0, 0xFF}),
              ElementsAre(0, 0, 0, 0x00, 0x55, 0xFF, 0x00));
  EXPECT_THAT(mfc(board, {0x17, 0x8B, 0xFF, 0xFF}), ElementsAre(0, 0, 0, 0x55)) << "byte 1 alone";
}

TEST(MfcSpi, ExcessBytesAreIgnoredAndReadZero) {
  ChipBoard board;
  mfc(board, {0x21, 0x04, 0x01, 0xAA, 0xBB, 0xCC});  // AL_OVERRIDE has one byte
  EXPECT_THAT(mfc(board, {0x21, 0x03, 0xFF, 0, 0, 0, 0xFF}), ElementsAre(0, 0, 0, 1, 0, 0, 0));
}

TEST(MfcSpi, RegistersAreReadInEveryState) {
  ChipBoard board({.device_emulation = true});
  board.chip.io().drive(3, OutsideDrive::level(true), board.bus.now());
  // AL_OVERRIDE is readable in Init, without a master, and so are inputs.
  EXPECT_THAT(mfc(board, {0x21, 0x02, 0xFF}), ElementsAre(0, 0, 0));
  board.bus.request(AlState::pre_operational);
  mfc(board, {0x21, 0x04, 0x01});
  EXPECT_THAT(mfc(board, {0x21, 0x02, 0xFF}), ElementsAre(0, 0, 1));
}

TEST(MfcSpi, WorksWithoutALoadedEeprom) {
  Tmc8461Configuration configuration;
  configuration.sii = ChipBoard::Bytes(2048, std::byte{0x55});
  ChipBoard board(configuration);
  EXPECT_THAT(board.pdi({0x00, 0x02, 0xFF}), ElementsAre(0, 0, 0));
  mfc(board, {0x00, 0x04, 0x21, 0x01});
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0x21, 0x01));
}

/// A parameter RAM that maps one register with the given configuration byte.
void map_register(ChipBoard& board, unsigned number, unsigned configuration) {
  board.bus_write(0x059E, {0x00, 0x11, 0x00, 0x14});
  board.bus_write(static_cast<std::uint16_t>(0x05A2U + number), {configuration});
}

TEST(MfcSpi, MappedRegistersAreTheMastersToWriteButStayReadable) {
  ChipBoard board({.device_emulation = true});
  mfc(board, {0x00, 0x04, 0x21, 0x01});
  map_register(board, 0, 0x10);  // ENC_MODE, transparent
  mfc(board, {0x00, 0x04, 0xFF, 0x01});
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0x21, 0x01));
  map_register(board, 0, 0x00);
  mfc(board, {0x00, 0x04, 0x05, 0x00});
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0x05, 0x00));
}

TEST(MfcSpi, RegisterOfTheMasterAloneReadsZero) {
  ChipBoard board;
  // Register 63, MFCIO_STATUS of the mapping, address 03F0h.
  EXPECT_THAT(mfc(board, {0x1F, 0x83, 0xFF, 0, 0, 0, 0xFF}), ElementsAre(0, 0, 0, 0, 0, 0, 0));
}

TEST(MfcSpi, InterruptPinFollowsFlagsAndReadingClearsThem) {
  ChipBoard board;
  board.watch({product::HostLine::mfc_interrupt});
  mfc(board, {0x19, 0x84, 0x00, 0x08, 0x00, 0x00});  // mask 51: watchdog timeout (bit 11)
  mfc(board, {0x1A, 0x84, 0xC4, 0x09, 0x00, 0x00});  // WD_TIME 53 = 2500: 100 us
  board.bus.pass(1_ms);
  const auto flags = mfc(board, {0x1A, 0x03, 0xFF, 0, 0, 0, 0xFF});
  EXPECT_EQ(flags[4] & 0x08U, 0x08U);
  EXPECT_FALSE(board.rises(product::HostLine::mfc_interrupt).empty());
  EXPECT_FALSE(board.high(product::HostLine::mfc_interrupt));
}

TEST(MfcSpi, RegisterReadInPiecesIsReadOnce) {
  ChipBoard board;
  mfc(board, {0x17, 0x84, 0x11, 0x22, 0x33, 0x44});
  const auto head = ChipBoard::bytes({0x17, 0x83, 0xFF, 0x00});
  const auto tail = ChipBoard::bytes({0x00, 0x00, 0xFF});
  ChipBoard::Bytes first(head.size());
  ChipBoard::Bytes rest(tail.size());
  board.chip.select(product::HostSpi::mfc);
  board.chip.transfer(product::HostSpi::mfc, head, first, {});
  board.chip.transfer(product::HostSpi::mfc, tail, rest, {});
  board.chip.deselect(product::HostSpi::mfc, 0);
  EXPECT_EQ(first[3], std::byte{0x11});
  EXPECT_EQ(rest, ChipBoard::bytes({0x22, 0x33, 0x44}));
}

TEST(MfcSpi, ErrorsOfItsDatagramsAreNotThoseOfThePdi) {
  ChipBoard board;
  mfc(board, {0x00, 0x02, 0x00, 0x00});
  mfc(board, {0x00, 0x07});
  EXPECT_EQ(board.bus_read(0x030D), 0U);
}

TEST(MfcSpi, HeaderIsAnsweredByZerosUnlessTheBusIsShared) {
  for (const bool shared : {false, true}) {
    ChipBoard board({.shared_bus = shared});
    board.bus.request(AlState::pre_operational);
    EXPECT_EQ(mfc(board, {0x00, 0x00})[0], shared ? 1U : 0U);
  }
}

TEST(MfcSpi, OnASharedBusOnlyTheChipSelectSaysWhoIsMeant) {
  ChipBoard board({.shared_bus = true});
  mfc(board, {0x00, 0x04, 0x21, 0x01});
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0x21, 0x01));
  EXPECT_THAT(board.pdi({0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0xD0, 0x61));
  // Both selected: both take the write.
  board.chip.select(product::HostSpi::mfc);
  const auto write = ChipBoard::bytes({0x80, 0x06, 0x10, 0x5A});  // 1000h at both
  ChipBoard::Bytes in(write.size());
  board.chip.select(product::HostSpi::pdi);
  board.chip.transfer(product::HostSpi::pdi, ChipBoard::bytes({0x80, 0x04, 0x5A}),
                      std::span(in).first(3), {});
  board.chip.deselect(product::HostSpi::pdi, 0);
  board.chip.deselect(product::HostSpi::mfc, 0);
  EXPECT_EQ(board.bus_read(0x1000), 0x5AU);
}

/// Notes what the SPI master of the block sends.
class Peripheral final : public mfc::SpiSlave {
 public:
  void select(base::SimTime /*time*/) override {}
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    sent.push_back(transfer.sent);
    bits = transfer.bits;
    return 0;
  }
  void deselect(base::SimTime /*time*/) override {}

  std::vector<std::uint64_t> sent;
  unsigned bits = 0;
};

// Vectors SPI-1 to SPI-4 (L9132): a datagram of 20 bits to a stepper driver.
TEST(MfcSpi, WriteOfTheHighestTransmitByteStartsTheTransfer) {
  ChipBoard board;
  Peripheral driver;
  board.chip.io().attach_spi(0, &driver);
  mfc(board, {0x21, 0x04, 0x01});        // AL_OVERRIDE: outputs without Operational
  mfc(board, {0x05, 0x04, 0x13});        // SPI_LENGTH: 20 bits
  mfc(board, {0x05, 0x84, 0x02});        // SPI_TIME: 3.125 MHz
  mfc(board, {0x04, 0x04, 0x60, 0x00});  // SPI_CONF: mode 3, most significant bit first
  mfc(board, {0x03, 0x84, 0x10, 0xF0});  // the two lower bytes of SPI_TX_DATA
  board.bus.pass(1_ms);
  EXPECT_TRUE(driver.sent.empty());
  mfc(board, {0x03, 0x84, 0x10, 0xF0, 0x0E});
  board.bus.pass(1_ms);
  EXPECT_THAT(driver.sent, ElementsAre(0xEF010U));
  EXPECT_EQ(driver.bits, 20U);
  board.chip.io().attach_spi(0, nullptr);
}

TEST(MfcSpi, ResetClearsTheBlock) {
  ChipBoard board;
  mfc(board, {0x00, 0x04, 0x21, 0x01});
  board.chip.set_pin(product::HostPin::reset, false);
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0, 0)) << "silent";
  board.chip.set_pin(product::HostPin::reset, true);
  EXPECT_THAT(mfc(board, {0x00, 0x02, 0x00, 0xFF}), ElementsAre(0, 0, 0, 0));
}

// GPI waits for an edge of a chip select before it goes to process data.
TEST(MfcSpi, ChipSelectsTriggerTransfersOfProcessData) {
  for (const mfc::Trigger trigger : {mfc::Trigger::pdi_select, mfc::Trigger::pdi_deselect,
                                     mfc::Trigger::mfc_select, mfc::Trigger::mfc_deselect}) {
    ChipBoard board({.device_emulation = true});
    board.bus_write(0x0580 + 3, {static_cast<unsigned>(mfc::Signal::gpi0)});
    map_register(board, 48, 0x10U | static_cast<unsigned>(trigger));
    board.bus_write(0x0818, {0x00, 0x14, 4, 0, 0x20, 0, 1, 0});
    board.bus.request(AlState::pre_operational);
    board.bus.request(AlState::safe_operational);
    const auto inputs = [&board] {
      return std::to_integer<unsigned>(board.bus.read(0x1400, 4)[0]);
    };
    board.chip.io().drive(3, OutsideDrive::level(true), board.bus.now());
    const bool of_pdi =
        trigger == mfc::Trigger::pdi_select || trigger == mfc::Trigger::pdi_deselect;
    const product::HostSpi its = of_pdi ? product::HostSpi::pdi : product::HostSpi::mfc;
    const product::HostSpi other = of_pdi ? product::HostSpi::mfc : product::HostSpi::pdi;
    board.spi(other, {0x00, 0x02, 0xFF});
    EXPECT_EQ(inputs(), 0U) << static_cast<unsigned>(trigger);
    const bool falling = trigger == mfc::Trigger::pdi_select || trigger == mfc::Trigger::mfc_select;
    board.chip.select(its);
    EXPECT_EQ(inputs(), falling ? 1U : 0U) << static_cast<unsigned>(trigger);
    board.chip.deselect(its, 0);
    EXPECT_EQ(inputs(), 1U) << static_cast<unsigned>(trigger);
  }
}

/// Both ways into the I/O block: what the master writes into process data comes out at pins, what
/// pins carry comes back, without any controller.
TEST(IoBlock, MasterReachesPinsThroughProcessData) {
  Tmc8461Configuration configuration;
  configuration.device_emulation = true;
  configuration.sii = Tmc8461(configuration).sii_image();
  ChipBoard board(configuration);
  // Crossbar: GPIO 0 at MFCIO00 and MFCIO01 is left to the block's own table; here GPI and GPO.
  board.bus_write(0x059E, {0x00, 0x11, 0x00, 0x14});
  board.bus_write(0x05A2 + 47, {0x10});  // GPO
  board.bus_write(0x05A2 + 48, {0x10});  // GPI
  board.bus_write(0x0810, {0x00, 0x11, 4, 0, 0x64, 0, 1, 0});
  board.bus_write(0x0818, {0x00, 0x14, 4, 0, 0x20, 0, 1, 0});
  board.bus.request(AlState::pre_operational);
  board.bus.request(AlState::safe_operational);
  board.bus.request(AlState::operational);
  board.bus_write(0x1100, {0x00, 0x55, 0xFF, 0x00});
  EXPECT_THAT(mfc(board, {0x17, 0x83, 0xFF, 0, 0, 0, 0xFF}),
              ElementsAre(0, 0, 0, 0x00, 0x55, 0xFF, 0x00))
      << "GPO as the master has written it";
}

}  // namespace
}  // namespace stator::devices

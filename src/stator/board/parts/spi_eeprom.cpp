// A serial EEPROM on SPI with the commands of the 25LC256.

#include <array>

#include "stator/board/parts/memory_array.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

constexpr std::size_t kSize = 32768;
constexpr std::size_t kPage = 64;
constexpr std::uint8_t kProtectionBits = 0x0C;  ///< 0..3 in 3:2: nothing, a quarter, half, all

// Commands.
constexpr std::uint8_t kWriteStatus = 0x01;
constexpr std::uint8_t kWrite = 0x02;
constexpr std::uint8_t kRead = 0x03;
constexpr std::uint8_t kWriteDisable = 0x04;
constexpr std::uint8_t kReadStatus = 0x05;
constexpr std::uint8_t kWriteEnable = 0x06;

/// Modes 0 and 3; two bytes of address. What is written begins to be programmed when CS rises
/// after a whole byte; until that is done only the status register answers. Status: bit 0 write in
/// progress, 1 write enabled, 3:2 protection of the upper quarter, half or all.
class SpiEeprom final : public Peripheral, public SpiSlave {
 public:
  explicit SpiEeprom(const Settings& settings)
      : memory_(kSize, kPage, base::SimDuration(settings.integer("write_time") * 1000)) {}

  SpiSlave* spi() override { return this; }
  KeptContent* kept_content() override { return &memory_; }
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    return clock_word(*this, transfer);
  }

  void select(base::SimTime /*now*/) override {
    bits_ = 0;
    bytes_ = 0;
    shift_ = 0;
    answer_ = 0;
    answers_ = false;
  }
  [[nodiscard]] Drive output() const override {
    return answers_ ? driven(((answer_ >> (7U - bits_)) & 1U) != 0) : Drive::released;
  }
  void take(base::SimTime now, bool bit) override {
    shift_ = static_cast<std::uint8_t>(unsigned{shift_} << 1U | (bit ? 1U : 0U));
    if (++bits_ == 8) {
      bits_ = 0;
      take_byte(now);
      ++bytes_;
    }
  }
  void deselect(base::SimTime now) override {
    if (bits_ != 0 || bytes_ == 0 || ignored_) {
      memory_.drop();
      return;
    }
    if (command_ == kWriteEnable || command_ == kWriteDisable) {
      enabled_ = command_ == kWriteEnable;
    } else if (command_ == kWrite && memory_.loaded()) {
      memory_.program(now);
      enabled_ = false;
    } else if (command_ == kWriteStatus && bytes_ >= 2 && enabled_) {
      memory_.write_register(now, shift_ & kProtectionBits);
      enabled_ = false;
    }
  }

  std::vector<base::Signal> signals() const override {
    return {{"writes", "", base::SignalReader::bind<&SpiEeprom::writes>(*this)}};
  }

 private:
  [[nodiscard]] double writes() const { return static_cast<double>(memory_.writes()); }
  [[nodiscard]] std::uint8_t status(base::SimTime now) const {
    return static_cast<std::uint8_t>((memory_.busy(now) ? 1U : 0U) | (enabled_ ? 2U : 0U) |
                                     (memory_.read_register() & kProtectionBits));
  }
  /// First protected address.
  [[nodiscard]] std::size_t protected_from() const {
    constexpr std::array<std::size_t, 4> kFrom{kSize, kSize / 4 * 3, kSize / 2, 0};
    return kFrom[(memory_.read_register() & kProtectionBits) >> 2U];
  }

  void take_byte(base::SimTime now) {
    if (bytes_ == 0) {
      command_ = shift_;
      ignored_ = memory_.busy(now) && command_ != kReadStatus;
      address_ = 0;
      answers_ = command_ == kReadStatus && !ignored_;
      answer_ = status(now);
      return;
    }
    if (ignored_) {
      return;
    }
    if (command_ == kReadStatus) {
      answer_ = status(now);
    } else if (command_ == kRead || command_ == kWrite) {
      take_data();
    }
  }

  void take_data() {
    constexpr unsigned kAddressBytes = 2;
    if (bytes_ <= kAddressBytes) {
      address_ = (address_ << 8U | shift_) & (kSize - 1);
      if (bytes_ == kAddressBytes && command_ == kWrite) {
        memory_.begin_page(address_);
      }
    } else if (command_ == kWrite && enabled_ && address_ < protected_from()) {
      memory_.load(shift_);
    }
    if (bytes_ >= kAddressBytes && command_ == kRead) {
      answers_ = true;
      answer_ = memory_.read(address_);
      address_ = (address_ + 1) & (kSize - 1);
    }
  }

  MemoryArray memory_;
  bool enabled_ = false;

  std::uint8_t command_ = 0;
  bool ignored_ = false;  ///< the command came while the memory was busy
  std::uint8_t shift_ = 0;
  unsigned bits_ = 0;
  unsigned bytes_ = 0;  ///< complete ones of the datagram
  std::size_t address_ = 0;
  std::uint8_t answer_ = 0;
  bool answers_ = false;
};

constexpr std::array<PinDeclaration, 4> kPins{
    {{"sck", PinUse::watches, false, ""},
     {"mosi", PinUse::watches, false, "SDO of the chip"},
     {"miso", PinUse::drives, true, "SDI of the chip"},
     {"cs", PinUse::watches, false, "selects at low level"}}};
constexpr std::array<ParameterDeclaration, 1> kParameters{
    {{"write_time", "us", 0.0, 1e6, 5000.0, "until a page is programmed"}}};

}  // namespace

constinit const PeripheralType kSpiEeprom{
    "spi-eeprom",
    "EEPROM of 32 Kbyte, 25LC256",
    kPins,
    kParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<SpiEeprom>(settings);
    }};

}  // namespace stator::board

// A serial EEPROM on I2C, 24LC64.

#include <array>

#include "stator/board/parts/memory_array.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

constexpr std::size_t kSize = 8192;
constexpr std::size_t kPage = 32;

/// Two bytes of address, then data of at most a page, programmed after the stop; meanwhile it does
/// not answer to its address. Reads go on from the address pointer.
class I2cEeprom final : public Peripheral, public mfc::I2cSlave {
 public:
  explicit I2cEeprom(const Settings& settings)
      : address_(static_cast<std::uint8_t>(settings.integer("address"))),
        memory_(kSize, kPage, base::SimDuration(settings.integer("write_time") * 1000)) {}

  mfc::I2cSlave* i2c() override { return this; }
  KeptContent* kept_content() override { return &memory_; }

  void start(base::SimTime /*now*/) override { addressed_ = false; }
  mfc::I2cAnswer address(base::SimTime now, std::uint8_t address, bool read) override {
    addressed_ = address == address_ && !memory_.busy(now);
    if (addressed_ && !read) {
      bytes_ = 0;
      memory_.drop();
    }
    return {.acknowledge = addressed_, .stretch = {}};
  }
  mfc::I2cAnswer write(base::SimTime /*now*/, std::uint8_t value) override {
    constexpr unsigned kAddressBytes = 2;
    if (bytes_ < kAddressBytes) {
      pointer_ = (pointer_ << 8U | value) & (kSize - 1);
      if (++bytes_ == kAddressBytes) {
        memory_.begin_page(pointer_);
      }
    } else {
      memory_.load(value);
      const std::size_t within = (pointer_ + 1) & (kPage - 1);
      pointer_ = (pointer_ & ~(kPage - 1)) | within;
    }
    return {.acknowledge = true, .stretch = {}};
  }
  mfc::I2cData read(base::SimTime /*now*/) override {
    const std::uint8_t value = memory_.read(pointer_);
    pointer_ = (pointer_ + 1) & (kSize - 1);
    return {.value = value, .stretch = {}};
  }
  void acknowledged(base::SimTime /*now*/, bool /*acknowledge*/) override {}
  void stop(base::SimTime now) override {
    // A repeated start instead of the stop leaves what was loaded unprogrammed.
    if (addressed_ && memory_.loaded()) {
      memory_.program(now);
    }
    addressed_ = false;
  }

  std::vector<base::Signal> signals() const override {
    return {{"writes", "", base::SignalReader::bind<&I2cEeprom::writes>(*this)}};
  }

 private:
  [[nodiscard]] double writes() const { return static_cast<double>(memory_.writes()); }

  std::uint8_t address_;
  MemoryArray memory_;
  bool addressed_ = false;
  unsigned bytes_ = 0;
  std::size_t pointer_ = 0;
};

constexpr std::array<PinDeclaration, 2> kPins{
    {{"scl", PinUse::watches, false, ""}, {"sda", PinUse::shares, false, "open drain"}}};
constexpr std::array<ParameterDeclaration, 2> kParameters{
    {{"address", "", 80.0, 87.0, 80.0, "of 7 bits; 80 is 50h"},
     {"write_time", "us", 0.0, 1e6, 5000.0, "until a page is programmed"}}};

}  // namespace

constinit const PeripheralType kI2cEeprom{
    "i2c-eeprom",
    "EEPROM of 8 Kbyte, 24LC64",
    kPins,
    kParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<I2cEeprom>(settings);
    }};

}  // namespace stator::board

// A temperature sensor and a port expander on I2C.

#include <algorithm>
#include <array>
#include <cmath>

#include "stator/board/parts/numbered.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

/// Four registers behind a pointer byte: 0 temperature, 1 configuration (8 bits), 2 hysteresis, 3
/// limit; the others have 16 bits, of which the upper nine count in 0.5 K. Output OS is low (bit 2
/// of the configuration: high) from the limit up until the temperature falls below the hysteresis.
class TemperatureSensor final : public Peripheral, public mfc::I2cSlave {
 public:
  explicit TemperatureSensor(const Settings& settings)
      : address_(static_cast<std::uint8_t>(settings.integer("address"))),
        temperature_(settings.number("temperature")) {}

  mfc::I2cSlave* i2c() override { return this; }

  void begin(base::SimTime now) override { update(now); }
  void start(base::SimTime /*now*/) override {}
  mfc::I2cAnswer address(base::SimTime /*now*/, std::uint8_t address, bool /*read*/) override {
    byte_ = 0;
    latched_ = value(pointer_);
    return {.acknowledge = address == address_, .stretch = {}};
  }
  mfc::I2cAnswer write(base::SimTime now, std::uint8_t data) override {
    if (byte_ == 0) {
      pointer_ = data & 3U;
    } else if (pointer_ == kConfiguration && byte_ == 1) {
      configuration_ = data & 0x1FU;
    } else if (pointer_ >= kHysteresis && byte_ <= 2) {
      std::uint16_t& target = limits_[pointer_ - kHysteresis];
      target = byte_ == 1 ? static_cast<std::uint16_t>(unsigned{data} << 8U | (target & 0xFFU))
                          : static_cast<std::uint16_t>((target & 0xFF00U) | (data & 0x80U));
    }
    ++byte_;
    update(now);
    return {.acknowledge = true, .stretch = {}};
  }
  mfc::I2cData read(base::SimTime /*now*/) override {
    const std::uint8_t data = byte_ == 0   ? static_cast<std::uint8_t>(latched_ >> 8U)
                              : byte_ == 1 ? static_cast<std::uint8_t>(latched_)
                                           : std::uint8_t{0xFF};
    ++byte_;
    return {.value = data, .stretch = {}};
  }
  void acknowledged(base::SimTime /*now*/, bool /*acknowledge*/) override {}
  void stop(base::SimTime /*now*/) override {}

  std::vector<base::Signal> signals() const override {
    return {
        {"temperature", "degree C", base::SignalReader::bind<&TemperatureSensor::measured>(*this)}};
  }
  std::vector<base::Input> inputs() override {
    return {{"temperature", "degree C", -55.0, 125.0,
             base::Delegate<void(double)>::bind<&TemperatureSensor::set_temperature>(*this),
             base::InputGroup::sensors, temperature_}};
  }

 private:
  static constexpr unsigned kConfiguration = 1;
  static constexpr unsigned kHysteresis = 2;
  static constexpr std::size_t kOs = 2;

  /// Half kelvins, rounded down as its converter does.
  [[nodiscard]] int half_kelvins() const {
    return static_cast<int>(std::floor(temperature_ * 2.0));
  }
  [[nodiscard]] double measured() const { return half_kelvins() * 0.5; }
  [[nodiscard]] std::uint16_t value(unsigned pointer) const {
    if (pointer == 0) {
      return static_cast<std::uint16_t>(half_kelvins() * 128);
    }
    // A register of one byte repeats it.
    return pointer == kConfiguration ? static_cast<std::uint16_t>(configuration_ * 0x101U)
                                     : limits_[pointer - kHysteresis];
  }
  [[nodiscard]] static int half_kelvins_of(std::uint16_t limit) {
    return static_cast<std::int16_t>(limit) / 128;
  }
  void update(base::SimTime now) {
    if (half_kelvins() >= half_kelvins_of(limits_[1])) {
      alarm_ = true;
    } else if (half_kelvins() < half_kelvins_of(limits_[0])) {
      alarm_ = false;
    }
    drive(now, kOs, alarm_ == ((configuration_ & 4U) != 0));
  }
  void set_temperature(double celsius) {
    temperature_ = celsius;
    update(now());
  }

  std::uint8_t address_;
  double temperature_;
  std::array<std::uint16_t, 2> limits_{75 * 256, 80 * 256};  ///< hysteresis, limit
  std::uint8_t configuration_ = 0;
  unsigned pointer_ = 0;
  unsigned byte_ = 0;
  std::uint16_t latched_ = 0;
  bool alarm_ = false;
};

/// Eight quasi-bidirectional lines: a written 1 pulls up weakly, so that the outside can pull the
/// line down and be read; a written 0 holds it down. INT is low from the moment at which the
/// outside changes a line until the port is read or written.
class PortExpander final : public Peripheral, public mfc::I2cSlave {
 public:
  explicit PortExpander(const Settings& settings)
      : address_(static_cast<std::uint8_t>(settings.integer("address"))), numbered_(*this, 8) {}

  mfc::I2cSlave* i2c() override { return this; }

  void begin(base::SimTime now) override { show(now); }
  void start(base::SimTime /*now*/) override {}
  mfc::I2cAnswer address(base::SimTime /*now*/, std::uint8_t address, bool /*read*/) override {
    return {.acknowledge = address == address_, .stretch = {}};
  }
  mfc::I2cAnswer write(base::SimTime now, std::uint8_t data) override {
    latch_ = data;
    known_ = levels();
    show(now);
    return {.acknowledge = true, .stretch = {}};
  }
  mfc::I2cData read(base::SimTime now) override {
    known_ = levels();
    show(now);
    return {.value = known_, .stretch = {}};
  }
  void acknowledged(base::SimTime /*now*/, bool /*acknowledge*/) override {}
  void stop(base::SimTime /*now*/) override {}

  [[nodiscard]] double number_value(std::size_t k) const { return (levels() >> k) & 1U; }
  void set_number(std::size_t k, double value) {
    const auto bit = static_cast<std::uint8_t>(1U << k);
    outside_ = static_cast<std::uint8_t>(value >= 0.5 ? outside_ | bit : outside_ & ~bit);
    show(now());
  }
  std::vector<base::Signal> signals() const override {
    std::vector<base::Signal> result;
    numbered_.append_signals(result, "p");
    return result;
  }
  std::vector<base::Input> inputs() override {
    std::vector<base::Input> result;
    numbered_.append_inputs(result, {.name = "p", .group = base::InputGroup::lines, .normal = 1.0});
    return result;
  }

 private:
  static constexpr std::size_t kInt = 2;

  [[nodiscard]] std::uint8_t levels() const { return latch_ & outside_; }
  void show(base::SimTime now) { drive(now, kInt, levels() == known_); }

  std::uint8_t address_;
  std::uint8_t latch_ = 0xFF;
  std::uint8_t outside_ = 0xFF;  ///< 0: pulled down from outside
  std::uint8_t known_ = 0xFF;    ///< as last read or written
  Numbered<PortExpander> numbered_;
};

constexpr PinDeclaration kScl{"scl", PinUse::watches, false, ""};
constexpr PinDeclaration kSda{"sda", PinUse::shares, false, "open drain"};

constexpr std::array<PinDeclaration, 3> kSensorPins{
    kScl, kSda, PinDeclaration{"os", PinUse::drives, true, "low above the limit"}};
constexpr std::array<ParameterDeclaration, 2> kSensorParameters{
    {{"address", "", 72.0, 79.0, 72.0, "of 7 bits; 72 is 48h"},
     {"temperature", "degree C", -55.0, 125.0, 25.0, "at power-on"}}};
constexpr std::array<PinDeclaration, 3> kExpanderPins{
    kScl, kSda, PinDeclaration{"int", PinUse::drives, true, "low after a change from outside"}};
constexpr std::array<ParameterDeclaration, 1> kExpanderParameters{
    {{"address", "", 32.0, 39.0, 32.0, "of 7 bits; 32 is 20h"}}};

}  // namespace

constinit const PeripheralType kI2cTemperatureSensor{
    "i2c-temperature-sensor",
    "temperature sensor with a limit, LM75",
    kSensorPins,
    kSensorParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<TemperatureSensor>(settings);
    }};

constinit const PeripheralType kI2cPortExpander{
    "i2c-port-expander",
    "eight quasi-bidirectional lines, PCF8574",
    kExpanderPins,
    kExpanderParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<PortExpander>(settings);
    }};

}  // namespace stator::board

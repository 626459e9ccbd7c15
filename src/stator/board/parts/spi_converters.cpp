// Converters on SPI: an ADC with the framing of the MCP3208, a DAC with that of the MCP4922.

#include <algorithm>
#include <array>
#include <bit>

#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

constexpr std::size_t kChannels = 8;

/// 12 bits, 8 channels or 4 differential pairs, modes 0 and 3. A datagram: any number of zeros, the
/// start bit, 1 for a single channel or 0 for a pair, three bits of the channel, one clock in which
/// the sample is taken, a zero, 12 bits from the most significant one; then the same bits upwards
/// from bit 1, then zeros.
class SpiAdc final : public Peripheral, public SpiSlave {
 public:
  explicit SpiAdc(const Settings& settings) : reference_(settings.number("reference_voltage")) {}

  SpiSlave* spi() override { return this; }
  /// A datagram in one transfer is answered at once.
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    const int clocks = static_cast<int>(std::bit_width(transfer.sent)) - 1;  // behind the start bit
    if (clock_ != kBeforeStart || clocks < kNullBit ||
        transfer.clock_polarity != transfer.clock_phase) {
      return clock_word(*this, transfer);
    }
    channel_ = static_cast<unsigned>(transfer.sent >> (clocks - kChannelBit)) & 0xFU;
    const int before = transfer.bits - 1 - clocks + kSample;
    code_ = convert(first_sample(transfer) + transfer.clock_period * before);
    clock_ = std::min(clocks + 1, kEnd);
    keep_late_bit(transfer);
    return answer(clocks);
  }
  bool connect(std::size_t channel, Peripheral& other) override {
    sources_[channel] = other.analog_output();
    return sources_[channel] != nullptr;
  }

  void select(base::SimTime /*now*/) override { clock_ = kBeforeStart; }
  void deselect(base::SimTime /*now*/) override {}
  [[nodiscard]] Drive output() const override {
    if (clock_ < kNullBit) {
      return Drive::released;
    }
    // Bits 11..0, then 1..11, then zeros.
    const int place = clock_ - kNullBit - 1;
    const int bit = place < 12 ? 11 - place : place - 11;
    return driven(place >= 0 && bit < 12 && ((code_ >> bit) & 1U) != 0);
  }
  void take(base::SimTime now, bool bit) override {
    if (clock_ == kBeforeStart) {
      clock_ = bit ? 1 : kBeforeStart;
      channel_ = 0;
      return;
    }
    if (clock_ <= kChannelBit) {
      channel_ = channel_ << 1U | (bit ? 1U : 0U);
    } else if (clock_ == kSample) {
      code_ = convert(now);
    }
    clock_ = clock_ < kEnd ? clock_ + 1 : clock_;
  }

  std::vector<base::Signal> signals() const override {
    return {{"code", "", base::SignalReader::bind<&SpiAdc::code>(*this)}};
  }
  std::vector<base::Input> inputs() override {
    std::vector<base::Input> result;
    add_inputs(result, std::make_index_sequence<kChannels>());
    return result;
  }

 private:
  // Clocks since the start bit, which is clock 0.
  static constexpr int kBeforeStart = 0;
  static constexpr int kChannelBit = 4;
  static constexpr int kSample = 5;
  static constexpr int kNullBit = 6;
  static constexpr int kEnd = 31;

  /// What output() shows in `clocks` clocks behind the start bit.
  [[nodiscard]] std::uint64_t answer(int clocks) const {
    constexpr int kLastOfCode = kNullBit + 12;
    if (clocks <= kLastOfCode) {
      return code_ >> (kLastOfCode - clocks);
    }
    std::uint64_t shown = code_;
    for (int bit = 1; bit <= clocks - kLastOfCode; ++bit) {
      shown = shown << 1U | (bit < 12 ? code_ >> bit & 1U : 0U);
    }
    return shown;
  }

  [[nodiscard]] double voltage(std::size_t channel, base::SimTime now) const {
    return sources_[channel] != nullptr ? sources_[channel]->voltage(now) : by_hand_[channel];
  }
  [[nodiscard]] unsigned convert(base::SimTime now) const {
    const bool single = (channel_ & 8U) != 0;
    const std::size_t channel = channel_ & 7U;
    const double difference = voltage(channel, now) - (single ? 0.0 : voltage(channel ^ 1U, now));
    // A voltage that stands for a whole code is not lost to rounding.
    constexpr double kRounding = 1e-6;
    const double code = difference / reference_ * 4096.0 + kRounding;
    return static_cast<unsigned>(std::clamp(code, 0.0, 4095.0));
  }
  [[nodiscard]] double code() const { return code_; }

  template <std::size_t channel>
  void set_voltage(double volt) {
    by_hand_[channel] = volt;
  }
  template <std::size_t... channels>
  void add_inputs(std::vector<base::Input>& result, std::index_sequence<channels...> /*all*/) {
    const auto add = [this,
                      &result]<std::size_t channel>(std::integral_constant<std::size_t, channel>) {
      if (sources_[channel] == nullptr) {
        result.push_back({"channel" + std::to_string(channel), "V", -100.0, 100.0,
                          base::Delegate<void(double)>::bind<&SpiAdc::set_voltage<channel>>(*this),
                          base::InputGroup::lines});
      }
    };
    (add(std::integral_constant<std::size_t, channels>()), ...);
  }

  double reference_;
  std::array<AnalogSource*, kChannels> sources_{};
  std::array<double, kChannels> by_hand_{};  ///< V of channels without a source
  int clock_ = kBeforeStart;
  unsigned channel_ = 0;  ///< single-ended bit and channel
  unsigned code_ = 0;
};

/// 12 bits, two channels, modes 0 and 3. A datagram of 16 bits: channel B, buffered (no effect
/// here), gain 1 instead of 2, output active, 12 bits of data; taken when CS rises after exactly 16
/// clocks. Outputs follow at once, or when LDAC is low if that is wired.
class SpiDac final : public Peripheral, public SpiSlave {
 public:
  explicit SpiDac(const Settings& settings)
      : reference_(settings.number("reference_voltage")),
        supply_(settings.number("supply_voltage")) {}

  SpiSlave* spi() override { return this; }
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    return clock_word(*this, transfer);
  }
  bool connect(std::size_t /*connection*/, Peripheral& /*other*/) override { return false; }

  void select(base::SimTime /*now*/) override {
    word_ = 0;
    clocks_ = 0;
  }
  [[nodiscard]] Drive output() const override { return Drive::released; }
  void take(base::SimTime /*now*/, bool bit) override {
    word_ = word_ << 1U | (bit ? 1U : 0U);
    clocks_ = std::min(clocks_ + 1, 17);
  }
  void deselect(base::SimTime /*now*/) override {
    if (clocks_ == 16) {
      inputs_[(word_ >> 15U) & 1U] = word_;
      if (!wired(kLdac) || !level(kLdac)) {
        outputs_ = inputs_;
      }
    }
  }
  void line_changed(base::SimTime /*now*/, std::size_t pin, bool level) override {
    if (pin == kLdac && !level) {
      outputs_ = inputs_;
    }
  }

  std::vector<base::Signal> signals() const override {
    using Read = base::SignalReader;
    return {{"voltage_a", "V", Read::bind<&SpiDac::voltage_of<0>>(*this)},
            {"voltage_b", "V", Read::bind<&SpiDac::voltage_of<1>>(*this)}};
  }

 private:
  static constexpr std::size_t kLdac = 3;

  /// 0 V while shut down.
  template <std::size_t channel>
  [[nodiscard]] double voltage_of() const {
    const unsigned word = outputs_[channel];
    const double gain = (word & 0x2000U) != 0 ? 1.0 : 2.0;
    const double volt = gain * reference_ * static_cast<double>(word & 0xFFFU) / 4096.0;
    return (word & 0x1000U) != 0 ? std::min(volt, supply_) : 0.0;
  }

  double reference_;
  double supply_;
  unsigned word_ = 0;
  int clocks_ = 0;
  std::array<unsigned, 2> inputs_{};   ///< input registers
  std::array<unsigned, 2> outputs_{};  ///< what the outputs show
};

constexpr PinDeclaration kSck{"sck", PinUse::watches, false, ""};
constexpr PinDeclaration kMosi{"mosi", PinUse::watches, false, "SDO of the chip"};
constexpr PinDeclaration kMiso{"miso", PinUse::drives, true, "SDI of the chip"};
constexpr PinDeclaration kCs{"cs", PinUse::watches, false, "selects at low level"};

constexpr std::array<PinDeclaration, 4> kAdcPins{kSck, kMosi, kMiso, kCs};
constexpr std::array<ParameterDeclaration, 1> kAdcParameters{
    {{"reference_voltage", "V", 0.1, 10.0, 3.3, "of full scale"}}};
constexpr ConnectionDeclaration channel(std::string_view name) {
  return {name, ConnectionKind::analog, true, "what the channel measures; else an input of it"};
}
constexpr std::array<ConnectionDeclaration, kChannels> kAdcConnections{
    channel("channel0"), channel("channel1"), channel("channel2"), channel("channel3"),
    channel("channel4"), channel("channel5"), channel("channel6"), channel("channel7")};

constexpr std::array<PinDeclaration, 4> kDacPins{
    kSck, kMosi, kCs, PinDeclaration{"ldac", PinUse::watches, true, "low: outputs follow inputs"}};
constexpr std::array<ParameterDeclaration, 2> kDacParameters{
    {{"reference_voltage", "V", 0.1, 10.0, 2.048, "of full scale with gain 1"},
     {"supply_voltage", "V", 0.0, 10.0, 5.0, "the outputs reach it at most"}}};

}  // namespace

constinit const PeripheralType kSpiAdc{"spi-adc",
                                       "ADC of 12 bits and 8 channels, MCP3208",
                                       kAdcPins,
                                       kAdcParameters,
                                       kAdcConnections,
                                       [](const Settings& settings) -> std::unique_ptr<Peripheral> {
                                         return std::make_unique<SpiAdc>(settings);
                                       }};

constinit const PeripheralType kSpiDac{"spi-dac",
                                       "DAC of 12 bits and 2 channels, MCP4922",
                                       kDacPins,
                                       kDacParameters,
                                       {},
                                       [](const Settings& settings) -> std::unique_ptr<Peripheral> {
                                         return std::make_unique<SpiDac>(settings);
                                       }};

}  // namespace stator::board

// A stepper motor behind a driver with the registers of the TMC262.

#include <array>

#include "stator/board/parts/stepper_peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"
#include "stator/control/stepper/cool_step.hpp"
#include "stator/control/stepper/microstep_sequencer.hpp"
#include "stator/control/stepper/open_load_detector.hpp"
#include "stator/control/stepper/stall_guard.hpp"

namespace stator::board {

namespace {

// Pins behind those of the SPI.
constexpr std::size_t kStep = 4;
constexpr std::size_t kDirection = 5;
constexpr std::size_t kEnable = 6;

[[nodiscard]] constexpr unsigned bits(std::uint32_t word, unsigned high, unsigned low) {
  return (word >> low) & ((1U << (high - low + 1)) - 1U);
}
[[nodiscard]] constexpr bool bit(std::uint32_t word, unsigned place) {
  return bits(word, place, place) != 0;
}

/// Registers of 20 bits, the upper ones of which name the register; the latest 20 bits are taken
/// when CS rises. Each datagram is answered with the state at its begin, and further clocks hand on
/// what came in, so that drivers can be chained. Motion comes by STEP and DIR or, with SDOFF, as
/// coil currents by SPI. Interpolation to 256 microsteps, slopes and the random off time do not
/// change what a mean chopper does, and chopper settings but TOFF = 0 (off) have no effect.
class SpiStepperDriver final : public StepperPeripheral, public SpiSlave {
 public:
  explicit SpiStepperDriver(const Settings& settings)
      : StepperPeripheral(settings), sense_resistor_(settings.number("sense_resistor")) {}

  SpiSlave* spi() override { return this; }
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    return clock_word(*this, transfer);
  }
  void select(base::SimTime now) override {
    shift_ = reply(now);
    clocks_ = 0;
  }
  [[nodiscard]] Drive output() const override { return driven(bit(shift_, 19)); }
  void take(base::SimTime /*now*/, bool bit) override {
    shift_ = (shift_ << 1U | (bit ? 1U : 0U)) & 0xFFFFFU;
    ++clocks_;
  }
  void deselect(base::SimTime now) override {
    if (clocks_ >= 20) {
      write(shift_);
      wake(now);
    }
  }

  void line_changed(base::SimTime now, std::size_t pin, bool level) override {
    const bool double_edge = bit(drive_control_, 8);
    if (pin == kStep && (level || double_edge) && !by_spi()) {
      forward_ = !this->level(kDirection);
      const std::int64_t step = std::int64_t{1} << resolution();
      position_ += forward_ ? step : -step;
      stepped_at_ = now;
    } else if (pin != kEnable) {
      return;
    }
    wake(now);
  }

  std::vector<base::Signal> signals() const override {
    using Read = base::SignalReader;
    std::vector<base::Signal> result = StepperPeripheral::signals();
    result.push_back({"steps", "1/256 step", Read::bind<&SpiStepperDriver::steps>(*this)});
    result.push_back({"stall_guard", "", Read::bind<&SpiStepperDriver::stall_guard>(*this)});
    return result;
  }

  [[nodiscard]] bool needs_edges() const override { return bit(drive_control_, 8); }

 private:
  void make_steps(base::SimTime now, std::int64_t steps) override {
    if (!by_spi()) {
      forward_ = steps > 0;
      position_ += steps * (std::int64_t{1} << resolution());
      stepped_at_ = now;
    }
  }
  // Clock 16 MHz: no step for 2^20 clocks.
  static constexpr base::SimDuration kStandstill{65'536'000};

  [[nodiscard]] double steps() const { return static_cast<double>(position_); }
  [[nodiscard]] double stall_guard() const { return stall_guard_.value(); }

  [[nodiscard]] bool by_spi() const { return bit(driver_configuration_, 7); }
  /// MRES as a power of two of 1/256 full steps.
  [[nodiscard]] unsigned resolution() const { return std::min(bits(drive_control_, 3, 0), 8U); }
  [[nodiscard]] unsigned current_scale() const { return bits(stall_control_, 4, 0); }

  void write(std::uint32_t datagram) {
    switch (bits(datagram, 19, 17)) {
      case 0:
      case 1:
        (by_spi() ? coil_control_ : drive_control_) = datagram;
        break;
      case 4:
        chopper_control_ = datagram;
        break;
      case 5:
        smart_control_ = datagram;
        break;
      case 6:
        stall_control_ = datagram;
        break;
      case 7:
        driver_configuration_ = datagram;
        break;
      default:
        break;
    }
  }

  [[nodiscard]] std::uint32_t reply(base::SimTime now) const {
    const std::uint32_t stall = stall_guard_.value();
    std::uint32_t value = 0;
    switch (bits(driver_configuration_, 5, 4)) {
      case 0:
        value = static_cast<std::uint32_t>(position_) & 0x3FFU;
        break;
      case 1:
        value = stall;
        break;
      default:
        value = (stall >> 5U) << 5U | (current_scale() - reduction());
        break;
    }
    const base::AxisSensing& sensing = world().sensing();
    const auto flag = [](bool set, unsigned place) { return (set ? 1U : 0U) << place; };
    const bool stands = now - stepped_at_ >= kStandstill;
    return value << 10U | flag(stands, 7) | flag(open_load_.open(1), 6) |
           flag(open_load_.open(0), 5) | flag(shorted_[1], 4) | flag(shorted_[0], 3) |
           flag(sensing.driver_temperature >= 100.0, 2) |
           flag(sensing.driver_temperature >= 150.0, 1) | flag(stall == 0, 0);
  }

  [[nodiscard]] unsigned reduction() const {
    return std::min<unsigned>(cool_step_.reduction(), current_scale());
  }
  /// A, peak, of a coil whose converter stands at full scale.
  [[nodiscard]] double amplitude() const {
    const double full_scale = bit(driver_configuration_, 6) ? 0.165 : 0.310;
    return (current_scale() - reduction() + 1) / 32.0 * full_scale / sense_resistor_;
  }

  [[nodiscard]] std::array<double, 2> targets() {
    if (!by_spi()) {
      sequencer_.set_resolution(8);
      return sequencer_.coil_currents(position_, amplitude());
    }
    const auto coil = [this](unsigned sign, unsigned value) {
      const double size = value / static_cast<double>(control::MicrostepSequencer::kAmplitude);
      return (bit(coil_control_, sign) ? -1.0 : 1.0) * size * amplitude();
    };
    return {coil(17, bits(coil_control_, 16, 9)), coil(8, bits(coil_control_, 7, 0))};
  }

  base::AxisActuation actuation(base::SimTime now) override {
    base::AxisActuation result;
    const bool enabled = (!wired(kEnable) || !level(kEnable)) && bits(chopper_control_, 3, 0) != 0;
    if (!enabled) {
      shorted_ = {};
      open_load_.reset();
      stall_guard_.reset();
      cool_step_.reset();
      return result;
    }
    detect_shorts();
    result.bridge_enabled = !shorted_[0] && !shorted_[1];
    result.coil_current_target = targets();
    measure(now, result.coil_current_target);
    return result;
  }

  void detect_shorts() {
    const bool watched = !bit(driver_configuration_, 10);
    for (std::size_t k = 0; k < 2; ++k) {
      shorted_[k] = watched && (shorted_[k] || world().sensing().overcurrent[k]);
    }
  }

  void measure(base::SimTime now, const std::array<double, 2>& target) {
    const base::AxisSensing& sensing = world().sensing();
    open_load_.advance(target, sensing.coil_current);
    if (by_spi() && target != latest_target_) {
      forward_ = latest_target_[0] * target[1] - latest_target_[1] * target[0] >= 0.0;
      stepped_at_ = now;
    }
    latest_target_ = target;
    if (now - stepped_at_ >= kStandstill) {
      stall_guard_.reset();
      cool_step_.reset();
      return;
    }
    const unsigned threshold = bits(stall_control_, 14, 8);
    const control::StallGuardSettings settings{
        .threshold = static_cast<int>(threshold) - (threshold >= 64 ? 128 : 0),
        .filter = bit(stall_control_, 16)};
    if (stall_guard_.advance(settings, target, forward_, sensing)) {
      const auto register_field = [this](unsigned high, unsigned low) {
        return static_cast<std::uint8_t>(bits(smart_control_, high, low));
      };
      const control::CoolStepSettings cool{.minimum = register_field(15, 15),
                                           .down_step = register_field(14, 13),
                                           .up_step = register_field(6, 5),
                                           .hysteresis = register_field(11, 8),
                                           .hysteresis_start = register_field(3, 0)};
      constexpr unsigned kPerScale = 8;  // CoolStep's settings count 256 to its 32 scales
      cool_step_.measured(cool,
                          static_cast<std::uint8_t>(current_scale() * kPerScale + kPerScale - 1),
                          stall_guard_.value());
    }
  }

  double sense_resistor_;
  std::uint32_t shift_ = 0;
  unsigned clocks_ = 0;

  // Registers as written; all 0 after power-on, hence off.
  std::uint32_t drive_control_ = 0;  ///< DRVCTRL while STEP and DIR rule
  std::uint32_t coil_control_ = 0;   ///< DRVCTRL with SDOFF
  std::uint32_t chopper_control_ = 0;
  std::uint32_t smart_control_ = 0;
  std::uint32_t stall_control_ = 0;
  std::uint32_t driver_configuration_ = 0;

  std::int64_t position_ = 0;  ///< 1/256 full steps
  bool forward_ = true;
  base::SimTime stepped_at_;
  std::array<double, 2> latest_target_{};
  std::array<bool, 2> shorted_{};
  control::MicrostepSequencer sequencer_;
  control::StallGuard stall_guard_;
  control::CoolStep cool_step_;
  control::OpenLoadDetector open_load_;
};

constexpr std::array<PinDeclaration, 7> kPins{
    {{"sck", PinUse::watches, false, ""},
     {"mosi", PinUse::watches, false, "SDO of the chip"},
     {"miso", PinUse::drives, true, "SDI of the chip"},
     {"cs", PinUse::watches, false, "selects at low level"},
     {"step", PinUse::watches, true, "each rising edge is one microstep; DEDGE: both edges"},
     {"dir", PinUse::watches, true, "high: backward"},
     {"enable", PinUse::watches, true, "low: the coils have current; not wired: always"}}};

constexpr std::array<ParameterDeclaration, 8> kParameters{
    {kStepperMotor,
     {"sense_resistor", "ohm", 0.01, 10.0, 0.075, "full scale is 0.31 V or, with VSENSE, 0.165 V"},
     kMotorSupply,
     kLoadInertia,
     kLoadFriction,
     kLoadTorque,
     kMinimumStop,
     kMaximumStop}};

}  // namespace

constinit const PeripheralType kSpiStepperDriver{
    "spi-stepper-driver",
    "stepper motor behind a driver on SPI, TMC262",
    kPins,
    kParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<SpiStepperDriver>(settings);
    }};

}  // namespace stator::board

// Potentiometer, RC filter, LED and loads: what makes a voltage, or something of a mean level.

#include <array>

#include "stator/base/random.hpp"
#include "stator/board/parts/decay.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

class Potentiometer final : public Peripheral, public AnalogSource {
 public:
  explicit Potentiometer(const Settings& settings)
      : supply_(settings.number("supply_voltage")), position_(settings.number("position")) {}

  AnalogSource* analog_output() override { return this; }
  [[nodiscard]] double voltage(base::SimTime now) const override {
    if (noise_ == 0.0) {
      return wiper();
    }
    // A track that is worn: each moment has its own voltage, the same in every run.
    base::Random random(static_cast<std::uint64_t>(now.nanoseconds()));
    return wiper() + noise_ * (2.0 * random.uniform() - 1.0);
  }

  std::vector<base::Signal> signals() const override {
    return {{"voltage", "V", base::SignalReader::bind<&Potentiometer::wiper>(*this)}};
  }
  std::vector<base::Input> inputs() override {
    return {
        {"position", "", 0.0, 1.0, base::Delegate<void(double)>::bind<&Potentiometer::turn>(*this),
         base::InputGroup::sensors, position_},
        {"noise", "V", 0.0, 100.0, base::Delegate<void(double)>::bind<&Potentiometer::wear>(*this),
         base::InputGroup::sensors}};
  }

 private:
  [[nodiscard]] double wiper() const { return supply_ * position_; }
  void turn(double position) { position_ = position; }
  void wear(double volt) { noise_ = volt; }

  double supply_;
  double position_;
  double noise_ = 0.0;  ///< V by which its voltage is off at most, either way
};

/// A resistor and a capacitor behind an output: v' = (mean level * supply - v) / (R C), solved
/// exactly between changes of the mean. The ripple of PWM or of the one-bit converter itself is
/// not in it: it is smaller than a count of the converters behind it for the R C customary there.
class RcFilter final : public Peripheral, public AnalogSource {
 public:
  explicit RcFilter(const Settings& settings)
      : supply_(settings.number("supply_voltage")),
        rate_(1e9 / (settings.number("resistance") * settings.number("capacitance"))) {}

  void begin(base::SimTime now) override { mean_changed(now, 0, mean(0)); }
  void mean_changed(base::SimTime now, std::size_t /*pin*/, double mean) override {
    from_ = voltage(now);
    since_ = now;
    target_ = supply_ * mean;
  }
  AnalogSource* analog_output() override { return this; }
  [[nodiscard]] double voltage(base::SimTime now) const override {
    return target_ + (from_ - target_) * decay((now - since_).seconds() * rate_);
  }
  std::vector<base::Signal> signals() const override {
    return {{"voltage", "V", base::SignalReader::bind<&RcFilter::present>(*this)}};
  }

 private:
  [[nodiscard]] double present() const { return voltage(now()); }

  double supply_;
  double rate_;  ///< 1/s
  double target_ = 0.0;
  double from_ = 0.0;
  base::SimTime since_;
};

class Led final : public Peripheral {
 public:
  explicit Led(const Settings& settings) : active_low_(settings.flag("active_low")) {}

  std::vector<base::Signal> signals() const override {
    return {{"brightness", "", base::SignalReader::bind<&Led::brightness>(*this)}};
  }

 private:
  [[nodiscard]] double brightness() const { return active_low_ ? 1.0 - mean(0) : mean(0); }

  bool active_low_;
};

/// A resistor from an output to ground or to the supply, and a screwdriver across it. What draws
/// more than the pin bears is a short to the chip.
class Load final : public Peripheral {
 public:
  explicit Load(const Settings& settings)
      : supply_(settings.number("supply_voltage")),
        resistance_(settings.number("resistance")),
        to_supply_(settings.flag("to_supply")),
        short_current_(settings.number("short_current")) {}

  void begin(base::SimTime now) override { apply(now); }
  std::vector<base::Signal> signals() const override {
    return {{"current", "A", base::SignalReader::bind<&Load::current>(*this)}};
  }
  std::vector<base::Input> inputs() override {
    return {{"resistance", "ohm", 0.0, 1e9,
             base::Delegate<void(double)>::bind<&Load::set_resistance>(*this),
             base::InputGroup::load, resistance_},
            {"short", "", 0.0, 2.0, base::Delegate<void(double)>::bind<&Load::shorten>(*this),
             base::InputGroup::driver}};
  }

 private:
  /// Mean current through the resistor; 0 while shorted, when it has no voltage.
  [[nodiscard]] double current() const {
    if (in_force_ != LineShort::none) {
      return 0.0;
    }
    return supply_ * (to_supply_ ? 1.0 - mean(0) : mean(0)) / resistance_;
  }
  void set_resistance(double ohm) {
    resistance_ = ohm;
    apply(now());
  }
  void shorten(double to) {
    by_hand_ = to >= 1.5 ? LineShort::supply : to >= 0.5 ? LineShort::ground : LineShort::none;
    apply(now());
  }
  void apply(base::SimTime now) {
    in_force_ = by_hand_;
    if (in_force_ == LineShort::none && supply_ > short_current_ * resistance_) {
      in_force_ = to_supply_ ? LineShort::supply : LineShort::ground;
    }
    set_short(now, 0, in_force_);
  }

  double supply_;
  double resistance_;
  bool to_supply_;
  double short_current_;
  LineShort by_hand_ = LineShort::none;
  LineShort in_force_ = LineShort::none;
};

constexpr ParameterDeclaration kLogicSupply{"supply_voltage", "V", 0.0, 35.0, 3.3,
                                            "of a high level"};

constexpr std::array<ParameterDeclaration, 2> kPotentiometerParameters{
    {{"supply_voltage", "V", 0.0, 35.0, 3.3, "across the potentiometer"},
     {"position", "", 0.0, 1.0, 0.5, "of the wiper at power-on"}}};

constexpr std::array<PinDeclaration, 1> kOutputPin{
    {{"line", PinUse::averages, false, "the output it is wired to"}}};
constexpr std::array<ParameterDeclaration, 3> kRcParameters{
    {kLogicSupply,
     {"resistance", "ohm", 1.0, 1e9, 10'000.0, ""},
     {"capacitance", "nF", 0.001, 1e9, 1000.0, ""}}};
constexpr std::array<ParameterDeclaration, 1> kLedParameters{
    {{"active_low", "", 0.0, 1.0, 0.0, "1: it shines while the line is low"}}};
constexpr std::array<ParameterDeclaration, 4> kLoadParameters{
    {{"supply_voltage", "V", 0.0, 35.0, 24.0, "of a high level"},
     {"resistance", "ohm", 0.0, 1e9, 1000.0, ""},
     {"to_supply", "", 0.0, 1.0, 0.0, "1: from the supply to the line, else to ground"},
     {"short_current", "A", 0.001, 100.0, 0.2, "above it the pin is shorted"}}};

template <typename Model>
std::unique_ptr<Peripheral> make(const Settings& settings) {
  return std::make_unique<Model>(settings);
}

}  // namespace

constinit const PeripheralType kPotentiometer{
    "potentiometer",     "a voltage that people turn", {}, kPotentiometerParameters, {},
    &make<Potentiometer>};

constinit const PeripheralType kRcFilter{"rc-filter", "makes a voltage of an output's mean level",
                                         kOutputPin,  kRcParameters,
                                         {},          &make<RcFilter>};

constinit const PeripheralType kLed{
    "led", "shines with an output's mean level", kOutputPin, kLedParameters, {}, &make<Led>};

constinit const PeripheralType kLoad{"load",     "a resistor at an output, with shorts on demand",
                                     kOutputPin, kLoadParameters,
                                     {},         &make<Load>};

}  // namespace stator::board

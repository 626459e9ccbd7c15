// A chain of shift registers with output latches, as 74HC595 make one.

#include <array>

#include "stator/board/parts/numbered.hpp"
#include "stator/board/peripheral/peripheral.hpp"
#include "stator/board/peripheral/peripheral_types.hpp"

namespace stator::board {

namespace {

/// Takes a bit at each rising edge of SCK and hands on the one that falls out at the far end; the
/// outputs take over when CS rises. The bit sent last appears at output 0.
class ShiftRegister final : public Peripheral, public SpiSlave {
 public:
  explicit ShiftRegister(const Settings& settings)
      : stages_(static_cast<std::size_t>(settings.integer("outputs"))),
        outputs_(stages_.size()),
        numbered_(*this, stages_.size()) {}

  SpiSlave* spi() override { return this; }
  std::uint64_t exchange(const mfc::SpiTransfer& transfer) override {
    return clock_word(*this, transfer);
  }
  void select(base::SimTime /*now*/) override {}
  [[nodiscard]] Drive output() const override { return driven(stages_[next_] != 0); }
  void take(base::SimTime /*now*/, bool bit) override {
    // A ring: the stage at the far end becomes the first.
    stages_[next_] = bit ? 1 : 0;
    next_ = next_ + 1 < stages_.size() ? next_ + 1 : 0;
  }
  void deselect(base::SimTime /*now*/) override {
    for (std::size_t k = 0; k < stages_.size(); ++k) {
      outputs_[stages_.size() - 1 - k] = stages_[(next_ + k) % stages_.size()];
    }
  }

  [[nodiscard]] double number_value(std::size_t k) const { return outputs_[k]; }
  void set_number(std::size_t /*k*/, double /*value*/) {}
  std::vector<base::Signal> signals() const override {
    std::vector<base::Signal> result;
    numbered_.append_signals(result, "output");
    return result;
  }

 private:
  std::vector<std::uint8_t> stages_;
  std::vector<std::uint8_t> outputs_;
  std::size_t next_ = 0;  ///< the far end of the chain
  Numbered<ShiftRegister> numbered_;
};

constexpr std::array<PinDeclaration, 4> kPins{
    {{"sck", PinUse::watches, false, "shifts at rising edges"},
     {"mosi", PinUse::watches, false, "SDO of the chip"},
     {"miso", PinUse::drives, true, "far end of the chain, while CS is low"},
     {"cs", PinUse::watches, false, "its rising edge latches the outputs"}}};
constexpr std::array<ParameterDeclaration, 1> kParameters{
    {{"outputs", "", 8.0, 256.0, 8.0, "stages of the chain"}}};

}  // namespace

constinit const PeripheralType kShiftRegister{
    "shift-register",
    "chain of shift registers with latched outputs, 74HC595",
    kPins,
    kParameters,
    {},
    [](const Settings& settings) -> std::unique_ptr<Peripheral> {
      return std::make_unique<ShiftRegister>(settings);
    }};

}  // namespace stator::board

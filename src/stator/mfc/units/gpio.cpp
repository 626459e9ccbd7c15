#include "stator/mfc/units/gpio.hpp"

namespace stator::mfc {

std::uint16_t Gpio::levels() const {
  return static_cast<std::uint16_t>(emergency_ ? outputs_ >> 16 : outputs_);
}

void Gpio::tell(base::SimTime time, std::uint16_t levels_before, std::uint16_t driven_before,
                SignalSink& sink) const {
  for (std::size_t i = 0; i < kLines; ++i) {
    if (((levels() ^ levels_before) >> i & 1) != 0) {
      sink.change(time, offset(Signal::gpo0, i), level(i));
    }
    if (((configuration_ ^ driven_before) >> i & 1) != 0) {
      sink.enable(time, offset(Signal::gpo0, i), driven(i));
    }
  }
}

void Gpio::write_outputs(base::SimTime time, std::uint32_t outputs, SignalSink& sink) {
  const std::uint16_t before = levels();
  outputs_ = outputs;
  tell(time, before, configuration_, sink);
}

void Gpio::write_configuration(base::SimTime time, std::uint16_t configuration, SignalSink& sink) {
  const std::uint16_t before = configuration_;
  configuration_ = configuration;
  tell(time, levels(), before, sink);
}

void Gpio::set_emergency(base::SimTime time, bool active, SignalSink& sink) {
  const std::uint16_t before = levels();
  emergency_ = active;
  tell(time, before, configuration_, sink);
}

void Gpio::input(std::size_t line, bool level) {
  const auto bit = static_cast<std::uint16_t>(1U << line);
  inputs_ = static_cast<std::uint16_t>(level ? inputs_ | bit : inputs_ & ~bit);
}

}  // namespace stator::mfc

#pragma once

#include <cstddef>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// General purpose inputs and outputs (registers 47 to 49; TMC8461 datasheet L9975-L10013): plain
/// logic, which does nothing by itself. The rules of all units are in signal.hpp.
class Gpio {
 public:
  static constexpr std::size_t kLines = 16;

  /// GPO, 32 bits: levels, and in bits 31:16 the levels of an emergency.
  void write_outputs(base::SimTime time, std::uint32_t outputs, SignalSink& sink);
  [[nodiscard]] std::uint32_t outputs() const { return outputs_; }
  /// GPIO_CONFIG: 1 drives an output, 0 leaves it high-impedance.
  void write_configuration(base::SimTime time, std::uint16_t configuration, SignalSink& sink);
  [[nodiscard]] std::uint16_t configuration() const { return configuration_; }
  void set_emergency(base::SimTime time, bool active, SignalSink& sink);

  /// The pin of GPI`line` has `level`.
  void input(std::size_t line, bool level);
  /// GPI.
  [[nodiscard]] std::uint16_t inputs() const { return inputs_; }

  /// All outputs are told as they change: there are few changes and each is a write.
  [[nodiscard]] bool level(std::size_t line) const { return ((levels() >> line) & 1U) != 0; }
  [[nodiscard]] bool driven(std::size_t line) const { return ((configuration_ >> line) & 1U) != 0; }

 private:
  [[nodiscard]] std::uint16_t levels() const;
  void tell(base::SimTime time, std::uint16_t levels_before, std::uint16_t driven_before,
            SignalSink& sink) const;

  std::uint32_t outputs_ = 0;
  std::uint16_t configuration_ = 0;
  std::uint16_t inputs_ = 0;
  bool emergency_ = false;
};

}  // namespace stator::mfc

#pragma once

#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/mfc/pins/signal.hpp"

namespace stator::mfc {

/// What triggers the watchdog besides levels of lines.
enum class WatchdogTrigger : std::uint8_t {
  pdi_select,      ///< rising edge of PDI_SPI_CSN
  mfc_select,      ///< rising edge of MFC_CTRL_SPI_CSN
  start_of_frame,  ///< of EtherCAT
};

/// What the watchdog does with the 24 MFC IO lines.
struct WatchdogAction {
  bool active = false;
  std::uint32_t lines = 0;    ///< those affected; 0 if not active
  std::uint32_t levels = 0;   ///< WD_OUT_POL
  std::uint32_t enables = 0;  ///< WD_OE_POL: 1 output, 0 input
  friend constexpr bool operator==(const WatchdogAction&, const WatchdogAction&) = default;
};

/// The watchdog between crossbar and pads (registers 53 to 58; TMC8461 datasheet L10032-L10249).
/// Its counter runs at 25 MHz. The rules of all units are in signal.hpp.
class Watchdog {
 public:
  static constexpr std::uint32_t kLines = 0x00FF'FFFF;

  void advance(base::SimTime to, SignalSink& sink);
  /// When the time runs out; never() if it is off or has run out.
  [[nodiscard]] base::SimTime next_event() const;

  /// WD_TIME in 40 ns; 0 is off. Ends the action, clears WD_MAX and starts from 0.
  void write_time(std::uint32_t time);
  /// WD_CFG, bits 4:0.
  void write_configuration(std::uint8_t configuration) { configuration_ = configuration & 0x1F; }
  /// WD_OUT_MASK_POL: levels in bits 23:0, mask in bits 55:32.
  void write_outputs(std::uint64_t mask_and_levels) { outputs_ = mask_and_levels; }
  /// WD_OE_POL.
  void write_output_enables(std::uint32_t enables) { enables_ = enables; }
  /// WD_IN_MASK_POL: levels in bits 23:0, mask in bits 55:32. Does not trigger by itself.
  void write_inputs(std::uint64_t mask_and_levels) { inputs_ = mask_and_levels; }

  [[nodiscard]] std::uint32_t time() const { return time_; }
  /// WD_CFG as read: bit 7 tells of an active action.
  [[nodiscard]] std::uint8_t configuration() const;
  [[nodiscard]] std::uint64_t outputs() const { return outputs_; }
  [[nodiscard]] std::uint32_t output_enables() const { return enables_; }
  [[nodiscard]] std::uint64_t inputs() const { return inputs_; }
  /// WD_MAX: the largest value the counter has had since WD_TIME was written, 40 ns.
  [[nodiscard]] std::uint32_t peak() const;

  void trigger(WatchdogTrigger trigger);
  /// The actual levels of the pins, also of those the chip drives (T61-MWD-005).
  void set_lines(std::uint32_t levels);
  [[nodiscard]] WatchdogAction action() const;
  /// The time has run out, and nothing has ended that.
  [[nodiscard]] bool expired() const { return expired_; }

 private:
  [[nodiscard]] bool condition() const;
  [[nodiscard]] std::uint32_t counter() const;
  void retrigger();

  std::uint32_t time_ = 0;
  std::uint8_t configuration_ = 0;
  std::uint64_t outputs_ = 0;
  std::uint32_t enables_ = 0;
  std::uint64_t inputs_ = 0;
  std::uint32_t lines_ = 0;
  base::SimTime now_;
  std::int64_t started_ = 0;  ///< tick of 40 ns at which the counter was 0
  std::uint32_t peak_ = 0;    ///< before started_
  bool expired_ = false;
};

}  // namespace stator::mfc

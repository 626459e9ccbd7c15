#pragma once

#include <array>
#include <cstdint>

namespace stator::control::foc {

/// Raw values of ADC group A: 0..65535.
struct CurrentGroup {
  std::array<std::uint16_t, 2> current{0x8000, 0x8000};  ///< I0 (phase U or X), I1 (phase W or Y)
  std::uint16_t motor_supply = 0;                        ///< VM, divided down
  std::uint16_t general_a = 0;                           ///< AGPI_A
  std::uint16_t general_b = 0;                           ///< AGPI_B
};

/// Raw values of ADC group B, the analog encoder: 0..65535.
struct EncoderGroup {
  std::uint16_t ux = 0x8000;
  std::uint16_t vn = 0x8000;
  std::uint16_t wy = 0x8000;

  friend bool operator==(const EncoderGroup&, const EncoderGroup&) = default;
};

/// What arrived at an ABN interface. More than one edge may lie in a period, so edges come counted,
/// the way a quadrature counter sees a wire: `count` rises while A leads B. Its two lower bits are
/// the levels: 0 = none, 1 = A, 2 = A and B, 3 = B.
struct AbnSignals {
  std::int64_t count = 0;      ///< quadrature edges since any moment, forward positive
  std::uint32_t passages = 0;  ///< N pulses met so far, modulo 2^32
  std::int64_t n_count = 0;    ///< `count` of the lowest position N covers, at the latest pulse
  std::int32_t n_width = 1;    ///< positions N covers, > 0
  bool n = false;              ///< level of N
};

/// PWM_IN as its counters see it; without a signal the period is 0.
struct PulseSignal {
  std::uint32_t period = 0;  ///< 10 ns
  std::uint32_t high = 0;    ///< 10 ns
  bool level = false;
};

/// Digital inputs without decoder of their own.
struct PinLevels {
  std::uint8_t halls = 7;   ///< bits 0, 1, 2: levels of UX, V, WY; open inputs read 1
  bool left_switch = true;  ///< levels of the reference switches; open inputs read 1
  bool home_switch = true;
  bool right_switch = true;
  bool enable = true;               ///< the power stage enable of the drive
  bool direction = false;           ///< level of DIR: high counts steps down
  std::uint8_t general_inputs = 0;  ///< GPI
  std::uint32_t steps = 0;          ///< pulses at STEP since any moment, modulo 2^32
  PulseSignal pwm_in;
};

/// What comes to the pins of the FOC block, once per PWM period: the moment at which a period
/// begins and the currents are sampled.
struct Inputs : PinLevels {
  CurrentGroup delta_sigma_a;
  EncoderGroup delta_sigma_b;
  CurrentGroup spi_a;
  EncoderGroup spi_b;
  AbnSignals abn;
  AbnSignals abn_2;
};

/// How the half bridges are driven: PWM_CHOP.
enum class Chopper : std::uint8_t {
  off = 0,
  low_sides_on = 1,
  high_sides_on = 2,
  off_3 = 3,
  off_4 = 4,
  low_side = 5,   ///< the low side switches, the high side stays off
  high_side = 6,  ///< the high side switches, the low side stays off
  centred = 7,    ///< both, centred in the period: what FOC needs
};

/// What the PWM engine does in the period that now begins.
struct PwmPeriod {
  /// On-time of the high sides of U/X1, V/X2, W/Y1, Y2 in ticks of 10 ns, 0..period.
  std::array<std::int32_t, 4> on_time{};
  std::int32_t period = 4000;     ///< ticks of 10 ns
  std::int32_t pause_high = 20;   ///< 10 ns by which a high side switches on later
  std::int32_t pause_low = 20;    ///< the same for low sides
  std::uint8_t half_bridges = 0;  ///< how many of the four are used
  Chopper chopper = Chopper::off;

  friend bool operator==(const PwmPeriod&, const PwmPeriod&) = default;
};

/// What leaves the FOC block.
struct Outputs {
  PwmPeriod pwm;
  bool enable = false;         ///< ENABLE_OUT
  bool brake_chopper = false;  ///< BRAKE_CHOPPER
  bool status = false;         ///< STATUS_OUT: a flag chosen by STATUS_MASK is set
};

}  // namespace stator::control::foc

// The registers of the I/O block: which unit they belong to, and what each side may do.

#include <algorithm>

#include "stator/mfc/block/block.hpp"

namespace stator::mfc {

namespace {

using namespace register_number;

constexpr unsigned kSlot = 16;  ///< addresses per register

constexpr std::uint64_t width_mask(unsigned number) {
  const unsigned bits = kRegisters[number].width_bits();
  return bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

template <typename T>
constexpr T as(std::uint64_t value) {
  return static_cast<T>(value);
}
constexpr std::uint64_t unsigned_of(std::int32_t value) {
  return static_cast<std::uint32_t>(value);
}

constexpr bool in_range(unsigned number, unsigned first, unsigned last) {
  return number >= first && number <= last;
}

/// Whether a write with this value starts something, so that a transfer of the same value is not
/// the same as none.
bool acts(unsigned number, std::uint64_t value) {
  constexpr std::uint64_t kClearOnce = 1U << 5;        // ENC_MODE
  constexpr std::uint64_t kSingleTrigger = 1U << 15;   // SPI_CONF
  constexpr std::uint64_t kClearCounts = 0x0010'1010;  // SD_CFG
  switch (number) {
    case kPositionWrite:
    case kSpiTxData:
    case kSdCh0Steptarget:
    case kSdCh1Steptarget:
    case kSdCh2Steptarget:
    case kWdTime:
      return true;
    case kI2cControl:
      return value != 0;
    case kEncMode:
      return (value & kClearOnce) != 0;
    case kSpiConf:
      return (value & kSingleTrigger) != 0;
    case kSdCfg:
      return (value & kClearCounts) != 0;
    default:
      return false;
  }
}

}  // namespace

/// The units that a register belongs to. What others do by themselves an access to it neither shows
/// nor changes.
std::uint32_t Block::units_of(std::size_t number) {
  if (number <= kEncLatch || in_range(static_cast<unsigned>(number), kGpo, kGpioConfig)) {
    return 0;
  }
  if (number <= kSpiTime) {
    return 1U << spi_unit;
  }
  if (number <= kI2cDataW) {
    return 1U << i2c_unit;
  }
  if (number <= kSdCfg) {
    return 1U << steps_unit;
  }
  if (number <= kPwmPulseLength) {
    return 1U << pwm_unit;
  }
  return number == kDacVal ? 1U << dac_unit : kAllUnits;
}

void Block::advance_units_of(std::uint16_t address, std::size_t length) {
  std::uint32_t units = 0;
  for (std::size_t number = address / kSlot; number * kSlot < address + length; ++number) {
    units |= units_of(number);
  }
  advance_units(units);
}

void Block::read(std::uint16_t address, std::span<std::byte> out) {
  advance_units_of(address, out.size());
  settle();
  for (std::size_t i = 0; i < out.size();) {
    const std::size_t at = address + i;
    const std::size_t number = at / kSlot;
    const std::size_t first = at % kSlot;
    const std::size_t count = std::min<std::size_t>(kSlot - first, out.size() - i);
    std::uint64_t value = 0;
    if (number < kRegisterCount && number != kSyncEventCount && first < kRegisters[number].size) {
      value = read_register(static_cast<unsigned>(number), true);
    }
    for (std::size_t byte = first; byte < first + count; ++byte, ++i) {
      const bool exists = number < kRegisterCount && byte < kRegisters[number].size;
      out[i] = exists ? static_cast<std::byte>(value >> (8 * byte)) : std::byte{0};
    }
  }
  settle();
}

void Block::write(std::uint16_t address, std::span<const std::byte> data) {
  advance_units_of(address, data.size());
  settle();
  for (std::size_t i = 0; i < data.size();) {
    const std::size_t number = (address + i) / kSlot;
    const std::size_t first = (address + i) % kSlot;
    const std::size_t count = std::min<std::size_t>(kSlot - first, data.size() - i);
    if (number < kRegisterCount && kRegisters[number].direction == Direction::write &&
        !bridge_.map().mapped(number)) {
      std::uint64_t value = held(static_cast<unsigned>(number));
      unsigned written = 0;
      for (std::size_t byte = first; byte < first + count && byte < kRegisters[number].size;
           ++byte) {
        const auto bits = std::to_integer<std::uint64_t>(data[i + byte - first]);
        value = (value & ~(std::uint64_t{0xFF} << (8 * byte))) | bits << (8 * byte);
        written |= 1U << byte;
      }
      if (written != 0) {
        write_register(static_cast<unsigned>(number), value, static_cast<std::uint8_t>(written));
      }
    }
    i += count;
  }
  settle();
}

std::uint64_t Block::transfer_out(unsigned number, bool clear) {
  return number == kSyncEventCount ? sync_counts_ : read_register(number, clear);
}

void Block::transfer_in(unsigned number, std::uint64_t value, std::uint8_t written) {
  value &= width_mask(number);
  if (value != held(number) || acts(number, value)) {
    write_register(number, value, written);
  }
}

/// What a writable register holds: what was written last, by whichever side, or by the chip itself,
/// which brings NEXTSR into STEPRATE (L9723-L9729).
std::uint64_t Block::held(unsigned number) const {
  return in_range(number, kSdCh0Steprate, kSdCh2Steprate)
             ? unsigned_of(steps_.channel(number - kSdCh0Steprate).rate())
             : written_[number];
}

std::uint64_t Block::read_register(unsigned number, bool clear) {
  if (in_range(number, kSdCh0Steprate, kSdCh2Nextsr)) {
    const StepChannel& channel = steps_.channel((number - kSdCh0Steprate) % 3);
    switch ((number - kSdCh0Steprate) / 3) {
      case 0:
        return unsigned_of(channel.rate());
      case 1:
        return unsigned_of(channel.count());
      case 2:
        return channel.remaining();
      case 3:
        return unsigned_of(channel.compare());
      default:
        return unsigned_of(channel.next_rate());
    }
  }
  switch (number) {
    case kEncMode:
      return encoder_.mode();
    case kEncStatus:
      return clear ? encoder_.read_status() : encoder_.status();
    case kPositionRead:
      return unsigned_of(encoder_.position());
    case kEncLatch:
      return unsigned_of(encoder_.latch());
    case kSpiRxData:
      return spi_.received_data();
    case kSpiStatus:
      return spi_.status();
    case kI2cStatus:
      return i2c_.status();
    case kI2cDataR:
      return i2c_.received_data();
    case kGpi:
      return gpio_.inputs();
    case kMfcioIrqFlags:
      return clear ? irq_.read_flags() : irq_.flags();
    case kMfcioIrqCfg:
      return irq_.mask();
    case kWdCfg:
      return watchdog_.configuration();
    case kWdMax:
      return watchdog_.peak();
    case kHvAnaStatus:
      return analog_status();
    default:
      return written_[number];
  }
}

std::uint32_t Block::analog_status() {
  bring_pins_up_to_date();
  return pads_.status() | (overheated_ ? 1U << 24 : 0U) |
         (regulators_.fixed_short_flag() ? 1U << 25 : 0U) |
         (regulators_.adjustable_short_flag() ? 1U << 26 : 0U) |
         (regulators_.adjustable_overheated_flag() ? 1U << 27 : 0U);
}

void Block::write_register(unsigned number, std::uint64_t value, std::uint8_t written) {
  stale_ |= units_of(number);
  value &= width_mask(number);
  written_[number] = value;
  if (write_serial_register(number, value, written)) {
    return;
  }
  ++output_changes_;
  if (!write_generator_register(number, value)) {
    write_other_register(number, value);
  }
}

bool Block::write_serial_register(unsigned number, std::uint64_t value, std::uint8_t written) {
  switch (number) {
    case kEncMode:
      encoder_.write_mode(now_, as<std::uint16_t>(value), *this);
      return true;
    case kPositionWrite:
      encoder_.write_position(static_cast<std::int32_t>(as<std::uint32_t>(value)));
      return true;
    case kEncConst:
      encoder_.write_constant(as<std::uint32_t>(value));
      return true;
    case kSpiTxData: {
      const unsigned highest = (spi_.length() & 0x3FU) / 8;
      spi_.write_data(value, (written >> highest & 1U) != 0, *this);
      return true;
    }
    case kSpiConf:
      spi_.write_configuration(as<std::uint16_t>(value), *this);
      return true;
    case kSpiLength:
      spi_.write_length(as<std::uint8_t>(value));
      return true;
    case kSpiTime:
      spi_.write_time(as<std::uint8_t>(value));
      return true;
    case kI2cTimebase:
      i2c_.write_timebase(as<std::uint8_t>(value));
      return true;
    case kI2cControl:
      if (value != 0) {
        i2c_.write_control(as<std::uint8_t>(value));
      }
      return true;
    case kI2cAddress:
      i2c_.write_address(as<std::uint8_t>(value));
      return true;
    case kI2cDataW:
      i2c_.write_data(as<std::uint8_t>(value));
      return true;
    default:
      return false;
  }
}

bool Block::write_generator_register(unsigned number, std::uint64_t value) {
  if (in_range(number, kSdCh0Steprate, kSdCh2Nextsr)) {
    const std::size_t channel = (number - kSdCh0Steprate) % 3;
    const auto bits = as<std::uint32_t>(value);
    switch ((number - kSdCh0Steprate) / 3) {
      case 0:
        steps_.write_rate(channel, static_cast<std::int32_t>(bits), *this);
        break;
      case 2:
        steps_.write_target(channel, bits);
        break;
      case 3:
        steps_.write_compare(channel, static_cast<std::int32_t>(bits));
        break;
      default:
        steps_.write_next_rate(channel, static_cast<std::int32_t>(bits));
        break;
    }
    return true;
  }
  if (in_range(number, kPwm1, kPwm4)) {
    pwm_.write_duty(number - kPwm1, as<std::uint16_t>(value), *this);
    return true;
  }
  if (in_range(number, kPwm1Cntrshft, kPwm4Cntrshft)) {
    pwm_.write_shift(number - kPwm1Cntrshft, as<std::uint16_t>(value), *this);
    return true;
  }
  switch (number) {
    case kSdSteplength:
      steps_.write_lengths(value);
      return true;
    case kSdDelay:
      steps_.write_delays(value);
      return true;
    case kSdCfg:
      steps_.write_configuration(as<std::uint32_t>(value), *this);
      return true;
    case kPwmCfg:
      pwm_.write_configuration(value, *this);
      return true;
    case kPwmPulseBPulseA:
      pwm_.write_marks(as<std::uint32_t>(value), *this);
      return true;
    case kPwmPulseLength:
      pwm_.write_pulse_length(as<std::uint8_t>(value), *this);
      return true;
    default:
      return false;
  }
}

void Block::write_other_register(unsigned number, std::uint64_t value) {
  switch (number) {
    case kGpo:
      gpio_.write_outputs(now_, as<std::uint32_t>(value), *this);
      break;
    case kGpioConfig:
      gpio_.write_configuration(now_, as<std::uint16_t>(value), *this);
      break;
    case kDacVal:
      dac_.write_value(as<std::uint16_t>(value), *this);
      break;
    case kMfcioIrqCfg:
      irq_.write_mask(as<IrqSet>(value));
      break;
    case kWdTime:
      watchdog_.write_time(as<std::uint32_t>(value));
      break;
    case kWdCfg:
      watchdog_.write_configuration(as<std::uint8_t>(value));
      break;
    case kWdOutMaskPol:
      watchdog_.write_outputs(value);
      break;
    case kWdOePol:
      watchdog_.write_output_enables(as<std::uint32_t>(value));
      break;
    case kWdInMaskPol:
      bring_pins_up_to_date();
      watchdog_.set_lines(pads_.inputs());
      watchdog_.write_inputs(value);
      update_watching();
      break;
    case kHvioCfg:
      pads_.configure(as<std::uint32_t>(value));
      crossbar_.configure(configuration_, as<std::uint32_t>(value));
      apply_crossbar();
      break;
    case kBuckConvCfg:
      regulators_.configure(now_, as<std::uint16_t>(value));
      break;
    case kAlOverride:
      al_override_ = (value & 1U) != 0;
      bring_pins_up_to_date();
      break;
    default:
      break;
  }
}

}  // namespace stator::mfc

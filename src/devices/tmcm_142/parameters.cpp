#include "devices/tmcm_142/parameters.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string_view>

namespace stator::devices::tmcm_142 {

namespace {

using tmcl::ParameterDeclaration;
using enum tmcl::ParameterUnit;

struct Access {
  bool writable;
  bool stored;
  bool storable = false;
};
constexpr Access kR{.writable = false, .stored = false};
constexpr Access kRW{.writable = true, .stored = false};
constexpr Access kRWE{.writable = true, .stored = true};
/// Listed for STAP and RSAP although the letter E is missing (A56).
constexpr Access kRWListed{.writable = true, .stored = false, .storable = true};

struct Range {
  std::int32_t minimum;
  std::int32_t maximum;
};
constexpr std::int32_t kLargest = std::numeric_limits<std::int32_t>::max();
constexpr Range kAny{std::numeric_limits<std::int32_t>::min(), kLargest};
constexpr Range kNotNegative{0, kLargest};
constexpr Range kSwitch{0, 1};
constexpr Range kChipAcceleration{1, 16777215};
constexpr Range kFactor{0, 16777215};  // A27: the chip's 24 bits
constexpr Range kCanIdentifier{0, 0x7FF};

constexpr ParameterDeclaration row(std::uint8_t number, std::string_view name,
                                   std::string_view symbol, Access access, Range range,
                                   std::int32_t initial, tmcl::ParameterUnit unit,
                                   std::string_view unit_text = {}) {
  return {.number = number,
          .name = name,
          .symbol = symbol,
          .writable = access.writable,
          .stored = access.stored,
          .storable = access.storable,
          .minimum = range.minimum,
          .maximum = range.maximum,
          .initial = initial,
          .unit = unit,
          .unit_text = unit_text};
}

// clang-format off
constexpr std::array kAxisParameters{
    row(0, "Target position", "TARGET_POSITION", kRWListed, kAny, 0, microsteps),
    row(1, "Actual position", "ACTUAL_POSITION", kRWListed, kAny, 0, microsteps),
    row(2, "Target speed", "TARGET_SPEED", kRWListed, kAny, 0, velocity),
    row(3, "Actual speed", "ACTUAL_SPEED", kRWListed, kAny, 0, velocity),
    row(4, "Max. positioning speed", "MAX_POSITIONING_SPEED", kRWE, kNotNegative, 500000, velocity),
    row(5, "Max. acceleration and deceleration", "MAX_ACCELERATION_AND_DECELERATION", kRWE, kChipAcceleration, 50000, acceleration),
    row(6, "Max. current", "MAX_CURRENT", kRWE, {0, 15}, 8, current_scale),
    row(7, "Standby current", "STANDBY_CURRENT", kRWE, {0, 15}, 2, current_scale),
    row(8, "Position reached", "POSITION_REACHED", kR, kSwitch, 0, flag),
    row(9, "Switch status", "SWITCH_STATUS", kR, {0, 63}, 0, bits),
    row(10, "Right limit switch status", "RIGHT_LIMIT_SWITCH_STATUS", kR, kSwitch, 0, flag),
    row(11, "Left limit switch status", "LEFT_LIMIT_SWITCH_STATUS", kR, kSwitch, 0, flag),
    row(12, "Right limit switch disable", "RIGHT_LIMIT_SWITCH_DISABLE", kRWE, kSwitch, 0, flag),
    row(13, "Left limit switch disable", "LEFT_LIMIT_SWITCH_DISABLE", kRWE, kSwitch, 0, flag),
    row(14, "Switch mode", "SWITCH_MODE", kRWE, {0, 0x1F3C}, 0, bits),
    row(15, "Stop deceleration", "STOP_DECELERATION", kRWE, kChipAcceleration, 50000, acceleration),
    row(16, "Max. acceleration", "MAX_ACCELERATION", kRWE, kChipAcceleration, 50000, acceleration),
    row(17, "Max. deceleration", "MAX_DECELERATION", kRWE, kChipAcceleration, 50000, acceleration),
    row(18, "Bow", "BOW", kRWE, {0, 18}, 0, other, "bow index (usteps/t^3 scale)"),
    row(19, "Shaft", "SHAFT", kRWE, kSwitch, 0, flag),
    row(20, "Standby delay", "STANDBY_DELAY", kRWE, {0, 4095}, 50, other, "65536/fCLK = 4.096 ms"),
    row(21, "Mixed decay run", "MIXED_DECAY_RUN", kRWE, kSwitch, 1, flag),
    row(22, "Mixed decay standby", "MIXED_DECAY_STANDBY", kRWE, kSwitch, 0, flag),
    row(23, "Chopper clock divider", "CHOPPER_CLOCK_DIVIDER", kRWE, {96, 818}, 444, other, "16 MHz / value"),
    row(25, "Actual load value", "ACTUAL_LOAD_VALUE", kR, {0, 7}, 0, other, "stallGuard steps"),
    row(26, "Driver status", "DRIVER_STATUS", kR, {0, 3}, 0, bits),
    row(27, "Microstep resolution", "MICROSTEP_RESOLUTION", kRWE, {0, 11}, 1, enumeration),
    row(28, "PID tolerance", "PID_TOLERANCE", kRWE, {0, 1048575}, 0, microsteps),
    row(29, "Sine wave offset", "SINE_WAVE_OFFSET", kRWE, {0, 255}, 0, other, "1/1024 of sine amplitude"),
    row(30, "PID p factor", "PID_P_FACTOR", kRWE, kFactor, 0, other, "1/256"),
    row(31, "PID i factor", "PID_I_FACTOR", kRWE, kFactor, 0, other, "1/256"),
    row(32, "PID d factor", "PID_D_FACTOR", kRWE, kFactor, 0, other, "1"),
    row(33, "PID i clipping", "PID_I_CLIPPING", kRWE, {0, 32640}, 0, other, "65536"),
    row(34, "PID i sum", "PID_I_SUM", kRW, kAny, 0, none),
    row(35, "PID d clock divider", "PID_D_CLOCK_DIVIDER", kRWE, {0, 255}, 0, other, "divider"),
    row(37, "PID dv clipping", "PID_DV_CLIPPING", kRWE, kNotNegative, 0, velocity),
    row(38, "PID error", "PID_ERROR", kR, {-8388608, 8388607}, 0, microsteps),
    row(39, "PID Vactual", "PID_VACTUAL", kR, kAny, 0, velocity),
    row(40, "PID mode", "PID_MODE", kRWE, kSwitch, 0, flag),
    row(41, "Encoder position", "ENCODER_POSITION", kR, kAny, 0, microsteps),
    row(42, "Encoder constant", "ENCODER_CONSTANT", kRWE, kNotNegative, 65536, other, "1/65536 ustep, or 16.16 decimal (hi usteps, lo 1/10000)"),
    row(43, "Encoder mode", "ENCODER_MODE", kRWE, {0, 0x21FF}, 0, bits),
    row(44, "Encoder status", "ENCODER_STATUS", kR, kSwitch, 0, flag),
    row(45, "Encoder latch", "ENCODER_LATCH", kR, kAny, 0, microsteps),
    row(46, "Position latch", "POSITION_LATCH", kR, kAny, 0, microsteps),
    row(47, "Encoder warn distance", "ENCODER_WARN_DISTANCE", kRWE, {0, 8388607}, 0, microsteps),
    row(48, "Compare position", "COMPARE_POSITION", kRWE, kAny, 0, microsteps),
    row(50, "Right position limit", "RIGHT_POSITION_LIMIT", kRWE, kAny, 0, microsteps),
    row(51, "Left position limit", "LEFT_POSITION_LIMIT", kRWE, kAny, 0, microsteps),
    row(52, "Right position limit enable", "RIGHT_POSITION_LIMIT_ENABLE", kRWE, kSwitch, 0, flag),
    row(53, "Left position limit enable", "LEFT_POSITION_LIMIT_ENABLE", kRWE, kSwitch, 0, flag),
    row(63, "Microstep table position", "MICROSTEP_TABLE_POSITION", kRWListed, {0, 8191}, 0, other, "table entry"),
    row(64, "Step pulse length", "STEP_PULSE_LENGTH", kRWE, {0, 255}, 0, other, "1/16 MHz = 62.5 ns"),
    row(128, "Ramp mode", "RAMP_MODE", kRWListed, {0, 3}, 0, enumeration),
    row(129, "Status flags", "STATUS_FLAGS", kR, {0, 15}, 0, bits),
    row(130, "Velocity reached", "VELOCITY_REACHED", kR, kSwitch, 0, flag),
    row(193, "Reference search mode", "REFERENCE_SEARCH_MODE", kRWE, {1, 3}, 1, enumeration),
    row(194, "Reference search speed", "REFERENCE_SEARCH_SPEED", kRWE, kNotNegative, 0, velocity),
    row(195, "Reference switch speed", "REFERENCE_SWITCH_SPEED", kRWE, kNotNegative, 0, velocity),
    row(196, "End switch distance", "END_SWITCH_DISTANCE", kR, kNotNegative, 0, microsteps),
    row(207, "Error flags", "ERROR_FLAGS", kR, {0, 3}, 0, bits),
    row(212, "Maximum encoder deviation", "MAXIMUM_ENCODER_DEVIATION", kRWE, kNotNegative, 0, microsteps),
    row(255, "Unit conversion mode", "UNIT_CONVERSION_MODE", kRWE, kSwitch, 0, enumeration),
};

constexpr std::array kConfiguration{
    row(64, "EEPROM magic", "EEPROM_MAGIC", kRWE, {0, 255}, 0xE4, none),
    row(65, "RS232/RS485 baud rate", "BAUD_RATE", kRWE, {0, 11}, 0, enumeration),
    row(66, "serial address", "SERIAL_ADDRESS", kRWE, {0, 255}, 1, none),
    row(67, "ASCII mode", "ASCII_MODE", kRWE, {0, 0x31}, 0, bits),
    row(69, "CAN bit rate", "CAN_BIT_RATE", kRWE, {1, 8}, 8, enumeration),
    row(70, "CAN reply ID", "CAN_REPLY_ID", kRWE, kCanIdentifier, 2, none),
    row(71, "CAN ID", "CAN_ID", kRWE, kCanIdentifier, 1, none),
    row(73, "configuration EEPROM lock flag", "CONFIGURATION_EEPROM_LOCK_FLAG", kRWE, {0, 4321}, 0, none),
    row(75, "telegram pause time", "TELEGRAM_PAUSE_TIME", kRWE, {0, 255}, 0, milliseconds),
    row(76, "serial host address", "SERIAL_HOST_ADDRESS", kRWE, {0, 255}, 2, none),
    row(77, "auto start mode", "AUTO_START_MODE", kRWE, kSwitch, 0, flag),
    row(80, "shutdown pin functionality", "SHUTDOWN_PIN_FUNCTIONALITY", kRWE, {0, 2}, 0, enumeration),
    row(81, "TMCL code protection", "TMCL_CODE_PROTECTION", kRWE, {0, 3}, 0, enumeration),
    row(83, "CAN secondary address", "CAN_SECONDARY_ADDRESS", kRWE, kCanIdentifier, 0, none),
    row(84, "coordinate storage", "COORDINATE_STORAGE", kRWE, kSwitch, 0, flag),
    row(128, "TMCL application status", "TMCL_APPLICATION_STATUS", kR, {0, 3}, 0, enumeration),
    row(129, "download mode", "DOWNLOAD_MODE", kR, kSwitch, 0, flag),
    row(130, "TMCL program counter", "TMCL_PROGRAM_COUNTER", kR, {0, 2047}, 0, other, "command index"),
    row(132, "tick timer", "TICK_TIMER", kRW, kAny, 0, milliseconds),
    row(133, "random number", "RANDOM_NUMBER", kR, kNotNegative, 0, none),
};
// clang-format on

constexpr std::uint8_t kVariables = 56;
constexpr std::uint8_t kVariableBank = 2;
constexpr std::string_view kVariableName = "general purpose variable #";
constexpr std::string_view kVariableSymbol = "VARIABLE_";

/// A word and a number of one or two digits.
template <std::size_t WordLength>
struct NumberedWord {
  std::array<char, WordLength + 2> characters{};
  std::size_t length = 0;

  constexpr NumberedWord() = default;
  constexpr NumberedWord(std::string_view word, unsigned number) {
    for (const char c : word) {
      append(c);
    }
    if (number >= 10) {
      append(static_cast<char>('0' + number / 10));
    }
    append(static_cast<char>('0' + number % 10));
  }

  [[nodiscard]] constexpr std::string_view view() const { return {characters.data(), length}; }

 private:
  constexpr void append(char c) { characters[length++] = c; }
};

template <std::size_t WordLength>
constexpr auto numbered_words(std::string_view word) {
  std::array<NumberedWord<WordLength>, kVariables> words;
  for (unsigned i = 0; i < kVariables; ++i) {
    words[i] = NumberedWord<WordLength>(word, i);
  }
  return words;
}

constexpr auto kVariableNames = numbered_words<kVariableName.size()>(kVariableName);
constexpr auto kVariableSymbols = numbered_words<kVariableSymbol.size()>(kVariableSymbol);

constexpr auto all_global_parameters() {
  std::array<ParameterDeclaration, kConfiguration.size() + kVariables> rows;
  for (std::size_t i = 0; i < kConfiguration.size(); ++i) {
    rows[i] = kConfiguration[i];
  }
  for (std::uint8_t i = 0; i < kVariables; ++i) {
    ParameterDeclaration& variable = rows[kConfiguration.size() + i];
    variable = row(i, kVariableNames[i].view(), kVariableSymbols[i].view(), kRWE, kAny, 0, none);
    variable.bank = kVariableBank;
  }
  return rows;
}

constexpr auto kGlobalParameters = all_global_parameters();

}  // namespace

std::span<const ParameterDeclaration> axis_parameters() {
  return kAxisParameters;
}

std::span<const ParameterDeclaration> global_parameters() {
  return kGlobalParameters;
}

}  // namespace stator::devices::tmcm_142

namespace stator::devices {

namespace {

/// Firmware 4.45: minor number in the lowest byte, major one in the next, the type number in the
/// upper half is not used (L5201-L5216, A89).
constexpr std::int32_t kVersionValue = 4 << 8 | 45;

// Connector 3 (L254-L298); output 7 is an internal line (A73).
constexpr std::uint32_t kDigitalInputs = 0x1FF;
constexpr std::uint32_t kAnalogInputs = 0x007;
constexpr std::uint32_t kOutputs = 0x087;

}  // namespace

const tmcl::ModuleDescription& tmcm_142_description() {
  static const tmcl::ModuleDescription description{
      .product = "tmcm-142",
      .commands = tmcl::classic_command_set(),
      .axis_parameters = tmcm_142::axis_parameters(),
      .global_parameters = tmcm_142::global_parameters(),
      .version_text = "142V4.45",
      .version_value = kVersionValue,
      .digital_inputs = kDigitalInputs,
      .analog_inputs = kAnalogInputs,
      .outputs = kOutputs,
      .input_bits = kDigitalInputs};
  return description;
}

}  // namespace stator::devices

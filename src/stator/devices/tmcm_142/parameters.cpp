#include "stator/devices/tmcm_142/parameters.hpp"

#include <algorithm>
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

/// Where the document tells of it, and what a row cannot say.
constexpr ParameterDeclaration documented(ParameterDeclaration declaration, std::string_view source,
                                          std::string_view notes = {}) {
  declaration.source = source;
  declaration.notes = notes;
  return declaration;
}

// clang-format off
constexpr std::array kAxisParameters{
    documented(row(0, "Target position", "TARGET_POSITION", kRWListed, kAny, 0, microsteps),
               "L1112-L1114;L1481-L1483;L5231-L5233", "writing starts positioning (AAP example); STAP/RSAP list contains it although letter E is missing"),
    documented(row(1, "Actual position", "ACTUAL_POSITION", kRWListed, kAny, 0, microsteps),
               "L1115-L1117;L1484-L1486;L5234-L5236", "STAP/RSAP list contains it"),
    documented(row(2, "Target speed", "TARGET_SPEED", kRWListed, kAny, 0, velocity),
               "L1118-L1120;L1487-L1489;L5237-L5239", "ROL/ROR/MST write here"),
    documented(row(3, "Actual speed", "ACTUAL_SPEED", kRWListed, kAny, 0, velocity),
               "L1121-L1123;L1490-L1492;L5240-L5242", "listed as writable (A104)"),
    documented(row(4, "Max. positioning speed", "MAX_POSITIONING_SPEED", kRWE, kNotNegative, 500000, velocity),
               "L1124-L1125;L1493-L1494;L5243-L5244", "used by MVP"),
    documented(row(5, "Max. acceleration and deceleration", "MAX_ACCELERATION_AND_DECELERATION", kRWE, kChipAcceleration, 50000, acceleration),
               "L1126-L1127;L1495-L1496;L5245-L5246", "write sets AP16 and AP17"),
    documented(row(6, "Max. current", "MAX_CURRENT", kRWE, {0, 15}, 8, current_scale),
               "L1128-L1130;L1497-L1499;L5247-L5249", "0=0%, 15=100%"),
    documented(row(7, "Standby current", "STANDBY_CURRENT", kRWE, {0, 15}, 2, current_scale),
               "L1131-L1133;L1500-L1502;L5250-L5252", "0=0%, 15=100%"),
    documented(row(8, "Position reached", "POSITION_REACHED", kR, kSwitch, 0, flag),
               "L1503-L1504;L5253-L5254", "1 while target == actual"),
    documented(row(9, "Switch status", "SWITCH_STATUS", kR, {0, 63}, 0, bits),
               "L1513-L1533;L5255-L5266", "bits 2,3 cleared by reading; see bit_fields.csv"),
    documented(row(10, "Right limit switch status", "RIGHT_LIMIT_SWITCH_STATUS", kR, kSwitch, 0, flag),
               "L1535-L1541;L5267"),
    documented(row(11, "Left limit switch status", "LEFT_LIMIT_SWITCH_STATUS", kR, kSwitch, 0, flag),
               "L1543-L1549;L5268"),
    documented(row(12, "Right limit switch disable", "RIGHT_LIMIT_SWITCH_DISABLE", kRWE, kSwitch, 0, flag),
               "L1134-L1135;L1551-L1558;L5269-L5270", "1 = switch function off"),
    documented(row(13, "Left limit switch disable", "LEFT_LIMIT_SWITCH_DISABLE", kRWE, kSwitch, 0, flag),
               "L1136-L1137;L1560-L1567;L5271-L5272", "1 = switch function off"),
    documented(row(14, "Switch mode", "SWITCH_MODE", kRWE, {0, 0x1F3C}, 0, bits),
               "L1140-L1154;L5283-L5310", "bits 2,3,4,5,8-12 documented; see bit_fields.csv"),
    documented(row(15, "Stop deceleration", "STOP_DECELERATION", kRWE, kChipAcceleration, 50000, acceleration),
               "L1156-L1157;L5312-L5322", "used when a stop switch is touched"),
    documented(row(16, "Max. acceleration", "MAX_ACCELERATION", kRWE, kChipAcceleration, 50000, acceleration),
               "L1159-L1161;L5324-L5333"),
    documented(row(17, "Max. deceleration", "MAX_DECELERATION", kRWE, kChipAcceleration, 50000, acceleration),
               "L1163-L1165;L5335-L5344"),
    documented(row(18, "Bow", "BOW", kRWE, {0, 18}, 0, other, "bow index (usteps/t^3 scale)"),
               "L1166-L1178;L5346-L5368", "0=trapezoid; 1..18: bow value 2^(index-1); printed end value 262144 contradicts (A24)"),
    documented(row(19, "Shaft", "SHAFT", kRWE, kSwitch, 0, flag),
               "L1180-L1181;L5370-L5379", "1 = reverse direction"),
    documented(row(20, "Standby delay", "STANDBY_DELAY", kRWE, {0, 4095}, 50, other, "65536/fCLK = 4.096 ms"),
               "L1183-L1185;L2302-L2305;L5381-L5392", "STAP text prints 4.069 ms (A25)"),
    documented(row(21, "Mixed decay run", "MIXED_DECAY_RUN", kRWE, kSwitch, 1, flag),
               "L1187-L1188;L5394-L5403"),
    documented(row(22, "Mixed decay standby", "MIXED_DECAY_STANDBY", kRWE, kSwitch, 1, flag),
               "L1190-L1191;L5405-L5414"),
    documented(row(23, "Chopper clock divider", "CHOPPER_CLOCK_DIVIDER", kRWE, {96, 818}, 444, other, "16 MHz / value"),
               "L1193-L1197;L5416-L5428", "do not change"),
    documented(row(25, "Actual load value", "ACTUAL_LOAD_VALUE", kR, {0, 7}, 0, other, "stallGuard steps"),
               "L1703-L1709;L5430-L5436", "7=low load, 0=high load; access letter lost (A103)"),
    documented(row(26, "Driver status", "DRIVER_STATUS", kR, {0, 3}, 0, bits),
               "L1711-L1716;L5438-L5443", "bit0 driver error, bit1 over-temperature pre-warning; access letter lost (A103)"),
    documented(row(27, "Microstep resolution", "MICROSTEP_RESOLUTION", kRWE, {0, 11}, 1, enumeration),
               "L1206-L1232;L5454-L5482", "0=2048 ... 11=fullstep; see enumerations.csv; must be rewritten after AP29"),
    documented(row(28, "PID tolerance", "PID_TOLERANCE", kRWE, {0, 1048575}, 0, microsteps),
               "L1234-L1248;L5484-L5500", "hysteresis"),
    documented(row(29, "Sine wave offset", "SINE_WAVE_OFFSET", kRWE, {0, 255}, 0, other, "1/1024 of sine amplitude"),
               "L1250-L1270;L5502-L5524", "effective after AP27 is set again"),
    documented(row(30, "PID p factor", "PID_P_FACTOR", kRWE, kFactor, 0, other, "1/256"),
               "L1272-L1281;L5526-L5537", "printed maximum 1677215 (A27); result pid_e*p/256, clip +-2^31"),
    documented(row(31, "PID i factor", "PID_I_FACTOR", kRWE, kFactor, 0, other, "1/256"),
               "L1283-L1291;L5539-L5549", "printed maximum 1677215 (A27); result (isum/256)*i/256, clip +-2^31"),
    documented(row(32, "PID d factor", "PID_D_FACTOR", kRWE, kFactor, 0, other, "1"),
               "L1293-L1311;L5551-L5571", "printed maximum 1677215 (A27); result (e_last-e_now)*d, delta clip +-127"),
    documented(row(33, "PID i clipping", "PID_I_CLIPPING", kRWE, {0, 32640}, 0, other, "65536"),
               "L1313-L1321;L5573-L5583", "limits pid_isum"),
    documented(row(34, "PID i sum", "PID_I_SUM", kRW, kAny, 0, none),
               "L1840-L1846;L5585-L5591", "text: cleared to zero upon write access, but not in the SAP list (A33); access letter lost"),
    documented(row(35, "PID d clock divider", "PID_D_CLOCK_DIVIDER", kRWE, {0, 255}, 0, other, "divider"),
               "L1323-L1336;L5602-L5617", "0 acts as 256; D rate = fCLK/(128*value)"),
    documented(row(37, "PID dv clipping", "PID_DV_CLIPPING", kRWE, kNotNegative, 0, velocity),
               "L1338-L1341;L5619-L5631", "limits the PID velocity contribution"),
    documented(row(38, "PID error", "PID_ERROR", kR, {-8388608, 8388607}, 0, microsteps),
               "L1875-L1883;L5633-L5641", "clipped to +-2^23; access letter lost (A103)"),
    documented(row(39, "PID Vactual", "PID_VACTUAL", kR, kAny, 0, velocity),
               "L1885-L1897;L5643-L5655", "PID_base selects result or sum (A29); access letter lost"),
    documented(row(40, "PID mode", "PID_MODE", kRWE, kSwitch, 0, flag),
               "L1342-L1343;L5657-L5666", "0 off, 1 on"),
    documented(row(41, "Encoder position", "ENCODER_POSITION", kR, kAny, 0, microsteps),
               "L1908-L1916;L5668-L5676", "unit and minus sign garbled; write permission open (A34)"),
    documented(row(42, "Encoder constant", "ENCODER_CONSTANT", kRWE, kNotNegative, 65536, other, "1/65536 ustep, or 16.16 decimal (hi usteps, lo 1/10000)"),
               "L1344-L1350;L1918-L1942;L5678-L5704", "mode by AP43 bit 13; decimal low half 0..9999"),
    documented(row(43, "Encoder mode", "ENCODER_MODE", kRWE, {0, 0x21FF}, 0, bits),
               "L1351-L1370;L5706-L5738", "bits 0-8 and 13; see bit_fields.csv"),
    documented(row(44, "Encoder status", "ENCODER_STATUS", kR, kSwitch, 0, flag),
               "L1983-L1991;L5740-L5748", "null event seen; cleared by reading; access letter lost (A103)"),
    documented(row(45, "Encoder latch", "ENCODER_LATCH", kR, kAny, 0, microsteps),
               "L1993-L2000;L5750-L5757", "access letter lost (A103)"),
    documented(row(46, "Position latch", "POSITION_LATCH", kR, kAny, 0, microsteps),
               "L2002-L2007;L5759-L5760"),
    documented(row(47, "Encoder warn distance", "ENCODER_WARN_DISTANCE", kRWE, {0, 8388607}, 0, microsteps),
               "L1371-L1372;L5761-L5762", "no range printed (A39)"),
    documented(row(48, "Compare position", "COMPARE_POSITION", kRWE, kAny, 0, microsteps),
               "L1373-L1375;L5763-L5765", "function: to be defined in the document (A40)"),
    documented(row(50, "Right position limit", "RIGHT_POSITION_LIMIT", kRWE, kAny, 0, microsteps),
               "L1376-L1378;L5766-L5768", "limit for positive direction"),
    documented(row(51, "Left position limit", "LEFT_POSITION_LIMIT", kRWE, kAny, 0, microsteps),
               "L1379-L1381;L5769-L5771", "limit for negative direction"),
    documented(row(52, "Right position limit enable", "RIGHT_POSITION_LIMIT_ENABLE", kRWE, kSwitch, 0, flag),
               "L1382-L1383;L5772-L5773"),
    documented(row(53, "Left position limit enable", "LEFT_POSITION_LIMIT_ENABLE", kRWE, kSwitch, 0, flag),
               "L1384-L1385;L5774-L5775"),
    documented(row(63, "Microstep table position", "MICROSTEP_TABLE_POSITION", kRWListed, {0, 8191}, 0, other, "table entry"),
               "L1386-L1387;L5776-L5777"),
    documented(row(64, "Step pulse length", "STEP_PULSE_LENGTH", kRWE, {0, 255}, 0, other, "1/16 MHz = 62.5 ns"),
               "L1388-L1389;L2081-L2089;L5778-L5779", "unit garbled in two of three places"),
    documented(row(128, "Ramp mode", "RAMP_MODE", kRWListed, {0, 3}, 0, enumeration),
               "L1391-L1396;L2091-L2105;L5780-L5785", "0 positioning, 1 reserved, 2 velocity, 3 hold"),
    documented(row(129, "Status flags", "STATUS_FLAGS", kR, {0, 15}, 0, bits),
               "L2107-L2113;L5786-L5792", "see bit_fields.csv"),
    documented(row(130, "Velocity reached", "VELOCITY_REACHED", kR, kSwitch, 0, flag),
               "L2114-L2115;L5793-L5794", "1 while actual speed == target speed"),
    documented(row(193, "Reference search mode", "REFERENCE_SEARCH_MODE", kRWE, {1, 3}, 1, enumeration),
               "L1397-L1407;L5795-L5805", "see enumerations.csv and A50"),
    documented(row(194, "Reference search speed", "REFERENCE_SEARCH_SPEED", kRWE, kNotNegative, 0, velocity),
               "L1408-L1409;L5806-L5807", "reduces AP4 as search speed"),
    documented(row(195, "Reference switch speed", "REFERENCE_SWITCH_SPEED", kRWE, kNotNegative, 0, velocity),
               "L1410-L1411;L5808-L5809;L6132-L6133", "no unit printed; default a quarter of max. positioning speed per chapter 9.2"),
    documented(row(196, "End switch distance", "END_SWITCH_DISTANCE", kR, kNotNegative, 0, microsteps),
               "L2131-L2133;L5810-L5815", "valid after modes 2 or 3"),
    documented(row(207, "Error flags", "ERROR_FLAGS", kR, {0, 3}, 0, bits),
               "L2134-L2137;L5824-L5834", "bit1 encoder deviation stop; cleared by reading; bit 0 undocumented (A52)"),
    documented(row(212, "Maximum encoder deviation", "MAXIMUM_ENCODER_DEVIATION", kRWE, kNotNegative, 0, microsteps),
               "L1412-L1417;L5836-L5849", "0 = off; excess stops the motor and sets AP207 bit 1"),
    documented(row(255, "Unit conversion mode", "UNIT_CONVERSION_MODE", kRWE, kSwitch, 0, enumeration),
               "L1418-L1421;L5851-L5862", "0 TMC457 units, 1 PPS"),
};

constexpr std::array kConfiguration{
    documented(row(64, "EEPROM magic", "EEPROM_MAGIC", kRWE, {0, 255}, 0xE4, none),
               "L2922-L2925;L5938-L5941", "other value than 0xE4: factory defaults for all axis and global parameters at next power up"),
    documented(row(65, "RS232/RS485 baud rate", "BAUD_RATE", kRWE, {0, 11}, 0, enumeration),
               "L2927-L2938;L5943-L5954", "see enumerations.csv"),
    documented(row(66, "serial address", "SERIAL_ADDRESS", kRWE, {0, 255}, 1, none),
               "L2939;L5955;L3333-L3335", "module (target) address"),
    documented(row(67, "ASCII mode", "ASCII_MODE", kRWE, {0, 0x31}, 0, bits),
               "L2940-L2947;L5956-L5963;L860-L868", "bit0 start in ASCII; bits 5,4: 00 char echo, 01 line echo, 10 no echo"),
    documented(row(69, "CAN bit rate", "CAN_BIT_RATE", kRWE, {1, 8}, 8, enumeration),
               "L2956-L2978;L5965-L5972", "printed range 1..7 although 8 is listed as default (A11)"),
    documented(row(70, "CAN reply ID", "CAN_REPLY_ID", kRWE, kCanIdentifier, 2, none),
               "L2980-L2986;L5973"),
    documented(row(71, "CAN ID", "CAN_ID", kRWE, kCanIdentifier, 1, none),
               "L2988-L2994;L5974", "module (target) identifier"),
    documented(row(73, "configuration EEPROM lock flag", "CONFIGURATION_EEPROM_LOCK_FLAG", kRWE, {0, 4321}, 0, none),
               "L2996-L3004;L5975-L5976", "1234 locks, 4321 unlocks; read 1=locked; default 0 presumed (A60)"),
    documented(row(75, "telegram pause time", "TELEGRAM_PAUSE_TIME", kRWE, {0, 255}, 0, milliseconds),
               "L3006-L3018;L5977-L5981", "RS232: 0; RS485: 15 often necessary; no effect on CAN"),
    documented(row(76, "serial host address", "SERIAL_HOST_ADDRESS", kRWE, {0, 255}, 2, none),
               "L3020-L3027;L5982-L5983", "first byte of serial replies"),
    documented(row(77, "auto start mode", "AUTO_START_MODE", kRWE, kSwitch, 0, flag),
               "L3029-L3037;L5984-L5986", "1 = start program after power up"),
    documented(row(80, "shutdown pin functionality", "SHUTDOWN_PIN_FUNCTIONALITY", kRWE, {0, 2}, 0, enumeration),
               "L3039-L3049;L5987-L5990", "0 none, 1 high active, 2 low active"),
    documented(row(81, "TMCL code protection", "TMCL_CODE_PROTECTION", kRWE, {0, 3}, 0, enumeration),
               "L3051-L3071;L5991-L6000", "1 or 3 to 0 or 2 erases the program first"),
    documented(row(83, "CAN secondary address", "CAN_SECONDARY_ADDRESS", kRWE, kCanIdentifier, 0, none),
               "L3073-L3080;L6001-L6002", "0 = off"),
    documented(row(84, "coordinate storage", "COORDINATE_STORAGE", kRWE, kSwitch, 0, flag),
               "L3082-L3090;L6003-L6005;L4214-L4215", "0 RAM only, 1 EEPROM"),
    documented(row(128, "TMCL application status", "TMCL_APPLICATION_STATUS", kR, {0, 3}, 0, enumeration),
               "L3243-L3246;L6006-L6009", "0 stop, 1 run, 2 step, 3 reset"),
    documented(row(129, "download mode", "DOWNLOAD_MODE", kR, kSwitch, 0, flag),
               "L3247-L3248;L6010-L6011"),
    documented(row(130, "TMCL program counter", "TMCL_PROGRAM_COUNTER", kR, {0, 2047}, 0, other, "command index"),
               "L3249-L3250;L6012-L6013", "range derived from 2048-command memory"),
    documented(row(132, "tick timer", "TICK_TIMER", kRW, kAny, 0, milliseconds),
               "L3092-L3097;L3251-L3252;L6014-L6015", "can be preset"),
    documented(row(133, "random number", "RANDOM_NUMBER", kR, kNotNegative, 0, none),
               "L3253-L3254;L6016-L6017", "read only"),
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

/// Of those that the document lists one by one; the others share the last entry.
constexpr std::array<std::string_view, 21> kVariableSources{
    "L3116;L6037", "L3117;L6038", "L3118;L6039",
    "L3119;L6040", "L3120;L6041", "L3121;L6042",
    "L3122;L6043", "L3123;L6044", "L3124;L6045",
    "L3125;L6046", "L3126;L6047", "L3127;L6048",
    "L3128;L6049", "L3129;L6050", "L3130;L6051",
    "L3131;L6052", "L3132;L6053", "L3133;L6054",
    "L3134;L6055", "L3135;L6056", "L3136-L3137;L6057-L6058"};

constexpr auto all_global_parameters() {
  std::array<ParameterDeclaration, kConfiguration.size() + kVariables> rows;
  for (std::size_t i = 0; i < kConfiguration.size(); ++i) {
    rows[i] = kConfiguration[i];
  }
  for (std::uint8_t i = 0; i < kVariables; ++i) {
    ParameterDeclaration& variable = rows[kConfiguration.size() + i];
    variable = row(i, kVariableNames[i].view(), kVariableSymbols[i].view(), kRWE, kAny, 0, none);
    variable.bank = kVariableBank;
    variable.source = kVariableSources[std::min<std::size_t>(i, kVariableSources.size() - 1)];
    variable.notes = "RAM copy; STGP saves, RSGP and boot reload";
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

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "stator/mfc/registers/register_numbers.hpp"

namespace stator::mfc {

// The registers of the multi-function I/O block and their fields (TMC8461 datasheet sections 7.2
// and 7.3, L6285-L8104), declared once. Masks, sizes, the memory map and the printed table follow.

/// Which way a mapped register is transferred.
enum class Direction : std::uint8_t {
  none,   ///< no register
  write,  ///< master to block: memory block 0
  read,   ///< block to master: memory block 1
};

/// What one side may do with a field, in the document's notation.
enum class FieldAccess : std::uint8_t {
  none,         ///< "-"
  read,         ///< "r"
  read_clears,  ///< "r+c": reading clears it
  read_write,   ///< "r/w"
  write,        ///< "w": written; what it reads through the MFC CTRL SPI is the last value (A-40)
};

/// One register as the overview has it (L6295-L6441).
struct Register {
  std::uint8_t number = 0;
  std::string_view name;
  Direction direction = Direction::none;
  std::uint8_t size = 0;   ///< bytes
  std::uint16_t line = 0;  ///< of the overview in the document

  /// Address on the MFC CTRL SPI: register number and byte number (L1156-L1168).
  [[nodiscard]] constexpr std::uint16_t spi_address() const {
    return static_cast<std::uint16_t>(number << 4);
  }
  [[nodiscard]] constexpr unsigned width_bits() const { return size * 8U; }
  /// Bytes it takes in its memory block, padding included.
  [[nodiscard]] constexpr std::uint8_t mapped_size() const {
    return static_cast<std::uint8_t>((size + 3U) / 4U * 4U);
  }
  /// It has a configuration byte in the parameter RAM (0x05A2 + number).
  [[nodiscard]] constexpr bool mappable() const {
    return direction != Direction::none && number <= register_number::kSyncEventCount;
  }
};

inline constexpr std::size_t kRegisterCount = 67;
inline constexpr std::size_t kMappableCount = 64;

inline constexpr std::array<Register, kRegisterCount> kRegisters{{
    {0, "ENC_MODE", Direction::write, 2, 6301},
    {1, "ENC_STATUS", Direction::read, 1, 6303},
    {2, "X_ENC", Direction::write, 4, 6305},
    {3, "X_ENC", Direction::read, 4, 6307},
    {4, "ENC_CONST", Direction::write, 4, 6309},
    {5, "ENC_LATCH", Direction::read, 4, 6311},
    {6, "SPI_RX_DATA", Direction::read, 8, 6313},
    {7, "SPI_TX_DATA", Direction::write, 8, 6315},
    {8, "SPI_CONF", Direction::write, 2, 6317},
    {9, "SPI_STATUS", Direction::read, 1, 6319},
    {10, "SPI_LENGTH", Direction::write, 1, 6321},
    {11, "SPI_TIME", Direction::write, 1, 6323},
    {12, "I2C_TIMEBASE", Direction::write, 1, 6325},
    {13, "I2C_CONTROL", Direction::write, 1, 6327},
    {14, "I2C_STATUS", Direction::read, 1, 6329},
    {15, "I2C_ADDRESS", Direction::write, 1, 6331},
    {16, "I2C_DATA_R", Direction::read, 1, 6333},
    {17, "I2C_DATA_W", Direction::write, 1, 6335},
    {18, "SD_CH0_STEPRATE", Direction::write, 4, 6337},
    {19, "SD_CH1_STEPRATE", Direction::write, 4, 6339},
    {20, "SD_CH2_STEPRATE", Direction::write, 4, 6341},
    {21, "SD_CH0_STEPCOUNT", Direction::read, 4, 6343},
    {22, "SD_CH1_STEPCOUNT", Direction::read, 4, 6345},
    {23, "SD_CH2_STEPCOUNT", Direction::read, 4, 6347},
    {24, "SD_CH0_STEPTARGET", Direction::write, 4, 6349},
    {25, "SD_CH1_STEPTARGET", Direction::write, 4, 6351},
    {26, "SD_CH2_STEPTARGET", Direction::write, 4, 6353},
    {27, "SD_CH0_COMPARE", Direction::write, 4, 6355},
    {28, "SD_CH1_COMPARE", Direction::write, 4, 6360},
    {29, "SD_CH2_COMPARE", Direction::write, 4, 6362},
    {30, "SD_CH0_NEXTSR", Direction::write, 4, 6364},
    {31, "SD_CH1_NEXTSR", Direction::write, 4, 6366},
    {32, "SD_CH2_NEXTSR", Direction::write, 4, 6368},
    {33, "SD_STEPLENGTH", Direction::write, 6, 6370},
    {34, "SD_DELAY", Direction::write, 6, 6372},
    {35, "SD_CFG", Direction::write, 3, 6374},
    {36, "PWM_CFG", Direction::write, 8, 6376},
    {37, "PWM1", Direction::write, 2, 6378},
    {38, "PWM2", Direction::write, 2, 6380},
    {39, "PWM3", Direction::write, 2, 6382},
    {40, "PWM4", Direction::write, 2, 6384},
    {41, "PWM1_CNTRSHFT", Direction::write, 2, 6386},
    {42, "PWM2_CNTRSHFT", Direction::write, 2, 6388},
    {43, "PWM3_CNTRSHFT", Direction::write, 2, 6390},
    {44, "PWM4_CNTRSHFT", Direction::write, 2, 6392},
    {45, "PWM_PULSE_B_PULSE_A", Direction::write, 4, 6394},
    {46, "PWM_PULSE_LENGTH", Direction::write, 1, 6396},
    {47, "GPO", Direction::write, 4, 6398},
    {48, "GPI", Direction::read, 2, 6400},
    {49, "GPIO_CONFIG", Direction::write, 2, 6402},
    {50, "DAC_VAL", Direction::write, 2, 6404},
    {51, "MFCIO_IRQ_CFG", Direction::write, 3, 6406},
    {52, "MFCIO_IRQ_FLAGS", Direction::read, 3, 6408},
    {53, "WD_TIME", Direction::write, 4, 6410},
    {54, "WD_CFG", Direction::write, 1, 6412},
    {55, "WD_OUT_MASK_POL", Direction::write, 8, 6414},
    {56, "WD_OE_POL", Direction::write, 4, 6416},
    {57, "WD_IN_MASK_POL", Direction::write, 8, 6418},
    {58, "WD_MAX", Direction::read, 4, 6420},
    {59, "HV_ANA_STATUS", Direction::read, 4, 6422},
    {60, "reserved", Direction::none, 0, 6424},
    {61, "reserved", Direction::none, 0, 6429},
    {62, "reserved", Direction::none, 0, 6431},
    {63, "SYNC1_SYNC0_EVENT_CNT", Direction::read, 4, 6433},
    {64, "HVIO_CFG", Direction::write, 4, 6435},
    {65, "BUCK_CONV_CFG", Direction::write, 2, 6437},
    {66, "AL_OVERRIDE", Direction::write, 1, 6439},
}};

/// One field of a register, a row of the document's tables. Fields named "reserved" or "unused"
/// have no meaning.
// NOLINTNEXTLINE(clang-analyzer-optin.performance.Padding): columns of a table
struct RegisterField {
  std::uint8_t number = 0;  ///< of its register
  std::uint8_t bit_hi = 0;
  std::uint8_t bit_lo = 0;
  std::string_view name;
  FieldAccess ecat = FieldAccess::none;  ///< the master's, by a mapping into process data
  FieldAccess pdi = FieldAccess::none;   ///< the controller's, by the MFC CTRL SPI
  std::string_view range;                ///< legal values as text; empty: not said
  std::string_view lines;                ///< of the document
  std::string_view meaning;
  std::uint32_t reset = 0;

  [[nodiscard]] constexpr bool reserved() const { return name == "reserved" || name == "unused"; }
};

/// All fields in the order of register and bit; the tables of registers 0..17, 18..46 and 47..66.
[[nodiscard]] std::array<std::span<const RegisterField>, 3> register_field_groups();

/// The value of register `number` after a reset.
[[nodiscard]] std::uint64_t reset_value(unsigned number);

/// The register called `name` that is transferred in `direction`; nullptr if there is none. X_ENC
/// exists once for each direction.
[[nodiscard]] const Register* find_register(std::string_view name, Direction direction);

}  // namespace stator::mfc

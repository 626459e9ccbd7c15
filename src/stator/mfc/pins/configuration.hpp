#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stator::mfc {

/// When shadow register and register are exchanged (TMC8461 datasheet L8864-L8900).
enum class Trigger : std::uint8_t {
  always = 0,          ///< the shadow register is transparent
  sync0 = 1,           ///< rising edge of SYNC0
  sync1 = 2,           ///< rising edge of SYNC1
  latch0 = 3,          ///< rising edge of LATCH0
  latch1 = 4,          ///< rising edge of LATCH1
  start_of_frame = 5,  ///< of an Ethernet frame
  end_of_frame = 6,
  pdi_select = 7,      ///< falling edge of PDI_SPI_CSN
  pdi_deselect = 8,    ///< rising edge of PDI_SPI_CSN
  mfc_select = 9,      ///< falling edge of MFC_CTRL_SPI_CSN
  mfc_deselect = 10,   ///< rising edge of MFC_CTRL_SPI_CSN
  before_bridge = 11,  ///< before the memory bridge handles the register
  after_bridge = 12,   ///< after it has
  pwm_zero = 13,       ///< the PWM counter's zero pulse
  never = 14,
  always_too = 15,  ///< the same as always
};
inline constexpr std::size_t kTriggerCount = 16;

/// Names of the triggers in configuration files, by code.
inline constexpr std::array<std::string_view, kTriggerCount> kTriggerNames{
    "always",       "SYNC0",      "SYNC1",        "LATCH0",     "LATCH1",       "start-of-frame",
    "end-of-frame", "pdi-select", "pdi-deselect", "mfc-select", "mfc-deselect", "before-bridge",
    "after-bridge", "pwm-zero",   "never",        "always-15"};

/// The shadow register is transparent.
constexpr bool transparent(Trigger trigger) {
  return trigger == Trigger::always || trigger == Trigger::always_too;
}

/// A register's configuration byte (L8846-L8860).
struct Mapping {
  bool enabled = false;  ///< transferred to or from process data, written by the master only
  Trigger trigger = Trigger::always;

  friend constexpr bool operator==(Mapping, Mapping) = default;
};

inline constexpr std::size_t kLines = 24;             ///< MFCIO00..15, MFC_HV0..7
inline constexpr std::size_t kFirstHighVoltage = 16;  ///< line of MFC_HV0
inline constexpr std::size_t kHighVoltageLines = 8;

/// "MFCIO00".."MFCIO15", "MFC_HV0".."MFC_HV7" by line.
inline constexpr std::array<std::string_view, kLines> kLineNames{
    "MFCIO00", "MFCIO01", "MFCIO02", "MFCIO03", "MFCIO04", "MFCIO05", "MFCIO06", "MFCIO07",
    "MFCIO08", "MFCIO09", "MFCIO10", "MFCIO11", "MFCIO12", "MFCIO13", "MFCIO14", "MFCIO15",
    "MFC_HV0", "MFC_HV1", "MFC_HV2", "MFC_HV3", "MFC_HV4", "MFC_HV5", "MFC_HV6", "MFC_HV7"};

/// The block's configuration as EEPROM category 1 and the parameter RAM 0x0580..0x05FF hold it
/// (TMC8461 datasheet section 7.4, L8151-L8414). A plain copy of the bytes with names for them.
class Configuration {
 public:
  static constexpr std::uint16_t kAddress = 0x0580;  ///< of the parameter RAM
  static constexpr std::size_t kLength = 128;        ///< of the parameter RAM, bytes
  static constexpr std::size_t kUsedLength = 98;     ///< 0x0580..0x05E1

  /// Nothing connected, nothing mapped: all bytes 0 (L8425-L8427).
  constexpr Configuration() = default;
  /// Takes up to kLength bytes; missing ones become 0.
  explicit Configuration(std::span<const std::byte> bytes);

  [[nodiscard]] std::span<const std::byte, kLength> bytes() const { return bytes_; }

  /// Code of the signal at `line`, as in crossbar_signals.csv.
  [[nodiscard]] std::uint8_t signal(std::size_t line) const { return at(line); }
  void set_signal(std::size_t line, std::uint8_t code) { put(line, code); }

  /// As HVIO_CFG (register 64): slow slope 7:0, weak high 15:8, weak low 23:16, pairs 27:24.
  [[nodiscard]] std::uint32_t high_voltage() const;
  void set_high_voltage(std::uint32_t value);
  /// As BUCK_CONV_CFG (register 65).
  [[nodiscard]] std::uint16_t regulators() const;
  void set_regulators(std::uint16_t value);

  /// Start of memory block 0 (written by the master) or 1.
  [[nodiscard]] std::uint16_t block_start(unsigned block) const;
  void set_block_start(unsigned block, std::uint16_t address);

  /// Of register 0..63.
  [[nodiscard]] Mapping mapping(std::size_t number) const;
  void set_mapping(std::size_t number, Mapping mapping);

  friend bool operator==(const Configuration&, const Configuration&) = default;

 private:
  // Offsets from 0x0580.
  static constexpr std::size_t kHighVoltage = 0x18;
  static constexpr std::size_t kRegulators = 0x1C;
  static constexpr std::size_t kBlockStarts = 0x1E;
  static constexpr std::size_t kMappings = 0x22;

  [[nodiscard]] std::uint8_t at(std::size_t offset) const {
    return std::to_integer<std::uint8_t>(bytes_[offset]);
  }
  void put(std::size_t offset, unsigned value) { bytes_[offset] = static_cast<std::byte>(value); }

  std::array<std::byte, kLength> bytes_{};
};

}  // namespace stator::mfc

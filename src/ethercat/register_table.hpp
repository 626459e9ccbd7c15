#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace stator::ethercat {

/// Optional parts of a slave controller; a register that belongs to an absent part does not exist
/// for either side.
enum class ControllerFeature : std::uint32_t {
  always = 0,
  distributed_clocks = 1U << 0,
  write_protection = 1U << 1,      ///< 0x0020, 0x0021, 0x0030, 0x0031
  reset_registers = 1U << 2,       ///< 0x0040, 0x0041
  read_write_offset = 1U << 3,     ///< 0x0108
  led_override = 1U << 4,          ///< 0x0138, 0x0139
  pdi_information = 1U << 5,       ///< 0x014E
  mii_management = 1U << 6,        ///< 0x0510-0x051B
  parameter_ram = 1U << 7,         ///< 0x0580-0x05FF
  buffer_event_times = 1U << 8,    ///< 0x09F0-0x09FF
  product_identity = 1U << 9,      ///< 0x0E00-0x0E0F
  user_ram = 1U << 10,             ///< 0x0F80-0x0FFF
  sii_eight_byte_read = 1U << 11,  ///< 0x0502 bit 6
};
constexpr ControllerFeature operator|(ControllerFeature a, ControllerFeature b) {
  return static_cast<ControllerFeature>(static_cast<std::uint32_t>(a) |
                                        static_cast<std::uint32_t>(b));
}
/// True if all parts of `wanted` are in `present`.
constexpr bool has_feature(ControllerFeature present, ControllerFeature wanted) {
  return (static_cast<std::uint32_t>(present) & static_cast<std::uint32_t>(wanted)) ==
         static_cast<std::uint32_t>(wanted);
}

/// What one side, bus or host, may do with a register.
enum class Rights : std::uint8_t {
  none,
  read,
  read_write,
  read_acknowledge,  ///< a write stores nothing, it acknowledges the event the register reports
};

/// What an access causes besides moving bits. Named by the register group; which side and which
/// kind of access causes it stands in register_effects.cpp.
enum class Effect : std::uint8_t {
  none,
  station_address,
  unlock_registers,
  unlock_controller,
  write_protection,
  reset_by_bus,
  reset_by_host,
  dl_control,
  dl_status,
  al_control,
  al_status,
  event_mask,
  event_request,
  clear_receive_errors,
  clear_processing_unit_errors,
  clear_pdi_errors,
  clear_lost_links,
  watchdog_time,
  watchdog_status,
  clear_watchdog_counters,
  sii_access,
  sii_interface,
  fmmu,
  sync_manager,
  sync_manager_activate,
  sync_manager_host_control,
  receive_time,
  system_time,
  time_setting,
  time_loop,
  time_filter,
  speed_filter,
  speed_difference,
  clock_side,
  sync_activation,
  sync_status,
  sync_times,
  sync_cycle,
  latch_control,
  latch_status,
  latch_time,
  buffer_event_time,
};

/// True if the bytes written to such a register only trigger the effect and are not stored.
constexpr bool discards_value(Effect effect) {
  switch (effect) {
    case Effect::unlock_registers:
    case Effect::unlock_controller:
    case Effect::reset_by_bus:
    case Effect::reset_by_host:
    case Effect::clear_receive_errors:
    case Effect::clear_processing_unit_errors:
    case Effect::clear_pdi_errors:
    case Effect::clear_lost_links:
    case Effect::clear_watchdog_counters:
    case Effect::receive_time:
    case Effect::system_time:
      return true;
    default:
      return false;
  }
}

/// True if a read by the bus has to compute the value first or changes something.
constexpr bool has_bus_read_effect(Effect effect) {
  return effect == Effect::dl_status || effect == Effect::al_status ||
         effect == Effect::event_request || effect == Effect::system_time ||
         effect >= Effect::speed_difference;
}

/// How often a declaration occurs: once, or once per channel at the distance named.
enum class Repetition : std::uint8_t {
  once,
  per_fmmu,          ///< every 16 bytes
  per_sync_manager,  ///< every 8 bytes
};

/// One register as the device document declares it.
struct RegisterDeclaration {
  std::uint16_t address;  ///< of the first channel
  std::uint16_t width;    ///< bits
  std::string_view name;
  Rights bus;
  Rights host;
  std::uint64_t reset = 0;
  std::uint64_t writable = ~std::uint64_t{0};  ///< bits that keep what is written
  Effect effect = Effect::none;
  ControllerFeature feature = ControllerFeature::always;
  Repetition repetition = Repetition::once;
};

/// All registers an EtherCAT slave controller can have, by address (ETG.1000.4 §6; TMC8461
/// datasheet section "ESC register map").
[[nodiscard]] std::span<const RegisterDeclaration> register_declarations();

inline constexpr std::size_t kRegisterSpace = 0x1000;

/// The declared table spread to bytes for one device: what each of the 4096 register bytes allows.
class RegisterMap {
 public:
  struct Byte {
    std::uint8_t bus_stores = 0;   ///< bits a bus write changes
    std::uint8_t host_stores = 0;  ///< bits a host write changes
    bool bus_reads : 1 = false;
    bool bus_writes : 1 = false;
    bool host_reads : 1 = false;
    bool host_writes : 1 = false;
    Effect effect = Effect::none;
  };

  RegisterMap(ControllerFeature features, unsigned fmmu_count, unsigned sync_manager_count);

  [[nodiscard]] const Byte& operator[](std::size_t address) const { return bytes_[address]; }

  /// Writes the declared reset values of all existing registers; everything else becomes 0.
  void reset(std::span<std::byte, kRegisterSpace> registers) const;

 private:
  template <typename Visitor>
  void for_each_instance(Visitor visit) const;

  ControllerFeature features_;
  unsigned fmmu_count_;
  unsigned sync_manager_count_;
  std::array<Byte, kRegisterSpace> bytes_{};
};

}  // namespace stator::ethercat

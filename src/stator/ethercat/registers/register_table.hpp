#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "stator/ethercat/registers/register_effect.hpp"

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
  error_counters = 1U << 12,       ///< 0x030C-0x030E
  lost_link_counters = 1U << 13,   ///< 0x0310-0x0313
  mii_link_detection = 1U << 14,   ///< 0x0518-0x051B, 0x0510 bit 2
  sii_host_access = 1U << 15,      ///< 0x0500, 0x0501
  watchdog_setting = 1U << 16,     ///< 0x0400 and 0x0410 writable; without it they are constants
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

/// What one side, bus or host, may do with a field of a register, in the notations of the device
/// documents. What the condition of a conditional right is stands with the register's effect.
enum class Access : std::uint8_t {
  none,                     ///< "": the side sees nothing and changes nothing
  read,                     ///< "r"
  read_acknowledges,        ///< "r*": reading acknowledges the event the register reports
  read_write,               ///< "r/w"
  read_write_if,            ///< "r/(w)": written under a condition
  read_write_if_starts,     ///< "r/(w)": the same, but the bit only starts something, reads 0
  read_write_acknowledges,  ///< "r/(w ack)": a write stores nothing, it acknowledges the event
  read_write_clears,        ///< "r/w(clr)": a write of any value clears the group's counters
  read_write_special,       ///< "r/w (special)": a write of any value starts something
  write_special,            ///< "w": the write view of a register that reads something else
  write_if,                 ///< "(w)": likewise, stored under a condition
};

/// The notation that the document uses for `access`.
[[nodiscard]] std::string_view to_string(Access access);

constexpr bool may_read(Access access) {
  return access != Access::none && access != Access::write_special && access != Access::write_if;
}
constexpr bool may_write(Access access) {
  return access != Access::none && access != Access::read && access != Access::read_acknowledges;
}
/// True if what is written stays in the register.
constexpr bool stores(Access access) {
  return access == Access::read_write || access == Access::read_write_if ||
         access == Access::write_if;
}

/// What a declaration that stands for several registers is repeated for.
enum class Channels : std::uint8_t { one, fmmus, sync_managers, ports };

/// How often a declaration occurs, and how many bytes apart.
struct Repetition {
  Channels channels = Channels::one;
  std::uint8_t distance = 0;
};

/// The documents that describe the registers, as text.
enum class RegisterDocument : std::uint8_t {
  controller,  ///< of a slave controller on its own: TMC8461 datasheet
  drive,       ///< of a drive and its slave controller in one chip: TMC8670 datasheet
};

/// Lines of the documents at which a field stands. 0: not in that document.
struct DocumentLines {
  std::uint16_t controller = 0;
  std::uint16_t drive = 0;

  [[nodiscard]] constexpr std::uint16_t in(RegisterDocument document) const {
    return document == RegisterDocument::controller ? controller : drive;
  }
};

/// Where they begin to describe the process memory.
inline constexpr DocumentLines kProcessMemoryLines{6202, 1248};

/// One field of a register as the document's table has it, a row each. A field named "reserved"
/// takes writes where its right says so, but stores nothing and reads 0.
struct RegisterField {
  std::uint16_t bit_hi = 0;
  std::uint16_t bit_lo = 0;
  std::string_view name;
  Access bus = Access::none;
  Access host = Access::none;
  std::uint64_t reset = 0;  ///< after power-on; what depends on the build is in reset_registers()
  DocumentLines lines;

  [[nodiscard]] constexpr bool reserved() const { return name.starts_with("reserved"); }
};

/// What one byte of a register allows and holds, put together from its fields.
struct RegisterByte {
  std::uint8_t bus_stores = 0;   ///< bits a bus write changes
  std::uint8_t host_stores = 0;  ///< bits a host write changes
  std::uint8_t reset = 0;
  bool bus_reads = false;
  bool bus_writes = false;
  bool host_reads = false;
  bool host_writes = false;
  std::uint8_t more = 0;  ///< bytes of the register behind this one that allow the same, up to 7

  [[nodiscard]] constexpr bool allows_same_as(const RegisterByte& other) const {
    return bus_stores == other.bus_stores && host_stores == other.host_stores &&
           bus_reads == other.bus_reads && bus_writes == other.bus_writes &&
           host_reads == other.host_reads && host_writes == other.host_writes;
  }
};

/// One register as the device document declares it. Masks, reset values, rights and the printed
/// table are derived from its fields.
struct RegisterDeclaration {
  std::uint16_t address = 0;  ///< of the first channel
  std::uint16_t width = 0;    ///< bits
  std::string_view name;      ///< '#' stands for the channel's number
  Effect effect = Effect::none;
  ControllerFeature feature = ControllerFeature::always;
  Repetition repetition;
  ControllerFeature write_feature = ControllerFeature::always;  ///< without it, constants
  std::span<const RegisterField> fields;
  std::span<const RegisterByte> bytes;  ///< derived from `fields`
};

/// All registers an EtherCAT slave controller can have, by address (ETG.1000.4 §6; TMC8461
/// datasheet section "ESC register map"), in the document's groups: data link, application layer,
/// events and watchdogs, SII and MII, FMMUs and sync managers, distributed clocks, identity.
[[nodiscard]] std::array<std::span<const RegisterDeclaration>, 7> register_groups();

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
    bool built : 1 = false;     ///< the register is there, not only answered
    std::uint8_t more : 3 = 0;  ///< bytes behind this one that allow and cause the same
    Effect effect = Effect::none;

    /// Bytes from this one on that allow and cause the same, and may be dealt with together.
    [[nodiscard]] std::size_t run() const { return std::size_t{1} + more; }
  };

  /// `features` are the parts that are built. Of other parts only those in `answered_features`
  /// answer: their registers read 0 and ignore writes, but the working counter counts.
  RegisterMap(ControllerFeature features, ControllerFeature answered_features, unsigned fmmu_count,
              unsigned sync_manager_count);

  [[nodiscard]] const Byte& operator[](std::size_t address) const { return bytes_[address]; }

  /// Exchanges the rights of bus and host to write what steers the system time (0x0910..0x0935).
  void give_time_loop_to_host();

  /// True if the register is built or at least answers.
  [[nodiscard]] bool answers(const RegisterDeclaration& declaration) const {
    return has_feature(features_ | answered_features_, declaration.feature);
  }
  /// How many of a repeated register there are.
  [[nodiscard]] unsigned channel_count(Channels channels) const;

  /// Writes the declared reset values of all existing registers; everything else becomes 0.
  void reset(std::span<std::byte, kRegisterSpace> registers) const;

 private:
  void add_register(const RegisterDeclaration& declaration, std::size_t address);
  /// Calls `visit(declaration, address)` for every register that answers.
  template <typename Visitor>
  void for_each_register(Visitor visit) const;

  ControllerFeature features_;
  ControllerFeature answered_features_;
  unsigned fmmu_count_;
  unsigned sync_manager_count_;
  std::array<Byte, kRegisterSpace> bytes_{};
};

}  // namespace stator::ethercat

#include "stator/ethercat/controller/register_description.hpp"

#include <algorithm>
#include <cstdint>
#include <span>
#include <utility>

namespace stator::ethercat {

namespace {

/// What decides over a right in brackets, by what the register causes.
std::string_view condition_of(Effect effect) {
  switch (effect) {
    case Effect::al_control:
      return "bus: when the host has taken the request before; host: in acknowledge-by-write mode";
    case Effect::al_status:
      return "host: without device emulation";
    case Effect::watchdog_status:
    case Effect::sync_manager_activate:
      return "host: in acknowledge-by-write mode";
    case Effect::sii_access:
      return "host: while 0x0500 offers the EEPROM";
    case Effect::sii_interface:
      return "the EEPROM's owner, while it is not busy";
    case Effect::mii_interface:
      return "the owner of MII management, while it is not busy";
    case Effect::mii_access:
      return "bus: while the host has no access; host: while the bus claims none";
    case Effect::sync_manager:
      return "while the sync manager is disabled";
    default:
      return "";
  }
}

bool conditional(Access access) {
  return access == Access::read_write_if || access == Access::read_write_if_starts ||
         access == Access::write_if || access == Access::read_write_acknowledges;
}

std::string hexadecimal(std::uint64_t value, unsigned digits) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  std::string text = "0x";
  while (digits-- > 0) {
    text += kDigits[value >> (4 * digits) & 0xFU];
  }
  return text;
}

/// Fields of a byte and more in hexadecimal, as documents print them.
std::string reset_text(std::uint64_t value, unsigned bits) {
  return bits < 8 || bits > 64 ? std::to_string(value) : hexadecimal(value, (bits + 3) / 4);
}

/// Bits bit_lo..bit_hi, at most 64, of the register at `address`.
std::uint64_t field_value(std::span<const std::byte> registers, std::size_t address,
                          const RegisterField& field) {
  std::uint64_t value = 0;
  for (unsigned bit = field.bit_lo; bit <= field.bit_hi && bit - field.bit_lo < 64; ++bit) {
    const auto byte = std::to_integer<unsigned>(registers[address + bit / 8]);
    value |= std::uint64_t{byte >> (bit % 8) & 1U} << (bit - field.bit_lo);
  }
  return value;
}

std::string with_channel(std::string_view name, unsigned channel) {
  std::string text(name);
  if (const std::size_t at = text.find('#'); at != std::string::npos) {
    text.replace(at, 1, std::to_string(channel));
  }
  return text;
}

/// Whether a register is there at all, may be written, or only answers.
struct Presence {
  bool built;
  bool writable;
};

std::string access_text(Access access, Presence presence) {
  const bool constant = !presence.built || !presence.writable;
  return std::string(to_string(constant && may_read(access) ? Access::read : access));
}

std::string notes_of(const RegisterDeclaration& declaration, const RegisterField& field,
                     Presence presence) {
  if (!presence.built) {
    return "not built: reads 0, ignores writes";
  }
  if (!presence.writable) {
    return "constant: ignores writes";
  }
  if (conditional(field.bus) || conditional(field.host)) {
    return std::string(condition_of(declaration.effect));
  }
  return "";
}

class Describer {
 public:
  explicit Describer(const ControllerPreset& preset)
      : preset_(preset),
        map_(preset.configuration.features, preset.configuration.answered_features,
             preset.configuration.fmmu_count, preset.configuration.sync_manager_count),
        reset_(kRegisterSpace) {
    const std::span<std::byte, kRegisterSpace> registers(reset_.data(), kRegisterSpace);
    map_.reset(registers);
    write_build_registers(preset.configuration, registers);
  }

  void add(const RegisterDeclaration& declaration, unsigned channel) {
    const std::size_t address = declaration.address + channel * declaration.repetition.distance;
    const bool built = map_[address].built;
    const Presence presence{built,
                            has_feature(preset_.configuration.features, declaration.write_feature)};
    for (const RegisterField& field : declaration.fields) {
      const unsigned bits = field.bit_hi - field.bit_lo + 1U;
      rows_.push_back({hexadecimal(address, 4), std::to_string(declaration.width),
                       with_channel(declaration.name, channel), std::to_string(field.bit_hi),
                       std::to_string(field.bit_lo), std::string(field.name),
                       access_text(field.bus, presence), access_text(field.host, presence),
                       reset_text(field_value(reset_, address, field), bits),
                       line_text(field.lines), notes_of(declaration, field, presence)});
    }
  }

  void add_process_memory() {
    const unsigned bits = preset_.configuration.ram_kilobytes * 8192U;
    rows_.push_back({"0x1000", std::to_string(bits), "Process Data RAM", std::to_string(bits - 1),
                     "0", "pdram", "(r/w)", "(r/w)", "0", line_text(kProcessMemoryLines),
                     "while 0x0110.0 is 1; as the sync managers allow"});
  }

  [[nodiscard]] const RegisterMap& map() const { return map_; }
  /// The rows by address: channels of a repeated register lie between one another.
  [[nodiscard]] std::vector<RegisterDescription> take() {
    std::ranges::stable_sort(rows_, {}, &RegisterDescription::address);
    return std::move(rows_);
  }

 private:
  [[nodiscard]] std::string line_text(const DocumentLines& lines) const {
    const unsigned line = lines.in(preset_.document);
    return line == 0 ? "" : "L" + std::to_string(line);
  }

  const ControllerPreset& preset_;
  RegisterMap map_;
  std::vector<std::byte> reset_;
  std::vector<RegisterDescription> rows_;
};

}  // namespace

std::vector<RegisterDescription> describe_registers(const ControllerPreset& preset) {
  Describer describer(preset);
  for (const std::span<const RegisterDeclaration> group : register_groups()) {
    for (const RegisterDeclaration& declaration : group) {
      if (!describer.map().answers(declaration)) {
        continue;
      }
      const unsigned channels = describer.map().channel_count(declaration.repetition.channels);
      for (unsigned channel = 0; channel < channels; ++channel) {
        describer.add(declaration, channel);
      }
    }
  }
  describer.add_process_memory();
  return describer.take();
}

}  // namespace stator::ethercat

#include "ethercat/register_table.hpp"

#include <algorithm>

#include "ethercat/register_rows.hpp"

namespace stator::ethercat {

namespace {

/// Bits of `field` within byte `index` of its register.
constexpr std::uint8_t bits_in_byte(const RegisterField& field, std::size_t index) {
  unsigned bits = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const std::size_t at = 8 * index + bit;
    bits |= at >= field.bit_lo && at <= field.bit_hi ? 1U << bit : 0U;
  }
  return static_cast<std::uint8_t>(bits);
}

/// Reset value of `field` within byte `index`.
constexpr std::uint8_t reset_in_byte(const RegisterField& field, std::size_t index) {
  unsigned value = 0;
  for (unsigned bit = 0; bit < 8; ++bit) {
    const std::size_t at = 8 * index + bit;
    const bool set = at >= field.bit_lo && at - field.bit_lo < 64 &&
                     (field.reset >> (at - field.bit_lo) & 1U) != 0;
    value |= set ? 1U << bit : 0U;
  }
  return static_cast<std::uint8_t>(value);
}

/// What one field of a register contributes to the byte `index` of the register.
void add_field(RegisterMap::Byte& byte, const RegisterField& field, std::size_t index, bool kept) {
  const std::uint8_t bits = bits_in_byte(field, index);
  if (bits == 0) {
    return;
  }
  byte.bus_reads |= may_read(field.bus);
  byte.bus_writes |= may_write(field.bus);
  byte.host_reads |= may_read(field.host);
  byte.host_writes |= may_write(field.host);
  if (kept && !field.reserved()) {
    byte.bus_stores |= stores(field.bus) ? bits : std::uint8_t{0};
    byte.host_stores |= stores(field.host) ? bits : std::uint8_t{0};
  }
}

}  // namespace

std::string_view to_string(Access access) {
  switch (access) {
    case Access::none:
      return "";
    case Access::read:
      return "r";
    case Access::read_acknowledges:
      return "r*";
    case Access::read_write:
      return "r/w";
    case Access::read_write_if:
    case Access::read_write_if_starts:
      return "r/(w)";
    case Access::read_write_acknowledges:
      return "r/(w ack)";
    case Access::read_write_clears:
      return "r/w(clr)";
    case Access::read_write_special:
      return "r/w (special)";
    case Access::write_special:
      return "w";
    case Access::write_if:
      return "(w)";
  }
  return "";
}

std::array<std::span<const RegisterDeclaration>, 7> register_groups() {
  return {data_link_registers(),   application_layer_registers(),     event_registers(),
          sii_and_mii_registers(), fmmu_and_sync_manager_registers(), distributed_clock_registers(),
          identity_registers()};
}

unsigned RegisterMap::channel_count(Channels channels) const {
  switch (channels) {
    case Channels::fmmus:
      return fmmu_count_;
    case Channels::sync_managers:
      return sync_manager_count_;
    case Channels::ports:
      return 4;
    case Channels::one:
      break;
  }
  return 1;
}

template <typename Visitor>
void RegisterMap::for_each_register(Visitor visit) const {
  for (const std::span<const RegisterDeclaration> group : register_groups()) {
    for (const RegisterDeclaration& declaration : group) {
      if (!answers(declaration)) {
        continue;
      }
      const unsigned channels = channel_count(declaration.repetition.channels);
      for (unsigned channel = 0; channel < channels; ++channel) {
        visit(declaration, declaration.address + channel * declaration.repetition.distance);
      }
    }
  }
}

RegisterMap::RegisterMap(ControllerFeature features, ControllerFeature answered_features,
                         unsigned fmmu_count, unsigned sync_manager_count)
    : features_(features),
      answered_features_(answered_features),
      fmmu_count_(fmmu_count),
      sync_manager_count_(sync_manager_count) {
  for_each_register([this](const RegisterDeclaration& declaration, std::size_t address) {
    add_register(declaration, address);
  });
}

void RegisterMap::add_register(const RegisterDeclaration& declaration, std::size_t address) {
  const bool built = has_feature(features_, declaration.feature);
  const bool writable = built && has_feature(features_, declaration.write_feature);
  const bool swallows = has_feature(answered_features_, declaration.write_feature);
  for (std::size_t i = 0; i < declaration.width / 8U; ++i) {
    Byte& byte = bytes_[address + i];
    for (const RegisterField& field : declaration.fields) {
      add_field(byte, field, i, writable && !discards_value(declaration.effect));
    }
    byte.built = built;
    byte.bus_writes = byte.bus_writes && (writable || swallows);
    byte.effect = built ? declaration.effect : Effect::none;
  }
}

void RegisterMap::reset(std::span<std::byte, kRegisterSpace> registers) const {
  std::fill(registers.begin(), registers.end(), std::byte{0});
  for_each_register([&](const RegisterDeclaration& declaration, std::size_t address) {
    if (!has_feature(features_, declaration.feature)) {
      return;
    }
    for (std::size_t i = 0; i < declaration.width / 8U; ++i) {
      for (const RegisterField& field : declaration.fields) {
        registers[address + i] |= std::byte{reset_in_byte(field, i)};
      }
    }
  });
}

}  // namespace stator::ethercat

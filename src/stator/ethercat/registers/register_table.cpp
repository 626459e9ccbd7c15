#include "stator/ethercat/registers/register_table.hpp"

#include <algorithm>
#include <utility>

#include "stator/ethercat/registers/register_rows.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

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
  for (const RegisterByte& declared : declaration.bytes) {
    Byte& byte = bytes_[address++];
    byte.bus_stores = writable ? declared.bus_stores : std::uint8_t{0};
    byte.host_stores = writable ? declared.host_stores : std::uint8_t{0};
    byte.bus_reads = declared.bus_reads;
    byte.bus_writes = declared.bus_writes && (writable || swallows);
    byte.host_reads = declared.host_reads;
    byte.host_writes = declared.host_writes;
    byte.built = built;
    byte.more = declared.more & 7;
    byte.effect = built ? declaration.effect : Effect::none;
  }
}

void RegisterMap::give_time_loop_to_host() {
  constexpr EffectSet kTimeLoop =
      set_of(Effect::system_time, Effect::time_setting, Effect::time_loop, Effect::time_filter,
             Effect::speed_filter);
  for (Byte& byte : bytes_) {
    if (any_of(set_of(byte.effect), kTimeLoop)) {
      std::swap(byte.bus_stores, byte.host_stores);
      const bool bus_writes = byte.bus_writes;
      byte.bus_writes = byte.host_writes;
      byte.host_writes = bus_writes;
    }
  }
  // The host compares with times that latch unit 0 takes, so the bus cannot take over that unit.
  constexpr std::uint8_t kLatch0OfHost = 0x10;
  Byte& control = bytes_[register_address::kCyclicUnitControl];
  control.bus_stores = static_cast<std::uint8_t>(control.bus_stores & ~kLatch0OfHost);
}

void RegisterMap::reset(std::span<std::byte, kRegisterSpace> registers) const {
  std::fill(registers.begin(), registers.end(), std::byte{0});
  for_each_register([&](const RegisterDeclaration& declaration, std::size_t address) {
    if (has_feature(features_, declaration.feature)) {
      std::ranges::transform(declaration.bytes, registers.subspan(address).begin(),
                             [](const RegisterByte& byte) { return std::byte{byte.reset}; });
    }
  });
}

}  // namespace stator::ethercat

#include "ethercat/register_table.hpp"

#include <algorithm>

namespace stator::ethercat {

namespace {

using enum Rights;
using F = ControllerFeature;
using E = Effect;
using R = Repetition;

constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr std::uint64_t kNone = 0;

// Where the datasheet prints no reset value, the one common to EtherCAT slave controllers stands
// here. Where it prints a right that contradicts the text or the standard, the standard stands.
constexpr RegisterDeclaration kDeclarations[] = {
    // addr   bits  name                                    bus         host        reset writable
    {0x0000, 8, "Type", read, read},
    {0x0001, 8, "Revision", read, read},
    {0x0002, 16, "Build", read, read},
    {0x0004, 8, "FMMUs supported", read, read},
    {0x0005, 8, "SyncManagers supported", read, read},
    {0x0006, 8, "RAM Size", read, read},
    {0x0007, 8, "Port Descriptor", read, read},
    {0x0008, 16, "ESC Features supported", read, read},
    {0x0010, 16, "Configured Station Address", read_write, read, 0, kAll, E::station_address},
    {0x0012, 16, "Configured Station Alias", read, read_write, 0, kAll, E::station_address},
    {0x0020, 8, "Write Register Enable", read_write, read, 0, 0x01, E::unlock_registers,
     F::write_protection},
    {0x0021, 8, "Write Register Protection", read_write, read, 0, 0x01, E::write_protection,
     F::write_protection},
    {0x0030, 8, "ESC Write Enable", read_write, read, 0, 0x01, E::unlock_controller,
     F::write_protection},
    {0x0031, 8, "ESC Write Protection", read_write, read, 0, 0x01, E::write_protection,
     F::write_protection},
    {0x0040, 8, "ESC Reset ECAT", read_write, read, 0, kAll, E::reset_by_bus, F::reset_registers},
    {0x0041, 8, "ESC Reset PDI", read, read_write, 0, kAll, E::reset_by_host, F::reset_registers},
    {0x0100, 32, "ESC DL Control", read_write, read, 0x00070001, 0x017FFF03, E::dl_control},
    {0x0108, 16, "Physical Read/Write Offset", read_write, read, 0, kAll, E::none,
     F::read_write_offset},
    {0x0110, 16, "ESC DL Status", read, read, 0, kNone, E::dl_status},
    {0x0120, 16, "AL Control", read_write, read_acknowledge, 0x0001, 0x003F, E::al_control},
    {0x0130, 16, "AL Status", read, read_write, 0x0001, 0x003F, E::al_status},
    {0x0134, 16, "AL Status Code", read, read_write},
    {0x0138, 8, "RUN LED Override", read_write, read_write, 0, 0x1F, E::none, F::led_override},
    {0x0139, 8, "ERR LED Override", read_write, read_write, 0, 0x1F, E::none, F::led_override},
    {0x0140, 8, "PDI Control", read, read},
    {0x0141, 8, "ESC Configuration", read, read},
    {0x014E, 16, "PDI Information", read, read, 0, kNone, E::none, F::pdi_information},
    {0x0150, 8, "PDI SPI Slave Configuration", read, read},
    {0x0151, 8, "SYNC/LATCH PDI Configuration", read, read, 0x66},
    {0x0152, 16, "Extended PDI SPI Slave Configuration", read, read},
    {0x0200, 16, "ECAT Event Mask", read_write, read, 0, kAll, E::event_mask},
    {0x0204, 32, "AL Event Mask", read, read_write, 0x00FFFF0F},
    {0x0210, 16, "ECAT Event Request", read, read, 0, kNone, E::event_request},
    {0x0220, 32, "AL Event Request", read, read, 0, kNone, E::event_request},
    {0x0300, 64, "RX Error Counter Ports 0-3", read_write, read, 0, kAll, E::clear_receive_errors},
    {0x0308, 32, "Forwarded RX Error Counter Ports 0-3", read_write, read, 0, kAll,
     E::clear_receive_errors},
    {0x030C, 8, "ECAT Processing Unit Error Counter", read_write, read, 0, kAll,
     E::clear_processing_unit_errors},
    {0x030D, 8, "PDI Error Counter", read_write, read, 0, kAll, E::clear_pdi_errors},
    {0x030E, 8, "PDI Error Code", read, read},
    {0x0310, 32, "Lost Link Counter Ports 0-3", read_write, read, 0, kAll, E::clear_lost_links},
    {0x0400, 16, "Watchdog Divider", read_write, read, 0x09C2, kAll, E::watchdog_time},
    {0x0410, 16, "Watchdog Time PDI", read_write, read, 0x03E8, kAll, E::watchdog_time},
    {0x0420, 16, "Watchdog Time Process Data", read_write, read, 0x03E8, kAll, E::watchdog_time},
    {0x0440, 16, "Watchdog Status Process Data", read, read_acknowledge, 0, kNone,
     E::watchdog_status},
    {0x0442, 8, "Watchdog Counter Process Data", read_write, read, 0, kAll,
     E::clear_watchdog_counters},
    {0x0443, 8, "Watchdog Counter PDI", read_write, read, 0, kAll, E::clear_watchdog_counters},
    {0x0500, 8, "EEPROM Configuration", read_write, read, 0, 0x03, E::sii_access},
    {0x0501, 8, "EEPROM PDI Access State", read, read_write, 0, 0x01, E::sii_access},
    {0x0502, 16, "EEPROM Control/Status", read_write, read_write, 0, 0x0701, E::sii_interface},
    {0x0504, 32, "EEPROM Address", read_write, read_write, 0, kAll, E::sii_interface},
    {0x0508, 16, "EEPROM Data", read_write, read_write, 0, kAll, E::sii_interface},
    {0x050A, 48, "EEPROM Data (read only part)", read, read},
    {0x0510, 16, "MII Management Control/Status", read_write, read_write, 0x0006, 0x0301, E::none,
     F::mii_management},
    {0x0512, 8, "PHY Address", read_write, read_write, 0, 0x9F, E::none, F::mii_management},
    {0x0513, 8, "PHY Register Address", read_write, read_write, 0, 0x1F, E::none,
     F::mii_management},
    {0x0514, 16, "PHY Data", read_write, read_write, 0, kAll, E::none, F::mii_management},
    {0x0516, 8, "MII Management ECAT Access State", read_write, read, 0, 0x01, E::none,
     F::mii_management},
    {0x0517, 8, "MII Management PDI Access State", read_write, read_write, 0, 0x03, E::none,
     F::mii_management},
    {0x0518, 32, "PHY Port Status Ports 0-3", read_write, read_write, 0, kNone, E::none,
     F::mii_management},
    {0x0580, 1024, "ESC Parameter RAM", read_write, read_write, 0, kAll, E::none, F::parameter_ram},
    {0x0600, 32, "FMMU Logical Start Address", read_write, read, 0, kAll, E::fmmu, F::always,
     R::per_fmmu},
    {0x0604, 16, "FMMU Length", read_write, read, 0, kAll, E::fmmu, F::always, R::per_fmmu},
    {0x0606, 8, "FMMU Logical Start Bit", read_write, read, 0, 0x07, E::fmmu, F::always,
     R::per_fmmu},
    {0x0607, 8, "FMMU Logical Stop Bit", read_write, read, 0, 0x07, E::fmmu, F::always,
     R::per_fmmu},
    {0x0608, 16, "FMMU Physical Start Address", read_write, read, 0, kAll, E::fmmu, F::always,
     R::per_fmmu},
    {0x060A, 8, "FMMU Physical Start Bit", read_write, read, 0, 0x07, E::fmmu, F::always,
     R::per_fmmu},
    {0x060B, 8, "FMMU Type", read_write, read, 0, 0x03, E::fmmu, F::always, R::per_fmmu},
    {0x060C, 8, "FMMU Activate", read_write, read, 0, 0x01, E::fmmu, F::always, R::per_fmmu},
    {0x060D, 24, "FMMU Reserved", read, read, 0, kNone, E::none, F::always, R::per_fmmu},
    {0x0800, 16, "SM Physical Start Address", read_write, read, 0, kAll, E::sync_manager, F::always,
     R::per_sync_manager},
    {0x0802, 16, "SM Length", read_write, read, 0, kAll, E::sync_manager, F::always,
     R::per_sync_manager},
    {0x0804, 8, "SM Control", read_write, read, 0, 0x7F, E::sync_manager, F::always,
     R::per_sync_manager},
    {0x0805, 8, "SM Status", read, read, 0x30, kNone, E::none, F::always, R::per_sync_manager},
    {0x0806, 8, "SM Activate", read_write, read_acknowledge, 0, 0xC3, E::sync_manager_activate,
     F::always, R::per_sync_manager},
    {0x0807, 8, "SM PDI Control", read, read_write, 0, 0x03, E::sync_manager_host_control,
     F::always, R::per_sync_manager},
    {0x0900, 32, "Receive Time Port 0", read_write, read, 0, kAll, E::receive_time,
     F::distributed_clocks},
    {0x0904, 32, "Receive Time Port 1", read, read, 0, kNone, E::none, F::distributed_clocks},
    {0x0908, 32, "Receive Time Port 2", read, read, 0, kNone, E::none, F::distributed_clocks},
    {0x090C, 32, "Receive Time Port 3", read, read, 0, kNone, E::none, F::distributed_clocks},
    {0x0910, 64, "System Time", read_write, read, 0, kAll, E::system_time, F::distributed_clocks},
    {0x0918, 64, "Receive Time ECAT Processing Unit", read, read, 0, kNone, E::none,
     F::distributed_clocks},
    {0x0920, 64, "System Time Offset", read_write, read, 0, kAll, E::time_setting,
     F::distributed_clocks},
    {0x0928, 32, "System Time Delay", read_write, read, 0, kAll, E::time_setting,
     F::distributed_clocks},
    {0x092C, 32, "System Time Difference", read, read, 0, kNone, E::none, F::distributed_clocks},
    {0x0930, 16, "Speed Counter Start", read_write, read, 0x1000, 0x7FFF, E::time_loop,
     F::distributed_clocks},
    {0x0932, 16, "Speed Counter Diff", read, read, 0, kNone, E::speed_difference,
     F::distributed_clocks},
    {0x0934, 8, "System Time Difference Filter Depth", read_write, read, 4, 0x0F, E::time_filter,
     F::distributed_clocks},
    {0x0935, 8, "Speed Counter Filter Depth", read_write, read, 12, 0x0F, E::speed_filter,
     F::distributed_clocks},
    {0x0980, 8, "Cyclic Unit Control", read_write, read, 0, 0x31, E::clock_side,
     F::distributed_clocks},
    {0x0981, 8, "SYNC Out Activation", read_write, read_write, 0, 0x7F, E::sync_activation,
     F::distributed_clocks},
    {0x0982, 16, "Pulse Length of SYNC signals", read, read, 0, kNone, E::none,
     F::distributed_clocks},
    {0x0984, 8, "Activation Status", read, read, 0, kNone, E::sync_status, F::distributed_clocks},
    {0x098E, 8, "SYNC0 Status", read, read_acknowledge, 0, kNone, E::sync_status,
     F::distributed_clocks},
    {0x098F, 8, "SYNC1 Status", read, read_acknowledge, 0, kNone, E::sync_status,
     F::distributed_clocks},
    {0x0990, 64, "Start Time Cyclic Operation / Next SYNC0 Pulse", read_write, read_write, 0, kAll,
     E::sync_times, F::distributed_clocks},
    {0x0998, 64, "Next SYNC1 Pulse", read, read, 0, kNone, E::sync_times, F::distributed_clocks},
    {0x09A0, 32, "SYNC0 Cycle Time", read_write, read_write, 0, kAll, E::sync_cycle,
     F::distributed_clocks},
    {0x09A4, 32, "SYNC1 Cycle Time", read_write, read_write, 0, kAll, E::sync_cycle,
     F::distributed_clocks},
    {0x09A8, 8, "Latch0 Control", read_write, read_write, 0, 0x03, E::latch_control,
     F::distributed_clocks},
    {0x09A9, 8, "Latch1 Control", read_write, read_write, 0, 0x03, E::latch_control,
     F::distributed_clocks},
    {0x09AE, 8, "Latch0 Status", read, read, 0, kNone, E::latch_status, F::distributed_clocks},
    {0x09AF, 8, "Latch1 Status", read, read, 0, kNone, E::latch_status, F::distributed_clocks},
    {0x09B0, 64, "Latch0 Time Positive Edge", read, read_acknowledge, 0, kNone, E::latch_time,
     F::distributed_clocks},
    {0x09B8, 64, "Latch0 Time Negative Edge", read, read_acknowledge, 0, kNone, E::latch_time,
     F::distributed_clocks},
    {0x09C0, 64, "Latch1 Time Positive Edge", read, read_acknowledge, 0, kNone, E::latch_time,
     F::distributed_clocks},
    {0x09C8, 64, "Latch1 Time Negative Edge", read, read_acknowledge, 0, kNone, E::latch_time,
     F::distributed_clocks},
    {0x09F0, 32, "EtherCAT Buffer Change Event Time", read, read, 0, kNone, E::buffer_event_time,
     F::buffer_event_times},
    {0x09F8, 32, "PDI Buffer Start Event Time", read, read, 0, kNone, E::buffer_event_time,
     F::buffer_event_times},
    {0x09FC, 32, "PDI Buffer Change Event Time", read, read, 0, kNone, E::buffer_event_time,
     F::buffer_event_times},
    {0x0E00, 64, "Product ID", read, read, 0, kNone, E::none, F::product_identity},
    {0x0E08, 64, "Vendor ID", read, read, 0, kNone, E::none, F::product_identity},
    {0x0F80, 1024, "User RAM", read_write, read_write, 0, kAll, E::none, F::user_ram},
};

constexpr bool may_read(Rights rights) {
  return rights != Rights::none;
}
constexpr bool may_write(Rights rights) {
  return rights == Rights::read_write || rights == Rights::read_acknowledge;
}
/// Byte `index` of a field that is as wide as a register; fields wider than 64 bits repeat.
constexpr std::uint8_t byte_of(std::uint64_t field, std::size_t index) {
  return static_cast<std::uint8_t>(field >> (8 * (index % 8)));
}

}  // namespace

std::span<const RegisterDeclaration> register_declarations() {
  return kDeclarations;
}

template <typename Visitor>
void RegisterMap::for_each_instance(Visitor visit) const {
  for (const RegisterDeclaration& declaration : kDeclarations) {
    if (!has_feature(features_, declaration.feature)) {
      continue;
    }
    unsigned instances = 1;
    std::size_t distance = 0;
    if (declaration.repetition == Repetition::per_fmmu) {
      instances = fmmu_count_;
      distance = 16;
    } else if (declaration.repetition == Repetition::per_sync_manager) {
      instances = sync_manager_count_;
      distance = 8;
    }
    for (unsigned instance = 0; instance < instances; ++instance) {
      visit(declaration, declaration.address + instance * distance);
    }
  }
}

RegisterMap::RegisterMap(ControllerFeature features, unsigned fmmu_count,
                         unsigned sync_manager_count)
    : features_(features), fmmu_count_(fmmu_count), sync_manager_count_(sync_manager_count) {
  for_each_instance([this](const RegisterDeclaration& declaration, std::size_t address) {
    const bool stored = !discards_value(declaration.effect);
    for (std::size_t i = 0; i < declaration.width / 8U; ++i) {
      Byte& byte = bytes_[address + i];
      const auto stores = [&](Rights rights) {
        return stored && rights == Rights::read_write ? byte_of(declaration.writable, i)
                                                      : std::uint8_t{0};
      };
      byte.bus_reads = may_read(declaration.bus);
      byte.bus_writes = may_write(declaration.bus);
      byte.host_reads = may_read(declaration.host);
      byte.host_writes = may_write(declaration.host);
      byte.bus_stores = stores(declaration.bus);
      byte.host_stores = stores(declaration.host);
      byte.effect = declaration.effect;
    }
  });
}

void RegisterMap::reset(std::span<std::byte, kRegisterSpace> registers) const {
  std::fill(registers.begin(), registers.end(), std::byte{0});
  for_each_instance([&](const RegisterDeclaration& declaration, std::size_t address) {
    for (std::size_t i = 0; i < declaration.width / 8U; ++i) {
      registers[address + i] = std::byte{byte_of(declaration.reset, i)};
    }
  });
}

}  // namespace stator::ethercat

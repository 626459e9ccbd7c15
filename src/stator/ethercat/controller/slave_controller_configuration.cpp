#include "stator/ethercat/controller/slave_controller_configuration.hpp"

#include "stator/base/byte_order.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

namespace {

using namespace register_address;

}  // namespace

void write_build_registers(const SlaveControllerConfiguration& configuration,
                           std::span<std::byte, kRegisterSpace> registers) {
  const auto built = [&](ControllerFeature feature) {
    return has_feature(configuration.features, feature);
  };
  registers[kType] = std::byte{configuration.type};
  registers[kRevision] = std::byte{configuration.revision};
  base::store_le(registers, kBuild, configuration.build);
  registers[kFmmusSupported] = std::byte{configuration.fmmu_count};
  registers[kSyncManagersSupported] = std::byte{configuration.sync_manager_count};
  registers[kRamSize] = std::byte{configuration.ram_kilobytes};
  registers[kPortDescriptor] = std::byte{configuration.port_descriptor};
  // Enhanced link detection (MII) and separate counting of frames with wrong check sequence; with
  // distributed clocks also 64-bit times and the enhanced SYNC activation.
  const unsigned clocks = built(ControllerFeature::distributed_clocks) ? 0x010CU : 0U;
  base::store_le(registers, kFeatures, static_cast<std::uint16_t>(0x00C0U | clocks));
  if (built(ControllerFeature::product_identity)) {
    base::store_le(registers, kProductId, configuration.product_id);
    base::store_le(registers, kVendorId, configuration.vendor_id);
  }
  if (configuration.host_controls_time && built(ControllerFeature::distributed_clocks)) {
    registers[kCyclicUnitControl] = std::byte{0x10};  // latch unit 0 is the host's
  }
  registers[kSyncLatchConfiguration] = std::byte{configuration.sync_latch_reset};
  if (built(ControllerFeature::mii_management)) {
    // The host may take the interface; links are detected through it.
    registers[kMiiControl] = std::byte{0x02};
    if (built(ControllerFeature::mii_link_detection)) {
      registers[kMiiControl] |= std::byte{0x04};
    }
  }
}

}  // namespace stator::ethercat

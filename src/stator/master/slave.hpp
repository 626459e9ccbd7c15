#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/ethercat/standard/al_state.hpp"
#include "stator/ethercat/standard/device_description.hpp"

namespace stator::master {

/// Who made a slave and what it is (SII words 0008h to 000Fh, object 1018h).
struct Identity {
  std::uint32_t vendor_id = 0;
  std::uint32_t product_code = 0;
  std::uint32_t revision = 0;
  std::uint32_t serial_number = 0;

  friend bool operator==(const Identity&, const Identity&) = default;
};

/// One port of a slave controller as the DL status register 0110h shows it.
struct PortStatus {
  bool link = false;           ///< a signal is seen on the medium
  bool loop_closed = true;     ///< frames turn around here
  bool communication = false;  ///< frames have passed
};

/// What a slave tells in its SII (ETG.2010), as far as this master uses it.
struct SlaveInformation {
  Identity identity;
  std::uint16_t alias = 0;
  std::string name;        ///< string of the general category, e.g. "TMCM-3315"
  std::string order_code;  ///< e.g. the ESI's <Type>
  std::string group;
  ethercat::MailboxArea receive_mailbox;   ///< master to slave; length 0: no mailbox
  ethercat::MailboxArea transmit_mailbox;  ///< slave to master
  bool coe = false;
  bool foe = false;
  bool eoe = false;
  bool sdo_information = false;
  bool complete_access = false;
  std::vector<ethercat::SiiSyncManager> sync_managers;
};

/// A slave as a scan found it.
struct Slave {
  std::uint16_t position = 0;         ///< along the segment, 0 = first
  std::uint16_t station_address = 0;  ///< given by the scan
  std::array<PortStatus, 4> ports{};
  std::uint8_t fmmu_count = 0;
  std::uint8_t sync_manager_count = 0;
  bool distributed_clocks = false;
  ethercat::AlState state = ethercat::AlState::init;  ///< when the scan ended
  SlaveInformation information{};
};

}  // namespace stator::master

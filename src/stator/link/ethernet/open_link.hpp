#pragma once

#include <cstdint>
#include <memory>

#include "stator/link/ethernet/ethernet_link.hpp"
#include "stator/link/ethernet/link_address.hpp"
#include "stator/link/system/receive_wait.hpp"

namespace stator::link {

/// Which end of the medium is opened. Only UDP tells them apart: slaves listen, a master sends.
enum class LinkEnd : std::uint8_t { slaves, master };

struct LinkOptions {
  WaitMode wait = WaitMode::block;
  base::SimDuration spin_time{200'000};  ///< of WaitMode::adaptive
};

/// Opens any kind of link for EtherCAT frames; in_process is refused, there is nothing to open.
[[nodiscard]] base::Expected<std::unique_ptr<EthernetLink>, LinkError> open_link(
    const LinkAddress& address, LinkEnd end, const LinkOptions& options);

}  // namespace stator::link

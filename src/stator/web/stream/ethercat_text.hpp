#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/web/stream/decoded_frame.hpp"
#include "stator/web/stream/traffic_map.hpp"

namespace stator::web {

/// An Ethernet frame of a segment in words: datagrams with command, address, register and working
/// counter; state changes; mailboxes; process data as objects. `answer`: it has passed the slaves.
/// Takes whatever bytes come.
[[nodiscard]] DecodedFrame describe_ethercat(std::span<const std::byte> frame, bool answer,
                                             const std::vector<SlaveMap>& slaves);

}  // namespace stator::web

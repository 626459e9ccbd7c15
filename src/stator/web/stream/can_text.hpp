#pragma once

#include <vector>

#include "stator/can/frame.hpp"
#include "stator/web/stream/decoded_frame.hpp"
#include "stator/web/stream/traffic_map.hpp"

namespace stator::web {

/// A frame of a CAN bus in words: NMT, SYNC, TIME, emergencies, SDOs, PDOs as objects, error
/// control and LSS of CANopen (CiA 301, CiA 305), requests and replies of TMCL modules.
[[nodiscard]] DecodedFrame describe_can(const can::Frame& frame, const std::vector<NodeMap>& nodes);

}  // namespace stator::web

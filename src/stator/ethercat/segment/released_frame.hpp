#pragma once

#include <cstddef>

#include "stator/ethercat/segment/topology.hpp"

namespace stator::ethercat {

/// A frame that a fault held on a cable and that comes out of its segment.
struct ReleasedFrame {
  std::size_t length = 0;
  MasterInterface exit = MasterInterface::primary;
};

}  // namespace stator::ethercat

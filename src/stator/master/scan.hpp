// The scan of an EtherCAT segment, which finds its slaves and gives them station addresses.
#pragma once

#include <vector>

#include "stator/master/bus.hpp"
#include "stator/master/slave.hpp"

namespace stator::master {

[[nodiscard]] inline Station station_of(const Slave& slave) {
  return {slave.position, slave.station_address};
}

/// Counts the slaves of a segment, requests Init from all of them, clears what an earlier master
/// left behind, gives station addresses from 1001h and reads who the slaves are.
[[nodiscard]] Result<std::vector<Slave>> scan_segment(Bus& bus);

}  // namespace stator::master

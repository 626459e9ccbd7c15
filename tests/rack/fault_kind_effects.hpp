#pragma once

#include <map>
#include <string_view>

#include <gtest/gtest.h>

#include "rack/drive_fault_bench.hpp"
#include "stator/rack/faults/fault_kinds.hpp"

namespace stator::tests {

/// A TMCC160 "drive" on a bus at 1 Mbit/s, with faults.
class FaultyNode : public CanopenDriveBench {
 public:
  FaultyNode() : CanopenDriveBench("[[bus]]\n[[bus.device]]\ntype = 'tmcc160'\nname = 'drive'\n") {
    start();
    static_cast<void>(told());
  }
  bool answers() { return !sdo(can::data_frame(0x601, {0x40, 0, 0x10, 0, 0, 0, 0, 0})).empty(); }
};

}  // namespace stator::tests

namespace stator::rack {

/// What shows the effect of a kind of fault, by its name in the table of kinds.
using FaultKindEffects = std::map<std::string_view, void (*)()>;

FaultKindEffects ethercat_effects();
FaultKindEffects can_effects();
FaultKindEffects serial_effects();

}  // namespace stator::rack

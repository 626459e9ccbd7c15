#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "stator/ethercat/controller/slave_controller.hpp"

namespace stator::ethercat::testing {

/// What the documents and ETG.1000.4 let bus and host do with one byte of the register space right
/// after power-on, EEPROM loaded, nothing configured. Derived from tests/data/*/registers.csv and
/// the readings of their unclear places, not from the controller's own table.
struct ExpectedByte {
  bool declared = false;
  bool bus_reads = false;
  bool bus_writes = false;
  bool host_reads = false;
  bool host_writes = false;
  std::uint8_t bus_stores = 0;   ///< bits a bus write changes
  std::uint8_t host_stores = 0;  ///< bits a host write changes
};

/// Registers of one kind: all channels of a FMMU, sync manager or port register together.
struct ExpectedRegister {
  std::string name;  ///< with address, fit for the name of a test case
  std::vector<std::uint16_t> bytes;
};

struct ControllerExpectation {
  std::string name;  ///< of the preset, fit for the name of a test case
  SlaveControllerConfiguration configuration;
  std::array<ExpectedByte, 0x1000> bytes{};
  std::vector<ExpectedRegister> registers;
};

/// What is expected of tmc8461, tmcm-3315, tmc8670 `document` and `silicon`.
[[nodiscard]] const std::vector<ControllerExpectation>& controller_expectations();

}  // namespace stator::ethercat::testing

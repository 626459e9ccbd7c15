#pragma once

#include <memory>

#include "devices/drive_sequences/drive_under_test.hpp"

namespace stator::tests {

/// The servo of racks/ethercat-servo.toml.
[[nodiscard]] std::unique_ptr<DriveUnderTest> make_tmc8670_drive();
/// Axis 0 of a module whose load damps the rotor; the other axes stand.
[[nodiscard]] std::unique_ptr<DriveUnderTest> make_tmcm_3315_drive();

}  // namespace stator::tests

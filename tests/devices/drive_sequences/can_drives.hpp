#pragma once

#include <memory>

#include "devices/drive_sequences/drive_under_test.hpp"

namespace stator::tests {

/// A TMCC160 with its default motor, commutated by its encoder or by its Hall sensors, in
/// Operational.
[[nodiscard]] std::unique_ptr<DriveUnderTest> make_tmcc160_drive(bool encoder);
/// A TMCM-142 with its default motor, in microsteps per second.
[[nodiscard]] std::unique_ptr<DriveUnderTest> make_tmcm_142_drive();

}  // namespace stator::tests

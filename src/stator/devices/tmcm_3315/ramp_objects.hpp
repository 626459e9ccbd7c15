#pragma once

#include <cstdint>

#include "stator/dictionary/dictionary.hpp"
#include "stator/drive/motion/axis_settings.hpp"

namespace stator::devices::tmcm_3315 {

/// The manufacturer's objects of the ramp generator (document §4.2.11-4.2.16).
class RampObjects {
 public:
  RampObjects(const dictionary::Dictionary& dictionary, std::uint16_t index_offset);

  /// Writes settings.ramp in the units of settings.units.
  void configure(drive::AxisSettings& settings) const;

 private:
  dictionary::Variable<const std::uint32_t> start_velocity_;      // 2010h
  dictionary::Variable<const std::uint32_t> start_acceleration_;  // 2011h, A1
  dictionary::Variable<const std::uint32_t> break_velocity_;      // 2012h, V1
  dictionary::Variable<const std::uint32_t> final_deceleration_;  // 2013h, D1
  dictionary::Variable<const std::uint32_t> stop_deceleration_;   // 2014h
  dictionary::Variable<const std::uint8_t> bow_factor_;           // 2015h
};

}  // namespace stator::devices::tmcm_3315

#pragma once

#include <array>
#include <cstdint>

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::drive {

/// An object whose integer type differs from product to product (CiA 402 has INTEGER16 where some
/// documents print UNSIGNED16 or INTEGER32).
class IntegerObject {
 public:
  IntegerObject() = default;
  /// Throws std::logic_error if the object does not exist or has more than 32 bits.
  IntegerObject(dictionary::Dictionary& dictionary, std::uint16_t index);
  /// One that a product may lack: it reads as 0 then.
  static IntegerObject optional(dictionary::Dictionary& dictionary, std::uint16_t index);
  [[nodiscard]] bool exists() const { return entry_ != nullptr; }
  [[nodiscard]] std::int64_t get() const { return exists() ? entry_->signed_value() : 0; }
  /// Stores `value`, saturated to what the object's type holds (up to 32 bits); nothing happens
  /// where it is missing.
  void set(std::int64_t value);

 private:
  dictionary::Entry* entry_ = nullptr;
  std::int64_t minimum_ = 0;
  std::int64_t maximum_ = 0;
};

/// An object that a product may lack: it reads as 0 then.
template <typename T>
class OptionalVariable {
 public:
  void bind(dictionary::Variable<T> variable) {
    variable_ = variable;
    exists_ = true;
  }
  [[nodiscard]] bool exists() const { return exists_; }
  [[nodiscard]] T get() const { return exists_ ? variable_.get() : T{}; }
  /// Nothing happens where it is missing.
  void set(T value) {
    if (exists_) {
      variable_.set(value);
    }
  }

 private:
  dictionary::Variable<T> variable_;
  bool exists_ = false;
};

/// The objects of CiA 402 that one axis works with, bound once. Index offset: 0 for the first axis,
/// 800h for the second and so on (CiA 402-1). Every product declares those that are not optional;
/// optional ones read as 0 where a product lacks them.
struct AxisObjects {
  AxisObjects(dictionary::Dictionary& dictionary, std::uint16_t index_offset);

  dictionary::Variable<std::uint16_t> controlword;       // 6040h
  dictionary::Variable<std::uint16_t> statusword;        // 6041h
  IntegerObject quick_stop_option;                       // 605Ah
  IntegerObject shutdown_option;                         // 605Bh
  IntegerObject disable_operation_option;                // 605Ch
  IntegerObject halt_option;                             // 605Dh, optional
  IntegerObject fault_reaction_option;                   // 605Eh
  dictionary::Variable<std::int8_t> mode;                // 6060h
  dictionary::Variable<std::int8_t> mode_display;        // 6061h
  dictionary::Variable<std::int32_t> position_demand;    // 6062h
  dictionary::Variable<std::int32_t> position_internal;  // 6063h
  dictionary::Variable<std::int32_t> position_actual;    // 6064h
  OptionalVariable<std::uint32_t> following_window;      // 6065h, 0 = not watched
  OptionalVariable<std::uint16_t> following_time_out;    // 6066h, ms
  dictionary::Variable<std::uint32_t> position_window;   // 6067h
  OptionalVariable<std::uint16_t> position_window_time;  // 6068h, ms
  OptionalVariable<std::int16_t> sensor_selection;       // 606Ah, 0 = encoder
  OptionalVariable<std::int32_t> velocity_demand;        // 606Bh
  dictionary::Variable<std::int32_t> velocity_actual;    // 606Ch
  IntegerObject target_torque;                           // 6071h, optional, mA
  IntegerObject torque_actual;                           // 6077h, optional, mA
  dictionary::Variable<std::int32_t> target_position;    // 607Ah
  dictionary::Variable<std::int32_t> home_offset;        // 607Ch
  dictionary::Variable<std::int32_t> minimum_position;   // 607Dh:01
  dictionary::Variable<std::int32_t> maximum_position;   // 607Dh:02
  dictionary::Variable<std::uint32_t> profile_velocity;  // 6081h
  IntegerObject end_velocity;                            // 6082h, optional, its magnitude counts
  dictionary::Variable<std::uint32_t> profile_acceleration;     // 6083h
  dictionary::Variable<std::uint32_t> profile_deceleration;     // 6084h
  dictionary::Variable<std::uint32_t> quick_stop_deceleration;  // 6085h
  IntegerObject profile_type;                                   // 6086h, optional, 1 = S-shaped
  OptionalVariable<std::uint32_t> torque_slope;                 // 6087h, units of torque per s
  dictionary::Variable<std::uint32_t> encoder_increments;       // 608Fh:01
  dictionary::Variable<std::int8_t> homing_method;              // 6098h
  dictionary::Variable<std::uint32_t> homing_fast_speed;        // 6099h:01
  dictionary::Variable<std::uint32_t> homing_slow_speed;        // 6099h:02
  dictionary::Variable<std::uint32_t> homing_acceleration;      // 609Ah
  std::array<OptionalVariable<std::uint32_t>, 4> jerk;          // 60A4h:01 to 04
  OptionalVariable<std::int32_t> position_offset;               // 60B0h
  OptionalVariable<std::int32_t> velocity_offset;               // 60B1h
  IntegerObject torque_offset;                                  // 60B2h, optional, as 6071h
  OptionalVariable<std::uint8_t> interpolation_value;           // 60C2h:01
  OptionalVariable<std::int8_t> interpolation_index;            // 60C2h:02
  OptionalVariable<std::uint16_t> positioning_option;           // 60F2h
  OptionalVariable<std::int32_t> following_error;               // 60F4h
  dictionary::Variable<std::int32_t> target_velocity;           // 60FFh
  OptionalVariable<std::uint32_t> supported_modes;              // 6502h

  [[nodiscard]] bool uses_encoder() const { return sensor_selection.get() == 0; }
  /// 60C2h: value * 10^index seconds; the value 0 counts as 1. Without 60C2h no time at all: a
  /// set-point counts from the moment it comes.
  [[nodiscard]] base::SimDuration interpolation_period() const;
};

}  // namespace stator::drive

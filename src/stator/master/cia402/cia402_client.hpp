#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "stator/base/sim_time.hpp"
#include "stator/master/cia402/drive_port.hpp"
#include "stator/master/cia402/drive_state.hpp"
#include "stator/master/master.hpp"

namespace stator::master {

/// Modes of operation (object 6060h).
enum class OperationMode : std::int8_t {
  profile_position = 1,
  profile_velocity = 3,
  profile_torque = 4,
  homing = 6,
  interpolated_position = 7,
  cyclic_synchronous_position = 8,
  cyclic_synchronous_velocity = 9,
  cyclic_synchronous_torque = 10,
};

/// A profile position move in the drive's own units; what is left out keeps the drive's value.
struct ProfileMove {
  std::int32_t target = 0;                      ///< 607Ah
  bool relative = false;                        ///< to the previous target instead of absolute
  bool immediately = true;                      ///< replaces a move that is under way
  std::optional<std::uint32_t> velocity{};      ///< 6081h
  std::optional<std::uint32_t> acceleration{};  ///< 6083h
  std::optional<std::uint32_t> deceleration{};  ///< 6084h
};

/// One axis of a CiA 402 drive as a master sees it. Waiting runs the master's cycle, so all axes of
/// a network go on while one is waited for.
class Cia402Client {
 public:
  /// Objects of axis n lie n * 800h above those of axis 0 (CiA 402-1 §5.2, ETG.6010 §3). `port`
  /// must outlive the client.
  explicit Cia402Client(DrivePort& port, unsigned axis = 0);
  /// A slave of an EtherCAT master, which must outlive the client.
  Cia402Client(Master& master, std::size_t position, unsigned axis = 0);

  Result<std::uint16_t> statusword();
  Result<DriveState> state();
  Result<std::int32_t> position_actual();  ///< 6064h
  Result<std::int32_t> velocity_actual();  ///< 606Ch

  /// Acknowledges a fault and waits for Switch on disabled; nothing to do without a fault.
  Result<void> reset_fault();
  /// Walks the power state machine up to Operation enabled, holding the present position.
  /// ErrorCode::drive_fault when the drive is or falls into Fault; reset_fault() is the caller's
  /// decision.
  Result<void> enable();
  /// Down to Switch on disabled.
  Result<void> disable();

  /// Quick stop: the drive brakes as its quick stop option code (605Ah) says. enable() leads on.
  Result<void> quick_stop();
  /// Stops what moves as the halt option code (605Dh) says and stays enabled (controlword bit 8);
  /// start_move(), start_homing() and run_at() end it.
  Result<void> halt();
  /// Writes the controlword (6040h) as it is, whatever that does.
  Result<void> write_controlword(std::uint16_t controlword);
  /// The one that was written last.
  [[nodiscard]] std::uint16_t controlword() const { return controlword_; }
  /// Takes `controlword` for that one, e.g. since the drive was brought back to an earlier moment.
  void assume_controlword(std::uint16_t controlword) { controlword_ = controlword; }

  /// Selects a mode and waits until the drive shows it (6061h). Some drives have one mode, which
  /// nobody can write (6060h): one that is shown already is selected.
  Result<void> set_mode(OperationMode mode);

  /// Hands a set-point to the drive in profile position mode, with the handshake of new set-point
  /// (controlword bit 4) and set-point acknowledge (statusword bit 12), and returns as soon as the
  /// drive has taken it.
  Result<void> start_move(const ProfileMove& move);
  /// Whether the drive reports target reached (statusword bit 10).
  Result<bool> target_reached();
  /// Waits for target reached; `each_cycle` is called as long as it is not.
  Result<void> wait_for_target(base::SimDuration limit,
                               const std::function<void()>& each_cycle = {});

  /// Moves in cyclic synchronous position mode, which must have been selected: a new target (607Ah)
  /// each cycle along a trapezoid, from where the axis is. For drives that have no profile position
  /// mode. `move` has to have velocity and acceleration; returns once the last target is written.
  Result<void> stream_move(const ProfileMove& move, const std::function<void()>& each_cycle = {});

  /// Turns at `velocity` (60FFh) from now on, in profile velocity or cyclic synchronous velocity
  /// mode, which must have been selected.
  Result<void> run_at(std::int32_t velocity);
  /// Begins homing by the drive's method (6098h), in homing mode, which must have been selected.
  /// Statusword bit 12 tells that home is attained, bit 13 that it cannot be.
  Result<void> start_homing();

  /// How long the drive may take for a state, a mode or a set-point; 1 s at first.
  void set_response_timeout(base::SimDuration timeout) { response_timeout_ = timeout; }

  /// Reads an object of this axis; `index` is that of axis 0.
  template <typename T>
  Result<T> read(std::uint16_t index, std::uint8_t subindex = 0);
  /// Writes an object of this axis; `index` is that of axis 0.
  template <typename T>
  Result<void> write(std::uint16_t index, std::uint8_t subindex, T value);

 private:
  [[nodiscard]] std::uint16_t axis_index(std::uint16_t index) const;
  Result<void> require_enabled(std::string_view what);
  Result<void> write_profile(const ProfileMove& move);
  Result<void> hold_position();
  Result<void> wait_for_state(DriveState wanted, bool fault_is_failure);
  Result<void> wait_for_statusword(std::uint16_t mask, std::uint16_t value, base::SimDuration limit,
                                   std::string_view awaited,
                                   const std::function<void()>& each_cycle = {});
  [[nodiscard]] Result<void> timeout(const std::string& awaited, base::SimDuration limit) const;
  Error fault_error();
  [[nodiscard]] std::string name() const;

  std::unique_ptr<DrivePort> own_port_;  ///< null: somebody else's
  DrivePort& port_;
  unsigned axis_;
  std::uint16_t controlword_ = 0;
  base::SimDuration response_timeout_{1'000'000'000};
};

template <typename T>
Result<T> Cia402Client::read(std::uint16_t index, std::uint8_t subindex) {
  const auto bits = port_.read({axis_index(index), subindex}, sizeof(T));
  if (!bits) {
    return base::Unexpected{bits.error()};
  }
  return static_cast<T>(*bits);
}

template <typename T>
Result<void> Cia402Client::write(std::uint16_t index, std::uint8_t subindex, T value) {
  return port_.write({axis_index(index), subindex}, sizeof(T), static_cast<std::uint64_t>(value));
}

}  // namespace stator::master

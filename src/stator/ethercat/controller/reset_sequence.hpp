#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/ethercat/registers/register_table.hpp"
#include "stator/ethercat/registers/time_stamp.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"

namespace stator::ethercat {

/// The reset sequence: R, E, S, written to 0x0040 by the bus in three frames or to 0x0041 by the
/// host in three accesses, with nothing in between (datasheet "ESC Reset"). Works on the
/// controller's register memory, where a side reads how far its sequence has come.
class ResetSequence {
 public:
  /// Begins before the first step.
  explicit ResetSequence(std::span<std::byte, kRegisterSpace> registers) : registers_(registers) {}

  /// Both sides are back before the first step.
  void reset();

  /// `side` has written `key` to its register.
  void take_key(AccessSide side, std::uint8_t key);
  /// A frame ends in which the bus wrote a key or could have gone on with its sequence.
  void end_of_frame();
  /// The host has made an access, which breaks its sequence unless it brought the next step.
  void end_of_host_access() { of(AccessSide::host).end_of_access(); }

  /// The bus has begun its sequence, so that what the next frame brings matters.
  [[nodiscard]] bool bus_under_way() const { return of(AccessSide::bus).progress != 0; }
  /// All steps have been made; from the bus this counts at the end of the frame.
  [[nodiscard]] bool complete(AccessSide side) const { return of(side).progress == kSteps; }

  /// The register to which `side` writes its keys.
  [[nodiscard]] static constexpr std::size_t address(AccessSide side) {
    return side == AccessSide::bus ? register_address::kResetByBus : register_address::kResetByHost;
  }

 private:
  static constexpr std::size_t kSteps = 3;
  struct Steps {
    std::uint8_t progress = 0;
    bool stepped = false;  ///< in the present frame, or access of the host

    void end_of_access() {
      progress = stepped ? progress : std::uint8_t{0};
      stepped = false;
    }
  };
  [[nodiscard]] Steps& of(AccessSide side) { return steps_[static_cast<std::size_t>(side)]; }
  [[nodiscard]] const Steps& of(AccessSide side) const {
    return steps_[static_cast<std::size_t>(side)];
  }

  std::span<std::byte, kRegisterSpace> registers_;
  std::array<Steps, 2> steps_{};  ///< by side
};

}  // namespace stator::ethercat

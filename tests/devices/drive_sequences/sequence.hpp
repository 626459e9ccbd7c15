#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "stator/tmcl/command.hpp"

namespace stator::tests {

/// What a master, a person or a machine does to a drive.
enum class DriveAction : std::uint8_t {
  wait,          ///< `value` ms pass
  write,         ///< object `index`:`subindex` = `value`; process data where they carry it
  write_near,    ///< the same with `value` increments from 6064h as it is then
  set,           ///< input `input` = `level`
  switch_at,     ///< input `input` is pressed while the shaft is further out than `level`
                 ///< revolutions from where it is now; left is negative
  travel,        ///< for `cycles` ms object `index` moves by `value` a millisecond, a position from
                 ///< where the shaft is, a velocity from 0
  lose_cycles,   ///< the next `value` exchanges of process data do not happen
  double_cycle,  ///< the next exchange happens twice
  network,       ///< EtherCAT state or NMT command `value`
  command,       ///< TMCL `command`, type `index`, `value`
};

struct DriveStep {
  DriveAction action = DriveAction::wait;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::int64_t value = 0;
  std::string_view input{};
  double level = 0.0;
  std::int32_t cycles = 0;
  tmcl::Command command{};
};

/// Drives the sequences are for; `axis0` of each.
enum class Product : std::uint8_t { tmc8670, tmcm_3315, tmcc160_hall, tmcc160_encoder, tmcm_142 };
[[nodiscard]] std::string_view to_text(Product product);

[[nodiscard]] std::string to_text(const DriveStep& step);

/// Steps that follow from `seed` alone. Most of the time the drive moves.
[[nodiscard]] std::vector<DriveStep> random_drive_sequence(Product product, std::uint64_t seed);
/// All that was done to the drive is taken back, and it is halted or disabled.
[[nodiscard]] std::vector<DriveStep> withdrawal(Product product, bool by_halt);
/// Faults are reset, limits and ramps as delivered; the drive is enabled and moves by a revolution.
[[nodiscard]] std::vector<DriveStep> revival(Product product);

/// A scenario file that does `steps`, which a DriveUnderTest resolved, to the product as the tests
/// have it. What no step of a scenario can do stands there as a comment.
[[nodiscard]] std::string scenario_of(Product product, std::span<const DriveStep> steps,
                                      std::string_view name);

}  // namespace stator::tests

// Runs one random sequence of commands on a drive, watches its invariants, and shortens sequences
// that fail.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "devices/drive_sequences/drive_invariants.hpp"
#include "devices/drive_sequences/drive_under_test.hpp"
#include "devices/drive_sequences/sequence.hpp"

namespace stator::tests {

struct DriveSequence {
  Product product{};
  std::vector<DriveStep> steps;
  bool ends_with_halt = false;  ///< otherwise it is disabled before it has to stand
};

struct TrialOutcome {
  std::optional<DriveViolation> violation;
  std::size_t steps = 0;            ///< done when it came, or all
  std::vector<DriveStep> resolved;  ///< what was done, without what depends on the shaft
  double moved = 0.0;               ///< share of the time in which the shaft turned
  double simulated = 0.0;           ///< s
};

/// Does a sequence to a drive of its own. At its end all is withdrawn, the shaft has to stand, and
/// after fault reset and enabling the drive has to move.
/// `look` sees every sample.
[[nodiscard]] TrialOutcome run_sequence(const DriveSequence& sequence,
                                        const std::set<Invariant>& excepted = {},
                                        const std::function<void(const Sample&)>& look = {});

/// The same with a drive given.
[[nodiscard]] TrialOutcome run_sequence(std::unique_ptr<DriveUnderTest> drive,
                                        const DriveSequence& sequence,
                                        const std::set<Invariant>& excepted = {},
                                        const std::function<void(const Sample&)>& look = {});

/// Leaves steps away and halves times as long as `fails` says so.
[[nodiscard]] std::vector<DriveStep> shortened(
    std::vector<DriveStep> steps, const std::function<bool(const std::vector<DriveStep>&)>& fails);

}  // namespace stator::tests

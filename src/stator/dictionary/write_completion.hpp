#pragma once

#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::dictionary {

/// Decides when a write by SDO is complete. Storing parameters is answered only when the data are
/// where they outlive the supply (CiA 301 §7.5.2.13), which takes longer than the write itself: the
/// SDO server, of CANopen or of CoE, asks until there is a verdict, and answers the client then.
class WriteCompletion {
 public:
  WriteCompletion() = default;
  WriteCompletion(const WriteCompletion&) = delete;
  WriteCompletion& operator=(const WriteCompletion&) = delete;
  virtual ~WriteCompletion() = default;

  /// Asked after each write that the dictionary took, first at once and then again and again.
  /// Nothing: what the write to `entry` has begun is still under way. Success, also for entries
  /// that never take longer, or a refusal: the answer to the client.
  [[nodiscard]] virtual std::optional<Verdict> poll(const Entry& entry, base::SimTime now) = 0;
};

}  // namespace stator::dictionary

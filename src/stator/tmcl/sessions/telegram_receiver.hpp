#pragma once

#include <cstddef>
#include <optional>

#include "stator/base/sim_time.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tmcl {

/// Puts the bytes of a serial line together to telegrams. Passive: bytes come in with their times.
///
/// A telegram has no mark at its begin, so a byte lost or added shifts all that follow. The pause
/// between two telegrams puts that right: what came before a gap longer than `gap` and is no whole
/// telegram is forgotten.
class TelegramReceiver {
 public:
  explicit TelegramReceiver(base::SimDuration gap) : gap_(gap) {}

  /// The telegram that `byte`, received at `now`, completes; nothing: it is not complete.
  [[nodiscard]] std::optional<Telegram> take(std::byte byte, base::SimTime now);
  /// Forgets what came of a telegram.
  void reset() { length_ = 0; }

  /// Bytes of the telegram that is coming in.
  [[nodiscard]] std::size_t pending() const { return length_; }

 private:
  base::SimDuration gap_;
  Telegram telegram_{};
  std::size_t length_ = 0;
  base::SimTime last_;
};

}  // namespace stator::tmcl

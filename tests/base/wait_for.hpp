#pragma once

#include <chrono>
#include <functional>
#include <thread>

namespace stator::tests {

/// Waits for `reached`, which depends on other threads or on simulated time that follows the
/// machine's clock. False: not within two minutes, which only end what hangs.
inline bool wait_for(const std::function<bool()>& reached) {
  constexpr std::chrono::minutes kPatience{2};
  constexpr std::chrono::milliseconds kPause{5};
  const auto end = std::chrono::steady_clock::now() + kPatience;
  while (!reached()) {
    if (std::chrono::steady_clock::now() > end) {
      return false;
    }
    std::this_thread::sleep_for(kPause);
  }
  return true;
}

}  // namespace stator::tests

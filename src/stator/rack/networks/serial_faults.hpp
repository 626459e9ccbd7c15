#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "stator/base/recurrence.hpp"
#include "stator/base/sim_time.hpp"

namespace stator::rack {

/// What can go wrong on a serial line.
enum class SerialFaultKind : std::uint8_t {
  noise,  ///< bits of bytes are inverted
  cut,    ///< only the first bytes of a telegram pass
  delay,  ///< bytes come later
};

/// Which way bytes go on a serial line.
enum class SerialDirection : std::uint8_t { to_devices, to_programs };

/// A fault that hits bytes or telegrams in one direction. A telegram is what passes without a
/// pause, or what a device sends at once.
struct SerialFault {
  SerialFaultKind kind = SerialFaultKind::noise;
  SerialDirection direction = SerialDirection::to_programs;
  std::uint64_t count = 0;    ///< bytes of noise, else telegrams; 0: until it is withdrawn
  double probability = 1.0;   ///< with which a byte or telegram is hit, 0 to 1
  std::uint64_t seed = 1;     ///< of the choice of bytes and bits
  std::size_t bytes = 0;      ///< of `cut`: that pass
  base::SimDuration delay{};  ///< of `delay`
};

/// The faults of one serial line, and the bytes that they delay.
class SerialFaults {
 public:
  std::uint64_t add(const SerialFault& fault);
  void withdraw(std::uint64_t number);
  [[nodiscard]] std::optional<std::uint64_t> hits(std::uint64_t number) const;

  /// Spoils bytes that pass at `now`; what is left of them to pass at once. Those before follow a
  /// pause if `pause` is shorter than the time since then.
  [[nodiscard]] std::vector<std::byte> spoil(std::span<const std::byte> bytes,
                                             SerialDirection direction, base::SimTime now,
                                             base::SimDuration pause);

  struct Delayed {
    base::SimTime due;
    SerialDirection direction;
    std::vector<std::byte> bytes;
  };
  /// When delayed bytes are due; never() if there are none.
  [[nodiscard]] base::SimTime next_delayed() const {
    return delayed_.empty() ? base::SimTime::never() : delayed_.front().due;
  }
  [[nodiscard]] Delayed take_delayed();

 private:
  struct Fault {
    std::uint64_t number = 0;
    SerialFault fault;
    base::Recurrence recurrence;
    base::Random bits{1};
    std::size_t passed = 0;  ///< bytes of the present telegram
    bool hits_telegram = false;
    std::optional<base::SimTime> last{};  ///< when bytes came last
  };
  void spoil(Fault& fault, std::vector<std::byte>& bytes, base::SimTime now,
             base::SimDuration pause);

  std::vector<Fault> faults_;
  std::deque<Delayed> delayed_;  ///< by time
  std::uint64_t newest_ = 0;
};

}  // namespace stator::rack

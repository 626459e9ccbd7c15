#pragma once

#include <cstdint>
#include <vector>

#include "stator/base/sim_time.hpp"

namespace stator::board {

/// Where a shaft stands: whole turns and the rest, so that resolution does not fall with their
/// number. Invariant: 0 <= fraction < 1.
struct ShaftPosition {
  std::int64_t turns = 0;
  double fraction = 0.0;

  friend bool operator==(const ShaftPosition&, const ShaftPosition&) = default;
};

[[nodiscard]] constexpr double revolutions(const ShaftPosition& position) {
  return static_cast<double>(position.turns) + position.fraction;
}

/// The way of a shaft during one step of its plant.
struct ShaftMotion {
  base::SimTime begin;
  base::SimDuration duration;
  ShaftPosition from;
  ShaftPosition to;
};

/// What sits on a shaft.
class ShaftObserver {
 public:
  ShaftObserver() = default;
  ShaftObserver(const ShaftObserver&) = delete;
  ShaftObserver& operator=(const ShaftObserver&) = delete;
  virtual ~ShaftObserver() = default;

  /// Told at `motion.begin`: a plant computes its step ahead with the inputs it has there, so the
  /// observer knows the moments of its edges before they come. Motions follow each other in time;
  /// between them the shaft stands.
  virtual void moves(const ShaftMotion& motion) = 0;
};

/// The shaft of a motor.
class Shaft {
 public:
  /// At construction of the board only. The observer must outlive the shaft's motions.
  void attach(ShaftObserver& observer) { observers_.push_back(&observer); }
  void move(const ShaftMotion& motion) {
    for (ShaftObserver* observer : observers_) {
      observer->moves(motion);
    }
    position_ = motion.to;
  }
  void place(const ShaftPosition& position) { position_ = position; }
  /// At the end of the latest motion.
  [[nodiscard]] const ShaftPosition& position() const { return position_; }

 private:
  std::vector<ShaftObserver*> observers_;
  ShaftPosition position_;
};

}  // namespace stator::board

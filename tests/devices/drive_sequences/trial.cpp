#include "devices/drive_sequences/trial.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <utility>

#include "devices/drive_sequences/drive_under_test.hpp"

namespace stator::tests {

namespace {

constexpr double kTurning = 0.3;  // rev/s, of a shaft that hunts or rings

class Trial {
 public:
  Trial(Product product, std::unique_ptr<DriveUnderTest> drive, const std::set<Invariant>& excepted,
        const std::function<void(const Sample&)>& look)
      : product_(product),
        look_(look),
        drive_(std::move(drive)),
        invariants_(drive_->traits(), excepted) {}

  /// False: an invariant is violated.
  bool perform(const DriveStep& step) {
    switch (step.action) {
      case DriveAction::wait:
        pass(step.value);
        break;
      case DriveAction::travel:
        travel(step);
        break;
      default:
        drive_->perform(step);
        break;
    }
    return !violated();
  }

  void finish(bool by_halt) {
    for (const DriveStep& step : withdrawal(product_, by_halt)) {
      perform(step);
    }
    if (violated() || !comes_to_rest()) {
      return;
    }
    const double start = drive_->shaft_position();
    for (const DriveStep& step : revival(product_)) {
      if (!perform(step)) {
        return;
      }
    }
    constexpr int kTime = 5000;  // ms, with a search of the commutation
    for (int i = 0; i < kTime && !violated(); ++i) {
      pass(1);
      if (std::abs(drive_->shaft_position() - start - 1.0) < kNear &&
          std::abs(drive_->shaft_velocity()) < 0.5) {
        return;
      }
    }
    std::ostringstream text;
    text << std::setprecision(4) << "moved by " << drive_->shaft_position() - start
         << " instead of 1 rev, statusword " << last_.statusword << ", mode " << last_.mode
         << ", demand " << last_.demand << ", target " << last_.target;
    invariants_.violate(Invariant::works_afterwards, last_.time, text.str());
  }

  [[nodiscard]] bool violated() const { return invariants_.violation().has_value(); }
  [[nodiscard]] TrialOutcome outcome() const {
    return {.violation = invariants_.violation(),
            .resolved = drive_->resolved(),
            .moved = passed_ == 0 ? 0.0 : static_cast<double>(moved_) / passed_,
            .simulated = 1e-3 * passed_};
  }

 private:
  static constexpr double kNear = 0.12;  // rev, one Hall step and a pole of a stepper

  void pass(std::int64_t milliseconds) {
    for (std::int64_t i = 0; i < milliseconds && !violated(); ++i) {
      drive_->pass();
      last_ = drive_->sample();
      if (look_) {
        look_(last_);
      }
      invariants_.see(last_);
      ++passed_;
      moved_ += std::abs(last_.velocity) > kTurning ? 1 : 0;
    }
  }

  void travel(const DriveStep& step) {
    const bool velocity = step.index == 0x60FF;
    std::int64_t value = velocity ? 0 : drive_->actual_position();
    for (std::int32_t i = 0; i < step.cycles && !violated(); ++i) {
      value += step.value;
      drive_->perform({.action = DriveAction::write,
                       .index = step.index,
                       .value = static_cast<std::int32_t>(value)});
      pass(1);
    }
  }

  /// No stop is under way that changes the drive's state at its end.
  [[nodiscard]] bool settled() const {
    return !last_.power || last_.stop.cause == StopCause::none ||
           last_.stop.cause == StopCause::halt || last_.stop.cause == StopCause::command ||
           last_.stop.cause == StopCause::quick_stop;
  }

  bool comes_to_rest() {
    constexpr int kTime = 12'000;  // ms: the gentlest ramp from the greatest speed, and coasting
    int rests = 0;
    for (int i = 0; i < kTime && !violated(); ++i) {
      pass(1);
      rests = std::abs(drive_->shaft_velocity()) < kTurning && settled() ? rests + 1 : 0;
      if (rests >= 60) {
        return true;
      }
    }
    std::ostringstream text;
    text << std::setprecision(4) << "12 s after everything was withdrawn the shaft turns with "
         << drive_->shaft_velocity() << " rev/s, statusword " << last_.statusword << ", mode "
         << last_.mode << ", " << to_text(last_.stop.cause);
    invariants_.violate(Invariant::runs_for_ever, last_.time, text.str());
    return false;
  }

  Product product_;
  const std::function<void(const Sample&)>& look_;
  std::unique_ptr<DriveUnderTest> drive_;
  DriveInvariants invariants_;
  Sample last_;
  int passed_ = 0;
  int moved_ = 0;
};

}  // namespace

TrialOutcome run_sequence(const DriveSequence& sequence, const std::set<Invariant>& excepted,
                          const std::function<void(const Sample&)>& look) {
  return run_sequence(make_drive(sequence.product), sequence, excepted, look);
}

TrialOutcome run_sequence(std::unique_ptr<DriveUnderTest> drive, const DriveSequence& sequence,
                          const std::set<Invariant>& excepted,
                          const std::function<void(const Sample&)>& look) {
  Trial trial(sequence.product, std::move(drive), excepted, look);
  std::size_t steps = 0;
  for (const DriveStep& step : sequence.steps) {
    ++steps;
    if (!trial.perform(step)) {
      break;
    }
  }
  if (!trial.violated()) {
    trial.finish(sequence.ends_with_halt);
  }
  TrialOutcome outcome = trial.outcome();
  outcome.steps = steps;
  return outcome;
}

std::vector<DriveStep> shortened(std::vector<DriveStep> steps,
                                 const std::function<bool(const std::vector<DriveStep>&)>& fails) {
  for (std::size_t part = std::max<std::size_t>(1, steps.size() / 2); part > 0; part /= 2) {
    for (std::size_t begin = 0; begin < steps.size();) {
      std::vector<DriveStep> fewer = steps;
      const auto first = fewer.begin() + static_cast<std::ptrdiff_t>(begin);
      fewer.erase(first, first + static_cast<std::ptrdiff_t>(std::min(part, steps.size() - begin)));
      if (fails(fewer)) {
        steps = std::move(fewer);
      } else {
        begin += part;
      }
    }
  }
  for (std::size_t i = 0; i < steps.size(); ++i) {
    while (true) {
      std::vector<DriveStep> shorter = steps;
      DriveStep& step = shorter[i];
      if (step.action == DriveAction::wait && step.value > 1) {
        step.value /= 2;
      } else if (step.action == DriveAction::travel && step.cycles > 1) {
        step.cycles /= 2;
      } else {
        break;
      }
      if (!fails(shorter)) {
        break;
      }
      steps = std::move(shorter);
    }
  }
  return steps;
}

}  // namespace stator::tests

#include "stator/control/motion_controller/reference_search.hpp"

#include <algorithm>

#include "stator/control/rounding.hpp"

namespace stator::control::motion_controller {

namespace {

std::int32_t speed(std::uint32_t setting, std::uint32_t otherwise) {
  return saturated(setting > 0 ? setting : otherwise);
}

}  // namespace

void ReferenceSearch::start(MotionController& controller, const SearchSettings& settings) {
  const std::uint32_t fastest = controller.settings().ramp.maximum_velocity;
  search_speed_ = speed(settings.search_speed, fastest);
  switch_speed_ = speed(settings.switch_speed, fastest / 4);
  right_searched_ = settings.mode != SearchMode::left_switch;
  failure_ = SearchFailure::none;
  if (search_speed_ == 0 || switch_speed_ == 0) {
    controller.rotate(0);
    end(controller, SearchFailure::no_speed);
    return;
  }
  controller.ignore_stops(true);
  if (right_searched_) {
    enter(controller, SearchState::to_right_switch, search_speed_);
  } else {
    search_left(controller);
  }
}

void ReferenceSearch::search_left(MotionController& controller) {
  enter(controller, SearchState::to_left_switch, -search_speed_);
}

void ReferenceSearch::enter(MotionController& controller, SearchState state,
                            std::int32_t velocity) {
  state_ = state;
  controller.rotate(velocity);
}

void ReferenceSearch::stop(MotionController& controller) {
  if (active()) {
    controller.rotate(0);
    end(controller);
  }
}

void ReferenceSearch::abandon(MotionController& controller) {
  if (active()) {
    end(controller, SearchFailure::undriven);
  }
}

void ReferenceSearch::end(MotionController& controller, SearchFailure failure) {
  state_ = SearchState::inactive;
  failure_ = failure;
  controller.ignore_stops(false);
}

void ReferenceSearch::advance(MotionController& controller) {
  if (!active()) {
    return;
  }
  if (controller.stopped_by_deviation()) {
    end(controller, SearchFailure::deviation);
    return;
  }
  const std::int64_t position = controller.observed_travel();
  const bool left = controller.left_switch();
  switch (state_) {
    case SearchState::to_right_switch:
      if (controller.right_switch()) {
        right_position_ = position;
        enter(controller, SearchState::braking_at_right_switch, 0);
      }
      return;
    case SearchState::to_left_switch:
      if (left) {
        enter(controller, SearchState::braking_at_left_switch, 0);
      }
      return;
    case SearchState::leaving_left_switch:
      left_seen_ = left_seen_ || left;
      if (left_seen_ && !left) {
        released_at_ = position;
        enter(controller, SearchState::braking_after_left_switch, 0);
      }
      return;
    case SearchState::reentering_left_switch:
      if (left) {
        reentered_at_ = position;
        enter(controller, SearchState::braking_at_reference, 0);
      }
      return;
    default:
      next_at_rest(controller);
  }
}

/// What follows each end of braking.
void ReferenceSearch::next_at_rest(MotionController& controller) {
  if (!controller.at_rest()) {
    return;
  }
  switch (state_) {
    case SearchState::braking_at_right_switch:
      search_left(controller);
      return;
    case SearchState::braking_at_left_switch:
      left_seen_ = controller.left_switch();
      enter(controller, SearchState::leaving_left_switch, switch_speed_);
      return;
    case SearchState::braking_after_left_switch:
      enter(controller, SearchState::reentering_left_switch, -switch_speed_);
      return;
    default:
      finish(controller);
  }
}

void ReferenceSearch::finish(MotionController& controller) {
  const std::int64_t reference = (released_at_ + reentered_at_) >> 1;
  if (right_searched_) {
    switch_distance_ = saturated(std::max<std::int64_t>(0, right_position_ - reference));
  }
  controller.set_reference(saturated(controller.travel() - reference));
  end(controller);
}

}  // namespace stator::control::motion_controller

#include "devices/drive_sequences/drive_under_test.hpp"

#include <algorithm>

#include <gtest/gtest.h>

#include "devices/drive_sequences/can_drives.hpp"
#include "devices/drive_sequences/ethercat_drives.hpp"

namespace stator::tests {

void DriveUnderTest::set_input(std::string_view name, double level) {
  if (name == "axis0.load_torque") {
    surroundings_.load = level;
  } else if (name == "axis0.supply_voltage") {
    surroundings_.source = level;
  } else if (name == "axis0.added_inertia") {
    surroundings_.inertia = level;
  } else if (name == "axis0.jammed") {
    surroundings_.jammed = level != 0.0;
  }
  for (const base::Input& input : inputs_) {
    if (input.name == name) {
      input.set(std::clamp(level, input.minimum, input.maximum));
      return;
    }
  }
  ADD_FAILURE() << "no input " << name;
}

void DriveUnderTest::command(const DriveStep& /*step*/) {}

void DriveUnderTest::perform(const DriveStep& step) {
  switch (step.action) {
    case DriveAction::write_near: {
      DriveStep absolute = step;
      absolute.action = DriveAction::write;
      absolute.value = static_cast<std::int32_t>(actual_position() + step.value);
      perform(absolute);
      break;
    }
    case DriveAction::write:
      note(step);
      write(step);
      break;
    case DriveAction::set:
      std::erase_if(cams_, [&](const Cam& cam) { return cam.input == step.input; });
      note(step);
      set_input(step.input, step.level);
      break;
    case DriveAction::switch_at: {
      const double outward = step.input == "axis0.left_switch" ? -1.0 : 1.0;
      std::erase_if(cams_, [&](const Cam& cam) { return cam.input == step.input; });
      cams_.push_back({step.input, shaft_position() + outward * step.level, false});
      break;
    }
    case DriveAction::lose_cycles:
      if (step.value > 0) {
        note(step);
      }
      lost_ = step.value;
      break;
    case DriveAction::double_cycle:
      note(step);
      doubled_ = true;
      break;
    case DriveAction::network:
      note(step);
      go_to_network_state(static_cast<int>(step.value));
      break;
    case DriveAction::command:
      note(step);
      command(step);
      break;
    case DriveAction::wait:
    case DriveAction::travel:
      break;
  }
}

void DriveUnderTest::pass() {
  turn_cams();
  int times = doubled_ ? 2 : 1;
  if (lost_ > 0) {
    --lost_;
    times = 0;
  }
  doubled_ = false;
  pass_cycle(times);
  if (!resolved_.empty() && resolved_.back().action == DriveAction::wait) {
    ++resolved_.back().value;
  } else {
    note({.action = DriveAction::wait, .value = 1});
  }
}

void DriveUnderTest::turn_cams() {
  for (Cam& cam : cams_) {
    const bool left = cam.input == "axis0.left_switch";
    const bool pressed = left ? shaft_position() < cam.at : shaft_position() > cam.at;
    if (pressed != cam.pressed) {
      cam.pressed = pressed;
      const DriveStep step{
          .action = DriveAction::set, .input = cam.input, .level = pressed ? 1.0 : 0.0};
      note(step);
      set_input(step.input, step.level);
    }
  }
}

std::unique_ptr<DriveUnderTest> make_drive(Product product) {
  switch (product) {
    case Product::tmc8670:
      return make_tmc8670_drive();
    case Product::tmcm_3315:
      return make_tmcm_3315_drive();
    case Product::tmcc160_hall:
      return make_tmcc160_drive(false);
    case Product::tmcc160_encoder:
      return make_tmcc160_drive(true);
    case Product::tmcm_142:
      return make_tmcm_142_drive();
  }
  return nullptr;
}

}  // namespace stator::tests

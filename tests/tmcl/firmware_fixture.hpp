#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/sim_time.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"
#include "tmcl/fake_module.hpp"

namespace stator::tests {

/// Instructions as programs and telegrams hold them.
inline tmcl::Instruction instruction(tmcl::Command command, int type = 0, int motor = 0,
                                     std::int32_t value = 0) {
  return {.command = static_cast<std::uint8_t>(command),
          .type = static_cast<std::uint8_t>(type),
          .motor = static_cast<std::uint8_t>(motor),
          .value = value};
}

/// A firmware with the fake module behind it, switched on at time 0.
class FirmwareFixture : public testing::Test {
 protected:
  FirmwareFixture() {
    module_.power_on();
    firmware_.power_on(now_);
  }

  tmcl::HostAnswer execute(tmcl::Command command, int type = 0, int motor = 0,
                           std::int32_t value = 0, tmcl::Origin origin = tmcl::Origin::serial) {
    return firmware_.execute(instruction(command, type, motor, value), origin, now_);
  }
  tmcl::Status status(tmcl::Command command, int type = 0, int motor = 0, std::int32_t value = 0) {
    return execute(command, type, motor, value).status;
  }
  std::int32_t axis(int number) { return execute(tmcl::Command::get_axis_parameter, number).value; }
  std::int32_t global(int number, int bank = 0) {
    return execute(tmcl::Command::get_global_parameter, number, bank).value;
  }
  void set_global(int number, std::int32_t value, int bank = 0) {
    EXPECT_EQ(status(tmcl::Command::set_global_parameter, number, bank, value),
              tmcl::Status::success);
  }

  void load(const std::vector<tmcl::Instruction>& program) { firmware_.load_program(program); }
  void start(const std::vector<tmcl::Instruction>& program) {
    load(program);
    EXPECT_EQ(status(tmcl::Command::run_application, 1), tmcl::Status::success);
  }
  void advance(base::SimDuration duration) {
    now_ += duration;
    firmware_.advance(now_);
  }
  /// Lets `count` instructions of the default rate pass.
  void pass(std::int64_t count = 1) { advance(base::SimDuration(100'000) * count); }
  [[nodiscard]] const tmcl::Registers& registers() const { return firmware_.state().registers; }
  [[nodiscard]] int counter() const { return firmware_.state().program_counter; }
  [[nodiscard]] tmcl::ApplicationStatus application() const {
    return firmware_.state().application;
  }

  FakeModule module_;
  base::SimTime now_;
  tmcl::Firmware firmware_{FakeModule::description(), module_};
};

}  // namespace stator::tests

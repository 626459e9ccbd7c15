#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "sentences.hpp"
#include "stator/base/sim_time.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/sessions/serial_port.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::tests {

using devices::Tmcm142;
using devices::Tmcm142Configuration;

/// The other end of a serial line.
class SerialCable final : public tmcl::SerialPort {
 public:
  std::size_t take(std::span<std::byte> buffer) override {
    std::size_t count = 0;
    while (count < buffer.size() && !to_module_.empty()) {
      buffer[count++] = to_module_.front();
      to_module_.pop_front();
    }
    return count;
  }
  void send(std::span<const std::byte> bytes, base::SimTime /*now*/) override {
    from_module_.insert(from_module_.end(), bytes.begin(), bytes.end());
  }
  void write(std::span<const std::byte> bytes) {
    to_module_.insert(to_module_.end(), bytes.begin(), bytes.end());
  }
  /// What has come from the module since the last call.
  [[nodiscard]] std::vector<std::byte> read() { return std::exchange(from_module_, {}); }

 private:
  std::deque<std::byte> to_module_;
  std::vector<std::byte> from_module_;
};

/// A TMCM-142 with its time, reached through direct mode.
struct Tmcm142Module {
  explicit Tmcm142Module(Tmcm142Configuration wanted = {})
      : device(std::make_unique<Tmcm142>(wanted, base::EventReporter(&events, 0))) {}

  /// A command as from a host on a serial line.
  tmcl::HostAnswer execute(tmcl::Command command, int type, int motor, std::int64_t value = 0) {
    return device->tmcl().execute({.command = static_cast<std::uint8_t>(command),
                                   .type = static_cast<std::uint8_t>(type),
                                   .motor = static_cast<std::uint8_t>(motor),
                                   .value = static_cast<std::int32_t>(value)},
                                  tmcl::Origin::serial, now);
  }
  tmcl::Status sap(devices::tmcm_142::AxisParameter parameter, std::int64_t value) {
    return execute(tmcl::Command::set_axis_parameter, static_cast<int>(parameter), 0, value).status;
  }
  std::int32_t gap(devices::tmcm_142::AxisParameter parameter) {
    const tmcl::HostAnswer answer =
        execute(tmcl::Command::get_axis_parameter, static_cast<int>(parameter), 0);
    EXPECT_EQ(answer.status, tmcl::Status::success) << "GAP " << static_cast<int>(parameter);
    return answer.value;
  }
  tmcl::Status sgp(int parameter, std::int64_t value, int bank = 0) {
    return execute(tmcl::Command::set_global_parameter, parameter, bank, value).status;
  }
  std::int32_t ggp(int parameter, int bank = 0) {
    return execute(tmcl::Command::get_global_parameter, parameter, bank).value;
  }
  [[nodiscard]] bool raised(tmcl::ErrorFlag flag) const {
    return device->tmcl().state().registers.raised(flag);
  }
  void run(base::SimDuration duration) {
    now += duration;
    device->advance(now);
  }
  /// False: the target was not reached in time.
  [[nodiscard]] bool run_to_target(base::SimDuration limit) {
    const base::SimTime end = now + limit;
    while (now < end && gap(devices::tmcm_142::AxisParameter::position_reached) == 0) {
      run(base::SimDuration(1'000'000));
    }
    return gap(devices::tmcm_142::AxisParameter::position_reached) == 1;
  }
  void power_cycle() {
    device->set_power(false, now);
    run(base::SimDuration(10'000'000));
    device->set_power(true, now);
  }
  /// Sets something of the world around the module.
  void set(const std::string& input, double value) {
    for (const product::Input& each : device->inputs()) {
      if (each.name == input) {
        each.set(value);
        return;
      }
    }
    FAIL() << "no input " << input;
  }
  [[nodiscard]] double signal(const std::string& name) {
    for (const product::Signal& each : device->signals()) {
      if (each.name == name) {
        return each.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }

  Sentences events;
  std::unique_ptr<Tmcm142> device;
  base::SimTime now;
};

}  // namespace stator::tests

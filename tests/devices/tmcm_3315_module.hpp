// A TMCM-3315 with an EtherCAT master that reads and writes objects by axis, for its tests.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "devices/sentences.hpp"
#include "devices/test_bus.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {

using namespace base::literals;
using drive::PowerState;
using ethercat::AlState;
using Emergency = tests::TestBus::Emergency;

inline constexpr double kMicrostepsPerRevolution = 51'200.0;
inline constexpr std::uint32_t kDeviceStateAbort = 0x08000022;

/// Index of an object of motor `n`.
constexpr std::uint16_t of_motor(unsigned n, unsigned index) {
  return static_cast<std::uint16_t>(index + n * (index < 0x6000 ? 0x200 : 0x800));
}

class Tmcm3315Module : public testing::Test {
 protected:
  explicit Tmcm3315Module(const Tmcm3315Configuration& configuration = {}) { renew(configuration); }

  /// A new module on a new bus, in place of those before.
  void renew(const Tmcm3315Configuration& configuration = {}) {
    bus_.reset();  // takes itself off the device
    device_ = std::make_unique<Tmcm3315>(configuration, base::EventReporter(&told_, 0));
    bus_ = std::make_unique<tests::TestBus>(*device_);
  }

  /// Operational without process data watchdog: SDOs alone drive the axes.
  void go_operational() {
    bus_->write(0x0420, {std::byte{0}, std::byte{0}});
    bus_->bring_to(AlState::operational);
  }
  template <typename T>
  void write(std::uint16_t index, T value, std::uint8_t subindex = 0) {
    EXPECT_EQ(bus_->download<T>(index, subindex, value), 0U) << std::hex << index;
  }
  /// Positions are those of the encoder, which gives `counts` a revolution.
  void use_encoder(unsigned motor = 0, std::uint32_t counts = 40'000) {
    write<std::int16_t>(of_motor(motor, 0x606A), 0);
    write<std::uint32_t>(of_motor(motor, 0x608F), counts, 1);
  }
  void set_profile(unsigned motor, std::uint32_t velocity, std::uint32_t acceleration) {
    write<std::uint32_t>(of_motor(motor, 0x6081), velocity);
    write<std::uint32_t>(of_motor(motor, 0x6083), acceleration);
    write<std::uint32_t>(of_motor(motor, 0x6084), acceleration);
  }
  void enable(unsigned motor, std::int8_t mode) {
    write<std::int8_t>(of_motor(motor, 0x6060), mode);
    for (const int controlword : {6, 7, 15}) {
      control(motor, static_cast<std::uint16_t>(controlword));
    }
  }
  void control(unsigned motor, std::uint16_t controlword) {
    write<std::uint16_t>(of_motor(motor, 0x6040), controlword);
  }
  void start_move(unsigned motor, std::int32_t target) {
    write<std::int32_t>(of_motor(motor, 0x607A), target);
    control(motor, 31);
    control(motor, 15);
  }
  std::uint16_t statusword(unsigned motor = 0) {
    return bus_->upload<std::uint16_t>(of_motor(motor, 0x6041));
  }
  double signal(const std::string& name) {
    for (const product::Signal& candidate : device_->signals()) {
      if (candidate.name == name) {
        return candidate.read();
      }
    }
    ADD_FAILURE() << "no signal " << name;
    return 0.0;
  }
  void set_input(const std::string& name, double value) {
    for (const product::Input& candidate : device_->inputs()) {
      if (candidate.name == name) {
        EXPECT_GE(value, candidate.minimum) << name;
        EXPECT_LE(value, candidate.maximum) << name;
        candidate.set(value);
        return;
      }
    }
    ADD_FAILURE() << "no input " << name;
  }
  double shaft_microsteps(unsigned motor = 0) {
    return signal("axis" + std::to_string(motor) + ".shaft_position") * kMicrostepsPerRevolution;
  }

  tests::Sentences told_;
  std::unique_ptr<Tmcm3315> device_;
  std::unique_ptr<tests::TestBus> bus_;
};

}  // namespace stator::devices

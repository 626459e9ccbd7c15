#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "devices/sentences.hpp"
#include "devices/test_bus.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"

namespace stator::devices {

using namespace base::literals;
using drive::PowerState;
using ethercat::AlState;

/// The default motor with a flywheel and the gains of racks/ethercat-servo.toml.
inline Tmc8670Configuration tuned_chip() {
  Tmc8670Configuration configuration;
  configuration.axis.load.inertia = 2e-5;
  configuration.objects = {
      {0x2030, 1, 1453}, {0x2030, 2, 786},    {0x2030, 3, 1453},   {0x2030, 4, 786},
      {0x2030, 5, 6400}, {0x2030, 6, 80},     {0x2030, 7, 300},    {0x2031, 1, 12'000},
      {0x6072, 0, 2000}, {0x6073, 0, 2000},   {0x6075, 0, 2450},   {0x6076, 0, 125},
      {0x6081, 0, 2000}, {0x6083, 0, 20'000}, {0x6084, 0, 20'000}, {0x6085, 0, 50'000}};
  return configuration;
}

class Tmc8670Chip : public testing::Test {
 protected:
  explicit Tmc8670Chip(const Tmc8670Configuration& configuration = tuned_chip()) {
    renew(configuration);
  }

  /// A new chip on a new bus, in place of those before.
  void renew(const Tmc8670Configuration& configuration = tuned_chip()) {
    bus_.reset();  // takes itself off the device
    device_ = std::make_unique<Tmc8670>(configuration, base::EventReporter(&told_, 0));
    bus_ = std::make_unique<tests::TestBus>(*device_);
    bus_->set_output_length(13);
    bus_->set_input_length(15);
  }

  /// Operational without process data watchdog: SDOs alone drive the axis.
  void go_operational() {
    bus_->write(0x0420, {std::byte{0}, std::byte{0}});
    bus_->bring_to(AlState::operational);
  }
  template <typename T>
  void write(std::uint16_t index, T value, std::uint8_t subindex = 0) {
    EXPECT_EQ(bus_->download<T>(index, subindex, value), 0U) << std::hex << index;
  }
  template <typename T>
  T read(std::uint16_t index, std::uint8_t subindex = 0) {
    return bus_->upload<T>(index, subindex);
  }
  void control(std::uint16_t controlword) { write<std::uint16_t>(0x6040, controlword); }
  std::uint16_t statusword() { return read<std::uint16_t>(0x6041); }
  void enable(std::int8_t mode) {
    write<std::int8_t>(0x6060, mode);
    for (const int controlword : {6, 7, 15}) {
      control(static_cast<std::uint16_t>(controlword));
      bus_->pass(5_ms);
    }
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

  tests::Sentences told_;
  std::unique_ptr<Tmc8670> device_;
  std::unique_ptr<tests::TestBus> bus_;
};

}  // namespace stator::devices

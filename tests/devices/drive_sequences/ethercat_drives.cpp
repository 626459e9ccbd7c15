#include "devices/drive_sequences/ethercat_drives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "devices/drive_sequences/cia402_axis.hpp"
#include "devices/drive_sequences/object_access.hpp"
#include "devices/drive_sequences/three_phase_sample.hpp"
#include "devices/test_bus.hpp"
#include "devices/tmc8670_chip.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::tests {

namespace {

using ethercat::AlState;
using namespace base::literals;

constexpr double kTurn = 2.0 * std::numbers::pi;

/// An object in the outputs of the default mapping.
struct MappedObject {
  std::uint16_t index = 0;
  std::uint8_t offset = 0;
  std::uint8_t size = 0;
};

/// A device with process data on a bus of its own.
class EtherCatDrive : public DriveUnderTest {
 protected:
  EtherCatDrive(std::unique_ptr<product::EtherCatDevice> device, std::uint8_t outputs,
                std::uint8_t inputs, std::span<const MappedObject> mapped)
      : device_(std::move(device)), bus_(*device_), mapped_(mapped) {
    surround(*device_);
    bus_.set_output_length(outputs);
    bus_.set_input_length(inputs);
    bus_.bring_to(AlState::operational);
  }

  [[nodiscard]] bool exchanges() const { return state_ >= 4; }
  [[nodiscard]] base::SimTime now() const { return bus_.now(); }
  [[nodiscard]] product::EtherCatDevice& device() { return *device_; }

  void write(const DriveStep& step) override {
    for (const MappedObject& object : mapped_) {
      if (object.index == step.index && exchanges()) {
        for (unsigned i = 0; i < object.size; ++i) {
          bus_.outputs[object.offset + i] =
              static_cast<std::byte>(static_cast<std::uint64_t>(step.value) >> (8 * i));
        }
        return;
      }
    }
    write_object(*device_, step, network(), bus_.now());
  }

  void go_to_network_state(int state) override {
    const auto acknowledged = [this](int wanted) {
      bus_.request(static_cast<AlState>(0x10 | wanted));
    };
    // The watchdog may have taken it down.
    state_ = std::to_integer<int>(bus_.read(0x0130, 1)[0]) & 0x0F;
    if (state == state_ && state == 8) {
      return;
    }
    if (state == 8 && state_ == 4) {
      acknowledged(4);
      bus_.exchange();
      bus_.request(AlState::operational);
    } else if (state == 8 && state_ < 4) {
      acknowledged(1);
      bus_.bring_to(AlState::operational);
    } else if (state < 4 && state_ < 4) {
      return;  // nothing drives the axis there
    } else {
      acknowledged(state);
    }
    state_ = state;
  }

  void pass_cycle(int times) override {
    const base::SimTime end = next_;
    next_ = next_ + 1_ms;
    for (int i = 0; i < times && exchanges(); ++i) {
      bus_.exchange();
    }
    if (bus_.now() < end) {
      bus_.pass(end - bus_.now());
    }
  }
  void begin_cycles() { next_ = bus_.now() + 1_ms; }

 private:
  [[nodiscard]] dictionary::NetworkState network() const {
    return state_ == 8   ? dictionary::NetworkState::operational
           : state_ == 4 ? dictionary::NetworkState::safe_operational
                         : dictionary::NetworkState::pre_operational;
  }

  std::unique_ptr<product::EtherCatDevice> device_;
  TestBus bus_;
  std::span<const MappedObject> mapped_;
  int state_ = 8;  ///< as requested last
  base::SimTime next_;
};

constexpr std::array kTmc8670Outputs{MappedObject{0x6040, 0, 2}, MappedObject{0x6060, 2, 1},
                                     MappedObject{0x607A, 3, 4}, MappedObject{0x60FF, 7, 4},
                                     MappedObject{0x6071, 11, 2}};

devices::Tmc8670Configuration servo() {
  devices::Tmc8670Configuration configuration = devices::tuned_chip();
  configuration.axis.inverter.dead_time = 2e-7;
  for (const devices::tmc8670::ObjectValue& object :
       {devices::tmc8670::ObjectValue{0x2040, 1, 28'000},
        {0x2040, 2, 27'000},
        {0x6065, 0, 65'536},
        {0x6066, 0, 100},
        {0x6067, 0, 100},
        {0x6068, 0, 10},
        {0x6098, 0, 34}}) {
    configuration.objects.push_back(object);
  }
  return configuration;
}

class Tmc8670Drive final : public EtherCatDrive {
 public:
  Tmc8670Drive()
      : EtherCatDrive(std::make_unique<devices::Tmc8670>(servo()), 13, 15, kTmc8670Outputs),
        chip_(static_cast<devices::Tmc8670&>(device())),
        motor_(*plant::find_three_phase_motor("QBL4208-61-04-013")),
        inertia_(motor_.rotor_inertia + 2e-5) {
    begin_cycles();
    choices_ = {.counts = 65'536.0};
    traits_ = {.standstill = 0.5,
               .settle = 0.05,
               .reaction = 0.03,
               .bandwidth = 200.0,
               .inertia = inertia_,
               .follows_within = 0.01,
               .position_error = 0.005,
               .velocity_error = 0.6,
               .no_load_velocity = 3.5,
               .overvoltage = 61.0,
               .current_allowance = 1.5};
  }

  Sample sample() override {
    const plant::PwmAxis& plant = chip_.axis().stage().plant();
    const drive::FocAxis& axis = chip_.axis().axis();
    Sample sample = three_phase_sample(plant, now(), motor_, inertia_, surroundings(),
                                       axis.settings().reference.switches);
    const drive::FocSettings& settings = axis.foc_settings();
    const double rated = 1.4142135623730951e-3 * settings.rated_current;
    sample.current_limit =
        std::min({1e-3 * std::min(settings.maximum_torque, settings.maximum_current) * rated,
                  settings.torque_flux_limit * settings.current_per_step});
    sample.torque_limit = sample.current_limit * motor_.torque_constant();
    observer_.observe(axis, choices_, sample);
    sample.shown_torque = axis.quadrature_current() * motor_.torque_constant();
    return sample;
  }
  double shaft_velocity() override { return chip_.axis().stage().plant().speed() / kTurn; }
  double shaft_position() override { return chip_.axis().stage().plant().revolutions(); }
  std::int64_t actual_position() override {
    return chip_.axis().axis().objects().position_actual.get();
  }

 private:
  devices::Tmc8670& chip_;
  plant::ThreePhaseMotorParameters motor_;
  double inertia_;
  Cia402Choices choices_;
  Cia402Observer observer_;
};

constexpr std::array kTmcm3315Outputs{MappedObject{0x6040, 0, 2}, MappedObject{0x607A, 2, 4},
                                      MappedObject{0x60FF, 6, 4}};

devices::Tmcm3315Configuration damped_module() {
  devices::Tmcm3315Configuration configuration;
  configuration.axes[0].load.viscous_friction = 0.004;  // N m s/rad: it does not ring for long
  return configuration;
}

class Tmcm3315Drive final : public EtherCatDrive {
 public:
  Tmcm3315Drive()
      : EtherCatDrive(std::make_unique<devices::Tmcm3315>(damped_module()), 30, 30,
                      kTmcm3315Outputs),
        module_(static_cast<devices::Tmcm3315&>(device())) {
    begin_cycles();
    traits_ = {.standstill = 0.002,
               .settle = 1e-4,
               .reaction = 0.002,
               .lag = 0.0,
               .bandwidth = 1000.0,
               .inertia = 2e-5,
               .follows_within = 0.01,
               .velocity_error = 0.002,
               .current_allowance = 0.6,
               .shaft_is_counter = true};
  }

  Sample sample() override {
    const plant::StepperAxis& plant = module_.axis(0).plant();
    const drive::StepperAxis& axis = module_.axis(0).axis();
    Sample sample{.time = now(),
                  .position = static_cast<double>(axis.motion().position()) / kCounts,
                  .velocity = axis.motion().velocity() / kCounts,
                  .inertia = traits_.inertia,
                  .torque_limit = kUnlimited,
                  .supply = plant.sensing().supply_voltage,
                  .source = surroundings().source,
                  .jammed = surroundings().jammed};
    const std::array<double, 2>& coils = plant.sensing().coil_current;
    sample.current = std::hypot(coils[0], coils[1]);
    sample.current_limit = 3.0;
    const drive::SwitchStates pressed = axis.settings().reference.switches.pressed(
        {plant.sensing().left_switch, plant.sensing().right_switch, plant.sensing().home_switch});
    sample.negative_switch = pressed.negative_limit;
    sample.positive_switch = pressed.positive_limit;
    Cia402Choices choices{.counts = kCounts, .halts_homing = false, .steps_to_rest = true};
    const double stop = axis.settings().ramp.stop_deceleration / kCounts;
    choices.switch_deceleration = stop > 0.0 ? stop : kUnlimited;
    observer_.observe(axis, choices, sample);
    if (stop <= 0.0 && (sample.negative_switch || sample.positive_switch)) {
      sample.acceleration = kUnlimited;
    }
    return sample;
  }
  double shaft_velocity() override { return module_.axis(0).plant().observe().speed / kTurn; }
  double shaft_position() override { return module_.axis(0).plant().observe().shaft_revolutions; }
  std::int64_t actual_position() override {
    return module_.axis(0).axis().objects().position_actual.get();
  }

 private:
  static constexpr double kCounts = 51'200.0;
  static constexpr double kUnlimited = 1e9;

  devices::Tmcm3315& module_;
  Cia402Observer observer_;
};

}  // namespace

std::unique_ptr<DriveUnderTest> make_tmc8670_drive() {
  return std::make_unique<Tmc8670Drive>();
}

std::unique_ptr<DriveUnderTest> make_tmcm_3315_drive() {
  return std::make_unique<Tmcm3315Drive>();
}

}  // namespace stator::tests

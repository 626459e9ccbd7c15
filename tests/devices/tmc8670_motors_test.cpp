// The chip with other motors, other PWM rates, other clocks, and what its pins and LEDs show.

#include <cmath>
#include <vector>

#include "devices/tmc8670_chip.hpp"
#include "stator/devices/tmc8670/junction.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/ethercat/units/led.hpp"

namespace stator::devices {
namespace {

using control::foc::field;

class Tmc8670Motors : public Tmc8670Chip {};

Tmc8670Configuration stepper_chip() {
  Tmc8670Configuration configuration;
  configuration.axis.motor = *plant::find_stepper_motor("QSH5718-55-30-098");
  configuration.axis.halls.fitted = false;
  configuration.axis.load.inertia = 2e-5;
  configuration.axis.supply_voltage = 48.0;
  configuration.objects = {
      {0x2000, 1, 2},     {0x2000, 2, 50},    {0x2030, 1, 1500},   {0x2030, 2, 200},
      {0x2030, 3, 1500},  {0x2030, 4, 200},   {0x2030, 5, 2500},   {0x2030, 6, 60},
      {0x2030, 7, 200},   {0x2031, 1, 6'000}, {0x2031, 6, 32'767}, {0x2050, 1, 2},
      {0x2050, 2, 2'000}, {0x6075, 0, 2'000}, {0x6072, 0, 2'000},  {0x6073, 0, 2'000},
      {0x6081, 0, 200},   {0x6083, 0, 2'000}, {0x6084, 0, 2'000}};
  return configuration;
}

Tmc8670Configuration brushed_chip() {
  Tmc8670Configuration configuration;
  configuration.axis.motor = plant::DcMotorParameters{};
  configuration.axis.load.inertia = 2e-5;
  configuration.objects = {{0x2000, 1, 1},     {0x2000, 2, 1},     {0x2030, 1, 250},
                           {0x2030, 2, 4'000}, {0x2030, 3, 250},   {0x2030, 4, 4'000},
                           {0x2030, 5, 5'000}, {0x2030, 6, 60},    {0x2030, 7, 200},
                           {0x2031, 1, 8'000}, {0x6075, 0, 2'100}, {0x6072, 0, 2'000},
                           {0x6073, 0, 2'000}};
  return configuration;
}

TEST_F(Tmc8670Motors, AStepperMotorFollowsCyclicPositions) {
  renew(stepper_chip());
  go_operational();
  enable(8);
  bus_->pass(2_s);  // the commutation is searched by a current in D
  ASSERT_EQ(statusword() & 0x006F, 0x0027) << "Operation enabled";
  const auto start = read<std::int32_t>(0x6064);
  const double turned = signal("axis0.shaft_position");
  for (int k = 1; k <= 400; ++k) {
    base::store_le(bus_->outputs, 0, std::uint16_t{15});
    base::store_le(bus_->outputs, 2, std::uint8_t{8});
    base::store_le(bus_->outputs, 3, start + 50 * k);
    bus_->exchange();
    bus_->pass(1_ms - 20_us);
  }
  bus_->pass(200_ms);
  EXPECT_NEAR((signal("axis0.shaft_position") - turned) * 65'536.0, 20'000.0, 200.0);
}

TEST_F(Tmc8670Motors, ABrushedMotorTurnsAtItsSpeed) {
  renew(brushed_chip());
  go_operational();
  enable(9);
  write<std::int32_t>(0x60FF, 900);
  bus_->pass(500_ms);
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, 900.0, 15.0);
  EXPECT_EQ(signal("axis0.duty_w"), 0.0) << "the first full bridge alone";
}

TEST_F(Tmc8670Motors, LoopsRunAtThePwmRateWhateverTheFirmwareDoes) {
  go_operational();
  enable(3);
  write<std::int32_t>(0x60FF, 600);
  bus_->pass(300_ms);
  // Between two ticks of the firmware a register is written: the next PWM period obeys.
  const std::int64_t since_tick = bus_->now().nanoseconds() % 125'000;
  bus_->pass(base::SimDuration(126'000 - since_tick));
  control::foc::FocBlock& block = device_->axis().stage().block();
  EXPECT_GT(block.get(field("PIDOUT_TARGET_TORQUE")), -3'000);
  block.set(field("PID_VELOCITY_TARGET"), 0);
  bus_->pass(100_us);
  EXPECT_LT(block.get(field("PIDOUT_TARGET_TORQUE")), -6'000);
}

TEST_F(Tmc8670Motors, PwmGoesUpToAHundredKilohertz) {
  Tmc8670Configuration configuration = tuned_chip();
  configuration.objects.push_back({0x2001, 1, 999});
  configuration.objects.push_back({0x2030, 2, 200});
  configuration.objects.push_back({0x2030, 4, 200});
  configuration.objects.push_back({0x2030, 6, 20});
  renew(configuration);
  EXPECT_EQ(device_->axis().pwm_period(), 10_us);
  go_operational();
  enable(3);
  write<std::int32_t>(0x60FF, 1'000);
  bus_->pass(300_ms);
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, 1'000.0, 15.0);
}

TEST_F(Tmc8670Motors, OpenInputsReadOne) {
  Tmc8670Configuration configuration;
  configuration.axis.encoders[1].counts_per_revolution = 0;
  renew(configuration);
  bus_->pass(1_ms);
  const control::foc::FocBlock& block = device_->axis().stage().block();
  EXPECT_EQ(block.get(field("REF_SW_H_RAW")), 1);
  EXPECT_EQ(block.get(field("REF_SW_L_RAW")), 1);
  EXPECT_EQ(block.get(field("REF_SW_R_RAW")), 1);
  EXPECT_EQ(control::foc::PinLevels{}.halls, 7);
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(read<std::uint32_t>(0x60FD), 0U) << "active low: none is pressed";
  set_input("axis0.left_switch", 1.0);
  bus_->pass(1_ms);
  EXPECT_EQ(block.get(field("REF_SW_L_RAW")), 0);
  EXPECT_EQ(read<std::uint32_t>(0x60FD), 1U);
}

TEST_F(Tmc8670Motors, AnOscillatorMayDeviate) {
  Tmc8670Configuration configuration;
  configuration.clock_deviation_ppb = 25'000;
  renew(configuration);
  bus_->pass(1_s);
  const std::int64_t ahead =
      static_cast<std::int64_t>(device_->controller().system_time(bus_->now())) -
      bus_->now().nanoseconds();
  EXPECT_NEAR(static_cast<double>(ahead), 25'000.0, 100.0);
}

TEST_F(Tmc8670Motors, LedsAreSignals) {
  EXPECT_EQ(signal("led_run"), 0.0);
  EXPECT_EQ(signal("led_error"), 0.0);
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(signal("led_run"), static_cast<double>(ethercat::LedCode::blinking));
  EXPECT_EQ(signal("led_link_in"), static_cast<double>(ethercat::LedCode::flickering));
  EXPECT_EQ(signal("led_link_out"), 0.0) << "nothing is connected";
  bus_->pass(1_s);
  EXPECT_EQ(signal("led_link_in"), static_cast<double>(ethercat::LedCode::on)) << "no frames";
}

TEST(Tmc8670Junction, FollowsAirPowerAndDraught) {
  using namespace tmc8670;
  EXPECT_NEAR(kStaticPower + kDynamicPower, 0.562, 1e-12);
  EXPECT_EQ(junction_to_ambient(0.0), 27.03);
  EXPECT_EQ(junction_to_ambient(1.0), 22.91);
  EXPECT_EQ(junction_to_ambient(2.5), 21.25);
  EXPECT_EQ(junction_to_ambient(9.0), 21.25);
  EXPECT_NEAR(junction_to_ambient(0.5), 24.97, 1e-12);
  EXPECT_NEAR(junction_temperature(25.0, 0.562, 0.0), 40.19, 0.01);
  EXPECT_NEAR(maximum_power(85.0, 0.0), 40.0 / 27.03, 1e-12);
}

TEST_F(Tmc8670Motors, ADraughtCoolsTheChipAndWithoutSupplyItIsCold) {
  const double still = signal("axis0.junction_temperature");
  set_input("axis0.air_speed", 2.5);
  EXPECT_NEAR(signal("axis0.junction_temperature"), still - 0.562 * (27.03 - 21.25), 1e-9);
  device_->set_power(false, bus_->now());
  EXPECT_EQ(signal("axis0.junction_temperature"), 25.0);
}

}  // namespace
}  // namespace stator::devices

// Homing of a TMC8670 as a master commissions and runs it.

#include <set>

#include "devices/tmc8670_cycles.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"
#include "stator/drive/modes/homing_methods.hpp"

namespace stator::devices {
namespace {

constexpr std::uint16_t kAttained = 1U << 12;
constexpr std::uint16_t kError = 1U << 13;
constexpr std::uint32_t kNoSuchValue = 0x06090030;

class Tmc8670Homing : public Tmc8670Cycles {
 protected:
  [[nodiscard]] unsigned bits() const {
    return static_cast<unsigned>(seen().statusword) & (kReached | kAttained | kError);
  }
};

TEST_F(Tmc8670Homing, MethodsThatAreNotThereAreRefusedAndThoseThatAreAreListed) {
  std::set<int> listed;
  for (std::uint8_t k = read<std::uint8_t>(0x60E3); k > 0; --k) {
    listed.insert(read<std::int8_t>(0x60E3, k));
  }
  EXPECT_EQ(listed.size(), drive::kHomingMethods.size());
  for (int method = -128; method < 128; ++method) {
    const std::uint32_t answer =
        bus_->download<std::int8_t>(0x6098, 0, static_cast<std::int8_t>(method));
    EXPECT_EQ(answer, method == 0 || listed.contains(method) ? 0 : kNoSuchValue) << method;
  }
  write<std::int8_t>(0x6098, 34);
  for (const int method : {4, 7, 8, 23, 30}) {
    EXPECT_EQ(bus_->download<std::int8_t>(0x6098, 0, static_cast<std::int8_t>(method)),
              kNoSuchValue);
  }
  EXPECT_EQ(read<std::int8_t>(0x6098), 34) << "as it was";
}

TEST_F(Tmc8670Homing, HaltHoldsARunAndItsEndContinuesIt) {
  for (const int method : {17, 34, -1}) {
    SCOPED_TRACE(method);
    Tmc8670Configuration configuration = servo();
    configuration.axis.initial_revolutions = 0.3;
    configuration.axis.load.end_stop_maximum = 4.0;
    renew(configuration);
    go_operational();
    write<std::int8_t>(0x6098, static_cast<std::int8_t>(method));
    write<std::uint32_t>(0x6099, 300, 1);
    write<std::uint32_t>(0x6099, 60, 2);
    write<std::uint32_t>(0x609A, 4000);
    write<std::uint32_t>(0x2055, 1000, 1);
    enable_in(6);
    EXPECT_EQ(bits(), kReached) << "not started";
    command(0x1F);
    cycle(200_ms);
    ASSERT_GT(std::fabs(seen().rpm), 40.0);
    EXPECT_EQ(bits(), 0U);
    forget();
    command(0x11F);
    cycle(300_ms);
    EXPECT_LE(speed_at_target_reached(), kStands);
    EXPECT_EQ(bits(), kReached) << "interrupted";
    const double stood = seen().revolutions;
    cycle(300_ms);
    EXPECT_NEAR(seen().revolutions, stood, 0.01);
    command(0x1F);
    cycle(1_ms);
    EXPECT_EQ(bits(), 0U);
    if (method == 17) {
      cycle(100_ms);
      set_input("axis0.left_switch", 1.0);
      cycle(200_ms);
      set_input("axis0.left_switch", 0.0);
    }
    EXPECT_TRUE(cycle_until([&] { return bits() == (kReached | kAttained); }, 10_s));
  }
}

TEST_F(Tmc8670Homing, WithoutASpeedItEndsWithAHomingError) {
  write<std::int8_t>(0x6098, 34);
  write<std::uint32_t>(0x6099, 0, 1);
  enable_in(6);
  command(0x1F);
  cycle(1_ms);
  EXPECT_EQ(bits(), kError | kReached);
  EXPECT_EQ(told_.count("homing method 34 not started: 6099h is 0 and 10 rpm"), 1);
}

TEST_F(Tmc8670Homing, ThePresentPositionBecomesTheHomeOffset) {
  write<std::int32_t>(0x607C, 5000);
  for (const int method : {35, 37}) {
    for (const int as_position : {0, 1}) {
      write<std::uint8_t>(0x2053, static_cast<std::uint8_t>(as_position), 3);
      write<std::int8_t>(0x6098, static_cast<std::int8_t>(method));
      command(0x0F);
      enable_in(6);
      command(0x1F);
      ASSERT_TRUE(cycle_until([&] { return bits() == (kReached | kAttained); }, 100_ms));
      EXPECT_NEAR(actual(), as_position != 0 ? 5000.0 : -5000.0, 20.0);
    }
  }
}

}  // namespace
}  // namespace stator::devices

// What older firmware of the module has not.

#include <cstring>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::devices {
namespace {

using tmcm_3315::FirmwareVersion;

constexpr std::uint32_t kNoSuchObject = 0x06020000;
constexpr std::uint32_t kInvalidValue = 0x06090030;

class Tmcm3315Versions : public Tmcm3315Module {
 protected:
  void power_up(FirmwareVersion firmware) {
    Tmcm3315Configuration configuration;
    configuration.firmware = firmware;
    renew(configuration);
    go_operational();
  }
};

TEST_F(Tmcm3315Versions, EachTellsItsVersion) {
  struct Case {
    FirmwareVersion firmware;
    std::uint32_t revision;
    const char* text;
  };
  for (const Case& c : {Case{FirmwareVersion::v1_07, 0x00010007, "1.07"},
                        Case{FirmwareVersion::v1_08, 0x00010008, "1.08"},
                        Case{FirmwareVersion::v1_09, 0x00010009, "1.09"}}) {
    power_up(c.firmware);
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x1018, 3), c.revision);
    const auto text = bus_->upload<std::uint32_t>(0x100A);
    EXPECT_EQ(std::memcmp(&text, c.text, sizeof(text)), 0) << c.text;
    EXPECT_EQ(device_->description().revision, c.revision) << "SII and ESI say the same";
  }
}

TEST_F(Tmcm3315Versions, VersionSevenHasNoLatchAndNoCyclicVelocity) {
  power_up(FirmwareVersion::v1_07);
  for (unsigned motor = 0; motor < 3; ++motor) {
    EXPECT_EQ(bus_->download<std::uint8_t>(of_motor(motor, 0x200F), 1, 1), kNoSuchObject);
    EXPECT_EQ(bus_->download<std::int8_t>(of_motor(motor, 0x6060), 0, 9), kInvalidValue);
    EXPECT_EQ(bus_->upload<std::uint32_t>(of_motor(motor, 0x6502)), 0x2A5U);
  }
  set_profile(0, 100'000, 1'000'000);
  enable(0, 8);
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 8) << "all other modes are there";
  write<std::int32_t>(0x607A, 100);
  bus_->pass(5_ms);
  EXPECT_EQ(bus_->upload<std::int32_t>(0x6062), 100);
}

TEST_F(Tmcm3315Versions, FromVersionEightOnBothAreThere) {
  for (const FirmwareVersion firmware : {FirmwareVersion::v1_08, FirmwareVersion::v1_09}) {
    power_up(firmware);
    write<std::uint8_t>(0x200F, 1, 1);
    enable(0, 9);
    EXPECT_EQ(bus_->upload<std::int8_t>(0x6061), 9);
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x6502), 0x3A5U);
  }
}

}  // namespace
}  // namespace stator::devices

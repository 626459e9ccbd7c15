// SDOs of the module to the byte, and which objects may be written when.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

using SdoBytes = std::array<unsigned, 8>;

class Tmcm3315Sdo : public Tmcm3315Module {
 protected:
  tests::TestBus::Bytes ask(const SdoBytes& bytes) {
    std::array<std::byte, 8> request{};
    std::ranges::transform(bytes, request.begin(),
                           [](unsigned byte) { return static_cast<std::byte>(byte); });
    return bus_->sdo(request);
  }
  static tests::TestBus::Bytes bytes(const SdoBytes& bytes) {
    tests::TestBus::Bytes result;
    for (const unsigned byte : bytes) {
      result.push_back(static_cast<std::byte>(byte));
    }
    return result;
  }
  /// A normal upload: the size, then the value behind the eight bytes.
  std::string upload_text(unsigned index) {
    const auto response = ask({0x40, index & 0xFFU, index >> 8U, 0, 0, 0, 0, 0});
    EXPECT_EQ(response.at(0), std::byte{0x41});
    const auto size = base::load_le<std::uint32_t>(response, 4);
    EXPECT_EQ(response.size(), 8 + size);
    std::string text(size, ' ');
    std::ranges::transform(response.begin() + 8, response.end(), text.begin(),
                           [](std::byte byte) { return static_cast<char>(byte); });
    return text;
  }
};

TEST_F(Tmcm3315Sdo, IdentityReadsAreAnsweredToTheByte) {
  struct Vector {
    SdoBytes request;
    SdoBytes response;
  };
  constexpr std::array<Vector, 14> kVectors{{
      {{0x40, 0x00, 0x10, 0, 0, 0, 0, 0}, {0x43, 0x00, 0x10, 0x00, 0x92, 0x01, 0xFC, 0xFF}},
      {{0x40, 0x01, 0x10, 0, 0, 0, 0, 0}, {0x4F, 0x01, 0x10, 0x00, 0x00, 0x00, 0x00, 0x00}},
      {{0x40, 0x18, 0x10, 0, 0, 0, 0, 0}, {0x4F, 0x18, 0x10, 0x00, 0x03, 0x00, 0x00, 0x00}},
      {{0x40, 0x18, 0x10, 1, 0, 0, 0, 0}, {0x43, 0x18, 0x10, 0x01, 0x86, 0x02, 0x00, 0x00}},
      {{0x40, 0x18, 0x10, 2, 0, 0, 0, 0}, {0x43, 0x18, 0x10, 0x02, 0xF3, 0x0C, 0x00, 0x00}},
      {{0x40, 0x00, 0x16, 0, 0, 0, 0, 0}, {0x4F, 0x00, 0x16, 0x00, 0x09, 0x00, 0x00, 0x00}},
      {{0x40, 0x00, 0x16, 1, 0, 0, 0, 0}, {0x43, 0x00, 0x16, 0x01, 0x10, 0x00, 0x40, 0x60}},
      {{0x40, 0x00, 0x1A, 2, 0, 0, 0, 0}, {0x43, 0x00, 0x1A, 0x02, 0x20, 0x00, 0x64, 0x60}},
      {{0x40, 0x12, 0x1C, 1, 0, 0, 0, 0}, {0x4B, 0x12, 0x1C, 0x01, 0x00, 0x16, 0x00, 0x00}},
      {{0x40, 0x00, 0x20, 0, 0, 0, 0, 0}, {0x4F, 0x00, 0x20, 0x00, 0x08, 0x00, 0x00, 0x00}},
      {{0x40, 0x03, 0x20, 0, 0, 0, 0, 0}, {0x4F, 0x03, 0x20, 0x00, 0x80, 0x00, 0x00, 0x00}},
      {{0x40, 0x85, 0x60, 0, 0, 0, 0, 0}, {0x43, 0x85, 0x60, 0x00, 0x00, 0xC8, 0x00, 0x00}},
      {{0x40, 0x67, 0x60, 0, 0, 0, 0, 0}, {0x43, 0x67, 0x60, 0x00, 0xFF, 0xFF, 0xFF, 0xFF}},
      {{0x40, 0x6A, 0x60, 0, 0, 0, 0, 0}, {0x4B, 0x6A, 0x60, 0x00, 0xFF, 0xFF, 0x00, 0x00}},
  }};
  bus_->bring_to(AlState::pre_operational);
  for (const Vector& vector : kVectors) {
    EXPECT_EQ(ask(vector.request), bytes(vector.response))
        << std::hex << vector.request[2] << vector.request[1];
  }
}

TEST_F(Tmcm3315Sdo, TextsComeByNormalTransferOrExpedited) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(upload_text(0x1008), "TMCM-3315");
  // "2.0" and "1.09": three and four bytes.
  EXPECT_EQ(ask({0x40, 0x09, 0x10, 0, 0, 0, 0, 0}),
            bytes({0x47, 0x09, 0x10, 0x00, 0x32, 0x2E, 0x30, 0x00}));
  EXPECT_EQ(ask({0x40, 0x0A, 0x10, 0, 0, 0, 0, 0}),
            bytes({0x43, 0x0A, 0x10, 0x00, 0x31, 0x2E, 0x30, 0x39}));
}

TEST_F(Tmcm3315Sdo, TheStepCounterComesAsEightBytes) {
  go_operational();
  set_profile(1, 51'200, 512'000);
  enable(1, 1);
  start_move(1, 12'345);
  bus_->pass(1_s);
  const auto response = ask({0x40, 0x0B, 0x23, 0x03, 0, 0, 0, 0});
  ASSERT_EQ(response.size(), 16U);
  EXPECT_EQ(response[0], std::byte{0x41}) << "normal transfer, size indicated";
  EXPECT_EQ(base::load_le<std::uint32_t>(response, 4), 8U);
  EXPECT_EQ(base::load_le<std::uint64_t>(response, 8), 12'345U);
  EXPECT_EQ(ask({0x23, 0x0B, 0x23, 0x03, 1, 0, 0, 0}),
            bytes({0x80, 0x0B, 0x23, 0x03, 0x02, 0x00, 0x01, 0x06}))
      << "read only";
}

TEST_F(Tmcm3315Sdo, BlockTransferIsRefusedInBothDirections) {
  bus_->bring_to(AlState::pre_operational);
  for (const unsigned command : {0xA0U, 0xA4U, 0xC0U, 0xC2U, 0xC6U, 0xE0U}) {
    EXPECT_EQ(ask({command, 0x08, 0x10, 0x00, 0x7F, 0, 0, 0}),
              bytes({0x80, 0x08, 0x10, 0x00, 0x01, 0x00, 0x04, 0x05}))
        << std::hex << command;
  }
}

TEST_F(Tmcm3315Sdo, RefusalsCarryTheirStandardCodes) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x6041, 0, 0), 0x06010002U) << "read only";
  EXPECT_EQ(bus_->download<std::int8_t>(0x6061, 0, 1), 0x06010002U);
  EXPECT_EQ(bus_->download<std::uint32_t>(0x60FD, 0, 1), 0x06010002U);
  EXPECT_EQ(bus_->download<std::uint32_t>(0x1000, 0, 1), 0x06010002U);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x2902, 0, 0), 0x06020000U) << "no such object";
  EXPECT_EQ(bus_->download<std::uint8_t>(0x7840, 0, 0), 0x06020000U) << "there is no axis 3";
  EXPECT_EQ(bus_->download<std::uint32_t>(0x1018, 4, 0), 0x06090011U) << "no serial number";
  EXPECT_EQ(bus_->download<std::uint8_t>(0x2000, 0, 9), 0x06090031U) << "too high";
  EXPECT_EQ(bus_->download<std::int8_t>(0x60C2, 2, -4), 0x06090032U) << "too low";
  EXPECT_EQ(bus_->download<std::int8_t>(0x6060, 0, 7), 0x06090030U) << "no legal mode";
  EXPECT_EQ(bus_->download<std::uint16_t>(0x605E, 0, 1), 0x06090030U) << "no legal option";
  EXPECT_EQ(bus_->download<std::uint16_t>(0x2000, 0, 8), 0x06070012U) << "too long";
  EXPECT_EQ(bus_->download<std::uint16_t>(0x607A, 0, 8), 0x06070013U) << "too short";
}

// Objects that depend on the axis' power state: 2005h, 200Bh, 200Ch, 208Ch.

class Tmcm3315WriteStates : public Tmcm3315Module {
 protected:
  struct Target {
    unsigned index;
    std::uint8_t subindex;
  };
  static constexpr std::array<Target, 7> kTargets{
      {{0x2005, 0}, {0x200B, 1}, {0x200B, 2}, {0x200B, 3}, {0x200C, 1}, {0x200C, 2}, {0x208C, 0}}};

  /// Writes the present value back.
  std::uint32_t rewrite(unsigned motor, const Target& target) {
    const std::uint16_t index = of_motor(motor, target.index);
    if (target.index == 0x2005) {
      return bus_->download(index, 0, bus_->upload<std::uint32_t>(index));
    }
    const auto value = bus_->upload<std::uint8_t>(index, target.subindex);
    return bus_->download(index, target.subindex, value);
  }
  void expect_all(unsigned motor, std::uint32_t answer, std::string_view state) {
    for (const Target& target : kTargets) {
      EXPECT_EQ(rewrite(motor, target), answer) << std::hex << of_motor(motor, target.index) << ':'
                                                << unsigned{target.subindex} << " in " << state;
    }
  }
};

TEST_F(Tmcm3315WriteStates, SwitchOnDisabledOfTheOwnAxisAloneAllowsThem) {
  go_operational();
  for (unsigned motor = 0; motor < 3; ++motor) {
    const unsigned other = (motor + 1) % 3;
    write<std::int16_t>(of_motor(motor, 0x605A), 6);
    expect_all(motor, 0, "Switch on disabled");
    control(motor, 6);
    expect_all(motor, kDeviceStateAbort, "Ready to switch on");
    expect_all(other, 0, "Switch on disabled of another axis");
    control(motor, 7);
    expect_all(motor, kDeviceStateAbort, "Switched on");
    control(motor, 15);
    expect_all(motor, kDeviceStateAbort, "Operation enabled");
    control(motor, 2);
    ASSERT_EQ(statusword(motor) & 0x006F, 0x0007);
    expect_all(motor, kDeviceStateAbort, "Quick stop active");
    control(motor, 0);
    expect_all(motor, 0, "Switch on disabled again");
  }
}

TEST_F(Tmcm3315WriteStates, FaultForbidsThemToo) {
  go_operational();
  use_encoder();
  enable(0, 3);
  write<std::uint32_t>(0x6065, 10);
  device_->axis(0).plant().set_external_torque(-0.3);
  bus_->pass(50_ms);
  ASSERT_EQ(statusword() & 0x004F, 0x0008);
  expect_all(0, kDeviceStateAbort, "Fault");
}

}  // namespace
}  // namespace stator::devices

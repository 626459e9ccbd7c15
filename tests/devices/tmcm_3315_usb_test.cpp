// The USB interface of the module: binary TMCL that reads and moves nothing.

#include <string>
#include <vector>

#include "devices/tmcm_3315_module.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::devices {
namespace {

using tmcl::Request;
using tmcl::Status;

class Tmcm3315Usb : public Tmcm3315Module {
 protected:
  Tmcm3315Usb() { EXPECT_TRUE(device_->connect_serial("usb", &cable_)); }
  void put(const tmcl::Telegram& telegram, std::size_t length = tmcl::kTelegramLength) {
    cable_.put(telegram, length);
  }
  tmcl::Telegram raw_answer() {
    bus_->pass(1_ms);
    return cable_.take_telegram();
  }
  tmcl::Reply answer(const Request& request) {
    put(encode(request));
    const tmcl::Telegram telegram = raw_answer();
    EXPECT_TRUE(tmcl::has_right_checksum(telegram));
    const tmcl::Reply reply = tmcl::decode_reply(telegram);
    EXPECT_EQ(reply.host_address, 2);
    EXPECT_EQ(reply.module_address, 1);
    EXPECT_EQ(reply.command, request.command);
    return reply;
  }
  std::int32_t axis_parameter(int type, int motor = 0) {
    const tmcl::Reply reply = answer({.command = 6,
                                      .type = static_cast<std::uint8_t>(type),
                                      .motor = static_cast<std::uint8_t>(motor)});
    EXPECT_EQ(reply.status, Status::success) << "axis parameter " << type;
    return reply.value;
  }
  Status status_of(const Request& request) { return answer(request).status; }

  tests::SerialLine cable_;
};

TEST_F(Tmcm3315Usb, ReadsPositionAndSpeedWhileTheBusMovesTheMotor) {
  go_operational();
  set_profile(1, 102'400, 1'024'000);
  enable(1, 1);
  start_move(1, -512'000);
  bus_->pass(1'000_ms);
  EXPECT_EQ(axis_parameter(0, 1), -512'000);
  EXPECT_NEAR(axis_parameter(1, 1), signal("axis1.position_actual"), 200.0);
  EXPECT_NEAR(axis_parameter(3, 1), -102'400, 2'000);
  EXPECT_EQ(axis_parameter(4, 1), 102'400);
  EXPECT_EQ(axis_parameter(5, 1), 1'024'000);
  EXPECT_EQ(axis_parameter(8, 1), 0) << "not there yet";
  EXPECT_EQ(axis_parameter(0, 0), 0) << "another motor";
  bus_->pass(6'000_ms);
  EXPECT_EQ(axis_parameter(8, 1), 1);
}

TEST_F(Tmcm3315Usb, EveryParameterShowsItsObjectOnEveryAxis) {
  bus_->bring_to(AlState::pre_operational);
  for (const product::ReadableParameter& parameter : tmcm_3315::readable_parameters()) {
    for (unsigned motor = 0; motor < 3; ++motor) {
      SCOPED_TRACE(std::string(parameter.name) + " of motor " + std::to_string(motor));
      const dictionary::Entry* entry =
          device_->dictionary().find(of_motor(motor, parameter.index), parameter.subindex);
      ASSERT_NE(entry, nullptr);
      EXPECT_EQ(entry->axis(), motor);
      const auto bits = static_cast<std::uint32_t>(entry->value() >> parameter.first_bit);
      const std::uint32_t mask = parameter.bits == 32 ? 0xFFFFFFFFU : (1U << parameter.bits) - 1U;
      EXPECT_EQ(
          static_cast<std::uint32_t>(axis_parameter(parameter.number, static_cast<int>(motor))),
          bits & mask);
    }
  }
}

TEST_F(Tmcm3315Usb, NegativeValuesOfShortObjectsKeepTheirSign) {
  bus_->bring_to(AlState::pre_operational);
  write<std::int8_t>(0x209E, -5);
  EXPECT_EQ(axis_parameter(174), -5);
}

TEST_F(Tmcm3315Usb, SwitchesAreReadByTheirBits) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint32_t>(0x2005, 0x2D);
  bus_->pass(2_ms);
  EXPECT_EQ(axis_parameter(9), 1);
  EXPECT_EQ(axis_parameter(10), 1);
  EXPECT_EQ(axis_parameter(11), 1);
  EXPECT_EQ(axis_parameter(13), 1) << "left switch disabled";
  EXPECT_EQ(axis_parameter(12), 0);
}

TEST_F(Tmcm3315Usb, ReadsInputsAndOutputs) {
  device_->set_digital_input(2, true);
  device_->set_analog_input(3, 54'321);
  go_operational();
  write<std::uint32_t>(0x2703, 1U << 17, 2);
  write<std::uint32_t>(0x2703, 1U << 17, 1);
  bus_->pass(2_ms);
  EXPECT_EQ(answer({.command = 15, .type = 2, .motor = 0}).value, 1);
  EXPECT_EQ(answer({.command = 15, .type = 1, .motor = 0}).value, 0);
  EXPECT_EQ(answer({.command = 15, .type = 3, .motor = 1}).value, 54'321);
  EXPECT_EQ(answer({.command = 15, .type = 1, .motor = 2}).value, 1);
  EXPECT_EQ(answer({.command = 15, .type = 0, .motor = 2}).value, 0);
  EXPECT_EQ(status_of({.command = 15, .type = 4, .motor = 0}), Status::wrong_type);
  EXPECT_EQ(status_of({.command = 15, .type = 0, .motor = 3}), Status::invalid_value);
}

TEST_F(Tmcm3315Usb, TellsItsVersionAsTextAndAsNumber) {
  put(tmcl::encode(Request{.command = 136, .type = 0}));
  const tmcl::Telegram text = raw_answer();
  std::string version;
  for (std::size_t i = 1; i < text.size(); ++i) {
    version += std::to_integer<char>(text[i]);
  }
  EXPECT_EQ(text[0], std::byte{2});
  EXPECT_EQ(version, "3315V109");
  EXPECT_EQ(answer({.command = 136, .type = 1}).value, 0x0CF3'0109);
  EXPECT_EQ(status_of({.command = 136, .type = 2}), Status::wrong_type);
}

TEST_F(Tmcm3315Usb, TellsTheVersionOfAnOlderFirmware) {
  Tmcm3315Configuration configuration;
  configuration.firmware = tmcm_3315::FirmwareVersion::v1_07;
  renew(configuration);
  EXPECT_TRUE(device_->connect_serial("usb", &cable_));
  put(tmcl::encode(Request{.command = 136, .type = 0}));
  EXPECT_EQ(raw_answer().back(), std::byte{'7'});
  EXPECT_EQ(answer({.command = 136, .type = 1}).value, 0x0CF3'0107);
}

TEST_F(Tmcm3315Usb, ReadsGlobalParameters) {
  EXPECT_EQ(answer({.command = 10, .type = 66}).value, 1);
  EXPECT_EQ(answer({.command = 10, .type = 76}).value, 2);
  const std::int32_t before = answer({.command = 10, .type = 132}).value;
  bus_->pass(50_ms);
  EXPECT_EQ(answer({.command = 10, .type = 132}).value, before + 51);
  EXPECT_EQ(status_of({.command = 10, .type = 0}), Status::wrong_type);
  EXPECT_EQ(status_of({.command = 10, .type = 66, .motor = 1}), Status::invalid_value);
}

TEST_F(Tmcm3315Usb, NothingMovesOrChangesThroughIt) {
  go_operational();
  set_profile(0, 51'200, 512'000);
  enable(0, 1);
  bus_->pass(10_ms);
  std::vector<std::uint64_t> values;
  for (const dictionary::Entry& entry : device_->dictionary().entries()) {
    values.push_back(entry.value());
  }
  for (const int command : {1,  2,  3,  4,  5,   7,   8,   9,   11,  12,  13,  14,
                            30, 31, 32, 39, 128, 129, 130, 131, 132, 133, 137, 255}) {
    SCOPED_TRACE(command);
    told_.all.clear();
    EXPECT_EQ(status_of({.command = static_cast<std::uint8_t>(command), .value = 12'800}),
              Status::command_not_available);
    ASSERT_EQ(told_.all.size(), 1U);
    EXPECT_NE(told_.all[0].find("moves or changes nothing"), std::string::npos);
  }
  bus_->pass(100_ms);
  EXPECT_NEAR(shaft_microsteps(), 0.0, 5.0);
  std::size_t i = 0;
  for (const dictionary::Entry& entry : device_->dictionary().entries()) {
    EXPECT_EQ(entry.value(), values[i++]) << entry.name();
  }
}

TEST_F(Tmcm3315Usb, UnknownCommandsTypesAndMotorsHaveTheirStatus) {
  EXPECT_EQ(status_of({.command = 77}), Status::invalid_command);
  EXPECT_EQ(status_of({.command = 0, .type = 0}), Status::invalid_command);
  EXPECT_EQ(status_of({.command = 6, .type = 250}), Status::wrong_type);
  EXPECT_EQ(status_of({.command = 6, .type = 1, .motor = 3}), Status::invalid_value);
}

TEST_F(Tmcm3315Usb, AnyAddressIsTaken) {
  EXPECT_EQ(status_of({.address = 77, .command = 6, .type = 1}), Status::success);
}

TEST_F(Tmcm3315Usb, AWrongChecksumIsAnsweredWithStatus1AndValue0) {
  tmcl::Telegram telegram = encode(Request{.command = 6, .type = 140});
  telegram.back() ^= std::byte{1};
  put(telegram);
  const tmcl::Reply reply = tmcl::decode_reply(raw_answer());
  EXPECT_EQ(reply.status, Status::wrong_checksum);
  EXPECT_EQ(reply.value, 0);
}

TEST_F(Tmcm3315Usb, APauseEndsABrokenTelegram) {
  put(tmcl::encode(Request{.command = 6, .type = 140}), 5);
  bus_->pass(200_ms);
  EXPECT_EQ(axis_parameter(140), 8);
}

TEST_F(Tmcm3315Usb, SeveralRequestsAreAnsweredInTheirOrder) {
  for (const int type : {140, 202, 6}) {
    put(tmcl::encode(Request{.command = 6, .type = static_cast<std::uint8_t>(type)}));
  }
  bus_->pass(1_ms);
  EXPECT_EQ(cable_.from_device.size(), 3 * tmcl::kTelegramLength);
}

TEST_F(Tmcm3315Usb, WithoutSupplyItIsSilent) {
  device_->set_power(false, bus_->now());
  put(tmcl::encode(Request{.command = 6, .type = 1}));
  bus_->pass(10_ms);
  EXPECT_TRUE(cable_.from_device.empty());
}

/// The update as the maker's programs do it.
class Tmcm3315UsbUpdate : public Tmcm3315Usb {
 protected:
  void start_boot_loader() {
    put(tmcl::encode(Request{.command = 242,
                             .type = 0x81,
                             .motor = 0x92,
                             .value = static_cast<std::int32_t>(0xA3B4C5D6)}));
    bus_->pass(2_ms);
    EXPECT_TRUE(cable_.from_device.empty()) << "this command is not answered";
  }
  void start_firmware() {
    put(tmcl::encode(Request{.command = 205}));
    bus_->pass(2_ms);
    EXPECT_TRUE(cable_.from_device.empty()) << "nor is this one";
  }
  std::string version() {
    put(tmcl::encode(Request{.command = 136}));
    const tmcl::Telegram text = raw_answer();
    std::string version;
    for (std::size_t i = 1; i < text.size(); ++i) {
      version += std::to_integer<char>(text[i]);
    }
    return version;
  }
  /// Three words on one page.
  void load(std::int32_t sum) {
    const std::int32_t start = answer({.command = 206, .type = 1}).value;
    EXPECT_EQ(status_of({.command = 200}), Status::success);
    for (std::uint8_t word = 0; word < 3; ++word) {
      EXPECT_EQ(status_of({.command = 201, .type = word, .value = 0x01020304}), Status::success);
    }
    EXPECT_EQ(status_of({.command = 202, .value = start}), Status::success);
    EXPECT_EQ(answer({.command = 203, .value = start + 11}).value, 30);
    EXPECT_EQ(status_of({.command = 208, .type = 0, .value = 12}), Status::success);
    EXPECT_EQ(status_of({.command = 208, .type = 1, .value = sum}), Status::success);
  }
};

TEST_F(Tmcm3315UsbUpdate, LoadsAnImageAndRestarts) {
  EXPECT_EQ(version(), "3315V109");
  start_boot_loader();
  EXPECT_EQ(version(), "3315B100");
  load(30);
  start_firmware();
  EXPECT_EQ(version(), "3315V109");
  ASSERT_EQ(device_->firmware()->image().size(), 12U);
  EXPECT_EQ(device_->firmware()->image()[0], std::byte{4});
  EXPECT_EQ(device_->firmware()->image()[11], std::byte{1});
  go_operational();
}

TEST_F(Tmcm3315UsbUpdate, ABrokenImageIsNotStartedAndTheOldOneStays) {
  start_boot_loader();
  load(31);
  start_firmware();
  EXPECT_EQ(version(), "3315B100");
  EXPECT_TRUE(device_->firmware()->image().empty());
  load(30);
  start_firmware();
  EXPECT_EQ(version(), "3315V109");
}

TEST_F(Tmcm3315UsbUpdate, WithoutErasingNothingChanges) {
  start_boot_loader();
  start_firmware();
  EXPECT_EQ(version(), "3315V109");
  EXPECT_TRUE(device_->firmware()->image().empty());
}

TEST_F(Tmcm3315UsbUpdate, DrivesAndNetworkAreAtRestMeanwhile) {
  go_operational();
  set_profile(0, 102'400, 1'024'000);
  enable(0, 1);
  start_move(0, 5'120'000);
  bus_->pass(500_ms);
  start_boot_loader();
  EXPECT_FALSE(device_->axis(0).axis().bridge_enabled());
  EXPECT_EQ(device_->stack().state(), AlState::init);
  bus_->pass(1'000_ms);
  EXPECT_NEAR(signal("axis0.shaft_speed"), 0.0, 0.01);
  EXPECT_EQ(bus_->request(AlState::pre_operational) & 0x0FU, 1U) << "nobody answers there";
  EXPECT_EQ(status_of({.command = 6, .type = 1}), Status::invalid_command);
}

TEST_F(Tmcm3315UsbUpdate, ThePowerEndsTheBootLoader) {
  start_boot_loader();
  device_->set_power(false, bus_->now());
  device_->set_power(true, bus_->now());
  EXPECT_EQ(version(), "3315V109");
}

TEST_F(Tmcm3315UsbUpdate, TheBootLoaderNeedsItsKey) {
  put(encode(Request{.command = 242, .type = 0x81, .motor = 0x92, .value = 1}));
  bus_->pass(1_ms);
  EXPECT_TRUE(cable_.from_device.empty()) << "hosts wait for no answer";
  EXPECT_EQ(version(), "3315V109");
}

}  // namespace
}  // namespace stator::devices

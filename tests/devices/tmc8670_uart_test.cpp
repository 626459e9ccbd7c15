// The two UARTs of the chip: register datagrams, and TMCL with the boot loader.

#include <array>
#include <string>
#include <vector>

#include "devices/tmc8670_chip.hpp"
#include "stator/control/foc/register_fields.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"
#include "tmcl/serial_line.hpp"

namespace stator::devices {
namespace {

using control::foc::field;
using Bytes = std::vector<std::uint8_t>;

/// Keeps what a UART sends and gives it what a test puts in.
class Wire final : public tmcl::SerialPort {
 public:
  std::size_t take(std::span<std::byte> buffer) override {
    const std::size_t length = std::min(buffer.size(), waiting_.size());
    std::copy_n(waiting_.begin(), length, buffer.begin());
    waiting_.erase(waiting_.begin(), waiting_.begin() + static_cast<std::ptrdiff_t>(length));
    return length;
  }
  void send(std::span<const std::byte> bytes, base::SimTime /*now*/) override {
    for (const std::byte byte : bytes) {
      sent.push_back(std::to_integer<std::uint8_t>(byte));
    }
  }
  void put(const Bytes& bytes) {
    for (const std::uint8_t byte : bytes) {
      waiting_.push_back(std::byte{byte});
    }
  }
  Bytes sent;

 private:
  std::vector<std::byte> waiting_;
};

class Tmc8670HardwareUart : public Tmc8670Chip {
 protected:
  Tmc8670HardwareUart() { EXPECT_TRUE(device_->connect_serial("hardware-uart", &wire_)); }
  ~Tmc8670HardwareUart() override { device_->connect_serial("hardware-uart", nullptr); }
  void put(const Bytes& bytes) {
    wire_.put(bytes);
    device_->handle_serial(bus_->now());
  }
  Bytes answer(const Bytes& bytes) {
    wire_.sent.clear();
    put(bytes);
    return wire_.sent;
  }
  Wire wire_;
};

TEST_F(Tmc8670HardwareUart, TellsTheTypeOfTheChip) {
  EXPECT_EQ(answer({0x81, 0, 0, 0, 0}), (Bytes{0x81, 0, 0, 0, 0}));
  EXPECT_EQ(answer({0x00, 0, 0, 0, 0}), (Bytes{0x00, 0x38, 0x36, 0x37, 0x30}));
}

TEST_F(Tmc8670HardwareUart, WritesAreEchoedAndReadBackMostSignificantByteFirst) {
  EXPECT_EQ(answer({0xD8, 0x12, 0x34, 0x56, 0x78}), (Bytes{0xD8, 0x12, 0x34, 0x56, 0x78}));
  EXPECT_EQ(device_->axis().stage().block().get(field("PID_VELOCITY_P")), 0x1234);
  EXPECT_EQ(answer({0x58, 0, 0, 0, 0}), (Bytes{0x58, 0x12, 0x34, 0x56, 0x78}));
}

TEST_F(Tmc8670HardwareUart, UnknownAddressesReadZeroAndReadOnlyOnesStay) {
  EXPECT_EQ(answer({0x7E, 0, 0, 0, 0}), (Bytes{0x7E, 0, 0, 0, 0}));
  EXPECT_EQ(answer({0xFE, 1, 2, 3, 4}), (Bytes{0xFE, 1, 2, 3, 4}));
  EXPECT_EQ(answer({0x80, 1, 2, 3, 4}), (Bytes{0x80, 1, 2, 3, 4}));
  EXPECT_EQ(answer({0x00, 0, 0, 0, 0}), (Bytes{0x00, 0x38, 0x36, 0x37, 0x30}));
}

TEST_F(Tmc8670HardwareUart, ThreeBytesAreDroppedAfterASilenceOfMoreThanASecond) {
  EXPECT_EQ(answer({0x81, 0, 0}), Bytes{});
  bus_->pass(1'100_ms);
  EXPECT_EQ(answer({0, 0, 0, 0, 0}), (Bytes{0x00, 0x38, 0x36, 0x37, 0x30}));
}

TEST_F(Tmc8670HardwareUart, APauseBelowASecondDividesNoDatagram) {
  EXPECT_EQ(answer({0, 0, 0, 0}), Bytes{});
  bus_->pass(900_ms);
  EXPECT_EQ(answer({0}), (Bytes{0x00, 0x38, 0x36, 0x37, 0x30}));
}

TEST_F(Tmc8670HardwareUart, ADatagramThatTakesLongerThanASecondIsGivenUp) {
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(answer({0}), Bytes{});
    bus_->pass(400_ms);
  }
  EXPECT_EQ(answer({0, 0}), Bytes{}) << "the fourth byte begins a new one";
  EXPECT_EQ(answer({0, 0, 0}), (Bytes{0x00, 0x38, 0x36, 0x37, 0x30}));
}

TEST_F(Tmc8670HardwareUart, SpeedChangesOnceTheReplyIsThrough) {
  EXPECT_EQ(device_->baud_rate("hardware-uart"), 9600U);
  EXPECT_EQ(answer({0xF9, 0x00, 0x92, 0x16, 0x00}), (Bytes{0xF9, 0x00, 0x92, 0x16, 0x00}));
  bus_->pass(5_ms);
  EXPECT_EQ(device_->baud_rate("hardware-uart"), 9600U) << "50 bits take 5.2 ms";
  bus_->pass(1_ms);
  EXPECT_EQ(device_->baud_rate("hardware-uart"), 921'600U);
  answer({0xF9, 0x00, 0x00, 0x12, 0x34});
  bus_->pass(1_ms);
  EXPECT_EQ(device_->baud_rate("hardware-uart"), 921'600U) << "1234 is no speed";
  answer({0xF9, 0x03, 0x00, 0x00, 0x00});
  bus_->pass(1_ms);
  EXPECT_EQ(device_->baud_rate("hardware-uart"), 3'000'000U);
  device_->set_power(false, bus_->now());
  device_->set_power(true, bus_->now());
  EXPECT_EQ(device_->baud_rate("hardware-uart"), 9600U);
}

TEST_F(Tmc8670HardwareUart, AccessWhileTheDriveRunsDisturbsNothing) {
  go_operational();
  enable(3);
  write<std::int32_t>(0x60FF, 1000);
  bus_->pass(300_ms);
  for (int i = 0; i < 200; ++i) {
    EXPECT_EQ(answer({0x6A, 0, 0, 0, 0}).size(), 5U);
    bus_->pass(1_ms);
  }
  EXPECT_NEAR(signal("axis0.shaft_speed") * 60.0, 1000.0, 15.0);
  EXPECT_EQ(answer({0xE6, 0, 0, 0, 0}).size(), 5U) << "a write in operation is not blocked";
}

TEST_F(Tmc8670HardwareUart, TurnsAMotorWithoutAMaster) {
  answer({0xE3, 0x80, 0, 0, 8});     // voltages from registers
  answer({0xA4, 0, 0, 0x0F, 0xA0});  // U_D 4000
  answer({0xD2, 0, 0, 0, 2});        // angle of the open-loop generator
  answer({0xA0, 0, 0, 0x07, 0xD0});  // 2000 rpm/s
  answer({0xA1, 0, 0, 0, 240});      // 240 rpm electrical, 60 of the shaft
  EXPECT_EQ(signal("axis0.enable_out"), 0.0);
  answer({0x9A, 0, 0, 1, 7});  // PWM
  bus_->pass(2_s);
  EXPECT_EQ(signal("axis0.enable_out"), 1.0);
  const double turned = signal("axis0.shaft_position");
  bus_->pass(5_s);
  EXPECT_NEAR(signal("axis0.shaft_position") - turned, 5.0, 0.05);
  go_operational();
  bus_->pass(1_ms);
  EXPECT_EQ(signal("axis0.enable_out"), 0.0) << "a master's drive decides";
}

TEST_F(Tmc8670HardwareUart, AnIdleLineStaysSilent) {
  device_->handle_serial(bus_->now());
  bus_->pass(3_s);
  EXPECT_TRUE(wire_.sent.empty());
}

TEST_F(Tmc8670HardwareUart, WithoutSupplyNothingIsAnswered) {
  device_->set_power(false, bus_->now());
  EXPECT_EQ(answer({0, 0, 0, 0, 0}), Bytes{});
}

TEST_F(Tmc8670HardwareUart, ArbitraryBytesNeverStopIt) {
  std::uint32_t random = 1;
  for (int i = 0; i < 20'000; ++i) {
    random = random * 1'664'525U + 1'013'904'223U;
    put({static_cast<std::uint8_t>(random >> 24)});
    if (i % 64 == 0) {
      bus_->pass(1_ms);
    }
  }
  EXPECT_EQ(wire_.sent.size() % 5, 0U);
  EXPECT_EQ(wire_.sent.size(), 20'000U);
  bus_->pass(1'100_ms);
  answer({0x81, 0, 0, 0, 0});
  EXPECT_EQ(answer({0, 0, 0, 0, 0}), (Bytes{0x00, 0x38, 0x36, 0x37, 0x30}));
}

class Tmc8670McuUart : public Tmc8670Chip {
 protected:
  Tmc8670McuUart() { EXPECT_TRUE(device_->connect_serial("mcu-uart", &cable_)); }
  ~Tmc8670McuUart() override { device_->connect_serial("mcu-uart", nullptr); }
  tmcl::Reply answer(const tmcl::Request& request) {
    cable_.put(encode(request), tmcl::kTelegramLength);
    bus_->pass(1_ms);
    const tmcl::Telegram telegram = cable_.take_telegram();
    EXPECT_TRUE(tmcl::has_right_checksum(telegram));
    return tmcl::decode_reply(telegram);
  }
  tests::SerialLine cable_;
};

TEST_F(Tmc8670McuUart, TellsTheVersionOfTheFirmware) {
  EXPECT_EQ(device_->baud_rate("mcu-uart"), 115'200U);
  EXPECT_EQ(answer({.command = 136, .type = 1}).value, 8670 << 16 | 0x0100);
  cable_.put(encode(tmcl::Request{.command = 136}), tmcl::kTelegramLength);
  bus_->pass(1_ms);
  const tmcl::Telegram text = cable_.take_telegram();
  std::string version;
  for (std::size_t i = 1; i < text.size(); ++i) {
    version += static_cast<char>(text[i]);
  }
  EXPECT_EQ(version, "8670V100");
}

TEST_F(Tmc8670McuUart, EveryParameterShowsItsObject) {
  go_operational();
  enable(3);
  write<std::int32_t>(0x60FF, 700);
  bus_->pass(300_ms);
  for (const product::ReadableParameter& parameter : tmc8670::readable_parameters()) {
    const tmcl::Reply reply = answer({.command = 6, .type = parameter.number});
    EXPECT_EQ(reply.status, tmcl::Status::success) << parameter.name;
  }
  EXPECT_EQ(answer({.command = 6, .type = 2}).value, 700);
  EXPECT_NEAR(answer({.command = 6, .type = 3}).value, 700, 15);
  EXPECT_EQ(answer({.command = 6, .type = 174}).value, 6400);
  EXPECT_EQ(answer({.command = 6, .type = 1, .motor = 1}).status, tmcl::Status::invalid_value);
  EXPECT_EQ(answer({.command = 6, .type = 254}).status, tmcl::Status::wrong_type);
}

TEST_F(Tmc8670McuUart, ReadsTheReferenceSwitches) {
  set_input("axis0.home_switch", 1.0);
  bus_->pass(1_ms);
  EXPECT_EQ(answer({.command = 15, .type = 2}).value, 1);
  EXPECT_EQ(answer({.command = 15, .type = 0}).value, 0);
  EXPECT_EQ(answer({.command = 15, .type = 3}).status, tmcl::Status::wrong_type);
  EXPECT_EQ(answer({.command = 15, .type = 0, .motor = 2}).status, tmcl::Status::invalid_value);
}

TEST_F(Tmc8670McuUart, MovesNothing) {
  EXPECT_EQ(answer({.command = 1, .value = 1000}).status, tmcl::Status::command_not_available);
  EXPECT_EQ(told_.count("MCU UART: ROR"), 1);
}

TEST_F(Tmc8670McuUart, LoadsFirmwareWithoutAMaster) {
  const auto tell = [this](const tmcl::Request& request) {
    cable_.put(encode(request), tmcl::kTelegramLength);
    bus_->pass(1_ms);
    EXPECT_TRUE(cable_.from_device.empty()) << "this command is not answered";
  };
  const auto boot = tmcl::Request{
      .command = 242, .type = 0x81, .motor = 0x92, .value = static_cast<std::int32_t>(0xA3B4C5D6)};
  constexpr std::int32_t kText = 0x302E3256;  // "V2.0"
  constexpr std::int32_t kSum = 0x30 + 0x2E + 0x32 + 0x56;
  go_operational();
  enable(3);
  tell(boot);
  EXPECT_EQ(signal("axis0.enable_out"), 0.0) << "the drive is at rest";
  const std::int32_t start = answer({.command = 206, .type = 1}).value;
  EXPECT_EQ(answer({.command = 200}).status, tmcl::Status::success);
  EXPECT_EQ(answer({.command = 201, .value = kText}).status, tmcl::Status::success);
  EXPECT_EQ(answer({.command = 202, .value = start}).status, tmcl::Status::success);
  EXPECT_EQ(answer({.command = 208, .type = 0, .value = 4}).status, tmcl::Status::success);
  EXPECT_EQ(answer({.command = 208, .type = 1, .value = kSum}).status, tmcl::Status::success);
  tell({.command = 205});
  EXPECT_EQ(device_->firmware()->image().size(), 4U);
  dictionary::Entry* version = device_->dictionary().find(0x100A, 0);
  EXPECT_TRUE(device_->dictionary().prepare_read(*version));
  EXPECT_EQ(version->text(), "V2.0");
  go_operational();
}

}  // namespace
}  // namespace stator::devices

// The interfaces of the TMCM-142: serial lines, CAN, the switches on its board; its time.

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/can/frame.hpp"
#include "stator/devices/tmcm_142/tmcm_142.hpp"
#include "tmcm_142_module.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::Reply;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

constexpr int kPositionReachedEvent = 138;

struct Tmcm142Interfaces : testing::Test {
  void connect(const std::string& interface) {
    ASSERT_TRUE(module.device->connect_serial(interface, &cable));
  }
  void send(const tmcl::Request& request) {
    cable.write(tmcl::encode(request));
    module.device->handle_serial(module.now);
  }
  /// The replies that came since the last call.
  std::vector<Reply> replies() {
    const std::vector<std::byte> bytes = cable.read();
    EXPECT_EQ(bytes.size() % tmcl::kTelegramLength, 0U);
    std::vector<Reply> all;
    for (std::size_t i = 0; i + tmcl::kTelegramLength <= bytes.size(); i += 9) {
      tmcl::Telegram telegram{};
      std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(i), telegram.size(),
                  telegram.begin());
      EXPECT_TRUE(tmcl::has_right_checksum(telegram));
      all.push_back(tmcl::decode_reply(telegram));
    }
    return all;
  }
  std::optional<can::Frame> exchange(std::uint32_t identifier,
                                     std::initializer_list<unsigned> data) {
    const can::Frame frame = can::data_frame(identifier, data);
    if (module.device->controller().filter().accepts(frame)) {
      module.device->controller().deliver(frame);
    }
    module.device->handle_bus_events(module.now);
    return sent();
  }
  std::optional<can::Frame> sent() {
    const can::Frame* pending = module.device->controller().pending();
    if (pending == nullptr) {
      return std::nullopt;
    }
    const can::Frame frame = *pending;
    module.device->controller().transmitted(frame);
    return frame;
  }

  Tmcm142Module module;
  SerialCable cable;
};

TEST_F(Tmcm142Interfaces, EverySerialInterfaceAnswersAtOnce) {
  for (const std::string_view interface : Tmcm142::kSerialInterfaces) {
    connect(std::string(interface));
    send({.command = 6, .type = 6});
    const std::vector<Reply> all = replies();
    ASSERT_EQ(all.size(), 1U) << interface;
    EXPECT_EQ(all[0], (Reply{.command = 6, .value = 8})) << interface;
    ASSERT_TRUE(module.device->connect_serial(interface, nullptr));
  }
  EXPECT_FALSE(module.device->connect_serial("midi", &cable));
}

// As PyTrinamic asks for the boot loader: without waiting for a reply (T-11).
TEST_F(Tmcm142Interfaces, TheBootCommandIsNotAnsweredOnAnyInterface) {
  for (const std::string_view interface : Tmcm142::kSerialInterfaces) {
    connect(std::string(interface));
    send({.command = 242,
          .type = 0x81,
          .motor = 0x92,
          .value = static_cast<std::int32_t>(0xA3B4C5D6)});
    send({.command = 205});
    EXPECT_TRUE(replies().empty()) << interface;
    send({.command = 6, .type = 6});
    const std::vector<Reply> all = replies();
    ASSERT_EQ(all.size(), 1U) << interface;
    EXPECT_EQ(all[0], (Reply{.command = 6, .value = 8})) << interface;
    ASSERT_TRUE(module.device->connect_serial(interface, nullptr));
  }
  EXPECT_FALSE(exchange(1, {242, 0x81, 0x92, 0xA3, 0xB4, 0xC5, 0xD6}));
  EXPECT_FALSE(exchange(1, {242, 0x81, 0x92, 0xA3, 0xB4, 0xC5, 0xD6, 0x5D}));
  EXPECT_EQ(exchange(1, {6, 6, 0, 0, 0, 0, 0}), can::data_frame(2, {1, 100, 6, 0, 0, 0, 8}));
  EXPECT_EQ(module.events.count("enter boot loader not obeyed and, as hosts expect, not answered"),
            6);
}

TEST_F(Tmcm142Interfaces, TheTelegramPauseEndsAtItsDeadline) {
  connect("rs485");
  ASSERT_EQ(module.sgp(75, 15), Status::success);
  EXPECT_EQ(module.device->next_deadline(), base::SimTime::never());
  send({.command = 6, .type = 6});
  EXPECT_TRUE(replies().empty());
  EXPECT_EQ(module.device->next_deadline(), module.now + 15_ms);
  module.run(14_ms);
  EXPECT_TRUE(replies().empty());
  module.run(1_ms);
  EXPECT_EQ(replies().size(), 1U);
}

TEST_F(Tmcm142Interfaces, TheReachedTargetIsToldWithinAControlPeriod) {
  connect("usb");
  send({.command = 4, .value = 2'000});
  send({.command = kPositionReachedEvent, .value = 1});
  EXPECT_EQ(replies().size(), 2U);
  for (int i = 0; i < 20'000 && module.gap(position_reached) == 0; ++i) {
    EXPECT_EQ(replies().size(), 0U);
    module.run(100_us);
  }
  const std::vector<Reply> all = replies();
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0].status, Status::target_reached);
}

// A program may reach a target between two control periods, by moving it to where the axis stands.
TEST(Tmcm142ReachedTarget, IsToldAtTheSameMomentHoweverOftenTheModuleIsLookedAt) {
  const auto instruction = [](Command command, int type, std::int32_t value) {
    return tmcl::Instruction{.command = static_cast<std::uint8_t>(command),
                             .type = static_cast<std::uint8_t>(type),
                             .motor = 0,
                             .value = value};
  };
  const auto told_after = [&](base::SimDuration look) {
    Tmcm142Configuration configuration;
    configuration.program = {
        instruction(Command::set_axis_parameter, static_cast<int>(max_positioning_speed), 0),
        instruction(Command::set_axis_parameter, static_cast<int>(target_position), 1'000),
        instruction(Command::wait, 0, 5),
        instruction(Command::set_axis_parameter, static_cast<int>(target_position), 0),
        instruction(Command::stop, 0, 0)};
    Tmcm142Module module(configuration);
    SerialCable cable;
    EXPECT_TRUE(module.device->connect_serial("usb", &cable));
    EXPECT_EQ(module.execute(Command::run_application, 1, 0).status, Status::success);
    module.run(10_ms);
    cable.write(tmcl::encode(tmcl::Request{.command = kPositionReachedEvent, .value = 1}));
    module.device->handle_serial(module.now);
    EXPECT_EQ(cable.read().size(), tmcl::kTelegramLength) << "told before the target is there";
    while (module.now < base::SimTime() + 1_s) {
      module.run(look);
      if (!cable.read().empty()) {
        break;
      }
    }
    return module.now;
  };
  const base::SimTime moment = told_after(Tmcm142::kControlPeriod);
  EXPECT_LT(moment, base::SimTime() + 100_ms);
  EXPECT_EQ(told_after(7_us).nanoseconds() / Tmcm142::kControlPeriod.nanoseconds(),
            moment.nanoseconds() / Tmcm142::kControlPeriod.nanoseconds());
  EXPECT_LT(told_after(7_us) - moment, 7_us);
}

TEST_F(Tmcm142Interfaces, CanTelegramsAreAnsweredUnderTheirIdentifier) {
  const auto reply = exchange(1, {6, 6, 0, 0, 0, 0, 0});
  ASSERT_TRUE(reply);
  EXPECT_EQ(reply->identifier, 2U);
  EXPECT_EQ(*reply, can::data_frame(2, {1, 100, 6, 0, 0, 0, 8}));
  EXPECT_FALSE(exchange(3, {6, 6, 0, 0, 0, 0, 0})) << "for another module";
  ASSERT_EQ(module.sgp(83, 3), Status::success);
  module.run(1_ms);
  EXPECT_TRUE(exchange(3, {6, 6, 0, 0, 0, 0, 0}));
  EXPECT_FALSE(exchange(1, {6, 6, 0}));
}

TEST_F(Tmcm142Interfaces, RemoteAndExtendedFramesAreNoTelegrams) {
  can::Frame frame = can::data_frame(1, {6, 6, 0, 0, 0, 0, 0});
  frame.extended = true;
  module.device->controller().deliver(frame);
  module.device->controller().deliver(can::remote_frame(1, 7));
  module.device->handle_bus_events(module.now);
  EXPECT_FALSE(sent());
}

TEST_F(Tmcm142Interfaces, TheReachedTargetIsToldOnCan) {
  ASSERT_TRUE(exchange(1, {4, 0, 0, 0, 0, 7, 0xD0, 0}));
  ASSERT_TRUE(exchange(1, {kPositionReachedEvent, 0, 0, 0, 0, 0, 1, 0}));
  EXPECT_FALSE(sent());
  EXPECT_EQ(module.device->next_deadline(), base::SimTime() + Tmcm142::kControlPeriod);
  ASSERT_TRUE(module.run_to_target(5_s));
  const auto event = sent();
  ASSERT_TRUE(event);
  EXPECT_EQ(event->data[1], std::byte{128});
}

TEST_F(Tmcm142Interfaces, RatesChangeWithTheNextStart) {
  EXPECT_EQ(module.device->bit_rate(), 1'000'000U);
  EXPECT_EQ(module.device->baud_rate("rs232"), 9'600U);
  EXPECT_FALSE(module.device->baud_rate("usb"));
  constexpr std::array<std::uint32_t, 8> kBitRates{10, 20, 50, 100, 125, 250, 500, 1000};
  for (std::size_t i = 0; i < kBitRates.size(); ++i) {
    const std::uint32_t before = module.device->bit_rate();
    ASSERT_EQ(module.sgp(69, static_cast<int>(i) + 1), Status::success);
    EXPECT_EQ(module.device->bit_rate(), before);
    module.power_cycle();
    EXPECT_EQ(module.device->bit_rate(), kBitRates[i] * 1'000);
  }
  constexpr std::array<std::uint32_t, 12> kBaudRates{
      9600, 14400, 19200, 28800, 38400, 57600, 76800, 115200, 230400, 250000, 500000, 1000000};
  for (std::size_t i = 0; i < kBaudRates.size(); ++i) {
    ASSERT_EQ(module.sgp(65, static_cast<int>(i)), Status::success);
    module.power_cycle();
    EXPECT_EQ(module.device->baud_rate("rs485"), kBaudRates[i]);
  }
  EXPECT_EQ(module.sgp(69, 0), Status::invalid_value);
  EXPECT_EQ(module.sgp(69, 9), Status::invalid_value);
  EXPECT_EQ(module.sgp(65, 12), Status::invalid_value);
}

TEST_F(Tmcm142Interfaces, AddressesChangeWithTheNextTelegram) {
  connect("rs232");
  send({.command = 9, .type = 66, .value = 5});
  const std::vector<Reply> first = replies();
  ASSERT_EQ(first.size(), 1U);
  EXPECT_EQ(first[0].module_address, 1);
  send({.command = 6, .type = 6});
  EXPECT_TRUE(replies().empty());
  send({.address = 5, .command = 6, .type = 6});
  const std::vector<Reply> second = replies();
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].module_address, 5);
}

TEST_F(Tmcm142Interfaces, WithoutSupplyNothingIsHeard) {
  connect("rs232");
  module.device->set_power(false, module.now);
  EXPECT_EQ(module.device->next_deadline(), base::SimTime::never());
  send({.command = 6, .type = 6});
  EXPECT_FALSE(exchange(1, {6, 6, 0, 0, 0, 0, 0}));
  EXPECT_EQ(module.signal("power_led"), 0.0);
  module.run(10_ms);
  module.device->set_power(true, module.now);
  module.run(10_ms);
  EXPECT_TRUE(replies().empty()) << "what came meanwhile is lost";
  send({.command = 6, .type = 6});
  EXPECT_EQ(replies().size(), 1U);
  EXPECT_EQ(module.signal("power_led"), 1.0);
}

TEST_F(Tmcm142Interfaces, TextIsSpokenFromTheStartIfToldSo) {
  connect("rs232");
  ASSERT_EQ(module.sgp(67, 0x21), Status::success);  // no echo
  module.power_cycle();
  const std::string line = "AGAP 6, 0\r";
  cable.write(std::as_bytes(std::span(line)));
  module.device->handle_serial(module.now);
  std::string answer;
  for (const std::byte byte : cable.read()) {
    answer += static_cast<char>(byte);
  }
  EXPECT_EQ(answer, "BA 100 8\r");
}

TEST(Tmcm142DipSwitches, AddToTheAddressesOfRs422AndCan) {
  Tmcm142Configuration configuration;
  configuration.dip_switches.address = 4;
  Tmcm142Module module(configuration);
  SerialCable rs422;
  SerialCable rs485;
  ASSERT_TRUE(module.device->connect_serial("rs422", &rs422));
  ASSERT_TRUE(module.device->connect_serial("rs485", &rs485));
  for (SerialCable* cable : {&rs422, &rs485}) {
    cable->write(tmcl::encode(tmcl::Request{.address = 1, .command = 6, .type = 6}));
    module.device->handle_serial(module.now);
    EXPECT_EQ(cable->read().empty(), cable == &rs422);
    cable->write(tmcl::encode(tmcl::Request{.address = 5, .command = 6, .type = 6}));
    module.device->handle_serial(module.now);
    EXPECT_EQ(cable->read().empty(), cable == &rs485);
  }
  EXPECT_TRUE(module.device->controller().filter().accepts(can::data_frame(5, {0})));
  EXPECT_FALSE(module.device->controller().filter().accepts(can::data_frame(1, {0})));
}

TEST(Tmcm142DipSwitches, SelectOneInterface) {
  Tmcm142Configuration configuration;
  configuration.dip_switches.interface = "rs485";
  Tmcm142Module module(configuration);
  SerialCable cable;
  for (const std::string_view interface : Tmcm142::kSerialInterfaces) {
    ASSERT_TRUE(module.device->connect_serial(interface, &cable));
    cable.write(tmcl::encode(tmcl::Request{.command = 6, .type = 6}));
    module.device->handle_serial(module.now);
    EXPECT_EQ(cable.read().empty(), interface != "rs485") << interface;
    ASSERT_TRUE(module.device->connect_serial(interface, nullptr));
    std::array<std::byte, 16> rest{};
    while (cable.take(rest) != 0) {
    }
  }
  module.device->controller().deliver(can::data_frame(1, {6, 6, 0, 0, 0, 0, 0}));
  module.device->handle_bus_events(module.now);
  EXPECT_EQ(module.device->controller().pending(), nullptr);
}

TEST(Tmcm142ConfigurationValues, OutOfRangeAreRefused) {
  const auto refused = [](auto change) {
    Tmcm142Configuration configuration;
    change(configuration);
    EXPECT_THROW(Tmcm142 device(configuration), std::invalid_argument);
  };
  refused([](Tmcm142Configuration& c) { c.tmcl.can = 0x800; });
  refused([](Tmcm142Configuration& c) { c.can_bit_rate = 0; });
  refused([](Tmcm142Configuration& c) { c.baud_rate = 12; });
  refused([](Tmcm142Configuration& c) { c.dip_switches.address = 16; });
  refused([](Tmcm142Configuration& c) { c.dip_switches.interface = "ethernet"; });
  refused([](Tmcm142Configuration& c) { c.instruction_time = base::SimDuration(); });
  refused([](Tmcm142Configuration& c) { c.program.resize(2'049); });
}

// One instruction per 100 us (A85), whatever the steps in which time comes.
TEST(Tmcm142Time, ProgramsRunAtTheirRate) {
  const std::vector<tmcl::Instruction> program{{.command = 19, .type = 0, .value = 1},
                                               {.command = 22}};  // CALC ADD 1; JA 0
  for (const auto step : {100_us, 1_ms, 37_us, 1_s}) {
    Tmcm142Module module;
    module.device->tmcl().load_program(program);
    module.device->tmcl().start_program(module.now);
    while (module.now < base::SimTime() + 1_s) {
      module.run(step);
    }
    module.device->advance(module.now);
    const auto count = module.now.nanoseconds() / 200'000;
    EXPECT_NEAR(module.signal("accumulator"), static_cast<double>(count), 1.0)
        << step.nanoseconds();
  }
}

// The device's bits do not depend on how it is brought through time.
TEST(Tmcm142Time, SameInputsGiveTheSameBitsWhateverTheSteps) {
  std::vector<std::vector<double>> runs;
  for (const auto step : {100_us, 1_ms, 30_us, 10_ms}) {
    Tmcm142Module module;
    EXPECT_EQ(module.execute(Command::move_to_position, 0, 0, 300'000).status, Status::success);
    while (module.now < base::SimTime() + 3_s) {
      module.run(step);
    }
    std::vector<double>& values = runs.emplace_back();
    for (const product::Signal& signal : module.device->signals()) {
      values.push_back(signal.read());
    }
  }
  for (const std::vector<double>& run : runs) {
    EXPECT_EQ(run, runs[0]);
  }
}

}  // namespace
}  // namespace stator::tests

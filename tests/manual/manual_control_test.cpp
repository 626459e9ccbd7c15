// Axes moved by hand in a running rack over EtherCAT, CANopen and TMCL, and who makes way for whom.
#include "stator/manual/manual_control.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "base/temporary_directory.hpp"
#include "base/wait_for.hpp"
#include "rack/text_log.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/bench/link_port.hpp"
#include "stator/devices/catalogue/products.hpp"
#include "stator/ethercat/segment/segment.hpp"
#include "stator/ethercat/standard/register_addresses.hpp"
#include "stator/link/ethernet/udp_ethernet_link.hpp"
#include "stator/link/system/file_descriptor.hpp"
#include "stator/master/master.hpp"
#include "stator/rack/core/rack.hpp"
#include "stator/rack/file/rack_file.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"

namespace stator::manual {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using tests::wait_for;

/// A broadcast write of AL control, which requests Safe-Operational from all slaves.
constexpr std::array<std::uint8_t, 30> kSafeOperationalForAll{
    0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x02, 0x00, 0x00, 0x00, 0x00, 0x01, 0x88, 0xA4, 0x0E,
    0x10, 0x08, 0x00, 0x00, 0x00, 0x20, 0x01, 0x02, 0x00, 0x00, 0x00, 0x04, 0x00, 0x00, 0x00};

std::uint16_t free_udp_port() {
  const auto probe = link::UdpEthernetLink::listen({.address = "127.0.0.1", .port = 0});
  return probe ? (*probe)->local_port() : std::uint16_t{0};
}

/// A rack with a stepper module "gantry" and an I/O chip on EtherCAT, a drive "spindle" and a
/// module "winder" on a CAN bus, a module "feeder" on a serial line, and "lift" on a paced one.
class ManualControlTest : public ::testing::Test {
 protected:
  ManualControlTest() { runner_.start(); }
  ~ManualControlTest() override {
    control_.stop();
    runner_.stop();
  }

  [[nodiscard]] std::string rack_text(const std::string& clock) const {
    return "clock = \"" + clock +
           "\"\n[[segment]]\nlink = \"udp:127.0.0.1:" + std::to_string(port_) +
           "\"\n[[segment.device]]\ntype = \"tmcm-3315\"\nname = \"gantry\"\n"
           "[[segment.device]]\ntype = \"tmc8461\"\nname = \"io\"\n"
           "[[bus]]\nbit_rate = 1000\nports = [\"slcan:" +
           can_path() +
           "\"]\n[[bus.device]]\ntype = \"tmcc160\"\nname = \"spindle\"\nnode_id = 5\n"
           "[[bus.device]]\ntype = \"tmcm-142\"\nname = \"winder\"\n"
           "[[device]]\ntype = \"tmcm-142\"\nname = \"feeder\"\nusb = \"pty:" +
           serial_path() + "\"\nprogram = \"" + program_path() +
           "\"\n"
           "[[device]]\ntype = \"tmcm-142\"\nname = \"lift\"\nrs485 = \"pty:" +
           paced_path() + "\"\n[[line]]\nlink = \"pty:" + paced_path() + "\"\npacing = true\n";
  }
  [[nodiscard]] std::string can_path() const { return directory_.path() + "/can"; }
  [[nodiscard]] std::string serial_path() const { return directory_.path() + "/usb"; }
  [[nodiscard]] std::string paced_path() const { return directory_.path() + "/rs485"; }
  /// Of the feeder; nothing starts it unless a test does.
  [[nodiscard]] std::string program_path() const { return directory_.path() + "/to_and_fro.tmc"; }
  [[nodiscard]] rack::RackConfiguration read(const std::string& clock) const {
    std::ofstream(program_path()) << "Loop: MVP ABS, 0, 30000\nWAIT POS, 0, 0\nMVP ABS, 0, 0\n"
                                     "WAIT POS, 0, 0\nJA Loop\n";
    return rack::parse_rack_file(rack_text(clock), "rack.toml", devices::products());
  }
  [[nodiscard]] rack::DeviceAddress address(const std::string& name) const {
    for (const rack::DeviceAddress each : rack_.addresses()) {
      if (rack_.name_of(each) == name) {
        return each;
      }
    }
    ADD_FAILURE() << "no device " << name;
    return {};
  }

  [[nodiscard]] Phase phase(rack::DeviceAddress device) const {
    return control_.status(device).phase;
  }
  [[nodiscard]] AxisRecord axis(rack::DeviceAddress device, std::size_t number = 0) const {
    const DeviceStatus status = control_.status(device);
    return number < status.axes.size() ? status.axes[number] : AxisRecord{};
  }
  void begin(rack::DeviceAddress device) {
    const auto started = control_.start(device);
    ASSERT_TRUE(started) << started.error();
    ASSERT_TRUE(
        wait_for([&] { return phase(device) == Phase::active || phase(device) == Phase::ended; }));
    ASSERT_EQ(phase(device), Phase::active) << control_.status(device).text;
  }
  void command(rack::DeviceAddress device, const Command& command, std::size_t number = 0) {
    const auto taken = control_.command(device, number, command);
    ASSERT_TRUE(taken) << taken.error();
  }
  void enable(rack::DeviceAddress device) {
    command(device, {.kind = CommandKind::enable});
    ASSERT_TRUE(wait_for([&] { return axis(device).status.enabled; })) << axis(device).refusal;
  }
  /// Passes a frame through the first segment past its link.
  void send_to_segment(std::span<const std::uint8_t> frame) {
    std::array<std::byte, 60> passing{};
    std::ranges::copy(std::as_bytes(frame), passing.begin());
    rack::RunningRack& running = runner_.running();
    const std::scoped_lock lock(running.mutex);
    const base::SimTime now = running.now();
    ASSERT_TRUE(rack_.process_frame(0, passing, now));
    rack_.handle_bus_events(0, now);
    running.catch_up();
  }
  /// The watchdogs of process data (0420h) of the two devices of the segment.
  [[nodiscard]] std::array<std::uint16_t, 2> watchdogs() {
    const std::scoped_lock lock(runner_.running().mutex);
    std::array<std::uint16_t, 2> times{};
    for (std::size_t i = 0; i < times.size(); ++i) {
      std::array<std::byte, 2> bytes{};
      rack_.segment(0).slave(i).peek(ethercat::register_address::kProcessDataWatchdogTime, bytes);
      times[i] = base::load_le<std::uint16_t>(bytes.data());
    }
    return times;
  }
  /// Sets them, as a master that was there before would.
  void set_watchdogs(std::array<std::uint16_t, 2> times) {
    for (std::size_t i = 0; i < times.size(); ++i) {
      std::array<std::byte, 2> time{};
      base::store_le(time.data(), times[i]);
      std::array<std::byte, ethercat::kMinimumFrameLength> buffer{};
      ethercat::FrameBuilder frame(buffer, {0x02, 0, 0, 0, 0, 1});
      frame.append(ethercat::Command::apwr, 0,
                   ethercat::physical_address(
                       ethercat::auto_increment_address(static_cast<std::uint16_t>(i)),
                       ethercat::register_address::kProcessDataWatchdogTime),
                   time);
      const std::scoped_lock lock(runner_.running().mutex);
      ASSERT_TRUE(rack_.process_frame(0, frame.finish(), runner_.running().now()));
    }
    ASSERT_EQ(watchdogs(), times);
  }
  /// What the module at the end of a serial line answers first to a program that asks it there.
  static tmcl::Reply ask_module(const std::string& line, const tmcl::Request& request) {
    const link::FileDescriptor program(::open(line.c_str(), O_RDWR | O_NOCTTY));
    const tmcl::Telegram question = tmcl::encode(request);
    EXPECT_EQ(::write(program.get(), question.data(), question.size()),
              static_cast<ssize_t>(question.size()));
    tmcl::Telegram reply{};
    for (std::size_t length = 0; length < reply.size();) {
      const ssize_t count = ::read(program.get(), reply.data() + length, reply.size() - length);
      if (count <= 0) {
        ADD_FAILURE() << "no reply at " << line;
        break;
      }
      length += static_cast<std::size_t>(count);
    }
    EXPECT_TRUE(tmcl::has_right_checksum(reply));
    return tmcl::decode_reply(reply);
  }
  /// A command to the module on CAN, as LAWICEL's protocol has it.
  static std::string line_of(const tmcl::Request& request) {
    const tmcl::Telegram telegram = tmcl::encode(request);
    std::string line = "t0017";
    for (std::size_t i = 1; i < 8; ++i) {
      line += fmt::format("{:02X}", static_cast<unsigned>(telegram.at(i)));
    }
    return line + '\r';
  }
  /// Reads lines of LAWICEL's protocol until a module has sent a reply, which it returns.
  static tmcl::Reply next_reply(const link::FileDescriptor& program) {
    std::string line;
    for (char next = 0; ::read(program.get(), &next, 1) == 1;) {
      if (next != '\r') {
        line += next;
      } else if (line.starts_with("t0027")) {
        tmcl::Telegram telegram{};
        for (std::size_t i = 1; i < 8; ++i) {
          telegram.at(i) =
              static_cast<std::byte>(std::stoul(line.substr(3 + 2 * i, 2), nullptr, 16));
        }
        return tmcl::decode_reply(telegram);
      } else {
        line.clear();
      }
    }
    ADD_FAILURE() << "no reply over CAN";
    return {};
  }
  /// Has `module` move far away at a fifth of its own speed, which it returns.
  double move_slowly(rack::DeviceAddress module) {
    const double own = axis(module).description.velocity;
    command(module, {.kind = CommandKind::move,
                     .value = 1'000'000'000,
                     .velocity = static_cast<std::uint32_t>(own / 5.0)});
    EXPECT_TRUE(wait_for([&] { return axis(module).status.velocity > 0.0; }))
        << axis(module).refusal;
    return own;
  }
  /// Moves by `distance` and waits until the device says that it is there.
  void move_by(rack::DeviceAddress device, std::int64_t distance) {
    const double start = axis(device).status.position;
    command(device, {.kind = CommandKind::move, .value = distance, .relative = true});
    EXPECT_TRUE(wait_for([&] {
      const AxisStatus now = axis(device).status;
      return now.reached && std::abs(now.position - start - static_cast<double>(distance)) <
                                std::abs(static_cast<double>(distance)) * 0.05;
    })) << axis(device).refusal
        << " at " << axis(device).status.position << " after " << start;
  }

  void set_homing_method(rack::DeviceAddress device, unsigned number, std::uint8_t method) {
    rack::RunningRack& running = runner_.running();
    const std::scoped_lock lock(running.mutex);
    running.catch_up();
    const auto index = static_cast<std::uint16_t>(0x6098 + number * 0x800);
    const rack::View& view = rack_;
    const dictionary::Entry* entry = view.device(device).object_dictionary()->find(index, 0);
    ASSERT_NE(entry, nullptr);
    const std::array value{static_cast<std::byte>(method)};
    ASSERT_TRUE(rack_.write_object(device, *entry, value, running.reached));
  }

  tests::TemporaryDirectory directory_;
  std::uint16_t port_ = free_udp_port();
  rack::RackConfiguration configuration_ = read("real");
  rack::EventLog log_;
  rack::Rack rack_{configuration_, log_};
  rack::Runner runner_{rack_, configuration_, tests::no_log()};
  ManualControl control_{runner_, configuration_, log_};
};

TEST_F(ManualControlTest, MovesAnAxisOnEtherCat) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  EXPECT_EQ(control_.status(gantry).axes.size(), 3U);
  enable(gantry);
  move_by(gantry, 51'200);
  EXPECT_EQ(log_.count("manual-control-begins"), 1U);
}

TEST_F(ManualControlTest, MovesADriveOnCan) {
  const rack::DeviceAddress spindle = address("spindle");
  begin(spindle);
  enable(spindle);
  move_by(spindle, 48);  // two revolutions in steps of its hall sensors
}

TEST_F(ManualControlTest, MovesAModuleOnASerialLine) {
  const rack::DeviceAddress feeder = address("feeder");
  begin(feeder);
  EXPECT_GT(axis(feeder).description.velocity, 0.0);
  move_by(feeder, 10'000);
}

TEST_F(ManualControlTest, MovesAModuleOnCan) {
  const rack::DeviceAddress winder = address("winder");
  begin(winder);
  move_by(winder, -10'000);
}

TEST_F(ManualControlTest, JogsForAsLongAsItIsToldTo) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  enable(gantry);
  command(gantry, {.kind = CommandKind::jog, .value = -51'200});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.velocity < -1'000.0; }))
      << axis(gantry).refusal;
  // Nobody repeats it.
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.velocity == 0.0; }));
  EXPECT_TRUE(axis(gantry).status.enabled);
}

TEST_F(ManualControlTest, StopsQuicklyAndChangesModeAndControlword) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  enable(gantry);
  command(gantry, {.kind = CommandKind::quick_stop});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).executed == 2; }));
  EXPECT_FALSE(axis(gantry).status.enabled);
  enable(gantry);
  command(gantry, {.kind = CommandKind::mode, .value = 9});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.mode == 9; })) << axis(gantry).refusal;
  command(gantry, {.kind = CommandKind::controlword, .value = 0x0007});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.state == "Switched on"; }))
      << axis(gantry).status.state;
  EXPECT_EQ(axis(gantry).status.controlword, 0x0007);
  command(gantry, {.kind = CommandKind::disable});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.state == "Switch on disabled"; }));
}

TEST_F(ManualControlTest, BringsADriveBackThatLeftOperational) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  enable(gantry);
  send_to_segment(kSafeOperationalForAll);
  ASSERT_TRUE(wait_for([&] { return !axis(gantry).status.enabled; }));
  EXPECT_EQ(phase(gantry), Phase::active);
  command(gantry, {.kind = CommandKind::enable});
  ASSERT_TRUE(wait_for([&] { return axis(gantry).executed == 2; }));
  EXPECT_THAT(axis(gantry).refusal, IsEmpty());
  move_by(gantry, 51'200);
}

TEST_F(ManualControlTest, StopsAMoveOnItsWay) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  enable(gantry);
  command(gantry, {.kind = CommandKind::move, .value = 2'000'000'000, .velocity = 100'000U});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.velocity > 1'000.0; }))
      << axis(gantry).refusal;
  command(gantry, {.kind = CommandKind::stop});
  EXPECT_TRUE(wait_for([&] { return axis(gantry).status.velocity == 0.0; }));
  EXPECT_TRUE(axis(gantry).status.enabled);
}

TEST_F(ManualControlTest, SearchesAndStopsAModule) {
  const rack::DeviceAddress feeder = address("feeder");
  begin(feeder);
  command(feeder, {.kind = CommandKind::home});
  EXPECT_TRUE(wait_for([&] { return axis(feeder).status.state == "reference search"; }))
      << axis(feeder).refusal;
  command(feeder, {.kind = CommandKind::stop});
  EXPECT_TRUE(wait_for([&] { return axis(feeder).status.state == "at rest"; }));
}

TEST_F(ManualControlTest, HomesADriveThatHasAMethodButNoSpeeds) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  command(gantry, {.kind = CommandKind::enable}, 1);
  ASSERT_TRUE(wait_for([&] { return axis(gantry, 1).status.enabled; })) << axis(gantry, 1).refusal;
  set_homing_method(gantry, 1, 17);  // to the left switch, which is not there
  command(gantry, {.kind = CommandKind::home}, 1);
  EXPECT_TRUE(wait_for([&] { return axis(gantry, 1).status.velocity < -50'000.0; }))
      << axis(gantry, 1).refusal;
}

TEST_F(ManualControlTest, SaysThatHomingNeedsAMethod) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  enable(gantry);
  command(gantry, {.kind = CommandKind::home});
  EXPECT_TRUE(wait_for([&] { return !axis(gantry).refusal.empty(); }));
  EXPECT_THAT(axis(gantry).refusal, HasSubstr("homing method (6098h) is 0"));
}

TEST_F(ManualControlTest, LeavesAnAxisWithoutCurrentWhenItIsGivenBack) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  enable(gantry);
  control_.release(gantry);
  EXPECT_TRUE(wait_for([&] { return phase(gantry) == Phase::off; }));
  EXPECT_EQ(log_.count("manual-control-ends"), 1U);
  begin(gantry);
  EXPECT_FALSE(axis(gantry).status.enabled);
}

TEST_F(ManualControlTest, LetsAProgramGoOnThatWaitedForTheEndOfItsMove) {
  const auto signals = rack_.signals();
  const auto signal =
      std::ranges::find(signals, "feeder.axis0.position_actual", &product::Signal::name);
  ASSERT_NE(signal, signals.end());
  const auto position = [&] {
    const std::scoped_lock lock(runner_.running().mutex);
    return signal->read();
  };
  const rack::DeviceAddress feeder = address("feeder");
  {
    rack::RunningRack& running = runner_.running();
    const std::scoped_lock lock(running.mutex);
    running.catch_up();
    rack_.put(0,
              tmcl::encode(tmcl::Request{
                  .command = static_cast<std::uint8_t>(tmcl::Command::run_application)}),
              running.reached);
  }
  ASSERT_TRUE(wait_for([&] { return position() > 1'000.0; }));
  begin(feeder);
  // A move that is broken off: the motor stands where the program did not send it.
  command(feeder, {.kind = CommandKind::move, .value = -1'000'000'000});
  ASSERT_TRUE(wait_for([&] { return position() < -1'000.0; }));
  command(feeder, {.kind = CommandKind::stop});
  ASSERT_TRUE(wait_for([&] { return axis(feeder).status.state == "at rest"; }));
  control_.release(feeder);
  EXPECT_TRUE(wait_for([&] { return position() > 20'000.0; }));
  EXPECT_TRUE(wait_for([&] { return position() < 10'000.0; }));
}

TEST_F(ManualControlTest, SaysWhyACommandWasNotCarriedOut) {
  const rack::DeviceAddress gantry = address("gantry");
  begin(gantry);
  command(gantry, {.kind = CommandKind::jog, .value = 1'000});
  EXPECT_TRUE(wait_for([&] { return !axis(gantry).refusal.empty(); }));
  EXPECT_THAT(axis(gantry).refusal, HasSubstr("enable it first"));
  EXPECT_EQ(phase(gantry), Phase::active);
}

TEST_F(ManualControlTest, GivesBackTheWatchdogsAsEachDeviceHadThem) {
  const rack::DeviceAddress gantry = address("gantry");
  const std::array<std::uint16_t, 2> own{250, 4'000};
  set_watchdogs(own);
  begin(gantry);
  EXPECT_EQ(watchdogs(), (std::array<std::uint16_t, 2>{20'000, 20'000}));
  control_.release(gantry);
  EXPECT_TRUE(wait_for([&] { return phase(gantry) == Phase::off && watchdogs() == own; }));
}

TEST_F(ManualControlTest, GivesAModuleItsOwnSpeedBackOnceAMoveIsOver) {
  const rack::DeviceAddress winder = address("winder");
  begin(winder);
  const double own = axis(winder).description.velocity;
  command(winder, {.kind = CommandKind::move,
                   .value = 1'000,
                   .relative = true,
                   .velocity = static_cast<std::uint32_t>(own / 5.0)});
  ASSERT_TRUE(wait_for([&] {
    return axis(winder).status.reached && axis(winder).status.position == 1'000.0;
  })) << axis(winder).refusal;
  command(winder, {.kind = CommandKind::move, .value = 1'000'000'000});
  EXPECT_TRUE(wait_for([&] { return axis(winder).status.velocity > own / 2.0; }))
      << axis(winder).status.velocity << " of " << own;
}

TEST_F(ManualControlTest, GivesAModuleItsOwnSpeedBackWithItself) {
  const rack::DeviceAddress winder = address("winder");
  begin(winder);
  const double own = move_slowly(winder);
  control_.release(winder);
  ASSERT_TRUE(wait_for([&] { return phase(winder) == Phase::off; }));
  begin(winder);
  EXPECT_EQ(axis(winder).description.velocity, own);
}

TEST_F(ManualControlTest, GivesAModuleItsOwnSpeedBackBeforeAnotherHostIsAnswered) {
  const tmcl::Request question{
      .command = static_cast<std::uint8_t>(tmcl::Command::get_axis_parameter), .type = 4};
  for (const auto& [name, line] :
       {std::pair("feeder", serial_path()), std::pair("lift", paced_path())}) {
    const rack::DeviceAddress module = address(name);
    begin(module);
    const double own = move_slowly(module);
    const tmcl::Reply reply = ask_module(line, question);
    EXPECT_EQ(reply.command, question.command) << name << ": not the reply to somebody else";
    EXPECT_EQ(reply.value, own) << name;
    EXPECT_TRUE(wait_for([&] { return phase(module) == Phase::ended; }));
    EXPECT_EQ(ask_module(line, question).value, own) << name << ": it has the line from then on";
  }
}

TEST_F(ManualControlTest, GivesAModuleOnCanItsOwnSpeedBackAndKeepsTheReplyFromTheOther) {
  const rack::DeviceAddress winder = address("winder");
  begin(winder);
  const double own = move_slowly(winder);
  const link::FileDescriptor program(::open(can_path().c_str(), O_RDWR | O_NOCTTY));
  const auto send = [&](const std::string& text) {
    ASSERT_EQ(::write(program.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  };
  // Commands that nobody else gives here. What has passed before them was for all on the bus.
  const tmcl::Request first{.command = 10, .type = 71};
  const tmcl::Request last{.command = 10, .type = 70};
  const tmcl::Request question{
      .command = static_cast<std::uint8_t>(tmcl::Command::get_axis_parameter), .type = 4};
  send("O\r" + line_of(first));
  tmcl::Reply reply = next_reply(program);
  while (reply.command != first.command) {
    EXPECT_FALSE(reply.command == static_cast<std::uint8_t>(tmcl::Command::set_axis_parameter) &&
                 reply.value == own);
    reply = next_reply(program);
  }
  ASSERT_TRUE(wait_for([&] { return phase(winder) == Phase::ended; }));
  send(line_of(question));
  reply = next_reply(program);
  EXPECT_EQ(reply.command, question.command) << "not the reply to somebody else";
  EXPECT_EQ(reply.value, own);
  send(line_of(last));
  EXPECT_EQ(next_reply(program).command, last.command);
}

TEST_F(ManualControlTest, MakesWayForAMasterOnTheSegment) {
  const rack::DeviceAddress gantry = address("gantry");
  const std::array<std::uint16_t, 2> own{250, 4'000};
  set_watchdogs(own);
  begin(gantry);
  const auto link = link::UdpEthernetLink::connect({.address = "127.0.0.1", .port = port_});
  ASSERT_TRUE(link);
  bench::LinkPort port(**link);
  master::Master other(port, {.frame_timeout = base::SimDuration(5'000'000'000)});
  const auto scanned = other.scan();
  ASSERT_TRUE(scanned) << scanned.error().text;
  EXPECT_EQ(other.slaves().size(), 2U);
  EXPECT_TRUE(wait_for([&] { return phase(gantry) == Phase::ended; }));
  EXPECT_THAT(control_.status(gantry).text, HasSubstr("another master spoke"));
  EXPECT_EQ(log_.count("manual-control-lost"), 1U);
  EXPECT_EQ(watchdogs(), own) << "as the master before had set them";
  // The other one keeps its segment.
  const auto mailbox = other.start_mailbox(0);
  EXPECT_TRUE(mailbox) << mailbox.error().text;
}

TEST_F(ManualControlTest, MakesWayOnASerialLineAndTheReplyGoesToTheOther) {
  const rack::DeviceAddress feeder = address("feeder");
  begin(feeder);
  EXPECT_EQ(ask_module(serial_path(), {.command = 6, .type = 1}).command, 6);
  EXPECT_TRUE(wait_for([&] { return phase(feeder) == Phase::ended; }));
}

TEST_F(ManualControlTest, DoesNotBeginWhileAnotherMasterSpeaks) {
  const auto link = link::UdpEthernetLink::connect({.address = "127.0.0.1", .port = port_});
  ASSERT_TRUE(link);
  bench::LinkPort port(**link);
  master::Master other(port, {.frame_timeout = base::SimDuration(5'000'000'000)});
  ASSERT_TRUE(other.scan());
  // It goes on speaking until the attempt has ended, however long that takes.
  const rack::DeviceAddress gantry = address("gantry");
  ASSERT_TRUE(control_.start(gantry));
  EXPECT_TRUE(wait_for([&] {
    static_cast<void>(other.al_status(0));
    return phase(gantry) == Phase::ended;
  }));
  EXPECT_THAT(
      control_.status(gantry).text,
      ::testing::AnyOf(HasSubstr("another master is speaking"), HasSubstr("another master spoke")));
}

TEST_F(ManualControlTest, SaysWhyADeviceCannotBeMovedByHand) {
  EXPECT_THAT(control_.impediment(address("gantry")), IsEmpty());
  EXPECT_THAT(control_.impediment(address("io")), HasSubstr("no axis"));
  const auto refused = control_.start(address("io"));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error(), HasSubstr("a program beside it"));
}

TEST_F(ManualControlTest, TakesNoCommandForWhatItDoesNotControl) {
  const rack::DeviceAddress gantry = address("gantry");
  const auto early = control_.command(gantry, 0, {.kind = CommandKind::enable});
  ASSERT_FALSE(early);
  EXPECT_THAT(early.error(), HasSubstr("not under manual control"));
  begin(gantry);
  const auto fourth = control_.command(gantry, 3, {.kind = CommandKind::enable});
  ASSERT_FALSE(fourth);
  EXPECT_EQ(fourth.error(), "it has no axis 3; the last is 2");
  const rack::DeviceAddress feeder = address("feeder");
  begin(feeder);
  const auto enable = control_.command(feeder, 0, {.kind = CommandKind::enable});
  ASSERT_FALSE(enable);
  EXPECT_EQ(enable.error(), "its axes have no \"enable\"");
}

TEST(ManualControlInLockstep, IsLeftToTheMaster) {
  rack::RackConfiguration configuration = rack::parse_rack_file(
      "clock = \"lockstep\"\n[[segment]]\nlink = \"udp:127.0.0.1:" +
          std::to_string(free_udp_port()) + "\"\n[[segment.device]]\ntype = \"tmcm-3315\"\n",
      "rack.toml", devices::products());
  rack::EventLog log;
  rack::Rack rack(configuration, log);
  rack::Runner runner(rack, configuration, tests::no_log());
  ManualControl control(runner, configuration, log);
  EXPECT_THAT(control.impediment({}), HasSubstr("lockstep"));
}

TEST(ManualCommands, HaveNamesThatAreFoundAgain) {
  for (const char* name : {"enable", "disable", "reset-fault", "jog", "move", "home", "stop",
                           "quick-stop", "mode", "controlword"}) {
    const auto kind = command_of(name);
    ASSERT_TRUE(kind) << name;
    EXPECT_EQ(name_of(*kind), name);
    EXPECT_THAT(command_names(), ::testing::Contains(name));
  }
  EXPECT_FALSE(command_of("fly"));
}

}  // namespace
}  // namespace stator::manual

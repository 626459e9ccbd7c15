// A TMCM-142 that is connected to a memory answers what it has written when that is kept.

#include "tmcm_142_busy.hpp"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/can/frame.hpp"

namespace stator::tests {
namespace {

using namespace base::literals;
using tmcl::Command;
using tmcl::Reply;
using tmcl::Status;
using enum devices::tmcm_142::AxisParameter;

constexpr base::SimDuration kWriteTime = devices::tmcm_142::Eeprom::kWriteTime;
constexpr int kAddress = 66;
constexpr int kCanReplyIdentifier = 70;
constexpr int kTelegramPause = 75;
constexpr int kProtection = 81;
constexpr int kCoordinateStorage = 84;
constexpr int kVariables = 2;  // a bank

TEST_F(Tmcm142Busy, AReplyComesWhenTheEepromIsWrittenAndTheMemoryIsReady) {
  module.run(123_us);
  send(Command::set_global_parameter, kAddress, 0, 1);
  EXPECT_EQ(module.device->next_serial_reply(), module.now + kWriteTime);
  EXPECT_EQ(module.device->next_deadline(), module.now + kWriteTime);
  memory.finish(true);
  module.run(kWriteTime - 1_ns);
  EXPECT_FALSE(reply()) << "the disk was quicker than the EEPROM";
  module.run(1_ns);
  EXPECT_EQ(reply(), (Reply{.command = 9, .value = 1}));
  EXPECT_EQ(module.device->next_serial_reply(), base::SimTime::never());
  EXPECT_EQ(module.device->next_deadline(), base::SimTime::never());
}

TEST_F(Tmcm142Busy, AMemoryThatIsSlowerThanTheEepromIsWaitedFor) {
  send(Command::set_global_parameter, kAddress, 0, 1);
  module.run(70_ms);
  EXPECT_FALSE(reply());
  memory.finish(true);
  module.run(99_us);
  EXPECT_FALSE(reply()) << "it is looked for in every control period";
  module.run(1_us);
  EXPECT_EQ(reply(), (Reply{.command = 9, .value = 1}));
}

// The moment of a reply must not depend on who looks at the device in between.
TEST_F(Tmcm142Busy, TheReplyDoesNotDependOnTheIntervalsAtWhichTimeIsTold) {
  send(Command::set_global_parameter, kAddress, 0, 1);
  module.run(kWriteTime + 30_us);
  EXPECT_FALSE(reply());
  memory.finish(true);
  for (int i = 0; i < 69; ++i) {
    module.run(1_us);
    EXPECT_FALSE(reply()) << i;
  }
  module.run(1_us);
  EXPECT_TRUE(reply());
}

TEST_F(Tmcm142Busy, EveryCommandThatWritesTheEepromIsAnsweredWhenItIsKept) {
  EXPECT_EQ(written(Command::set_global_parameter, kCoordinateStorage, 0, 1), Status::success);
  EXPECT_EQ(written(Command::store_axis_parameter, 4, 0), Status::success);
  EXPECT_EQ(written(Command::store_global_parameter, 3, kVariables), Status::success);
  EXPECT_EQ(written(Command::set_coordinate, 5, 0, 99), Status::success);
  EXPECT_EQ(written(Command::capture_coordinate, 6, 0), Status::success);
  EXPECT_EQ(written(Command::set_coordinate, 0, 255), Status::success) << "copies all";
  EXPECT_EQ(written(Command::accumulator_to_global_parameter, kProtection, 0), Status::success);
  EXPECT_EQ(written(Command::accumulator_to_coordinate, 7, 0), Status::success);
  EXPECT_EQ(memory.orders, 8);
}

TEST_F(Tmcm142Busy, CommandsThatWriteNothingAreAnsweredAtOnce) {
  const int before = memory.orders;
  const std::vector<tmcl::Request> all{request(Command::set_axis_parameter, 4, 0, 1000),
                                       request(Command::restore_axis_parameter, 4, 0),
                                       request(Command::set_global_parameter, 3, kVariables, 5),
                                       request(Command::restore_global_parameter, 3, kVariables),
                                       request(Command::set_coordinate, 5, 0, 9),
                                       request(Command::get_global_parameter, kAddress, 0),
                                       request(Command::start_download, 0, 0),
                                       request(Command::quit_download, 0, 0)};
  for (const tmcl::Request& each : all) {
    send(usb, each);
    EXPECT_TRUE(reply()) << int{each.command};
  }
  EXPECT_EQ(memory.orders, before);
}

TEST_F(Tmcm142Busy, ARefusedCommandIsRefusedAtOnce) {
  ASSERT_EQ(written(Command::set_global_parameter, 73, 0, 1234), Status::success);
  send(Command::set_global_parameter, kAddress, 0, 5);
  EXPECT_EQ(reply()->status, Status::eeprom_locked);
  EXPECT_EQ(module.events.count("could not be kept"), 0);
}

TEST_F(Tmcm142Busy, WhatCannotBeKeptIsRefusedAndTheOldValueIsThere) {
  ASSERT_EQ(written(Command::set_global_parameter, kTelegramPause, 0, 1), Status::success);
  EXPECT_EQ(written(Command::set_global_parameter, kTelegramPause, 0, 9, false),
            Status::eeprom_locked);
  EXPECT_EQ(module.ggp(kTelegramPause), 1);
  EXPECT_EQ(kept_global(kTelegramPause), 1);
  EXPECT_EQ(module.events.count("SGP with type 75, motor or bank 0, value 9 refused with status 5"),
            1);
  module.power_cycle();
  EXPECT_EQ(module.ggp(kTelegramPause), 1) << "in the EEPROM too";
  EXPECT_EQ(written(Command::set_global_parameter, kTelegramPause, 0, 9), Status::success)
      << "sent again when there is room";
  EXPECT_EQ(kept_global(kTelegramPause), 9);
}

TEST_F(Tmcm142Busy, AStoreThatFailsLeavesTheValueInRamAndTheOldOneInTheEeprom) {
  ASSERT_EQ(module.sap(bow, 5), Status::success);
  ASSERT_EQ(written(Command::store_axis_parameter, 18, 0), Status::success);
  ASSERT_EQ(module.sap(bow, 9), Status::success);
  EXPECT_EQ(written(Command::store_axis_parameter, 18, 0, 0, false), Status::eeprom_locked);
  EXPECT_EQ(module.gap(bow), 9);
  module.power_cycle();
  EXPECT_EQ(module.gap(bow), 5);

  send(Command::set_global_parameter, 3, kVariables, 33);
  EXPECT_TRUE(reply());
  EXPECT_EQ(written(Command::store_global_parameter, 3, kVariables, 0, false),
            Status::eeprom_locked);
  EXPECT_EQ(module.ggp(3, kVariables), 33);
  module.power_cycle();
  EXPECT_EQ(module.ggp(3, kVariables), 0);
}

TEST_F(Tmcm142Busy, ACoordinateThatCannotBeKeptKeepsItsOldValue) {
  const auto coordinate = [&] { return module.execute(Command::get_coordinate, 5, 0).value; };
  send(Command::set_coordinate, 5, 0, 1);
  EXPECT_TRUE(reply()) << "in RAM only";
  EXPECT_EQ(written(Command::set_coordinate, 5, 255, 0, false), Status::eeprom_locked);
  EXPECT_EQ(coordinate(), 1) << "a copy to the EEPROM leaves the RAM alone";
  ASSERT_EQ(written(Command::set_global_parameter, kCoordinateStorage, 0, 1), Status::success);
  ASSERT_EQ(written(Command::set_coordinate, 5, 0, 70), Status::success);
  EXPECT_EQ(written(Command::set_coordinate, 5, 0, 80, false), Status::eeprom_locked);
  EXPECT_EQ(coordinate(), 70);
  module.power_cycle();
  EXPECT_EQ(coordinate(), 70);
}

TEST_F(Tmcm142Busy, LiftingTheProtectionErasesTheProgramOrDoesNeither) {
  ASSERT_EQ(written(Command::set_global_parameter, kProtection, 0, 1), Status::success);
  module.device->tmcl().load_program(std::vector<tmcl::Instruction>(3, {.command = 28}));
  module.run(1_ms);
  write();
  EXPECT_EQ(written(Command::set_global_parameter, kProtection, 0, 0, false),
            Status::eeprom_locked);
  EXPECT_EQ(module.ggp(kProtection), 1);
  EXPECT_EQ(module.device->tmcl().memory()[2].command, 28);
  EXPECT_EQ(written(Command::set_global_parameter, kProtection, 0, 0), Status::success);
  EXPECT_EQ(module.device->tmcl().memory()[2].command, 0);
}

TEST_F(Tmcm142Busy, EveryInstructionOfADownloadIsKeptBeforeItsReply) {
  send(Command::start_download, 0, 0, 10);
  EXPECT_EQ(reply()->status, Status::success);
  EXPECT_EQ(written(Command::rotate_right, 0, 0, 500), Status::loaded_into_eeprom);
  EXPECT_EQ(written(Command::stop, 0, 0), Status::loaded_into_eeprom);
  send(Command::quit_download, 0, 0);
  EXPECT_EQ(reply()->status, Status::success);
  Tmcm142Module other;
  other.device->connect_memory(memory);
  EXPECT_EQ(other.device->tmcl().memory()[10], (tmcl::Instruction{.command = 1, .value = 500}));
  EXPECT_EQ(other.device->tmcl().memory()[11], tmcl::Instruction{.command = 28});
}

TEST_F(Tmcm142Busy, AnInstructionThatCannotBeKeptIsToldInItsReplyAndCanBeSentAgain) {
  send(Command::start_download, 0, 0);
  EXPECT_TRUE(reply());
  EXPECT_EQ(written(Command::rotate_right, 0, 0, 500), Status::loaded_into_eeprom);
  EXPECT_EQ(written(Command::wait, 0, 0, 7, false), Status::eeprom_locked);
  EXPECT_EQ(module.device->tmcl().memory()[1], tmcl::Instruction{});
  EXPECT_EQ(written(Command::wait, 0, 0, 7), Status::loaded_into_eeprom);
  EXPECT_EQ(module.device->tmcl().memory()[0].command, 1);
  EXPECT_EQ(module.device->tmcl().memory()[1], (tmcl::Instruction{.command = 27, .value = 7}));
}

TEST_F(Tmcm142Busy, HostsOfEveryInterfaceWaitInTurn) {
  send(Command::set_global_parameter, kAddress, 0, 1);
  send(rs232, request(Command::get_axis_parameter, 6, 0));
  send_frame({6, 6, 0, 0, 0, 0, 0});
  send_frame({10, 66, 0, 0, 0, 0, 0});
  send(usb, request(Command::get_axis_parameter, 7, 0));
  EXPECT_TRUE(replies(rs232).empty());
  EXPECT_FALSE(sent());
  send(rs232, request(Command::get_axis_parameter, 7, 0));
  EXPECT_EQ(module.events.count("telegram lost"), 1) << "one waits on each line";
  write();
  EXPECT_EQ(replies(usb),
            (std::vector<Reply>{{.command = 9, .value = 1}, {.command = 6, .value = 2}}));
  EXPECT_EQ(replies(rs232), (std::vector<Reply>{{.command = 6, .value = 8}}));
  EXPECT_EQ(sent(), can::data_frame(2, {1, 100, 6, 0, 0, 0, 8}));
  EXPECT_EQ(sent(), can::data_frame(2, {1, 100, 10, 0, 0, 0, 1}))
      << "frames wait in the controller";
}

TEST_F(Tmcm142Busy, ACanReplyComesUnderTheIdentifierOfBefore) {
  send_frame({9, kCanReplyIdentifier, 0, 0, 0, 0, 77});
  EXPECT_FALSE(sent());
  EXPECT_EQ(module.device->next_deadline(), module.now + kWriteTime);
  write();
  EXPECT_EQ(sent(), can::data_frame(2, {1, 100, 9, 0, 0, 0, 77}));
  send_frame({9, kCanReplyIdentifier, 0, 0, 0, 0, 88});
  write(false);
  EXPECT_EQ(sent(), can::data_frame(77, {1, 5, 9, 0, 0, 0, 88}));
  EXPECT_EQ(module.ggp(kCanReplyIdentifier), 77);
}

TEST_F(Tmcm142Busy, ALineOfTextIsAnsweredWhenItIsKeptAndTheNextOneWaits) {
  send(Command::enter_ascii_mode, 0, 0);
  EXPECT_TRUE(reply());
  const auto type = [&](std::string_view text) {
    usb.write(std::as_bytes(std::span(text)));
    module.device->handle_serial(module.now);
  };
  const auto text = [&] {
    std::string all;
    for (const std::byte byte : usb.read()) {
      all += static_cast<char>(byte);
    }
    return all;
  };
  type("ASGP 76, 0, 2\r");
  EXPECT_EQ(text(), "ASGP 76, 0, 2\r") << "the echo";
  type("AGAP 6, 0\r");
  EXPECT_EQ(text(), "AGAP 6, 0\r");
  write();
  EXPECT_EQ(text(), "BA 100 2\rBA 100 8\r");
  type("ASGP 67, 0, 16\r");
  write();
  EXPECT_EQ(text(), "ASGP 67, 0, 16\rASGP 67, 0, 16\rBA 100 16\r");
  type("ASGP 75, 0, 9\rAGAP 7, 0\r");
  write(false);
  EXPECT_EQ(text(), "ASGP 75, 0, 9\rBA 5 9\rAGAP 7, 0\rBA 100 2\r");
}

TEST_F(Tmcm142Busy, TheTelegramPauseComesAfterTheWrite) {
  send(rs232, request(Command::set_global_parameter, kTelegramPause, 0, 3));
  write();
  EXPECT_TRUE(replies(rs232).empty());
  module.run(3_ms);
  EXPECT_EQ(replies(rs232).size(), 1U);
}

TEST_F(Tmcm142Busy, FactorySettingsThatCannotBeKeptAreTriedAgain) {
  ASSERT_EQ(written(Command::set_global_parameter, kTelegramPause, 0, 9), Status::success);
  send(Command::restore_factory_settings, 0, 0, 1234);
  write(false);
  EXPECT_FALSE(reply()) << "it has none";
  EXPECT_EQ(kept_global(kTelegramPause), 9);
  EXPECT_EQ(module.events.count("written again every 5 s"), 1);
  EXPECT_EQ(written(Command::set_coordinate, 1, 255, 0, false), Status::eeprom_locked)
      << "what comes later is refused for itself";
  module.run(5'010_ms);
  memory.finish(false);
  module.run(5'010_ms);
  EXPECT_EQ(module.events.count("written again every 5 s"), 1) << "told once";
  memory.finish(true);
  module.run(1_ms);
  EXPECT_EQ(kept_global(kTelegramPause), 0);
  const int orders = memory.orders;
  module.run(20_s);
  EXPECT_EQ(memory.orders, orders) << "nothing is owed any more";
}

TEST_F(Tmcm142Busy, WhatIsOwedIsKeptWithTheNextWrite) {
  send(Command::restore_factory_settings, 0, 0, 1234);
  write(false);
  ASSERT_EQ(written(Command::store_axis_parameter, 4, 0), Status::success);
  const int orders = memory.orders;
  module.run(20_s);
  EXPECT_EQ(memory.orders, orders);
}

TEST_F(Tmcm142Busy, ALossOfSupplyDuringAWriteLeavesTheOldOrTheNewAndNoReply) {
  for (const bool kept : {true, false}) {
    send(Command::set_global_parameter, kTelegramPause, 0, kept ? 5 : 6);
    module.run(1_ms);
    module.device->set_power(false, module.now);
    module.run(1_ms);
    module.device->set_power(true, module.now);
    send(rs232, request(Command::get_axis_parameter, 6, 0));
    EXPECT_TRUE(replies(rs232).empty()) << "the EEPROM is still busy";
    memory.finish(kept);
    module.run(kWriteTime);
    EXPECT_FALSE(reply());
    EXPECT_EQ(kept_global(kTelegramPause), 5);
    module.run(6_ms);
    EXPECT_EQ(replies(rs232).size(), 1U);
  }
  memory.answer = ModuleMemory::Answer::kept;
  module.run(6_s);
  EXPECT_EQ(kept_global(kTelegramPause), 6) << "there was nobody to refuse it to";
}

TEST_F(Tmcm142Busy, ACableThatIsPulledOutDoesNotStopTheModule) {
  send(Command::set_global_parameter, kTelegramPause, 0, 5);
  ASSERT_TRUE(module.device->connect_serial("usb", nullptr));
  write();
  send(rs232, request(Command::get_axis_parameter, 6, 0));
  module.run(5_ms);
  EXPECT_EQ(replies(rs232).size(), 1U);
}

TEST_F(Tmcm142Busy, AMemoryThatIsReadyAtOnceTakesNoTime) {
  memory.answer = ModuleMemory::Answer::kept;
  send(Command::set_global_parameter, kAddress, 0, 1);
  EXPECT_TRUE(reply());
  memory.answer = ModuleMemory::Answer::failed;
  send(Command::set_global_parameter, kTelegramPause, 0, 1);
  EXPECT_EQ(reply()->status, Status::eeprom_locked);
  EXPECT_EQ(module.ggp(kTelegramPause), 0);
}

TEST(Tmcm142WithoutMemory, AnswersAtOnce) {
  Tmcm142Module module;
  SerialCable usb;
  ASSERT_TRUE(module.device->connect_serial("usb", &usb));
  usb.write(tmcl::encode({.command = 9, .type = kAddress, .value = 1}));
  module.device->handle_serial(module.now);
  EXPECT_EQ(usb.read().size(), tmcl::kTelegramLength);
}

}  // namespace
}  // namespace stator::tests

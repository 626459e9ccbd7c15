#include "ethercat/stack_fixture.hpp"
#include "ethercat/test_bus.hpp"
#include "stator/ethercat/sii/sii_image.hpp"

namespace stator::ethercat::test {
namespace {

using ::testing::HasSubstr;

/// The stack on the real controller, driven by frames as a master sends them.
class StackOnController : public ::testing::Test {
 protected:
  static constexpr std::uint16_t kStatus = 0x0130;
  static constexpr std::uint32_t kOutputs = 0x10000;
  static constexpr std::uint32_t kInputs = 0x10020;

  StackOnController() {
    fill_test_dictionary(dictionary);
    bus.slave().load_sii(build_sii_image(description, dictionary));
    stack.emplace(bus.slave(), dictionary, description, application, base::EventReporter(&log, 0));
  }

  ethercat::testing::Answer read(std::uint16_t address, std::size_t length) {
    const auto answer = bus.read(0, address, length);
    stack->process(bus.now());
    return answer;
  }
  ethercat::testing::Answer write(std::uint16_t address, const Bytes& data) {
    const auto answer = bus.write(0, address, data);
    stack->process(bus.now());
    return answer;
  }
  unsigned status() { return base::load_le<std::uint16_t>(read(kStatus, 2).data, 0); }
  unsigned status_code() { return base::load_le<std::uint16_t>(read(0x0134, 2).data, 0); }
  void request(std::uint16_t al_control) { write(0x0120, le(al_control)); }

  void configure_mailbox() {
    write(0x0800, hex("00 10 80 00 26 00 01 00 80 10 80 00 22 00 01 00"));
  }
  void configure_process_data() {
    write(0x0810, hex("00 11 1E 00 64 00 01 00"));
    write(0x0818, hex("00 14 1E 00 20 00 01 00"));
    bus.set_fmmu(0, 0, {kOutputs, 30, 0x1100, 2});
    bus.set_fmmu(0, 1, {kInputs, 30, 0x1400, 1});
    stack->process(bus.now());
  }
  void go_pre_operational() {
    configure_mailbox();
    request(0x02);
    ASSERT_EQ(status(), 0x02U) << ::testing::PrintToString(log.sentences());
  }
  void go_operational() {
    go_pre_operational();
    configure_process_data();
    request(0x04);
    ASSERT_EQ(status(), 0x04U) << ::testing::PrintToString(log.sentences());
    request(0x08);
    ASSERT_EQ(status(), 0x08U) << ::testing::PrintToString(log.sentences());
  }
  /// One process-data exchange; working counter 3 if both directions worked.
  unsigned exchange(const Bytes& outputs, Bytes* inputs = nullptr) {
    Bytes image(62);
    std::ranges::copy(outputs, image.begin());
    const auto answer = bus.transfer(Command::lrw, kOutputs, image);
    stack->process(bus.now());
    if (inputs != nullptr) {
      *inputs = part(answer.data, 32, 30);
    }
    return answer.working_counter;
  }
  /// Lets milliseconds pass, with a control tick in each.
  void wait_for(int milliseconds) {
    for (int k = 0; k < milliseconds; ++k) {
      bus.wait(base::SimDuration(1'000'000));
      stack->process(bus.now());
    }
  }
  std::uint64_t controlword() { return dictionary.find(0x6040, 0)->value(); }
  static Bytes mailbox(const Bytes& message) {
    Bytes padded = message;
    padded.resize(128);
    return padded;
  }
  static Bytes sdo_read(std::uint16_t index, unsigned counter) {
    return mailbox(concat({hex("0A 00 00 00 00"),
                           {static_cast<std::byte>(3 | counter << 4)},
                           hex("00 20 40"),
                           le(index),
                           Bytes(5)}));
  }
  bool reply_waits() { return (read(0x080D, 1).data[0] & std::byte{8}) != std::byte{0}; }
  /// The index in the reply, 0 if the mailbox is empty.
  unsigned fetch_index() {
    const auto answer = read(0x1080, 128);
    return answer.working_counter == 1 ? base::load_le<std::uint16_t>(answer.data, 9) : 0;
  }

  /// Controlword 15 and position 500000 of axis 0, among others.
  const Bytes example_outputs =
      hex("0F 00 20 A1 07 00 00 00 00 00 06 00 00 00 00 00 00 00 00 00 0F 00 00 00 00 00 60 79 FE "
          "FF");

  EventLog log;
  DeviceDescription description = test_description();
  dictionary::Dictionary dictionary;
  RecordingApplication application;
  ethercat::testing::TestBus bus;
  std::optional<SlaveStack> stack;
};

TEST_F(StackOnController, InitToOperational_ExchangesProcessData) {
  go_operational();
  dictionary.find(0x6041, 0)->set_value(0x1237);
  stack->publish_inputs(bus.now());
  Bytes inputs;
  EXPECT_EQ(exchange(example_outputs, &inputs), 3U);
  EXPECT_EQ(to_hex(part(inputs, 0, 2)), "37 12");
  EXPECT_EQ(dictionary.find(0x607A, 0)->value(), 500000U);
  EXPECT_EQ(application.outputs, 1);
}

TEST_F(StackOnController, SilenceInOperational_LeavesForSafeOperational) {
  go_operational();
  for (int i = 0; i < 50; ++i) {
    exchange(Bytes(30));
    bus.wait(base::SimDuration(50'000'000));
    stack->process(bus.now());
  }
  EXPECT_EQ(status(), 0x08U);
  exchange(Bytes(30));
  bus.wait(base::SimDuration(101'000'000));
  stack->process(bus.now());
  EXPECT_EQ(status(), 0x14U);
  EXPECT_EQ(status_code(), 0x001BU);
  exchange(Bytes(30));
  request(0x18);
  EXPECT_EQ(status(), 0x08U);
  bus.wait(base::SimDuration(50'000'000));
  stack->process(bus.now());
  EXPECT_EQ(status(), 0x08U);
}

TEST_F(StackOnController, OperationalWithoutAnyOutputs_EndsByTheWatchdog) {
  go_operational();
  bus.wait(base::SimDuration(101'000'000));
  stack->process(bus.now());
  EXPECT_EQ(status(), 0x14U);
}

TEST_F(StackOnController, OutputsOfBeforeSafeOperational_AreNotExecutedInTheNextOperational) {
  go_operational();
  exchange(example_outputs);
  ASSERT_EQ(controlword(), 15U);
  wait_for(101);
  ASSERT_EQ(status(), 0x14U);
  dictionary.find(0x6040, 0)->set_value(7);  // by SDO meanwhile
  request(0x18);
  EXPECT_EQ(status(), 0x08U);
  EXPECT_EQ(controlword(), 7U);
  EXPECT_EQ(application.outputs, 1) << "told of outputs that came before";
  wait_for(101);
  EXPECT_EQ(status(), 0x14U) << "silence counts from Operational on";
  EXPECT_EQ(status_code(), 0x001BU);
}

TEST_F(StackOnController, OutputsSentAfterTheWatchdog_AreExecutedInTheNextOperational) {
  go_operational();
  exchange(Bytes(30));
  wait_for(101);
  ASSERT_EQ(status(), 0x14U);
  exchange(example_outputs);
  EXPECT_EQ(controlword(), 0U) << "not before Operational";
  request(0x18);
  EXPECT_EQ(status(), 0x08U);
  EXPECT_EQ(controlword(), 15U);
}

TEST_F(StackOnController, OutputsWrittenInPreOperational_DoNotCount) {
  go_pre_operational();
  configure_process_data();
  EXPECT_EQ(exchange(example_outputs), 3U) << "the sync manager takes them in any state";
  request(0x04);
  request(0x08);
  EXPECT_EQ(status(), 0x08U);
  EXPECT_EQ(controlword(), 0U);
  EXPECT_EQ(application.outputs, 0);
  exchange(example_outputs);
  EXPECT_EQ(controlword(), 15U);
}

TEST_F(StackOnController, OutputsStillInTheirBufferWhenOperationalIsLeft_DoNotCount) {
  go_operational();
  Bytes image(62);
  std::ranges::copy(example_outputs, image.begin());
  bus.transfer(Command::lrw, kOutputs, image);  // the firmware does not get to it in time
  request(0x04);
  ASSERT_EQ(status(), 0x04U);
  request(0x08);
  EXPECT_EQ(status(), 0x08U);
  EXPECT_EQ(controlword(), 0U);
  EXPECT_EQ(application.outputs, 0);
}

TEST_F(StackOnController, OutputsThatTheirSyncManagerForgot_DoNotCount) {
  go_operational();
  request(0x04);
  Bytes image(62);
  std::ranges::copy(example_outputs, image.begin());
  bus.transfer(Command::lrw, kOutputs, image);
  bus.write(0, 0x0816, Bytes(1));
  bus.write(0, 0x0816, Bytes{std::byte{1}});  // back before the firmware has looked
  stack->process(bus.now());
  ASSERT_EQ(status(), 0x04U);
  request(0x08);
  EXPECT_EQ(status(), 0x08U);
  EXPECT_EQ(controlword(), 0U);
  EXPECT_EQ(application.outputs, 0);
}

TEST_F(StackOnController, WatchdogSetBeforeTheFirstOutputs_IsTheOneThatCounts) {
  struct Setting {
    std::uint16_t count;  ///< units of 100 us
    int lasts;            ///< ms for which Operational must last
    int ends;             ///< ms after which it must be over; 0: it lasts
  };
  for (const Setting& setting : {Setting{0, 500, 0}, {10'000, 950, 1'010}, {300, 25, 35}}) {
    request(0x01);
    write(0x0420, le(std::uint16_t{1000}));
    go_operational();
    wait_for(5);
    write(0x0420, le(setting.count));
    wait_for(setting.lasts - 5);
    EXPECT_EQ(status(), 0x08U) << setting.count;
    if (setting.ends != 0) {
      wait_for(setting.ends - setting.lasts);
      EXPECT_EQ(status(), 0x14U) << setting.count;
      EXPECT_EQ(status_code(), 0x001BU) << setting.count;
    }
    request(0x11);
  }
}

TEST_F(StackOnController, WatchdogSwitchedOnInOperational_CountsFromThenOn) {
  for (const bool outputs_came : {false, true}) {
    request(0x11);
    write(0x0420, le(std::uint16_t{0}));
    go_operational();
    if (outputs_came) {
      exchange(Bytes(30));
    }
    wait_for(500);
    write(0x0420, le(std::uint16_t{1000}));
    wait_for(95);
    EXPECT_EQ(status(), 0x08U) << outputs_came;
    wait_for(10);
    EXPECT_EQ(status(), 0x14U) << outputs_came;
    EXPECT_EQ(status_code(), 0x001BU);
  }
}

TEST_F(StackOnController, WatchdogSwitchedOffAndOnAgain_StillNoticesSilence) {
  go_operational();
  exchange(Bytes(30));
  write(0x0420, le(std::uint16_t{0}));
  write(0x0420, le(std::uint16_t{1000}));
  wait_for(95);
  EXPECT_EQ(status(), 0x08U);
  wait_for(10);
  EXPECT_EQ(status(), 0x14U);
}

TEST_F(StackOnController, WatchdogSwitchedOnUnderAMasterThatSends_EndsNothing) {
  write(0x0420, le(std::uint16_t{0}));
  go_operational();
  for (int k = 0; k < 30; ++k) {
    exchange(Bytes(30));
    wait_for(10);
    if (k == 10) {
      write(0x0420, le(std::uint16_t{1000}));
    }
  }
  EXPECT_EQ(status(), 0x08U);
  wait_for(105);
  EXPECT_EQ(status(), 0x14U);
}

TEST_F(StackOnController, AResetOfTheController_IsToldWithWhoAskedForItAndTheState) {
  bus.slave().set_event_reporter(base::EventReporter(&log, 0));
  go_operational();
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    EXPECT_EQ(log.last("esc-reset"), "");
    bus.write(0, 0x0040, Bytes{static_cast<std::byte>(key)});
  }
  EXPECT_THAT(log.last("esc-reset"),
              HasSubstr("the master has reset the controller (keys R, E, S in 0040h), which was in "
                        "Operational"));
  EXPECT_EQ(base::load_le<std::uint16_t>(bus.read(0, kStatus, 2).data, 0), 0x01U);
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    bus.slave().write(0x0041, Bytes{static_cast<std::byte>(key)});
  }
  EXPECT_THAT(log.last("esc-reset"), HasSubstr("its host has reset the controller (keys R, E, S in "
                                               "0041h), which was in Init"));
}

TEST(ControllerReset, ThatTheBoardHasToDo_IsToldAsAWish) {
  SlaveControllerConfiguration configuration;
  configuration.reset_by_board = true;
  ethercat::testing::TestBus bus(1, configuration);
  EventLog log;
  bus.slave().set_event_reporter(base::EventReporter(&log, 0));
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    bus.write(0, 0x0040, Bytes{static_cast<std::byte>(key)});
  }
  EXPECT_THAT(log.last("esc-reset-out"), HasSubstr("in Init: RESET_OUT rises"));
  EXPECT_EQ(log.last("esc-reset"), "");
}

TEST_F(StackOnController, Sdo_IsAnsweredThroughTheMailbox) {
  go_pre_operational();
  EXPECT_FALSE(reply_waits());
  EXPECT_EQ(write(0x1000, sdo_read(0x1018, 1)).working_counter, 1U);
  EXPECT_TRUE(reply_waits());
  const auto answer = read(0x1080, 128);
  EXPECT_EQ(answer.working_counter, 1U);
  EXPECT_EQ(to_hex(part(answer.data, 0, 16)), "0A 00 00 00 00 13 00 30 4F 18 10 00 03 00 00 00");
  EXPECT_FALSE(reply_waits());
  EXPECT_EQ(read(0x1080, 128).working_counter, 0U);
}

TEST_F(StackOnController, MailboxInTwoAccesses_AsTwinCatDoesIt) {
  go_pre_operational();
  const Bytes request = sdo_read(0x1000, 1);
  bus.with(Command::apwr, physical_address(0, 0x1000), part(request, 0, 16));
  bus.with(Command::apwr, physical_address(0, 0x107F), Bytes(1));
  for (const auto& answer : bus.send()) {
    EXPECT_EQ(answer.working_counter, 1U);
  }
  stack->process(bus.now());
  EXPECT_EQ(read(0x1080, 2).working_counter, 1U);
  EXPECT_TRUE(reply_waits());
  EXPECT_EQ(to_hex(read(0x1080, 16).data), "0A 00 00 00 00 13 00 30 43 00 10 00 92 01 FC FF");
  EXPECT_EQ(read(0x10FF, 1).working_counter, 1U);
  EXPECT_FALSE(reply_waits());
}

TEST_F(StackOnController, MailboxReadAsHeaderContentAndLastByte_IsReleasedByTheLastByteOnly) {
  go_pre_operational();
  EXPECT_EQ(read(0x1080, 6).working_counter, 0U) << "empty";
  write(0x1000, sdo_read(0x1000, 1));
  for (int poll = 0; poll < 3; ++poll) {
    EXPECT_EQ(read(0x1080, 6).working_counter, 1U);
    EXPECT_TRUE(reply_waits());
  }
  EXPECT_EQ(to_hex(part(read(0x1080, 16).data, 6)), "00 30 43 00 10 00 92 01 FC FF");
  EXPECT_TRUE(reply_waits());
  EXPECT_EQ(read(0x10FF, 1).working_counter, 1U);
  EXPECT_EQ(read(0x1080, 6).working_counter, 0U);
}

TEST_F(StackOnController, MailboxPolledByChangeOfTheMappedStatusBit_IsFoundAndCollected) {
  go_operational();
  bus.set_fmmu(0, 2, {0x20000, 1, 0x080D, 1, 0, 0, 3});
  const auto full = [this] {
    const auto answer = bus.transfer(Command::lrd, 0x20000, Bytes(1));
    stack->process(bus.now());
    return answer.data[0] == std::byte{1};
  };
  EXPECT_FALSE(full());
  for (unsigned counter = 1; counter < 4; ++counter) {
    write(0x1000, sdo_read(0x1000, counter));
    EXPECT_TRUE(full()) << "change to full";
    EXPECT_EQ(fetch_index(), 0x1000U);
    EXPECT_FALSE(full()) << "and back, so that the next change is seen";
  }
}

TEST_F(StackOnController, RequestSentAgainBeforeItsReplyWasRead_LeavesTheMailboxEmpty) {
  go_pre_operational();
  for (int frame = 0; frame < 3; ++frame) {  // the master's network was slow, all frames arrive
    EXPECT_EQ(write(0x1000, sdo_read(0x1000, 1)).working_counter, 1U);
  }
  EXPECT_EQ(read(0x0805, 1).data[0] & std::byte{8}, std::byte{0});
  EXPECT_EQ(fetch_index(), 0x1000U);
  EXPECT_EQ(fetch_index(), 0U);
  EXPECT_EQ(write(0x1000, sdo_read(0x1001, 2)).working_counter, 1U);
  EXPECT_EQ(fetch_index(), 0x1001U);
}

TEST_F(StackOnController, RequestThatWaitsForItsTurn_IsForgottenWhenTheMailboxIsSwitchedOff) {
  go_pre_operational();
  write(0x1000, sdo_read(0x1000, 1));
  write(0x1000, sdo_read(0x1001, 2));
  bus.write(0, 0x0806, hex("00"));  // off and on again before the firmware looks
  bus.write(0, 0x0806, hex("01"));
  EXPECT_EQ(fetch_index(), 0x1000U);
  EXPECT_EQ(fetch_index(), 0U);
  write(0x1000, sdo_read(0x1008, 3));
  EXPECT_EQ(fetch_index(), 0x1008U);
}

TEST_F(StackOnController, DrainingReadsAndPollsWithNothingThere_DisturbNothing) {
  go_pre_operational();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(read(0x1080, 128).working_counter, 0U);
    EXPECT_FALSE(reply_waits());
  }
  write(0x1000, sdo_read(0x1000, 1));
  EXPECT_EQ(fetch_index(), 0x1000U);
}

TEST_F(StackOnController, AllEightSyncManagerBytesWrittenAgain_LoseNoMessage) {
  go_pre_operational();
  write(0x1000, sdo_read(0x1000, 1));
  ASSERT_TRUE(reply_waits());
  write(0x0808, hex("80 10 80 00 22 00 01 00"));
  EXPECT_EQ(status(), 0x02U);
  EXPECT_TRUE(reply_waits());
  EXPECT_EQ(fetch_index(), 0x1000U);
}

TEST_F(StackOnController, LostReplyInSafeOperational_ComesAgainToo) {
  go_operational();
  request(0x04);
  write(0x1000, sdo_read(0x1000, 1));
  EXPECT_EQ(fetch_index(), 0x1000U);
  write(0x080E, hex("03"));
  EXPECT_EQ(fetch_index(), 0x1000U);
  EXPECT_EQ(status(), 0x04U);
}

TEST_F(StackOnController, NextRequestBeforeTheReplyWasRead_WaitsInTheController) {
  go_pre_operational();
  EXPECT_EQ(write(0x1000, sdo_read(0x1000, 1)).working_counter, 1U);
  EXPECT_EQ(write(0x1000, sdo_read(0x1001, 2)).working_counter, 1U);
  EXPECT_EQ(write(0x1000, sdo_read(0x1008, 3)).working_counter, 0U);
  EXPECT_EQ(fetch_index(), 0x1000U);
  EXPECT_EQ(fetch_index(), 0x1001U);
  EXPECT_EQ(fetch_index(), 0U);
}

TEST_F(StackOnController, LostReply_ComesAgainOnRepeatRequest) {
  go_pre_operational();
  write(0x1000, sdo_read(0x1000, 1));
  EXPECT_EQ(fetch_index(), 0x1000U);  // the master never saw this frame
  write(0x080E, hex("03"));
  EXPECT_EQ(to_hex(read(0x080F, 1).data), "02");
  EXPECT_EQ(fetch_index(), 0x1000U);
  EXPECT_EQ(fetch_index(), 0U);
}

TEST_F(StackOnController, LostReplyWithANewerOneInPlace_ComesBeforeTheNewer) {
  go_pre_operational();
  write(0x1000, sdo_read(0x1000, 1));
  EXPECT_EQ(fetch_index(), 0x1000U);
  write(0x1000, sdo_read(0x1001, 2));
  ASSERT_TRUE(reply_waits());
  write(0x080E, hex("03"));
  EXPECT_EQ(fetch_index(), 0x1000U);
  EXPECT_EQ(fetch_index(), 0x1001U);
  EXPECT_EQ(fetch_index(), 0U);
}

TEST_F(StackOnController, MessagesLeftInTheMailboxes_AreGoneAfterInit) {
  go_pre_operational();
  write(0x1000, sdo_read(0x1000, 1));
  write(0x1000, sdo_read(0x1001, 2));
  request(0x01);
  request(0x02);
  ASSERT_EQ(status(), 0x02U);
  EXPECT_FALSE(reply_waits());
  EXPECT_EQ(write(0x1000, sdo_read(0x1008, 3)).working_counter, 1U);
  EXPECT_EQ(fetch_index(), 0x1008U);
  EXPECT_EQ(fetch_index(), 0U);
}

TEST_F(StackOnController, MasterRestartedInEveryState_FindsTheSlaveReady) {
  for (const unsigned last : {0x02U, 0x04U, 0x08U}) {
    for (int round = 0; round < 3; ++round) {
      write(0x0120, le(std::uint16_t{0x11}));
      write(0x0600, Bytes(48));
      write(0x0800, Bytes(32));
      write(0x0120, le(std::uint16_t{0x11}));
      ASSERT_EQ(status(), 0x01U);
      go_pre_operational();
      write(0x1000, sdo_read(0x1000, 1));
      if (round == 1) {
        continue;  // killed with a reply in the mailbox
      }
      ASSERT_EQ(fetch_index(), 0x1000U);
      if (last >= 0x04) {
        configure_process_data();
        request(0x04);
      }
      if (last == 0x08) {
        request(0x08);
        ASSERT_EQ(exchange(Bytes(30)), 3U);
      }
      ASSERT_EQ(status(), last) << ::testing::PrintToString(log.sentences());
    }
  }
}

TEST_F(StackOnController, SyncManagersClearedInOperational_StopTheSlave) {
  go_operational();
  exchange(Bytes(30));
  write(0x0816, hex("00"));
  EXPECT_EQ(status(), 0x12U);
  EXPECT_EQ(status_code(), 0x001DU);
  EXPECT_THAT(log.last("al-sm-disabled"), HasSubstr("SM2 is not enabled"));
}

TEST_F(StackOnController, WithNothingToDo_NoEventStaysPending) {
  go_operational();
  exchange(Bytes(30));
  write(0x1000, sdo_read(0x1000, 1));
  EXPECT_EQ(fetch_index(), 0x1000U);
  constexpr std::uint32_t kHandled = al_event::kAlControl | al_event::kSyncManagerActivation |
                                     al_event::kProcessDataWatchdog | al_event::sync_manager(0) |
                                     al_event::sync_manager(2);
  EXPECT_EQ(bus.slave().al_event_request() & kHandled, 0U);
}

TEST_F(StackOnController, SyncManagerOfAnotherChannel_IsAcknowledgedToo) {
  go_operational();
  write(0x0830, hex("00 20 10 00 20 00 01 00"));
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kSyncManagerActivation, 0U);
  EXPECT_EQ(status(), 0x08U);
}

/// Writes one word of the EEPROM as masters do; reloads it with 0400h.
class StackWithEeprom : public StackOnController {
 protected:
  void write_word(unsigned word, unsigned value) {
    write(0x0502,
          ethercat::testing::bytes({0x81, 0x02, word, 0, 0, 0, value & 0xFFU, value >> 8U}));
    pass();
  }
  void reload() {
    write(0x0502, hex("00 04 00 00 00 00"));
    pass();
  }
  void pass() {
    bus.wait(base::SimDuration(2'000'000));
    stack->process(bus.now());
  }
  unsigned checksum() { return sii_checksum(bus.slave().sii()); }
};

TEST_F(StackWithEeprom, StaysInInitUntilTheEepromIsRepairedAndReloaded) {
  const unsigned good = checksum();
  write_word(7, good ^ 0xFFU);
  reload();
  configure_mailbox();
  request(0x02);
  EXPECT_EQ(status(), 0x01U);
  EXPECT_EQ(status_code(), 0U) << "nobody is there to give a reason";
  write(0x1000, sdo_read(0x1000, 1));
  EXPECT_EQ(read(0x0805, 1).data[0] & std::byte{8}, std::byte{0}) << "the mailbox is closed";
  write_word(7, good);
  reload();
  EXPECT_EQ(log.last("al-controller-back"),
            "the slave controller answers its firmware again, which starts in Init");
  EXPECT_EQ(status(), 0x02U) << "the request that waited was answered";
}

TEST_F(StackWithEeprom, LeavesOperationalWhenAReloadFailsAndStartsAnewWhenOneSucceeds) {
  go_operational();
  const unsigned good = checksum();
  write_word(7, good ^ 0xFFU);
  application.steps.clear();
  reload();
  EXPECT_EQ(application.steps.back(), "Pre-Operational->Init") << "nothing it commanded goes on";
  EXPECT_EQ(stack->state(), AlState::init);
  EXPECT_THAT(log.last("al-controller-lost"), HasSubstr("left Operational for Init"));
  EXPECT_EQ(status(), 0x08U) << "nobody can write AL status";
  write_word(7, good);
  reload();
  EXPECT_EQ(status(), 0x01U);
  go_operational();
}

}  // namespace
}  // namespace stator::ethercat::test

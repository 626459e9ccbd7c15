// Every requested AL state in every state against the standard's table, with status codes and their
// explanation.
#include "stator/ethercat/stack/application_layer.hpp"

#include "ethercat/stack_fixture.hpp"

namespace stator::ethercat::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class ApplicationLayerTest : public StackFixture {
 protected:
  /// Brings the slave to `state` by the regular way.
  void go(AlState state) {
    configure_mailbox();
    configure_process_data();
    process();
    for (const unsigned step : {2U, 4U, 8U}) {
      if (step > static_cast<unsigned>(state)) {
        break;
      }
      request(step);
    }
    ASSERT_EQ(stack.state(), state) << testing::PrintToString(log.sentences());
    application.steps.clear();
  }
  void expect_status(unsigned status, AlStatusCode code) {
    EXPECT_EQ(controller.al_status(), status) << testing::PrintToString(log.sentences());
    EXPECT_EQ(controller.al_status_code(), static_cast<unsigned>(code));
  }
};

TEST_F(ApplicationLayerTest, AfterPowerOn_IsInInitWithoutError) {
  expect_status(0x01, AlStatusCode::no_error);
}

/// Every requested number in every state, against the standard's table.
struct Case {
  AlState from;
  unsigned requested;
  unsigned status;
  AlStatusCode code;
};

class EveryRequest : public ApplicationLayerTest, public testing::WithParamInterface<Case> {};

TEST_P(EveryRequest, IsAnsweredAsTheStandardSays) {
  const Case& c = GetParam();
  go(c.from);
  request(c.requested);
  expect_status(c.status, c.code);
}

TEST_P(EveryRequest, IsExplainedWhenItIsRefused) {
  const Case& c = GetParam();
  go(c.from);
  log.events.clear();
  request(c.requested);
  const bool refused = c.code != AlStatusCode::no_error;
  const bool explained = std::ranges::any_of(log.events, [](const base::Event& event) {
    return event.rule->severity == base::Severity::refusal;
  });
  EXPECT_EQ(refused, explained);
}

std::vector<Case> all_cases() {
  const AlStatusCode ok = AlStatusCode::no_error;
  const AlStatusCode invalid = AlStatusCode::invalid_requested_state_change;
  const AlStatusCode no_boot = AlStatusCode::bootstrap_not_supported;
  std::vector<Case> cases{
      {AlState::init, 1, 0x01, ok},
      {AlState::init, 2, 0x02, ok},
      {AlState::init, 3, 0x11, no_boot},
      {AlState::init, 4, 0x11, invalid},
      {AlState::init, 8, 0x11, invalid},
      {AlState::pre_operational, 1, 0x01, ok},
      {AlState::pre_operational, 2, 0x02, ok},
      {AlState::pre_operational, 3, 0x12, invalid},
      {AlState::pre_operational, 4, 0x04, ok},
      {AlState::pre_operational, 8, 0x12, invalid},
      {AlState::safe_operational, 1, 0x01, ok},
      {AlState::safe_operational, 2, 0x02, ok},
      {AlState::safe_operational, 3, 0x14, invalid},
      {AlState::safe_operational, 4, 0x04, ok},
      {AlState::safe_operational, 8, 0x08, ok},
      {AlState::operational, 1, 0x01, ok},
      {AlState::operational, 2, 0x02, ok},
      {AlState::operational, 3, 0x18, invalid},
      {AlState::operational, 4, 0x04, ok},
      {AlState::operational, 8, 0x08, ok},
  };
  for (const AlState from :
       {AlState::init, AlState::pre_operational, AlState::safe_operational, AlState::operational}) {
    for (const unsigned unknown : {0U, 5U, 6U, 7U, 9U, 10U, 11U, 12U, 13U, 14U, 15U}) {
      cases.push_back({from, unknown, static_cast<unsigned>(from) | 0x10U,
                       AlStatusCode::unknown_requested_state});
    }
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(StateMachine, EveryRequest, testing::ValuesIn(all_cases()),
                         [](const testing::TestParamInfo<Case>& c) {
                           std::string name(to_text(c.param.from));
                           std::erase(name, '-');
                           return name + "_Requests" + std::to_string(c.param.requested);
                         });

TEST_F(ApplicationLayerTest, OperationalToInit_TellsTheApplicationEachStep) {
  go(AlState::operational);
  request(0x01);
  EXPECT_THAT(application.steps,
              ElementsAre("Operational->Safe-Operational", "Safe-Operational->Pre-Operational",
                          "Pre-Operational->Init"));
}

TEST_F(ApplicationLayerTest, UnacknowledgedError_BlocksEverythingButInit) {
  go(AlState::pre_operational);
  request(0x08);
  expect_status(0x12, AlStatusCode::invalid_requested_state_change);
  request(0x04);
  expect_status(0x12, AlStatusCode::invalid_requested_state_change);
  EXPECT_THAT(log.last("al-error-not-acknowledged"), HasSubstr("set bit 4 of AL control"));
  request(0x01);
  expect_status(0x01, AlStatusCode::no_error);
}

TEST_F(ApplicationLayerTest, AcknowledgedError_IsClearedWithTheRequest) {
  go(AlState::pre_operational);
  request(0x08);
  request(0x12);
  expect_status(0x02, AlStatusCode::no_error);
  request(0x08);
  request(0x14);
  expect_status(0x04, AlStatusCode::no_error);
}

TEST_F(ApplicationLayerTest, AcknowledgeWithRefusedRequest_ShowsTheNewError) {
  go(AlState::pre_operational);
  request(0x08);
  request(0x15);
  expect_status(0x12, AlStatusCode::unknown_requested_state);
}

TEST_F(ApplicationLayerTest, MailboxNotConfigured_RefusesPreOperationalWith0016h) {
  request(0x02);
  expect_status(0x11, AlStatusCode::invalid_mailbox_configuration_pre_operational);
  EXPECT_THAT(log.last("al-sm-disabled"), HasSubstr("SM0 is not enabled"));
}

TEST_F(ApplicationLayerTest, WrongMailboxChannels_AreRefusedWith0016h) {
  struct Wrong {
    unsigned channel;
    std::uint16_t start;
    std::uint16_t length;
    std::uint8_t control;
  };
  for (const Wrong& wrong : {Wrong{0, 0x1000, 128, 0x22},     // direction
                             Wrong{1, 0x1080, 128, 0x26},     // direction
                             Wrong{0, 0x1000, 128, 0x24},     // three-buffer mode
                             Wrong{0, 0x1000, 15, 0x26},      // too short
                             Wrong{1, 0x1080, 129, 0x22},     // too long
                             Wrong{0, 0x0F00, 128, 0x26},     // in the registers
                             Wrong{1, 0x2FC0, 128, 0x22},     // behind the memory
                             Wrong{1, 0x1040, 128, 0x22}}) {  // overlaps SM0
    request(0x11);
    configure_mailbox();
    controller.set_sync_manager(wrong.channel, wrong.start, wrong.length, wrong.control, true);
    request(0x02);
    expect_status(0x11, AlStatusCode::invalid_mailbox_configuration_pre_operational);
  }
}

TEST_F(ApplicationLayerTest, OutputLengthNotThatOfTheMapping_IsRefusedWith001DhAndSaysWhy) {
  go_pre_operational();
  configure_process_data(6, 30);
  request(0x04);
  expect_status(0x12, AlStatusCode::invalid_output_configuration);
  EXPECT_THAT(log.last("al-sm-length"), HasSubstr("SM2 length 6, mapping needs 30"));
}

TEST_F(ApplicationLayerTest, InputLengthNotThatOfTheMapping_IsRefusedWith001Eh) {
  go_pre_operational();
  configure_process_data(30, 40);
  request(0x04);
  expect_status(0x12, AlStatusCode::invalid_input_configuration);
  EXPECT_EQ(stack.output_bytes(), 0U);
}

TEST_F(ApplicationLayerTest, WrongProcessDataChannels_AreRefused) {
  go_pre_operational();
  for (const auto& [channel, start, control, enable] :
       {std::tuple{2U, 0x1800, 0x20, true}, std::tuple{2U, 0x1800, 0x66, true},
        std::tuple{2U, 0x1800, 0x64, false}, std::tuple{2U, 0x1080, 0x64, true},
        std::tuple{3U, 0x1C00, 0x24, true}, std::tuple{3U, 0x1C00, 0x20, false},
        std::tuple{3U, 0x1820, 0x20, true}, std::tuple{3U, 0x2FB0, 0x20, true}}) {
    configure_process_data();
    controller.set_sync_manager(channel, static_cast<std::uint16_t>(start), 30,
                                static_cast<std::uint8_t>(control), enable);
    request(0x14);
    const bool overlaps_inputs = start == 0x1820;
    expect_status(0x12, channel == 2 || overlaps_inputs
                            ? AlStatusCode::invalid_output_configuration
                            : AlStatusCode::invalid_input_configuration);
  }
}

TEST_F(ApplicationLayerTest, NoOutputsMapped_AcceptsADisabledSm2AndRefusesAnEnabledOne) {
  go_pre_operational();
  sdo("2F 12 1C 00 00 00 00 00");
  configure_process_data(30, 30);
  request(0x04);
  expect_status(0x12, AlStatusCode::invalid_output_configuration);
  configure_process_data(0, 30);
  request(0x14);
  expect_status(0x04, AlStatusCode::no_error);
}

TEST_F(ApplicationLayerTest, DisabledMailboxInOperation_LeavesForInitWith0016h) {
  for (const unsigned channel : {0U, 1U}) {
    request(0x11);
    go(AlState::operational);
    controller.set_sync_manager(channel, static_cast<std::uint16_t>(0x1000 + channel * 0x80), 128,
                                channel == 0 ? 0x26 : 0x22, false);
    process();
    expect_status(0x11, AlStatusCode::invalid_mailbox_configuration_pre_operational);
  }
}

TEST_F(ApplicationLayerTest, DisabledProcessDataInOperation_LeavesForPreOperational) {
  go(AlState::operational);
  controller.set_sync_manager(2, 0x1800, 30, 0x64, false);
  process();
  expect_status(0x12, AlStatusCode::invalid_output_configuration);
  EXPECT_THAT(application.steps,
              ElementsAre("Operational->Safe-Operational", "Safe-Operational->Pre-Operational"));
  EXPECT_THAT(log.last("al-stepped-down"), HasSubstr("left Operational for Pre-Operational"));
  configure_process_data();
  request(0x14);
  controller.set_sync_manager(3, 0x1C00, 30, 0x20, false);
  process();
  expect_status(0x12, AlStatusCode::invalid_input_configuration);
}

TEST_F(ApplicationLayerTest, MovedChannelInOperation_IsNotFollowed) {
  go(AlState::operational);
  controller.set_sync_manager(3, 0x1D00, 30, 0x20, true);
  process();
  expect_status(0x12, AlStatusCode::invalid_input_configuration);
}

TEST_F(ApplicationLayerTest, SyncManagerChangeInInit_IsOnlyAcknowledged) {
  controller.set_sync_manager(2, 0x1800, 30, 0x64, true);
  process();
  EXPECT_EQ(controller.al_event_request(), 0U);
  expect_status(0x01, AlStatusCode::no_error);
}

TEST_F(ApplicationLayerTest, WatchdogInOperational_LeavesForSafeOperationalWith001Bh) {
  go(AlState::operational);
  controller.write_outputs(Bytes(30));
  process();
  controller.expire_watchdog();
  process();
  expect_status(0x14, AlStatusCode::sync_manager_watchdog);
  EXPECT_EQ(stack.statistics().watchdog_expirations, 1U);
  EXPECT_THAT(application.steps, ElementsAre("Operational->Safe-Operational"));
}

TEST_F(ApplicationLayerTest, WatchdogInSafeOperational_IsNoError) {
  go(AlState::safe_operational);
  controller.expire_watchdog();
  process();
  expect_status(0x04, AlStatusCode::no_error);
  controller.write_outputs(Bytes(30));
  controller.set_word(0x0440, 1);
  request(0x08);
  process();
  expect_status(0x08, AlStatusCode::no_error);
}

TEST_F(ApplicationLayerTest, OperationalWithoutAnyOutputs_EndsAfterTheWatchdogTime) {
  go(AlState::operational);
  now = base::SimTime(base::SimDuration(99'000'000));
  process();
  expect_status(0x08, AlStatusCode::no_error);
  now = base::SimTime(base::SimDuration(101'000'000));
  process();
  expect_status(0x14, AlStatusCode::sync_manager_watchdog);
}

TEST_F(ApplicationLayerTest, OperationalWithoutOutputs_LastsIfTheWatchdogIsOff) {
  controller.set_word(0x0420, 0);
  go(AlState::operational);
  now = base::SimTime(base::SimDuration(10'000'000'000));
  process();
  expect_status(0x08, AlStatusCode::no_error);
}

TEST_F(ApplicationLayerTest, ApplicationMayRefuseAStepUp) {
  application.refused_state = AlState::safe_operational;
  go_pre_operational();
  configure_process_data();
  request(0x04);
  expect_status(0x12, AlStatusCode::dc_invalid_sync_cycle_time);
  EXPECT_THAT(log.last("al-application-refused"), HasSubstr("0035h"));
  EXPECT_EQ(stack.input_bytes(), 0U);
}

TEST_F(ApplicationLayerTest, StepDownByTheDevice_SetsTheErrorIndication) {
  go(AlState::operational);
  stack.step_down(AlState::safe_operational, AlStatusCode::fatal_sync_error, now);
  expect_status(0x14, AlStatusCode::fatal_sync_error);
  stack.step_down(AlState::operational, AlStatusCode::fatal_sync_error, now);
  expect_status(0x14, AlStatusCode::fatal_sync_error);
}

TEST_F(ApplicationLayerTest, Reset_ReturnsToInit) {
  go(AlState::operational);
  stack.reset(now);
  expect_status(0x01, AlStatusCode::no_error);
  EXPECT_EQ(stack.statistics().state_changes, 0U);
}

TEST_F(ApplicationLayerTest, IdentificationRequestWithoutSupport_IsIgnored) {
  go(AlState::pre_operational);
  request(0x22);
  expect_status(0x02, AlStatusCode::no_error);
  EXPECT_THAT(log.last("al-no-identification"), HasSubstr("rack file"));
}

class IdentifiedTest : public StackFixture {
 protected:
  IdentifiedTest() : StackFixture(test_description(), {.device_identification = 0x0815}) {}
};

TEST_F(IdentifiedTest, IdentificationRequest_IsAnsweredInStatusCode) {
  go_pre_operational();
  request(0x22);
  EXPECT_EQ(controller.al_status(), 0x22U);
  EXPECT_EQ(controller.al_status_code(), 0x0815U);
  request(0x02);
  EXPECT_EQ(controller.al_status(), 0x02U);
  EXPECT_EQ(controller.al_status_code(), 0U);
}

TEST_F(IdentifiedTest, ErrorHasPrecedenceOverIdentification) {
  go_pre_operational();
  request(0x28);
  EXPECT_EQ(controller.al_status(), 0x12U);
  EXPECT_EQ(controller.al_status_code(), 0x0011U);
}

class OutputsRequiredTest : public StackFixture {
 protected:
  OutputsRequiredTest() : StackFixture(test_description(), {.require_outputs = true}) {}
};

TEST_F(OutputsRequiredTest, OperationalNeedsOutputsFirst) {
  go_safe_operational();
  request(0x08);
  EXPECT_EQ(controller.al_status(), 0x14U);
  EXPECT_EQ(controller.al_status_code(), 0x0019U);
  EXPECT_THAT(log.last("al-no-outputs"), HasSubstr("exchange process data before"));
  controller.write_outputs(Bytes(30));
  request(0x18);
  EXPECT_EQ(controller.al_status(), 0x08U);
}

TEST_F(OutputsRequiredTest, OutputsOfAnEarlierOperational_AreNotEnoughForTheNext) {
  go_safe_operational();
  controller.write_outputs(Bytes(30));
  request(0x08);
  ASSERT_EQ(controller.al_status(), 0x08U);
  controller.write_outputs(Bytes(30));
  process();
  request(0x04);
  request(0x08);
  EXPECT_EQ(controller.al_status(), 0x14U);
  EXPECT_EQ(controller.al_status_code(), 0x0019U);
  controller.write_outputs(Bytes(30));
  request(0x18);
  EXPECT_EQ(controller.al_status(), 0x08U);
}

TEST_F(OutputsRequiredTest, OutputsWrittenInPreOperational_AreNotEnough) {
  go_pre_operational();
  configure_process_data();
  controller.write_outputs(Bytes(30));
  request(0x04);
  request(0x08);
  EXPECT_EQ(controller.al_status(), 0x14U);
  EXPECT_EQ(controller.al_status_code(), 0x0019U);
}

TEST_F(OutputsRequiredTest, OutputsOfAChannelThatIsPolled_CountLikeOthers) {
  go_pre_operational();
  configure_process_data();
  controller.set_sync_manager(2, 0x1800, 30, 0x44, true);
  controller.write_outputs(Bytes(30));
  request(0x04);
  request(0x08);
  EXPECT_EQ(controller.al_status_code(), 0x0019U);
  controller.write_outputs(Bytes(30));
  request(0x18);
  EXPECT_EQ(controller.al_status(), 0x08U);
}

class BootstrapTest : public StackFixture {
 protected:
  BootstrapTest() : StackFixture(description_with_bootstrap()) {}
  static DeviceDescription description_with_bootstrap() {
    DeviceDescription description = test_description();
    description.bootstrap_receive_mailbox = {0x1000, 256};
    description.bootstrap_transmit_mailbox = {0x1200, 256};
    return description;
  }
};

TEST_F(BootstrapTest, NeedsItsMailboxAndOffersNoCoe) {
  request(0x03);
  EXPECT_EQ(controller.al_status(), 0x11U);
  EXPECT_EQ(controller.al_status_code(), 0x0015U);
  controller.set_sync_manager(0, 0x1000, 256, 0x26, true);
  controller.set_sync_manager(1, 0x1200, 256, 0x22, true);
  request(0x13);
  EXPECT_EQ(controller.al_status(), 0x03U);
  const Bytes reply = exchange(message(3, hex("00 20 40 00 10 00 00 00 00 00")));
  EXPECT_EQ(to_hex(reply), "04 00 00 00 00 10 01 00 02 00");
  request(0x02);
  EXPECT_EQ(controller.al_status(), 0x13U);
  EXPECT_EQ(controller.al_status_code(), 0x0011U);
  request(0x11);
  EXPECT_EQ(controller.al_status(), 0x01U);
}

}  // namespace
}  // namespace stator::ethercat::test

// Process data of a slave stack between sync managers and objects, against the worked example.
#include "ethercat/stack_fixture.hpp"
#include "stator/ethercat/stack/process_image.hpp"

namespace stator::ethercat::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

class ProcessDataTest : public StackFixture {
 protected:
  std::int64_t signed_value(std::uint16_t index) const {
    return dictionary.find(index, 0)->signed_value();
  }
  void set(std::uint16_t index, std::int64_t value) {
    dictionary.find(index, 0)->set_value(static_cast<std::uint64_t>(value));
  }
  void outputs(const Bytes& data) {
    controller.write_outputs(data);
    process();
  }
  /// Maps 6060h alone into the outputs.
  void map_mode_only() {
    go_pre_operational();
    sdo("2F 12 1C 00 00 00 00 00");
    sdo("2B 12 1C 01 01 16 00 00");
    sdo("2F 12 1C 00 01 00 00 00");
    configure_process_data(1, 30);
    request(0x04);
    request(0x08);
    ASSERT_EQ(stack.state(), AlState::operational);
  }
  const Bytes example_outputs =
      hex("0F 00 20 A1 07 00 00 00 00 00 06 00 00 00 00 00 00 00 00 00 0F 00 00 00 00 00 60 79 FE "
          "FF");
};

TEST_F(ProcessDataTest, DefaultMapping_IsThirtyBytesEachWay) {
  go_safe_operational();
  EXPECT_EQ(stack.output_bytes(), 30U);
  EXPECT_EQ(stack.input_bytes(), 30U);
}

TEST_F(ProcessDataTest, Outputs_OfTheWorkedExample_ReachTheirObjects) {
  go_operational();
  outputs(example_outputs);
  EXPECT_EQ(value(0x6040), 15U);
  EXPECT_EQ(signed_value(0x607A), 500000);
  EXPECT_EQ(value(0x6840), 6U);
  EXPECT_EQ(value(0x7040), 15U);
  EXPECT_EQ(signed_value(0x70FF), -100000);
  EXPECT_EQ(application.outputs, 1);
}

TEST_F(ProcessDataTest, Inputs_OfTheWorkedExample_AreInPlaceBeforeSafeOperationalIsTold) {
  set(0x6041, 0x1237);
  set(0x6064, 500000);
  set(0x6841, 0x0250);
  set(0x7041, 0x5237);
  set(0x7064, -1);
  set(0x706C, -100000);
  go_safe_operational();
  EXPECT_EQ(to_hex(controller.read_inputs()),
            "37 12 20 A1 07 00 00 00 00 00 50 02 00 00 00 00 00 00 00 00 37 52 FF FF FF FF 60 79 "
            "FE FF");
  EXPECT_EQ(application.inputs, 1);
}

TEST_F(ProcessDataTest, PublishInputs_WorksInSafeOperationalAndOperationalOnly) {
  go_pre_operational();
  stack.publish_inputs(now);
  EXPECT_EQ(application.inputs, 0);
  configure_process_data();
  request(0x04);
  set(0x6041, 0x0040);
  stack.publish_inputs(now);
  EXPECT_EQ(to_hex(part(controller.read_inputs(), 0, 2)), "40 00");
  EXPECT_EQ(application.inputs, 2);
}

TEST_F(ProcessDataTest, OutputsInSafeOperational_AreHeldUntilOperational) {
  go_safe_operational();
  outputs(example_outputs);
  EXPECT_EQ(value(0x6040), 0U);
  EXPECT_EQ(application.outputs, 0);
  request(0x08);
  EXPECT_EQ(value(0x6040), 15U);
  EXPECT_EQ(application.outputs, 1);
}

TEST_F(ProcessDataTest, OutputsOfAnEarlierRun_AreNotAppliedAgain) {
  go_operational();
  outputs(example_outputs);
  request(0x02);
  set(0x6040, 0);
  request(0x04);
  request(0x08);
  EXPECT_EQ(value(0x6040), 0U);
}

TEST_F(ProcessDataTest, RefusedValue_KeepsTheOldOneAndIsToldOnceUntilCorrect) {
  map_mode_only();
  outputs(hex("08"));
  EXPECT_EQ(value(0x6060), 8U);
  outputs(hex("63"));
  outputs(hex("63"));
  EXPECT_EQ(value(0x6060), 8U);
  EXPECT_THAT(application.refused, ElementsAre(0x6060));
  EXPECT_EQ(stack.statistics().outputs_refused, 2U);
  outputs(hex("01"));
  outputs(hex("63"));
  EXPECT_THAT(application.refused, ElementsAre(0x6060, 0x6060));
  outputs(hex("01"));
  outputs(hex("63"));
  EXPECT_THAT(application.refused, ElementsAre(0x6060, 0x6060, 0x6060));
}

TEST_F(ProcessDataTest, BitsAndPadding_KeepTheirPlaces) {
  go_pre_operational();
  sdo("2F 00 16 00 00 00 00 00");
  sdo("23 00 16 01 03 00 00 00");  // three bits of padding
  sdo("23 00 16 02 01 00 15 20");  // 2015h, one bit
  sdo("23 00 16 03 20 00 7A 60");  // 607Ah, 32 bits from bit 4 on
  sdo("23 00 16 04 04 00 00 00");  // padding to a whole byte
  sdo("2F 00 16 00 04 00 00 00");
  configure_process_data(5, 30);
  request(0x04);
  request(0x08);
  ASSERT_EQ(stack.state(), AlState::operational) << testing::PrintToString(log.sentences());
  outputs(hex("87 67 45 23 01"));
  EXPECT_EQ(value(0x2015), 0U);
  EXPECT_EQ(signed_value(0x607A), 0x12345678);
  outputs(hex("F8 EF FF FF 0F"));
  EXPECT_EQ(value(0x2015), 1U);
  EXPECT_EQ(signed_value(0x607A), -257);
}

TEST_F(ProcessDataTest, TwoPdosOfOneDirection_FollowOneAnother) {
  go_pre_operational();
  sdo("31 13 1C 00 06 00 00 00 02 00 01 1A 00 1A");
  configure_process_data(30, 31);
  set(0x6061, 8);
  set(0x6041, 0x0637);
  request(0x04);
  EXPECT_EQ(to_hex(part(controller.read_inputs(), 0, 4)), "08 37 06 00");
}

TEST_F(ProcessDataTest, OutputChannelWithoutHostInterrupt_IsPolled) {
  go_pre_operational();
  configure_process_data();
  controller.set_sync_manager(2, 0x1800, 30, 0x44, true);
  request(0x04);
  request(0x08);
  outputs(example_outputs);
  EXPECT_EQ(value(0x6040), 15U);
}

TEST_F(ProcessDataTest, ProcessWithNothingPending_DoesNothing) {
  go_operational();
  const auto before = stack.statistics().outputs_received;
  process();
  process();
  EXPECT_EQ(stack.statistics().outputs_received, before);
  EXPECT_THAT(application.refused, IsEmpty());
}

}  // namespace
}  // namespace stator::ethercat::test

// Emergency messages with error register, history and inhibit time, and what of them lasts over
// resets (CiA 301 §7.2.7).
#include "stator/canopen/emergency/emergency_producer.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "canopen/service_bench.hpp"

namespace stator::canopen {
namespace {

using namespace base::literals;
using test::emergency_frame;
using test::ServiceBench;

constexpr Emergency kOvercurrent{.code = 0x2310, .error_register = 0x02, .information = {1, 2}};
constexpr Emergency kOverheating{.code = 0x4310, .error_register = 0x08};

TEST(EmergencyProducer, Error_IsSentOnceWithTheRegister) {
  ServiceBench bench;
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.raise(kOvercurrent, bench.now);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2310, 0x03, {1, 2})});
  bench.emergencies.raise(kOverheating, bench.now);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x4310, 0x0B)});
  EXPECT_EQ(bench.value(0x1001), 0x0BU);
}

TEST(EmergencyProducer, Register_HoldsTheBitsOfErrorsThatLast) {
  ServiceBench bench;
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.raise(kOverheating, bench.now);
  bench.take_sent();
  bench.emergencies.clear(0x2310, 0, bench.now);
  EXPECT_EQ(bench.value(0x1001), 0x09U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x09)});
  bench.emergencies.clear(0x4310, 0, bench.now);
  EXPECT_EQ(bench.value(0x1001), 0x00U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
  bench.emergencies.clear(0x4310, 0, bench.now);
  EXPECT_TRUE(bench.take_sent().empty()) << "it was gone already";
}

TEST(EmergencyProducer, SeveralErrors_CanBeReportedGoneWithOneMessage) {
  ServiceBench bench;
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.raise(kOverheating, bench.now);
  bench.take_sent();
  bench.emergencies.withdraw(0x2310, 0);
  bench.emergencies.withdraw(0x4310, 0);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.emergencies.report_reset(bench.now);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
}

TEST(EmergencyProducer, TableOfTheProduct_GivesBitsAndInformation) {
  constexpr std::array<EmergencyRule, 2> kRules{{{0x2310, 0x83, {}}, {0x8110, 0x11, {0, 255}}}};
  ServiceBench bench({}, {kRules});
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.clear(0x2310, 0, bench.now);
  bench.emergencies.raise({.code = 0x8110, .information = {2}}, bench.now);
  EXPECT_EQ(bench.take_sent(),
            (std::vector{emergency_frame(0x2310, 0x83, {1, 2}), emergency_frame(0x0000, 0x00),
                         emergency_frame(0x8110, 0x11, {2, 255})}));
}

TEST(EmergencyProducer, InhibitTime_KeepsMessagesApartAndInOrder) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1015, 0, 100), 0U);  // 10 ms
  for (std::uint16_t code = 0x2310; code < 0x2313; ++code) {
    bench.emergencies.raise({.code = code, .error_register = 0x02}, bench.now);
  }
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2310, 0x03)});
  bench.wait(9'999_us);
  EXPECT_TRUE(bench.take_sent().empty());
  bench.wait(1_us);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2311, 0x03)});
  bench.wait(10_ms);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2312, 0x03)});
}

TEST(EmergencyProducer, EightMessages_WaitAndAFurtherOneIsLost) {
  ServiceBench bench;
  bench.enter(NmtState::stopped);
  for (std::uint16_t code = 0x2310; code < 0x2319; ++code) {
    bench.emergencies.raise({.code = code}, bench.now);
  }
  EXPECT_TRUE(bench.take_sent().empty()) << "nothing in Stopped";
  EXPECT_EQ(bench.emergencies.statistics().dropped, 1U);
  bench.operational();
  std::vector<can::Frame> sent = bench.take_sent();
  std::erase_if(sent, [](const can::Frame& frame) { return frame.identifier != 0x85; });
  ASSERT_EQ(sent.size(), 8U);
  EXPECT_EQ(sent.front(), emergency_frame(0x2310, 0x01));
  EXPECT_EQ(sent.back(), emergency_frame(0x2317, 0x01));
}

TEST(EmergencyProducer, InvalidCobId_SilencesIt) {
  ServiceBench bench;
  bench.write(0x1014, 0, 0x80000085);
  bench.emergencies.raise(kOvercurrent, bench.now);
  EXPECT_TRUE(bench.take_sent().empty());
  EXPECT_EQ(bench.value(0x1001), 0x03U);
  bench.write(0x1014, 0, 0x91);
  bench.emergencies.raise(kOverheating, bench.now);
  EXPECT_EQ(bench.take_count(0x91), 1U);
}

/// An emergency producer beside the bench's, whose lines are kept.
class LinesOfEmergencies : public base::EventSink {
 public:
  void on_event(const base::Event& event) override {
    const std::string sentence = base::to_sentence(event);
    lines.push_back(sentence.substr(sentence.rfind(';') + 1));
  }
  /// What the line of the next error says of its message.
  std::string fate() {
    lines.clear();
    producer.raise({.code = code++}, now);
    return lines.size() == 1 ? lines.front() : "no line, or several";
  }

  base::SimTime now;
  test::TestDictionary objects;
  test::RecordingTransmitter transmitter;
  EmergencyProducer producer{objects.dictionary, transmitter, base::EventReporter(this, 0)};
  std::uint16_t code = 0x2310;
  std::vector<std::string> lines;
};

TEST(EmergencyProducer, LineOfAnError_SaysWhatBecameOfItsMessage) {
  LinesOfEmergencies lines;
  EXPECT_EQ(lines.fate(),
            " its emergency comes after the boot-up message, if the error lasts until then");
  lines.producer.start(lines.now);
  lines.producer.on_state(NmtState::pre_operational, lines.now);
  EXPECT_EQ(lines.transmitter.frames.size(), 1U);

  EXPECT_EQ(lines.fate(), " its emergency has been handed to the CAN controller");
  EXPECT_EQ(lines.transmitter.frames.size(), 2U);

  lines.transmitter.full = true;
  EXPECT_EQ(lines.fate(),
            " its emergency is lost, for the transmit buffer of the CAN controller is full");
  lines.transmitter.full = false;

  lines.objects.set(0x1015, 0, 100);
  EXPECT_EQ(lines.fate(), " its emergency has been handed to the CAN controller");
  EXPECT_EQ(lines.fate(), " its emergency waits for the inhibit time 1015h or for earlier ones");
  EXPECT_EQ(lines.transmitter.frames.size(), 3U);

  lines.producer.on_state(NmtState::stopped, lines.now);
  EXPECT_EQ(lines.fate(), " its emergency waits until the node has left Stopped");
  for (int waiting = 2; waiting < 8; ++waiting) {
    lines.fate();
  }
  EXPECT_EQ(lines.fate(), " its emergency is lost, for eight wait already");

  lines.objects.set(0x1014, 0, 0x80000085);
  EXPECT_EQ(lines.fate(), " no emergency is sent, for bit 31 of 1014h switches them off");
  lines.lines.clear();
  lines.producer.note({.code = 0x3110}, lines.now);
  EXPECT_EQ(lines.lines,
            std::vector<std::string>{
                " no emergency is sent, for the product has no code for it: only 1001h tells"});
}

TEST(EmergencyProducer, History_HasTheNewestFirstAndTheMessagesFirstBytes) {
  ServiceBench bench;
  EXPECT_EQ(bench.read_refusal(0x1003, 1), 0x08000024U) << "no error yet";
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.raise(kOverheating, bench.now);
  EXPECT_EQ(bench.value(0x1003, 0), 2U);
  EXPECT_EQ(bench.value(0x1003, 1), 0x00004310U);
  EXPECT_EQ(bench.value(0x1003, 2), 0x02012310U);
  EXPECT_EQ(bench.read_refusal(0x1003, 2), 0U);
  EXPECT_EQ(bench.read_refusal(0x1003, 3), 0x08000024U);
  for (std::uint16_t code = 0x5000; code < 0x5003; ++code) {
    bench.emergencies.raise({.code = code}, bench.now);
  }
  EXPECT_EQ(bench.value(0x1003, 0), 4U) << "the oldest one falls out";
  EXPECT_EQ(bench.value(0x1003, 4), 0x00004310U);
}

TEST(EmergencyProducer, History_IsClearedWithZeroOnly) {
  ServiceBench bench;
  bench.emergencies.raise(kOvercurrent, bench.now);
  EXPECT_EQ(bench.write(0x1003, 0, 1), 0x06090030U);
  EXPECT_EQ(bench.write(0x1003, 0, 0), 0U);
  EXPECT_EQ(bench.read_refusal(0x1003, 1), 0x08000024U);
  EXPECT_EQ(bench.value(0x1001), 0x03U) << "the error itself lasts";
}

TEST(EmergencyProducer, Reset_ForgetsCommunicationErrorsAndTellsThoseOfTheApplicationAnew) {
  ServiceBench bench;
  bench.enter(NmtState::stopped);
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.raise({.code = 0x8130, .error_register = 0x10}, bench.now);
  EXPECT_EQ(bench.value(0x1001), 0x13U);
  bench.start();
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2310, 0x03, {1, 2})});
  EXPECT_EQ(bench.value(0x1001), 0x03U) << "the application's error lasts";
  bench.emergencies.forget();
  EXPECT_EQ(bench.value(0x1001), 0x00U);
}

TEST(EmergencyProducer, InInitialisation_TheCobIdOfBeforeDoesNotCount) {
  ServiceBench bench;
  EXPECT_EQ(bench.write(0x1014, 0, 0x80000085), 0U);
  bench.enter(NmtState::initialisation);
  bench.emergencies.raise(kOverheating, bench.now);
  EXPECT_EQ(bench.write(0x1014, 0, 0x85), 0U);
  bench.enter(NmtState::pre_operational);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x4310, 0x09)});
}

TEST(EmergencyProducer, ApplicationThatBeginsAnewInInitialisation_HasNoMessagesOfBefore) {
  ServiceBench bench;
  bench.enter(NmtState::initialisation);
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.forget();  // the supply came again before it had booted up
  bench.emergencies.raise(kOverheating, bench.now);
  bench.enter(NmtState::pre_operational);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x4310, 0x09)});
}

/// Initialisation as Node does it: the communication objects get the values they start with before
/// the services do.
void initialise(ServiceBench& bench) {
  bench.enter(NmtState::initialisation);
  bench.dictionary.reset_values(0x1000, 0x1FFF);
  for (Service* service : bench.services()) {
    service->start(bench.now);
  }
  bench.enter(NmtState::pre_operational);
}

TEST(EmergencyProducer, Register_TellsWhatLastsAfterTheObjectsWereReset) {
  ServiceBench bench;
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.take_sent();
  initialise(bench);
  EXPECT_EQ(bench.value(0x1001), 0x03U);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2310, 0x03, {1, 2})});
  bench.emergencies.clear(0x2310, 0, bench.now);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x0000, 0x00)});
}

TEST(EmergencyProducer, ErrorFoundDuringInitialisation_IsToldOnceAfterwards) {
  ServiceBench bench;
  bench.write(0x1014, 0, 0x80000085);  // switched off, until the reset switches it on again
  bench.enter(NmtState::initialisation);
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.raise(kOverheating, bench.now);
  bench.emergencies.clear(0x4310, 0, bench.now);
  bench.dictionary.reset_values(0x1000, 0x1FFF);
  for (Service* service : bench.services()) {
    service->start(bench.now);
  }
  EXPECT_TRUE(bench.take_sent().empty()) << "not before the boot-up message";
  bench.enter(NmtState::pre_operational);
  EXPECT_EQ(bench.take_sent(), std::vector{emergency_frame(0x2310, 0x03, {1, 2})});
}

TEST(EmergencyProducer, ErrorOfTheRegisterAlone_IsNotToldAfterAReset) {
  ServiceBench bench;
  bench.emergencies.note(kOverheating, bench.now);
  initialise(bench);
  EXPECT_EQ(bench.value(0x1001), 0x09U);
  EXPECT_TRUE(bench.take_sent().empty());
}

TEST(EmergencyProducer, Forgetting_TakesBackWhatWaits) {
  ServiceBench bench;
  bench.enter(NmtState::stopped);
  bench.emergencies.raise(kOvercurrent, bench.now);
  bench.emergencies.forget();
  bench.enter(NmtState::pre_operational);
  EXPECT_TRUE(bench.take_sent().empty());
}

}  // namespace
}  // namespace stator::canopen

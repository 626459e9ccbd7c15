// AL control and AL status between bus and host, in each way to acknowledge and in device
// emulation.
#include <gtest/gtest.h>

#include "ethercat/test_bus.hpp"
#include "stator/base/event.hpp"

namespace stator::ethercat {
namespace {

using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;

TEST(AlControl, IsLockedUntilTheHostHasReadIt) {
  TestBus bus;
  bus.with(Command::apwr, physical_address(0, 0x0120), bytes({0x02, 0}))
      .with(Command::apwr, physical_address(0, 0x0120), bytes({0x04, 0}));
  const auto answers = bus.send();
  EXPECT_EQ(answers[0].working_counter, 1U);
  EXPECT_EQ(answers[1].working_counter, 0U);
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kAlControl, al_event::kAlControl);
  EXPECT_EQ(number(host_read(bus.slave(), 0x0120, 2)), 2U);
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kAlControl, 0U);
  EXPECT_EQ(bus.write(0, 0x0120, bytes({0x04, 0})).working_counter, 1U);
}

TEST(AlControl, ReadingTheUpperByteAloneAcknowledges) {
  TestBus bus;
  bus.write(0, 0x0120, bytes({0x02, 0}));
  host_read(bus.slave(), 0x0121, 1);
  EXPECT_EQ(bus.write(0, 0x0120, bytes({0x04, 0})).working_counter, 1U);
}

TEST(AlControl, ReadingByTheBusDoesNotAcknowledge) {
  TestBus bus;
  bus.write(0, 0x0120, bytes({0x02, 0}));
  bus.read(0, 0x0120, 2);
  EXPECT_EQ(bus.write(0, 0x0120, bytes({0x04, 0})).working_counter, 0U);
}

TEST(AlControl, InAcknowledgeByWriteMode_TheHostWritesToAcknowledge) {
  SlaveControllerConfiguration configuration;
  configuration.acknowledge_by_write = true;
  TestBus bus(1, configuration);
  bus.write(0, 0x0120, bytes({0x02, 0}));
  host_read(bus.slave(), 0x0120, 2);
  EXPECT_EQ(bus.write(0, 0x0120, bytes({0x04, 0})).working_counter, 0U);
  host_write(bus.slave(), 0x0120, bytes({0, 0}));
  EXPECT_EQ(number(bus.read(0, 0x0120, 2).data), 2U) << "the value written is ignored";
  EXPECT_EQ(bus.write(0, 0x0120, bytes({0x04, 0})).working_counter, 1U);
}

TEST(AlControl, InDeviceEmulation_StatusFollowsAndNothingLocks) {
  SlaveControllerConfiguration configuration;
  configuration.device_emulation = true;
  TestBus bus(1, configuration);
  bus.write(0, 0x0120, bytes({0x02, 0}));
  EXPECT_EQ(bus.write(0, 0x0120, bytes({0x04, 0})).working_counter, 1U);
  EXPECT_EQ(number(bus.read(0, 0x0130, 2).data), 4U);
  EXPECT_EQ(bus.slave().al_event_request() & al_event::kAlControl, 0U);
  host_write(bus.slave(), 0x0130, bytes({8, 0}));
  EXPECT_EQ(number(bus.read(0, 0x0130, 2).data), 4U) << "the host has no say";
}

TEST(AlControl, StatusAndCodeAreTheHostsToWrite) {
  TestBus bus;
  EXPECT_EQ(bus.write(0, 0x0130, bytes({8, 0})).working_counter, 0U);
  EXPECT_EQ(bus.write(0, 0x0134, bytes({8, 0})).working_counter, 0U);
  host_write(bus.slave(), 0x0130, bytes({0x12, 0}));
  host_write(bus.slave(), 0x0134, bytes({0x16, 0}));
  EXPECT_EQ(bus.read(0, 0x0130, 6).data, bytes({0x12, 0, 0, 0, 0x16, 0}));
}

class LastRule final : public base::EventSink {
 public:
  void on_event(const base::Event& event) override { sentence = base::to_sentence(event); }
  std::string sentence;
};

TEST(AlControl, ARefusedWriteExplainsItself) {
  TestBus bus;
  LastRule sink;
  bus.slave().set_event_reporter(base::EventReporter(&sink, 0));
  host_read(bus.slave(), 0x0130, 2);  // it is there
  bus.write(0, 0x0120, bytes({0x02, 0}));
  EXPECT_EQ(sink.sentence, "");
  bus.write(0, 0x0120, bytes({0x04, 0}));
  EXPECT_EQ(sink.sentence,
            "AL control write of 0004h refused: the host has not read the request before (0002h) "
            "yet; wait for AL status, then write again");
}

}  // namespace
}  // namespace stator::ethercat

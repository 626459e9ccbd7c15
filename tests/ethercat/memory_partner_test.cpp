#include "stator/ethercat/controller/memory_partner.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "ethercat/test_bus.hpp"
#include "stator/base/byte_order.hpp"

namespace stator::ethercat {
namespace {

using testing::Bytes;
using testing::bytes;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::TestBus;

/// Notes what it is told; before a read of 0x2000 it puts a count there.
class Witness final : public MemoryPartner {
 public:
  explicit Witness(SlaveController& controller) : controller_(controller) {
    controller.set_memory_partner(this);
  }
  std::vector<std::string> take() { return std::exchange(told_, {}); }
  bool counts = false;

  void start_of_frame(base::SimTime) override { told_.emplace_back("start"); }
  void end_of_frame(base::SimTime) override { told_.emplace_back("end"); }
  void before_bus_read(base::SimTime, std::uint16_t address, std::size_t length) override {
    note("read", address, length);
    if (counts) {
      ++count_;
      controller_.write_process_data(0x2001, bytes({count_}));
      controller_.finish_process_data(0x2000, 4);
    }
  }
  void after_bus_write(base::SimTime, std::uint16_t address, std::size_t length) override {
    note("write", address, length);
  }
  void parameters_changed(base::SimTime) override { told_.emplace_back("parameters"); }
  void al_status_changed(base::SimTime, std::uint16_t al_status) override {
    told_.push_back("al " + std::to_string(al_status));
  }
  void controller_reset(base::SimTime) override { told_.emplace_back("reset"); }

 private:
  void note(const std::string& what, unsigned address, std::size_t length) {
    told_.push_back(what + " " + std::to_string(address) + " " + std::to_string(length));
  }
  SlaveController& controller_;
  std::vector<std::string> told_;
  unsigned count_ = 0;
};

SlaveControllerConfiguration emulating() {
  SlaveControllerConfiguration configuration;
  configuration.device_emulation = true;
  return configuration;
}

TEST(MemoryPartner, IsToldOfFramesAndAccessesInOrder) {
  TestBus bus;
  Witness witness(bus.slave());
  bus.write(0, 0x1100, bytes({1, 2, 3}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "write 4352 3", "end"));
  bus.read(0, 0x1100, 2);
  EXPECT_THAT(witness.take(), ElementsAre("start", "read 4352 2", "end"));
  bus.read(0, 0x0130, 2);
  EXPECT_THAT(witness.take(), ElementsAre("start", "end"));
}

TEST(MemoryPartner, IsToldOfParametersFromEitherSideAndFromTheEeprom) {
  TestBus bus;
  Witness witness(bus.slave());
  bus.write(0, 0x05E1, bytes({1}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "parameters", "end"));
  bus.slave().write(0x0580, bytes({1}));
  EXPECT_THAT(witness.take(), ElementsAre("parameters"));
  bus.write(0, 0x0510, bytes({0}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "end"));
  bus.slave().load_sii(testing::valid_sii());
  EXPECT_THAT(witness.take(), ElementsAre("parameters"));
  bus.slave().power_on_reset();
  EXPECT_THAT(witness.take(), ElementsAre("reset", "parameters"));
}

TEST(MemoryPartner, IsToldOfEachNewAlStatus) {
  TestBus bus(1, emulating());
  Witness witness(bus.slave());
  bus.write(0, 0x0120, bytes({2, 0}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "al 2", "end"));
  bus.write(0, 0x0120, bytes({2, 0}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "end"));
}

TEST(MemoryPartner, OfABufferedAreaSeesTheNewestCompleteBufferAndLeavesItToTheHost) {
  TestBus bus;
  bus.set_sync_manager(0, 2, {.start = 0x1000, .length = 4, .control = 0x24});
  Witness witness(bus.slave());
  const auto seen = [&] {
    Bytes out(4);
    bus.slave().read_process_data(0x1000, out);
    return out;
  };
  bus.write(0, 0x1000, bytes({1, 2}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "end")) << "not complete yet";
  EXPECT_EQ(seen(), bytes({0, 0, 0, 0}));
  bus.write(0, 0x1002, bytes({3, 4}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "write 4096 4", "end"));
  EXPECT_EQ(seen(), bytes({1, 2, 3, 4}));
  bus.slave().finish_process_data(0x1000, 4);
  EXPECT_NE(bus.slave().al_event_request() & al_event::sync_manager(2), 0U)
      << "still new for the host";
  Bytes host(4);
  bus.slave().read(0x1000, host);
  EXPECT_EQ(host, bytes({1, 2, 3, 4}));
  EXPECT_EQ(seen(), host) << "taken by the host, but still the newest";
}

TEST(MemoryPartner, WritesBetweenTheBytesOfTheHost) {
  TestBus bus;
  bus.set_sync_manager(0, 3, {.start = 0x2000, .length = 4, .control = 0x20});
  Witness witness(bus.slave());
  witness.counts = true;
  bus.slave().write(0x2000, bytes({0xA0, 0, 0xA2, 0xA3}));
  EXPECT_EQ(bus.read(0, 0x2000, 4).data, bytes({0xA0, 1, 0xA2, 0xA3}));
  EXPECT_EQ(bus.read(0, 0x2000, 4).data, bytes({0xA0, 2, 0xA2, 0xA3}));
  bus.slave().write(0x2000, bytes({0xB0, 0, 0xB2, 0xB3}));
  EXPECT_EQ(bus.read(0, 0x2000, 4).data, bytes({0xB0, 3, 0xB2, 0xB3}));
}

TEST(MemoryPartner, InDeviceEmulation_FillsAndEmptiesOneBufferAreas) {
  TestBus bus(1, emulating());
  bus.set_sync_manager(0, 0, {.start = 0x1000, .length = 2, .control = 0x26});
  bus.set_sync_manager(0, 1, {.start = 0x2000, .length = 4, .control = 0x22});
  Witness witness(bus.slave());
  witness.counts = true;
  EXPECT_EQ(bus.write(0, 0x1000, bytes({1, 2})).working_counter, 1);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({3, 4})).working_counter, 0) << "full";
  bus.slave().finish_process_data(0x1000, 2);
  EXPECT_EQ(bus.write(0, 0x1000, bytes({3, 4})).working_counter, 1);
  EXPECT_EQ(bus.read(0, 0x2000, 4).working_counter, 1);
  EXPECT_EQ(bus.read(0, 0x2000, 4).data, bytes({0, 2, 0, 0}));
}

TEST(MemoryPartner, SeesLogicalAccessesToo) {
  TestBus bus;
  bus.set_sync_manager(0, 3, {.start = 0x2000, .length = 4, .control = 0x20});
  bus.set_fmmu(0, 0, {.logical = 0x10000, .length = 4, .physical = 0x2000, .type = 1});
  Witness witness(bus.slave());
  witness.counts = true;
  witness.take();
  const auto answer = bus.transfer(Command::lrd, 0x10000, testing::zeros(4));
  EXPECT_EQ(answer.working_counter, 1);
  EXPECT_EQ(answer.data, bytes({0, 1, 0, 0}));
  EXPECT_THAT(witness.take(), ElementsAre("start", "read 8192 4", "end"));
}

}  // namespace
}  // namespace stator::ethercat

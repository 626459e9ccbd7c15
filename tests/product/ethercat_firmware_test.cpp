// A product of a few lines on the shell that all EtherCAT products share.

#include "stator/product/shell/ethercat_firmware.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "devices/sentences.hpp"
#include "devices/test_bus.hpp"
#include "stator/product/shell/boot_loading.hpp"

namespace stator::product {
namespace {

using namespace base::literals;
using ethercat::AlState;
using testing::ElementsAre;

constexpr auto kLampObjects = std::to_array<dictionary::EntryDeclaration>({
    {.index = 0x6000,
     .name = "Light",
     .type = dictionary::DataType::unsigned16,
     .access = dictionary::Access::read_only,
     .mapping = dictionary::PdoMapping::transmit},
    {.index = 0x7000,
     .name = "Dimming",
     .type = dictionary::DataType::unsigned16,
     .mapping = dictionary::PdoMapping::receive},
});

ethercat::DeviceDescription lamp_description() {
  ethercat::DeviceDescription description;
  description.vendor_id = 0x1234;
  description.product_code = 7;
  description.revision = 3;
  description.name = "Lamp";
  description.receive_mailbox = {0x1000, 128};
  description.transmit_mailbox = {0x1080, 128};
  description.output_offset = 0x1200;
  description.input_offset = 0x1300;
  description.coe = true;
  description.distributed_clocks = true;
  description.pdi_control = 0x0C05;  // SPI; SYNC and latch units
  description.sync_latch_configuration = 0x66;
  description.sync_pulse_length = 1000;
  return description;
}

/// Notes when it is asked to do what.
class DimmedLamp final : public EtherCatFirmware {
 public:
  static constexpr base::SimDuration kStep{250'000};

  explicit DimmedLamp(const EtherCatFirmwareRules& rules = {})
      : EtherCatFirmware({.description = lamp_description(),
                          .stack = {.distributed_clocks = {.sync0 = true,
                                                           .shortest_cycle = 100_us,
                                                           .longest_cycle = 1_s}},
                          .rules = rules},
                         [](dictionary::Dictionary& objects) { objects.add(kLampObjects); }, {}),
        light_(objects().variable<std::uint16_t>(0x6000)),
        dimming_(objects().variable<std::uint16_t>(0x7000)) {
    restart_firmware(base::SimTime());
    calls.clear();
  }

  [[nodiscard]] std::vector<Signal> signals() const override { return {}; }

  std::vector<std::string> calls;

 private:
  void note(const char* what, base::SimTime now) {
    calls.push_back(what + (' ' + std::to_string(now.nanoseconds() / 1000)));
  }
  void restart(base::SimTime now) override { note("restart", now); }
  void tick(base::SimTime now) override {
    note("tick", now);
    light_.set(static_cast<std::uint16_t>(5 * dimming_.get()));
  }
  void step_world(base::SimTime until) override {
    for (; world_ + kStep <= until; world_ += kStep) {
      note("step", world_ + kStep);
    }
  }
  void at_sync0(base::SimTime now) override { note("sync0", now); }
  void network_operational(bool operational, base::SimTime now) override {
    note(operational ? "operational" : "not operational", now);
  }

  dictionary::Variable<std::uint16_t> light_;
  dictionary::Variable<std::uint16_t> dimming_;
  base::SimTime world_;
};

TEST(EtherCatFirmware, ExchangesWhatItsFewObjectsSay) {
  DimmedLamp lamp;
  tests::TestBus bus(lamp);
  bus.set_output_length(2);
  bus.set_input_length(2);
  bus.bring_to(AlState::operational);
  bus.outputs[0] = std::byte{30};
  bus.exchange();
  EXPECT_EQ(lamp.dictionary().find(0x7000, 0)->value(), 30U);
  bus.pass(1_ms);
  EXPECT_EQ(lamp.dictionary().find(0x6000, 0)->value(), 150U);
  bus.exchange();
  EXPECT_EQ(base::load_le<std::uint16_t>(bus.inputs, 0), 150);
}

TEST(EtherCatFirmware, HasTheObjectsThatFollowFromWhatItIs) {
  DimmedLamp lamp;
  tests::TestBus bus(lamp);
  bus.bring_to(AlState::pre_operational);
  EXPECT_EQ(bus.upload<std::uint32_t>(0x1000), 0U);
  EXPECT_EQ(bus.upload<std::uint8_t>(0x1001), 0U);
  EXPECT_EQ(lamp.dictionary().find(0x1008, 0)->text(), "Lamp");
  EXPECT_EQ(bus.upload<std::uint32_t>(0x1018, 1), 0x1234U);
  EXPECT_EQ(bus.upload<std::uint32_t>(0x1018, 2), 7U);
  EXPECT_EQ(bus.upload<std::uint32_t>(0x1018, 3), 3U);
  EXPECT_EQ(bus.upload<std::uint8_t>(0x1C00), 4U);
  EXPECT_EQ(bus.upload<std::uint16_t>(0x1C12, 1), 0x1600U);
  EXPECT_EQ(bus.upload<std::uint32_t>(0x1600, 1), 0x70000010U);
  EXPECT_EQ(bus.upload<std::uint16_t>(0x1C13, 1), 0x1A00U);
  EXPECT_EQ(bus.upload<std::uint32_t>(0x1A00, 1), 0x60000010U);
}

TEST(EtherCatFirmware, AStepThatEndsWithAPeriodComesBeforeItsTickOrBehindIt) {
  DimmedLamp before;
  before.advance(base::SimTime() + 1_ms);
  EXPECT_THAT(before.calls,
              ElementsAre("step 250", "step 500", "step 750", "step 1000", "tick 1000"));
  DimmedLamp behind({.step_before_tick = false});
  behind.advance(base::SimTime() + 1_ms);
  EXPECT_THAT(behind.calls,
              ElementsAre("step 250", "step 500", "step 750", "tick 1000", "step 1000"));
}

/// Synchronised with SYNC0 every millisecond from a multiple of one on. Returns the first one.
base::SimTime synchronise(tests::TestBus& bus, DimmedLamp& lamp) {
  bus.set_output_length(2);
  bus.set_input_length(2);
  bus.bring_to(AlState::pre_operational);
  bus.write(0x0420, {std::byte{0}, std::byte{0}});
  const base::SimTime first = base::SimTime() + 8_ms;
  std::array<std::byte, 16> registers{};
  base::store_le(registers, 0,
                 lamp.controller().system_time(bus.now()) +
                     static_cast<std::uint64_t>((first - bus.now()).nanoseconds()));
  bus.write(0x0990, {registers.begin(), registers.begin() + 8});
  base::store_le(registers, 0, std::uint32_t{1'000'000});
  bus.write(0x09A0, {registers.begin(), registers.begin() + 4});
  bus.write(0x0980, {std::byte{0}, std::byte{3}});
  bus.bring_to(AlState::safe_operational);
  EXPECT_LT(bus.now(), first);
  return first;
}

TEST(EtherCatFirmware, Sync0ComesFirst) {
  DimmedLamp lamp;
  tests::TestBus bus(lamp);
  const base::SimTime first = synchronise(bus, lamp);
  bus.pass(first - base::SimDuration(1) - bus.now());
  lamp.calls.clear();
  bus.pass(base::SimDuration(1));
  EXPECT_THAT(lamp.calls, ElementsAre("sync0 8000", "step 8000", "tick 8000"));
}

TEST(EtherCatFirmware, PeriodsFollowSync0AndWaitForItHalfAPeriod) {
  DimmedLamp lamp({.periods_follow_sync0 = true});
  tests::TestBus bus(lamp);
  const base::SimTime first = synchronise(bus, lamp);
  bus.pass(first + 1'600_us - bus.now());
  lamp.calls.clear();
  bus.write(0x0981, {std::byte{0}});  // no more SYNC0
  bus.pass(first + 3_ms - bus.now());
  std::erase_if(lamp.calls, [](const std::string& call) { return call.starts_with("step"); });
  EXPECT_THAT(lamp.calls, ElementsAre("tick 10500"));
}

TEST(EtherCatFirmware, WithoutPowerNothingButTheWorldGoesOn) {
  DimmedLamp lamp;
  tests::TestBus bus(lamp);
  bus.set_output_length(2);
  bus.set_input_length(2);
  bus.bring_to(AlState::operational);
  lamp.calls.clear();
  const base::SimTime off = bus.now();
  lamp.set_power(false, off);
  bus.pass(500_us);
  lamp.set_power(true, bus.now());
  EXPECT_EQ(lamp.calls.front(), "restart " + std::to_string(off.nanoseconds() / 1000));
  EXPECT_EQ(lamp.calls.back(), "restart " + std::to_string(bus.now().nanoseconds() / 1000));
  EXPECT_EQ(lamp.slave_stack()->state(), AlState::init);
}

TEST(EtherCatFirmware, TellsOfANewImageInItsOwnWordsOrInThoseOfAll) {
  static constexpr base::EventRule kOwn{"lamp-new-image", base::Severity::information,
                                        "the lamp has {0} bytes of new firmware"};
  tests::Sentences told;
  const base::EventReporter reporter(&told, 0);
  report_new_firmware(12, &kOwn, reporter, base::SimTime());
  report_new_firmware(34, nullptr, reporter, base::SimTime());
  EXPECT_EQ(told.count("the lamp has 12 bytes of new firmware"), 1);
  EXPECT_EQ(told.count("restarting with a new firmware image, 34 bytes"), 1);
}

}  // namespace
}  // namespace stator::product

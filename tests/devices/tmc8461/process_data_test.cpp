// A TMC8461 without a controller: its EEPROM maps the I/O block into process data, as a master sees
// it.
#include <gmock/gmock.h>

#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/tmc8461/block_on_controller.hpp"
#include "stator/devices/tmc8461/sii.hpp"

namespace stator::devices::tmc8461 {
namespace {

using ethercat::testing::Bytes;
using ethercat::testing::bytes;
using ethercat::testing::TestBus;
using mfc::Signal;
using namespace mfc::register_number;

constexpr std::uint32_t kLogicalOutputs = 0x10000;
constexpr std::uint32_t kLogicalInputs = 0x20000;

/// A chip without a controller, set up from its EEPROM, and a master.
class Standalone : public ::testing::Test {
 protected:
  Standalone() {
    configuration.set_block_start(0, 0x1000);
    configuration.set_block_start(1, 0x1200);
    map(kGpo);
    map(kGpioConfig);
    map(kXEncPreset);
    map(kGpi);
    map(kPositionRead);
    map(kSyncEventCount);
    connect(0, Signal::gpo0);
    connect(1, Signal::gpi0);
    connect(2, Signal::a);
    connect(3, Signal::b);
    chip.load_sii(ethercat::compose_sii_image(sii_contents(configuration, {})));
  }

  static constexpr std::uint8_t kXEncPreset = kPositionWrite;
  void map(std::uint8_t number, mfc::Trigger trigger = mfc::Trigger::always) {
    configuration.set_mapping(number, {true, trigger});
  }
  void connect(std::size_t line, Signal signal) {
    configuration.set_signal(line, static_cast<std::uint8_t>(signal));
  }
  void request(unsigned state) {
    bus.write(0, 0x0120, bytes({state, 0}));
    EXPECT_EQ(bus.read(0, 0x0130, 1).data, bytes({state}));
  }
  /// As masters do it, from the EEPROM's sync managers.
  void map_process_data() {
    const auto contents = ethercat::parse_sii_image(chip.sii());
    for (unsigned i = 0; i < 2; ++i) {
      const ethercat::SiiSyncManager& manager = contents->sync_managers[i];
      bus.set_sync_manager(
          0, i, {.start = manager.start, .length = manager.length, .control = manager.control});
      bus.set_fmmu(0, i,
                   {.logical = i == 0 ? kLogicalOutputs : kLogicalInputs,
                    .length = manager.length,
                    .physical = manager.start,
                    .type = static_cast<std::uint8_t>(i == 0 ? 2 : 1)});
    }
  }
  void outputs(std::int32_t position, std::uint32_t gpo, std::uint16_t enable) {
    Bytes data(12);
    base::store_le(data.data(), position);
    base::store_le(data.data() + 4, gpo);
    base::store_le(data.data() + 8, enable);
    EXPECT_EQ(bus.transfer(ethercat::Command::lwr, kLogicalOutputs, data).working_counter, 1);
  }
  struct Inputs {
    std::int32_t position;
    std::uint16_t gpi;
    std::uint32_t sync_counts;
  };
  Inputs inputs() {
    const auto answer = bus.transfer(ethercat::Command::lrd, kLogicalInputs, Bytes(12));
    EXPECT_EQ(answer.working_counter, 1);
    return {base::load_le<std::int32_t>(answer.data.data()),
            base::load_le<std::uint16_t>(answer.data.data() + 4),
            base::load_le<std::uint32_t>(answer.data.data() + 8)};
  }

  static ethercat::SlaveControllerConfiguration preset() {
    return ethercat::testing::controller_of("tmc8461");
  }
  mfc::Configuration configuration;
  TestBus bus{1, preset()};
  ethercat::SlaveController& chip = bus.slave();
  mfc::Block block;
  BlockOnController halves{chip, block};
};

TEST_F(Standalone, EepromConfiguresThePinsAndTheMap) {
  EXPECT_EQ(block.signal(0), Signal::gpo0);
  EXPECT_TRUE(block.memory_map().mapped(kGpo));
  EXPECT_EQ(block.memory_map().block(1).start, 0x1200U);
}

TEST_F(Standalone, MasterDrivesPinsInOperationalOnly) {
  map_process_data();
  request(2);
  request(4);
  outputs(0, 1, 1);
  EXPECT_EQ(block.pin(0), mfc::PinState::floating);
  request(8);
  outputs(0, 1, 1);
  EXPECT_EQ(block.pin(0), mfc::PinState::high);
  outputs(0, 0, 1);
  EXPECT_EQ(block.pin(0), mfc::PinState::low);
  request(4);
  EXPECT_EQ(block.pin(0), mfc::PinState::floating);
}

TEST_F(Standalone, MasterReadsPinsFromSafeOperationalOn) {
  map_process_data();
  request(2);
  block.drive(1, mfc::OutsideDrive::level(true), block.now());
  EXPECT_EQ(inputs().gpi, 0);
  request(4);
  EXPECT_EQ(inputs().gpi, 1);
  block.drive(1, mfc::OutsideDrive::level(false), block.now());
  EXPECT_EQ(inputs().gpi, 0);
}

TEST_F(Standalone, MasterReadsAndPresetsTheEncoder) {
  map_process_data();
  request(2);
  request(4);
  request(8);
  outputs(1000, 0, 0);
  EXPECT_EQ(inputs().position, 1000);
  block.drive(2, mfc::OutsideDrive::level(true), block.now());
  block.drive(3, mfc::OutsideDrive::level(true), block.now());
  EXPECT_EQ(std::abs(inputs().position - 1000), 2);
  outputs(-5, 0, 0);
  EXPECT_EQ(inputs().position, -5);
}

TEST_F(Standalone, ParametersCanBeWrittenOnline) {
  request(2);
  request(4);
  request(8);
  bus.write(0, 0x0580 + 7, bytes({2}));
  EXPECT_EQ(block.signal(7), Signal::high);
  EXPECT_EQ(block.pin(7), mfc::PinState::high);
  chip.write(0x0580 + 7, bytes({1}));
  EXPECT_EQ(block.pin(7), mfc::PinState::low);
}

TEST_F(Standalone, ResetOfTheControllerResetsTheBlockAndLoadsItAgain) {
  request(2);
  bus.write(0, 0x0580 + 7, bytes({2}));
  for (const unsigned key : {0x52U, 0x45U, 0x53U}) {
    bus.write(0, 0x0040, bytes({key}));
  }
  EXPECT_EQ(block.signal(7), Signal::zero);
  EXPECT_EQ(block.signal(0), Signal::gpo0);
}

TEST_F(Standalone, SyncPulsesAreCountedAndTriggerTransfersInTime) {
  map(kGpi, mfc::Trigger::sync0);
  chip.load_sii(ethercat::compose_sii_image(sii_contents(configuration, {})));
  map_process_data();
  request(2);
  request(4);
  Bytes cycle(4);
  base::store_le(cycle.data(), std::uint32_t{1'000'000});
  bus.write(0, 0x09A0, cycle);
  const auto answer = bus.read(0, 0x0910, 8);
  const auto now = base::load_le<std::uint64_t>(answer.data.data());
  Bytes start(8);
  base::store_le(start.data(), now + 1'000'000);
  bus.write(0, 0x0990, start);
  bus.write(0, 0x0981, bytes({0x03}));
  const base::SimTime begin = bus.now();
  EXPECT_LT(halves.next_event(), begin + base::SimDuration(1'000'000));
  block.drive(1, mfc::OutsideDrive::level(true), block.now());
  EXPECT_EQ(inputs().gpi, 0) << "not before SYNC0";
  halves.advance(begin + base::SimDuration(5'500'000));
  bus.wait(base::SimDuration(5'500'000));
  const Inputs seen = inputs();
  EXPECT_EQ(seen.gpi, 1);
  EXPECT_EQ(seen.sync_counts & 0xFFFF, 5U);
}

TEST_F(Standalone, LatchEdgesTriggerTransfers) {
  map(kGpi, mfc::Trigger::latch1);
  chip.load_sii(ethercat::compose_sii_image(sii_contents(configuration, {})));
  map_process_data();
  request(2);
  request(4);
  block.drive(1, mfc::OutsideDrive::level(true), block.now());
  halves.set_latch_input(0, true);
  EXPECT_EQ(inputs().gpi, 0);
  halves.set_latch_input(1, true);
  EXPECT_EQ(inputs().gpi, 1);
}

TEST_F(Standalone, WithoutFramesTheWatchdogPutsPinsIntoTheirSafeState) {
  map_process_data();
  request(2);
  request(4);
  request(8);
  const auto set = [this](std::uint8_t number, const Bytes& data) {
    block.write(mfc::kRegisters[number].spi_address(), data);
  };
  set(kWdOutMaskPol, bytes({0, 0, 0, 0, 1, 0, 0, 0}));
  set(kWdOePol, bytes({1, 0, 0, 0}));
  set(kWdCfg, bytes({0x08}));
  set(kWdTime, bytes({0xA8, 0x61, 0, 0}));  // 25000: 1 ms
  outputs(0, 1, 1);
  halves.advance(bus.now() + base::SimDuration(900'000));
  EXPECT_EQ(block.pin(0), mfc::PinState::high);
  halves.advance(bus.now() + base::SimDuration(1'100'000));
  EXPECT_EQ(block.pin(0), mfc::PinState::low);
  bus.wait(base::SimDuration(1'100'000));
  outputs(0, 1, 1);
  EXPECT_EQ(block.pin(0), mfc::PinState::high);
}

TEST_F(Standalone, WithoutTheBlocksWatchdogOutputsOutliveTheOneOfProcessData) {
  map_process_data();
  request(2);
  request(4);
  request(8);
  outputs(0, 1, 1);
  EXPECT_TRUE(chip.process_data_watchdog_state());
  bus.wait(base::SimDuration(200'000'000));
  halves.advance(bus.now());
  EXPECT_FALSE(chip.process_data_watchdog_state());
  EXPECT_EQ(bus.read(0, 0x0130, 1).data, bytes({8})) << "nobody leaves Operational for it";
  EXPECT_EQ(block.pin(0), mfc::PinState::high);
}

}  // namespace
}  // namespace stator::devices::tmc8461

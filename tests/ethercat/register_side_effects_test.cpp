// One probe for each row of the table of side effects made from the TMC8670 datasheet.

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"
#include "source_paths.hpp"
#include "stator/devices/tmc8670/tmc8670.hpp"

namespace stator::ethercat {
namespace {

using base::literals::operator""_ms;
using base::literals::operator""_us;
using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr std::uint32_t kAlControlEvent = 1U << 0;
constexpr std::uint32_t kActivationEvent = 1U << 4;
constexpr std::uint32_t kWatchdogEvent = 1U << 6;

SlaveControllerConfiguration chip() {
  return testing::controller_of("tmc8670", "document");
}
SlaveControllerConfiguration acknowledging_by_write() {
  SlaveControllerConfiguration configuration = chip();
  configuration.acknowledge_by_write = true;
  return configuration;
}
SlaveControllerConfiguration emulating() {
  SlaveControllerConfiguration configuration = chip();
  configuration.device_emulation = true;
  return configuration;
}

/// One TMC8670 on a bus, with shorthands for what probes do.
struct Probe {
  explicit Probe(const SlaveControllerConfiguration& configuration = chip())
      : bus(1, configuration), slave(bus.slave()) {}

  unsigned get(std::uint16_t address, std::size_t length = 1) {
    return static_cast<unsigned>(number(bus.read(0, address, length).data));
  }
  unsigned set(std::uint16_t address, const Bytes& data) {
    return bus.write(0, address, data).working_counter;
  }
  [[nodiscard]] bool event(std::uint32_t bit) const {
    return (slave.al_event_request() & bit) != 0;
  }
  bool ecat_event(unsigned bit) { return (get(0x0210, 2) >> bit & 1U) != 0; }

  TestBus bus;
  SlaveController& slave;
};

struct SideEffect {
  const char* register_name;  ///< the first columns of the row that is probed
  const char* actor;
  const char* access;
  const char* condition;
  void (*check)();
};

void count_every_error(Probe& probe) {
  for (const unsigned port : {0U, 1U}) {
    probe.slave.count_receive_error(port, ReceiveError::invalid_frame);
    probe.slave.count_receive_error(port, ReceiveError::physical);
    probe.slave.count_receive_error(port, ReceiveError::forwarded_error);
  }
  probe.slave.count_malformed_frame();
  probe.slave.count_host_error(0x1B);
  probe.slave.set_link(0, false);
  probe.slave.set_link(0, true);
}

/// What is left of all counters after a write of 0xAA to `address`: one character per group.
std::string left_after_writing(std::uint16_t address) {
  Probe probe;
  count_every_error(probe);
  EXPECT_EQ(probe.set(address, bytes({0xAA})), address == 0x030E ? 0U : 1U);
  const auto shown = [&](std::uint16_t first, std::size_t length) {
    const Bytes group = probe.bus.read(0, first, length).data;
    return std::all_of(group.begin(), group.end(), [](std::byte b) { return b == std::byte{0}; })
               ? '0'
               : '1';
  };
  return {shown(0x0300, 12), shown(0x030C, 1), shown(0x030D, 1), shown(0x030E, 1),
          shown(0x0310, 4)};
}

void start_watchdogs_and_let_them_expire(Probe& probe) {
  probe.bus.set_sync_manager(0, 2, {.start = 0x1100, .length = 2, .control = 0x64});
  probe.set(0x1100, bytes({1, 2}));
  probe.slave.set_host_polling(false);
  probe.bus.wait(150_ms);
}

void offer_eeprom_to_host(Probe& probe) {
  probe.set(0x0500, bytes({1}));
  host_write(probe.slave, 0x0501, bytes({1}));
}

void mailbox(Probe& probe) {
  probe.bus.set_sync_manager(0, 0, {.start = 0x1000, .length = 4, .control = 0x26});
}

const std::vector<SideEffect>& probes() {
  static const std::vector<SideEffect> kTable{
      {"0x0110:0x0111", "ECAT", "read", "any",
       [] {
         Probe probe;
         EXPECT_TRUE(probe.ecat_event(2)) << "the link came up";
         probe.get(0x0111);
         EXPECT_FALSE(probe.ecat_event(2));
       }},
      {"0x0130:0x0131", "ECAT", "read", "any",
       [] {
         Probe probe;
         host_write(probe.slave, 0x0130, bytes({2, 0}));
         EXPECT_TRUE(probe.ecat_event(3));
         host_read(probe.slave, 0x0130, 2);
         EXPECT_TRUE(probe.ecat_event(3)) << "the host's reading does not count";
         probe.get(0x0130, 2);
         EXPECT_FALSE(probe.ecat_event(3));
       }},
      {"0x0120:0x0121", "ECAT", "write", "device emulation off and previous value taken by PDI",
       [] {
         Probe probe;
         EXPECT_EQ(probe.set(0x0120, bytes({2, 0})), 1U);
         EXPECT_TRUE(probe.event(kAlControlEvent));
         EXPECT_EQ(probe.get(0x0120, 2), 2U);
       }},
      {"0x0120:0x0121", "ECAT", "write", "device emulation off and previous value not yet taken",
       [] {
         Probe probe;
         probe.set(0x0120, bytes({2, 0}));
         EXPECT_EQ(probe.set(0x0120, bytes({4, 0})), 0U);
         EXPECT_EQ(probe.get(0x0120, 2), 2U);
       }},
      {"0x0120:0x0121", "ECAT", "write", "device emulation on",
       [] {
         Probe probe(emulating());
         for (const unsigned state : {2U, 4U, 8U}) {
           EXPECT_EQ(probe.set(0x0120, bytes({state, 0})), 1U);
           EXPECT_EQ(probe.get(0x0130, 2), state);
         }
         EXPECT_FALSE(probe.event(kAlControlEvent));
       }},
      {"0x0120 or 0x0121", "PDI", "read", "write-acknowledge disabled",
       [] {
         for (const std::uint16_t byte : {std::uint16_t{0x0120}, std::uint16_t{0x0121}}) {
           Probe probe;
           probe.set(0x0120, bytes({2, 0}));
           host_read(probe.slave, byte, 1);
           EXPECT_FALSE(probe.event(kAlControlEvent));
           EXPECT_EQ(probe.set(0x0120, bytes({4, 0})), 1U);
         }
       }},
      {"0x0120 or 0x0121", "PDI", "write", "write-acknowledge enabled",
       [] {
         Probe probe(acknowledging_by_write());
         probe.set(0x0120, bytes({2, 0}));
         host_read(probe.slave, 0x0120, 2);
         EXPECT_TRUE(probe.event(kAlControlEvent));
         host_write(probe.slave, 0x0121, bytes({0xFF}));
         EXPECT_FALSE(probe.event(kAlControlEvent));
         EXPECT_EQ(probe.get(0x0120, 2), 2U) << "the value written is ignored";
         EXPECT_EQ(probe.set(0x0120, bytes({4, 0})), 1U);
       }},
      {"0x0120:0x0121", "PDI", "write", "write-acknowledge disabled",
       [] {
         Probe probe;
         probe.set(0x0120, bytes({2, 0}));
         host_write(probe.slave, 0x0120, bytes({8, 0}));
         EXPECT_TRUE(probe.event(kAlControlEvent));
         EXPECT_EQ(probe.get(0x0120, 2), 2U);
       }},
      {"0x0130:0x0131", "PDI", "write", "device emulation off",
       [] {
         Probe probe;
         probe.set(0x0138, bytes({0x1F}));
         host_write(probe.slave, 0x0130, bytes({2, 0}));
         EXPECT_EQ(probe.get(0x0138) & 0x10U, 0U);
         EXPECT_TRUE(probe.ecat_event(3));
         EXPECT_EQ(probe.get(0x0130, 2), 2U);
       }},
      {"0x0130:0x0131", "PDI", "write", "device emulation on",
       [] {
         Probe probe(emulating());
         host_write(probe.slave, 0x0130, bytes({8, 0}));
         EXPECT_EQ(probe.get(0x0130, 2), 1U);
       }},
      {"0x0139", "device", "event", "new error condition",
       [] {
         Probe probe;
         probe.set(0x0139, bytes({0x1F}));
         host_write(probe.slave, 0x0130, bytes({0x11, 0}));
         EXPECT_EQ(probe.get(0x0139) & 0x10U, 0U);
       }},
      {"0x0020", "ECAT", "write", "register protection on",
       [] {
         Probe probe;
         probe.set(0x0021, bytes({1}));
         probe.bus.with(Command::apwr, physical_address(0, 0x0010), bytes({1, 0}))
             .with(Command::apwr, physical_address(0, 0x0020), bytes({0}))
             .with(Command::apwr, physical_address(0, 0x0010), bytes({2, 0}))
             .with(Command::apwr, physical_address(0, 0x0012), bytes({2, 0}));
         const auto answers = probe.bus.send();
         EXPECT_EQ(answers[0].working_counter, 0U) << "not yet";
         EXPECT_EQ(answers[1].working_counter, 1U);
         EXPECT_EQ(answers[2].working_counter, 1U);
         EXPECT_EQ(answers[3].working_counter, 0U) << "rights stay rights";
         EXPECT_EQ(probe.set(0x0010, bytes({3, 0})), 0U) << "the next frame";
         EXPECT_EQ(probe.set(0x0138, bytes({0x1F})), 1U) << "outside the protected range";
         EXPECT_EQ(probe.set(0x0F80, bytes({1})), 1U);
         EXPECT_EQ(probe.set(0x1000, bytes({1})), 1U);
       }},
      {"0x0030", "ECAT", "write", "ESC write protection on",
       [] {
         Probe probe;
         probe.set(0x0031, bytes({1}));
         EXPECT_EQ(probe.set(0x1000, bytes({1})), 0U);
         EXPECT_EQ(probe.set(0x0138, bytes({0x1F})), 0U);
         EXPECT_EQ(probe.set(0x0020, bytes({0})), 0U);
         probe.bus.with(Command::apwr, physical_address(0, 0x0030), bytes({0}))
             .with(Command::apwr, physical_address(0, 0x1000), bytes({2}));
         EXPECT_EQ(probe.bus.send()[1].working_counter, 1U);
         EXPECT_EQ(probe.set(0x1000, bytes({1})), 0U) << "the next frame";
         host_write(probe.slave, 0x1000, bytes({9}));
         EXPECT_EQ(probe.get(0x1000), 9U) << "the host is not concerned";
       }},
      {"0x0300-0x030B", "ECAT", "write", "any byte, any value",
       [] {
         EXPECT_EQ(left_after_writing(0x0300), "01111");
         EXPECT_EQ(left_after_writing(0x0309), "01111");
       }},
      {"0x030C", "ECAT", "write", "any value",
       [] { EXPECT_EQ(left_after_writing(0x030C), "10111"); }},
      {"0x030D", "ECAT", "write", "any value",
       [] {
         EXPECT_EQ(left_after_writing(0x030D), "11001");
         EXPECT_EQ(left_after_writing(0x030E), "11111") << "the code itself is read only";
       }},
      {"0x0310-0x0313", "ECAT", "write", "any byte, any value",
       [] { EXPECT_EQ(left_after_writing(0x0312), "11110"); }},
      {"0x0442-0x0443", "ECAT", "write", "any byte, any value",
       [] {
         for (const std::uint16_t byte : {std::uint16_t{0x0442}, std::uint16_t{0x0443}}) {
           Probe probe;
           start_watchdogs_and_let_them_expire(probe);
           EXPECT_EQ(probe.get(0x0442, 2), 0x0101U);
           EXPECT_EQ(probe.set(byte, bytes({0x55})), 1U);
           EXPECT_EQ(probe.get(0x0442, 2), 0U);
         }
       }},
      {"0x0440:0x0441", "PDI", "read", "write-acknowledge disabled",
       [] {
         Probe probe;
         start_watchdogs_and_let_them_expire(probe);
         EXPECT_TRUE(probe.event(kWatchdogEvent));
         probe.get(0x0440, 2);
         EXPECT_TRUE(probe.event(kWatchdogEvent));
         EXPECT_EQ(host_read(probe.slave, 0x0440, 2), zeros(2));
         EXPECT_FALSE(probe.event(kWatchdogEvent));
       }},
      {"0x0440:0x0441", "PDI", "write", "write-acknowledge enabled",
       [] {
         Probe probe(acknowledging_by_write());
         start_watchdogs_and_let_them_expire(probe);
         host_read(probe.slave, 0x0440, 2);
         EXPECT_TRUE(probe.event(kWatchdogEvent));
         host_write(probe.slave, 0x0440, bytes({0xFF}));
         EXPECT_FALSE(probe.event(kWatchdogEvent));
         EXPECT_EQ(probe.get(0x0440), 0U);
       }},
      {"any", "PDI", "read or write", "watchdog time PDI not 0",
       [] {
         Probe probe;
         probe.slave.set_host_polling(false);
         for (int i = 0; i < 4; ++i) {
           probe.bus.wait(80_ms);
           if (i % 2 == 0) {
             host_read(probe.slave, 0x0F00, 1);
           } else {
             host_write(probe.slave, 0x0F00, bytes({0}));
           }
         }
         EXPECT_EQ(probe.get(0x0443), 0U);
         probe.bus.wait(120_ms);
         EXPECT_EQ(probe.get(0x0443), 1U);
       }},
      {"SM data area", "ECAT or PDI side that writes", "write", "SM with watchdog trigger enabled",
       [] {
         Probe probe;
         probe.bus.set_sync_manager(0, 2, {.start = 0x1100, .length = 2, .control = 0x64});
         for (unsigned i = 0; i < 4; ++i) {
           probe.set(0x1100, bytes({i, i}));
           EXPECT_EQ(probe.get(0x0440), 1U);
           probe.bus.wait(80_ms);
         }
         EXPECT_EQ(probe.get(0x0442), 0U);
         probe.set(0x1100, bytes({1}));
         probe.bus.wait(80_ms);
         EXPECT_EQ(probe.get(0x0442), 1U) << "half a buffer is no trigger";
       }},
      {"0x0500.1", "ECAT", "write", "written 1",
       [] {
         Probe probe;
         offer_eeprom_to_host(probe);
         EXPECT_EQ(probe.get(0x0501), 1U);
         probe.set(0x0500, bytes({2}));
         EXPECT_EQ(probe.get(0x0501), 0U);
       }},
      {"0x0501.0", "PDI", "write", "0x0500.0 = 1 and 0x0500.1 = 0",
       [] {
         Probe probe;
         host_write(probe.slave, 0x0501, bytes({1}));
         EXPECT_EQ(probe.get(0x0501), 0U) << "not offered";
         probe.set(0x0500, bytes({3}));
         host_write(probe.slave, 0x0501, bytes({1}));
         EXPECT_EQ(probe.get(0x0501), 0U) << "forced";
         offer_eeprom_to_host(probe);
         EXPECT_EQ(probe.get(0x0501), 1U);
         host_write(probe.slave, 0x0501, bytes({0}));
         EXPECT_EQ(probe.get(0x0501), 0U) << "released";
       }},
      {"0x0502 bits 10:8", "ECAT or owner", "write", "not busy",
       [] {
         Probe probe;
         probe.set(0x0502, bytes({0, 1, 0x10, 0, 0, 0}));
         EXPECT_EQ(probe.get(0x0502, 2) & 0x8700U, 0x8100U);
         probe.bus.wait(1_ms);
         EXPECT_EQ(probe.get(0x0502, 2) & 0x8700U, 0U);
         EXPECT_EQ(probe.get(0x0508, 4), 0x00110010U);
       }},
      {"0x0502 bits 10:8 = 000", "owner", "write", "not busy",
       [] {
         Probe probe;
         probe.set(0x0502, bytes({0, 2}));
         EXPECT_EQ(probe.get(0x0502, 2) & 0x6000U, 0x4000U);
         probe.set(0x0502, bytes({0, 0}));
         EXPECT_EQ(probe.get(0x0502, 2) & 0x6000U, 0U);
         probe.set(0x0502, bytes({0, 3}));
         EXPECT_EQ(probe.get(0x0502, 2) & 0x6000U, 0x2000U);
         probe.set(0x0503, bytes({0}));
         EXPECT_EQ(probe.get(0x0502, 2) & 0x6000U, 0U);
       }},
      {"0x0502.0", "device", "SOF of the next frame", "was 1 from ECAT",
       [] {
         Probe probe;
         probe.bus.with(Command::apwr, physical_address(0, 0x0502), bytes({1}))
             .with(Command::aprd, physical_address(0, 0x0502), bytes({0}));
         EXPECT_EQ(number(probe.bus.send()[1].data) & 1U, 1U) << "the same frame";
         EXPECT_EQ(probe.get(0x0502) & 1U, 0U);
       }},
      {"0x0504, 0x0508, 0x0502", "owner", "write", "busy (0x0502.15 = 1)",
       [] {
         Probe probe;
         probe.set(0x0502, bytes({0, 1, 0x10, 0, 0, 0}));
         for (const std::uint16_t address :
              {std::uint16_t{0x0502}, std::uint16_t{0x0504}, std::uint16_t{0x0508}}) {
           EXPECT_EQ(probe.set(address, bytes({0x77, 0})), 0U) << std::hex << address;
         }
         probe.bus.wait(1_ms);
         EXPECT_EQ(probe.get(0x0504, 4), 0x10U);
       }},
      {"0x0510", "owner", "write", "any",
       [] {
         Probe probe;
         probe.set(0x0510, bytes({0, 1, 9, 0}));
         probe.bus.wait(1_ms);
         EXPECT_EQ(probe.get(0x0510, 2) & 0x2000U, 0x2000U);
         probe.set(0x0510, bytes({0}));
         EXPECT_EQ(probe.get(0x0510, 2) & 0x2000U, 0U);
       }},
      {"0x0510 bits 9:8 = 00", "owner", "write", "any",
       [] {
         Probe probe;
         probe.set(0x0510, bytes({0, 2}));
         EXPECT_EQ(probe.get(0x0510, 2) & 0x6000U, 0x4000U);
         probe.set(0x0510, bytes({0, 0}));
         EXPECT_EQ(probe.get(0x0510, 2) & 0x6000U, 0U);
       }},
      {"0x0510.0", "device", "SOF of the next frame or end of the PDI access", "was 1",
       [] {
         Probe probe;
         probe.bus.with(Command::apwr, physical_address(0, 0x0510), bytes({1}))
             .with(Command::aprd, physical_address(0, 0x0510), bytes({0}));
         EXPECT_EQ(number(probe.bus.send()[1].data) & 1U, 1U);
         EXPECT_EQ(probe.get(0x0510) & 1U, 0U);
       }},
      {"0x0510-0x0515", "owner", "write", "busy (0x0510.15 = 1)",
       [] {
         Probe probe;
         probe.bus.with(Command::apwr, physical_address(0, 0x0510), bytes({0, 1, 0, 2}))
             .with(Command::apwr, physical_address(0, 0x0510), zeros(6));
         EXPECT_EQ(probe.bus.send()[1].working_counter, 0U);
       }},
      {"0x0516", "ECAT", "write", "0x0517.0 = 0",
       [] {
         Probe probe;
         EXPECT_EQ(probe.set(0x0516, bytes({1})), 1U);
         EXPECT_EQ(probe.get(0x0516), 1U);
         EXPECT_EQ(probe.set(0x0516, bytes({0})), 1U);
         host_write(probe.slave, 0x0517, bytes({1}));
         EXPECT_EQ(probe.set(0x0516, bytes({1})), 0U);
       }},
      {"0x0517.1", "ECAT", "write", "written 1",
       [] {
         Probe probe;
         host_write(probe.slave, 0x0517, bytes({1}));
         EXPECT_EQ(probe.get(0x0517) & 1U, 1U);
         probe.set(0x0517, bytes({2}));
         EXPECT_EQ(probe.get(0x0517) & 1U, 0U);
       }},
      {"0x0518-0x051B", "ECAT or PDI", "write", "any byte, any value",
       [] {
         SlaveControllerConfiguration configuration = chip();
         configuration.mii.phy_addresses = {0, 5};  // that of port 1 is not found
         for (const bool by_host : {false, true}) {
           Probe probe(configuration);
           EXPECT_EQ(probe.get(0x0518, 2) & 0x0808U, 0x0800U);
           if (by_host) {
             host_write(probe.slave, 0x051A, bytes({0}));
           } else {
             EXPECT_EQ(probe.set(0x051A, bytes({0})), 1U);
           }
           EXPECT_EQ(probe.get(0x0518, 2) & 0x0808U, 0U);
         }
       }},
      {"0x0806+8y", "ECAT", "write", "enable changed",
       [] {
         Probe probe;
         EXPECT_FALSE(probe.event(kActivationEvent));
         probe.set(0x080E, bytes({1}));
         EXPECT_TRUE(probe.event(kActivationEvent));
       }},
      {"0x0806+8y", "PDI", "read", "write-acknowledge disabled; all SMs with changed activation",
       [] {
         Probe probe;
         probe.set(0x0806, bytes({1}));
         probe.set(0x081E, bytes({1}));
         host_read(probe.slave, 0x0806, 1);
         EXPECT_TRUE(probe.event(kActivationEvent)) << "one of two";
         host_read(probe.slave, 0x081E, 1);
         EXPECT_FALSE(probe.event(kActivationEvent));
       }},
      {"0x0806+8y", "PDI", "write", "write-acknowledge enabled; all SMs with changed activation",
       [] {
         Probe probe(acknowledging_by_write());
         probe.set(0x0806, bytes({1}));
         host_read(probe.slave, 0x0806, 1);
         EXPECT_TRUE(probe.event(kActivationEvent));
         host_write(probe.slave, 0x0806, bytes({0xFF}));
         EXPECT_FALSE(probe.event(kActivationEvent));
         EXPECT_EQ(probe.get(0x0806), 1U) << "the value written is ignored";
       }},
      {"0x0807+8y bit 0", "PDI", "write", "written 1",
       [] {
         Probe probe;
         mailbox(probe);
         probe.set(0x1000, bytes({1, 2, 3, 4}));
         host_write(probe.slave, 0x0807, bytes({1}));
         EXPECT_EQ(probe.get(0x0807), 1U);
         EXPECT_EQ(probe.get(0x0805) & 0x0BU, 0U) << "reset";
         EXPECT_EQ(probe.set(0x1000, bytes({1, 2, 3, 4})), 0U) << "locked";
         EXPECT_EQ(host_read(probe.slave, 0x1000, 4), zeros(4));
       }},
      {"SM buffer first byte", "reader", "read", "SM active",
       [] {
         Probe probe;
         mailbox(probe);
         probe.set(0x1000, bytes({1, 2, 3, 4}));
         EXPECT_EQ(probe.get(0x0805) & 1U, 1U);
         host_read(probe.slave, 0x1000, 1);
         EXPECT_EQ(probe.get(0x0805) & 1U, 0U);
       }},
      {"SM buffer first byte", "writer", "write", "SM active",
       [] {
         Probe probe;
         mailbox(probe);
         probe.set(0x1000, bytes({1, 2, 3, 4}));
         host_read(probe.slave, 0x1000, 4);
         EXPECT_EQ(probe.get(0x0805) & 2U, 2U);
         probe.set(0x1000, bytes({1}));
         EXPECT_EQ(probe.get(0x0805) & 2U, 0U);
       }},
      {"SM buffer last byte", "writer", "write", "SM active and buffer complete",
       [] {
         Probe probe;
         mailbox(probe);
         probe.set(0x1000, bytes({1, 2, 3}));
         EXPECT_EQ(probe.get(0x0805) & 0x09U, 0U);
         probe.set(0x1003, bytes({4}));
         EXPECT_EQ(probe.get(0x0805) & 0x09U, 0x09U);
       }},
      {"SM buffer last byte", "reader", "read", "SM active and buffer complete",
       [] {
         Probe probe;
         mailbox(probe);
         probe.set(0x1000, bytes({1, 2, 3, 4}));
         host_read(probe.slave, 0x1000, 3);
         EXPECT_EQ(probe.get(0x0805) & 0x0AU, 0x08U);
         EXPECT_EQ(host_read(probe.slave, 0x1003, 1), bytes({4}));
         EXPECT_EQ(probe.get(0x0805) & 0x0AU, 0x02U);
       }},
  };
  return kTable;
}

class SideEffects : public ::testing::TestWithParam<std::size_t> {};

TEST_P(SideEffects, OfRegistersAreThoseOfTheDocument) {
  probes()[GetParam()].check();
}

INSTANTIATE_TEST_SUITE_P(Tmc8670, SideEffects, ::testing::Range(std::size_t{0}, probes().size()),
                         [](const ::testing::TestParamInfo<std::size_t>& probe) {
                           const SideEffect& row = probes()[probe.param];
                           std::string name = std::string(row.register_name) + "_" + row.actor +
                                              "_" + row.access + "_" + std::to_string(probe.param);
                           std::replace_if(
                               name.begin(), name.end(),
                               [](char c) {
                                 return std::isalnum(static_cast<unsigned char>(c)) == 0;
                               },
                               '_');
                           return name;
                         });

TEST(SideEffectTable, EveryRowHasItsProbe) {
  // Loops and their time: Segment tests. Distributed clocks, cyclic units, latches and event
  // times: DistributedClock tests.
  const auto elsewhere = [](const std::string& name) {
    return name.starts_with("0x0100") || name.starts_with("0x09") || name.starts_with("\"0x09");
  };
  std::set<std::string> probed;
  for (const SideEffect& row : probes()) {
    probed.insert(std::string(row.register_name) + "|" + row.actor + "|" + row.access);
  }
  std::ifstream file(STATOR_TEST_DATA "/tmc8670/register_side_effects.csv");
  const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const std::vector<tests::CsvRow> rows = tests::parse_csv(text);
  ASSERT_GT(rows.size(), 60U);
  std::size_t expected = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (!elsewhere(rows[i][0])) {
      ++expected;
      EXPECT_TRUE(probed.count(rows[i][0] + "|" + rows[i][1] + "|" + rows[i][2]) == 1)
          << rows[i][0] << ", " << rows[i][1] << ", " << rows[i][2];
    }
  }
  EXPECT_EQ(probes().size(), expected) << "one probe for each row";
}

}  // namespace
}  // namespace stator::ethercat

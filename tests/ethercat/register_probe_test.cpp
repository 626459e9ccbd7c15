// Raw frames at every byte of the register space, of every preset, compared with what the documents
// allow.

#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ethercat/register_expectation.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::Bytes;
using testing::bytes;
using testing::controller_expectations;
using testing::ControllerExpectation;
using testing::ExpectedByte;
using testing::ExpectedRegister;
using testing::host_read;
using testing::host_write;
using testing::TestBus;

constexpr std::uint16_t kStation = 0x1001;

struct ProbeCase {
  std::size_t controller;
  std::size_t register_index;

  [[nodiscard]] const ControllerExpectation& expectation() const {
    return controller_expectations()[controller];
  }
  [[nodiscard]] const ExpectedRegister& target() const {
    return expectation().registers[register_index];
  }
};

void PrintTo(const ProbeCase& probe, std::ostream* out) {
  *out << probe.expectation().name << " " << probe.target().name;
}

std::vector<ProbeCase> all_cases() {
  std::vector<ProbeCase> cases;
  for (std::size_t c = 0; c < controller_expectations().size(); ++c) {
    if (controller_expectations()[c].name == "tmcm3315") {
      continue;  // register by register the same as the tmc8461
    }
    for (std::size_t r = 0; r < controller_expectations()[c].registers.size(); ++r) {
      cases.push_back({c, r});
    }
  }
  return cases;
}

std::string hexadecimal(unsigned value) {
  char text[8];
  static_cast<void>(std::snprintf(text, sizeof text, "0x%04X", value));
  return text;
}

unsigned peek(const SlaveController& slave, std::uint16_t address) {
  Bytes byte(1);
  slave.peek(address, byte);
  return std::to_integer<unsigned>(byte[0]);
}

/// Times count on, so two reads of them differ.
bool runs_by_itself(std::uint16_t address) {
  return address >= 0x0910 && address <= 0x0917;
}

/// Writing this byte starts something that shows in the same byte: commands are cleared, errors
/// appear beside them, receive times are latched.
bool starts_something(std::uint16_t address) {
  return address == 0x0503 || address == 0x0511 || (address >= 0x0900 && address <= 0x0903);
}

/// What cyclic unit and latches do with their settings is not a matter of rights alone.
bool belongs_to_cyclic_units(std::uint16_t address) {
  return address >= 0x0980 && address <= 0x09DF;
}

class RegisterProbe : public ::testing::TestWithParam<ProbeCase> {
 protected:
  void check_bus_reads() const;
  void check_bus_writes() const;
  void check_exchanges() const;
  void check_host_reads() const;
  void check_host_writes() const;

 private:
  template <typename Check>
  void for_each_byte(Check check) const {
    for (const std::uint16_t address : GetParam().target().bytes) {
      SCOPED_TRACE(hexadecimal(address));
      check(address, GetParam().expectation().bytes[address]);
    }
  }
  [[nodiscard]] TestBus fresh() const { return TestBus(1, GetParam().expectation().configuration); }
};

void RegisterProbe::check_bus_reads() const {
  TestBus bus = fresh();
  bus.write(0, 0x0010, bytes({kStation & 0xFF, kStation >> 8}));
  for_each_byte([&](std::uint16_t address, const ExpectedByte& expected) {
    const std::pair<Command, std::uint16_t> kReads[] = {
        {Command::aprd, 0}, {Command::fprd, kStation}, {Command::brd, 0}};
    for (const auto& [command, adp] : kReads) {
      const auto answer = bus.transfer(command, physical_address(adp, address), bytes({0}));
      EXPECT_EQ(answer.working_counter, expected.bus_reads ? 1U : 0U)
          << "command " << static_cast<int>(command);
      if (!runs_by_itself(address)) {
        const unsigned value = expected.bus_reads ? peek(bus.slave(), address) : 0;
        EXPECT_EQ(std::to_integer<unsigned>(answer.data[0]), value);
      }
    }
  });
}

void RegisterProbe::check_bus_writes() const {
  for_each_byte([&](std::uint16_t address, const ExpectedByte& expected) {
    const std::pair<Command, std::uint16_t> kWrites[] = {
        {Command::apwr, 0}, {Command::fpwr, kStation}, {Command::bwr, 0}};
    for (const auto& [command, adp] : kWrites) {
      for (const unsigned value : {0xFFU, 0x00U}) {
        TestBus bus = fresh();
        bus.write(0, 0x0010, bytes({kStation & 0xFF, kStation >> 8}));
        const unsigned before = peek(bus.slave(), address);
        const auto answer = bus.transfer(command, physical_address(adp, address), bytes({value}));
        EXPECT_EQ(answer.working_counter, expected.bus_writes ? 1U : 0U)
            << "command " << static_cast<int>(command);
        if (!starts_something(address) && !belongs_to_cyclic_units(address)) {
          const unsigned mask = expected.bus_stores;
          EXPECT_EQ(peek(bus.slave(), address), (before & ~mask) | (value & mask))
              << "before " << before << ", written " << value;
        }
      }
    }
  });
}

/// Read-write commands count one for reading and two for writing.
void RegisterProbe::check_exchanges() const {
  for_each_byte([&](std::uint16_t address, const ExpectedByte& expected) {
    const std::pair<Command, std::uint16_t> kExchanges[] = {
        {Command::aprw, 0}, {Command::fprw, kStation}, {Command::brw, 0}};
    for (const auto& [command, adp] : kExchanges) {
      TestBus bus = fresh();
      bus.write(0, 0x0010, bytes({kStation & 0xFF, kStation >> 8}));
      bus.read(0, address, 1);  // some values are computed when they are read
      const unsigned before = peek(bus.slave(), address);
      const auto answer = bus.transfer(command, physical_address(adp, address), bytes({0}));
      EXPECT_EQ(answer.working_counter,
                (expected.bus_reads ? 1U : 0U) + (expected.bus_writes ? 2U : 0U))
          << "command " << static_cast<int>(command);
      if (!runs_by_itself(address) && expected.bus_reads) {
        EXPECT_EQ(std::to_integer<unsigned>(answer.data[0]), before) << "the value before";
      }
    }
  });
}

void RegisterProbe::check_host_reads() const {
  TestBus bus = fresh();
  for_each_byte([&](std::uint16_t address, const ExpectedByte& expected) {
    const Bytes answer = host_read(bus.slave(), address, 1);
    if (!runs_by_itself(address)) {
      const unsigned value = expected.host_reads ? peek(bus.slave(), address) : 0;
      EXPECT_EQ(std::to_integer<unsigned>(answer[0]), value);
    }
  });
}

void RegisterProbe::check_host_writes() const {
  for_each_byte([&](std::uint16_t address, const ExpectedByte& expected) {
    for (const unsigned value : {0xFFU, 0x00U}) {
      TestBus bus = fresh();
      const unsigned before = peek(bus.slave(), address);
      host_write(bus.slave(), address, bytes({value}));
      if (!starts_something(address) && !belongs_to_cyclic_units(address)) {
        const unsigned mask = expected.host_stores;
        EXPECT_EQ(peek(bus.slave(), address), (before & ~mask) | (value & mask))
            << "before " << before << ", written " << value;
      }
    }
  });
}

TEST_P(RegisterProbe, Bus_ReadsWritesAndCountsAsTheRightsSay) {
  check_bus_reads();
  check_bus_writes();
  check_exchanges();
}

TEST_P(RegisterProbe, Host_ReadsAndWritesAsTheRightsSay) {
  check_host_reads();
  check_host_writes();
}

INSTANTIATE_TEST_SUITE_P(Every, RegisterProbe, ::testing::ValuesIn(all_cases()),
                         [](const ::testing::TestParamInfo<ProbeCase>& probe) {
                           return probe.param.expectation().name + "_" + probe.param.target().name;
                         });

class ControllerProbe : public ::testing::TestWithParam<std::size_t> {
 protected:
  [[nodiscard]] const ControllerExpectation& expectation() const {
    return controller_expectations()[GetParam()];
  }
};

TEST_P(ControllerProbe, BytesWithoutARegister_LeaveTheWorkingCounterAlone) {
  TestBus bus(1, expectation().configuration);
  for (std::uint16_t address = 0; address < 0x1000; ++address) {
    if (!expectation().bytes[address].declared) {
      EXPECT_EQ(bus.read(0, address, 1).working_counter, 0U) << hexadecimal(address);
      EXPECT_EQ(bus.write(0, address, bytes({0xFF})).working_counter, 0U) << hexadecimal(address);
      EXPECT_EQ(host_read(bus.slave(), address, 1), bytes({0})) << hexadecimal(address);
      host_write(bus.slave(), address, bytes({0xFF}));
      EXPECT_EQ(peek(bus.slave(), address), 0U) << hexadecimal(address);
    }
  }
}

TEST_P(ControllerProbe, LongAccesses_CountOnceIfAnyByteAnswers) {
  TestBus bus(1, expectation().configuration);
  for (std::uint16_t address = 0; address + 8 < 0x1000; address += 3) {
    bool any = false;
    for (std::uint16_t i = 0; i < 8; ++i) {
      any |= expectation().bytes[address + i].bus_reads;
    }
    EXPECT_EQ(bus.read(0, address, 8).working_counter, any ? 1U : 0U) << hexadecimal(address);
  }
}

TEST_P(ControllerProbe, Rights_AreTheSameInEveryState) {
  for (const unsigned state : {1U, 2U, 3U, 4U, 8U, 0x12U}) {
    for (std::uint16_t address = 0; address < 0x1000; ++address) {
      const ExpectedByte& expected = expectation().bytes[address];
      // Of the memory-like areas the first bytes will do.
      const bool inside = (address > 0x0588 && address < 0x0600) || address > 0x0F88;
      if (!expected.declared || inside) {
        continue;
      }
      TestBus bus(1, expectation().configuration);
      host_write(bus.slave(), 0x0130, bytes({state, 0}));
      EXPECT_EQ(bus.read(0, address, 1).working_counter, expected.bus_reads ? 1U : 0U)
          << hexadecimal(address) << " in state " << state;
      EXPECT_EQ(bus.write(0, address, bytes({0})).working_counter, expected.bus_writes ? 1U : 0U)
          << hexadecimal(address) << " in state " << state;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, ControllerProbe,
                         ::testing::Range(std::size_t{0}, controller_expectations().size()),
                         [](const ::testing::TestParamInfo<std::size_t>& probe) {
                           return controller_expectations()[probe.param].name;
                         });

}  // namespace
}  // namespace stator::ethercat

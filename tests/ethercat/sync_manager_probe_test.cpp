// Accesses of every offset and length, by both sides, to a sync manager in every state, compared
// with the rules of ETG.1000.4 §6.3 written down a second time.

#include <algorithm>
#include <array>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ethercat/controllers.hpp"
#include "ethercat/test_bus.hpp"

namespace stator::ethercat {
namespace {

using testing::Bytes;
using testing::bytes;
using testing::host_read;
using testing::host_write;
using testing::number;
using testing::TestBus;
using testing::zeros;

constexpr int kStart = 0x1100;
constexpr int kLength = 6;
/// Bytes around the area that are accessed too; behind a buffered one lie its other two buffers.
constexpr int kMargin = 3;

enum class State : std::uint8_t {
  disabled,
  empty,
  write_open,   ///< first byte written, last one not
  full,         ///< mailbox full, or a buffer written
  read_open,    ///< and the first byte read, the last one not
  deactivated,  ///< by the host
  wrong_mode,   ///< enabled with a reserved mode: not in charge
};
constexpr std::array kStates{State::disabled,  State::empty,       State::write_open, State::full,
                             State::read_open, State::deactivated, State::wrong_mode};

struct SyncManagerCase {
  const char* preset;
  bool buffered;
  bool bus_writes;
  State state;
  bool by_bus;
  bool write;
};

void PrintTo(const SyncManagerCase& value, std::ostream* out) {
  *out << value.preset << (value.buffered ? " buffered" : " mailbox");
}

std::string name_of(const SyncManagerCase& value) {
  constexpr std::array<const char*, 7> kNames{"Disabled", "Empty",       "WriteOpen", "Full",
                                              "ReadOpen", "Deactivated", "WrongMode"};
  return std::string(value.preset) + (value.buffered ? "_Buffered" : "_Mailbox") +
         (value.bus_writes ? "_BusWrites_" : "_HostWrites_") +
         kNames[static_cast<std::size_t>(value.state)] + (value.by_bus ? "_Bus" : "_Host") +
         (value.write ? "Write" : "Read");
}

std::vector<SyncManagerCase> all_cases() {
  std::vector<SyncManagerCase> cases;
  for (const char* preset : {"tmc8461", "tmc8670"}) {
    for (const bool buffered : {false, true}) {
      for (const bool bus_writes : {false, true}) {
        for (const State state : kStates) {
          for (const bool by_bus : {false, true}) {
            for (const bool write : {false, true}) {
              cases.push_back({preset, buffered, bus_writes, state, by_bus, write});
            }
          }
        }
      }
    }
  }
  return cases;
}

/// What becomes of one access: whether any byte was reached, and the state of the channel after.
struct Outcome {
  bool succeeds = false;
  bool opens_writing = false;
  bool completes_writing = false;
  bool opens_reading = false;
  bool completes_reading = false;
};

/// The standard's rules for an access to `length` bytes from `offset` of the area on.
Outcome expected_outcome(const SyncManagerCase& probe, int offset, int length) {
  Outcome outcome;
  const bool in_charge = probe.state != State::disabled && probe.state != State::wrong_mode;
  const int guarded = probe.buffered ? 3 * kLength : kLength;
  const int end = offset + length;
  if (!in_charge || offset < 0 || end > guarded) {
    outcome.succeeds = true;  // some byte of it is plain memory
  }
  const bool touches_area = offset < kLength && end > 0;
  if (!in_charge || probe.state == State::deactivated || !touches_area) {
    return outcome;
  }
  const bool is_writer = probe.bus_writes == probe.by_bus;
  if (probe.write != is_writer) {
    return outcome;  // the other direction is nobody's
  }
  const bool first_byte = offset <= 0;
  const bool last_byte = end >= kLength;
  const bool full = probe.state == State::full || probe.state == State::read_open;
  if (probe.write) {
    const bool open = first_byte ? probe.buffered || !full : probe.state == State::write_open;
    outcome.opens_writing = open && first_byte;
    outcome.completes_writing = open && last_byte;
    outcome.succeeds |= open;
  } else {
    const bool open = first_byte ? probe.buffered || full : probe.state == State::read_open;
    outcome.opens_reading = open && first_byte;
    outcome.completes_reading = open && last_byte;
    outcome.succeeds |= open;
  }
  return outcome;
}

class SyncManagerProbe : public ::testing::TestWithParam<SyncManagerCase> {
 protected:
  /// A controller with sync manager 0 in the state of the case.
  struct World {
    explicit World(const SyncManagerCase& probe) : bus(1, testing::controller_of(probe.preset)) {
      const unsigned mode = probe.buffered ? 0U : 2U;
      const unsigned direction = probe.bus_writes ? 4U : 0U;
      const unsigned reserved = probe.state == State::wrong_mode ? 1U : 0U;
      bus.set_sync_manager(
          0, 0,
          {.start = kStart,
           .length = kLength,
           .control = static_cast<std::uint8_t>(mode | direction | reserved),
           .activate = probe.state == State::disabled ? std::uint8_t{0} : std::uint8_t{1}});
      switch (probe.state) {
        case State::write_open:
          write(probe.bus_writes, 0, 1);
          break;
        case State::full:
          write(probe.bus_writes, 0, kLength);
          break;
        case State::read_open:
          write(probe.bus_writes, 0, kLength);
          read(!probe.bus_writes, 0, 1);
          break;
        case State::deactivated:
          host_write(bus.slave(), 0x0807, bytes({1}));
          break;
        default:
          break;
      }
    }

    static std::uint16_t at(int offset) { return static_cast<std::uint16_t>(kStart + offset); }

    /// Working counter of the bus; empty for the host, which learns nothing.
    std::optional<unsigned> write(bool by_bus, int offset, int length) {
      const Bytes data(static_cast<std::size_t>(length), std::byte{0x5A});
      if (by_bus) {
        return bus.write(0, at(offset), data).working_counter;
      }
      host_write(bus.slave(), at(offset), data);
      return std::nullopt;
    }
    std::optional<unsigned> read(bool by_bus, int offset, int length) {
      if (by_bus) {
        return bus.read(0, at(offset), static_cast<std::size_t>(length)).working_counter;
      }
      host_read(bus.slave(), at(offset), static_cast<std::size_t>(length));
      return std::nullopt;
    }
    unsigned status() { return static_cast<unsigned>(number(bus.read(0, 0x0805, 1).data)); }

    TestBus bus;
  };

  void expect_status(const Outcome& outcome, unsigned before, unsigned after) const {
    const bool buffered = GetParam().buffered;
    unsigned expected = before & 0xCBU;  // all but "last buffer", which the writer moves
    if (outcome.opens_writing) {
      expected = (expected & ~0x02U) | 0x80U;
    }
    if (outcome.completes_writing) {
      expected = (expected & ~0x80U) | 0x01U | (buffered ? 0U : 0x08U);
    }
    if (outcome.opens_reading) {
      expected = (expected & ~0x01U) | 0x40U;
    }
    if (outcome.completes_reading) {
      expected = (expected & ~0x48U) | 0x02U;
    }
    EXPECT_EQ(after & 0xCBU, expected) << std::hex << "status before " << before;
    const bool moves = buffered && outcome.completes_writing;
    EXPECT_EQ((after & 0x30U) != (before & 0x30U), moves) << "last written buffer";
  }
};

TEST_P(SyncManagerProbe, EveryOffsetAndLength_FollowsTheRulesOfItsState) {
  const SyncManagerCase& probe = GetParam();
  const int guarded = probe.buffered ? 3 * kLength : kLength;
  for (int offset = -kMargin; offset < guarded + kMargin; ++offset) {
    for (int length = 1; offset + length <= guarded + kMargin; ++length) {
      SCOPED_TRACE("offset " + std::to_string(offset) + ", length " + std::to_string(length));
      World world(probe);
      const unsigned before = world.status();
      const auto counted = probe.write ? world.write(probe.by_bus, offset, length)
                                       : world.read(probe.by_bus, offset, length);
      const Outcome outcome = expected_outcome(probe, offset, length);
      if (counted) {
        EXPECT_EQ(*counted, outcome.succeeds ? 1U : 0U);
      }
      expect_status(outcome, before, world.status());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Every, SyncManagerProbe, ::testing::ValuesIn(all_cases()),
                         [](const ::testing::TestParamInfo<SyncManagerCase>& probe) {
                           return name_of(probe.param);
                         });

class LastByteProbe : public ::testing::TestWithParam<int> {};

TEST_P(LastByteProbe, MailboxIsWrittenInPiecesAndClosedByItsLastByteInADatagramOfItsOwn) {
  // As TwinCAT does: the used bytes, then the last byte of the mailbox, in one frame or in two.
  const int used = GetParam();
  for (const bool one_frame : {true, false}) {
    SCOPED_TRACE(one_frame ? "one frame" : "two frames");
    TestBus bus;
    bus.set_sync_manager(0, 0, {.start = kStart, .length = 64, .control = 0x26});
    Bytes message(static_cast<std::size_t>(used), std::byte{0x77});
    bus.with(Command::apwr, physical_address(0, kStart), message);
    if (!one_frame) {
      EXPECT_EQ(bus.send()[0].working_counter, 1U);
      EXPECT_EQ(bus.slave().al_event_request() & 0x100U, 0U) << "not complete";
      EXPECT_EQ(host_read(bus.slave(), kStart, 2), zeros(2)) << "not yet for the host";
    }
    bus.with(Command::apwr, physical_address(0, kStart + 63), bytes({0}));
    EXPECT_EQ(bus.send().back().working_counter, 1U);
    EXPECT_EQ(bus.slave().al_event_request() & 0x100U, 0x100U);
    EXPECT_EQ(host_read(bus.slave(), kStart, static_cast<std::size_t>(used)), message);
    EXPECT_EQ(bus.write(0, kStart, message).working_counter, 0U) << "full";
    host_read(bus.slave(), kStart + 63, 1);
    EXPECT_EQ(bus.write(0, kStart, message).working_counter, 1U) << "emptied by its last byte";
  }
}

TEST_P(LastByteProbe, ReplyIsPolledByTwoBytesAndTakenByItsLastByte) {
  const auto used = static_cast<std::size_t>(GetParam());
  TestBus bus;
  bus.set_sync_manager(0, 1, {.start = kStart, .length = 64, .control = 0x22});
  EXPECT_EQ(bus.read(0, kStart, 2).working_counter, 0U) << "empty";
  Bytes reply(64);
  std::fill_n(reply.begin(), used, std::byte{0x33});
  host_write(bus.slave(), kStart, reply);
  for (int poll = 0; poll < 3; ++poll) {
    const auto answer = bus.read(0, kStart, 2);
    EXPECT_EQ(answer.working_counter, 1U) << "poll " << poll;
    EXPECT_EQ(answer.data, Bytes(reply.begin(), reply.begin() + 2));
  }
  EXPECT_EQ(bus.read(0, kStart, used).data,
            Bytes(reply.begin(), reply.begin() + static_cast<std::ptrdiff_t>(used)));
  host_write(bus.slave(), kStart, zeros(64));
  EXPECT_EQ(bus.read(0, kStart, used).data[0], reply[0]) << "the host cannot replace it";
  EXPECT_EQ(bus.read(0, kStart + 63, 1).working_counter, 1U);
  EXPECT_EQ(bus.read(0, kStart, 2).working_counter, 0U) << "taken";
  EXPECT_EQ(bus.read(0, kStart + 63, 1).working_counter, 0U);
}

INSTANTIATE_TEST_SUITE_P(UsedBytes, LastByteProbe, ::testing::Values(2, 3, 6, 16, 62, 63));

}  // namespace
}  // namespace stator::ethercat

// What masters demand of each field of each mailbox message that a slave sends.
//
// Read from the sources of SOEM 2.0, IgH 1.5, ethercrab and KickCAT as masters; SOES is named where
// the field is what this slave sends, with which all of them are tried. A field that no master
// looks at has the value of the standard (ETG.1000.4, ETG.1000.6).

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "masters/soem.hpp"
#include "stator/base/byte_order.hpp"
#include "stator/devices/tmcm_3315/tmcm_3315.hpp"

namespace stator::tests {
namespace {

/// Bytes at an offset from the start of the mailbox, and who looks at them.
struct Field {
  const char* name;
  std::size_t offset;
  std::size_t bytes;
  std::uint64_t mask;
  std::uint64_t value;
  const char* demanded_by;
};

constexpr std::uint64_t kAll = ~std::uint64_t{0};
constexpr std::uint16_t kShort = 48;  ///< a mailbox in which 1600h needs segments

/// A device with everything, in Pre-Operational, and the ways to get each message out of it.
class Slave {
 public:
  Slave() : soem(bus) {
    devices::Tmcm3315Configuration configuration;
    configuration.coe.ethernet_over_ethercat = true;
    configuration.coe.firmware_erase_time = 500_ms;
    bus.add_device(configuration);
    soem.config_init();
  }

  static Bytes request(unsigned command, std::uint16_t index, unsigned subindex,
                       std::uint32_t data = 0) {
    Bytes sdo = bytes({command, 0, 0, subindex, 0, 0, 0, 0});
    base::store_le(sdo, 1, index);
    base::store_le(sdo, 4, data);
    return sdo;
  }
  /// The answer to a message, with its mailbox header.
  Bytes exchange(Bytes message) {
    message.resize(length);
    EXPECT_EQ(bus.fpwr(Soem::station(0), Soem::kReceiveMailbox, message).working_counter, 1U);
    return receive();
  }
  Bytes receive() {
    for (int poll = 0; poll < 1'000 && !soem.mailbox_full(0); ++poll) {
      bus.pass(200_us);
    }
    const Answer answer = bus.fprd(Soem::station(0), Soem::kTransmitMailbox, length);
    EXPECT_EQ(answer.working_counter, 1U) << "no answer";
    return part(answer.data, 0, 6 + number(part(answer.data, 0, 2)));
  }
  Bytes sdo(const Bytes& request) { return exchange(soem.coe(2, request)); }
  Bytes information(std::string_view request) { return exchange(soem.coe(8, hex(request))); }
  Bytes foe(std::string_view request) { return exchange(soem.message(4, hex(request))); }
  Bytes eoe(std::string_view request) { return exchange(soem.message(2, hex(request))); }

  /// Both mailboxes of `bytes`, from Init to `state`.
  void restart(std::uint16_t bytes_each, unsigned state) {
    const std::uint16_t station = Soem::station(0);
    soem.request(0, Soem::kInit);
    bus.fpwr(station, 0x0806, zeros(1));
    bus.fpwr(station, 0x080E, zeros(1));
    bus.fpwr(station, 0x0800, sync_manager(Soem::kReceiveMailbox, bytes_each, 0x26));
    bus.fpwr(station, 0x0808, sync_manager(Soem::kTransmitMailbox, bytes_each, 0x22));
    soem.request(0, state);
    ASSERT_EQ(number(bus.fprd(station, 0x0130, 2).data), state);
    length = bytes_each;
  }

  DeviceBus bus{0};
  Soem soem;
  std::uint16_t length = Soem::kMailboxLength;
};

constexpr unsigned kPreOperational = 0x02;
constexpr unsigned kBootstrap = 0x03;

struct Message {
  const char* name;
  std::function<Bytes(Slave&)> provoke;
  unsigned type;
  std::vector<Field> fields;
};

// The CoE header of an SDO answer: SOEM takes any answer of service 3 with the right index for the
// success of a write, and reads the abort code of others only; IgH wants 2 and 3 exactly.
constexpr Field kResponse{"CoE service", 6, 2, 0xF000, 0x3000, "SOEM, IgH (exactly), KickCAT"};
constexpr Field kAbortService{"CoE service", 6,      2,
                              0xF000,        0x2000, "SOEM (not 3), IgH (exactly), KickCAT, SOES"};
constexpr Field kAbortCommand{"command",
                              8,
                              1,
                              kAll,
                              0x80,
                              "SOEM (all eight bits), IgH, "
                              "ethercrab, KickCAT (upper three)"};
constexpr Field kInformation{"CoE service", 6, 2, 0xF000, 0x8000, "IgH, KickCAT"};
constexpr Field kNumber{"CoE number", 6, 2, 0x0FFF, 0, "the standard"};
constexpr Field kTenBytes{"length", 0, 2, kAll, 10, "IgH (not below 10)"};

Field index_of(std::uint64_t index) {
  return {"index", 9, 2, kAll, index, "SOEM, IgH, ethercrab, KickCAT"};
}
Field subindex_of(std::uint64_t subindex) {
  return {"subindex", 11, 1, kAll, subindex, "SOEM (writes), IgH, ethercrab, KickCAT"};
}
Field code(std::uint64_t abort_code) {
  return {"abort code", 12, 4, kAll, abort_code, "SOEM, IgH, ethercrab, KickCAT"};
}
Field opcode(std::uint64_t value) {
  return {"SDO information opcode", 8, 1, kAll, value, "SOEM, IgH, ethercrab, KickCAT"};
}
constexpr Field kInformationReserved{"reserved", 9, 1, kAll, 0, "the standard"};
constexpr Field kNoFragments{"fragments left", 10, 2, kAll, 0, "SOEM, IgH, ethercrab, KickCAT"};

std::vector<Message> messages() {
  const auto abort_of = [](std::uint16_t index, unsigned subindex, std::uint32_t abort_code) {
    return std::vector<Field>{kTenBytes,       kNumber,         kAbortService,
                              kAbortCommand,   index_of(index), subindex_of(subindex),
                              code(abort_code)};
  };
  const auto open_segments = [](Slave& slave) {
    slave.restart(kShort, kPreOperational);
    return slave.sdo(Slave::request(0x50, 0x1600, 0));
  };
  const auto open_long_download = [](Slave& slave) {
    slave.restart(kShort, kPreOperational);
    // 1600h by complete access: 38 bytes, of which 32 fit into the first message.
    Bytes first = Slave::request(0x31, 0x1600, 0, 38);
    const Bytes now = slave.sdo(Slave::request(0x50, 0x1600, 0));
    const Bytes data = part(now, 16, 32);
    first.insert(first.end(), data.begin(), data.end());
    return slave.sdo(first);
  };
  return {
      // SDO, done.
      {"DownloadResponse",
       [](Slave& s) { return s.sdo(Slave::request(0x2F, 0x6060, 0, 1)); },
       3,
       {kTenBytes,
        kNumber,
        kResponse,
        {"command", 8, 1, kAll, 0x60, "IgH, ethercrab, KickCAT (upper three bits)"},
        index_of(0x6060),
        subindex_of(0)}},
      {"UploadResponseExpedited",
       [](Slave& s) { return s.sdo(Slave::request(0x40, 0x6041, 0)); },
       3,
       {kTenBytes,
        kNumber,
        kResponse,
        {"command", 8, 1, 0xE0, 0x40, "IgH, ethercrab, KickCAT"},
        {"expedited", 8, 1, 0x02, 0x02, "SOEM, IgH, ethercrab, KickCAT"},
        {"size indicated", 8, 1, 0x01, 0x01, "IgH (else four bytes)"},
        {"unused bytes", 8, 1, 0x0C, 0x08, "SOEM, IgH, ethercrab, KickCAT"},
        index_of(0x6041),
        subindex_of(0)}},
      {"UploadResponseNormal",
       [](Slave& s) { return s.sdo(Slave::request(0x40, 0x1008, 0)); },
       3,
       {{"length", 0, 2, kAll, 19, "SOEM, IgH, ethercrab, KickCAT (data are length - 10)"},
        kResponse,
        {"command", 8, 1, kAll, 0x41, "SOEM, IgH, ethercrab, KickCAT"},
        index_of(0x1008),
        subindex_of(0),
        {"complete size", 12, 4, kAll, 9, "SOEM, IgH, ethercrab, KickCAT"}}},
      {"UploadResponseBeforeSegments",
       open_segments,
       3,
       {{"length", 0, 2, kAll, kShort - 6, "SOEM, IgH (data before the first segment), SOES"},
        kResponse,
        {"command", 8, 1, kAll, 0x51, "SOEM, IgH"},
        index_of(0x1600),
        {"complete size", 12, 4, kAll, 38, "SOEM, IgH"}}},
      {"UploadSegment",
       [=](Slave& s) {
         open_segments(s);
         return s.sdo(Slave::request(0x60, 0, 0));
       },
       3,
       {kTenBytes,
        kNumber,
        kResponse,
        {"command", 8, 1, 0xE0, 0x00, "SOEM, IgH, KickCAT (ethercrab expects 3 here)"},
        {"toggle", 8, 1, 0x10, 0x00, "IgH, KickCAT"},
        {"unused bytes", 8, 1, 0x0E, 0x02, "SOEM, IgH, KickCAT, if the length is 10"},
        {"last segment", 8, 1, 0x01, 0x01, "SOEM, IgH, KickCAT"}}},
      {"DownloadResponseBeforeSegments",
       open_long_download,
       3,
       {kTenBytes,
        kResponse,
        {"command", 8, 1, 0xE0, 0x60, "IgH, KickCAT"},
        index_of(0x1600),
        subindex_of(0)}},
      {"DownloadSegmentResponse",
       [=](Slave& s) {
         open_long_download(s);
         return s.sdo(hex("03 7A 70 20 00 FF 70 00"));
       },
       3,
       {kTenBytes,
        kNumber,
        kResponse,
        {"command", 8, 1, 0xE0, 0x20, "SOEM, IgH, KickCAT"},
        {"toggle", 8, 1, 0x10, 0x00, "IgH, KickCAT"}}},
      // SDO, refused.
      {"AbortOfWriteToReadOnly", [](Slave& s) { return s.sdo(Slave::request(0x2B, 0x6041, 0)); }, 3,
       abort_of(0x6041, 0, 0x06010002)},
      {"AbortOfWriteOutOfRange",
       [](Slave& s) { return s.sdo(Slave::request(0x2F, 0x2000, 0, 200)); }, 3,
       abort_of(0x2000, 0, 0x06090031)},
      {"AbortOfReadOfNoObject", [](Slave& s) { return s.sdo(Slave::request(0x40, 0x5FFF, 7)); }, 3,
       abort_of(0x5FFF, 7, 0x06020000)},
      {"AbortOfReadOfNoSubindex", [](Slave& s) { return s.sdo(Slave::request(0x40, 0x1018, 9)); },
       3, abort_of(0x1018, 9, 0x06090011)},
      {"AbortOfCompleteAccess", [](Slave& s) { return s.sdo(Slave::request(0x50, 0x5FFF, 0)); }, 3,
       abort_of(0x5FFF, 0, 0x06020000)},
      {"AbortOfSegmentWithOldToggle",
       [=](Slave& s) {
         open_segments(s);
         return s.sdo(Slave::request(0x70, 0, 0));
       },
       3, abort_of(0x1600, 0, 0x05030000)},
      {"AbortOfSegmentWithoutTransfer", [](Slave& s) { return s.sdo(Slave::request(0x60, 0, 0)); },
       3, abort_of(0, 0, 0x05040001)},
      {"AbortOfUnknownCommand", [](Slave& s) { return s.sdo(Slave::request(0xE0, 0x6041, 0)); }, 3,
       abort_of(0x6041, 0, 0x05040001)},
      // SDO information.
      {"ObjectListFragment",
       [](Slave& s) {
         s.restart(kShort, kPreOperational);
         return s.information("01 00 00 00 01 00");
       },
       3,
       {{"length", 0, 2, 1, 0, "IgH (even)"},
        kNumber,
        kInformation,
        opcode(0x82),
        kInformationReserved,
        {"list type", 12, 2, kAll, 1, "SOEM, IgH, ethercrab, KickCAT (skipped as two bytes)"}}},
      {"ObjectDescription",
       [](Slave& s) { return s.information("03 00 00 00 18 10"); },
       3,
       {kNumber,
        kInformation,
        opcode(0x04),
        kInformationReserved,
        kNoFragments,
        {"index", 12, 2, kAll, 0x1018, "IgH"},
        {"highest subindex", 16, 1, kAll, 3, "SOEM, IgH"},
        {"object code", 17, 1, kAll, 9, "SOEM, IgH"}}},
      {"EntryDescription",
       [](Slave& s) { return s.information("05 00 00 00 18 10 01 07"); },
       3,
       {kNumber,
        kInformation,
        opcode(0x06),
        kInformationReserved,
        kNoFragments,
        {"index", 12, 2, kAll, 0x1018, "IgH"},
        {"subindex", 14, 1, kAll, 1, "IgH"},
        {"values before the name", 15, 1, 0xF8, 0, "SOEM, IgH (the name is at 22)"},
        {"data type", 16, 2, kAll, 7, "SOEM, IgH"},
        {"bits", 18, 2, kAll, 32, "SOEM, IgH"},
        {"access", 20, 2, 0x003F, 0x0007, "SOEM, IgH"}}},
      {"InformationError",
       [](Slave& s) { return s.information("03 00 00 00 FF 5F"); },
       3,
       {kTenBytes, kNumber, kInformation, opcode(0x07), kInformationReserved, kNoFragments,
        code(0x06020000)}},
      // Emergencies: told of a limit that excludes where the axis stands.
      {"Emergency",
       [](Slave& s) {
         EXPECT_EQ(s.sdo(Slave::request(0x23, 0x607D, 1, 1000))[8], std::byte{0x60});
         return s.receive();
       },
       3,
       {{"length", 0, 2, kAll, 10, "IgH (not below 10)"},
        kNumber,
        {"CoE service", 6, 2, 0xF000, 0x1000, "SOEM, IgH, ethercrab, KickCAT"},
        {"error code", 8, 2, kAll, 0xFF01, "SOEM, IgH, ethercrab, KickCAT"}}},
      // Errors of the mailbox itself.
      {"MailboxErrorOfAnUnknownProtocol",
       [](Slave& s) { return s.exchange(s.soem.message(15, zeros(8))); },
       0,
       {{"length", 0, 2, kAll, 4, "the standard"},
        {"service", 6, 2, kAll, 1, "the standard"},
        {"detail", 8, 2, kAll, 2, "SOEM, IgH"}}},
      {"MailboxErrorOfAnUnknownService",
       [](Slave& s) { return s.exchange(s.soem.coe(0, zeros(8))); },
       0,
       {{"length", 0, 2, kAll, 4, "the standard"},
        {"service", 6, 2, kAll, 1, "the standard"},
        {"detail", 8, 2, kAll, 5, "SOEM, IgH"}}},
      {"MailboxErrorOfAShortMessage",
       [](Slave& s) { return s.exchange(s.soem.coe(2, hex("40 41 60"))); },
       0,
       {{"length", 0, 2, kAll, 4, "the standard"},
        {"service", 6, 2, kAll, 1, "the standard"},
        {"detail", 8, 2, kAll, 6, "SOEM, IgH"}}},
      // FoE: packet number and error code have four bytes.
      {"FoeErrorOutsideBootstrap",
       [](Slave& s) { return s.foe("02 00 00 00 00 00 66 77"); },
       4,
       {{"operation", 6, 1, kAll, 5, "SOEM, IgH"},
        {"reserved", 7, 1, kAll, 0, "the standard"},
        {"error code", 8, 4, kAll, 0x8008, "SOEM, IgH"},
        {"text without end mark", 12, 4, kAll, 0x746F6F62, "IgH (to the length)"}}},
      {"FoeAcknowledge",
       [](Slave& s) {
         s.restart(Soem::kMailboxLength, kBootstrap);
         return s.foe("02 00 00 00 00 00 66 77");
       },
       4,
       {{"length", 0, 2, kAll, 6, "SOEM, IgH"},
        {"operation", 6, 1, kAll, 4, "SOEM, IgH"},
        {"reserved", 7, 1, kAll, 0, "the standard"},
        {"packet", 8, 4, kAll, 0, "SOEM (packet 0 acknowledges the request)"}}},
      {"FoeErrorOfNoFile",
       [](Slave& s) {
         s.restart(Soem::kMailboxLength, kBootstrap);
         return s.foe("01 00 00 00 00 00 78 79 7A");
       },
       4,
       {{"operation", 6, 1, kAll, 5, "SOEM, IgH"},
        {"error code", 8, 4, kAll, 0x8001, "SOEM (the one code it tells apart), IgH"}}},
      {"FoeBusy",
       [](Slave& s) {
         s.restart(Soem::kMailboxLength, kBootstrap);
         s.foe("02 00 00 00 00 00 66 77");
         return s.foe("03 00 01 00 00 00 AA BB CC DD");  // while the memory is being erased
       },
       4,
       {{"operation", 6, 1, kAll, 6, "SOEM, IgH (the packet is sent again)"},
        {"reserved", 7, 1, kAll, 0, "the standard"},
        {"done", 8, 1, 0x80, 0, "the standard (0 to 100 of the next field)"},
        {"entire", 10, 2, kAll, 100, "the standard"}}},
      {"FoeData",
       [](Slave& s) {
         s.restart(Soem::kMailboxLength, kBootstrap);
         s.foe("02 00 00 00 00 00 66 77");
         for (int attempt = 0; attempt < 100; ++attempt) {
           s.bus.pass(100_ms);
           if (s.foe("03 00 01 00 00 00 AA BB CC DD")[6] == std::byte{4}) {
             break;
           }
         }
         return s.foe("01 00 00 00 00 00 66 77");
       },
       4,
       {{"length", 0, 2, kAll, 10, "SOEM, IgH (data are length - 6, less than full ends the file)"},
        {"operation", 6, 1, kAll, 3, "SOEM, IgH"},
        {"reserved", 7, 1, kAll, 0, "the standard"},
        {"packet", 8, 4, kAll, 1, "SOEM, IgH (counts from 1)"},
        {"data", 12, 4, kAll, 0xDDCCBBAA, "SOEM, IgH"}}},
      // EoE.
      {"EoeSetIpResponse",
       [](Slave& s) { return s.eoe("02 01 00 00 06 00 00 00 02 09 A8 C0 00 FF FF FF"); },
       2,
       {{"length", 0, 2, kAll, 4, "IgH (not below 4)"},
        {"frame type", 6, 1, 0x0F, 3, "SOEM, IgH, SOES"},
        {"port", 6, 1, 0xF0, 0, "SOEM"},
        {"last fragment", 7, 1, kAll, 1, "SOES"},
        {"result", 8, 2, kAll, 0, "SOEM, IgH"}}},
      {"EoeSetIpRefused",
       [](Slave& s) { return s.eoe("02 01 00 00 3F 00 00 00"); },
       2,
       {{"frame type", 6, 1, 0x0F, 3, "SOEM, IgH, SOES"}, {"result", 8, 2, kAll, 1, "SOEM, IgH"}}},
      {"EoeGetIpResponse",
       [](Slave& s) {
         s.eoe("02 01 00 00 06 00 00 00 02 09 A8 C0 00 FF FF FF");
         return s.eoe("06 01 00 00");
       },
       2,
       {{"frame type", 6, 1, 0x0F, 7, "SOEM, SOES"},
        {"flags", 10, 4, kAll, 0x06, "SOEM, SOES (what follows, without gaps)"},
        {"address", 14, 4, kAll, 0xC0A80902, "SOEM, SOES (last octet first)"},
        {"subnet mask", 18, 4, kAll, 0xFFFFFF00, "SOEM, SOES"}}},
      {"EoeTimeStamp",
       [](Slave& s) {
         Bytes frame = hex("00 05 80 50");  // one fragment, time requested, frame number 5
         frame.resize(4 + 60);
         return s.exchange(s.soem.message(2, frame));
       },
       2,
       {{"length", 0, 2, kAll, 8, "the standard"},
        {"frame type", 6, 1, 0x0F, 1, "the standard"},
        {"frame number", 8, 2, 0xF000, 0x5000, "the standard"}}},
      {"EoeFilterResponse",
       [](Slave& s) { return s.eoe("04 01 00 00"); },
       2,
       {{"frame type", 6, 1, 0x0F, 5, "SOES"}, {"result", 8, 2, kAll, 0x0401, "SOES"}}},
  };
}

class MailboxField : public ::testing::TestWithParam<Message> {};

TEST_P(MailboxField, IsWhatEveryMasterThatLooksAtItDemands) {
  const Message& expected = GetParam();
  Slave slave;
  const Bytes message = expected.provoke(slave);
  ASSERT_GE(message.size(), 10U);
  const std::string whole = to_hex(message);

  // The mailbox header is the same for all: KickCAT takes a set bit 15 of the address for a message
  // of its gateway; a counter of 0 would say that nothing is counted.
  EXPECT_EQ(number(part(message, 2, 2)), 0U) << "address, looked at by KickCAT\n" << whole;
  EXPECT_EQ(number(part(message, 4, 1)), 0U) << "channel and priority\n" << whole;
  EXPECT_EQ(number(part(message, 5, 1)) & 0x0F, expected.type) << "type, looked at by all\n"
                                                               << whole;
  EXPECT_NE(number(part(message, 5, 1)) & 0x70, 0U) << "counter\n" << whole;
  EXPECT_EQ(number(part(message, 5, 1)) & 0x80, 0U) << "reserved bit\n" << whole;
  for (const Field& field : expected.fields) {
    ASSERT_GE(message.size(), field.offset + field.bytes) << field.name << '\n' << whole;
    EXPECT_EQ(number(part(message, field.offset, field.bytes)) & field.mask, field.value)
        << field.name << " at " << field.offset << ", looked at by " << field.demanded_by << '\n'
        << whole;
  }
}

INSTANTIATE_TEST_SUITE_P(OfEachMessage, MailboxField, ::testing::ValuesIn(messages()),
                         [](const auto& tested) { return std::string(tested.param.name); });

TEST(MailboxCounter, GoesFromOneToSevenWithEachMessageOfTheSlave) {
  Slave slave;
  auto before = number(part(slave.sdo(Slave::request(0x40, 0x1018, 1)), 5, 1)) >> 4;
  for (int k = 0; k < 16; ++k) {
    // Answers, aborts and errors of the mailbox share one counter.
    const Bytes answer = k % 3 == 0   ? slave.sdo(Slave::request(0x40, 0x1018, 1))
                         : k % 3 == 1 ? slave.sdo(Slave::request(0x40, 0x5FFF, 0))
                                      : slave.exchange(slave.soem.message(15, zeros(8)));
    const auto now = number(part(answer, 5, 1)) >> 4;
    EXPECT_EQ(now, before % 7 + 1);
    before = now;
  }
}

}  // namespace
}  // namespace stator::tests

// Cases of the CiA conformance test, group 3: PDO. Numbers are those of the test tool.

#include <gtest/gtest.h>

#include "canopen/conformance_device.hpp"

namespace stator::canopen::test {
namespace {

using namespace base::literals;

constexpr std::uint32_t kTransmit1 = 0x180 + kNodeId;

TEST(ConformanceCase, Case3_01_02_PdosAreFoundOnTheirCobIds) {
  ConformanceDevice device;
  for (std::uint16_t number = 0; number < 4; ++number) {
    EXPECT_EQ(device.upload_number(static_cast<std::uint16_t>(0x1400 + number), 1) & 0x800007FF,
              0x200U + 0x100U * number + kNodeId);
    EXPECT_EQ(device.upload_number(static_cast<std::uint16_t>(0x1800 + number), 1) & 0x800007FF,
              0x180U + 0x100U * number + kNodeId);
  }
  EXPECT_NE(device.upload_number(0x1404, 1) & kCobIdInvalid, 0U);
}

/// What triggers transmit PDO 1 in cases 03 to 20.
struct Trigger {
  const char* number;
  const char* about;
  std::uint8_t type;
  void (*prepare)(ConformanceDevice&);
  void (*pull)(ConformanceDevice&);
};

void nothing(ConformanceDevice& /*device*/) {}
void change_a_value(ConformanceDevice& device) {
  device.set(0x2011, 0, device.value(0x2011) + 1);
  device.pdos.values_may_have_changed(device.now);
  device.wait(1_ms);
}
void send_a_sync(ConformanceDevice& device) {
  device.sync();
}
void send_sync_with_counter(ConformanceDevice& device) {
  device.send(can::data_frame(0x80, {3}));
}

const Trigger kTriggers[] = {
    {"03", "remote frame", 253, nothing,
     [](ConformanceDevice& device) { device.send(can::remote_frame(kTransmit1)); }},
    {"04", "event", 254, nothing, change_a_value},
    {"05", "event timer", 254,
     [](ConformanceDevice& device) { EXPECT_EQ(device.download(0x1800, 5, 100), 0U); },
     [](ConformanceDevice& device) { device.wait(100_ms); }},
    {"06", "cyclic synchronous", 1, nothing, send_a_sync},
    {"07", "acyclic synchronous", 0, nothing, send_a_sync},
    {"08", "SYNC start value", 1,
     [](ConformanceDevice& device) {
       EXPECT_EQ(device.download(0x1019, 0, 10), 0U);
       EXPECT_EQ(device.download(0x1800, 1, kCobIdInvalid | kTransmit1), 0U);
       EXPECT_EQ(device.download(0x1800, 6, 3), 0U);
       EXPECT_EQ(device.download(0x1800, 1, kTransmit1), 0U);
     },
     send_sync_with_counter},
};

TEST(ConformanceCase, Case3_03_08_TransmitPdo_IsSentInOperational) {
  for (const Trigger& trigger : kTriggers) {
    ConformanceDevice device;
    device.configure_pdo(0x1800, trigger.type, {0x20110010});
    trigger.prepare(device);
    device.operational();
    EXPECT_EQ(device.take_count(kTransmit1), trigger.type >= 254 ? 1U : 0U)
        << trigger.about << ": event-driven ones are sent at the start";
    trigger.pull(device);
    EXPECT_EQ(device.take_count(kTransmit1), 1U) << trigger.number << ": " << trigger.about;
  }
}

TEST(ConformanceCase, Case3_09_20_TransmitPdo_IsNotSentInStoppedAndPreOperational) {
  for (const NmtCommand state : {NmtCommand::stop, NmtCommand::enter_pre_operational}) {
    for (const Trigger& trigger : kTriggers) {
      ConformanceDevice device;
      device.configure_pdo(0x1800, trigger.type, {0x20110010});
      trigger.prepare(device);
      device.operational();
      device.nmt(state);
      device.take_sent();
      trigger.pull(device);
      EXPECT_EQ(device.take_count(kTransmit1), 0U) << trigger.number << ": " << trigger.about;
    }
  }
}

TEST(ConformanceCase, Case3_07_AcyclicSynchronousPdo_AnswersEachReconfigurationAtTheSync) {
  ConformanceDevice device;
  device.operational();
  for (int round = 0; round < 3; ++round) {
    device.configure_pdo(0x1800, 0, {0x20110010});
    device.nmt(NmtCommand::start);
    device.take_sent();
    device.sync();
    EXPECT_EQ(device.take_count(kTransmit1), 1U) << round;
    device.sync();
    EXPECT_EQ(device.take_count(kTransmit1), 0U) << "the value is constant";
  }
}

TEST(ConformanceCase, Case3_21_DefaultMappings_NameObjectsThatExist) {
  ConformanceDevice device;
  for (const std::uint16_t first : {std::uint16_t{0x1600}, std::uint16_t{0x1A00}}) {
    for (std::uint16_t index = first; index < first + 5; ++index) {
      const std::uint32_t count = device.upload_number(index, 0);
      for (std::uint8_t subindex = 1; subindex <= count; ++subindex) {
        const std::uint32_t mapped = device.upload_number(index, subindex);
        EXPECT_EQ(device.upload(static_cast<std::uint16_t>(mapped >> 16U),
                                static_cast<std::uint8_t>(mapped >> 8U & 0xFFU))
                          .bytes.size() *
                      8,
                  mapped & 0xFF);
      }
    }
  }
}

TEST(ConformanceCase, Case3_22_CompleteRemapping_Succeeds) {
  ConformanceDevice device;
  device.configure_pdo(0x1400, 255, {0x20030020, 0x20010008});
  device.configure_pdo(0x1800, 255, {0x20120020, 0x20100008});
  device.operational();
  device.send(can::data_frame(0x205, {1, 2, 3, 4, 5}));
  EXPECT_EQ(device.upload_number(0x2003, 0), 0x04030201U);
  EXPECT_EQ(device.upload_number(0x2001, 0), 5U);
  EXPECT_EQ(device.take_sent().front(), can::data_frame(kTransmit1, {0, 0, 0, 0, 0}));
}

TEST(ConformanceCase, Case3_23_EntryWithoutCountZero_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1400, 1, 0x80000205), 0U);
  EXPECT_EQ(device.download(0x1600, 1, 0x20010008), 0x06010000U);
  EXPECT_EQ(device.download(0x1800, 1, 0x80000185), 0U);
  EXPECT_EQ(device.download(0x1A00, 1, 0x20100008), 0x06010000U);
}

TEST(ConformanceCase, Case3_24_RemappingOfAValidPdo_IsRefused) {
  ConformanceDevice device;
  EXPECT_EQ(device.download(0x1600, 0, 0), 0x06010000U);
  EXPECT_EQ(device.download(0x1A00, 0, 0), 0x06010000U);
}

/// A mapping that is tried in cases 25 to 33, and the answer to its last write.
struct MappingCase {
  const char* number;
  const char* about;
  std::uint16_t communication;
  std::uint8_t entries;  ///< how many times
  std::uint32_t object;
  std::uint32_t entry_abort;
  std::uint32_t count_abort;
};

constexpr MappingCase kMappingCases[] = {
    {"25", "nine entries, receive", 0x1400, 9, 0x20010008, 0, 0x06040042},
    {"25", "nine entries, transmit", 0x1800, 9, 0x20100008, 0, 0x06040042},
    {"26", "eight long entries, receive", 0x1400, 8, 0x20030020, 0, 0x06040042},
    {"26", "eight long entries, transmit", 0x1800, 8, 0x20120020, 0, 0x06040042},
    {"27", "rww object to receive", 0x1400, 1, 0x20010008, 0, 0},
    {"27", "wo object to receive", 0x1400, 1, 0x20040020, 0, 0},
    {"28", "ro object to receive", 0x1400, 1, 0x20100008, 0x06040041, 0x06020000},
    {"29", "object that cannot be mapped, receive", 0x1400, 1, 0x20200020, 0x06040041, 0x06020000},
    {"30", "ro object to transmit", 0x1800, 1, 0x20100008, 0, 0},
    {"31", "rww object to transmit", 0x1800, 1, 0x20010008, 0x06040041, 0x06020000},
    {"31", "wo object to transmit", 0x1800, 1, 0x20040020, 0x06040041, 0x06020000},
    {"32", "object that cannot be mapped, transmit", 0x1800, 1, 0x20200020, 0x06040041, 0x06020000},
    {"33", "gap as DummyUsage says", 0x1400, 1, 0x00020008, 0, 0},
};

TEST(ConformanceCase, Case3_25_33_Mappings_HaveThePreciseAnswer) {
  for (const MappingCase& mapping : kMappingCases) {
    ConformanceDevice device;
    const auto index = static_cast<std::uint16_t>(mapping.communication + 0x200);
    const std::uint32_t cob_id = device.upload_number(mapping.communication, 1);
    EXPECT_EQ(device.download(mapping.communication, 1, cob_id | kCobIdInvalid), 0U);
    EXPECT_EQ(device.download(index, 0, 0), 0U);
    EXPECT_EQ(device.download(index, 1, 0), 0U);
    for (std::uint8_t subindex = 1; subindex <= mapping.entries; ++subindex) {
      EXPECT_EQ(device.download(index, subindex, mapping.object), mapping.entry_abort)
          << mapping.number << ": " << mapping.about;
    }
    EXPECT_EQ(device.download(index, 0, mapping.entries), mapping.count_abort)
        << mapping.number << ": " << mapping.about;
  }
}

}  // namespace
}  // namespace stator::canopen::test

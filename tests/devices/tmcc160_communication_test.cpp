// PDOs, SYNC, emergencies and stored parameters as a master meets them at the device: requirements
// ERR, SYN, EMO, STO, RPD and TPD.

#include <optional>

#include <gtest/gtest.h>

#include "devices/tmcc160_module.hpp"

namespace stator::tests {
namespace {

using AbortCode = dictionary::AbortCode;
constexpr AbortCode kNoError = Tmcc160Module::kNoError;
constexpr std::uint32_t kSave = 0x65766173;
constexpr std::uint32_t kLoad = 0x64616F6C;
/// Subindices of 1010h and 1011h.
constexpr std::array<std::uint8_t, 3> kGroups{1, 2, 4};

/// Frames with an identifier among those taken since frames.clear().
std::vector<can::Frame> with(const Tmcc160Module& module, std::uint32_t identifier) {
  std::vector<can::Frame> found;
  std::ranges::copy_if(module.frames, std::back_inserter(found),
                       [=](const can::Frame& frame) { return frame.identifier == identifier; });
  return found;
}

struct Tmcc160Communication : testing::Test {
  /// Sets up a PDO as the document says (L876-L879, L969-L973).
  void map(std::uint16_t communication, std::initializer_list<std::uint32_t> objects,
           std::uint8_t type) {
    const auto mapping = static_cast<std::uint16_t>(communication + 0x200);
    const std::int64_t cob_id = module.read(communication, 1);
    EXPECT_EQ(module.write(communication, 1, cob_id | 0x80000000), kNoError);
    EXPECT_EQ(module.write(communication, 2, type), kNoError);
    EXPECT_EQ(module.write(mapping, 0, 0), kNoError);
    std::uint8_t subindex = 0;
    for (const std::uint32_t object : objects) {
      EXPECT_EQ(module.write(mapping, ++subindex, object), kNoError) << object;
    }
    EXPECT_EQ(module.write(mapping, 0, subindex), kNoError);
    EXPECT_EQ(module.write(communication, 1, cob_id), kNoError);
    module.wait(2);
    module.frames.clear();
  }
  std::size_t count(std::uint32_t identifier) const { return with(module, identifier).size(); }
  void sync() { module.send(can::data_frame(0x080, {})); }

  Tmcc160Module module;
};

// Error register and error behaviour.

TEST_F(Tmcc160Communication, ErrorRegisterIsReadOnlyAndZeroWithoutErrors) {
  module.boot(true);
  EXPECT_EQ(module.read(0x1001), 0);
  EXPECT_EQ(module.write(0x1001, 0, 1), AbortCode::read_only);
  EXPECT_EQ(module.write(0x1800, 1, 0xC0000181), kNoError);
  EXPECT_EQ(module.write(0x1A00, 0, 0), kNoError);
  EXPECT_EQ(module.write(0x1A00, 1, 0x10010008), AbortCode::not_mappable);
  module.send(can::data_frame(0x201, {6}));
  EXPECT_EQ(module.read(0x1001), 0x11);
  module.send(can::data_frame(0x201, {6, 0}));
  EXPECT_EQ(module.read(0x1001), 0);
  module.upload(0x1003, 0);
  EXPECT_EQ(module.abort, AbortCode::object_does_not_exist) << "no error history";
}

TEST_F(Tmcc160Communication, ErrorBehaviourTakesZeroForStoppedAndOneForNothing) {
  module.boot();
  EXPECT_EQ(module.read(0x1029, 0), 2);
  EXPECT_EQ(module.read(0x1029, 1), 0);
  EXPECT_EQ(module.read(0x1029, 2), 1);
  EXPECT_EQ(module.write(0x1029, 1, 2), AbortCode::value_range_exceeded);
  EXPECT_EQ(module.write(0x1029, 2, 0), kNoError);
  for (const int value : {0, 1}) {
    EXPECT_EQ(module.write(0x1029, 1, value), kNoError);
    EXPECT_EQ(module.write(0x1016, 1, 0x7F << 16 | 100), kNoError);
    module.nmt(1);
    module.send(can::data_frame(0x77F, {5}));
    module.wait(200);
    EXPECT_EQ(module.device->node().state(),
              value == 0 ? canopen::NmtState::stopped : canopen::NmtState::operational);
    module.nmt(128);
    module.wait(2);
  }
}

TEST_F(Tmcc160Communication, ErrorsFoundInPreOperationalDoNotStopTheNode) {
  module.boot();
  EXPECT_EQ(module.write(0x1016, 1, 0x7F << 16 | 100), kNoError);
  module.send(can::data_frame(0x77F, {5}));
  module.wait(200);
  EXPECT_EQ(module.device->node().state(), canopen::NmtState::pre_operational);
}

TEST_F(Tmcc160Communication, AMissingHeartbeatTakesTheRunningDriveToFault) {
  module.boot();
  module.enable(3);
  EXPECT_EQ(module.write(0x1016, 1, 0x7F << 16 | 100), kNoError);
  module.nmt(1);
  module.send(can::data_frame(0x77F, {5}));
  module.wait(1'500);
  EXPECT_EQ(module.device->node().state(), canopen::NmtState::stopped);
  EXPECT_EQ(module.device->axis().power_state(), drive::PowerState::fault);
}

// SYNC.

TEST_F(Tmcc160Communication, SyncIsConsumedOnlyAndItsCanIdCanBeChosen) {
  module.boot(true);
  EXPECT_EQ(module.read(0x1005), 0x80);
  EXPECT_EQ(module.write(0x1005, 0, 0x40000080), AbortCode::value_range_exceeded) << "bit 30";
  EXPECT_EQ(module.write(0x1005, 0, 0x20000080), AbortCode::value_range_exceeded) << "bit 29";
  EXPECT_EQ(module.write(0x1005, 0, 0x00000880), AbortCode::value_range_exceeded) << "bit 11";
  EXPECT_EQ(module.write(0x1005, 0, 0x181), AbortCode::value_range_exceeded) << "TPDO 1";
  EXPECT_EQ(module.write(0x1005, 0, 0x0A0), kNoError);
  module.frames.clear();
  sync();
  EXPECT_EQ(count(0x381), 0U);
  module.send(can::data_frame(0x0A0, {}));
  EXPECT_EQ(count(0x381), 1U);
  for (const int index : {0x1006, 0x1007, 0x1019}) {
    module.upload(static_cast<std::uint16_t>(index), 0);
    EXPECT_EQ(module.abort, AbortCode::object_does_not_exist) << index;
  }
}

TEST_F(Tmcc160Communication, SyncMovesProcessDataInOperationalOnly) {
  module.boot();
  module.frames.clear();
  sync();
  module.nmt(2);
  sync();
  EXPECT_EQ(count(0x381), 0U);
  module.nmt(1);
  sync();
  EXPECT_EQ(count(0x381), 1U);
}

TEST_F(Tmcc160Communication, RestrictedCanIdsAreRefused) {
  module.boot();
  const auto refused = AbortCode::value_range_exceeded;
  for (const std::uint32_t can_id : {0x000U, 0x001U, 0x07FU, 0x101U, 0x180U, 0x581U, 0x5FFU, 0x601U,
                                     0x67FU, 0x6E0U, 0x6FFU, 0x701U, 0x77FU, 0x780U, 0x7FFU}) {
    EXPECT_EQ(module.write(0x1005, 0, can_id), refused) << can_id;
    EXPECT_EQ(module.write(0x1014, 0, can_id), refused) << can_id;
    EXPECT_EQ(module.write(0x1400, 1, 0x40000000 | can_id), refused) << can_id;
    EXPECT_EQ(module.write(0x1800, 1, 0x40000000 | can_id), refused) << can_id;
  }
}

// Emergencies.

TEST_F(Tmcc160Communication, EmergenciesFollowTheirCobId) {
  module.boot(true);
  EXPECT_EQ(module.read(0x1014), 0x81);
  EXPECT_EQ(module.read(0x1015), 0);
  EXPECT_EQ(module.write(0x1014, 0, 0x123), AbortCode::value_range_exceeded) << "restricted";
  EXPECT_EQ(module.write(0x1014, 0, 0x223), kNoError);
  module.send(can::data_frame(0x201, {6}));
  EXPECT_EQ(count(0x223), 1U);
  EXPECT_EQ(module.write(0x1014, 0, 0x80000223), kNoError);
  module.send(can::data_frame(0x301, {6}));
  EXPECT_EQ(count(0x223), 0U) << "switched off";
}

// Store and restore.

class SlowMemory final : public canopen::NonVolatileMemory {
 public:
  [[nodiscard]] std::span<const std::byte> image(std::uint8_t /*group*/) const override {
    return {};
  }
  void store(std::span<const GroupImage> images) override {
    ++orders;
    groups += images.size();
    present = next.value_or(present);
  }
  [[nodiscard]] Status status() const override { return present; }
  Status present = Status::ready;
  std::optional<Status> next;  ///< what an order leads to
  int orders = 0;
  std::size_t groups = 0;  ///< of all orders
};

TEST_F(Tmcc160Communication, GroupsTellThatTheyCanBeStoredAndRestored) {
  module.boot();
  for (const std::uint16_t index : {std::uint16_t{0x1010}, std::uint16_t{0x1011}}) {
    EXPECT_EQ(module.read(index, 0), 4);
    for (const std::uint8_t subindex : kGroups) {
      EXPECT_EQ(module.read(index, subindex), 1);
    }
    module.upload(index, 3);
    EXPECT_EQ(module.abort, AbortCode::subindex_does_not_exist);
  }
}

TEST_F(Tmcc160Communication, OnlyTheSignatureStoresAndRestores) {
  SlowMemory memory;
  module.device->connect_memory(memory);
  module.boot();
  for (const std::uint8_t subindex : kGroups) {
    for (const std::uint32_t wrong : {0U, 1U, 0x73617665U, kLoad}) {
      EXPECT_EQ(module.write(0x1010, subindex, wrong), AbortCode::cannot_store);
    }
    EXPECT_EQ(module.write(0x1011, subindex, kSave), AbortCode::cannot_store);
  }
  EXPECT_EQ(memory.orders, 0);
  EXPECT_EQ(module.write(0x1010, 1, kSave), kNoError);
  EXPECT_EQ(module.write(0x1011, 4, kLoad), kNoError);
  EXPECT_EQ(memory.orders, 2) << "one each, whatever it names";
  EXPECT_EQ(memory.groups, 5U) << "groups 2 and 4 stored, group 4 restored; with 4 its scale";
}

TEST_F(Tmcc160Communication, StoringIsConfirmedWhenItIsDoneAndAbortedWhenItFails) {
  using Status = canopen::NonVolatileMemory::Status;
  SlowMemory memory;
  module.device->connect_memory(memory);
  module.boot();
  for (const auto& [index, signature] : {std::pair{0x1010U, kSave}, {0x1011U, kLoad}}) {
    memory.present = Status::failed;
    EXPECT_EQ(module.write(static_cast<std::uint16_t>(index), 1, signature),
              AbortCode::hardware_error);
    memory.present = Status::ready;
    memory.next = Status::busy;
    module.frames.clear();
    const can::Frame request = can::data_frame(
        0x601, {0x23, index & 0xFFU, index >> 8U, 1, signature & 0xFFU, signature >> 8U & 0xFFU,
                signature >> 16U & 0xFFU, signature >> 24U});
    module.send(request);
    module.wait(100);
    EXPECT_EQ(count(0x581), 0U) << "not done yet";
    memory.next.reset();
    memory.present = Status::ready;
    module.wait(3);
    ASSERT_EQ(count(0x581), 1U);
    EXPECT_EQ(with(module, 0x581).front().data[0], std::byte{0x60});
  }
}

TEST_F(Tmcc160Communication, ProcessDataSettingsAndIdentityAreNotStored) {
  module.boot();
  EXPECT_EQ(module.write(0x1005, 0, 0xA0), kNoError);
  EXPECT_EQ(module.write(0x1017, 0, 1'000), kNoError);
  EXPECT_EQ(module.write(0x1802, 5, 50), kNoError);
  EXPECT_EQ(module.write(0x1010, 1, kSave), kNoError);
  module.nmt(129);
  module.wait(110);
  EXPECT_EQ(module.read(0x1005), 0x80);
  EXPECT_EQ(module.read(0x1017), 0);
  EXPECT_EQ(module.read(0x1802, 5), 0);
}

TEST_F(Tmcc160Communication, GroupTwoHoldsBitRateAndNodeIdOnly) {
  module.boot();
  EXPECT_EQ(module.write(0x2705, 0, 9), kNoError);
  EXPECT_EQ(module.write(0x6081, 0, 777), kNoError);
  EXPECT_EQ(module.write(0x1010, 2, kSave), kNoError);
  module.nmt(129);
  module.wait(110);
  module.node_id = 9;
  EXPECT_EQ(module.read(0x2708), 9);
  EXPECT_EQ(module.read(0x6081), 0);
  EXPECT_EQ(module.write(0x1011, 2, kLoad), kNoError);
  EXPECT_EQ(module.read(0x2708), 9) << "until the next reset";
  module.nmt(129);
  module.wait(110);
  module.node_id = 1;
  EXPECT_EQ(module.read(0x2708), 1);
}

// Receive PDOs.

TEST_F(Tmcc160Communication, ReceivePdosActInOperationalOnly) {
  module.boot();
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(module.read(0x60FF), 0);
  module.nmt(1);
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(module.read(0x60FF), 10);
  module.nmt(2);
  module.send(can::data_frame(0x501, {0, 0, 20, 0, 0, 0}));
  module.nmt(128);
  EXPECT_EQ(module.read(0x60FF), 10);
}

TEST_F(Tmcc160Communication, SynchronousReceivePdosActAtTheNextSync) {
  module.boot(true);
  map(0x1403, {0x60400010, 0x60FF0020}, 0);
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(module.read(0x60FF), 0);
  sync();
  EXPECT_EQ(module.read(0x60FF), 10);
}

TEST_F(Tmcc160Communication, CobIdsOfPdosKeepBit30AndBit31SwitchesThemOff) {
  module.boot(true);
  for (std::uint16_t number = 0; number < 4; ++number) {
    const auto receive = static_cast<std::uint16_t>(0x1400 + number);
    const auto transmit = static_cast<std::uint16_t>(0x1800 + number);
    EXPECT_EQ(module.read(receive, 1), 0x40000201 + 0x100 * number);
    EXPECT_EQ(module.read(transmit, 1), 0x40000181 + 0x100 * number);
    for (const std::uint16_t index : {receive, transmit}) {
      const std::int64_t cob_id = module.read(index, 1);
      EXPECT_EQ(module.write(index, 1, cob_id & ~0x40000000), AbortCode::value_range_exceeded);
      EXPECT_EQ(module.write(index, 1, cob_id | 0x20000000), AbortCode::value_range_exceeded);
      EXPECT_EQ(module.write(index, 1, cob_id + 8), AbortCode::device_state)
          << "while it is active";
      EXPECT_EQ(module.write(index, 1, cob_id | 0x80000000), kNoError);
    }
  }
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(module.read(0x60FF), 0) << "inactive";
  module.frames.clear();
  sync();
  EXPECT_EQ(count(0x381), 0U) << "inactive";
}

TEST_F(Tmcc160Communication, MappingFollowsTheProcedureOnly) {
  module.boot(true);
  EXPECT_EQ(module.write(0x1600, 0, 0), AbortCode::device_state) << "the PDO is active";
  EXPECT_EQ(module.write(0x1A00, 1, 0x60640020), AbortCode::device_state);
  EXPECT_EQ(module.write(0x1400, 1, 0xC0000201), kNoError);
  EXPECT_EQ(module.write(0x1600, 1, 0x60FF0020), AbortCode::device_state) << "one entry is active";
  EXPECT_EQ(module.write(0x1600, 0, 0), kNoError);
  EXPECT_EQ(module.write(0x1600, 1, 0x60410010), AbortCode::not_mappable);
  EXPECT_EQ(module.write(0x1600, 1, 0x60810020), AbortCode::not_mappable);
  EXPECT_EQ(module.write(0x1600, 1, 0x60400008), AbortCode::length_mismatch);
  EXPECT_EQ(module.write(0x1600, 1, 0x60FF0020), kNoError);
  EXPECT_EQ(module.write(0x1600, 2, 0x607A0020), kNoError);
  EXPECT_EQ(module.write(0x1600, 3, 0x60400010), kNoError);
  EXPECT_EQ(module.write(0x1600, 4, 0x60400010), AbortCode::subindex_does_not_exist);
  EXPECT_EQ(module.write(0x1600, 0, 4), AbortCode::value_too_high);
  EXPECT_EQ(module.write(0x1600, 0, 3), AbortCode::pdo_length_exceeded) << "80 bits";
  EXPECT_EQ(module.write(0x1600, 0, 2), kNoError);
  EXPECT_EQ(module.write(0x1400, 1, 0x40000201), kNoError);
  module.send(can::data_frame(0x201, {1, 0, 0, 0, 2, 0, 0, 0}));
  EXPECT_EQ(module.read(0x60FF), 1);
  EXPECT_EQ(module.read(0x607A), 2);
}

TEST_F(Tmcc160Communication, PdosOfTheWrongLengthAreNotProcessed) {
  module.boot(true);
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0}));
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0, 0, 0}));
  EXPECT_EQ(module.read(0x60FF), 0);
  EXPECT_EQ(module.take_emergencies(),
            (std::vector<std::string>{"10 82 11 00 FF 00 00 00", "00 00 00 00 00 00 00 00",
                                      "20 82 11 00 FF 00 00 00"}));
}

// Transmit PDOs.

TEST_F(Tmcc160Communication, EventDrivenTransmitPdosAreSentAtTheStartAndWithEachChange) {
  module.boot();
  module.frames.clear();
  module.nmt(1);
  EXPECT_EQ(count(0x181), 1U);
  EXPECT_EQ(count(0x281), 1U);
  EXPECT_EQ(count(0x381) + count(0x481), 0U) << "synchronous ones";
  module.frames.clear();
  module.wait(100);
  EXPECT_EQ(count(0x181), 0U) << "nothing changes";
  module.send(can::data_frame(0x201, {6, 0}));
  EXPECT_EQ(count(0x181), 1U);
}

TEST_F(Tmcc160Communication, TransmitPdosAreSentInOperationalOnly) {
  module.boot();
  EXPECT_EQ(module.write(0x1800, 5, 10), kNoError);
  module.frames.clear();
  module.wait(100);
  EXPECT_TRUE(module.frames.empty());
  module.nmt(2);
  sync();
  module.wait(100);
  EXPECT_TRUE(module.frames.empty());
}

TEST_F(Tmcc160Communication, EventTimerSendsEach250Milliseconds) {
  module.boot(true);
  EXPECT_EQ(module.write(0x1800, 5, 250), kNoError);
  module.wait(2);
  module.frames.clear();
  module.wait(1'000);
  EXPECT_EQ(count(0x181), 4U);
}

TEST_F(Tmcc160Communication, InhibitTimeIsInMilliseconds) {
  module.boot(true);
  EXPECT_EQ(module.write(0x1800, 3, 100), AbortCode::device_state) << "while it is active";
  EXPECT_EQ(module.write(0x1800, 1, 0xC0000181), kNoError);
  EXPECT_EQ(module.write(0x1800, 3, 100), kNoError);
  EXPECT_EQ(module.write(0x1800, 1, 0x40000181), kNoError);
  module.wait(250);
  module.frames.clear();
  module.send(can::data_frame(0x201, {6, 0}));
  module.send(can::data_frame(0x201, {7, 0}));
  EXPECT_EQ(count(0x181), 1U);
  module.wait(98);
  EXPECT_EQ(count(0x181), 1U);
  module.wait(4);
  EXPECT_EQ(count(0x181), 2U);
}

TEST_F(Tmcc160Communication, WritesToATransmitPdoDoNotBreakItsInhibitTime) {
  module.boot(true);
  EXPECT_EQ(module.write(0x1800, 1, 0xC0000181), kNoError);
  EXPECT_EQ(module.write(0x1800, 3, 1'000), kNoError);
  EXPECT_EQ(module.write(0x1800, 1, 0x40000181), kNoError);
  module.wait(2'500);
  module.frames.clear();
  module.send(can::data_frame(0x201, {6, 0}));
  EXPECT_EQ(count(0x181), 1U);
  for (const std::uint8_t subindex : std::to_array<std::uint8_t>({1, 2, 3, 5})) {
    const std::int64_t same = module.read(0x1800, subindex);
    EXPECT_EQ(module.write(0x1800, subindex, same), kNoError);
    module.wait(2);
    EXPECT_EQ(count(0x181), 0U) << int{subindex};
  }
  EXPECT_EQ(module.write(0x1800, 2, 254), kNoError);
  EXPECT_EQ(module.write(0x1800, 5, 10), kNoError);
  EXPECT_EQ(module.write(0x1800, 5, 0), kNoError);
  module.frames.clear();
  module.wait(900);
  EXPECT_EQ(count(0x181), 0U);
  module.wait(100);
  EXPECT_EQ(count(0x181), 1U) << "the change of the type is an event";
}

TEST_F(Tmcc160Communication, WritesToAReceivePdoLeaveWhatWaitsForItsSync) {
  module.boot(true);
  map(0x1403, {0x60400010, 0x60FF0020}, 0);
  module.send(can::data_frame(0x501, {0, 0, 10, 0, 0, 0}));
  EXPECT_EQ(module.write(0x1403, 2, 0), kNoError);
  EXPECT_EQ(module.write(0x1402, 2, 0), kNoError);
  EXPECT_EQ(module.write(0x1403, 1, 0x40000501), kNoError);
  EXPECT_EQ(module.read(0x60FF), 0);
  sync();
  EXPECT_EQ(module.read(0x60FF), 10);
}

TEST_F(Tmcc160Communication, TypeZeroAnswersAnEventAtTheSyncAndTypeOneEverySync) {
  module.boot(true);
  map(0x1800, {0x60410010}, 0);
  sync();
  EXPECT_EQ(count(0x181), 1U) << "being set up is an event";
  sync();
  EXPECT_EQ(count(0x181), 1U);
  EXPECT_EQ(count(0x381), 2U) << "type 1";
  module.send(can::data_frame(0x201, {6, 0}));
  module.wait(2);
  EXPECT_EQ(count(0x181), 1U);
  sync();
  EXPECT_EQ(count(0x181), 2U);
}

TEST_F(Tmcc160Communication, RemoteRequestsForTransmitPdosAreNotAnswered) {
  module.boot(true);
  module.frames.clear();
  for (const std::uint32_t identifier : {0x181U, 0x281U, 0x381U, 0x481U, 0x080U}) {
    module.send(can::remote_frame(identifier));
  }
  module.wait(10);
  EXPECT_TRUE(module.frames.empty());
}

TEST_F(Tmcc160Communication, TransmitPdosCanBeRemapped) {
  module.boot(true);
  EXPECT_EQ(module.read(0x1800, 0), 5);
  EXPECT_EQ(module.write(0x1800, 4, 0), AbortCode::read_only);
  map(0x1800, {0x606C0020, 0x60410010, 0x60610008}, 1);
  sync();
  const std::vector<can::Frame> sent = with(module, 0x181);
  ASSERT_EQ(sent.size(), 1U);
  EXPECT_EQ(sent.front().length, 7);
}

}  // namespace
}  // namespace stator::tests

// Process data of the module: mappings and their rules, contents, values that cannot be taken.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "devices/tmcm_3315_module.hpp"

namespace stator::devices {
namespace {

using dictionary::Entry;
using dictionary::PdoMapping;

constexpr std::uint32_t kObjectMissing = 0x06020000;
constexpr std::uint32_t kSubindexMissing = 0x06090011;
constexpr std::uint32_t kNotMappable = 0x06040041;
constexpr std::uint32_t kPdoTooLong = 0x06040042;
constexpr std::uint32_t kWrongLength = 0x06070010;
constexpr std::uint32_t kSubindexZeroNotZero = 0x06010003;
constexpr std::uint32_t kIllegalValue = 0x06090030;

constexpr std::uint32_t mapping(std::uint16_t index, std::uint8_t subindex, std::size_t bits) {
  return std::uint32_t{index} << 16 | std::uint32_t{subindex} << 8 |
         static_cast<std::uint32_t>(bits);
}

class Tmcm3315ProcessData : public Tmcm3315Module {
 protected:
  std::uint32_t map(std::uint16_t pdo, std::uint8_t subindex, std::uint32_t entry) {
    return bus_->download<std::uint32_t>(pdo, subindex, entry);
  }
  /// Replaces the mapping of `pdo`, assigned by `assignment`, in the usual order.
  void replace(std::uint16_t assignment, std::uint16_t pdo,
               const std::vector<std::uint32_t>& entries) {
    write<std::uint8_t>(assignment, 0);
    write<std::uint8_t>(pdo, 0);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      write<std::uint32_t>(pdo, entries[i], static_cast<std::uint8_t>(i + 1));
    }
    write<std::uint8_t>(pdo, static_cast<std::uint8_t>(entries.size()));
    write<std::uint8_t>(assignment, 1);
  }
};

TEST_F(Tmcm3315ProcessData, EveryObjectStandsWhereTheDocumentSaysAndNowhereElse) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint8_t>(0x1600, 0);
  write<std::uint8_t>(0x1A00, 0);
  std::size_t mappable = 0;
  for (const Entry& entry : device_->dictionary().entries()) {
    const PdoMapping allowed = entry.declaration().mapping;
    const std::uint32_t value = mapping(entry.index(), entry.subindex(), entry.bits());
    for (const std::uint16_t pdo : std::to_array<std::uint16_t>({0x1600, 0x1A00})) {
      const bool fits = allowed == PdoMapping::both ||
                        allowed == (pdo == 0x1600 ? PdoMapping::receive : PdoMapping::transmit);
      mappable += fits ? 1U : 0U;
      EXPECT_EQ(map(pdo, 1, value), fits ? 0U : kNotMappable)
          << std::hex << pdo << ": " << entry.index() << ':' << unsigned{entry.subindex()};
    }
  }
  // Per axis 8 received and 8 transmitted objects; of the module 2 and 5.
  EXPECT_EQ(mappable, 3U * 16U + 7U);
}

TEST_F(Tmcm3315ProcessData, MappingRefusalsComeInTheOrderOfTheRules) {
  bus_->bring_to(AlState::pre_operational);
  EXPECT_EQ(map(0x1600, 1, mapping(0x2FFF, 0, 16)), kSubindexZeroNotZero)
      << "whatever it would map: the PDO is active";
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1600, 0, 10), kPdoTooLong);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1A00, 0, 10), kPdoTooLong);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1C12, 0, 2), kIllegalValue);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1C13, 0, 2), kIllegalValue);
  write<std::uint8_t>(0x1600, 0);
  write<std::uint8_t>(0x1A00, 0);
  EXPECT_EQ(map(0x1600, 1, mapping(0x2FFF, 0, 16)), kObjectMissing);
  EXPECT_EQ(map(0x1600, 1, mapping(0x6040, 1, 8)), kSubindexMissing);
  EXPECT_EQ(map(0x1600, 1, mapping(0x6041, 0, 8)), kNotMappable) << "before the wrong length";
  EXPECT_EQ(map(0x1600, 1, mapping(0x6040, 0, 8)), kWrongLength);
  EXPECT_EQ(map(0x1A00, 2, mapping(0x6064, 0, 8)), kWrongLength) << "as the document prints it";
  EXPECT_EQ(map(0x1600, 10, mapping(0x6040, 0, 16)), kSubindexMissing) << "nine entries at most";
  EXPECT_EQ(bus_->upload<std::uint32_t>(0x1600, 1), 0x60400010U) << "nothing was changed";
  EXPECT_EQ(map(0x1600, 1, 0), 0U);
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1600, 0, 9), kObjectMissing) << "an entry is empty";
  EXPECT_EQ(bus_->download<std::uint8_t>(0x1600, 0, 0), 0U);

  EXPECT_EQ(bus_->download<std::uint16_t>(0x1C12, 1, 0x1600), kSubindexZeroNotZero);
  write<std::uint8_t>(0x1C12, 0);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x1C12, 1, 0x1A00), kIllegalValue);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x1C12, 1, 0x1601), kIllegalValue);
  EXPECT_EQ(bus_->download<std::uint16_t>(0x1C12, 1, 0x1600), 0U);
}

TEST_F(Tmcm3315ProcessData, MappingsAreFixedFromSafeOperationalOn) {
  for (const AlState state : {AlState::safe_operational, AlState::operational}) {
    bus_->bring_to(state);
    for (const std::uint16_t index :
         std::to_array<std::uint16_t>({0x1600, 0x1A00, 0x1C12, 0x1C13})) {
      EXPECT_EQ(bus_->download<std::uint8_t>(index, 0, 0), kDeviceStateAbort);
    }
    EXPECT_EQ(map(0x1600, 1, 0x60400010), kDeviceStateAbort);
    EXPECT_EQ(bus_->download<std::uint16_t>(0x1C13, 1, 0x1A00), kDeviceStateAbort);
  }
}

TEST_F(Tmcm3315ProcessData, DefaultMappingsAreReadEntryByEntry) {
  constexpr std::array<std::uint32_t, 9> kReceived{0x60400010, 0x607A0020, 0x60FF0020,
                                                   0x68400010, 0x687A0020, 0x68FF0020,
                                                   0x70400010, 0x707A0020, 0x70FF0020};
  constexpr std::array<std::uint32_t, 9> kTransmitted{0x60410010, 0x60640020, 0x606C0020,
                                                      0x68410010, 0x68640020, 0x686C0020,
                                                      0x70410010, 0x70640020, 0x706C0020};
  bus_->bring_to(AlState::pre_operational);
  for (std::uint8_t i = 0; i < 9; ++i) {
    const auto subindex = static_cast<std::uint8_t>(i + 1);
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x1600, subindex), kReceived[i]);
    EXPECT_EQ(bus_->upload<std::uint32_t>(0x1A00, subindex), kTransmitted[i]);
  }
  for (std::uint8_t channel = 0; channel < 4; ++channel) {
    const auto subindex = static_cast<std::uint8_t>(channel + 1);
    EXPECT_EQ(bus_->upload<std::uint8_t>(0x1C00, subindex), subindex);
  }
  EXPECT_EQ(bus_->upload<std::uint16_t>(0x1C13, 1), 0x1A00);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1C12, 0), 1);
  EXPECT_EQ(bus_->upload<std::uint8_t>(0x1C13, 0), 1);
}

TEST_F(Tmcm3315ProcessData, InputsCarryStatuswordPositionAndVelocityOfEveryAxis) {
  go_operational();
  for (const unsigned motor : {0U, 2U}) {
    set_profile(motor, 100'000, 1'000'000);
  }
  enable(0, 1);
  start_move(0, 500'000);
  enable(2, 3);
  write<std::int32_t>(0x70FF, -100'000);
  bus_->pass(6_s);
  const auto inputs = bus_->read(device_->description().input_offset, 30);
  const auto word = [&](std::size_t axis) {
    return base::load_le<std::uint16_t>(inputs, 10 * axis);
  };
  const auto position = [&](std::size_t axis) {
    return base::load_le<std::int32_t>(inputs, 10 * axis + 2);
  };
  const auto velocity = [&](std::size_t axis) {
    return base::load_le<std::int32_t>(inputs, 10 * axis + 6);
  };
  EXPECT_EQ(word(0), 0x0637) << "Operation enabled, target reached, remote, standing";
  EXPECT_EQ(position(0), 500'000);
  EXPECT_EQ(velocity(0), 0);
  EXPECT_EQ(word(1), 0x0270) << "Switch on disabled, remote";
  EXPECT_EQ(position(1), 0);
  EXPECT_EQ(velocity(1), 0);
  EXPECT_EQ(word(2), 0xC637) << "moving, in negative direction";
  EXPECT_NEAR(position(2), -595'000, 1000);
  EXPECT_EQ(velocity(2), -100'000);
}

TEST_F(Tmcm3315ProcessData, EntriesBeyondTheCountAreIgnored) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint8_t>(0x1C12, 0);
  write<std::uint8_t>(0x1600, 0);
  write<std::uint8_t>(0x1600, 4);  // axis 0, and the controlword of axis 1
  write<std::uint8_t>(0x1C12, 1);
  bus_->set_output_length(12);
  bus_->bring_to(AlState::operational);
  base::store_le(bus_->outputs, 0, std::uint16_t{6});
  base::store_le(bus_->outputs, 10, std::uint16_t{6});
  bus_->exchange();
  EXPECT_EQ(statusword(0) & 0x006F, 0x0021);
  EXPECT_EQ(statusword(1) & 0x006F, 0x0021);
  EXPECT_EQ(statusword(2) & 0x006F, 0x0060);
}

TEST_F(Tmcm3315ProcessData, WithoutAssignedPdosThereIsNothingToExchange) {
  bus_->bring_to(AlState::pre_operational);
  write<std::uint8_t>(0x1C12, 0);
  bus_->set_output_length(0);
  bus_->bring_to(AlState::safe_operational);
  EXPECT_EQ(bus_->request(AlState::operational), 0x0008);
  enable(0, 1);
  bus_->pass(300_ms);
  EXPECT_EQ(statusword() & 0x006F, 0x0027) << "no outputs, no watchdog: SDOs command the axis";
}

TEST_F(Tmcm3315ProcessData, EachObjectTellsItsRefusalOnceUntilACorrectValueComes) {
  bus_->bring_to(AlState::pre_operational);
  replace(0x1C12, 0x1600, {0x60600008, 0x68600008, 0x60400010});
  bus_->set_output_length(4);
  bus_->bring_to(AlState::operational);
  const auto send = [&](int mode0, int mode1) {
    bus_->outputs[0] = static_cast<std::byte>(mode0);
    bus_->outputs[1] = static_cast<std::byte>(mode1);
    bus_->exchange();
    bus_->pass(1_ms);
  };
  const Emergency parameter_error{0x20, 0x63, 0x21, 0x00, 0xFF, 0x00, 0x00, 0x00};
  send(3, 1);
  EXPECT_TRUE(bus_->take_emergencies().empty());
  send(2, 1);
  send(7, 1);
  send(-1, 1);
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({parameter_error}))
      << "wrong in three ways, told once";
  EXPECT_EQ(bus_->upload<std::int8_t>(0x6060), 3) << "the old value stays";
  send(2, 4);
  EXPECT_EQ(bus_->take_emergencies(), std::vector<Emergency>({parameter_error})) << "axis 1 now";
  send(3, 4);
  send(2, 4);
  EXPECT_EQ(bus_->take_emergencies().size(), 1U) << "3, the value it has, re-arms axis 0";
  base::store_le(bus_->outputs, 2, std::uint16_t{6});
  bus_->exchange();
  EXPECT_EQ(statusword() & 0x006F, 0x0021) << "the rest of the frame is obeyed";
}

}  // namespace
}  // namespace stator::devices

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "devices/csv.hpp"
#include "source_paths.hpp"
#include "stator/base/random.hpp"
#include "stator/control/foc/foc_block.hpp"
#include "stator/control/foc/register_map.hpp"

namespace stator::control::foc {
namespace {

/// One row of the reference list.
struct Reference {
  std::uint8_t address;
  std::string name;
  std::string fields;
};

std::vector<Reference> reference_list() {
  std::ifstream file(STATOR_TEST_DATA "/tmc8670/foc_registers_reference.csv");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  std::vector<Reference> result;
  for (const tests::CsvRow& row : tests::parse_csv(text)) {
    if (row.at(0).starts_with("0x")) {
      result.push_back(
          {static_cast<std::uint8_t>(std::stoi(row[0], nullptr, 16)), row.at(1), row.at(2)});
    }
  }
  return result;
}

TEST(FocRegisterMap, HoldsTheRegistersOfTheReferenceList) {
  std::set<std::string> names;
  for (const auto& [address, name, text] : reference_list()) {
    const RegisterDescription* found = find_register(address);
    ASSERT_NE(found, nullptr) << name;
    EXPECT_EQ(found->name, name);
    names.insert(name);
  }
  EXPECT_EQ(names.size(), 105U);
  for (const RegisterDescription& description : registers()) {
    if (description.view == kPlain) {
      EXPECT_TRUE(names.contains(std::string(description.name))) << description.name;
    }
  }
}

/// "NAME[7:0]" or "NAME[7:0]s" of the reference list; other words have no bracket.
struct ListedField {
  std::string name;
  std::uint8_t high = 0;
  std::uint8_t low = 0;
  bool is_signed = false;
};
std::vector<ListedField> listed_fields(const std::string& text) {
  std::vector<ListedField> fields;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    const std::size_t open = word.find('[');
    const std::size_t colon = word.find(':');
    if (open == std::string::npos || colon == std::string::npos) {
      continue;
    }
    ListedField& field = fields.emplace_back();
    field.name.assign(word, 0, open);
    field.high = static_cast<std::uint8_t>(std::atoi(word.c_str() + open + 1));
    field.low = static_cast<std::uint8_t>(std::atoi(word.c_str() + colon + 1));
    field.is_signed = word.ends_with("]s");
  }
  return fields;
}

TEST(FocRegisterMap, HoldsTheFieldsOfTheReferenceList) {
  int compared = 0;
  for (const auto& [address, name, text] : reference_list()) {
    for (const ListedField& listed : listed_fields(text)) {
      const std::string& field_name = listed.name;
      const FieldDescription* found = nullptr;
      for (const FieldDescription& candidate : fields()) {
        found = candidate.name == field_name ? &candidate : found;
      }
      ASSERT_NE(found, nullptr) << field_name;
      // Equation 1 of the datasheet adds a signed offset; the list has the TMC4671's unsigned one.
      const bool analog_offset = field_name.starts_with("AENC_") &&
                                 field_name.ends_with("_OFFSET") && name.ends_with("SCALE_OFFSET");
      const Field expected{address, kPlain, listed.low, listed.high,
                           analog_offset || listed.is_signed};
      EXPECT_EQ(found->field, expected) << field_name;
      ++compared;
    }
  }
  EXPECT_GT(compared, 200);
}

TEST(FocRegisterMap, HasNoOverlappingFieldsAndNoNameTwice) {
  std::set<std::string_view> names;
  for (const FieldDescription& a : fields()) {
    EXPECT_TRUE(names.insert(a.name).second) << a.name;
    EXPECT_NE(find_register(a.field.address, a.field.view), nullptr) << a.name;
    for (const FieldDescription& b : fields()) {
      if (&a != &b && a.field.address == b.field.address && a.field.view == b.field.view) {
        EXPECT_EQ(mask(a.field) & mask(b.field), 0U) << a.name << ' ' << b.name;
      }
    }
  }
}

TEST(FocRegisterMap, NamesTheOriginOfEveryRow) {
  for (const RegisterDescription& description : registers()) {
    EXPECT_TRUE(description.origin == kList || description.origin.starts_with("L"))
        << description.name;
  }
  EXPECT_EQ(find_register("CHIPINFO_ADDR")->origin, "L753");
  EXPECT_EQ(find_register("CHIPINFO_DATA")->origin, "L754");
}

/// Registers whose content is state: they are tested where the state is.
bool is_live(const RegisterDescription& description) {
  static const std::set<std::string_view> kLive{"ABN_DECODER_COUNT",        "ABN_DECODER_COUNT_N",
                                                "ABN_DECODER_PHI_E_PHI_M",  "ABN_2_DECODER_COUNT",
                                                "ABN_2_DECODER_COUNT_N",    "AENC_DECODER_COUNT",
                                                "OPENLOOP_VELOCITY_ACTUAL", "OPENLOOP_PHI",
                                                "PID_POSITION_ACTUAL",      "STATUS_FLAGS"};
  return kLive.contains(description.name);
}

TEST(FocRegisters, KeepWhatIsWritableAndNothingElse) {
  base::Random random(1);
  for (int round = 0; round < 20; ++round) {
    FocBlock block;
    for (const RegisterDescription& d : registers()) {
      if (d.view != kPlain || is_live(d) || d.name == "CONFIG_DATA") {
        continue;
      }
      const std::uint32_t before = block.read(d.address);
      const auto value = static_cast<std::uint32_t>(random.next());
      const std::uint32_t writable = writable_mask(d.address);
      EXPECT_EQ(block.write(d.address, value), writable != 0) << d.name;
      std::uint32_t shown = block.read(d.address);
      std::uint32_t expected = (before & ~writable) | (value & writable);
      if (d.name == "GPIO_DSADCI_CONFIG") {  // its inputs are inputs
        shown &= 0x00FFFFFF;
        expected &= 0x00FFFFFF;
      }
      EXPECT_EQ(shown, expected) << d.name;
    }
  }
}

TEST(FocRegisters, StartFromTheirResetValues) {
  const FocBlock block;
  for (const RegisterDescription& d : registers()) {
    if (d.view == kPlain && d.access == Access::read_write && !is_live(d) &&
        d.name != "CONFIG_DATA") {
      EXPECT_EQ(block.read(d.address), d.reset) << d.name;
    }
  }
  EXPECT_EQ(block.get(field("PWM_MAXCNT")), 3999);
  EXPECT_EQ(block.get(field("PIDOUT_UQ_UD_LIMITS")), 23169);
}

TEST(FocRegisters, ConfigurationIsReachedThroughItsAddressRegister) {
  FocBlock block;
  base::Random random(2);
  for (const RegisterDescription& d : registers()) {
    if (d.address != 0x4D || d.view == kPlain) {
      continue;
    }
    block.write(0x4E, static_cast<std::uint32_t>(d.view));
    EXPECT_EQ(block.read(0x4D), d.reset) << d.name;
    const auto value = static_cast<std::uint32_t>(random.next());
    block.write(0x4D, value);
    const std::uint32_t bits = writable_mask(0x4D, d.view) &
                               (d.view == 60 ? 0x0000FFFFU : 0xFFFFFFFFU);  // the status is live
    EXPECT_EQ(block.read(0x4D) & bits, value & bits) << d.name;
  }
  for (const std::uint32_t nowhere : {0U, 3U, 39U, 63U, 64U, 255U, 256U, 0xFFFFFFFFU}) {
    block.write(0x4E, nowhere);
    EXPECT_FALSE(block.write(0x4D, 0xFFFFFFFFU)) << nowhere;
    EXPECT_EQ(block.read(0x4D), 0U) << nowhere;
  }
}

TEST(FocRegisters, ChipInformationTellsTypeAndVersion) {
  FocBlock block;
  block.write(0x01, 0);
  EXPECT_EQ(block.read(0x00), 0x38363730U);  // "8670"
  block.write(0x01, 1);
  EXPECT_EQ(block.read(0x00), 0x00010000U);
  block.write(0x01, 2);
  EXPECT_EQ(block.read(0x00), 0x20171030U);
  block.write(0x01, 6);
  EXPECT_EQ(block.read(0x00), 0U);
  EXPECT_FALSE(block.write(0x00, 1));
}

TEST(FocRegisters, WhatDoesNotExistReadsZero) {
  FocBlock block;
  for (unsigned address = 0; address < 256; ++address) {
    if (address > 127 || find_register(static_cast<std::uint8_t>(address)) == nullptr) {
      EXPECT_EQ(block.read(static_cast<std::uint8_t>(address)), 0U) << address;
      EXPECT_FALSE(block.write(static_cast<std::uint8_t>(address), 0xFFFFFFFFU)) << address;
    }
  }
}

TEST(FocRegisters, FieldsAreSetWithoutTheirNeighbours) {
  FocBlock block;
  block.write(0x1B, 0x00030007);
  block.set(field("MOTOR_TYPE"), 2);
  EXPECT_EQ(block.read(0x1B), 0x00020007U);
  EXPECT_EQ(block.get(field("N_POLE_PAIRS")), 7);
  block.set(field("BIQUAD_V_A_2"), -12345);
  EXPECT_EQ(block.get(field("BIQUAD_V_A_2")), -12345);
  block.set(field("PID_TORQUE_TARGET"), -2);
  EXPECT_EQ(block.read(0x64), 0xFFFE0000U);
}

TEST(FocRegisters, AnyWritesAndInputsAtAllAreSurvived) {
  base::Random random(3);
  FocBlock block;
  Inputs inputs;
  for (int k = 0; k < 200'000; ++k) {
    if (random.below(8) == 0) {
      block.write(
          static_cast<std::uint8_t>(random.below(128)),
          static_cast<std::uint32_t>(random.next()) & static_cast<std::uint32_t>(random.next()));
      block.write(0x4E, static_cast<std::uint32_t>(random.below(64)));
    }
    for (auto& raw : inputs.delta_sigma_a.current) {
      raw = static_cast<std::uint16_t>(random.next());
    }
    inputs.delta_sigma_b.ux = static_cast<std::uint16_t>(random.next());
    inputs.abn.count += static_cast<std::int64_t>(random.below(2001)) - 1000;
    inputs.abn.passages += random.below(10) == 0 ? 1 : 0;
    inputs.halls = static_cast<std::uint8_t>(random.below(8));
    const Outputs& outputs = block.step(inputs);
    for (const std::int32_t on : outputs.pwm.on_time) {
      ASSERT_GE(on, 0);
      ASSERT_LE(on, 65536);
    }
    const auto address = static_cast<std::uint8_t>(random.below(128));
    ASSERT_EQ(block.read(address) & ~implemented_mask(address, kPlain) &
                  (find_register(address) == nullptr ? 0xFFFFFFFFU : 0U),
              0U);
  }
}

}  // namespace
}  // namespace stator::control::foc

// The description of a rack file's keys, of which schema and reference are made.
#include "stator/rack/file/rack_file_description.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"

namespace stator::rack {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::SizeIs;

const settings::TableDescription& description() {
  static const settings::TableDescription table = describe_rack_file(devices::products());
  return table;
}

const settings::TableDescription& below(const settings::TableDescription& table,
                                        const std::string& key) {
  return *table.find(key)->table;
}

const settings::TableDescription& variant(const settings::TableDescription& table,
                                          const std::string& value) {
  for (const settings::TableVariant& each : table.variants) {
    if (each.value == value) {
      return *each.table;
    }
  }
  throw std::runtime_error("there is no variant " + value);
}

void require_summaries(const settings::TableDescription& table, const std::string& path) {
  for (const settings::KeyDescription& key : table.keys) {
    EXPECT_FALSE(key.summary.empty())
        << "give " << path << key.name << " a summary where it is read";
    // What can be wired to a chip's pins has descriptions of its own.
    if (key.table != nullptr && key.name != "board") {
      require_summaries(*key.table, path + key.name + ".");
    }
  }
  for (const settings::TableVariant& each : table.variants) {
    require_summaries(*each.table, path + "(" + each.value + ").");
  }
}

TEST(RackFileDescription, EveryKeyHasASummary) {
  require_summaries(description(), "");
}

TEST(RackFileDescription, TellsTypeRangeUnitAndDefaultOfAKey) {
  const settings::TableDescription& device =
      variant(below(below(description(), "segment"), "device"), "tmcm-3315");
  const settings::KeyDescription& alias = *device.find("alias");
  ASSERT_THAT(alias.forms, SizeIs(1));
  EXPECT_EQ(alias.forms[0].kind, settings::ValueKind::integer);
  EXPECT_EQ(alias.forms[0].minimum, "0");
  EXPECT_EQ(alias.forms[0].maximum, "65535");
  EXPECT_EQ(alias.default_value, "0");

  const settings::KeyDescription& inertia = *below(below(device, "axis"), "load").find("inertia");
  EXPECT_EQ(inertia.unit, "kg m²");
  EXPECT_EQ(inertia.default_value, "0");

  const settings::KeyDescription& firmware = *device.find("firmware");
  EXPECT_THAT(firmware.forms.at(0).choices, ElementsAre("1.07", "1.08", "1.09"));
  EXPECT_EQ(firmware.default_value, "\"1.09\"");
}

TEST(RackFileDescription, AKeyMayHaveSeveralForms) {
  const settings::KeyDescription& rate = *below(description(), "bus").find("bit_rate");
  EXPECT_THAT(rate.forms, SizeIs(2));
  EXPECT_EQ(rate.default_value, "1000");
}

TEST(RackFileDescription, KeysDependOnTheTypeOfADevice) {
  const settings::TableDescription& device = below(below(description(), "bus"), "device");
  EXPECT_EQ(device.selector, "type");
  EXPECT_TRUE(device.find("type")->required);
  EXPECT_NE(variant(device, "tmcc160").find("node_id"), nullptr);
  EXPECT_EQ(variant(device, "tmcc160").find("can_id"), nullptr);
  EXPECT_NE(variant(device, "tmcm-142").find("can_id"), nullptr);
}

TEST(RackFileDescription, IsThereForACatalogueThatHasNoProductForANetwork) {
  product::Catalogue of_segments;
  of_segments.add(devices::products().find("tmcm-3315"));
  const settings::TableDescription table = describe_rack_file(of_segments);
  EXPECT_NE(variant(below(below(table, "segment"), "device"), "tmcm-3315").find("axis"), nullptr);
  EXPECT_THAT(below(below(table, "bus"), "device").variants, SizeIs(0));
}

TEST(RackFileDescription, MotorDataHasTheKeysOfEveryKindOfMotor) {
  const settings::TableDescription& device =
      variant(below(below(description(), "segment"), "device"), "tmc8670");
  const settings::TableDescription& axis = below(device, "axis");
  EXPECT_THAT(axis.find("motor")->forms.at(0).choices, Contains("dc"));
  const settings::TableDescription& motor = below(axis, "motor_data");
  EXPECT_NE(motor.find("flux_linkage"), nullptr);
  EXPECT_NE(motor.find("torque_constant"), nullptr) << "of a brushed motor";
  EXPECT_NE(motor.find("inductance"), nullptr) << "of a stepper motor";
}

TEST(RackFileDescription, EveryActionOfAnEventIsThere) {
  const settings::TableDescription& event = below(description(), "event");
  EXPECT_NE(variant(event, "set").find("over"), nullptr);
  EXPECT_NE(variant(event, "break").find("port"), nullptr);
  EXPECT_NE(variant(event, "drop").find("identifier"), nullptr) << "on a CAN bus";
  EXPECT_NE(variant(event, "drop").find("direction"), nullptr) << "on EtherCAT";
  EXPECT_TRUE(event.find("at")->required);
}

TEST(RackFileDescription, PeripheralsOfAChipHaveNamesOfTheirOwn) {
  const settings::TableDescription& device =
      variant(below(below(description(), "segment"), "device"), "tmc8461");
  const settings::TableDescription& board = below(device, "board");
  EXPECT_TRUE(board.free_names);
  ASSERT_THAT(board.keys, SizeIs(1));
  const settings::TableDescription& peripheral = *board.keys.front().table;
  EXPECT_NE(variant(peripheral, "led").find("wires"), nullptr);
}

}  // namespace
}  // namespace stator::rack

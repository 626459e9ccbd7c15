// What ESI files say of a device beside objects and PDOs: mailbox, sync managers, clocks, EEPROM;
// which of several devices is meant; modules in slots.
#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "formats/esi_file.hpp"
#include "stator/formats/esi/esi_reader.hpp"

namespace stator::formats {
namespace {

using dictionary::DataType;
using dictionary::ImportKind;
using ethercat::ImportedPdo;
using Read = tests::ReadEsi;
using tests::esi_refusal;

std::vector<int> indices(const std::vector<ImportedPdo>& pdos) {
  std::vector<int> found;
  std::ranges::transform(pdos, std::back_inserter(found), &ImportedPdo::index);
  return found;
}

TEST(EsiMailbox, ProtocolsAndCommandsAreRead) {
  const Read read("mailbox");
  const ethercat::DeviceDescription& description = read->description;
  EXPECT_TRUE(description.coe);
  EXPECT_TRUE(description.foe);
  EXPECT_TRUE(description.eoe);
  EXPECT_TRUE(description.sdo_information);
  EXPECT_TRUE(description.complete_access);
  EXPECT_TRUE(description.pdo_assign);
  EXPECT_FALSE(description.pdo_configuration);
  EXPECT_EQ(description.receive_mailbox.offset, 0x1000);
  EXPECT_EQ(description.receive_mailbox.length, 128);
  EXPECT_EQ(description.transmit_mailbox.offset, 0x1080);
  EXPECT_EQ(description.output_offset, 0x1100);
  EXPECT_EQ(description.input_offset, 0x1400);
  EXPECT_EQ(read.notes("pdo-upload", ImportKind::assumed), 1);
  EXPECT_EQ(read.notes("mailbox-protocol", ImportKind::left_out), 1);
  EXPECT_EQ(read.notes("dictionary-elsewhere", ImportKind::left_out), 1);

  ASSERT_EQ(read->init_commands.size(), 3U);
  const auto command = [&](std::size_t index, std::uint8_t subindex) {
    const auto found =
        std::ranges::find(read->init_commands, index, &ethercat::ImportedInitCommand::index);
    return found != read->init_commands.end() && found->subindex == subindex
               ? found->data
               : std::vector<std::byte>();
  };
  EXPECT_EQ(command(0x6060, 0), (std::vector{std::byte{8}}));
  EXPECT_EQ(command(0x8000, 0x12), (std::vector{std::byte{1}, std::byte{2}}));
  EXPECT_EQ(command(0x6072, 0), (std::vector{std::byte{0xE8}, std::byte{3}}));
  EXPECT_EQ(read.notes("init-command", ImportKind::left_out), 3);
}

TEST(EsiMailbox, WithoutSyncManagersThereIsNone) {
  const Read read("mailbox_without_sync_managers");
  EXPECT_FALSE(read->description.coe);
  EXPECT_EQ(read.notes("mailbox-without-memory", ImportKind::left_out), 1);
  const Read sized("mailbox_without_default_size");
  EXPECT_EQ(sized->description.receive_mailbox.length, 64);
  EXPECT_EQ(sized.notes("mailbox-size", ImportKind::assumed), 1);
}

TEST(EsiSyncManagers, WithoutTextTheControlByteTellsTheType) {
  const Read read("sync_managers_without_text");
  ASSERT_EQ(read->sync_managers.size(), 6U);
  std::vector<int> types;
  for (const auto& manager : read->sync_managers) {
    types.push_back(manager.type);
  }
  EXPECT_EQ(types, (std::vector{1, 2, 3, 4, 4, 0}));
  EXPECT_TRUE(read->sync_managers[0].enabled);
  EXPECT_FALSE(read->sync_managers[2].enabled);
  EXPECT_FALSE(read->sync_managers[3].enabled);
  EXPECT_FALSE(read->sync_managers[4].enabled);  // it is virtual
  EXPECT_EQ(read->sync_managers[2].default_size, 8);
  EXPECT_EQ(read->sync_managers[0].start, 0x1000);
  EXPECT_EQ(read->description.transmit_mailbox.offset, 0x1080);
}

TEST(EsiClocks, ModesAreRead) {
  const Read read("clock_modes");
  ASSERT_EQ(read->clock_modes.size(), 3U);
  EXPECT_EQ(read->clock_modes[1].name, "DC");
  EXPECT_EQ(read->clock_modes[1].assign_activate, 0x0300);
  EXPECT_TRUE(read->description.distributed_clocks);
  EXPECT_EQ(read.notes("assign-activate", ImportKind::repaired), 1);
}

TEST(EsiEeprom, FirstWordsAndSizeAreRead) {
  const Read read("eeprom");
  EXPECT_EQ(read->description.sii_size_kbit, 32);
  EXPECT_EQ(read->description.pdi_control, 0x0C05);
  EXPECT_EQ(read->description.pdi_configuration, 0x03);
  EXPECT_EQ(read->description.sync_latch_configuration, 0x44);
  EXPECT_EQ(read->description.sync_pulse_length, 10);
  EXPECT_EQ(read->description.station_alias, 0x2A);
  EXPECT_EQ(read->description.bootstrap_receive_mailbox.offset, 0x1000);
  EXPECT_EQ(read->description.bootstrap_transmit_mailbox.length, 0xF4);
  const Read image("eeprom_image");
  EXPECT_EQ(image->description.sii_size_kbit, 2);
  EXPECT_EQ(image->description.pdi_control, 0x0108);
  EXPECT_EQ(image->description.bootstrap_transmit_mailbox.offset, 0x1080);
}

TEST(EsiChoice, ADeviceIsMeantByTypeNameOrProductCode) {
  const auto read = [](const std::string& device) {
    const Read found("several_devices", {.device = device, .modules = {}});
    return std::pair{found->description.product_code, found->description.revision};
  };
  EXPECT_EQ(read("17"), (std::pair{0x11U, 3U}));
  EXPECT_EQ(read("0x11@2"), (std::pair{0x11U, 2U}));
  EXPECT_EQ(read("first@0x1"), (std::pair{0x11U, 1U}));
  EXPECT_EQ(read("Other first"), (std::pair{0x12U, 1U}));
  EXPECT_EQ(read("B@2"), (std::pair{0x20U, 1U}));
  EXPECT_EQ(read("hidden"), (std::pair{0x30U, 1U}));
}

TEST(EsiChoice, WhatFitsNoneOrSeveralIsRefusedWithAList) {
  for (const auto& [device, rule] :
       {std::pair{"", "device-ambiguous"}, std::pair{"A-1", "device-ambiguous"},
        std::pair{"C", "device-unknown"}, std::pair{"0x11@9", "device-unknown"}}) {
    const auto error = esi_refusal("several_devices", {.device = device, .modules = {}});
    EXPECT_EQ(error.rule, rule) << device;
    EXPECT_NE(error.text.find("A-1 (0x00000011@0x00000003)"), std::string::npos) << error.text;
  }
  EXPECT_EQ(esi_refusal("devices_with_one_product_code").rule, "device-ambiguous");
  const Read read("devices_with_one_product_code", {.device = "three axes", .modules = {}});
  EXPECT_EQ(read->description.order_code, "Three axes");
}

TEST(EsiChoice, WithoutOneTheNewestRevisionOfTheOnlyTypeIsTaken) {
  const Read read("revisions_of_one_device");
  EXPECT_EQ(read->description.revision, 3U);
  EXPECT_EQ(read.notes("revision", ImportKind::assumed), 1);
  const Read equal("three_equal_devices");
  EXPECT_EQ(equal->description.name, "One");
  EXPECT_EQ(equal.notes("device-twice", ImportKind::repaired), 1);
  EXPECT_EQ(equal.notes("revision", ImportKind::assumed), 0);
}

TEST(EsiChoice, AllDevicesAreListedWithTheirLines) {
  const auto devices = esi_devices(tests::esi_file_text("several_devices"));
  ASSERT_TRUE(devices);
  ASSERT_EQ(devices->size(), 6U);
  EXPECT_EQ((*devices)[4].type, "B@2");
  EXPECT_EQ((*devices)[0].line, 15U);
  EXPECT_EQ((*devices)[5].name, "Hidden");
}

TEST(EsiChoice, AListOfDescriptionsHasEachWithItsVendor) {
  const Read read("list_of_descriptions", {.device = "B", .modules = {}});
  EXPECT_EQ(read->description.vendor_id, 0xDEFU);
}

TEST(EsiModules, ThoseByDefaultStandInTheirSlots) {
  const Read read("modules_in_slots");
  EXPECT_EQ(read->profile, 402);
  EXPECT_EQ(indices(read->receive_pdos), (std::vector{0x1600, 0x1610}));
  EXPECT_EQ(indices(read->transmit_pdos), (std::vector{0x1A00, 0x1A10}));
  const std::vector<ImportedPdo::Entry>& second = read->receive_pdos[1].entries;
  EXPECT_EQ(second[0].index, 0x6840);
  EXPECT_EQ(second[1].index, 0x2000);
  EXPECT_EQ(second[2].index, 0);
  EXPECT_EQ(read->transmit_pdos[1].entries[0].index, 0x6841);
  for (const int index : {0x6040, 0x6840, 0x6041, 0x6841, 0x1600, 0x1610, 0x2100}) {
    EXPECT_NE(read.find(static_cast<std::uint16_t>(index), 0), nullptr) << std::hex << index;
  }
  EXPECT_EQ(read.row(0x2100).type, DataType::integer16);  // a type of the device's
  EXPECT_EQ(read.notes("object-twice", ImportKind::repaired), 1);
  ASSERT_EQ(read->init_commands.size(), 2U);
  EXPECT_EQ(read->init_commands[1].index, 0x6860);
}

TEST(EsiModules, ThoseChosenStandInTheFirstSlotsThatTakeThem) {
  const Read one("modules_in_slots", {.device = "", .modules = {"-", "Axis"}});
  EXPECT_EQ(indices(one->receive_pdos), (std::vector{0x1610}));
  const Read four("modules_in_slots",
                  {.device = "", .modules = {"0x10", "axis", "Spare", "Module Axis"}});
  EXPECT_EQ(indices(four->receive_pdos), (std::vector{0x1600, 0x1610, 0x1630}));
  EXPECT_EQ(esi_refusal("modules_in_slots", {.device = "", .modules = {"Valve"}}).rule,
            "module-unknown");
  EXPECT_EQ(esi_refusal("modules_in_slots",
                        {.device = "", .modules = {"Axis", "Axis", "Axis", "Axis", "Axis"}})
                .rule,
            "module-without-slot");
}

TEST(EsiModules, WhatDoesNotDependOnSlotsIsShiftedWhereItWouldCollide) {
  const Read read("modules_that_do_not_depend_on_slots");
  EXPECT_EQ(indices(read->receive_pdos), (std::vector{0x1600, 0x1601}));
  EXPECT_EQ(read->receive_pdos[1].entries[0].index, 0x7010);
  EXPECT_NE(read.find(0x7010, 1), nullptr);
  EXPECT_EQ(read.notes("module-without-slot", ImportKind::repaired), 1);
}

TEST(EsiModules, WithoutSlotsTheyAreLeftOut) {
  const Read read("modules_without_slots");
  EXPECT_TRUE(read->receive_pdos.empty());
  EXPECT_EQ(read.notes("modules-without-slots", ImportKind::left_out), 1);
}

TEST(EsiModules, TheyAreFoundByClassAndShiftedByGroup) {
  const Read read("modules_by_class");
  EXPECT_EQ(read.notes("module", ImportKind::assumed), 1);
  EXPECT_EQ(read.notes("module-missing", ImportKind::left_out), 1);
  EXPECT_EQ(indices(read->receive_pdos), (std::vector{0x1600}));
  EXPECT_NE(read.find(0x7100, 1), nullptr);
}

TEST(EsiModules, TheyTakeThePlaceOfWhatTheDeviceLetsThem) {
  const Read read("overwritten_by_module");
  ASSERT_EQ(read->receive_pdos.size(), 1U);
  EXPECT_EQ(read->receive_pdos[0].name, "Outputs");
  EXPECT_EQ(read.row(0x7000).object_name, "Outputs");
  EXPECT_EQ(read.row(0x7001).name, "Stays");
}

}  // namespace
}  // namespace stator::formats

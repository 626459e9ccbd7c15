// Our own products, written as ESI or EDS and read back, are the same to a master.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/devices/catalogue/products.hpp"
#include "stator/devices/generic/product.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/formats/esi/esi.hpp"
#include "stator/formats/esi/esi_reader.hpp"
#include "stator/imports/sii_slave.hpp"
#include "stator/product/device/can_device.hpp"
#include "stator/product/device/ethercat_device.hpp"

namespace stator::imports {
namespace {

using dictionary::Dictionary;
using dictionary::Entry;
using dictionary::ImportReport;

std::string notes_of(const ImportReport& report) {
  std::string text;
  for (const dictionary::ImportNote& note : report.notes) {
    text += note.text + " [" + note.rule + "]\n";
  }
  return text;
}

/// Our ESI files know no constants; nor do they tell arrays from records.
std::string access_of(const Entry& entry) {
  using dictionary::Access;
  const Access access = entry.declaration().access;
  return std::to_string(static_cast<int>(access == Access::constant ? Access::read_only : access));
}

/// Everything that SDO information says of an entry, in a line.
std::string line_of(const Entry& entry) {
  const dictionary::EntryDeclaration& declaration = entry.declaration();
  return std::to_string(entry.index()) + ":" + std::to_string(entry.subindex()) + " " +
         std::string(entry.name()) + " " + std::to_string(static_cast<int>(entry.type())) + " " +
         access_of(entry) + " " + std::to_string(static_cast<int>(declaration.mapping)) + " " +
         (declaration.object_code == dictionary::ObjectCode::variable ? "variable" : "several");
}

std::vector<std::string> lines_of(const Dictionary& objects) {
  std::vector<std::string> lines;
  for (const Entry& entry : objects.entries()) {
    lines.push_back(line_of(entry));
  }
  return lines;
}

class OfAnEtherCatProduct : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const auto product = devices::products().find(GetParam());
    ASSERT_NE(product, nullptr);
    made_ = product->defaults().make();
    device_ = dynamic_cast<product::EtherCatDevice*>(made_.get());
    ASSERT_NE(device_, nullptr);
  }

  std::unique_ptr<product::Device> made_;
  product::EtherCatDevice* device_ = nullptr;
};

TEST_P(OfAnEtherCatProduct, EveryObjectComesBackFromItsEsi) {
  ImportReport report;
  auto file = formats::read_esi(
      formats::esi_xml(device_->description(), device_->dictionary(), device_->sii_image()), {},
      report);
  ASSERT_TRUE(file) << file.error().text;
  const auto product = devices::imported_product("test", std::move(file).value(), report);
  const auto again = product->defaults().make();
  const auto* const device = dynamic_cast<const product::EtherCatDevice*>(again.get());
  ASSERT_NE(device, nullptr);
  const std::vector<std::string> before = lines_of(device_->dictionary());
  const std::vector<std::string> after = lines_of(device->dictionary());
  ASSERT_EQ(after.size(), before.size()) << notes_of(report);
  for (std::size_t i = 0; i < before.size(); ++i) {
    EXPECT_EQ(after[i], before[i]);
  }
}

TEST_P(OfAnEtherCatProduct, ItsEepromComesBackFromItsEsi) {
  ImportReport report;
  auto file = formats::read_esi(
      formats::esi_xml(device_->description(), device_->dictionary(), device_->sii_image()), {},
      report);
  ASSERT_TRUE(file) << file.error().text;
  const auto product = devices::imported_product("test", std::move(file).value(), report);
  const auto again = product->defaults().make();
  const auto* const device = dynamic_cast<const product::EtherCatDevice*>(again.get());
  ASSERT_NE(device, nullptr);
  const auto before = ethercat::parse_sii_image(device_->sii_image());
  const auto after = ethercat::parse_sii_image(device->sii_image());
  ASSERT_TRUE(before && after);
  EXPECT_EQ(after->vendor_id, before->vendor_id);
  EXPECT_EQ(after->product_code, before->product_code);
  EXPECT_EQ(after->revision, before->revision);
  EXPECT_EQ(after->name, before->name);
  EXPECT_EQ(after->receive_mailbox.length, before->receive_mailbox.length);
  EXPECT_EQ(after->transmit_mailbox.offset, before->transmit_mailbox.offset);
  ASSERT_EQ(after->sync_managers.size(), before->sync_managers.size());
  for (std::size_t i = 0; i < before->sync_managers.size(); ++i) {
    EXPECT_EQ(after->sync_managers[i].start, before->sync_managers[i].start) << i;
    EXPECT_EQ(after->sync_managers[i].length, before->sync_managers[i].length) << i;
    EXPECT_EQ(after->sync_managers[i].type, before->sync_managers[i].type) << i;
  }
  ASSERT_EQ(after->tx_pdos.size(), before->tx_pdos.size());
  for (std::size_t i = 0; i < before->tx_pdos.size(); ++i) {
    EXPECT_EQ(after->tx_pdos[i].index, before->tx_pdos[i].index);
    EXPECT_EQ(after->tx_pdos[i].sync_manager, before->tx_pdos[i].sync_manager);
    EXPECT_EQ(after->tx_pdos[i].entries.size(), before->tx_pdos[i].entries.size());
  }
}

TEST_P(OfAnEtherCatProduct, ItsEepromAloneGivesItsProcessData) {
  ImportReport report;
  const auto file = slave_of_sii(device_->sii_image(), report);
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->description.product_code, device_->description().product_code);
  EXPECT_EQ(file->description.coe, device_->description().coe);
  const auto contents = ethercat::parse_sii_image(device_->sii_image());
  EXPECT_EQ(file->receive_pdos.size(), contents->rx_pdos.size());
  EXPECT_EQ(file->transmit_pdos.size(), contents->tx_pdos.size());
}

INSTANTIATE_TEST_SUITE_P(Products, OfAnEtherCatProduct, testing::Values("tmcm-3315", "tmc8670"),
                         [](const auto& product) {
                           std::string name = product.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(SiiSlave, DumpsOfRealDevicesAreReadAsFarAsTheyGo) {
  const auto made = devices::products().find("tmc8670")->defaults().make();
  std::vector<std::byte> image = dynamic_cast<product::EtherCatDevice&>(*made).sii_image();
  ImportReport report;
  image[14] ^= std::byte{1};  // the checksum
  EXPECT_TRUE(slave_of_sii(image, report));
  EXPECT_EQ(report.notes.front().rule, "sii-checksum");
  image.resize(256);  // as some tools read
  ImportReport cut;
  const auto file = slave_of_sii(image, cut);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->description.product_code, 0x01008670U);
  image.resize(100);
  EXPECT_EQ(slave_of_sii(image, cut).error().rule, "sii-too-short");
}

TEST(SiiSlave, NamesOfOtherComputersBecomeUtf8) {
  ethercat::SiiContents contents;
  contents.order_code = "T-1";
  contents.name = "Filter 10 \xB5s";  // Latin-1
  ImportReport report;
  const auto file = slave_of_sii(ethercat::compose_sii_image(contents), report);
  ASSERT_TRUE(file) << file.error().text;
  EXPECT_EQ(file->description.name, "Filter 10 \xC2\xB5s");
}

TEST(OfACanOpenProduct, EveryObjectComesBackFromItsEds) {
  const auto made = devices::products().find("tmcc160")->defaults().make();
  const auto* const device = dynamic_cast<const product::CanDevice*>(made.get());
  ASSERT_NE(device, nullptr);
  ImportReport report;
  auto file = canopen::read_eds(device->eds(), report);
  ASSERT_TRUE(file) << file.error().text;
  const auto product = devices::imported_product("test", std::move(file).value(), report);
  const auto again = product->defaults().make();
  const auto* const imported = dynamic_cast<const product::CanDevice*>(again.get());
  ASSERT_NE(imported, nullptr);
  const Dictionary& before = *device->object_dictionary();
  const Dictionary& after = *imported->object_dictionary();
  // Names in an EDS are made unique, so that of them only the beginning is the same.
  ASSERT_EQ(after.entries().size(), before.entries().size()) << notes_of(report);
  for (std::size_t i = 0; i < before.entries().size(); ++i) {
    const Entry& was = before.entries()[i];
    const Entry& is = after.entries()[i];
    ASSERT_EQ(is.index(), was.index());
    ASSERT_EQ(is.subindex(), was.subindex());
    EXPECT_EQ(is.type(), was.type()) << line_of(was);
    EXPECT_EQ(access_of(is), access_of(was)) << line_of(was);
  }
}

}  // namespace
}  // namespace stator::imports

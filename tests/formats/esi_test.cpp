// The ESI file of the TMCM-3315: objects, types, process data, sync managers, modes of SYNC0.
#include "stator/formats/esi/esi.hpp"

#include <gtest/gtest.h>
#include <pugixml.hpp>

#include "stator/devices/tmcm_3315/tmcm_3315.hpp"
#include "stator/ethercat/sii/sii_image.hpp"
#include "stator/rack/core/device_making.hpp"

namespace stator::formats {
namespace {

class EsiOfTmcm3315 : public ::testing::Test {
 protected:
  EsiOfTmcm3315() {
    const auto sii = ethercat::build_sii_image(device_.description(), device_.dictionary());
    const std::string text = esi_xml(device_.description(), device_.dictionary(), sii);
    parsed_ = document_.load_string(text.c_str());
    node_ = document_.select_node("/EtherCATInfo/Descriptions/Devices/Device").node();
  }

  [[nodiscard]] int count(const char* path) const {
    return static_cast<int>(document_.select_nodes(path).size());
  }

  devices::Tmcm3315 device_{devices::Tmcm3315Configuration{}};
  pugi::xml_document document_;
  pugi::xml_parse_result parsed_;
  pugi::xml_node node_;
};

TEST_F(EsiOfTmcm3315, IsWellFormedAndNamesTheProduct) {
  ASSERT_TRUE(parsed_) << parsed_.description();
  EXPECT_STREQ(node_.child("Type").attribute("ProductCode").value(), "#x00000CF3");
  EXPECT_STREQ(node_.child("Type").attribute("RevisionNo").value(), "#x00010009");
  EXPECT_STREQ(document_.select_node("/EtherCATInfo/Vendor/Id").node().text().get(), "#x00000286");
  EXPECT_STREQ(node_.child("Profile").child("ProfileNo").text().get(), "402");
}

TEST_F(EsiOfTmcm3315, OffersOperationWithAndWithoutSync0) {
  EXPECT_EQ(count("//Device/Dc/OpMode"), 2);
  const pugi::xml_node mode = document_.select_node("//Device/Dc/OpMode[Name='DC_Sync0']").node();
  EXPECT_STREQ(mode.child("AssignActivate").text().get(), "#x0300");
  EXPECT_EQ(mode.child("CycleTimeSync0").attribute("Factor").as_int(), 1);
}

TEST_F(EsiOfTmcm3315, HasEveryObjectOfTheDictionary) {
  EXPECT_EQ(count("//Dictionary/Objects/Object"),
            static_cast<int>(device_.dictionary().objects().size()));
}

TEST_F(EsiOfTmcm3315, EveryObjectsTypeIsDeclaredWithTheSameSize) {
  for (const auto& found : document_.select_nodes("//Dictionary/Objects/Object")) {
    const std::string type = found.node().child("Type").text().get();
    const std::string path = "//DataTypes/DataType[Name='" + type + "']/BitSize";
    const pugi::xpath_node size = document_.select_node(path.c_str());
    ASSERT_TRUE(size) << type;
    EXPECT_STREQ(size.node().text().get(), found.node().child("BitSize").text().get()) << type;
  }
}

TEST_F(EsiOfTmcm3315, DefaultProcessDataAreNineEntriesInEachDirection) {
  const pugi::xml_node outputs = node_.child("RxPdo");
  EXPECT_STREQ(outputs.child("Index").text().get(), "#x1600");
  EXPECT_EQ(outputs.attribute("Sm").as_int(), 2);
  EXPECT_EQ(count("//Device/RxPdo/Entry"), 9);
  EXPECT_EQ(count("//Device/TxPdo/Entry"), 9);
  EXPECT_STREQ(outputs.child("Entry").child("Index").text().get(), "#x6040");
  EXPECT_STREQ(outputs.child("Entry").child("DataType").text().get(), "UINT");
}

TEST_F(EsiOfTmcm3315, SyncManagersHaveTheLengthsOfMailboxesAndMapping) {
  ASSERT_EQ(count("//Device/Sm"), 4);
  EXPECT_EQ(document_.select_node("//Device/Sm[3]").node().attribute("DefaultSize").as_int(), 30);
  EXPECT_EQ(document_.select_node("//Device/Sm[4]").node().attribute("DefaultSize").as_int(), 30);
}

}  // namespace
}  // namespace stator::formats

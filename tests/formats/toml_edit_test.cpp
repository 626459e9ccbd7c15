// Objects written into a rack file of a person, whose comments and spelling stay.
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "stator/formats/toml/edit.hpp"

namespace stator::formats {
namespace {

const std::vector<TomlEntry> kEntries{{"2030:03", "700", "P torque"}, {"2010:08", "-5"}};

/// In one of the ways in which people write keys that mean the same.
bool same_key(std::string_view left, std::string_view right) {
  return left == right || (left == "2030h:3" && right == "2030:03");
}

base::Expected<std::string, settings::Problem> edited(const std::string& text,
                                                      std::size_t device = 0) {
  return with_entries(text, "a", {"segment", 0, "device", device}, "objects", kEntries, same_key);
}

TEST(TomlEdit, FollowTheKeysOfADeviceThatHasNone) {
  EXPECT_EQ(*edited("[[segment]]\n[[segment.device]]\ntype = \"tmc8670\" # ours\n"
                    "axis.load.inertia = 1e-5\n\n[[segment.device]]\ntype = \"tmc8670\"\n"),
            "[[segment]]\n[[segment.device]]\ntype = \"tmc8670\" # ours\n"
            "axis.load.inertia = 1e-5\n\n[segment.device.objects]\n"
            "\"2030:03\" = 700              # P torque\n\"2010:08\" = -5\n"
            "\n[[segment.device]]\ntype = \"tmc8670\"\n");
}

TEST(TomlEdit, ChangeInTheirPlaceWhereTheyAre) {
  EXPECT_EQ(*edited("[[segment]]\n[[segment.device]]\ntype = \"tmc8670\"\n"
                    "[segment.device.axis]\nsupply_voltage = 24\n"
                    "[segment.device.objects]\n\"2030h:3\" = 1 # einst größer\n"
                    "\"2010:08\" = 0x10\n# end\n"),
            "[[segment]]\n[[segment.device]]\ntype = \"tmc8670\"\n"
            "[segment.device.axis]\nsupply_voltage = 24\n"
            "[segment.device.objects]\n\"2030h:3\" = 700 # einst größer\n"
            "\"2010:08\" = -5\n# end\n");
  EXPECT_EQ(*edited("[[segment]]\n[[segment.device]]\nobjects = {\"2030:03\"=9, \"6081\" = 5} "
                    "# two\n"),
            "[[segment]]\n[[segment.device]]\nobjects = {\"2030:03\"=700, \"6081\" = 5, "
            "\"2010:08\" = -5 } # two\n");
}

TEST(TomlEdit, NeedADeviceWithAHeader) {
  const auto within = edited("[[segment]]\ndevice = [{ type = \"tmc8670\" }]\n");
  ASSERT_FALSE(within);
  EXPECT_EQ(within.error().text(),
            "a: the device has no header [[segment.device]] of its own, behind which objects could "
            "be written; give it one");
  EXPECT_FALSE(edited("[[segment]]\n[[segment.device]]\ntype = 1\n", 1));
}

TEST(TomlEdit, NeedsATextInToml) {
  const auto torn = edited("[[segment]]\n[[segment.device\n");
  ASSERT_FALSE(torn);
  EXPECT_EQ(torn.error().text().substr(0, 4), "a:2:");
}

}  // namespace
}  // namespace stator::formats

#include "stator/rack/file/rack_file_objects.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "stator/rack/toml/rack_file_error.hpp"

namespace stator::rack {
namespace {

const std::vector<WrittenObject> kObjects{{{0x2030, 3, 700}, "P torque"},
                                          {{0x2010, 8, static_cast<std::uint64_t>(-5)}, ""}};

TEST(RackFileObjects, FollowTheKeysOfADeviceThatHasNone) {
  EXPECT_EQ(with_objects("[[segment]]\n[[segment.device]]\ntype = \"tmc8670\" # ours\n"
                         "axis.load.inertia = 1e-5\n\n[[segment.device]]\ntype = \"tmc8670\"\n",
                         "a", {0, 0}, kObjects),
            "[[segment]]\n[[segment.device]]\ntype = \"tmc8670\" # ours\n"
            "axis.load.inertia = 1e-5\n\n[segment.device.objects]\n"
            "\"2030:03\" = 700              # P torque\n\"2010:08\" = -5\n"
            "\n[[segment.device]]\ntype = \"tmc8670\"\n");
}

TEST(RackFileObjects, ChangeInTheirPlaceWhereTheyAre) {
  EXPECT_EQ(with_objects("[[segment]]\n[[segment.device]]\ntype = \"tmc8670\"\n"
                         "[segment.device.axis]\nsupply_voltage = 24\n"
                         "[segment.device.objects]\n\"2030H:3\" = 1 # einst größer\n"
                         "\"2010:08\" = 0x10\n# end\n",
                         "a", {0, 0}, kObjects),
            "[[segment]]\n[[segment.device]]\ntype = \"tmc8670\"\n"
            "[segment.device.axis]\nsupply_voltage = 24\n"
            "[segment.device.objects]\n\"2030H:3\" = 1 # einst größer\n"
            "\"2010:08\" = -5\n\"2030:03\" = 700              # P torque\n# end\n");
  EXPECT_EQ(with_objects("[[segment]]\n[[segment.device]]\nobjects = {\"2030:03\"=9, \"6081\" = 5} "
                         "# two\n",
                         "a", {0, 0}, kObjects),
            "[[segment]]\n[[segment.device]]\nobjects = {\"2030:03\"=700, \"6081\" = 5, "
            "\"2010:08\" = -5 } # two\n");
}

TEST(RackFileObjects, NeedADeviceWithAHeader) {
  EXPECT_THROW(static_cast<void>(with_objects("[[segment]]\ndevice = [{ type = \"tmc8670\" }]\n",
                                              "a", {0, 0}, kObjects)),
               RackFileError);
  EXPECT_THROW(static_cast<void>(with_objects("[[segment]]\n[[segment.device]]\ntype = 1\n", "a",
                                              {0, 1}, kObjects)),
               RackFileError);
}

}  // namespace
}  // namespace stator::rack

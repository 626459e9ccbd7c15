// That a tree of values written as text reads as the tree it was made of.
#include "stator/settings/value_text.hpp"

#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "stator/formats/toml/toml.hpp"

namespace stator::settings {
namespace {

TEST(ValueText, ReadsAsTheTableItWasMadeOf) {
  const Table table{{"kind", "load-step"},
                    {"count", 3},
                    {"torque", 0.1},
                    {"whole", 2.0},
                    {"small", 1e-9},
                    {"least", std::numeric_limits<std::int64_t>::min()},
                    {"on", true},
                    {"path with \"quotes\" and \\", "a\nb\tc\x7F"},
                    {"list", List{1, "two", 3.5, List{}}},
                    {"when", Table{{"signal", "axis0.speed"}, {"value", -1.5}}}};
  const std::string text = toml_text(table);
  const auto read = formats::parse_toml(text, "");
  ASSERT_TRUE(read) << text;
  EXPECT_EQ(toml_text(*read->find<Table>()), text);
  EXPECT_NE(text.find("\"whole\" = 2.0\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\"torque\" = 0.1\n"), std::string::npos) << text;
  EXPECT_NE(text.find("\"when\" = {\"signal\" = \"axis0.speed\", \"value\" = -1.5}\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace stator::settings

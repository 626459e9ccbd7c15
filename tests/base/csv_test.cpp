// Which fields of a CSV row are quoted.
#include "stator/base/csv.hpp"

#include <string>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

std::string field(std::string_view text) {
  std::string row;
  append_csv_field(row, text);
  return row;
}

TEST(Csv, OnlyFieldsThatWouldEndEarlyAreQuoted) {
  EXPECT_EQ(field("STOP"), "STOP");
  EXPECT_EQ(field("MVP ABS, 0"), "\"MVP ABS, 0\"");
  EXPECT_EQ(field("a \"b\" c"), "\"a \"\"b\"\" c\"");
  EXPECT_EQ(field("two\nlines"), "\"two\nlines\"");
  EXPECT_EQ(field(""), "");
}

TEST(Csv, FieldsAreAppended) {
  std::string row = "1,";
  append_csv_field(row, "2,5");
  EXPECT_EQ(row, "1,\"2,5\"");
}

}  // namespace
}  // namespace stator::base

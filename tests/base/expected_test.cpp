// A value or an error, also where both are of one type or the value cannot be copied.
#include "stator/base/expected.hpp"

#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace stator::base {
namespace {

TEST(Expected, HoldsAValue) {
  Expected<std::string, int> result(std::string("text"));
  ASSERT_TRUE(result.has_value());
  EXPECT_TRUE(static_cast<bool>(result));
  EXPECT_EQ(*result, "text");
  EXPECT_EQ(result->size(), 4U);
  result->append("s");
  EXPECT_EQ(std::as_const(result).value(), "texts");
}

TEST(Expected, HoldsAnError) {
  const Expected<std::string, int> result = Unexpected{7};
  EXPECT_FALSE(result.has_value());
  EXPECT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error(), 7);
}

TEST(Expected, TellsValueAndErrorApartWhenBothAreOneType) {
  const Expected<int, int> value(5);
  const Expected<int, int> failure = Unexpected{5};
  EXPECT_TRUE(value.has_value());
  EXPECT_FALSE(failure.has_value());
  EXPECT_EQ(failure.error(), 5);
}

TEST(Expected, GivesUpAValueThatCannotBeCopied) {
  Expected<std::unique_ptr<int>, int> result(std::make_unique<int>(3));
  const std::unique_ptr<int> taken = *std::move(result);
  EXPECT_EQ(*taken, 3);
}

TEST(ExpectedVoid, IsASuccessUnlessAnErrorIsGiven) {
  const Expected<void, std::string> success;
  EXPECT_TRUE(success.has_value());
  const Expected<void, std::string> failure = Unexpected{std::string("reason")};
  EXPECT_FALSE(static_cast<bool>(failure));
  EXPECT_EQ(failure.error(), "reason");
}

}  // namespace
}  // namespace stator::base

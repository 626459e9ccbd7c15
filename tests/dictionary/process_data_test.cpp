// Values that come into a dictionary by process data: range and sign count, access rights do not.
#include <cstdint>

#include <gtest/gtest.h>

#include "small_drive.hpp"

namespace stator::dictionary {
namespace {

class WriteCounter {
 public:
  void written(const Entry& /*entry*/) { ++count; }
  int count = 0;
};

TEST(DictionaryProcessData, StoresTheValueAndTellsTheOwner) {
  const auto dictionary = make_small_drive();
  WriteCounter counter;
  dictionary->on_written(0x607A, 0, Entry::WrittenHook::bind<&WriteCounter::written>(counter));
  ASSERT_TRUE(dictionary->write_from_pdo(*dictionary->find(0x607A, 0), 500).has_value());
  EXPECT_EQ(dictionary->find(0x607A, 0)->signed_value(), 500);
  EXPECT_EQ(counter.count, 1);
}

TEST(DictionaryProcessData, AnUnchangedValueIsNoEvent) {
  const auto dictionary = make_small_drive();
  WriteCounter counter;
  dictionary->on_written(0x607A, 0, Entry::WrittenHook::bind<&WriteCounter::written>(counter));
  Entry& target = *dictionary->find(0x607A, 0);
  for (int cycle = 0; cycle < 3; ++cycle) {
    ASSERT_TRUE(dictionary->write_from_pdo(target, 500).has_value());
  }
  EXPECT_EQ(counter.count, 1);
}

TEST(DictionaryProcessData, TheSignComesFromTheTypeAndHigherBitsAreIgnored) {
  const auto dictionary = make_small_drive();
  Entry& target = *dictionary->find(0x607A, 0);
  ASSERT_TRUE(dictionary->write_from_pdo(target, 0xFFFFFFFE).has_value());
  EXPECT_EQ(target.signed_value(), -2);
  Entry& controlword = *dictionary->find(0x6040, 0);
  ASSERT_TRUE(dictionary->write_from_pdo(controlword, 0xABCD000F).has_value());
  EXPECT_EQ(controlword.value(), 0x000FU);
}

TEST(DictionaryProcessData, TheRangeHoldsHereToo) {
  const auto dictionary = make_small_drive();
  Entry& target = *dictionary->find(0x607A, 0);
  const Verdict verdict = dictionary->write_from_pdo(target, 1001);
  ASSERT_FALSE(verdict.has_value());
  EXPECT_EQ(verdict.error().code, AbortCode::value_too_high);
  EXPECT_EQ(target.signed_value(), -7);
}

TEST(DictionaryProcessData, AccessBySdoAndNetworkStateDoNotMatter) {
  const auto dictionary = make_small_drive();
  EXPECT_TRUE(dictionary->write_from_pdo(*dictionary->find(0x2003, 0), 250).has_value());
  EXPECT_EQ(dictionary->find(0x2003, 0)->value(), 250U);
}

}  // namespace
}  // namespace stator::dictionary

// That the frames waiting for the bus stay sorted however members come and go, against a list
// sorted anew.
#include "stator/can/contenders.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "stator/base/random.hpp"

namespace stator::can {
namespace {

std::vector<Contenders::Entry> entries_of(const Contenders& contenders) {
  return {contenders.all().begin(), contenders.all().end()};
}

TEST(Contenders, StandInTheOrderOfFieldAndMember) {
  Contenders contenders;
  for (int i = 0; i < 4; ++i) {
    contenders.add_member();
  }
  contenders.insert({7, 3});
  contenders.insert({2, 0});
  contenders.insert({7, 1});
  contenders.insert({5, 2});
  const std::vector<Contenders::Entry> expected{{2, 0}, {5, 2}, {7, 1}, {7, 3}};
  EXPECT_EQ(entries_of(contenders), expected);
}

// As a list that is sorted anew each time, over many rounds, in the memory it began with.
TEST(Contenders, ComeAndGoInAnyOrder) {
  constexpr std::uint32_t kMembers = 40;
  Contenders contenders;
  for (std::uint32_t i = 0; i < kMembers; ++i) {
    contenders.add_member();
  }
  base::Random random(3);
  std::vector<Contenders::Entry> expected;
  for (int round = 0; round < 20'000; ++round) {
    const auto member = static_cast<std::uint32_t>((random.next() >> 16U) % kMembers);
    const auto found = std::ranges::find(expected, std::size_t{member}, &Contenders::Entry::member);
    if (found != expected.end()) {
      contenders.erase(*found);
      expected.erase(found);
    } else {
      const auto field = static_cast<std::uint32_t>((random.next() >> 16U) % 16U);
      contenders.insert({field, member});
      expected.push_back({field, member});
      std::ranges::sort(expected);
    }
    ASSERT_EQ(entries_of(contenders), expected) << "round " << round;
    ASSERT_EQ(contenders.empty(), expected.empty());
  }
}

}  // namespace
}  // namespace stator::can

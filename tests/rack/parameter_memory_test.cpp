// A device's parameter memory on a disk: how long an order is busy, failures, damaged content.
#include "stator/rack/kept/parameter_memory.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::rack {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Status = canopen::NonVolatileMemory::Status;

class Keeper final : public ParameterKeeper {
 public:
  bool keep_parameters(std::vector<std::byte> given, std::uint32_t number) override {
    content = std::move(given);
    version = number;
    return at_once;
  }
  std::vector<std::byte> content;
  std::uint32_t version = 0;
  bool at_once = false;
};

constexpr std::array kOne{std::byte{1}};
constexpr std::array kTwo{std::byte{2}, std::byte{2}};

TEST(ParameterMemory, IsBusyUntilItsContentIsKept) {
  Keeper keeper;
  ParameterMemory memory(keeper);
  EXPECT_EQ(memory.status(), Status::ready);
  memory.store(0, kOne);
  EXPECT_EQ(memory.status(), Status::busy);
  memory.finish(keeper.version, true);
  EXPECT_EQ(memory.status(), Status::ready);
  EXPECT_THAT(memory.image(0), ElementsAre(std::byte{1}));
  EXPECT_THAT(memory.image(1), IsEmpty());
}

TEST(ParameterMemory, AfterAFailureTheFormerImageIsThere) {
  Keeper keeper;
  ParameterMemory memory(keeper);
  memory.store(3, kOne);
  memory.finish(keeper.version, true);
  memory.store(3, kTwo);
  memory.finish(keeper.version, false);
  EXPECT_EQ(memory.status(), Status::failed);
  EXPECT_THAT(memory.image(3), ElementsAre(std::byte{1}));
}

TEST(ParameterMemory, OnlyTheNewestOrderDecides) {
  Keeper keeper;
  ParameterMemory memory(keeper);
  memory.store(1, kOne);
  const std::uint32_t first = keeper.version;
  memory.store(2, kTwo);
  memory.finish(first, false);
  EXPECT_EQ(memory.status(), Status::busy);
  memory.finish(keeper.version, true);
  EXPECT_THAT(memory.image(1), ElementsAre(std::byte{1}));
}

TEST(ParameterMemory, ContentIsReadBackAndDamagedContentIsRefused) {
  Keeper keeper;
  keeper.at_once = true;
  ParameterMemory memory(keeper);
  memory.store(1, kOne);
  memory.store(200, kTwo);
  memory.store(2, kTwo);
  memory.store(2, {});
  ParameterMemory other(keeper);
  const std::vector<std::byte> content = keeper.content;
  ASSERT_TRUE(other.restore(content));
  EXPECT_THAT(other.image(1), ElementsAre(std::byte{1}));
  EXPECT_THAT(other.image(200), ElementsAre(std::byte{2}, std::byte{2}));
  EXPECT_THAT(other.image(2), IsEmpty());
  for (std::size_t length = 1; length < content.size(); ++length) {
    const bool whole_groups = length == 6;
    EXPECT_EQ(other.restore(std::span(content).first(length)), whole_groups) << length;
  }
}

}  // namespace
}  // namespace stator::rack

// When a firmware image downloaded by FoE is in force, and what failures leave behind.
#include "stator/product/device/firmware_memory.hpp"

#include <vector>

#include <gtest/gtest.h>

namespace stator::product {
namespace {

using ethercat::FoeError;
using Bytes = std::vector<std::byte>;

class FirmwareMemoryTest : public testing::Test, protected FirmwareKeeper {
 protected:
  ~FirmwareMemoryTest() override { memory_.set_keeper(nullptr); }

  bool keep(std::span<const std::byte> image, std::uint32_t download) override {
    given_.assign(image.begin(), image.end());
    download_ = download;
    return keeps_at_once_;
  }
  FirmwareMemory::Commit download(const Bytes& image) {
    EXPECT_EQ(memory_.open_for_writing("any name"), FoeError::none);
    EXPECT_EQ(memory_.append(image), FoeError::none);
    return memory_.commit();
  }
  Bytes image() { return {memory_.image().begin(), memory_.image().end()}; }
  Bytes read(std::size_t offset, std::size_t count) {
    Bytes bytes(count);
    EXPECT_EQ(memory_.read(offset, bytes), FoeError::none);
    return bytes;
  }

  const Bytes one_ = Bytes(100, std::byte{1});
  const Bytes two_ = Bytes(50, std::byte{2});
  FirmwareMemory memory_{1000};
  Bytes given_;
  std::uint32_t download_ = 0;
  bool keeps_at_once_ = false;
};

TEST_F(FirmwareMemoryTest, ImageIsInForceWhenTheDownloadIsComplete) {
  EXPECT_EQ(memory_.open_for_reading(""), FoeError::not_found);
  ASSERT_EQ(memory_.open_for_writing("a"), FoeError::none);
  ASSERT_EQ(memory_.append(one_), FoeError::none);
  EXPECT_TRUE(image().empty());
  EXPECT_FALSE(memory_.commit().in_progress);
  EXPECT_EQ(image(), one_);
  ASSERT_EQ(memory_.open_for_reading("b"), FoeError::none) << "whatever it is called";
  EXPECT_EQ(memory_.size(), 100U);
  EXPECT_EQ(read(90, 10), Bytes(10, std::byte{1}));
}

TEST_F(FirmwareMemoryTest, BrokenDownload_LeavesTheOldImage) {
  download(one_);
  ASSERT_EQ(memory_.open_for_writing("a"), FoeError::none);
  ASSERT_EQ(memory_.append(two_), FoeError::none);
  memory_.abort();
  EXPECT_EQ(image(), one_);
  ASSERT_EQ(memory_.open_for_writing("a"), FoeError::none);
  ASSERT_EQ(memory_.append(two_), FoeError::none);
  EXPECT_FALSE(memory_.commit().in_progress);
  EXPECT_EQ(image(), two_) << "nothing of the broken one is left";
}

TEST_F(FirmwareMemoryTest, CapacityIsTheLimitToTheByte) {
  ASSERT_EQ(memory_.open_for_writing("a"), FoeError::none);
  EXPECT_EQ(memory_.append(Bytes(999)), FoeError::none);
  EXPECT_EQ(memory_.append(Bytes(2)), FoeError::disk_full);
  EXPECT_EQ(memory_.append(Bytes(1)), FoeError::none);
  EXPECT_EQ(memory_.append(Bytes(1)), FoeError::disk_full);
  EXPECT_FALSE(memory_.restore(Bytes(1001)));
  EXPECT_TRUE(memory_.restore(Bytes(1000)));
}

TEST_F(FirmwareMemoryTest, Keeper_DecidesWhenTheImageIsInForce) {
  ASSERT_TRUE(memory_.restore(two_));
  memory_.set_keeper(this);
  EXPECT_TRUE(download(one_).in_progress);
  EXPECT_EQ(given_, one_);
  EXPECT_EQ(image(), two_);
  EXPECT_TRUE(memory_.commit().in_progress);
  memory_.finish(download_, true);
  EXPECT_FALSE(memory_.commit().in_progress);
  EXPECT_EQ(memory_.commit().error, FoeError::none);
  EXPECT_EQ(image(), one_);
}

TEST_F(FirmwareMemoryTest, KeeperThatKeepsAtOnce_EndsTheDownload) {
  keeps_at_once_ = true;
  memory_.set_keeper(this);
  EXPECT_FALSE(download(one_).in_progress);
  EXPECT_EQ(image(), one_);
}

TEST_F(FirmwareMemoryTest, KeeperThatFails_LeavesTheOldImageAndSaysDiskFull) {
  ASSERT_TRUE(memory_.restore(two_));
  memory_.set_keeper(this);
  download(one_);
  memory_.finish(download_, false);
  EXPECT_EQ(memory_.commit().error, FoeError::disk_full);
  EXPECT_EQ(image(), two_);
  keeps_at_once_ = true;
  EXPECT_EQ(download(one_).error, FoeError::none) << "the next one is not blamed";
}

TEST_F(FirmwareMemoryTest, ImageBeingKept_CanBeReadAlready) {
  memory_.set_keeper(this);
  download(one_);
  ASSERT_EQ(memory_.open_for_reading(""), FoeError::none);
  EXPECT_EQ(read(0, 50), Bytes(50, std::byte{1}));
  memory_.finish(download_, true);
  EXPECT_EQ(read(50, 50), Bytes(50, std::byte{1}));
}

TEST_F(FirmwareMemoryTest, ImageThatFallsBackWhileItIsRead_EndsTheReading) {
  ASSERT_TRUE(memory_.restore(two_));
  memory_.set_keeper(this);
  download(one_);
  ASSERT_EQ(memory_.open_for_reading(""), FoeError::none);
  memory_.finish(download_, false);
  Bytes bytes(10);
  EXPECT_EQ(memory_.read(60, bytes), FoeError::program_error);
}

TEST_F(FirmwareMemoryTest, NewerDownload_TakesThePlaceOfTheOneBeingKept) {
  memory_.set_keeper(this);
  download(one_);
  const std::uint32_t first = download_;
  EXPECT_TRUE(download(two_).in_progress);
  memory_.finish(first, true);
  EXPECT_TRUE(memory_.commit().in_progress);
  EXPECT_TRUE(image().empty());
  memory_.finish(download_, true);
  EXPECT_EQ(image(), two_);
  EXPECT_EQ(memory_.downloads(), 2U);
}

}  // namespace
}  // namespace stator::product

// Firmware download to a TMCL module's boot loader, page by page.
#include "stator/tmcl/sessions/boot_loader.hpp"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "stator/tmcl/command.hpp"

namespace stator::tmcl {
namespace {

constexpr std::uint32_t kStart = 0x8000;

class BootLoaderTest : public testing::Test {
 protected:
  BootLoaderTest() { loader_.enter(); }

  BootLoader::Answer execute(Command command, std::int32_t value = 0, int type = 0, int motor = 0) {
    return loader_.execute({.command = static_cast<std::uint8_t>(command),
                            .type = static_cast<std::uint8_t>(type),
                            .motor = static_cast<std::uint8_t>(motor),
                            .value = value});
  }
  Status status_of(Command command, std::int32_t value = 0, int type = 0, int motor = 0) {
    return execute(command, value, type, motor).status;
  }
  /// Writes `words` words from the start address on, the n-th of them n, and its last page.
  void write_words(std::int32_t words) {
    for (std::int32_t n = 0; n < words; ++n) {
      EXPECT_EQ(status_of(Command::boot_write_buffer, n, n % 64), Status::success);
      if (n % 64 == 63 || n == words - 1) {
        EXPECT_EQ(
            status_of(Command::boot_write_page, static_cast<std::int32_t>(kStart) + n / 64 * 256),
            Status::success);
      }
    }
  }
  void state_length_and_sum(std::int32_t length, std::int32_t sum) {
    EXPECT_EQ(status_of(Command::boot_write_length, length, 0), Status::success);
    EXPECT_EQ(status_of(Command::boot_write_length, sum, 1), Status::success);
  }

  BootLoader loader_{{.page_size = 256, .start_address = kStart, .size = 4096}};
};

TEST_F(BootLoaderTest, TellsItsMemory) {
  EXPECT_EQ(execute(Command::boot_get_info, 0, 0).value, 256);
  EXPECT_EQ(execute(Command::boot_get_info, 0, 1).value, 0x8000);
  EXPECT_EQ(execute(Command::boot_get_info, 0, 2).value, 4096);
  EXPECT_EQ(status_of(Command::boot_get_info, 0, 3), Status::wrong_type);
}

TEST_F(BootLoaderTest, AnImageOfSeveralPagesIsTakenByteForByte) {
  EXPECT_EQ(status_of(Command::boot_erase_all), Status::success);
  write_words(100);
  const std::int32_t sum = 99 * 100 / 2;
  EXPECT_EQ(execute(Command::boot_get_checksum, 0x8000 + 399).value, sum);
  EXPECT_FALSE(loader_.complete()) << "its length is not stated yet";
  state_length_and_sum(400, sum);
  ASSERT_TRUE(loader_.complete());
  ASSERT_EQ(loader_.image().size(), 400U);
  for (std::size_t i = 0; i < 400; ++i) {
    EXPECT_EQ(loader_.image()[i], static_cast<std::byte>(i % 4 == 0 ? i / 4 : 0)) << i;
  }
}

TEST_F(BootLoaderTest, AnImageWithAWrongSumIsNotComplete) {
  EXPECT_EQ(status_of(Command::boot_erase_all), Status::success);
  write_words(10);
  state_length_and_sum(40, 46);
  EXPECT_FALSE(loader_.complete());
  EXPECT_TRUE(loader_.image().empty());
  state_length_and_sum(40, 45);
  EXPECT_TRUE(loader_.complete());
}

TEST_F(BootLoaderTest, AddressesOutsideItsMemoryAreRefused) {
  EXPECT_EQ(status_of(Command::boot_write_page, 0x8000), Status::invalid_value)
      << "nothing is erased";
  EXPECT_EQ(status_of(Command::boot_erase_all), Status::success);
  EXPECT_EQ(status_of(Command::boot_write_page, 0x7F00), Status::invalid_value);
  EXPECT_EQ(status_of(Command::boot_write_page, 0x8001), Status::invalid_value);
  EXPECT_EQ(status_of(Command::boot_write_page, 0x9000), Status::invalid_value);
  EXPECT_EQ(status_of(Command::boot_write_page, 0x8F00), Status::success) << "the last page";
  EXPECT_EQ(status_of(Command::boot_write_buffer, 1, 64), Status::invalid_value);
  EXPECT_EQ(status_of(Command::boot_write_buffer, 1, 0, 1), Status::invalid_value);
  EXPECT_EQ(status_of(Command::boot_get_checksum, 0x9000), Status::invalid_value);
  EXPECT_EQ(status_of(Command::boot_get_checksum, 0), Status::invalid_value);
}

TEST_F(BootLoaderTest, KnowsNoCommandOfTheFirmware) {
  EXPECT_EQ(status_of(Command::get_axis_parameter), Status::invalid_command);
}

}  // namespace
}  // namespace stator::tmcl

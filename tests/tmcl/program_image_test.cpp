// TMCL programs as bytes: seven an instruction, downloads, damaged ones.
#include "stator/tmcl/assembler/program_image.hpp"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace stator::tmcl {
namespace {

using ::testing::ElementsAre;

const std::vector<Instruction> two_commands{{2, 0, 0, 500000}, {4, 1, 0, -1000}};

Telegram telegram(const std::array<int, 9>& bytes) {
  Telegram result{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    result[i] = static_cast<std::byte>(bytes[i]);
  }
  return result;
}

TEST(ProgramImage, HoldsSevenBytesPerInstructionTheHighestOfTheValueFirst) {
  const auto image = image_of(two_commands);
  std::vector<int> bytes;
  bytes.reserve(image.size());
  for (const std::byte each : image) {
    bytes.push_back(std::to_integer<int>(each));
  }
  EXPECT_THAT(bytes, ElementsAre(2, 0, 0, 0x00, 0x07, 0xA1, 0x20,  //
                                 4, 1, 0, 0xFF, 0xFF, 0xFC, 0x18));
  EXPECT_EQ(program_in(std::span(image)), two_commands);
}

TEST(ProgramImage, OfAnotherLengthIsNone) {
  const auto image = image_of(two_commands);
  EXPECT_FALSE(program_in(std::span(image).first(13)));
  EXPECT_TRUE(program_in(std::span(image).first(0))->empty());
}

TEST(ProgramImage, IsDownloadedBetweenTheCommandsForIt) {
  const auto download = download_of(two_commands, 3);
  EXPECT_THAT(download, ElementsAre(telegram({3, 132, 0, 0, 0, 0, 0, 0, 135}),
                                    telegram({3, 2, 0, 0, 0, 0x07, 0xA1, 0x20, 0xCD}),
                                    telegram({3, 4, 1, 0, 0xFF, 0xFF, 0xFC, 0x18, 0x1A}),
                                    telegram({3, 133, 0, 0, 0, 0, 0, 0, 136})));
  EXPECT_EQ(program_in(std::span(download)), two_commands);
  EXPECT_EQ(program_in(std::span(download).subspan(1, 2)), two_commands);
}

TEST(ProgramImage, IsNotTakenFromADamagedDownload) {
  auto download = download_of(two_commands, 1);
  download[1][4] ^= std::byte{1};
  EXPECT_FALSE(program_in(std::span<const Telegram>(download)));
}

}  // namespace
}  // namespace stator::tmcl

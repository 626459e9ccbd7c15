#include "drive/object_bench.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>

#include <gtest/gtest.h>

namespace stator::drive {

bool ObjectBench::told(const std::string& text) const {
  return std::any_of(sentences.begin(), sentences.end(), [&](const std::string& sentence) {
    return sentence.find(text) != std::string::npos;
  });
}

void ObjectBench::write(std::uint16_t index, std::uint8_t subindex, std::int64_t value) {
  std::array<std::byte, 8> data{};
  for (std::size_t i = 0; i < data.size(); ++i) {
    data[i] = static_cast<std::byte>(static_cast<std::uint64_t>(value) >> (8 * i));
  }
  dictionary::Entry& entry = *dictionary.find(index, subindex);
  ASSERT_TRUE(dictionary.write(entry, std::span(data).first(entry.size()),
                               {dictionary::NetworkState::operational}));
  obey();
}

void ObjectBench::set_profile(std::int64_t velocity, std::int64_t acceleration,
                              std::int64_t deceleration) {
  write(0x6081, velocity);
  write(0x6083, acceleration);
  write(0x6084, deceleration);
}

void ObjectBench::start() {
  write(0x6040, 0x0F);
  write(0x6040, 0x1F);
}

void ObjectBench::request_operation(ModeCode mode) {
  write(0x6060, static_cast<std::int64_t>(mode));
  for (const int controlword : {6, 7, 15}) {
    write(0x6040, controlword);
  }
}

}  // namespace stator::drive

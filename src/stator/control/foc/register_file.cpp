#include "stator/control/foc/register_file.hpp"

#include "stator/control/foc/register_map.hpp"

namespace stator::control::foc {

RegisterFile::RegisterFile() {
  for (const RegisterDescription& description : registers()) {
    if (description.view == kPlain) {
      words_[description.address] = description.reset;
    } else if (description.address == kConfigData) {
      config_[static_cast<std::uint16_t>(description.view)] = description.reset;
    }
  }
}

bool RegisterFile::write(std::uint8_t address, std::int16_t view, std::uint32_t value) {
  const std::uint32_t bits = writable_mask(address, view);
  if (bits == 0 || (view != kPlain && address != kConfigData)) {
    return false;
  }
  std::uint32_t& content =
      view == kPlain ? words_[address] : config_[static_cast<std::uint16_t>(view)];
  content = (content & ~bits) | (value & bits);
  return true;
}

}  // namespace stator::control::foc

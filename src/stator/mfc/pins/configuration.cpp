#include "stator/mfc/pins/configuration.hpp"

#include <algorithm>

#include "stator/base/byte_order.hpp"

namespace stator::mfc {

namespace {

constexpr unsigned kTriggerMask = 0x0F;
constexpr unsigned kEnable = 0x10;

}  // namespace

Configuration::Configuration(std::span<const std::byte> bytes) {
  std::copy_n(bytes.begin(), std::min(bytes.size(), kLength), bytes_.begin());
}

std::uint32_t Configuration::high_voltage() const {
  return base::load_le<std::uint32_t>(bytes_, kHighVoltage);
}

void Configuration::set_high_voltage(std::uint32_t value) {
  base::store_le(std::span<std::byte>(bytes_), kHighVoltage, value);
}

std::uint16_t Configuration::regulators() const {
  return base::load_le<std::uint16_t>(bytes_, kRegulators);
}

void Configuration::set_regulators(std::uint16_t value) {
  base::store_le(std::span<std::byte>(bytes_), kRegulators, value);
}

std::uint16_t Configuration::block_start(unsigned block) const {
  return base::load_le<std::uint16_t>(bytes_, kBlockStarts + std::size_t{2} * block);
}

void Configuration::set_block_start(unsigned block, std::uint16_t address) {
  base::store_le(std::span<std::byte>(bytes_), kBlockStarts + std::size_t{2} * block, address);
}

Mapping Configuration::mapping(std::size_t number) const {
  const unsigned value = at(kMappings + number);
  return {(value & kEnable) != 0, static_cast<Trigger>(value & kTriggerMask)};
}

void Configuration::set_mapping(std::size_t number, Mapping mapping) {
  put(kMappings + number,
      static_cast<unsigned>(mapping.trigger) | (mapping.enabled ? kEnable : 0U));
}

}  // namespace stator::mfc

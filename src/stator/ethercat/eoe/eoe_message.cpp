#include "stator/ethercat/eoe/eoe_message.hpp"

#include <algorithm>

namespace stator::ethercat {

namespace {

// Flags of the block's first word: which parameters follow, in this order.
constexpr std::uint32_t kMacAddress = 0x01;
constexpr std::uint32_t kAddress = 0x02;
constexpr std::uint32_t kSubnetMask = 0x04;
constexpr std::uint32_t kDefaultGateway = 0x08;
constexpr std::uint32_t kDnsServer = 0x10;
constexpr std::uint32_t kDnsName = 0x20;
constexpr std::uint32_t kAppendTimeStamp = 0x10000;  // a wish, not a parameter

constexpr std::size_t kFlagsSize = 4;

/// IPv4 addresses are little-endian numbers here, so the last octet comes first.
Ipv4Address load_address(std::span<const std::byte> bytes) {
  Ipv4Address address{};
  std::ranges::transform(bytes.first<4>(), address.rbegin(),
                         [](std::byte byte) { return std::to_integer<std::uint8_t>(byte); });
  return address;
}

void store_address(std::span<std::byte> bytes, const Ipv4Address& address) {
  std::transform(address.rbegin(), address.rend(), bytes.begin(),
                 [](std::uint8_t octet) { return static_cast<std::byte>(octet); });
}

struct AddressField {
  std::uint32_t flag;
  std::optional<Ipv4Address> IpParameters::*member;
};

constexpr std::array<AddressField, 4> kAddressFields{{
    {kAddress, &IpParameters::address},
    {kSubnetMask, &IpParameters::subnet_mask},
    {kDefaultGateway, &IpParameters::default_gateway},
    {kDnsServer, &IpParameters::dns_server},
}};

/// Takes the fields behind the flags one after the other. Packed, a field that is not included has
/// no place; with gaps every field has one.
class FieldReader {
 public:
  FieldReader(std::span<const std::byte> fields, std::uint32_t flags, bool with_gaps)
      : rest_(fields), flags_(flags), with_gaps_(with_gaps) {}

  /// The bytes of the next field, which has `flag`; none if it is not included or not there.
  std::optional<std::span<const std::byte>> take(std::uint32_t flag, std::size_t size) {
    const bool included = (flags_ & flag) != 0;
    if (!included && !with_gaps_) {
      return std::nullopt;
    }
    complete_ = complete_ && rest_.size() >= size;
    if (!complete_) {
      return std::nullopt;
    }
    const std::span<const std::byte> field = rest_.first(size);
    rest_ = rest_.subspan(size);
    return included ? std::optional(field) : std::nullopt;
  }
  /// Every field that is included was there.
  [[nodiscard]] bool complete() const { return complete_; }
  [[nodiscard]] std::span<const std::byte> rest() const { return rest_; }

 private:
  std::span<const std::byte> rest_;
  std::uint32_t flags_;
  bool with_gaps_;
  bool complete_ = true;
};

}  // namespace

bool decode_ip_parameters(std::span<const std::byte> block, IpParameters& parameters,
                          bool& append_time_stamp) {
  if (block.size() < kFlagsSize) {
    return false;
  }
  const auto flags = base::load_le<std::uint32_t>(block);
  FieldReader fields(block.subspan(kFlagsSize), flags, block.size() == kMaximumIpParameterBlock);
  IpParameters changed = parameters;
  if (const auto bytes = fields.take(kMacAddress, sizeof(MacAddress))) {
    std::ranges::copy(*bytes,
                      std::as_writable_bytes(std::span(changed.mac_address.emplace())).begin());
  }
  for (const AddressField& field : kAddressFields) {
    if (const auto bytes = fields.take(field.flag, sizeof(Ipv4Address))) {
      changed.*field.member = load_address(*bytes);
    }
  }
  if (!fields.complete()) {
    return false;
  }
  if ((flags & kDnsName) != 0) {
    auto& name = changed.dns_name.emplace();
    const std::span<const std::byte> rest = fields.rest();
    std::ranges::copy(rest.first(std::min(rest.size(), name.size())),
                      std::as_writable_bytes(std::span(name)).begin());
  }
  parameters = changed;
  append_time_stamp = (flags & kAppendTimeStamp) != 0;
  return true;
}

std::size_t encode_ip_parameters(const IpParameters& parameters, std::span<std::byte> block) {
  std::uint32_t flags = 0;
  std::size_t used = kFlagsSize;
  if (parameters.mac_address) {
    flags |= kMacAddress;
    std::ranges::copy(std::as_bytes(std::span(*parameters.mac_address)),
                      block.subspan(used).begin());
    used += parameters.mac_address->size();
  }
  for (const AddressField& field : kAddressFields) {
    if (const auto& address = parameters.*field.member) {
      flags |= field.flag;
      store_address(block.subspan(used), *address);
      used += address->size();
    }
  }
  if (parameters.dns_name) {
    flags |= kDnsName;
    std::ranges::copy(std::as_bytes(std::span(*parameters.dns_name)), block.subspan(used).begin());
    used += parameters.dns_name->size();
  }
  base::store_le(block, 0, flags);
  return used;
}

}  // namespace stator::ethercat

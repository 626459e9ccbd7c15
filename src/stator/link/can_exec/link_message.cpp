#include "stator/link/can_exec/link_message.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <string_view>

#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/if_link.h>
#include <linux/rtnetlink.h>
#include <unistd.h>

namespace stator::link::can_exec {

namespace {

constexpr std::uint32_t kClock = 80'000'000;  // Hz, a usual one of CAN controllers
constexpr std::uint8_t kOperationallyUp = 6;  // RFC 2863 ifOperStatus, as Linux counts
constexpr std::uint8_t kOperationallyDown = 2;

/// Appends attributes, each in its frame of length and type.
class Attributes {
 public:
  explicit Attributes(std::string& message) : message_(message) {}

  template <typename Value>
  void put(unsigned type, const Value& value) {
    put_bytes(type, {reinterpret_cast<const char*>(&value), sizeof value});
  }
  void put_text(unsigned type, const std::string& text) {
    put_bytes(type, {text.c_str(), text.size() + 1});
  }
  void put_bytes(unsigned type, std::string_view bytes) {
    const std::size_t begin = open(type);
    message_ += bytes;
    close(begin);
  }
  /// Begins an attribute that holds others; close() takes what this returned.
  std::size_t open(unsigned type) {
    const std::size_t begin = message_.size();
    const rtattr head{.rta_len = 0, .rta_type = static_cast<std::uint16_t>(type)};
    message_.append(reinterpret_cast<const char*>(&head), sizeof head);
    return begin;
  }
  void close(std::size_t begin) {
    const auto length = static_cast<std::uint16_t>(message_.size() - begin);
    std::memcpy(message_.data() + begin + offsetof(rtattr, rta_len), &length, sizeof length);
    message_.resize(message_.size() + (RTA_ALIGN(length) - length), '\0');
  }

 private:
  std::string& message_;
};

/// The timing by which a controller with kClock reaches the bit rate, with the sample point that
/// CiA 301 recommends and Linux calculates with.
can_bittiming timing(std::uint32_t bit_rate) {
  constexpr std::uint32_t kQuanta = 16;
  can_bittiming timing{};
  timing.bitrate = bit_rate;
  timing.phase_seg2 = bit_rate > 800'000 ? 4 : bit_rate > 500'000 ? 3 : 2;
  const std::uint32_t before = kQuanta - 1 - timing.phase_seg2;
  timing.prop_seg = before / 2;
  timing.phase_seg1 = before - timing.prop_seg;
  timing.sample_point = 1'000 * (kQuanta - timing.phase_seg2) / kQuanta;
  timing.sjw = 1;
  timing.brp = std::max<std::uint32_t>(1, kClock / (bit_rate * kQuanta));
  timing.tq = static_cast<std::uint32_t>(std::uint64_t{1'000'000'000} * timing.brp / kClock);
  return timing;
}

void put_controller(Attributes& attributes, const InterfaceState& state) {
  const can_state controller = state.up ? CAN_STATE_ERROR_ACTIVE : CAN_STATE_STOPPED;
  const can_clock clock{.freq = kClock};
  can_bittiming_const limits{};
  std::strncpy(limits.name, "stator", sizeof limits.name - 1);
  limits.tseg1_min = 1;
  limits.tseg1_max = 16;
  limits.tseg2_min = 1;
  limits.tseg2_max = 8;
  limits.sjw_max = 4;
  limits.brp_min = 1;
  limits.brp_max = 1'024;
  limits.brp_inc = 1;
  if (state.port.bit_rate != 0) {
    attributes.put(IFLA_CAN_BITTIMING, timing(state.port.bit_rate));
  }
  attributes.put(IFLA_CAN_BITTIMING_CONST, limits);
  attributes.put(IFLA_CAN_CLOCK, clock);
  attributes.put(IFLA_CAN_STATE, std::uint32_t{controller});
  attributes.put(IFLA_CAN_CTRLMODE, can_ctrlmode{});
  attributes.put(IFLA_CAN_RESTART_MS, std::uint32_t{0});
  attributes.put(IFLA_CAN_BERR_COUNTER, can_berr_counter{});
}

void put_link_info(Attributes& attributes, const InterfaceState& state) {
  can_device_stats statistics{};
  statistics.bus_error = static_cast<std::uint32_t>(state.port.bus_errors);
  const std::size_t info = attributes.open(IFLA_LINKINFO);
  attributes.put_text(IFLA_INFO_KIND, "can");
  const std::size_t data = attributes.open(IFLA_INFO_DATA);
  put_controller(attributes, state);
  attributes.close(data);
  attributes.put(IFLA_INFO_XSTATS, statistics);
  attributes.close(info);
}

template <typename Statistics>
Statistics to_statistics(const PortState& port) {
  Statistics statistics{};
  using Count = decltype(statistics.rx_packets);
  statistics.rx_packets = static_cast<Count>(port.frames_received);
  statistics.tx_packets = static_cast<Count>(port.frames_sent);
  statistics.rx_bytes = static_cast<Count>(port.bytes_received);
  statistics.tx_bytes = static_cast<Count>(port.bytes_sent);
  statistics.rx_dropped = static_cast<Count>(port.frames_dropped);
  return statistics;
}

void put_attributes(Attributes& attributes, const Bus& bus, const InterfaceState& state) {
  attributes.put_text(IFLA_IFNAME, bus.name);
  attributes.put(IFLA_TXQLEN, std::uint32_t{kTransmitQueue});
  attributes.put(IFLA_OPERSTATE, state.up ? kOperationallyUp : kOperationallyDown);
  attributes.put(IFLA_LINKMODE, std::uint8_t{0});
  attributes.put(IFLA_MTU, std::uint32_t{CAN_MTU});
  attributes.put(IFLA_MIN_MTU, std::uint32_t{CAN_MTU});
  attributes.put(IFLA_MAX_MTU, std::uint32_t{CAN_MTU});
  attributes.put(IFLA_GROUP, std::uint32_t{0});
  attributes.put(IFLA_PROMISCUITY, std::uint32_t{0});
  attributes.put(IFLA_NUM_TX_QUEUES, std::uint32_t{1});
  attributes.put(IFLA_NUM_RX_QUEUES, std::uint32_t{1});
  attributes.put(IFLA_CARRIER, static_cast<std::uint8_t>(state.up ? 1 : 0));
  attributes.put_text(IFLA_QDISC, "pfifo_fast");
  attributes.put(IFLA_STATS64, to_statistics<rtnl_link_stats64>(state.port));
  attributes.put(IFLA_STATS, to_statistics<rtnl_link_stats>(state.port));
  put_link_info(attributes, state);
}

/// The attribute of that type among `attributes`, or nothing.
std::optional<std::span<const std::byte>> find_attribute(std::span<const std::byte> attributes,
                                                         unsigned type) {
  while (attributes.size() >= sizeof(rtattr)) {
    rtattr head{};
    std::memcpy(&head, attributes.data(), sizeof head);
    if (head.rta_len < sizeof head || head.rta_len > attributes.size()) {
      return std::nullopt;
    }
    if ((head.rta_type & NLA_TYPE_MASK) == type) {
      return attributes.subspan(sizeof head, head.rta_len - sizeof head);
    }
    attributes =
        attributes.subspan(std::min<std::size_t>(RTA_ALIGN(head.rta_len), attributes.size()));
  }
  return std::nullopt;
}

std::string to_text(std::span<const std::byte> attribute) {
  const std::string text(reinterpret_cast<const char*>(attribute.data()), attribute.size());
  return text.substr(0, text.find('\0'));
}

const Bus* named_bus(const ifinfomsg& about, std::span<const std::byte> attributes) {
  if (about.ifi_index != 0) {
    return bus_with_index(about.ifi_index);
  }
  for (const unsigned type : {unsigned{IFLA_IFNAME}, unsigned{IFLA_ALT_IFNAME}}) {
    if (const auto name = find_attribute(attributes, type)) {
      return bus_named(to_text(*name).c_str());
    }
  }
  return nullptr;
}

/// Are CAN interfaces among what a listing asks for? Linux leaves out others than those of a wanted
/// kind or master, and bridges have a family of their own.
bool lists_buses(const ifinfomsg& about, std::span<const std::byte> attributes) {
  if (about.ifi_family != AF_UNSPEC && about.ifi_family != AF_PACKET) {
    return false;
  }
  if (find_attribute(attributes, IFLA_MASTER)) {
    return false;
  }
  if (const auto info = find_attribute(attributes, IFLA_LINKINFO)) {
    const auto kind = find_attribute(*info, IFLA_INFO_KIND);
    return !kind || to_text(*kind) == "can";
  }
  return true;
}

/// What a change is answered with: a bus cannot be changed from here, but it may be up.
int judge_change(const Bus& bus, const ifinfomsg& wanted, std::span<const std::byte> attributes) {
  const bool wants_up =
      (wanted.ifi_flags & IFF_UP) != 0 && (wanted.ifi_change & ~unsigned{IFF_UP}) == 0;
  if (!wants_up || !attributes.empty()) {
    return EOPNOTSUPP;
  }
  return ask(bus).up ? 0 : ENETDOWN;
}

}  // namespace

std::optional<nlmsghdr> take_header(std::span<const std::byte> datagram, std::size_t& offset) {
  nlmsghdr header{};
  if (offset > datagram.size() || datagram.size() - offset < sizeof header) {
    return std::nullopt;
  }
  std::memcpy(&header, datagram.data() + offset, sizeof header);
  if (header.nlmsg_len < sizeof header || header.nlmsg_len > datagram.size() - offset) {
    return std::nullopt;
  }
  offset += NLMSG_ALIGN(header.nlmsg_len);
  return header;
}

LinkQuestion read_question(std::span<const std::byte> message) {
  using enum LinkQuestion::Kind;
  nlmsghdr header{};
  std::memcpy(&header, message.data(), sizeof header);
  const bool is_listing = (header.nlmsg_flags & NLM_F_DUMP) != 0;
  const std::span content = message.subspan(NLMSG_HDRLEN);
  if (header.nlmsg_type == RTM_GETADDR && is_listing && content.size() >= sizeof(ifaddrmsg)) {
    ifaddrmsg about{};
    std::memcpy(&about, content.data(), sizeof about);
    const Bus* const bus = bus_with_index(static_cast<int>(about.ifa_index));
    return {.kind = bus != nullptr ? empty : none, .bus = bus};
  }
  const bool is_question = header.nlmsg_type == RTM_GETLINK;
  if (!is_question && header.nlmsg_type != RTM_NEWLINK && header.nlmsg_type != RTM_SETLINK) {
    return {};
  }
  ifinfomsg about{};
  std::memcpy(&about, content.data(), std::min(content.size(), sizeof about));
  const std::span attributes = content.subspan(std::min(content.size(), sizeof about));
  if (is_question && is_listing) {
    return {.kind = lists_buses(about, attributes) ? listing : none};
  }
  const Bus* const bus = named_bus(about, attributes);
  if (bus == nullptr) {
    return {};
  }
  return is_question
             ? LinkQuestion{.kind = one, .bus = bus}
             : LinkQuestion{
                   .kind = change, .bus = bus, .error = judge_change(*bus, about, attributes)};
}

std::string link_message(const Bus& bus, const nlmsghdr& to, std::uint16_t flags) {
  const InterfaceState state = ask(bus);
  nlmsghdr header{};
  header.nlmsg_type = RTM_NEWLINK;
  header.nlmsg_flags = flags;
  header.nlmsg_seq = to.nlmsg_seq;
  header.nlmsg_pid = to.nlmsg_pid;
  ifinfomsg about{};
  about.ifi_type = ARPHRD_CAN;
  about.ifi_index = bus.index;
  about.ifi_flags = interface_flags(state);
  std::string message(reinterpret_cast<const char*>(&header), sizeof header);
  message.append(reinterpret_cast<const char*>(&about), sizeof about);
  Attributes attributes(message);
  put_attributes(attributes, bus, state);
  header.nlmsg_len = static_cast<std::uint32_t>(message.size());
  std::memcpy(message.data(), &header.nlmsg_len, sizeof header.nlmsg_len);
  return message;
}

}  // namespace stator::link::can_exec

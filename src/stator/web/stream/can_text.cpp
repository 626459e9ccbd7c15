#include "stator/web/stream/can_text.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/nmt/lss_protocol.hpp"
#include "stator/canopen/nmt_command.hpp"
#include "stator/ethercat/units/fmmu.hpp"
#include "stator/tmcl/command.hpp"
#include "stator/tmcl/telegram.hpp"
#include "stator/web/stream/object_text.hpp"
#include "stator/web/stream/sdo_text.hpp"

namespace stator::web {

namespace {

// Predefined connection set (CiA 301 §7.3.5).
constexpr std::uint32_t kSync = 0x080;
constexpr std::uint32_t kTime = 0x100;
constexpr std::uint32_t kFirstPdo = 0x180;
constexpr std::uint32_t kSdoAnswers = 0x580;
constexpr std::uint32_t kSdoRequests = 0x600;
constexpr std::uint32_t kNodes = 0x7F;
constexpr std::uint32_t kLssMaster = 0x7E5;

std::uint32_t big_endian(std::span<const std::byte> bytes) {
  std::uint32_t value = 0;
  for (const std::byte byte : bytes) {
    value = value << 8U | std::to_integer<std::uint32_t>(byte);
  }
  return value;
}

std::string node_text(unsigned node_id, const std::vector<NodeMap>& nodes) {
  const auto found = std::ranges::find(nodes, node_id, &NodeMap::node_id);
  return found == nodes.end() ? fmt::format("node {}", node_id)
                              : fmt::format("node {} {}", node_id, found->name);
}

const dictionary::Dictionary* objects_of(unsigned node_id, const std::vector<NodeMap>& nodes) {
  const auto found = std::ranges::find(nodes, node_id, &NodeMap::node_id);
  return found == nodes.end() ? nullptr : found->objects;
}

std::string nmt(std::span<const std::byte> data, const std::vector<NodeMap>& nodes) {
  if (data.size() != 2) {
    return "NMT of a wrong length";
  }
  const auto command = std::to_integer<std::uint8_t>(data[0]);
  const auto node = std::to_integer<unsigned>(data[1]);
  const auto transition = canopen::find_transition(command);
  const std::string to = node == 0 ? "all nodes" : node_text(node, nodes);
  if (!transition) {
    return fmt::format("NMT command {}, {}", command, to);
  }
  switch (transition->command) {
    case canopen::NmtCommand::reset_node:
      return "NMT reset node, " + to;
    case canopen::NmtCommand::reset_communication:
      return "NMT reset communication, " + to;
    default:
      return fmt::format("NMT {}, {}", to_text(transition->target), to);
  }
}

std::string error_control(const can::Frame& frame, const std::vector<NodeMap>& nodes) {
  const std::string node = node_text(frame.identifier & kNodes, nodes);
  if (frame.remote) {
    return "node guarding, request to " + node;
  }
  if (frame.length == 0) {
    return "error control without state, " + node;
  }
  constexpr unsigned kState = 0x7F;
  const unsigned state = std::to_integer<unsigned>(frame.data[0]) & kState;
  if (state == 0) {
    return "boot-up, " + node;
  }
  return fmt::format("heartbeat {}, {}", to_text(static_cast<canopen::NmtState>(state)), node);
}

std::string emergency(const can::Frame& frame, const std::vector<NodeMap>& nodes,
                      DecodedFrame& decoded) {
  const std::string node = node_text(frame.identifier & kNodes, nodes);
  if (frame.payload().size() < 8) {
    return "EMCY of a wrong length, " + node;
  }
  const auto code = base::load_le<std::uint16_t>(frame.payload(), 0);
  decoded.add("code", fmt::format("{:04X}h", code));
  decoded.add("error register", fmt::format("{:02X}h", std::to_integer<unsigned>(frame.data[2])));
  decoded.add("manufacturer", hexadecimal_text(frame.payload().subspan(3)));
  return code == 0 ? "EMCY error reset, " + node : fmt::format("EMCY {:04X}h, {}", code, node);
}

std::string pdo(const can::Frame& frame, const NodeMap& node, const NodeMap::Pdo& pdo,
                DecodedFrame& decoded) {
  const std::span<const std::byte> data = frame.payload();
  std::string control;
  for (const MappedObject& object : pdo.objects) {
    if (object.index == 0 || object.bits == 0 || object.bits > 64 ||
        object.bit + object.bits > 8 * data.size()) {
      continue;
    }
    std::array<std::byte, 8> value{};
    ethercat::copy_bits(value.data(), 0, data.data(), object.bit, object.bits);
    const std::string text = value_text(node.objects, object.index, object.subindex,
                                        std::span(value).first((object.bits + 7) / 8));
    if (control.empty() && text.find('(') != std::string::npos) {
      control = ": " + text;
    }
    decoded.add(object_text(node.objects, object.index, object.subindex), text);
  }
  return fmt::format("{} {}{}{}", frame.remote ? "request of" : "PDO", pdo.name, ", " + node.name,
                     control);
}

std::string tmcl_request(const can::Frame& frame, const NodeMap& node, DecodedFrame& decoded) {
  const std::span<const std::byte> data = frame.payload();
  if (data.size() < 7) {
    return "TMCL request of a wrong length, " + node.name;
  }
  const auto command = std::to_integer<std::uint8_t>(data[0]);
  const auto type = std::to_integer<unsigned>(data[1]);
  const auto motor = std::to_integer<unsigned>(data[2]);
  const auto value = static_cast<std::int32_t>(big_endian(data.subspan(3, 4)));
  const std::string_view known = tmcl::name_of(command);
  const std::string name = known.empty() ? fmt::format("command {}", command) : std::string(known);
  decoded.add("command", name);
  decoded.add("type", std::to_string(type));
  decoded.add("motor or bank", std::to_string(motor));
  decoded.add("value", std::to_string(value));
  return fmt::format("TMCL {} {}, {}, {}, to {}", name, type, motor, value, node.name);
}

std::string tmcl_reply(const can::Frame& frame, DecodedFrame& decoded) {
  const std::span<const std::byte> data = frame.payload();
  if (data.size() < 7) {
    return "TMCL reply of a wrong length";
  }
  const auto status = static_cast<tmcl::Status>(data[1]);
  const auto command = std::to_integer<std::uint8_t>(data[2]);
  const auto value = static_cast<std::int32_t>(big_endian(data.subspan(3, 4)));
  decoded.add("status", std::string(tmcl::status_text(status)));
  decoded.add("command", std::string(tmcl::name_of(command)));
  decoded.add("value", std::to_string(value));
  return fmt::format("TMCL {}, {} = {}", tmcl::status_text(status), tmcl::name_of(command), value);
}

/// What the rack's own modules and PDOs say; nothing: it is none of them.
std::optional<std::string> of_device(const can::Frame& frame, const std::vector<NodeMap>& nodes,
                                     DecodedFrame& decoded) {
  for (const NodeMap& node : nodes) {
    if (std::ranges::find(node.tmcl_requests, frame.identifier) != node.tmcl_requests.end()) {
      return tmcl_request(frame, node, decoded);
    }
    if (!node.tmcl_requests.empty() && frame.identifier == node.tmcl_replies) {
      return tmcl_reply(frame, decoded);
    }
    if (const auto found = node.pdos.find(frame.identifier); found != node.pdos.end()) {
      return pdo(frame, node, found->second, decoded);
    }
  }
  return std::nullopt;
}

/// By the predefined connection set.
std::string predefined(const can::Frame& frame, const std::vector<NodeMap>& nodes,
                       DecodedFrame& decoded) {
  const unsigned node = frame.identifier & kNodes;
  switch (frame.identifier & ~kNodes) {
    case kSync:
      if (node != 0) {
        return emergency(frame, nodes, decoded);
      }
      return frame.length == 0 ? "SYNC"
                               : fmt::format("SYNC {}", std::to_integer<unsigned>(frame.data[0]));
    case kTime:
      return node == 0 ? "TIME" : "CAN frame";
    case kSdoAnswers:
      return describe_sdo(frame.payload(), false, objects_of(node, nodes), decoded) + ", " +
             node_text(node, nodes);
    case kSdoRequests:
      return describe_sdo(frame.payload(), true, objects_of(node, nodes), decoded) + ", " +
             node_text(node, nodes);
    case canopen::kErrorControlBase:
      return error_control(frame, nodes);
    default:
      break;
  }
  if (frame.identifier == canopen::lss::kSlaveIdentifier || frame.identifier == kLssMaster) {
    return frame.length == 0
               ? "LSS"
               : fmt::format("LSS service {}{}", std::to_integer<unsigned>(frame.data[0]),
                             frame.identifier == kLssMaster ? "" : ", answer");
  }
  if (frame.identifier >= kFirstPdo && frame.identifier < kSdoAnswers) {
    return "PDO, " + node_text(node, nodes);
  }
  return "CAN frame";
}

}  // namespace

DecodedFrame describe_can(const can::Frame& frame, const std::vector<NodeMap>& nodes) {
  DecodedFrame decoded;
  const std::string identifier = frame.extended ? fmt::format("{:08X}h", frame.identifier)
                                                : fmt::format("{:03X}h", frame.identifier);
  decoded.add("identifier", identifier);
  decoded.add("length", std::to_string(frame.length));
  if (frame.remote) {
    decoded.add("remote", "yes");
  }
  const bool canopen = std::ranges::any_of(nodes, [](const NodeMap& n) { return n.node_id != 0; });
  std::string text;
  if (frame.extended) {
    text = "CAN frame";
  } else if (frame.identifier == canopen::kNmtIdentifier && canopen) {
    text = nmt(frame.payload(), nodes);
  } else if (auto own = of_device(frame, nodes, decoded)) {
    text = std::move(*own);
  } else {
    text = canopen ? predefined(frame, nodes, decoded) : "CAN frame";
  }
  decoded.summary = identifier + " " + text;
  return decoded;
}

}  // namespace stator::web

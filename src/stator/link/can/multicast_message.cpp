#include "stator/link/can/multicast_message.hpp"

#include <algorithm>
#include <bit>

#include "stator/link/can/message_pack.hpp"

namespace stator::link {

namespace {

constexpr std::uint32_t kMaximumStandard = 0x7FF;
constexpr std::uint32_t kMaximumExtended = 0x1FFFFFFF;
constexpr unsigned kFields = 11;

/// What a can.Message has and a classical frame has not, too.
struct Fields {
  std::uint64_t identifier = 0;
  bool extended = true;
  bool remote = false;
  bool error = false;
  bool flexible_data_rate = false;
  std::optional<std::uint64_t> length;
  std::span<const std::byte> data;
};

MulticastMessage encode(const Fields& fields, base::SimTime time) {
  MulticastMessage message;
  MessagePackWriter writer(message.bytes);
  writer.map(kFields);
  writer.text("timestamp");
  writer.number(time.seconds());
  writer.text("arbitration_id");
  writer.number(static_cast<std::uint32_t>(fields.identifier));
  writer.text("is_extended_id");
  writer.boolean(fields.extended);
  writer.text("is_remote_frame");
  writer.boolean(fields.remote);
  writer.text("is_error_frame");
  writer.boolean(fields.error);
  writer.text("channel");
  writer.nil();
  writer.text("dlc");
  writer.number(static_cast<std::uint32_t>(fields.length.value_or(fields.data.size())));
  writer.text("data");
  writer.binary(fields.data);
  writer.text("is_fd");
  writer.boolean(false);
  writer.text("bitrate_switch");
  writer.boolean(false);
  writer.text("error_state_indicator");
  writer.boolean(false);
  message.size = writer.size();
  return message;
}

/// False if the value is of another type than the field needs.
bool read_field(std::string_view name, MessagePackReader& reader, Fields& fields) {
  const auto take_boolean = [&](bool& to) {
    const auto value = reader.boolean();
    to = value.value_or(to);
    return value.has_value();
  };
  if (name == "arbitration_id" || name == "dlc") {
    const auto value = reader.unsigned_number();
    if (value) {
      (name == "dlc" ? fields.length.emplace() : fields.identifier) = *value;
    }
    return value.has_value();
  }
  if (name == "is_extended_id") {
    return take_boolean(fields.extended);
  }
  if (name == "is_remote_frame") {
    return take_boolean(fields.remote);
  }
  if (name == "is_error_frame") {
    return take_boolean(fields.error);
  }
  if (name == "is_fd") {
    return take_boolean(fields.flexible_data_rate);
  }
  if (name == "data" && !reader.next_is_nil()) {
    const auto value = reader.binary();
    fields.data = value.value_or(std::span<const std::byte>());
    return value.has_value();
  }
  return reader.skip();
}

/// Nothing if the fields are no classical frame that could be on a bus.
std::optional<can::Frame> to_frame(const Fields& fields) {
  const std::uint64_t length = fields.length.value_or(fields.data.size());
  if (fields.identifier > (fields.extended ? kMaximumExtended : kMaximumStandard) ||
      length > can::kMaximumData || fields.data.size() != (fields.remote ? 0 : length)) {
    return std::nullopt;
  }
  can::Frame frame{.identifier = static_cast<std::uint32_t>(fields.identifier),
                   .extended = fields.extended,
                   .remote = fields.remote,
                   .length = static_cast<std::uint8_t>(length)};
  std::ranges::copy(fields.data, frame.data.begin());
  return frame;
}

}  // namespace

MulticastMessage encode_multicast(const can::Frame& frame, base::SimTime time) {
  return encode({.identifier = frame.identifier,
                 .extended = frame.extended,
                 .remote = frame.remote,
                 .length = frame.length,
                 .data = frame.payload()},
                time);
}

MulticastMessage encode_multicast(const ErrorFrame& error, base::SimTime time) {
  return encode({.identifier = error.classes, .error = true, .length = {}, .data = error.data},
                time);
}

DecodedMulticast decode_multicast(std::span<const std::byte> datagram) {
  MessagePackReader reader(datagram);
  const auto count = reader.map();
  if (!count) {
    return {};
  }
  Fields fields;
  for (std::uint32_t i = 0; i < *count; ++i) {
    const auto name = reader.text();
    if (!name || !read_field(*name, reader, fields)) {
      return {};
    }
  }
  if (!reader.at_end()) {
    return {};
  }
  if (fields.flexible_data_rate) {
    return {.content = MulticastContent::not_classical, .frame = {}};
  }
  if (fields.error) {
    return {.content = MulticastContent::error_frame, .frame = {}};
  }
  const auto frame = to_frame(fields);
  return frame ? DecodedMulticast{MulticastContent::frame, *frame} : DecodedMulticast{};
}

}  // namespace stator::link

#include "stator/web/stream/sdo_text.hpp"

#include <cstdint>
#include <string>

#include <fmt/format.h>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/sdo/sdo_protocol.hpp"
#include "stator/dictionary/abort_code.hpp"
#include "stator/web/stream/object_text.hpp"

namespace stator::web {

namespace {

namespace sdo = canopen::sdo;

constexpr std::size_t kAddressEnd = 4;  // command, index, subindex
constexpr std::size_t kSizeEnd = 8;
constexpr unsigned kCompleteAccess = 0x10;

struct Sdo {
  unsigned command = 0;
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::span<const std::byte> bytes;

  [[nodiscard]] bool expedited() const { return (command & sdo::kExpedited) != 0; }
  /// The data of an initiate service: up to four bytes in place, or what follows the size (CoE).
  [[nodiscard]] std::span<const std::byte> data() const {
    if (!expedited()) {
      return bytes.subspan(kSizeEnd);
    }
    const std::size_t unused =
        (command & sdo::kSizeIndicated) != 0 ? command >> 2U & 3U : std::size_t{0};
    return bytes.subspan(kAddressEnd, sdo::kExpeditedMaximum - unused);
  }
};

/// An initiate service that carries data.
std::string transfer(const Sdo& message, const char* what, const dictionary::Dictionary* objects,
                     DecodedFrame& decoded) {
  const std::string object = object_text(objects, message.index, message.subindex);
  const bool complete = (message.command & kCompleteAccess) != 0;
  const std::string value =
      complete ? hexadecimal_text(message.data(), 64)
               : value_text(objects, message.index, message.subindex, message.data());
  decoded.add("object", object);
  if (complete) {
    decoded.add("complete access", "yes");
  }
  if (!message.expedited() && (message.command & sdo::kSizeIndicated) != 0) {
    decoded.add("bytes", std::to_string(base::load_le<std::uint32_t>(message.bytes, kAddressEnd)));
  }
  if (!value.empty()) {
    decoded.add("value", value);
  }
  return fmt::format("SDO {} {}{}{}", what, object, value.empty() ? "" : " = ", value);
}

std::string address_only(const Sdo& message, const char* what,
                         const dictionary::Dictionary* objects, DecodedFrame& decoded) {
  const std::string object = object_text(objects, message.index, message.subindex);
  decoded.add("object", object);
  return fmt::format("SDO {} {}", what, object);
}

std::string segment(const Sdo& message, const char* what, DecodedFrame& decoded) {
  const std::string data = hexadecimal_text(message.bytes.subspan(1), 64);
  decoded.add("segment", data);
  return fmt::format("SDO {} segment{}", what,
                     (message.command & sdo::kLastSegment) != 0 ? ", the last" : "");
}

std::string abort(const Sdo& message, const dictionary::Dictionary* objects,
                  DecodedFrame& decoded) {
  const auto code = base::load_le<std::uint32_t>(message.bytes, kAddressEnd);
  const std::string reason = fmt::format(
      "{:08X}h ({})", code, dictionary::to_text(static_cast<dictionary::AbortCode>(code)));
  const std::string object = object_text(objects, message.index, message.subindex);
  decoded.add("object", object);
  decoded.add("abort code", reason);
  return fmt::format("SDO abort {}: {}", object, reason);
}

std::string describe_request(const Sdo& message, const dictionary::Dictionary* objects,
                             DecodedFrame& decoded) {
  switch (static_cast<sdo::ClientCommand>(message.command >> 5U)) {
    case sdo::ClientCommand::download_segment:
      return segment(message, "download", decoded);
    case sdo::ClientCommand::initiate_download:
      return transfer(message, "download", objects, decoded);
    case sdo::ClientCommand::initiate_upload:
      return address_only(message, "upload", objects, decoded);
    case sdo::ClientCommand::upload_segment:
      return "SDO upload segment, request";
    case sdo::ClientCommand::abort:
      return abort(message, objects, decoded);
    case sdo::ClientCommand::block_upload:
      return "SDO block upload";
    case sdo::ClientCommand::block_download:
      return "SDO block download";
  }
  return "SDO of an unknown kind";
}

std::string describe_response(const Sdo& message, const dictionary::Dictionary* objects,
                              DecodedFrame& decoded) {
  switch (message.command & 0xE0U) {
    case sdo::kUploadSegmentResponse:
      return segment(message, "upload", decoded);
    case sdo::kDownloadSegmentResponse:
      return "SDO download segment, done";
    case sdo::kUploadResponse:
      return transfer(message, "upload", objects, decoded);
    case sdo::kDownloadResponse:
      return address_only(message, "download done", objects, decoded);
    case sdo::kAbort:
      return abort(message, objects, decoded);
    case sdo::kBlockDownloadResponse:
      return "SDO block download, answer";
    case sdo::kBlockUploadResponse:
      return "SDO block upload, answer";
    default:
      return "SDO of an unknown kind";
  }
}

}  // namespace

std::string describe_sdo(std::span<const std::byte> bytes, bool request,
                         const dictionary::Dictionary* objects, DecodedFrame& decoded) {
  if (bytes.size() < kSizeEnd) {
    return "SDO, too short";
  }
  const Sdo message{.command = std::to_integer<unsigned>(bytes[0]),
                    .index = base::load_le<std::uint16_t>(bytes, 1),
                    .subindex = std::to_integer<std::uint8_t>(bytes[3]),
                    .bytes = bytes};
  return request ? describe_request(message, objects, decoded)
                 : describe_response(message, objects, decoded);
}

}  // namespace stator::web

#include "stator/master/sdo_information_client.hpp"

#include <algorithm>
#include <array>

#include "stator/dictionary/abort_code.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

using ethercat::MailboxType;

namespace {

constexpr std::uint16_t kSdoInformation = 8;  // CoE service
constexpr std::size_t kHeader = 6;            // CoE header, opcode, reserved, fragments left

constexpr std::uint8_t kListRequest = 1;  // opcodes, ETG.1000.6 table 43; the answer is one higher
constexpr std::uint8_t kObjectRequest = 3;
constexpr std::uint8_t kEntryRequest = 5;
constexpr std::uint8_t kErrorAnswer = 7;
constexpr std::uint8_t kOpcodeMask = 0x7F;

// Value info of an entry description, ETG.1000.6 table 52.
constexpr unsigned kUnitType = 0x08;
constexpr unsigned kDefaultValue = 0x10;
constexpr unsigned kMinimumValue = 0x20;
constexpr unsigned kMaximumValue = 0x40;
constexpr std::uint8_t kEverything = 0x7F;

std::string to_string(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Takes `length` bytes off the front of `rest`, or what is left of them.
std::vector<std::byte> take(std::span<const std::byte>& rest, std::size_t length) {
  const auto part = rest.first(std::min(length, rest.size()));
  rest = rest.subspan(part.size());
  return {part.begin(), part.end()};
}

}  // namespace

/// Sends one request and joins the fragments of the answer (without their headers).
Result<std::vector<std::byte>> SdoInformationClient::request(std::uint8_t opcode,
                                                             std::span<const std::byte> data,
                                                             const std::string& what) {
  std::vector<std::byte> message(kHeader + data.size());
  base::store_le(std::span(message), 0, static_cast<std::uint16_t>(kSdoInformation << 12));
  message[2] = static_cast<std::byte>(opcode);
  std::copy(data.begin(), data.end(), message.begin() + kHeader);
  if (const auto sent = mailbox_.send(MailboxType::coe, message); !sent) {
    return base::Unexpected{sent.error()};
  }
  std::vector<std::byte> answer;
  base::SimTime deadline = mailbox_.answer_deadline();
  while (true) {
    const auto fragment = mailbox_.receive(MailboxType::coe, deadline);
    if (!fragment) {
      Error error = fragment.error();
      error.text = what + ": " + error.text;
      return base::Unexpected{error};
    }
    if (fragment->size() < kHeader ||
        base::load_le<std::uint16_t>(*fragment) >> 12 != kSdoInformation) {
      continue;
    }
    const auto answered =
        static_cast<std::uint8_t>(std::to_integer<std::uint8_t>((*fragment)[2]) & kOpcodeMask);
    if (answered == kErrorAnswer && fragment->size() >= kHeader + 4) {
      const auto code = base::load_le<std::uint32_t>(*fragment, kHeader);
      return fail(ErrorCode::sdo_aborted,
                  what + " of " + mailbox_.station().name() + " refused: " + hexadecimal(code, 8) +
                      " " +
                      std::string(dictionary::to_text(static_cast<dictionary::AbortCode>(code))),
                  code);
    }
    if (answered != opcode + 1) {
      continue;
    }
    answer.insert(answer.end(), fragment->begin() + kHeader, fragment->end());
    if (base::load_le<std::uint16_t>(*fragment, 4) == 0) {
      return answer;
    }
    deadline = mailbox_.answer_deadline();
  }
}

Result<std::vector<std::uint16_t>> SdoInformationClient::object_list(ObjectListType type) {
  std::array<std::byte, 2> data{};
  base::store_le(data.data(), static_cast<std::uint16_t>(type));
  const auto answer = request(kListRequest, data, "object list");
  if (!answer) {
    return base::Unexpected{answer.error()};
  }
  std::vector<std::uint16_t> indices;
  for (std::size_t at = 2; at + 2 <= answer->size(); at += 2) {
    indices.push_back(base::load_le<std::uint16_t>(*answer, at));
  }
  return indices;
}

Result<ObjectDescription> SdoInformationClient::object_description(std::uint16_t index) {
  std::array<std::byte, 2> data{};
  base::store_le(data.data(), index);
  const std::string what = "description of object " + hexadecimal(index, 4);
  const auto answer = request(kObjectRequest, data, what);
  if (!answer) {
    return base::Unexpected{answer.error()};
  }
  if (answer->size() < 6) {
    return fail(ErrorCode::protocol, what + ": " + mailbox_.station().name() + " sent " +
                                         std::to_string(answer->size()) +
                                         " bytes, at least 6 "
                                         "are needed");
  }
  return ObjectDescription{.index = base::load_le<std::uint16_t>(*answer, 0),
                           .data_type = base::load_le<std::uint16_t>(*answer, 2),
                           .maximum_subindex = std::to_integer<std::uint8_t>((*answer)[4]),
                           .object_code = std::to_integer<std::uint8_t>((*answer)[5]),
                           .name = to_string(std::span(*answer).subspan(6))};
}

Result<EntryDescription> SdoInformationClient::entry_description(std::uint16_t index,
                                                                 std::uint8_t subindex) {
  std::array<std::byte, 4> data{};
  base::store_le(data.data(), index);
  data[2] = static_cast<std::byte>(subindex);
  data[3] = static_cast<std::byte>(kEverything);
  const std::string what = "description of entry " + to_text(ObjectAddress{index, subindex});
  const auto answer = request(kEntryRequest, data, what);
  if (!answer) {
    return base::Unexpected{answer.error()};
  }
  if (answer->size() < 10) {
    return fail(ErrorCode::protocol, what + ": " + mailbox_.station().name() + " sent " +
                                         std::to_string(answer->size()) +
                                         " bytes, at least 10 "
                                         "are needed");
  }
  EntryDescription entry{.index = base::load_le<std::uint16_t>(*answer, 0),
                         .subindex = std::to_integer<std::uint8_t>((*answer)[2]),
                         .data_type = base::load_le<std::uint16_t>(*answer, 4),
                         .bit_length = base::load_le<std::uint16_t>(*answer, 6),
                         .access = base::load_le<std::uint16_t>(*answer, 8)};
  const auto value_info = std::to_integer<unsigned>((*answer)[3]);
  const std::size_t value_length = (std::size_t{entry.bit_length} + 7) / 8;
  std::span<const std::byte> rest = std::span(*answer).subspan(10);
  if ((value_info & kUnitType) != 0) {
    take(rest, sizeof(std::uint16_t));
  }
  if ((value_info & kDefaultValue) != 0) {
    entry.default_value = take(rest, value_length);
  }
  if ((value_info & kMinimumValue) != 0) {
    entry.minimum = take(rest, value_length);
  }
  if ((value_info & kMaximumValue) != 0) {
    entry.maximum = take(rest, value_length);
  }
  entry.name = to_string(rest);
  return entry;
}

}  // namespace stator::master

#include "stator/master/sdo_client.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "stator/dictionary/abort_code.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

using ethercat::MailboxType;

namespace {

// CoE header (ETG.1000.6 table 29): service in bits 12 to 15.
constexpr std::size_t kCoeHeader = 2;
constexpr std::uint16_t kSdoRequest = 2;
constexpr std::uint16_t kSdoResponse = 3;

// SDO command byte (ETG.1000.6 tables 31 to 39; CiA 301 §7.2.4.3).
constexpr unsigned kSpecifierMask = 0xE0;
constexpr unsigned kUploadSegment = 0x60;
constexpr unsigned kUploadInitiate = 0x40;
constexpr unsigned kDownloadInitiate = 0x20;
constexpr unsigned kDownloadSegment = 0x00;
constexpr unsigned kUploadInitiateAnswer = 0x40;
constexpr unsigned kUploadSegmentAnswer = 0x00;
constexpr unsigned kDownloadInitiateAnswer = 0x60;
constexpr unsigned kDownloadSegmentAnswer = 0x20;
constexpr unsigned kAbort = 0x80;
constexpr unsigned kCompleteAccess = 0x10;
constexpr unsigned kToggle = 0x10;
constexpr unsigned kExpedited = 0x02;
constexpr unsigned kSizeIndicated = 0x01;
constexpr unsigned kLastSegment = 0x01;

constexpr std::size_t kInitiateLength = 8;  // command, index, subindex, four bytes
constexpr std::size_t kSegmentHeader = 1;
constexpr std::size_t kShortestSegment = 7;  // data bytes of a segment in a CAN frame

unsigned command_of(std::span<const std::byte> sdo) {
  return std::to_integer<unsigned>(sdo[0]);
}

/// Command, index and subindex, with four zero bytes behind.
std::vector<std::byte> initiate(unsigned command, const ObjectAddress& object) {
  std::vector<std::byte> sdo(kInitiateLength);
  sdo[0] = static_cast<std::byte>(command | (object.complete_access ? kCompleteAccess : 0U));
  base::store_le(std::span(sdo), 1, object.index);
  sdo[3] = static_cast<std::byte>(object.subindex);
  return sdo;
}

bool concerns(std::span<const std::byte> sdo, const ObjectAddress& object) {
  return base::load_le<std::uint16_t>(sdo, 1) == object.index &&
         std::to_integer<std::uint8_t>(sdo[3]) == object.subindex;
}

}  // namespace

Error SdoClient::protocol_error(const Transfer& transfer, const std::string& what) const {
  return {ErrorCode::protocol, 0,
          std::string("SDO ") + transfer.verb + " of " + to_text(transfer.object) + " at " +
              mailbox_.station().name() + ": " + what};
}

Result<void> SdoClient::send(std::span<const std::byte> sdo) {
  std::vector<std::byte> message(kCoeHeader + sdo.size());
  base::store_le(std::span(message), 0, static_cast<std::uint16_t>(kSdoRequest << 12));
  std::copy(sdo.begin(), sdo.end(), message.begin() + kCoeHeader);
  return mailbox_.send(MailboxType::coe, message);
}

/// The answer to the request just sent; answers to other objects are late ones and are dropped.
Result<std::vector<std::byte>> SdoClient::receive(const Transfer& transfer, bool is_initiate) {
  const base::SimTime deadline = mailbox_.answer_deadline();
  while (true) {
    auto message = mailbox_.receive(MailboxType::coe, deadline);
    if (!message) {
      Error error = message.error();
      error.text = std::string("SDO ") + transfer.verb + " of " + to_text(transfer.object) + ": " +
                   error.text;
      return base::Unexpected{error};
    }
    const auto service = message->size() > kCoeHeader ? base::load_le<std::uint16_t>(*message) >> 12
                                                      : std::uint16_t{0};
    const std::span<const std::byte> sdo =
        std::span(*message).subspan(std::min(kCoeHeader, message->size()));
    // Slaves send an abort as request (the standard) or as response (many do).
    const bool is_abort = sdo.size() >= kInitiateLength && command_of(sdo) == kAbort &&
                          (service == kSdoRequest || service == kSdoResponse);
    if (is_abort && concerns(sdo, transfer.object)) {
      const auto code = base::load_le<std::uint32_t>(sdo, 4);
      return fail(ErrorCode::sdo_aborted,
                  std::string("SDO ") + transfer.verb + " of " + to_text(transfer.object) +
                      (transfer.verb[0] == 'r' ? " from " : " to ") + mailbox_.station().name() +
                      " aborted: " + hexadecimal(code, 8) + " " +
                      std::string(dictionary::to_text(static_cast<dictionary::AbortCode>(code))),
                  code);
    }
    const bool usable = service == kSdoResponse && !is_abort &&
                        (is_initiate ? sdo.size() >= kInitiateLength : !sdo.empty()) &&
                        (!is_initiate || concerns(sdo, transfer.object));
    if (usable) {
      return std::vector<std::byte>(sdo.begin(), sdo.end());
    }
  }
}

/// Tells the slave that the transfer is over and returns the reason as an error.
Result<void> SdoClient::abort(const Transfer& transfer, std::uint32_t code,
                              const std::string& reason) {
  ObjectAddress object = transfer.object;
  object.complete_access = false;
  std::vector<std::byte> sdo = initiate(kAbort, object);
  base::store_le(std::span(sdo), 4, code);
  if (auto sent = send(sdo); !sent) {
    return sent;
  }
  return base::Unexpected{protocol_error(transfer, reason)};
}

Result<std::vector<std::byte>> SdoClient::upload(const ObjectAddress& object) {
  const Transfer transfer{"read", object};
  if (const auto sent = send(initiate(kUploadInitiate, object)); !sent) {
    return base::Unexpected{sent.error()};
  }
  auto answer = receive(transfer, true);
  if (!answer) {
    return answer;
  }
  const unsigned command = command_of(*answer);
  if ((command & kSpecifierMask) != kUploadInitiateAnswer) {
    return base::Unexpected{
        protocol_error(transfer, "answer with unexpected command byte " + hexadecimal(command, 2))};
  }
  if ((command & kExpedited) != 0) {
    const std::size_t unused = (command & kSizeIndicated) != 0 ? command >> 2 & 3U : 0U;
    return std::vector<std::byte>(answer->begin() + 4,
                                  answer->begin() + 8 - static_cast<std::ptrdiff_t>(unused));
  }
  const std::size_t total = base::load_le<std::uint32_t>(*answer, 4);
  std::vector<std::byte> data(answer->begin() + kInitiateLength, answer->end());
  if (data.size() < total) {
    if (const auto done = upload_segments(transfer, total, data); !done) {
      return base::Unexpected{done.error()};
    }
  }
  if (data.size() != total) {
    return base::Unexpected{protocol_error(
        transfer,
        std::to_string(total) + " bytes were announced, " + std::to_string(data.size()) + " came")};
  }
  return data;
}

Result<void> SdoClient::upload_segments(const Transfer& transfer, std::size_t total,
                                        std::vector<std::byte>& data) {
  unsigned toggle = 0;
  while (true) {
    std::vector<std::byte> request(kInitiateLength);
    request[0] = static_cast<std::byte>(kUploadSegment | toggle);
    if (auto sent = send(request); !sent) {
      return sent;
    }
    const auto answer = receive(transfer, false);
    if (!answer) {
      return base::Unexpected{answer.error()};
    }
    const unsigned command = command_of(*answer);
    if ((command & kSpecifierMask) != kUploadSegmentAnswer || (command & kToggle) != toggle) {
      return abort(transfer,
                   static_cast<std::uint32_t>(dictionary::AbortCode::toggle_bit_not_changed),
                   "segment with unexpected command byte " + hexadecimal(command, 2));
    }
    std::size_t length = answer->size() - kSegmentHeader;
    if (length == kShortestSegment) {
      length -= command >> 1 & 7U;
    }
    data.insert(data.end(), answer->begin() + kSegmentHeader,
                answer->begin() + static_cast<std::ptrdiff_t>(kSegmentHeader + length));
    if ((command & kLastSegment) != 0) {
      return {};
    }
    if (data.size() > total || length == 0) {
      return abort(transfer, static_cast<std::uint32_t>(dictionary::AbortCode::general_error),
                   std::to_string(total) + " bytes were announced, more or empty segments came");
    }
    toggle ^= kToggle;
  }
}

Result<void> SdoClient::download(const ObjectAddress& object, std::span<const std::byte> data) {
  const Transfer transfer{"write", object};
  std::span<const std::byte> rest;
  std::vector<std::byte> request;
  if (!data.empty() && data.size() <= 4 && !object.complete_access) {
    const auto unused = static_cast<unsigned>(4 - data.size());
    request = initiate(kDownloadInitiate | kExpedited | kSizeIndicated | unused << 2, object);
    std::copy(data.begin(), data.end(), request.begin() + 4);
  } else {
    request = initiate(kDownloadInitiate | kSizeIndicated, object);
    base::store_le(std::span(request), 4, static_cast<std::uint32_t>(data.size()));
    const std::size_t room = mailbox_.capacity() - kCoeHeader - kInitiateLength;
    const auto first = data.first(std::min(room, data.size()));
    request.insert(request.end(), first.begin(), first.end());
    rest = data.subspan(first.size());
  }
  if (auto sent = send(request); !sent) {
    return sent;
  }
  const auto answer = receive(transfer, true);
  if (!answer) {
    return base::Unexpected{answer.error()};
  }
  if ((command_of(*answer) & kSpecifierMask) != kDownloadInitiateAnswer) {
    return base::Unexpected{protocol_error(
        transfer, "answer with unexpected command byte " + hexadecimal(command_of(*answer), 2))};
  }
  return rest.empty() ? Result<void>() : download_segments(transfer, rest);
}

Result<void> SdoClient::download_segments(const Transfer& transfer,
                                          std::span<const std::byte> rest) {
  const std::size_t room = mailbox_.capacity() - kCoeHeader - kSegmentHeader;
  unsigned toggle = 0;
  while (!rest.empty()) {
    const auto part = rest.first(std::min(room, rest.size()));
    rest = rest.subspan(part.size());
    const std::size_t padding = part.size() < kShortestSegment ? kShortestSegment - part.size() : 0;
    std::vector<std::byte> request(kSegmentHeader + part.size() + padding);
    request[0] =
        static_cast<std::byte>(kDownloadSegment | toggle | static_cast<unsigned>(padding) << 1 |
                               (rest.empty() ? kLastSegment : 0U));
    std::copy(part.begin(), part.end(), request.begin() + kSegmentHeader);
    if (auto sent = send(request); !sent) {
      return sent;
    }
    const auto answer = receive(transfer, false);
    if (!answer) {
      return base::Unexpected{answer.error()};
    }
    const unsigned command = command_of(*answer);
    if ((command & kSpecifierMask) != kDownloadSegmentAnswer || (command & kToggle) != toggle) {
      return abort(transfer,
                   static_cast<std::uint32_t>(dictionary::AbortCode::toggle_bit_not_changed),
                   "segment answered with unexpected command byte " + hexadecimal(command, 2));
    }
    toggle ^= kToggle;
  }
  return {};
}

}  // namespace stator::master

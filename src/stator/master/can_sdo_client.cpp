#include "stator/master/can_sdo_client.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "stator/base/byte_order.hpp"
#include "stator/master/text.hpp"

namespace stator::master {

namespace {

// Command specifiers, the upper three bits of the first byte (CiA 301 tables 42 to 49).
constexpr unsigned kDownloadSegmentRequest = 0;
constexpr unsigned kInitiateDownloadRequest = 1;
constexpr unsigned kInitiateUploadRequest = 2;
constexpr unsigned kUploadSegmentRequest = 3;
constexpr unsigned kUploadSegmentAnswer = 0;
constexpr unsigned kDownloadSegmentAnswer = 1;
constexpr unsigned kInitiateUploadAnswer = 2;
constexpr unsigned kInitiateDownloadAnswer = 3;
constexpr unsigned kAbort = 4;

constexpr unsigned kExpedited = 0x02;
constexpr unsigned kSizeIndicated = 0x01;
constexpr unsigned kToggle = 0x10;
constexpr unsigned kLastSegment = 0x01;
constexpr std::size_t kExpeditedBytes = 4;
constexpr std::size_t kSegmentBytes = 7;

unsigned first_byte(std::span<const std::byte> data) {
  return std::to_integer<unsigned>(data[0]);
}
unsigned specifier(std::span<const std::byte> data) {
  return first_byte(data) >> 5;
}

std::array<std::byte, can::kMaximumData> request(unsigned first, ObjectAddress object) {
  std::array<std::byte, can::kMaximumData> data{};
  data[0] = static_cast<std::byte>(first);
  base::store_le(data, 1, object.index);
  data[3] = std::byte{object.subindex};
  return data;
}

auto unexpected_answer(ObjectAddress object, unsigned first) {
  return fail(ErrorCode::protocol, "the answer about " + to_text(object) + " begins with " +
                                       hexadecimal(first, 2) + ", which does not fit");
}

}  // namespace

Result<CanSdoClient::Data> CanSdoClient::ask(const Data& request, ObjectAddress object) {
  const auto answer = exchange_(can::data_frame(kRequest + node_id_, request));
  if (!answer || answer->length != can::kMaximumData) {
    return fail(ErrorCode::mailbox, "node " + std::to_string(node_id_) +
                                        " did not answer an SDO about " + to_text(object));
  }
  if (specifier(answer->data) == kAbort) {
    const auto code = base::load_le<std::uint32_t>(std::span(answer->data).subspan(4));
    return fail(ErrorCode::sdo_aborted,
                "node " + std::to_string(node_id_) + " aborted the transfer of " + to_text(object) +
                    ": " + hexadecimal(code, 8),
                code);
  }
  return answer->data;
}

Result<std::vector<std::byte>> CanSdoClient::upload(ObjectAddress object) {
  const auto answer = ask(request(kInitiateUploadRequest << 5, object), object);
  if (!answer) {
    return base::Unexpected{answer.error()};
  }
  if (specifier(*answer) != kInitiateUploadAnswer) {
    return unexpected_answer(object, first_byte(*answer));
  }
  if ((first_byte(*answer) & kExpedited) == 0) {
    return upload_segments(object);
  }
  const std::size_t unused =
      (first_byte(*answer) & kSizeIndicated) != 0 ? first_byte(*answer) >> 2 & 3U : 0U;
  const auto data = std::span(*answer).subspan(4, kExpeditedBytes - unused);
  return std::vector<std::byte>(data.begin(), data.end());
}

Result<std::vector<std::byte>> CanSdoClient::upload_segments(ObjectAddress object) {
  std::vector<std::byte> data;
  for (unsigned toggle = 0;; toggle ^= kToggle) {
    const auto answer = ask(request(kUploadSegmentRequest << 5 | toggle, {}), object);
    if (!answer) {
      return base::Unexpected{answer.error()};
    }
    const unsigned first = first_byte(*answer);
    if (specifier(*answer) != kUploadSegmentAnswer || (first & kToggle) != toggle) {
      return unexpected_answer(object, first);
    }
    const auto segment = std::span(*answer).subspan(1, kSegmentBytes - (first >> 1 & 7U));
    data.insert(data.end(), segment.begin(), segment.end());
    if ((first & kLastSegment) != 0) {
      return data;
    }
  }
}

Result<void> CanSdoClient::download(ObjectAddress object, std::span<const std::byte> data) {
  if (data.empty() || data.size() > kExpeditedBytes) {
    return download_segments(object, data);
  }
  const auto unused = static_cast<unsigned>(kExpeditedBytes - data.size());
  Data expedited =
      request(kInitiateDownloadRequest << 5 | unused << 2 | kExpedited | kSizeIndicated, object);
  std::ranges::copy(data, expedited.begin() + 4);
  const auto answer = ask(expedited, object);
  if (!answer) {
    return base::Unexpected{answer.error()};
  }
  if (specifier(*answer) != kInitiateDownloadAnswer) {
    return unexpected_answer(object, first_byte(*answer));
  }
  return {};
}

Result<void> CanSdoClient::download_segments(ObjectAddress object,
                                             std::span<const std::byte> data) {
  Data begin = request(kInitiateDownloadRequest << 5 | kSizeIndicated, object);
  base::store_le(begin, 4, static_cast<std::uint32_t>(data.size()));
  auto answer = ask(begin, object);
  unsigned expected = kInitiateDownloadAnswer;
  unsigned toggle = 0;
  bool last = false;
  while (answer) {
    const unsigned first = first_byte(*answer);
    if (specifier(*answer) != expected ||
        (expected == kDownloadSegmentAnswer && (first & kToggle) != (toggle ^ kToggle))) {
      return unexpected_answer(object, first);
    }
    if (last) {
      return {};
    }
    const auto segment = data.first(std::min(data.size(), kSegmentBytes));
    data = data.subspan(segment.size());
    last = data.empty();
    const auto unused = static_cast<unsigned>(kSegmentBytes - segment.size());
    Data next{};
    next[0] = static_cast<std::byte>(kDownloadSegmentRequest << 5 | toggle | unused << 1 |
                                     (last ? kLastSegment : 0U));
    std::ranges::copy(segment, next.begin() + 1);
    answer = ask(next, object);
    expected = kDownloadSegmentAnswer;
    toggle ^= kToggle;
  }
  return base::Unexpected{answer.error()};
}

}  // namespace stator::master

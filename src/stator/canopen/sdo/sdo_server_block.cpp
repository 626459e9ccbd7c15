#include <algorithm>

#include "stator/base/byte_order.hpp"
#include "stator/canopen/sdo/crc16.hpp"
#include "stator/canopen/sdo/sdo_protocol.hpp"
#include "stator/canopen/sdo/sdo_server.hpp"

// Block transfer (CiA 301 §7.2.4.2.9 to §7.2.4.2.16): segments go one way without answers, and
// after each block the receiver says up to which of them it has all.

namespace stator::canopen {

namespace {

using base::SimDuration;
using base::SimTime;
using base::Unexpected;
using dictionary::AbortCode;
using dictionary::Verdict;

/// Frames that may wait in the transmit buffer beside a block: emergencies, heartbeats, PDOs.
constexpr std::size_t kRoomForOthers = 32;
/// When the transmit buffer is full: about the time of a frame at 1 Mbit/s.
constexpr SimDuration kRoomRetry(100'000);

/// Bytes without data in the last of the segments that carry `size` bytes.
constexpr std::size_t padding(std::size_t size) {
  return size == 0 ? sdo::kSegmentData
                   : (sdo::kSegmentData - size % sdo::kSegmentData) % sdo::kSegmentData;
}

}  // namespace

SdoServer::Answer SdoServer::block_upload(Request request, unsigned subcommand, SimTime now) {
  const auto command = std::to_integer<unsigned>(request[0]);
  if (!configuration_.block_transfer) {
    return refuse(AbortCode::command_specifier_unknown, sdo::rules::kBlockUnsupported);
  }
  if (subcommand == sdo::kInitiateBlock) {
    return initiate_block_upload(request);
  }
  if (subcommand == sdo::kStartBlock && transfer_ == Transfer::block_upload_begin) {
    transfer_ = Transfer::block_upload;
    return send_block(now);
  }
  if (subcommand == sdo::kAcknowledgeBlock && transfer_ == Transfer::block_upload) {
    return block_upload_acknowledged(request, now);
  }
  if (subcommand == sdo::kEndBlock && transfer_ == Transfer::block_upload_end) {
    forget();
    return std::optional<Reply>();
  }
  return refuse(AbortCode::command_specifier_unknown, sdo::rules::kNoTransfer, command);
}

Verdict SdoServer::set_block_size(unsigned size) {
  if (size == 0 || size > sdo::kMaximumBlockSize) {
    return refuse(AbortCode::invalid_block_size, sdo::rules::kBlockSize, size);
  }
  block_.size = static_cast<std::uint8_t>(size);
  return {};
}

SdoServer::Answer SdoServer::initiate_block_upload(Request request) {
  if (Verdict verdict = set_block_size(std::to_integer<unsigned>(request[4])); !verdict) {
    return Unexpected{verdict.error()};
  }
  if (Verdict verdict = open_upload(); !verdict) {
    return Unexpected{verdict.error()};
  }
  const auto threshold = std::to_integer<std::size_t>(request[5]);
  if (configuration_.honour_protocol_switch_threshold && threshold != 0 && *size_ <= threshold) {
    return answer_upload();
  }
  const unsigned crc = std::to_integer<unsigned>(request[0]) & sdo::kCrcSupported;
  block_.with_crc = crc != 0;
  transfer_ = Transfer::block_upload_begin;
  return std::optional(reply_to_initiate(
      sdo::kBlockUploadResponse | crc | sdo::kBlockSizeIndicated | sdo::kInitiateBlock,
      static_cast<std::uint32_t>(*size_)));
}

bool SdoServer::block_sent() const {
  return block_.sequence == block_.size || block_.last;
}

/// Sends the present block as far as the transmit buffer takes it; advance() goes on with it.
SdoServer::Answer SdoServer::send_block(SimTime now) {
  if (Verdict verdict = check_unchanged(); !verdict) {
    return Unexpected{verdict.error()};
  }
  while (!block_sent()) {
    if (transmitter_.room() <= kRoomForOthers) {
      retry_ = now + kRoomRetry;
      break;
    }
    const std::size_t sent = std::min(*size_ - offset_, sdo::kSegmentData);
    block_.last = offset_ + sent == *size_;
    ++block_.sequence;
    Reply segment{};
    segment[0] =
        static_cast<std::byte>(block_.sequence | (block_.last ? sdo::kLastBlockSegment : 0U));
    std::ranges::copy(upload_data().subspan(offset_, sent), segment.begin() + 1);
    offset_ += sent;
    send(segment);
  }
  return std::optional<Reply>();
}

SdoServer::Answer SdoServer::block_upload_acknowledged(Request request, SimTime now) {
  const auto acknowledged = std::to_integer<unsigned>(request[1]);
  if (acknowledged > block_.sequence) {
    return refuse(AbortCode::invalid_sequence_number, sdo::rules::kAcknowledgedTooMuch,
                  acknowledged, int{block_.sequence});
  }
  retry_ = SimTime::never();
  if (block_.last && acknowledged == block_.sequence) {
    transfer_ = Transfer::block_upload_end;
    Reply reply{};
    reply[0] = static_cast<std::byte>(sdo::kBlockUploadResponse | sdo::kEndBlock |
                                      static_cast<unsigned>(padding(*size_) << 2));
    if (block_.with_crc) {
      base::store_le(reply, 1, crc16(upload_data()));
    }
    return std::optional(reply);
  }
  if (Verdict verdict = set_block_size(std::to_integer<unsigned>(request[2])); !verdict) {
    return Unexpected{verdict.error()};
  }
  offset_ = block_.first_offset + acknowledged * sdo::kSegmentData;
  block_.first_offset = offset_;
  block_.sequence = 0;
  block_.last = false;
  return send_block(now);
}

SdoServer::Answer SdoServer::block_download(Request request, unsigned subcommand, SimTime now) {
  if (!configuration_.block_transfer) {
    return refuse(AbortCode::command_specifier_unknown, sdo::rules::kBlockUnsupported);
  }
  if (subcommand == sdo::kInitiateBlock) {
    return initiate_block_download(request);
  }
  if (transfer_ == Transfer::block_download_end) {
    return end_block_download(request, now);
  }
  return refuse(AbortCode::command_specifier_unknown, sdo::rules::kNoTransfer,
                std::to_integer<unsigned>(request[0]));
}

SdoServer::Answer SdoServer::initiate_block_download(Request request) {
  const auto command = std::to_integer<unsigned>(request[0]);
  std::optional<std::size_t> announced;
  if ((command & sdo::kBlockSizeIndicated) != 0) {
    announced = base::load_le<std::uint32_t>(request, 4);
  }
  if (Verdict verdict = open_download(announced); !verdict) {
    return Unexpected{verdict.error()};
  }
  const unsigned crc = command & sdo::kCrcSupported;
  block_.with_crc = crc != 0;
  block_.size = configuration_.block_size;
  transfer_ = Transfer::block_download;
  return std::optional(reply_to_initiate(sdo::kBlockDownloadResponse | crc | sdo::kInitiateBlock,
                                         std::uint32_t{block_.size}));
}

/// Takes the segment that follows the last one taken; any other is lost until the client repeats it
/// in the next block. A refusal waits for the block's end, where the client listens.
SdoServer::Answer SdoServer::block_download_segment(Request request) {
  const auto header = std::to_integer<unsigned>(request[0]);
  const unsigned sequence = header & sdo::kSequenceMask;
  const bool last = (header & sdo::kLastBlockSegment) != 0;
  if (sequence == 0 || sequence > block_.size) {
    return refuse(AbortCode::invalid_sequence_number, sdo::rules::kSequenceNumber, sequence,
                  int{block_.size});
  }
  block_.pending = true;
  if (sequence == block_.sequence + 1U && !block_.refusal) {
    const std::size_t counting = last ? 0 : sdo::kSegmentData;
    if (Verdict verdict = check_room(offset_ + counting); !verdict) {
      block_.refusal = verdict.error();
    } else {
      std::copy_n(request.begin() + 1, sdo::kSegmentData,
                  buffer_.begin() + static_cast<std::ptrdiff_t>(offset_));
      offset_ += sdo::kSegmentData;
      block_.last = last;
      ++block_.sequence;
    }
  }
  return last || sequence == block_.size ? finish_block() : Answer(std::nullopt);
}

SdoServer::Answer SdoServer::finish_block() {
  if (block_.refusal) {
    return Unexpected{*block_.refusal};
  }
  Reply reply{};
  reply[0] = static_cast<std::byte>(sdo::kBlockDownloadResponse | sdo::kAcknowledgeBlock);
  reply[1] = std::byte{block_.sequence};
  reply[2] = std::byte{block_.size};
  if (block_.last) {
    transfer_ = Transfer::block_download_end;
  }
  block_.sequence = 0;
  block_.pending = false;
  return std::optional(reply);
}

SdoServer::Answer SdoServer::end_block_download(Request request, SimTime now) {
  const auto command = std::to_integer<unsigned>(request[0]);
  offset_ -= (command >> 2) & 7;
  if (Verdict verdict = check_room(offset_); !verdict) {
    return Unexpected{verdict.error()};
  }
  if (block_.with_crc) {
    const auto theirs = base::load_le<std::uint16_t>(request, 1);
    const std::uint16_t ours = crc16(std::span(buffer_).first(offset_));
    if (theirs != ours) {
      return refuse(AbortCode::crc_error, sdo::rules::kCrc, int{theirs}, int{ours});
    }
  }
  Reply reply{};
  reply[0] = static_cast<std::byte>(sdo::kBlockDownloadResponse | sdo::kEndBlock);
  return complete_download(reply, now);
}

}  // namespace stator::canopen

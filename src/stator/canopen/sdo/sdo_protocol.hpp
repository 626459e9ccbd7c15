#pragma once

#include <cstddef>
#include <cstdint>

#include "stator/base/event.hpp"

namespace stator::canopen::sdo {

// The first byte of an SDO (CiA 301 §7.2.4.3.3 to §7.2.4.3.17).

/// Client command specifiers, bits 7..5.
enum class ClientCommand : std::uint8_t {
  download_segment = 0,
  initiate_download = 1,
  initiate_upload = 2,
  upload_segment = 3,
  abort = 4,
  block_upload = 5,
  block_download = 6,
};

// Server command specifiers, in place.
inline constexpr unsigned kUploadSegmentResponse = 0U << 5;
inline constexpr unsigned kDownloadSegmentResponse = 1U << 5;
inline constexpr unsigned kUploadResponse = 2U << 5;
inline constexpr unsigned kDownloadResponse = 3U << 5;
inline constexpr unsigned kAbort = 4U << 5;
inline constexpr unsigned kBlockDownloadResponse = 5U << 5;
inline constexpr unsigned kBlockUploadResponse = 6U << 5;

// Expedited and segmented transfer.
inline constexpr unsigned kSizeIndicated = 0x01;
inline constexpr unsigned kExpedited = 0x02;
inline constexpr unsigned kToggle = 0x10;
inline constexpr unsigned kLastSegment = 0x01;

// Block transfer: subcommands of client and server, and bits beside them.
inline constexpr unsigned kBlockUploadSubcommand = 0x03;
inline constexpr unsigned kBlockDownloadSubcommand = 0x01;
inline constexpr unsigned kInitiateBlock = 0;
inline constexpr unsigned kEndBlock = 1;
inline constexpr unsigned kAcknowledgeBlock = 2;
inline constexpr unsigned kStartBlock = 3;
inline constexpr unsigned kBlockSizeIndicated = 0x02;
inline constexpr unsigned kCrcSupported = 0x04;
inline constexpr unsigned kLastBlockSegment = 0x80;
inline constexpr unsigned kSequenceMask = 0x7F;

inline constexpr std::size_t kExpeditedMaximum = 4;  ///< data bytes of an expedited transfer
inline constexpr std::size_t kSegmentData = 7;       ///< data bytes of a segment
inline constexpr std::uint8_t kMaximumBlockSize = 127;

/// How many bytes of a request carry something, from its first byte; the rest are reserved.
constexpr std::size_t bytes_that_count(unsigned command) {
  constexpr std::size_t kMultiplexer = 4;  // with the command itself
  const bool size_indicated = (command & kSizeIndicated) != 0;
  switch (static_cast<ClientCommand>(command >> 5)) {
    case ClientCommand::upload_segment:
      return 1;
    case ClientCommand::download_segment:
      return 1 + kSegmentData - (command >> 1 & 7U);
    case ClientCommand::initiate_upload:
      return kMultiplexer;
    case ClientCommand::initiate_download:
      if ((command & kExpedited) == 0) {
        return size_indicated ? kMultiplexer + sizeof(std::uint32_t) : kMultiplexer;
      }
      return kMultiplexer + kExpeditedMaximum - (size_indicated ? command >> 2 & 3U : 0U);
    default:
      return kMultiplexer + sizeof(std::uint32_t);
  }
}

// Arguments of the rules: {0} index, {1} subindex, then what the rule adds.
namespace rules {
using base::EventRule;
using base::Severity;

inline constexpr EventRule kUnknownCommand{
    "sdo-command", Severity::refusal,
    "SDO refused: {2:x2} is no request; the server knows download, upload, their segments, block "
    "transfer and abort"};
inline constexpr EventRule kBlockUnsupported{
    "sdo-block-unsupported", Severity::refusal,
    "SDO block transfer of {0:x4}:{1:x2} refused: this device does not support it; use segmented "
    "transfer"};
inline constexpr EventRule kNoSegments{
    "sdo-no-segments", Severity::refusal,
    "SDO transfer of {0:x4}:{1:x2} refused: it needs segments, and the quirk no-segments is on; "
    "take it off the device's table in the rack file"};
inline constexpr EventRule kNoTransfer{
    "sdo-no-transfer", Severity::refusal,
    "SDO refused: request {2:x2} belongs to a transfer, and none of its kind is at that point; "
    "begin with an initiate request"};
inline constexpr EventRule kToggle{
    "sdo-toggle", Severity::refusal,
    "SDO segment of {0:x4}:{1:x2} refused: toggle bit {2} came, {3} was due; the transfer has "
    "ended"};
inline constexpr EventRule kTooManyBytes{
    "sdo-too-many-bytes", Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: {2} bytes came or were announced, {3} were expected"};
inline constexpr EventRule kTooFewBytes{
    "sdo-too-few-bytes", Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: it ended after {2} bytes, {3} were announced"};
inline constexpr EventRule kTooLong{
    "sdo-too-long", Severity::refusal,
    "SDO download to {0:x4}:{1:x2} refused: {2} bytes came or were announced, the server has room "
    "for {3}"};
inline constexpr EventRule kBlockSize{
    "sdo-block-size", Severity::refusal,
    "SDO block upload of {0:x4}:{1:x2} refused: a block of {2} segments was asked for, 1 to 127 "
    "are possible"};
inline constexpr EventRule kAcknowledgedTooMuch{
    "sdo-block-acknowledge", Severity::refusal,
    "SDO block upload of {0:x4}:{1:x2} refused: segment {2} was acknowledged, {3} were sent"};
inline constexpr EventRule kSequenceNumber{
    "sdo-block-sequence", Severity::refusal,
    "SDO block download to {0:x4}:{1:x2} refused: segment number {2} came, a block has 1 to {3}"};
inline constexpr EventRule kCrc{
    "sdo-block-crc", Severity::refusal,
    "SDO block download to {0:x4}:{1:x2} refused: the client's CRC is {2:x4}, that of the data "
    "{3:x4}"};
inline constexpr EventRule kValueChanged{
    "sdo-value-changed", Severity::refusal,
    "SDO upload of {0:x4}:{1:x2} ended: the value had {2} bytes at the begin and now has {3}; read "
    "it again"};
inline constexpr EventRule kTimeout{
    "sdo-timeout", Severity::refusal,
    "SDO transfer of {0:x4}:{1:x2} ended: the client sent nothing for {2} ms"};
inline constexpr EventRule kAbortedByClient{
    "sdo-client-abort", Severity::information,
    "SDO transfer of {0:x4}:{1:x2} ended by the client with abort code {2:x8}"};
inline constexpr EventRule kWrongLength{
    "sdo-length", Severity::refusal,
    "SDO ignored: the frame has {2} data bytes, must have 8; the quirk short-sdo takes requests "
    "that leave out bytes which carry nothing"};
}  // namespace rules

}  // namespace stator::canopen::sdo

// The client's side of SDO transfers for tests, with the abort codes of CiA 301 as numbers.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "node_bench.hpp"

namespace stator::canopen {

inline constexpr std::uint32_t kRequest = 0x600 + NodeBench::kNodeId;
inline constexpr std::uint32_t kResponse = 0x580 + NodeBench::kNodeId;

/// What the node sends upon one SDO request.
inline Texts ask(NodeBench& bench, std::initializer_list<unsigned> request) {
  bench.receive(kRequest, request);
  return to_text(bench.take());
}

/// An abort of the transfer of `index`:`subindex`, as ask() gives it.
inline Texts aborted(unsigned index, unsigned subindex, std::uint32_t code) {
  return {
      to_text(can::data_frame(kResponse, {0x80, index & 0xFF, index >> 8, subindex, code & 0xFF,
                                          (code >> 8) & 0xFF, (code >> 16) & 0xFF, code >> 24}))};
}

/// The standard's abort codes by their numbers, so that a test does not trust the product's names.
inline constexpr std::uint32_t kToggleBit = 0x05030000;
inline constexpr std::uint32_t kTimedOut = 0x05040000;
inline constexpr std::uint32_t kUnknownCommand = 0x05040001;
inline constexpr std::uint32_t kInvalidBlockSize = 0x05040002;
inline constexpr std::uint32_t kInvalidSequence = 0x05040003;
inline constexpr std::uint32_t kCrcError = 0x05040004;
inline constexpr std::uint32_t kOutOfMemory = 0x05040005;
inline constexpr std::uint32_t kWriteOnly = 0x06010001;
inline constexpr std::uint32_t kReadOnly = 0x06010002;
inline constexpr std::uint32_t kNoObject = 0x06020000;
inline constexpr std::uint32_t kHardwareError = 0x06060000;
inline constexpr std::uint32_t kTooLong = 0x06070012;
inline constexpr std::uint32_t kTooShort = 0x06070013;
inline constexpr std::uint32_t kNoSubindex = 0x06090011;
inline constexpr std::uint32_t kOutOfRange = 0x06090030;
inline constexpr std::uint32_t kTooHigh = 0x06090031;
inline constexpr std::uint32_t kTooLow = 0x06090032;
inline constexpr std::uint32_t kIncompatible = 0x06040043;
inline constexpr std::uint32_t kDeviceState = 0x08000022;

/// A client that does whole transfers, byte by byte as the standard says, and keeps what went
/// wrong.
class SdoClient {
 public:
  explicit SdoClient(NodeBench& bench) : bench_(bench) {}

  /// Abort code of the last transfer; 0: it succeeded.
  std::uint32_t abort_code = 0;

  std::string upload(std::uint16_t index, std::uint8_t subindex = 0) {
    can::Frame answer = exchange(initiate(0x40, index, subindex));
    const unsigned command = byte(answer, 0);
    if ((command & 0xE0) != 0x40) {
      return {};
    }
    if ((command & 2) != 0) {
      return text(answer, 4, 4 - ((command >> 2) & 3));
    }
    const auto size = base::load_le<std::uint32_t>(answer.data, 4);
    std::string value;
    for (unsigned toggle = 0; abort_code == 0; toggle ^= 0x10) {
      answer = exchange(can::data_frame(kRequest, {0x60 | toggle, 0, 0, 0, 0, 0, 0, 0}));
      EXPECT_EQ(byte(answer, 0) & 0xF0, toggle);
      value += text(answer, 1, 7 - ((byte(answer, 0) >> 1) & 7));
      if ((byte(answer, 0) & 1) != 0) {
        break;
      }
    }
    EXPECT_EQ(value.size(), size);
    return value;
  }

  /// Segmented, whatever the length.
  void download(std::uint16_t index, std::uint8_t subindex, const std::string& value,
                bool announce = true) {
    can::Frame request = initiate(announce ? 0x21 : 0x20, index, subindex);
    base::store_le(request.data, 4, static_cast<std::uint32_t>(announce ? value.size() : 0));
    exchange(request);
    std::size_t offset = 0;
    for (unsigned toggle = 0; abort_code == 0; toggle ^= 0x10) {
      const std::size_t part = std::min<std::size_t>(7, value.size() - offset);
      const bool last = offset + part == value.size();
      can::Frame segment = can::data_frame(
          kRequest, {toggle | static_cast<unsigned>((7 - part) << 1) | (last ? 1U : 0U), 0, 0, 0, 0,
                     0, 0, 0});
      put(segment, 1, value.substr(offset, part));
      const can::Frame answer = exchange(segment);
      offset += part;
      if (abort_code == 0) {
        EXPECT_EQ(byte(answer, 0), 0x20 | toggle);
      }
      if (last) {
        break;
      }
    }
  }

  /// Block upload. The segments named by `lost`, counted from 1 over the whole transfer, do not
  /// arrive the first time.
  std::string block_upload(std::uint16_t index, bool crc, std::vector<std::size_t> lost = {},
                           unsigned block_size = 127) {
    can::Frame request = initiate(crc ? 0xA4 : 0xA0, index, 0);
    request.data[4] = static_cast<std::byte>(block_size);
    const can::Frame begin = exchange(request);
    if (abort_code != 0) {
      return {};
    }
    EXPECT_EQ(byte(begin, 0), crc ? 0xC6U : 0xC2U);
    const auto size = base::load_le<std::uint32_t>(begin.data, 4);
    std::string value;
    std::size_t count = 0;
    bench_.receive(can::data_frame(kRequest, {0xA3, 0, 0, 0, 0, 0, 0, 0}));
    for (int blocks = 0; blocks < 100'000; ++blocks) {
      bench_.wait(base::SimDuration(10'000'000));
      const std::vector<can::Frame> segments = bench_.take();
      EXPECT_LE(segments.size(), block_size);
      unsigned taken = 0;
      bool complete = false;
      for (const can::Frame& segment : segments) {
        const bool arrives = std::erase(lost, ++count) == 0;
        if (arrives && (byte(segment, 0) & 0x7F) == taken + 1) {
          ++taken;
          value += text(segment, 1, 7);
          complete = (byte(segment, 0) & 0x80) != 0;
        }
      }
      const can::Frame answer = can::data_frame(kRequest, {0xA2, taken, block_size, 0, 0, 0, 0, 0});
      if (complete) {
        const can::Frame end = exchange(answer);
        EXPECT_EQ(byte(end, 0) & 0xE3, 0xC1U);
        value = value.substr(0, value.size() - ((byte(end, 0) >> 2) & 7));
        EXPECT_EQ(value.size(), size);
        checksum = base::load_le<std::uint16_t>(end.data, 1);
        bench_.receive(can::data_frame(kRequest, {0xA1, 0, 0, 0, 0, 0, 0, 0}));
        EXPECT_EQ(to_text(bench_.take()), Texts{});
        return value;
      }
      bench_.receive(answer);
    }
    ADD_FAILURE() << "the block upload does not end";
    return value;
  }

  /// Block download. `lost` as for block_upload(). `checksum` is sent if `crc`.
  void block_download(std::uint16_t index, const std::string& value, bool crc,
                      std::vector<std::size_t> lost = {}, bool announce = true) {
    can::Frame request = initiate((crc ? 0xC4U : 0xC0U) | (announce ? 2U : 0U), index, 0);
    base::store_le(request.data, 4, static_cast<std::uint32_t>(announce ? value.size() : 0));
    can::Frame answer = exchange(request);
    if (abort_code != 0) {
      return;
    }
    EXPECT_EQ(byte(answer, 0), crc ? 0xA4U : 0xA0U);
    unsigned block_size = byte(answer, 4);
    const std::size_t segments = std::max<std::size_t>(1, (value.size() + 6) / 7);
    std::size_t acknowledged = 0;
    std::size_t count = 0;
    while (acknowledged < segments) {
      const std::size_t in_block = std::min<std::size_t>(block_size, segments - acknowledged);
      for (std::size_t i = 1; i <= in_block; ++i) {
        const bool last = acknowledged + i == segments;
        can::Frame segment = can::data_frame(
            kRequest, {static_cast<unsigned>(i) | (last ? 0x80U : 0U), 0, 0, 0, 0, 0, 0, 0});
        const std::size_t offset = 7 * (acknowledged + i - 1);
        put(segment, 1, value.substr(std::min(offset, value.size()), 7));
        if (std::erase(lost, ++count) == 0) {
          bench_.receive(segment);
        }
      }
      bench_.wait(base::SimDuration(600'000'000));  // a lost end of a block is noticed by time
      const std::vector<can::Frame> answers = bench_.take();
      if (answers.size() != 1 || byte(answers[0], 0) != 0xA2) {
        abort_code = answers.empty() ? 1 : base::load_le<std::uint32_t>(answers[0].data, 4);
        return;
      }
      acknowledged += byte(answers[0], 1);
      block_size = byte(answers[0], 2);
    }
    const auto padding = static_cast<unsigned>(7 * segments - value.size());
    can::Frame end = can::data_frame(kRequest, {0xC1 | padding << 2, 0, 0, 0, 0, 0, 0, 0});
    base::store_le(end.data, 1, checksum);
    answer = exchange(end);
    if (abort_code == 0) {
      EXPECT_EQ(to_text(answer), "585 [A1 00 00 00 00 00 00 00]");
    }
  }

  std::uint16_t checksum = 0;  ///< of the last block upload, and for the next block download

 private:
  static unsigned byte(const can::Frame& frame, std::size_t position) {
    return std::to_integer<unsigned>(frame.data[position]);
  }
  static std::string text(const can::Frame& frame, std::size_t from, std::size_t length) {
    return {reinterpret_cast<const char*>(frame.data.data()) + from, length};
  }
  static void put(can::Frame& frame, std::size_t from, const std::string& value) {
    std::ranges::copy(std::as_bytes(std::span(value)), frame.data.begin() + static_cast<int>(from));
  }
  static can::Frame initiate(unsigned command, unsigned index, unsigned subindex) {
    return can::data_frame(kRequest, {command, index & 0xFF, index >> 8, subindex, 0, 0, 0, 0});
  }

  can::Frame exchange(const can::Frame& request) {
    bench_.receive(request);
    const std::vector<can::Frame> answers = bench_.take();
    if (answers.size() != 1 || answers[0].identifier != kResponse || answers[0].length != 8) {
      ADD_FAILURE() << "not one answer to " << to_text(request) << " but " << answers.size();
      abort_code = 1;
      return can::data_frame(kResponse, {0, 0, 0, 0, 0, 0, 0, 0});
    }
    abort_code = byte(answers[0], 0) == 0x80 ? base::load_le<std::uint32_t>(answers[0].data, 4) : 0;
    return answers[0];
  }

  NodeBench& bench_;
};

}  // namespace stator::canopen

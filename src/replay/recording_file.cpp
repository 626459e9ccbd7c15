#include "replay/recording_file.hpp"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <stdexcept>

#include "base/byte_order.hpp"
#include "base/crc32.hpp"

namespace stator::replay {

namespace {

/// How often the thread looks for chunks: they come some ten times a second.
constexpr std::chrono::milliseconds kPeriod{10};

}  // namespace

RecordingFile::RecordingFile(const std::string& path, const RecordingHeader& header)
    : file_(path), chunks_(kChunks) {
  bytes_ = kMagic.size();
  if (std::fwrite(kMagic.data(), 1, kMagic.size(), &file_.file()) != kMagic.size() ||
      !append(encode(header))) {
    throw std::runtime_error("cannot write recording \"" + path + "\": " + std::strerror(errno));
  }
  file_.give_name();
  for (Chunk& chunk : chunks_) {
    chunk.reserve(kMaximumChunk);
    empty_.push(&chunk);
  }
  thread_ = std::thread([this] { run(); });
}

RecordingFile::~RecordingFile() {
  finish();
}

RecordingFile::Chunk* RecordingFile::take_empty() {
  return good() ? empty_.take().value_or(nullptr) : nullptr;
}

void RecordingFile::write(Chunk& chunk) {
  full_.push(&chunk);  // there is room for all chunks there are
}

void RecordingFile::finish() {
  stopping_ = true;
  if (thread_.joinable()) {
    thread_.join();
  }
}

void RecordingFile::run() {
  while (true) {
    const bool last_look = stopping_;
    while (const auto chunk = full_.take()) {
      if (!failed_ && !append(**chunk)) {
        failed_ = true;
      }
      (*chunk)->clear();
      empty_.push(*chunk);
    }
    if (last_look) {
      return;
    }
    std::this_thread::sleep_for(kPeriod);
  }
}

bool RecordingFile::append(std::span<const std::byte> content) {
  std::array<std::byte, kChunkHead> head{};
  base::store_le(std::span<std::byte>(head), 0, static_cast<std::uint32_t>(content.size()));
  base::store_le(std::span<std::byte>(head), 4, base::crc32(content));
  const bool written =
      std::fwrite(head.data(), 1, head.size(), &file_.file()) == head.size() &&
      std::fwrite(content.data(), 1, content.size(), &file_.file()) == content.size() &&
      std::fflush(&file_.file()) == 0;
  bytes_ += written ? head.size() + content.size() : 0;
  return written;
}

}  // namespace stator::replay

#include "replay/recording_file.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "base/byte_order.hpp"
#include "base/crc32.hpp"

namespace stator::replay {

namespace {

[[noreturn]] void fail(const std::string& what, const std::string& path) {
  throw std::runtime_error("cannot " + what + " recording \"" + path +
                           "\": " + std::strerror(errno));
}

/// What stands before the content of a chunk.
std::array<std::byte, kChunkHead> head_of(std::span<const std::byte> content) {
  std::array<std::byte, kChunkHead> head{};
  base::store_le(std::span<std::byte>(head), 0, static_cast<std::uint32_t>(content.size()));
  base::store_le(std::span<std::byte>(head), 4, base::crc32(content));
  return head;
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path, const RecordingHeader& header)
    : file_(std::fopen(path.c_str(), "wb")) {
  if (file_ == nullptr) {
    fail("create", path);
  }
  const Chunk content = encode(header);
  const auto head = head_of(content);
  if (std::fwrite(kMagic.data(), 1, kMagic.size(), file_.get()) != kMagic.size() ||
      std::fwrite(head.data(), 1, head.size(), file_.get()) != head.size() ||
      std::fwrite(content.data(), 1, content.size(), file_.get()) != content.size() ||
      std::fflush(file_.get()) != 0) {
    fail("write", path);
  }
  head_ = kMagic.size() + head.size() + content.size();
  chunk_.reserve(kMaximumChunk);
  output_ = link::BackgroundOutput::onto(::fileno(file_.get()), path, kQueue);
}

RecordingFile::Chunk* RecordingFile::take_empty() {
  return good() ? &chunk_ : nullptr;
}

void RecordingFile::write(Chunk& chunk) {
  output_->write(head_of(chunk), chunk);
  chunk.clear();
}

void RecordingFile::finish(link::BackgroundOutput::Clock::time_point asked) {
  output_->finish(asked);
}

}  // namespace stator::replay

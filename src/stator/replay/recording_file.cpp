#include "stator/replay/recording_file.hpp"

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "stator/base/byte_order.hpp"
#include "stator/base/crc32.hpp"

namespace stator::replay {

namespace {

/// What stands before the content of a chunk.
std::array<std::byte, kChunkHead> head_of(std::span<const std::byte> content) {
  std::array<std::byte, kChunkHead> head{};
  base::store_le(std::span<std::byte>(head), 0, static_cast<std::uint32_t>(content.size()));
  base::store_le(std::span<std::byte>(head), 4, base::crc32(content));
  return head;
}

}  // namespace

RecordingFile::RecordingFile(const std::string& path, const RecordingHeader& header) : file_(path) {
  const Chunk content = encode(header);
  const auto head = head_of(content);
  std::FILE* const file = &file_.file();
  if (std::fwrite(kMagic.data(), 1, kMagic.size(), file) != kMagic.size() ||
      std::fwrite(head.data(), 1, head.size(), file) != head.size() ||
      std::fwrite(content.data(), 1, content.size(), file) != content.size() ||
      std::fflush(file) != 0) {
    throw std::runtime_error("cannot write recording \"" + path +
                             "\": " + std::generic_category().message(errno));
  }
  file_.give_name();
  head_ = kMagic.size() + head.size() + content.size();
  chunk_.reserve(kMaximumChunk);
  output_ = link::BackgroundOutput::onto(::fileno(file), path, kQueue);
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

#include "stator/rack/kept/kept_file_writer.hpp"

#include <stdexcept>
#include <utility>

namespace stator::rack {

namespace {

/// Larger ones (firmware) come as a whole new image; no copy of them is held for comparison.
constexpr std::size_t kLargestCompared = std::size_t{256} << 10;

}  // namespace

void KeptFileWriter::write(const KeptFile& content) {
  if (std::exchange(first_, false)) {
    known_ = look();
  }
  if (append(content)) {
    return;
  }
  // After a failed append the state of the file is unknown.
  known_.reset();
  const auto file = encode(content.kind, content.product, content.content);
  const auto stamp = directory_.replace(name_, file);
  if (content.content.size() <= kLargestCompared) {
    known_ = Known{content, {}, stamp};
    static_cast<void>(decode(file, known_->end));
  }
}

std::optional<KeptFileWriter::Known> KeptFileWriter::look() const {
  Known known;
  const auto stamp = directory_.stamp(name_);
  if (!stamp) {
    return std::nullopt;
  }
  known.stamp = *stamp;
  try {
    const auto file = directory_.read(name_, kLargestCompared + kLongestLog);
    if (!file) {
      return std::nullopt;
    }
    known.content = decode(*file, known.end);
  } catch (const std::runtime_error&) {
    return std::nullopt;  // it is replaced
  }
  return known;
}

bool KeptFileWriter::append(const KeptFile& content) {
  if (!known_ || known_->content.kind != content.kind ||
      known_->content.product != content.product || content.content.size() > kLargestCompared) {
    return false;
  }
  LogEnd end = known_->end;
  const auto record = encode_change(known_->content.content, content.content, end);
  if (end.log > kLongestLog) {
    return false;
  }
  Known known = *std::exchange(known_, std::nullopt);  // until it is known again
  const auto stamp = directory_.append(name_, known.stamp, known.end.length, record);
  if (!stamp) {
    return false;
  }
  known_ = Known{content, end, *stamp};
  return true;
}

}  // namespace stator::rack

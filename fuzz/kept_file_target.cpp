// The reader of kept files: any bytes, and a whole file with any bytes behind it. What it takes are
// words and contents within limits, and a change that is appended where it stopped is read.

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "input.hpp"
#include "stator/rack/kept/kept_file.hpp"

namespace {

using Bytes = std::vector<std::byte>;
using stator::fuzz::require;

void read(const Bytes& file) {
  using namespace stator::rack;
  LogEnd end;
  KeptFile kept;
  try {
    kept = decode(file, end);
  } catch (const std::runtime_error& error) {
    for (const char c : std::string_view(error.what())) {
      require(c >= ' ' && c <= '~');
    }
    return;
  }
  require(end.length <= file.size() && kept.content.size() <= file.size() + kLargestContent);
  Bytes whole(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(end.length));
  require(decode(whole).content == kept.content);
  Bytes after = kept.content;
  after.resize(after.size() / 2 + 3, std::byte{0x5A});
  const Bytes change = encode_change(kept.content, after, end);
  whole.insert(whole.end(), change.begin(), change.end());
  LogEnd again;
  require(decode(whole, again).content == after);
  require(again.length == end.length && again.check == end.check);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  read({bytes.begin(), bytes.end()});
  const Bytes before(size / 3, std::byte{1});
  Bytes file = stator::rack::encode("eeprom", "X", before);
  stator::rack::LogEnd end;
  static_cast<void>(stator::rack::decode(file, end));
  const Bytes change = stator::rack::encode_change(before, Bytes(size / 2), end);
  file.insert(file.end(), change.begin(), change.end());
  file.insert(file.end(), bytes.begin(), bytes.end());
  read(file);
  // The same as a fault of the disk: they overwrite what is there, from a place of their choice.
  if (size > 2) {
    const std::size_t place = (data[0] | std::size_t{data[1]} << 8) % file.size();
    std::copy_n(bytes.begin() + 2, std::min(size - 2, file.size() - place),
                file.begin() + static_cast<std::ptrdiff_t>(place));
    read(file);
  }
  return 0;
}

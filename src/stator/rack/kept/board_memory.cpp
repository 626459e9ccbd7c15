#include "stator/rack/kept/board_memory.hpp"

#include <fmt/format.h>

namespace stator::rack {

namespace {

/// The last point of a file's name before its kind stands between device and part.
std::string file_of(const std::string& device, const std::string& part) {
  std::string file = device + '.';
  for (const char c : part) {
    file += c == '.' ? std::string("%2E") : std::string(1, c);
  }
  return file;
}

}  // namespace

BoardMemory::BoardMemory(DeviceStorage& storage, const std::string& device,
                         const std::string& product, const board::KeptPart& part,
                         base::EventReporter reporter)
    : KeptMemory(storage, {"memory", device, product, file_of(device, part.name)}, reporter),
      part_(*part.content) {
  if (const auto kept = read()) {
    if (!part_.load(*kept)) {
      fail(fmt::format("it holds {} bytes, its part \"{}\" has {}", kept->size(), part.name,
                       part_.content().size()));
    }
    reporter.report({}, rules::kBoardMemoryRestored, {base::SharedText(path())});
  }
  part_.connect(this);
}

BoardMemory::~BoardMemory() {
  part_.connect(nullptr);
}

void BoardMemory::finish(std::uint32_t version, bool kept, base::SimTime /*now*/) {
  if (version == writes_) {
    part_.finish(kept);
  }
}

std::vector<std::byte> BoardMemory::content() const {
  const std::span<const std::byte> content = part_.content();
  return {content.begin(), content.end()};
}

}  // namespace stator::rack

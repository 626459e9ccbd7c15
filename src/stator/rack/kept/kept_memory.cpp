#include "stator/rack/kept/kept_memory.hpp"

#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "stator/rack/kept/device_storage.hpp"
#include "stator/rack/kept/kept_file.hpp"

namespace stator::rack {

KeptMemory::KeptMemory(DeviceStorage& storage, Identity identity, base::EventReporter reporter)
    : storage_(storage),
      identity_(std::move(identity)),
      reporter_(reporter),
      file_(fmt::format("{}.{}",
                        file_name_for(identity_.file.empty() ? identity_.name : identity_.file),
                        identity_.kind)),
      path_(storage.directory_.path_of(file_)) {}

void KeptMemory::fail(const std::string& reason) const {
  throw std::runtime_error(
      fmt::format("{}: device \"{}\" cannot start from this file: {}. Delete it to start without "
                  "it, or move it to {}.damaged to keep it aside; restore a copy, or name another "
                  "state directory",
                  path_, identity_.name, reason, path_));
}

std::optional<std::vector<std::byte>> KeptMemory::read() const {
  const auto bytes = storage_.directory_.read(file_);
  if (!bytes) {
    return std::nullopt;
  }
  KeptFile kept;
  try {
    kept = decode(*bytes);
  } catch (const std::runtime_error& error) {
    fail(error.what());
  }
  if (kept.kind != identity_.kind || kept.product != identity_.product) {
    fail(fmt::format("it belongs to the {} of a {}, the device is a {}", kept.kind, kept.product,
                     identity_.product));
  }
  return std::move(kept.content);
}

bool KeptMemory::order(std::span<const std::byte> content, std::uint32_t version) {
  ordered_ = version;
  const bool at_once = storage_.completions_ == DeviceStorage::Completions::at_once;
  if (at_once) {
    finished_ = version;
  } else {
    storage_.note_order();
  }
  write(content, version);
  return at_once;
}

void KeptMemory::write(std::span<const std::byte> content, std::uint32_t version) {
  storage_.writer_.write({file_,
                          {identity_.kind, identity_.product, {content.begin(), content.end()}},
                          number_,
                          version});
}

}  // namespace stator::rack

#include "stator/master/cia402/slave_drive_port.hpp"

#include <algorithm>
#include <array>

#include "stator/master/text.hpp"

namespace stator::master {

namespace {

const MappedEntry* find_entry(std::span<const MappedEntry> entries, ObjectAddress object) {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const MappedEntry& entry) {
    return entry.index == object.index && entry.subindex == object.subindex;
  });
  return found == entries.end() ? nullptr : &*found;
}

/// Whether an entry can be copied as bytes and has the size that the caller expects.
bool is_plain(const MappedEntry* entry, std::size_t size) {
  return entry != nullptr && entry->bit_offset % 8 == 0 && entry->bit_length == size * 8;
}

}  // namespace

std::string SlaveDrivePort::name() const {
  return "slave " + std::to_string(position_);
}

Result<std::uint64_t> SlaveDrivePort::read(ObjectAddress object, std::size_t size) {
  const MappedEntry* const entry = find_entry(master_.input_entries(position_), object);
  if (master_.operational() && is_plain(entry, size)) {
    return load_number(master_.inputs(position_).subspan(entry->bit_offset / 8, size));
  }
  const auto data = master_.upload(position_, object);
  if (!data) {
    return base::Unexpected{data.error()};
  }
  if (data->size() != size) {
    return fail(ErrorCode::protocol, to_text(object) + " of " + name() + " has " +
                                         std::to_string(data->size()) + " bytes, " +
                                         std::to_string(size) + " were expected");
  }
  return load_number(*data);
}

Result<void> SlaveDrivePort::write(ObjectAddress object, std::size_t size, std::uint64_t bits) {
  std::array<std::byte, sizeof bits> data{};
  const auto bytes = std::span(data).first(size);
  store_number(bytes, bits);
  const MappedEntry* const entry = find_entry(master_.output_entries(position_), object);
  if (master_.operational() && is_plain(entry, size)) {
    const auto image = master_.outputs(position_).subspan(entry->bit_offset / 8, size);
    std::copy(bytes.begin(), bytes.end(), image.begin());
    return {};
  }
  return master_.download(position_, object, bytes);
}

bool SlaveDrivePort::cyclic(ObjectAddress object) const {
  return master_.operational() && find_entry(master_.output_entries(position_), object) != nullptr;
}

}  // namespace stator::master

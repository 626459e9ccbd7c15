#include "stator/devices/generic/signals.hpp"

#include <string>

#include "stator/devices/generic/object_inputs.hpp"

namespace stator::devices::generic {

std::vector<product::Signal> device_signals(const dictionary::Dictionary& objects,
                                            const std::deque<Drive>& drives) {
  std::vector<product::Signal> all;
  const std::vector<std::string> names = object_names(objects);
  std::size_t i = 0;
  for (const dictionary::Entry& entry : objects.entries()) {
    const std::string& name = names[i++];
    if (entry.declaration().mapping != dictionary::PdoMapping::no &&
        !dictionary::is_string(entry.type())) {
      all.push_back({name, std::string(entry.declaration().unit),
                     base::SignalReader::bind<&dictionary::Entry::number>(entry)});
    }
  }
  for (const Drive& drive : drives) {
    drive.append_signals(all);
  }
  return all;
}

bool is_of_drive(const dictionary::Entry& entry, std::size_t drives) {
  constexpr std::size_t kFirst = 0x6000;
  return entry.index() >= kFirst && entry.index() < kFirst + index_offset(1) * drives;
}

}  // namespace stator::devices::generic

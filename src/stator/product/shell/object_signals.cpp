#include "stator/product/shell/object_signals.hpp"

#include <algorithm>
#include <string>

#include "stator/dictionary/data_type.hpp"

namespace stator::product {

namespace {

std::string signal_name(std::string name) {
  std::ranges::transform(name, name.begin(), [](char c) {
    const bool capital = c >= 'A' && c <= 'Z';
    return capital ? static_cast<char>(c - 'A' + 'a') : c == ' ' ? '_' : c;
  });
  return name;
}

}  // namespace

std::vector<Signal> object_signals(const dictionary::Dictionary& objects) {
  std::vector<Signal> signals;
  for (const dictionary::Entry& entry : objects.entries()) {
    if (entry.declaration().mapping != dictionary::PdoMapping::no &&
        !dictionary::is_string(entry.type())) {
      signals.push_back({signal_name(entry.name()), std::string(entry.declaration().unit),
                         base::SignalReader::bind<&dictionary::Entry::number>(entry)});
    }
  }
  return signals;
}

}  // namespace stator::product

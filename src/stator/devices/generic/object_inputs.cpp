#include "stator/devices/generic/object_inputs.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>

#include "stator/devices/generic/hexadecimal.hpp"

namespace stator::devices::generic {

namespace {

using dictionary::DataType;
using dictionary::Entry;

bool is_letter_or_digit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
}

std::string plain_name(const std::string& name) {
  std::string plain;
  for (char c : name) {
    const bool capital = c >= 'A' && c <= 'Z';
    c = capital ? static_cast<char>(c - 'A' + 'a') : c;
    if (is_letter_or_digit(c)) {
      plain += c;
    } else if (!plain.empty() && plain.back() != '_') {
      plain += '_';
    }
  }
  while (plain.ends_with('_')) {
    plain.pop_back();
  }
  return plain.empty() ? "object" : plain;
}

bool transmits(const Entry& entry) {
  const dictionary::PdoMapping mapping = entry.declaration().mapping;
  return mapping == dictionary::PdoMapping::transmit || mapping == dictionary::PdoMapping::both;
}

/// The values that a number of the type can have.
std::pair<double, double> limits_of(DataType type) {
  if (type == DataType::real32 || type == DataType::real64) {
    constexpr double kLargest = 1e30;
    return {-kLargest, kLargest};
  }
  const auto bits = static_cast<int>(dictionary::bit_length(type));
  if (dictionary::is_signed(type)) {
    return {-std::ldexp(1.0, bits - 1), std::ldexp(1.0, bits - 1) - 1.0};
  }
  return {0.0, std::ldexp(1.0, bits) - 1.0};
}

/// `value` as an entry of the type keeps it.
std::uint64_t bits_of(DataType type, double value) {
  if (type == DataType::real32) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(value));
  }
  if (type == DataType::real64) {
    return std::bit_cast<std::uint64_t>(value);
  }
  const double whole = std::floor(value + 0.5);
  if (dictionary::is_signed(type)) {
    constexpr double kBehind = 9223372036854775808.0;
    return whole >= kBehind ? static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())
                            : static_cast<std::uint64_t>(static_cast<std::int64_t>(whole));
  }
  constexpr double kBehind = 18446744073709551616.0;
  return whole >= kBehind ? ~std::uint64_t{0} : static_cast<std::uint64_t>(std::max(whole, 0.0));
}

}  // namespace

std::vector<std::string> object_names(const dictionary::Dictionary& objects) {
  std::vector<std::string> names;
  std::map<std::string, int> count;
  for (const Entry& entry : objects.entries()) {
    names.push_back(plain_name(entry.name()));
    // Others that nobody sees do not count.
    if (entry.declaration().mapping != dictionary::PdoMapping::no) {
      ++count[names.back()];
    }
  }
  std::size_t i = 0;
  for (const Entry& entry : objects.entries()) {
    if (count[names[i]] > 1) {
      names[i] += "_" + plain_name(hexadecimal(entry.index(), 4)) + "_" +
                  plain_name(hexadecimal(entry.subindex(), 2));
    }
    ++i;
  }
  return names;
}

void ObjectInputs::Value::set(double wanted) {
  value = wanted;
  was_set = true;
  show();
}

void ObjectInputs::Value::show() const {
  entry->set_value(bits_of(entry->type(), value));
}

void ObjectInputs::bind(dictionary::Dictionary& objects,
                        const std::function<bool(const Entry&)>& taken) {
  const std::vector<std::string> names = object_names(objects);
  std::size_t i = 0;
  for (const dictionary::Object& object : objects.objects()) {
    for (Entry& entry : objects.entries_of(object)) {
      const std::string& name = names[i++];
      if (transmits(entry) && !dictionary::is_string(entry.type()) && !taken(entry)) {
        values_.push_back({.entry = &entry, .name = name});
      }
    }
  }
}

void ObjectInputs::restore() {
  for (const Value& each : values_) {
    if (each.was_set) {
      each.show();
    }
  }
}

void ObjectInputs::append(std::vector<product::Input>& inputs) {
  for (Value& each : values_) {
    const auto [lowest, highest] = limits_of(each.entry->type());
    inputs.emplace_back(each.name, std::string(each.entry->declaration().unit), lowest, highest,
                        base::Delegate<void(double)>::bind<&Value::set>(each),
                        base::InputGroup::lines, each.entry->number());
  }
}

}  // namespace stator::devices::generic

#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"
#include "stator/master/sdo_types.hpp"
#include "stator/settings/key.hpp"

namespace stator::scenario {

/// A value as a scenario file has it for an object: a number, a text, or bytes as they are.
using ObjectValue = std::variant<double, std::string, std::vector<std::byte>>;

/// `value`, a number or a text, or `bytes`, hexadecimal such as "2B 01". Nothing: neither is there.
extern const settings::Section<std::optional<ObjectValue>> kObjectValueKeys;

/// The required key `object`, e.g. "6040:00". Nothing: it is missing or wrong, which has been
/// reported.
extern const settings::Section<std::optional<master::ObjectAddress>> kObjectKeys;
/// Ends reading of a step without an object.
template <typename T>
inline constexpr settings::Rule<T> kNeedsObject{
    .key = "object",
    .holds = [](const T& step) { return step.object.has_value(); },
    .sentence = "its row has told already what is wrong"};

/// The value as an SDO carries it to `entry`; null: the object is not in the device's dictionary,
/// and a number has four bytes. Else a sentence about what does not fit; the range is the device's
/// business.
[[nodiscard]] base::Expected<std::vector<std::byte>, std::string> to_bytes(
    const ObjectValue& value, const dictionary::Entry* entry);

/// The number that an SDO has brought from `entry`, or as an unsigned one if it is null; nothing
/// for texts.
[[nodiscard]] std::optional<double> to_number(std::span<const std::byte> data,
                                              const dictionary::Entry* entry);
/// For people: "1000", "\"TMCM-3315\"", "2B 01".
[[nodiscard]] std::string value_text(std::span<const std::byte> data,
                                     const dictionary::Entry* entry);

/// Bytes that a text like "2B 01 FF" means; nothing: it is none such.
[[nodiscard]] std::optional<std::vector<std::byte>> parse_bytes(std::string_view text);
/// "2B 01 FF".
[[nodiscard]] std::string bytes_text(std::span<const std::byte> data);

}  // namespace stator::scenario

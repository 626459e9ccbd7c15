#pragma once

#include <string_view>

namespace stator::base {

/// `name` fits `pattern` from end to end: * stands for any run of characters, ? for one, [abc] for
/// one of these, [a-c] for one of a range, [!abc] for one that is none of these. The one meaning of
/// patterns for names of signals, inputs, scenarios and TMCL symbols. Takes a time that grows with
/// the product of both lengths, whoever wrote the pattern (fnmatch(3) may take for ever).
[[nodiscard]] bool matches(std::string_view pattern, std::string_view name);
/// The same without regard to upper and lower case of ASCII letters.
[[nodiscard]] bool matches_in_any_case(std::string_view pattern, std::string_view name);

}  // namespace stator::base

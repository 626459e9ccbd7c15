#pragma once

#include <string>
#include <string_view>

#include "stator/dictionary/refusal.hpp"
#include "stator/web/message.hpp"

namespace stator::web {

/// The standard's words for an HTTP status, e.g. "Not Found" (RFC 9110 §15).
[[nodiscard]] std::string_view reason(unsigned status);

/// An error as problem details (RFC 9457): the type is "about:blank", so the title is that of the
/// status; `detail` is one sentence with rule, what came and the remedy.
[[nodiscard]] Response problem(unsigned status, std::string_view detail);

/// What a device refused, with SDO abort code, the standard's text for it and the device's sentence
/// as additional members.
[[nodiscard]] Response problem(const dictionary::Refusal& refusal);

}  // namespace stator::web

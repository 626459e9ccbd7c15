#pragma once

#include <cstddef>
#include <span>

#include "stator/dictionary/dictionary.hpp"
#include "stator/web/stream/decoded_frame.hpp"

namespace stator::web {

/// Adds what an SDO says to `decoded`: the eight bytes of CANopen (CiA 301 §7.2.4.3), or a service
/// of CoE behind the CoE header (ETG.1000.6 §5.6.2), which may be longer. `request`: from the
/// client. `objects` may be null. Returns the words for the summary.
[[nodiscard]] std::string describe_sdo(std::span<const std::byte> bytes, bool request,
                                       const dictionary::Dictionary* objects,
                                       DecodedFrame& decoded);

}  // namespace stator::web

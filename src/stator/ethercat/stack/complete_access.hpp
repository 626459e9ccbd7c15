#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "stator/base/expected.hpp"
#include "stator/dictionary/dictionary.hpp"

namespace stator::ethercat {

// Complete access (ETG.1000.6 §5.6.2, SDO services with the complete-access bit): all entries of an
// array or record in one transfer. Subindex 0 takes 16 bits; entries follow one another, those of
// whole bytes at byte borders, single bits packed; subindices that the object does not have take no
// room.

/// First subindex of the transfer as the request says: 0, or 1 to leave subindex 0 out.
enum class CompleteAccessStart : std::uint8_t { with_count = 0, entries_only = 1 };

/// Reads as many entries as subindex 0 says into `out`, write-only ones as zero; returns the
/// length.
[[nodiscard]] base::Expected<std::size_t, dictionary::Refusal> read_complete(
    const dictionary::Dictionary& dictionary, const dictionary::Object& object,
    CompleteAccessStart start, std::span<std::byte> out);

/// Writes entries from `data` in order, leaving out read-only ones. Data may end before the last
/// entry, at the border of two. Mapping and assignment objects are deactivated first and activated
/// last, so that one transfer can replace them; they stay deactivated if an entry is refused.
[[nodiscard]] dictionary::Verdict write_complete(dictionary::Dictionary& dictionary,
                                                 const dictionary::Object& object,
                                                 CompleteAccessStart start,
                                                 std::span<const std::byte> data,
                                                 const dictionary::AccessContext& context);

}  // namespace stator::ethercat

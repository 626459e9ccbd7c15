#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "stator/replay/byte_coding.hpp"

namespace stator::replay {

/// Writes `bytes` as what distinguishes them from `known`: cyclic frames hardly differ from the one
/// before, an answer hardly from its request.
void write_delta(ByteWriter& writer, std::span<const std::byte> known,
                 std::span<const std::byte> bytes);

/// Makes out of `known` what was written; `bytes` gets it. False, and the reader is no longer good:
/// there is nothing sensible to read, or it is longer than `limit`.
bool read_delta(ByteReader& reader, std::span<const std::byte> known, std::size_t limit,
                std::vector<std::byte>& bytes);

}  // namespace stator::replay

#pragma once

#include <string>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// Listens at a UNIX stream socket. One left behind by a program that is gone is replaced; any
/// other file at `path` stays. The error says what is in the way. Who owns the socket removes it in
/// the end.
[[nodiscard]] base::Expected<FileDescriptor, LinkError> listen_at_path(const std::string& path);

}  // namespace stator::link

#pragma once

#include <cstdint>
#include <string>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"
#include "stator/link/system/file_descriptor.hpp"

namespace stator::link {

/// Where this machine listens when nothing is said: programs on it can connect, others cannot.
inline constexpr const char* kLoopbackAddress = "127.0.0.1";

/// Listens for TCP connections at `port` of `address`, an IPv4 address in numbers. Port 0 becomes
/// the one the system chose. The error says what is in the way; `wanted` names the link in it.
[[nodiscard]] base::Expected<FileDescriptor, LinkError> listen_at(const std::string& address,
                                                                  std::uint16_t& port,
                                                                  const std::string& wanted);

/// Takes the next waiting connection, set up for short messages that are answered at once; closed
/// if there is none.
[[nodiscard]] FileDescriptor accept_connection(const FileDescriptor& listener);

}  // namespace stator::link

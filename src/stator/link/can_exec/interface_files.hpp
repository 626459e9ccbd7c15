#pragma once

#include <string>

// Files of Linux that show interfaces: /proc/net/dev and /sys/class/net.
namespace stator::link::can_exec {

/// Where the file is that the program shall find as `path`: itself, or in a folder of this library,
/// written anew just now. `buffer` keeps the name. Leaves errno alone.
[[nodiscard]] const char* interface_file(const char* path, std::string& buffer);

}  // namespace stator::link::can_exec

#pragma once

#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

#include "stator/base/expected.hpp"
#include "stator/link/system/error.hpp"

// How the links of this room word what went wrong.
namespace stator::link {

inline base::Unexpected<LinkError> fail(LinkErrorCode code, std::string text) {
  return base::Unexpected{LinkError{code, std::move(text)}};
}

/// `error` is an errno.
inline base::Unexpected<LinkError> system_failure(const std::string& what, int error) {
  return fail(LinkErrorCode::system, what + ": " + std::generic_category().message(error));
}

inline std::string in_quotes(const std::string& name) {
  return "\"" + name + "\"";
}

/// What a program that may do everything needs: setcap leaves it no others than those it names.
inline constexpr const char* kAllPrivileges = "cap_net_raw,cap_net_admin,cap_sys_nice,cap_ipc_lock";

/// The command that gives this program the privileges its links need without being root.
inline std::string setcap_command(const std::string& privileges = "cap_net_raw,cap_net_admin") {
  std::error_code ignored;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", ignored);
  return "sudo setcap " + privileges + "+ep " + program.string();
}

}  // namespace stator::link

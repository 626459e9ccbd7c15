#pragma once

#include <span>
#include <string_view>

#include "stator/web/message.hpp"

namespace stator::web {

/// A file of the dashboard, built into the program. Which there are, cmake/embed_assets.cmake
/// writes;
/// "/index.html" is always among them.
struct Asset {
  std::string_view path;  ///< as a browser asks for it, e.g. "/assets/index-4f2a.js"
  std::string_view hash;  ///< of the content, hexadecimal
  std::span<const unsigned char> content;
};

[[nodiscard]] std::span<const Asset> assets();

/// The answer to a request for the file at `path`; "/" is "/index.html". 304 if the client has it,
/// 404 if there is none.
[[nodiscard]] Response answer_asset(const Request& request, std::string_view path);

}  // namespace stator::web

#pragma once

#include <span>
#include <string_view>

#include "stator/web/message.hpp"

namespace stator::web {

/// A file of the dashboard, built into the program. Which there are, cmake/embed_assets.cmake
/// writes;
/// "/index.html" is always among them. Both forms are there, since a client may take only the
/// first, and the server inflates nothing.
struct Asset {
  std::string_view path;  ///< as a browser asks for it, e.g. "/assets/index-4f2a.js"
  std::string_view hash;  ///< of the content, hexadecimal
  std::span<const unsigned char> content;
  std::span<const unsigned char> compressed;  ///< by gzip; empty: that is not shorter
};

[[nodiscard]] std::span<const Asset> assets();

/// Whether a client that sends this Accept-Encoding takes gzip (RFC 9110 §12.5.3).
[[nodiscard]] bool takes_gzip(std::string_view accept_encoding);

/// The answer to a request for the file at `path`; "/" is "/index.html". Compressed where the
/// client takes that; 304 if it has it, 404 if there is none.
[[nodiscard]] Response answer_asset(const Request& request, std::string_view path);

}  // namespace stator::web

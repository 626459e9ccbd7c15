#include "stator/web/api/assets.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "stator/base/trimmed.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Pair = std::pair<std::string_view, std::string_view>;

constexpr auto kContentTypes = std::to_array<Pair>({
    {".html", "text/html; charset=utf-8"},
    {".js", "text/javascript; charset=utf-8"},
    {".css", "text/css; charset=utf-8"},
    {".svg", "image/svg+xml"},
    {".png", "image/png"},
    {".woff2", "font/woff2"},
});

/// A page loads what this server has and nothing else, runs no code but files of its own, and is
/// shown in no other page.
constexpr std::string_view kPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string_view content_type(std::string_view path) {
  for (const auto& [ending, type] : kContentTypes) {
    if (path.ends_with(ending)) {
      return type;
    }
  }
  return "application/octet-stream";
}

/// Names below /assets/ contain a hash of the content, so what a browser has of them stays right.
std::string_view cache_control(std::string_view path) {
  return path.starts_with("/assets/") ? "public, max-age=31536000, immutable" : "no-cache";
}

/// The text before `separator`, or all, without spaces around it; `text` is what comes behind.
std::string_view next_part(std::string_view& text, char separator) {
  const std::size_t end = std::min(text.find(separator), text.size());
  const std::string_view part = base::trimmed(text.substr(0, end), " \t");
  text.remove_prefix(std::min(end + 1, text.size()));
  return part;
}

bool equal(std::string_view text, std::string_view lower_case) {
  return std::ranges::equal(text, lower_case, [](char one, char other) {
    return (one >= 'A' && one <= 'Z' ? static_cast<char>(one - 'A' + 'a') : one) == other;
  });
}

/// A weight of 0 ("q=0", "q=0.000") excludes the encoding.
bool refuses(std::string_view parameters) {
  while (!parameters.empty()) {
    std::string_view parameter = next_part(parameters, ';');
    if (equal(next_part(parameter, '='), "q")) {
      return parameter.find_first_not_of("0. \t") == std::string_view::npos;
    }
  }
  return false;
}

}  // namespace

bool takes_gzip(std::string_view accept_encoding) {
  bool any = false;
  while (!accept_encoding.empty()) {
    std::string_view parameters = next_part(accept_encoding, ',');
    const std::string_view coding = next_part(parameters, ';');
    if (equal(coding, "gzip") || equal(coding, "x-gzip")) {
      return !refuses(parameters);
    }
    any = any || (coding == "*" && !refuses(parameters));
  }
  return any;
}

Response answer_asset(const Request& request, std::string_view path) {
  const auto all = assets();
  const auto found = std::ranges::find(all, path == "/" ? "/index.html" : path, &Asset::path);
  if (found == all.end()) {
    return problem(
        404, "the dashboard has no such file; reload the page, it may be of an older program");
  }
  const bool compressed =
      !found->compressed.empty() && takes_gzip(request.accept_encoding.value_or(""));
  // The plain and the compressed form are two representations, each with an entity tag of its own
  // (RFC 9110 §8.8.3.3).
  const std::string tag = fmt::format("\"{}{}\"", found->hash, compressed ? "-gzip" : "");
  Response response;
  response.content_type = content_type(found->path);
  response.headers = {{"ETag", tag},
                      {"Cache-Control", std::string(cache_control(found->path))},
                      {"Vary", "Accept-Encoding"},
                      {"Content-Security-Policy", std::string(kPolicy)},
                      {"Referrer-Policy", "no-referrer"}};
  if (request.if_none_match && request.if_none_match->find(tag) != std::string::npos) {
    response.status = 304;
    return response;
  }
  const auto content = compressed ? found->compressed : found->content;
  response.body.assign(content.begin(), content.end());
  if (compressed) {
    response.headers.emplace_back("Content-Encoding", "gzip");
  }
  return response;
}

}  // namespace stator::web

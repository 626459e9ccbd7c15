#include "stator/web/api/assets.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

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

}  // namespace

Response answer_asset(const Request& request, std::string_view path) {
  const auto all = assets();
  const auto found = std::ranges::find(all, path == "/" ? "/index.html" : path, &Asset::path);
  if (found == all.end()) {
    return problem(
        404, "the dashboard has no such file; reload the page, it may be of an older program");
  }
  const std::string tag = '"' + std::string(found->hash) + '"';
  Response response;
  response.content_type = content_type(found->path);
  response.headers = {{"ETag", tag},
                      {"Cache-Control", std::string(cache_control(found->path))},
                      {"Content-Security-Policy", std::string(kPolicy)},
                      {"Referrer-Policy", "no-referrer"}};
  if (request.if_none_match && request.if_none_match->find(tag) != std::string::npos) {
    response.status = 304;
    return response;
  }
  response.body.assign(found->content.begin(), found->content.end());
  return response;
}

}  // namespace stator::web

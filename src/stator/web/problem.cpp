#include "stator/web/problem.hpp"

#include <cstdint>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/web/json_text.hpp"

namespace stator::web {

namespace {

using dictionary::AbortCode;

nlohmann::ordered_json details(unsigned status, std::string_view detail) {
  return {{"type", "about:blank"},
          {"title", std::string(reason(status))},
          {"status", status},
          {"detail", std::string(detail)}};
}

Response response(unsigned status, const nlohmann::ordered_json& details) {
  return {.status = status, .content_type = "application/problem+json", .body = text_of(details)};
}

unsigned status_of(AbortCode code) {
  switch (code) {
    case AbortCode::object_does_not_exist:
    case AbortCode::subindex_does_not_exist:
      return 404;
    case AbortCode::read_only:
    case AbortCode::write_only:
    case AbortCode::unsupported_access:
      return 403;
    case AbortCode::device_state:
    case AbortCode::local_control:
      return 409;
    default:
      return 422;
  }
}

}  // namespace

std::string_view reason(unsigned status) {
  switch (status) {
    case 101:
      return "Switching Protocols";
    case 200:
      return "OK";
    case 201:
      return "Created";
    case 204:
      return "No Content";
    case 304:
      return "Not Modified";
    case 400:
      return "Bad Request";
    case 401:
      return "Unauthorized";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 408:
      return "Request Timeout";
    case 409:
      return "Conflict";
    case 413:
      return "Content Too Large";
    case 415:
      return "Unsupported Media Type";
    case 421:
      return "Misdirected Request";
    case 422:
      return "Unprocessable Content";
    case 426:
      return "Upgrade Required";
    case 431:
      return "Request Header Fields Too Large";
    case 500:
      return "Internal Server Error";
    case 503:
      return "Service Unavailable";
    default:
      return "Unknown";
  }
}

Response problem(unsigned status, std::string_view detail) {
  return response(status, details(status, detail));
}

Response problem(const dictionary::Refusal& refusal) {
  const unsigned status = status_of(refusal.code);
  const std::string text(to_text(refusal.code));
  const std::string sentence =
      refusal.rule == nullptr ? text : base::to_sentence({{}, refusal.rule, 0, refusal.arguments});
  nlohmann::ordered_json body = details(status, sentence);
  body["abort_code"] = fmt::format("0x{:08X}", static_cast<std::uint32_t>(refusal.code));
  body["abort_text"] = text;
  return response(status, body);
}

}  // namespace stator::web

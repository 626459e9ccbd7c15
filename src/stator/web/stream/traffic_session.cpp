#include "stator/web/stream/traffic_session.hpp"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/web/json_text.hpp"
#include "stator/web/problem.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestFilter = 200;
constexpr std::size_t kFramesPerMessage = 50;
constexpr std::string_view kForm =
    R"(write e.g. {"networks": ["segment 0"], "filter": "statusword", "frames": true}; no networks )"
    R"(are all, "frames": false is a pause)";

}  // namespace

void TrafficSession::take(std::string_view message) {
  const Json wanted = Json::parse(message, nullptr, false);
  if (!wanted.is_object() || !wanted.value("networks", Json::array()).is_array() ||
      !wanted.value("filter", Json("")).is_string() ||
      !wanted.value("frames", Json(true)).is_boolean()) {
    push_problem(kForm);
    return;
  }
  const std::vector<std::string>& names = hub_.networks();
  const Json networks = wanted.value("networks", Json::array());
  std::vector<bool> chosen(names.size(), networks.empty());
  for (const Json& network : networks) {
    const auto found = network.is_string()
                           ? std::ranges::find(names, network.get_ref<const std::string&>())
                           : names.end();
    if (found == names.end()) {
      push_problem(R"(the rack has no such network; "networks" in /api/v1/rack lists all)");
      return;
    }
    chosen[static_cast<std::size_t>(found - names.begin())] = true;
  }
  filter_ = wanted.value("filter", std::string()).substr(0, kLongestFilter);
  std::ranges::transform(filter_, filter_.begin(), [](char letter) {
    return letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
  });
  networks_ = std::move(chosen);
  const bool watch = wanted.value("frames", true);
  if (watch != std::exchange(watching_, watch)) {
    watch ? hub_.add(*this) : hub_.remove(*this);
  }
  Json shown = Json::array();
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (networks_[i] && !names[i].empty()) {
      shown.push_back(names[i]);
    }
  }
  queue_.push({text_of(
      {{"type", "subscribed"}, {"networks", shown}, {"filter", filter_}, {"frames", watch}})});
}

void TrafficSession::show(const std::vector<TrafficFrame>& frames, std::uint64_t lost) {
  dropped_ += lost;
  std::string text;
  std::size_t rows = 0;
  const auto flush = [&] {
    if (rows != 0) {
      dropped_ += queue_.push({fmt::format(R"({{"type":"frames","dropped":{},"frames":[{}]}})",
                                           dropped_, std::exchange(text, {})),
                               std::exchange(rows, 0)});
    }
  };
  for (const TrafficFrame& frame : frames) {
    if (networks_[frame.network] &&
        (filter_.empty() || frame.words.find(filter_) != std::string::npos)) {
      text += text.empty() ? "" : ",";
      text += frame.json;
      if (++rows == kFramesPerMessage) {
        flush();
      }
    }
  }
  flush();
  tell();
}

void TrafficSession::push_problem(std::string_view detail) {
  queue_.push({fmt::format(R"({{"type":"problem","problem":{}}})", problem(400, detail).body)});
}

}  // namespace stator::web

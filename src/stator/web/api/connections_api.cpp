#include "stator/web/api/connections_api.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "stator/rack/run/connections.hpp"
#include "stator/web/json_text.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

Json link_json(std::string_view network, std::string_view link,
               const rack::Connections& connections) {
  Json programs = Json::array();
  for (const rack::Connection& each : connections.programs) {
    programs.push_back({{"program", each.program},
                        {"lines", each.lines},
                        {"explanation", each.explanation},
                        {"guide", each.guide}});
  }
  return {{"network", network},
          {"link", link},
          {"where", connections.where},
          {"programs", std::move(programs)}};
}

}  // namespace

Response describe_connections(const State& state) {
  const rack::RackConfiguration& configuration = state.configuration();
  const rack::Runner& runner = state.runner();
  Json links = Json::array();
  for (std::size_t i = 0; i < configuration.segments.size(); ++i) {
    const rack::SegmentConfiguration& segment = configuration.segments[i];
    if (!segment.link.in_process()) {
      links.push_back(link_json("segment " + std::to_string(i), to_text(segment.link),
                                rack::connections_of(segment)));
    }
  }
  for (std::size_t i = 0; i < configuration.buses.size(); ++i) {
    const rack::BusConfiguration& bus = configuration.buses[i];
    for (std::size_t port = 0; bus.wire && port < runner.bus(i).ports(); ++port) {
      const std::string& name = runner.bus(i).port(port).name();
      links.push_back(link_json(bus.name, name, rack::connections_of(bus, name)));
    }
  }
  for (std::size_t i = 0; i < state.lines().size(); ++i) {
    const std::string& opened = runner.line(i).link().name();
    links.push_back(link_json(state.lines()[i].link, opened,
                              rack::connections_of(configuration, state.lines()[i], opened)));
  }
  return json_response({{"links", std::move(links)}});
}

}  // namespace stator::web

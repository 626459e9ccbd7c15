#include <cmath>
#include <iterator>
#include <string>

#include <fmt/format.h>

#include "stator/base/severity_text.hpp"
#include "stator/web/api/snapshot.hpp"

namespace stator::web {

namespace {

/// OpenMetrics 1.0, "Escaping": backslash, quotation mark and line feed.
std::string escaped(std::string_view text) {
  std::string result;
  for (const char letter : text) {
    if (letter == '\\' || letter == '"') {
      result += '\\';
      result += letter;
    } else if (letter == '\n') {
      result += "\\n";
    } else {
      result += letter;
    }
  }
  return result;
}

std::string number(double value) {
  if (std::isnan(value)) {
    return "NaN";
  }
  if (std::isinf(value)) {
    return value > 0 ? "+Inf" : "-Inf";
  }
  return fmt::format("{}", value);
}

class Text {
 public:
  void family(std::string_view name, std::string_view type, std::string_view help,
              std::string_view unit = {}) {
    name_ = name;
    suffix_ = type == "counter" ? "_total" : "";
    fmt::format_to(out(), "# TYPE {} {}\n", name, type);
    if (!unit.empty()) {
      fmt::format_to(out(), "# UNIT {} {}\n", name, unit);
    }
    fmt::format_to(out(), "# HELP {} {}\n", name, help);
  }
  template <typename Value>
  void sample(std::string_view labels, Value value) {
    fmt::format_to(out(), "{}{}{}{}{} {}\n", name_, suffix_, labels.empty() ? "" : "{", labels,
                   labels.empty() ? "" : "}", value);
  }
  [[nodiscard]] std::string finish() && {
    text_ += "# EOF\n";
    return std::move(text_);
  }

 private:
  std::back_insert_iterator<std::string> out() { return std::back_inserter(text_); }

  std::string text_;
  std::string_view name_;
  std::string_view suffix_;
};

void add_networks(Text& text, const Snapshot& snapshot) {
  const auto labels = [](const NetworkRecord& network) {
    return fmt::format(R"(network="{}",kind="{}")", escaped(network.name), network.kind);
  };
  text.family("stator_network_received", "counter",
              "Frames of masters and programs that came; bytes on serial lines.");
  for (const NetworkRecord& network : snapshot.networks) {
    text.sample(labels(network), network.frames);
  }
  text.family("stator_network_overruns", "counter",
              "Times the rack lagged behind the clock by more than 20 ms.");
  for (const NetworkRecord& network : snapshot.networks) {
    text.sample(labels(network), network.overruns);
  }
  text.family("stator_network_worst_lag_seconds", "gauge",
              "Longest time by which the rack lagged behind the clock.", "seconds");
  for (const NetworkRecord& network : snapshot.networks) {
    text.sample(labels(network), number(static_cast<double>(network.worst_lag_ns) * 1e-9));
  }
}

void add_server(Text& text, const ServerCounters& counters) {
  text.family("stator_http_answers", "counter", "Answers of the web server by status.");
  for (const auto& [status, count] : counters.answers) {
    text.sample(fmt::format("status=\"{}\"", status), count);
  }
  text.family("stator_http_connections", "gauge", "Connections that are open.");
  text.sample("", counters.connections);
  text.family("stator_http_connections_refused", "counter",
              "Connections refused because too many were at work.");
  text.sample("", counters.connections_refused);
  text.family("stator_http_connections_displaced", "counter",
              "Idle connections that were ended to make room for others.");
  text.sample("", counters.connections_displaced);
  text.family("stator_stream_clients", "gauge", "WebSockets that are open.");
  text.sample("", counters.streams);
  text.family("stator_stream_rows_sent", "counter", "Rows of samples sent to WebSockets.");
  text.sample("", counters.stream_rows_sent);
  text.family("stator_stream_rows_dropped", "counter",
              "Rows of samples dropped because their client was too slow.");
  text.sample("", counters.stream_rows_dropped);
}

}  // namespace

std::string openmetrics(const State& state, const Snapshot& snapshot) {
  Text text;
  text.family("stator_simulated_time_seconds", "gauge", "Simulated time since power-on.",
              "seconds");
  text.sample("", number(snapshot.time.seconds()));
  text.family("stator_lost_time_seconds", "counter",
              "Time the machine was too slow for, by which simulated time has been set back.",
              "seconds");
  text.sample("", number(snapshot.lost.seconds()));
  add_networks(text, snapshot);
  text.family("stator_device_powered", "gauge", "1: the device's supply is on.");
  for (std::size_t i = 0; i < state.devices().size(); ++i) {
    const DeviceRecord& device = state.devices()[i];
    text.sample(
        fmt::format(R"(device="{}",product="{}")", escaped(device.name), escaped(device.product)),
        snapshot.devices[i].powered ? 1 : 0);
  }
  text.family("stator_events", "counter", "Events of the rack by severity.");
  for (const base::Severity severity : {base::Severity::information, base::Severity::refusal,
                                        base::Severity::warning, base::Severity::fault}) {
    text.sample(fmt::format("severity=\"{}\"", to_text(severity)), state.event_count(severity));
  }
  text.family("stator_signal", "gauge", "Present value of a signal in its unit.");
  for (std::size_t i = 0; i < state.signals().size(); ++i) {
    const product::Signal& signal = state.signals()[i];
    text.sample(fmt::format(R"(signal="{}",unit="{}")", escaped(signal.name), escaped(signal.unit)),
                number(snapshot.signals[i]));
  }
  add_server(text, state.counters);
  return std::move(text).finish();
}

}  // namespace stator::web

#include "stator/cli/client/top_screen.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace stator::cli {

namespace {

using enum TextStyle;

/// Continuation bytes of UTF-8 take no room.
bool is_continuation(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U;
}

/// `text` in `width` columns; what a terminal would obey is replaced.
std::string cut(const std::string& text, std::size_t width) {
  std::string shown;
  std::size_t used = 0;
  for (const char byte : text) {
    if (!is_continuation(byte) && ++used > width) {
      break;
    }
    const auto code = static_cast<unsigned char>(byte);
    shown += code < 0x20U || code == 0x7FU ? '?' : byte;
  }
  return shown;
}

std::size_t width_of(const std::string& text) {
  return static_cast<std::size_t>(
      std::ranges::count_if(text, [](char byte) { return !is_continuation(byte); }));
}

/// A table whose columns are as wide as their widest cell.
class Table {
 public:
  explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}

  void add(std::vector<std::string> row, TextStyle style = plain) {
    rows_.push_back({std::move(row), style});
  }
  /// Header, the rows that contain `filter`, and an empty line; nothing without rows.
  void append_to(std::vector<StyledLine>& lines, const std::string& filter) const {
    if (rows_.empty()) {
      return;
    }
    lines.push_back({text_of(header_), bold});
    for (const Row& row : rows_) {
      std::string text = text_of(row.cells);
      if (text.find(filter) != std::string::npos) {
        lines.push_back({std::move(text), row.style});
      }
    }
    lines.push_back({});
  }

 private:
  struct Row {
    std::vector<std::string> cells;
    TextStyle style;
  };

  [[nodiscard]] std::size_t width(std::size_t column) const {
    std::size_t widest = width_of(header_[column]);
    for (const Row& row : rows_) {
      widest = std::max(widest, width_of(row.cells[column]));
    }
    return widest;
  }
  /// A header that begins with a blank stands over numbers, which end in one column.
  [[nodiscard]] std::string text_of(const std::vector<std::string>& cells) const {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::string room(width(i) - width_of(cells[i]), ' ');
      const bool number = header_[i].starts_with(' ');
      text += number ? room + cells[i] : cells[i] + room;
      text += "  ";
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
  }

  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

/// Five digits say enough in an overview.
std::string number(double value) {
  if (std::abs(value) < 1e-9) {
    return "0";
  }
  return std::abs(value) >= 1e5 ? fmt::format("{:.0f}", value) : fmt::format("{:.5g}", value);
}

std::string cell(const std::optional<RackOverview::Value>& value) {
  if (!value) {
    return "-";
  }
  return value->unit.empty() ? number(value->value)
                             : fmt::format("{} {}", number(value->value), value->unit);
}

std::string lag(std::int64_t nanoseconds) {
  return nanoseconds >= 1'000'000
             ? fmt::format("{:.1f} ms", static_cast<double>(nanoseconds) * 1e-6)
             : fmt::format("{:.0f} us", static_cast<double>(nanoseconds) * 1e-3);
}

TextStyle style_of_state(const std::string& state) {
  if (state.starts_with("Fault")) {
    return red;
  }
  if (state == "off") {
    return dim;
  }
  return state == "operational" || state == "Operation enabled" ? green : plain;
}

TextStyle style_of_severity(const std::string& severity) {
  if (severity == "fault") {
    return red;
  }
  return severity == "warning" || severity == "refusal" ? yellow : plain;
}

Table networks_of(const RackOverview& overview) {
  Table networks({"NETWORK", "KIND", " RATE", " RECEIVED", " OVERRUNS", " WORST LAG"});
  for (const RackOverview::Network& network : overview.networks) {
    networks.add(
        {network.name, network.kind, network.rate ? fmt::format("{:.0f} /s", *network.rate) : "-",
         fmt::format("{}", network.received), fmt::format("{}", network.overruns),
         lag(network.worst_lag_ns)},
        network.overruns != 0 ? yellow : plain);
  }
  return networks;
}

Table devices_of(const RackOverview& overview) {
  Table devices({"DEVICE", "PRODUCT", "NETWORK", "STATE"});
  for (const RackOverview::Device& device : overview.devices) {
    devices.add({device.name, device.product, device.network, device.state},
                style_of_state(device.state));
  }
  return devices;
}

Table axes_table_of(const RackOverview& overview) {
  Table axes({"AXIS", "STATE", " POSITION", " VELOCITY", " CURRENT", " LOAD", " TEMPERATURE"});
  for (const RackOverview::Axis& axis : overview.axes) {
    axes.add({axis.name, axis.state.empty() ? "-" : axis.state, cell(axis.position),
              cell(axis.velocity), cell(axis.current), cell(axis.load), cell(axis.temperature)},
             style_of_state(axis.state));
  }
  return axes;
}

/// How the tables stand: from the networks to what moves, or, where they have no room, what moves
/// first.
enum class Order : std::uint8_t { networks_first, axes_first };

std::vector<StyledLine> tables(const RackOverview& overview, const std::string& filter,
                               Order order = Order::networks_first) {
  std::vector<StyledLine> lines;
  std::array all{networks_of(overview), devices_of(overview), axes_table_of(overview)};
  if (order == Order::axes_first) {
    std::ranges::reverse(all);
  }
  for (const Table& table : all) {
    table.append_to(lines, filter);
  }
  return lines;
}

/// Newest first.
std::vector<StyledLine> event_lines(const RackOverview& overview, const std::string& filter) {
  std::vector<StyledLine> lines{{"NEWEST EVENTS", bold}};
  const auto add = [&](const RackOverview::Event& event) {
    std::string text = fmt::format("{:>12.6f} s  {}: {}", static_cast<double>(event.time_ns) * 1e-9,
                                   event.device, event.text);
    if (text.find(filter) != std::string::npos) {
      lines.push_back({std::move(text), style_of_severity(event.severity)});
    }
  };
  std::for_each(overview.events.rbegin(), overview.events.rend(), add);
  return lines;
}

std::string title(const RackOverview& overview, const TopView& view) {
  std::string text = fmt::format(
      "stator top  {}  {} clock  {:.3f} s  {} {}, {} signals", overview.url, overview.clock,
      static_cast<double>(overview.time_ns) * 1e-9, overview.devices.size(),
      overview.devices.size() == 1 ? "device" : "devices", overview.signals);
  if (view.paused) {
    text += "  PAUSED";
  }
  return text;
}

std::string help(const TopView& view) {
  if (view.typing) {
    return fmt::format("filter: {}_   Enter: keep it, Esc: none", view.filter);
  }
  return fmt::format("q quit  p pause  arrows scroll  / filter{}  ? help",
                     view.filter.empty() ? "" : fmt::format(" ({})", view.filter));
}

/// What ? shows.
const std::array<StyledLine, 10> kHelp{{
    {"KEYS", bold},
    {"q, Ctrl-C          end"},
    {"p                  stop and go on; the rack runs on meanwhile"},
    {"arrows, j, k       scroll the tables by a row"},
    {"page keys          by half a screen"},
    {"Home, End          to the first and the last row"},
    {"/                  only rows that contain what is typed"},
    {"Enter, Esc         keep that filter, show all again"},
    {"?                  these keys"},
    {},
}};

/// Fewer than these would not tell much.
constexpr std::size_t kFewestEvents = 5;

}  // namespace

std::size_t top_table_lines(const RackOverview& overview, const TopView& view) {
  return tables(overview, view.filter).size();
}

std::vector<StyledLine> top_frame(const RackOverview& overview, const TopView& view) {
  std::vector<StyledLine> events = event_lines(overview, view.filter);
  std::vector<StyledLine> lines{{title(overview, view), bold}, {}};
  if (view.rows == 0) {
    const std::vector<StyledLine> body = tables(overview, view.filter);
    lines.insert(lines.end(), body.begin(), body.end());
    lines.insert(lines.end(), events.begin(), events.end());
  } else if (view.help) {
    lines.insert(lines.end(), kHelp.begin(), kHelp.end());
    lines.resize(view.rows - 1);
    lines.push_back({"any key goes back", dim});
  } else {
    const std::size_t room = view.rows > 3 ? view.rows - 3 : 0;  // title, empty line, help
    const std::size_t for_events = std::min({kFewestEvents + 1, events.size(), room / 4});
    std::vector<StyledLine> body = tables(overview, view.filter);
    if (body.size() > room - for_events) {
      body = tables(overview, view.filter, Order::axes_first);
    }
    const std::size_t shown = std::min(body.size(), room - for_events);
    const std::size_t first = std::min(view.first, body.size() - shown);
    for (std::size_t i = 0; i < shown; ++i) {
      lines.push_back(body[first + i]);
    }
    for (std::size_t i = 0; i < std::min(events.size(), room - shown); ++i) {
      lines.push_back(events[i]);
    }
    lines.resize(view.rows - 1);
    lines.push_back({help(view), dim});
  }
  for (StyledLine& line : lines) {
    line.text = cut(line.text, view.columns);
  }
  return lines;
}

}  // namespace stator::cli

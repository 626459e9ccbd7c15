#include "stator/rack/file/changes.hpp"

#include <array>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "stator/formats/toml/toml.hpp"
#include "stator/settings/path.hpp"

namespace stator::rack {

namespace {

using settings::Path;
using settings::Value;

/// Where PATH ends: at the first "=" that is in no quotes.
std::size_t end_of_path(const std::string& change) {
  bool quoted = false;
  for (std::size_t i = 0; i < change.size(); ++i) {
    quoted = quoted != (change[i] == '"');
    if (change[i] == '=' && !quoted) {
      return i;
    }
  }
  return std::string::npos;
}

/// The name people give a device's table: its name, or its type without one.
bool is_called(const Value& device, const std::string& name) {
  const Value* called = device.at("name");
  if (called == nullptr) {
    called = device.at("type");
  }
  const auto* const text = called != nullptr ? called->find<std::string>() : nullptr;
  return text != nullptr && *text == name;
}

/// Where the device's table stands below `around`, which is a path to the tables of a network.
std::optional<Path> find_device(const Value& root, const Path& around, const std::string& name) {
  Path path = around;
  path.emplace_back("device");
  const Value* const devices = settings::find(root, path);
  const auto* const list = devices != nullptr ? devices->find<settings::List>() : nullptr;
  for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
    if (is_called((*list)[i], name)) {
      path.emplace_back(i);
      return path;
    }
  }
  return std::nullopt;
}

std::optional<Path> find_device(const Value& root, const std::string& name) {
  for (const char* const network : {"segment", "bus"}) {
    const Value* const tables = root.at(network);
    const auto* const list = tables != nullptr ? tables->find<settings::List>() : nullptr;
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i) {
      if (auto path = find_device(root, {network, i}, name)) {
        return path;
      }
    }
  }
  return find_device(root, {}, name);
}

/// What is wrong with the change; empty: it is made.
std::string apply(const std::string& change, Value& tree) {
  const std::size_t end = end_of_path(change);
  if (end == std::string::npos) {
    return "has no value; write PATH=VALUE, e.g. gantry.axis[1].load.inertia=2e-4";
  }
  auto path = settings::parse_path(std::string_view(change).substr(0, end));
  if (!path) {
    return path.error();
  }
  if (auto device = find_device(tree, std::get<std::string>(path->front()))) {
    device->insert(device->end(), path->begin() + 1, path->end());
    *path = std::move(*device);
  }
  auto source = std::make_shared<const std::string>("--set " + change);
  auto value = formats::parse_toml_value(change.substr(end + 1));
  const auto set =
      settings::set(tree, *path, Value(std::move(value), settings::Place{0, 0, std::move(source)}));
  return set ? "" : set.error();
}

}  // namespace

void apply_changes(Changes changes, Value& tree, settings::Problems& problems) {
  for (const std::string& change : changes) {
    if (const std::string wrong = apply(change, tree); !wrong.empty()) {
      problems.list.emplace_back(fmt::format("--set {}: {}", change, wrong));
    }
  }
}

}  // namespace stator::rack

#include "stator/link/can_exec/program_socket.hpp"

#include <cstdlib>
#include <cstring>
#include <string_view>

namespace stator::link::can_exec {

namespace {

std::vector<Bus> read_buses() {
  std::vector<Bus> found;
  const char* const variable = std::getenv(kBusesVariable);  // NOLINT(concurrency-mt-unsafe)
  std::string_view rest = variable == nullptr ? "" : variable;
  while (!rest.empty()) {
    const std::size_t end = rest.find(':');
    const std::string_view entry = rest.substr(0, end);
    const std::size_t equals = entry.find('=');
    if (equals != std::string_view::npos) {
      found.push_back({.name = std::string(entry.substr(0, equals)),
                       .path = std::string(entry.substr(equals + 1)),
                       .index = kFirstIndex + static_cast<int>(found.size())});
    }
    rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
  }
  return found;
}

}  // namespace

const std::vector<Bus>& buses() {
  static const std::vector<Bus>* const list = new std::vector<Bus>(read_buses());
  return *list;
}

const Bus* bus_named(const char* name) {
  for (const Bus& each : buses()) {
    if (each.name == name) {
      return &each;
    }
  }
  return nullptr;
}

const Bus* bus_with_index(int index) {
  for (const Bus& each : buses()) {
    if (each.index == index) {
      return &each;
    }
  }
  return nullptr;
}

}  // namespace stator::link::can_exec

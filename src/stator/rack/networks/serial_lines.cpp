#include "stator/rack/networks/serial_lines.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

namespace stator::rack {

void SerialLines::add(const SerialMember& member) {
  for (const SerialConnection& connection : member.configuration.serial) {
    if (!line_to(connection.line)
             .add(member.device, connection.interface, member.network, member.position)) {
      throw std::runtime_error(fmt::format("{} has no serial interface \"{}\"",
                                           member.configuration.name, connection.interface));
    }
  }
}

SerialLine& SerialLines::line_to(const std::string& link) {
  for (const auto& line : lines_) {
    if (line->configuration().link == link) {
      return *line;
    }
  }
  const auto own = std::ranges::find(settings_, link, &SerialLineConfiguration::link);
  SerialLineConfiguration configuration;
  configuration.link = link;
  lines_.push_back(std::make_unique<SerialLine>(own != settings_.end() ? *own : configuration));
  return *lines_.back();
}

void SerialLines::advance(base::SimTime now) {
  for (base::SimTime instant = next_deadline(); instant <= now; instant = next_deadline()) {
    for (const auto& line : lines_) {
      line->advance(instant);
    }
  }
}

void SerialLines::set_journal(Journal* journal) {
  for (std::size_t number = 0; number < lines_.size(); ++number) {
    lines_[number]->set_journal(journal, number);
  }
}

base::SimTime SerialLines::next_deadline() const {
  base::SimTime next = base::SimTime::never();
  for (const auto& line : lines_) {
    next = std::min(next, line->next_deadline());
  }
  return next;
}

void SerialLines::set_power(const product::Device& device, bool on) {
  for (const auto& line : lines_) {
    line->set_power(device, on);
  }
}

}  // namespace stator::rack

#pragma once

#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "stator/canopen/nmt/node.hpp"

namespace stator::canopen {

/// Stands in for emergency producer and error behaviour: writes down what they are told.
class ErrorRecorder final : public EmergencySink, public CommunicationErrorReaction {
 public:
  void connect(Node& node) {
    node.set_emergency_sink(this);
    node.set_communication_error_reaction(this);
  }

  void raise(const Emergency& emergency, base::SimTime) override {
    information = emergency.information;
    log.push_back(fmt::format("raise {:04X} {} register {:02X}", emergency.code, emergency.cause,
                              emergency.error_register));
  }
  void clear(std::uint16_t code, std::uint8_t cause, base::SimTime) override {
    log.push_back(fmt::format("clear {:04X} {}", code, cause));
  }
  void on_communication_error(base::SimTime) override { log.emplace_back("reaction"); }

  std::vector<std::string> log;
  std::array<std::uint8_t, 5> information{};
};

}  // namespace stator::canopen

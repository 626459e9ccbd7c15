#include "stator/web/api/state_machines.hpp"

#include <cstdint>
#include <string>
#include <string_view>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "stator/canopen/nmt_command.hpp"
#include "stator/drive/power/state_description.hpp"
#include "stator/ethercat/standard/al_transition.hpp"
#include "stator/web/json_text.hpp"

namespace stator::web {

namespace {

using Json = nlohmann::ordered_json;

Json transition(std::string_view from, std::string_view to, std::string_view number,
                std::string_view event) {
  return {{"from", from}, {"to", to}, {"number", number}, {"event", event}};
}

Json power_drive_system() {
  Json states = Json::array();
  for (const drive::PowerState state : drive::kPowerStates) {
    states.push_back(to_text(state));
  }
  Json transitions = Json::array();
  for (const drive::AutomaticPowerTransition& each : drive::kAutomaticPowerTransitions) {
    // Transition 0 comes from outside the graph; transition 13 begins in any state but those of
    // faults.
    if (each.from) {
      transitions.push_back(transition(to_text(*each.from), to_text(each.to),
                                       std::to_string(each.number), each.cause));
      continue;
    }
    for (const drive::PowerState from : drive::kPowerStates) {
      if (each.number != 0 && from != drive::PowerState::fault_reaction_active &&
          from != drive::PowerState::fault) {
        transitions.push_back(
            transition(to_text(from), to_text(each.to), std::to_string(each.number), each.cause));
      }
    }
  }
  for (const drive::PowerTransition& each : drive::kPowerTransitions) {
    transitions.push_back(transition(to_text(each.from), to_text(each.to),
                                     std::to_string(each.number), to_text(each.command)));
  }
  return {{"name", "cia402"},
          {"title", "CiA 402 power drive system"},
          {"states", std::move(states)},
          {"transitions", std::move(transitions)}};
}

Json ethercat_state_machine() {
  using ethercat::AlState;
  Json states = Json::array();
  for (const AlState state : {AlState::init, AlState::pre_operational, AlState::bootstrap,
                              AlState::safe_operational, AlState::operational}) {
    states.push_back(to_text(state));
  }
  Json transitions = Json::array();
  for (const ethercat::AlTransition& each : ethercat::kAlTransitions) {
    transitions.push_back(transition(to_text(each.from), to_text(each.to), each.name,
                                     fmt::format("AL control {}", static_cast<int>(each.to))));
  }
  return {{"name", "esm"},
          {"title", "EtherCAT state machine"},
          {"states", std::move(states)},
          {"transitions", std::move(transitions)}};
}

std::string_view name_of(canopen::NmtCommand command) {
  switch (command) {
    case canopen::NmtCommand::start:
      return "start remote node";
    case canopen::NmtCommand::stop:
      return "stop remote node";
    case canopen::NmtCommand::enter_pre_operational:
      return "enter pre-operational";
    case canopen::NmtCommand::reset_node:
      return "reset node";
    case canopen::NmtCommand::reset_communication:
      return "reset communication";
  }
  return "?";
}

Json nmt_state_machine() {
  using canopen::NmtState;
  Json states = Json::array();
  Json transitions = Json::array();
  transitions.push_back(transition(to_text(NmtState::initialisation),
                                   to_text(NmtState::pre_operational), "boot-up",
                                   "initialisation finished"));
  for (const NmtState from : {NmtState::initialisation, NmtState::pre_operational,
                              NmtState::operational, NmtState::stopped}) {
    states.push_back(to_text(from));
    for (const canopen::NmtTransition& each : canopen::kNmtTransitions) {
      if (from != NmtState::initialisation && from != each.target) {
        transitions.push_back(transition(to_text(from), to_text(each.target),
                                         std::to_string(static_cast<unsigned>(each.command)),
                                         name_of(each.command)));
      }
    }
  }
  return {{"name", "nmt"},
          {"title", "CANopen network management"},
          {"states", std::move(states)},
          {"transitions", std::move(transitions)}};
}

}  // namespace

Response describe_state_machines() {
  return json_response(
      {{"machines", {power_drive_system(), ethercat_state_machine(), nmt_state_machine()}}});
}

}  // namespace stator::web

// Sequences for people: lines, and scenario files that `stator test` runs.

#include <iomanip>
#include <sstream>

#include "devices/drive_sequences/sequence.hpp"

namespace stator::tests {

namespace {

std::string hexadecimal(std::uint32_t value, int digits) {
  std::ostringstream text;
  text << std::hex << std::uppercase << std::setfill('0') << std::setw(digits) << value;
  return text.str();
}

std::string object_text(const DriveStep& step) {
  return hexadecimal(step.index, 4) + ":" + hexadecimal(step.subindex, 2);
}

std::string number_text(double value) {
  std::ostringstream text;
  text.precision(12);
  text << value;
  return text.str();
}

std::string_view al_state(std::int64_t value) {
  switch (value) {
    case 1:
      return "init";
    case 2:
      return "pre-operational";
    case 4:
      return "safe-operational";
    default:
      return "operational";
  }
}

std::string_view nmt_command(std::int64_t value) {
  switch (value) {
    case 1:
      return "start";
    case 2:
      return "stop";
    case 0x81:
      return "reset-node";
    default:
      return "enter-pre-operational";
  }
}

bool on_ethercat(Product product) {
  return product == Product::tmc8670 || product == Product::tmcm_3315;
}

std::string tmcl_text(const DriveStep& step) {
  const std::string value = std::to_string(step.value);
  using enum tmcl::Command;
  switch (step.command) {
    case rotate_right:
      return "ROR 0, " + value;
    case rotate_left:
      return "ROL 0, " + value;
    case motor_stop:
      return "MST 0";
    case move_to_position:
      return std::string(step.index == 0 ? "MVP ABS, 0, " : "MVP REL, 0, ") + value;
    case set_axis_parameter:
      return "SAP " + std::to_string(step.index) + ", 0, " + value;
    case set_global_parameter:
      return "SGP " + std::to_string(step.index) + ", 0, " + value;
    case reference_search:
      return step.index == 0 ? "RFS START, 0" : "RFS STOP, 0";
    default:
      return "?";
  }
}

/// The keys of a rack file that make the product as the tests have it, and the device's name.
struct Bench {
  std::string_view rack;
  std::string_view device;
  std::string_view first_steps;
};

constexpr std::string_view kOperational = "[[step]]\ndo = \"state\"\nstate = \"operational\"\n\n";

Bench bench_of(Product product) {
  switch (product) {
    case Product::tmc8670:
      return {"rack = \"racks/ethercat-servo.toml\"  # from the folder of the repository\n\n",
              "servo", kOperational};
    case Product::tmcm_3315:
      return {
          "[[rack.segment]]\n[[rack.segment.device]]\ntype = \"tmcm-3315\"\nname = \"drive\"\n"
          "[[rack.segment.device.axis]]\nload.viscous_friction = 0.004\n\n",
          "drive", kOperational};
    case Product::tmcc160_hall:
      return {"[[rack.bus]]\n[[rack.bus.device]]\ntype = \"tmcc160\"\nname = \"drive\"\n\n",
              "drive", "[[step]]\ndo = \"nmt\"\ncommand = \"start\"\n\n"};
    case Product::tmcc160_encoder:
      return {"[[rack.bus]]\n[[rack.bus.device]]\ntype = \"tmcc160\"\nname = \"drive\"\n\n",
              "drive",
              "[[step]]\ndo = \"nmt\"\ncommand = \"start\"\n\n[[step]]\ndo = \"write\"\n"
              "object = \"2055:00\"\nvalue = 7\n\n"};
    case Product::tmcm_142:
      return {"[[rack.bus]]\n[[rack.bus.device]]\ntype = \"tmcm-142\"\nname = \"drive\"\n\n",
              "drive", "[[step]]\ndo = \"tmcl\"\ncommand = \"SAP 255, 0, 1\"\n\n"};
  }
  return {};
}

std::string scenario_step(Product product, const DriveStep& step, std::string_view device) {
  const std::string head = "[[step]]\ndo = ";
  switch (step.action) {
    case DriveAction::wait:
      return head + "\"wait\"\ntime = \"" + std::to_string(step.value) + "ms\"\n\n";
    case DriveAction::write:
      return head + "\"write\"\nobject = \"" + object_text(step) +
             "\"\nvalue = " + std::to_string(step.value) + "\n\n";
    case DriveAction::set:
      return head + "\"set\"\ndevice = \"" + std::string(device) + "\"\ninput = \"" +
             std::string(step.input) + "\"\nvalue = " + number_text(step.level) + "\n\n";
    case DriveAction::network:
      return on_ethercat(product)
                 ? head + "\"state\"\nstate = \"" + std::string(al_state(step.value)) + "\"\n\n"
                 : head + "\"nmt\"\ncommand = \"" + std::string(nmt_command(step.value)) + "\"\n\n";
    case DriveAction::command:
      return head + "\"tmcl\"\ncommand = \"" + tmcl_text(step) + "\"\n\n";
    default:
      return "# " + to_text(step) + "\n\n";
  }
}

}  // namespace

std::string_view to_text(Product product) {
  switch (product) {
    case Product::tmc8670:
      return "TMC8670";
    case Product::tmcm_3315:
      return "TMCM-3315";
    case Product::tmcc160_hall:
      return "TMCC160 with Hall sensors";
    case Product::tmcc160_encoder:
      return "TMCC160 with encoder";
    case Product::tmcm_142:
      return "TMCM-142";
  }
  return "?";
}

std::string to_text(const DriveStep& step) {
  const std::string value = std::to_string(step.value);
  switch (step.action) {
    case DriveAction::wait:
      return "wait " + value + " ms";
    case DriveAction::write:
      return object_text(step) + " = " +
             (step.index == 0x6040 ? "0x" + hexadecimal(static_cast<std::uint32_t>(step.value), 2)
                                   : value);
    case DriveAction::write_near:
      return object_text(step) + " = actual position + " + value;
    case DriveAction::set:
      return std::string(step.input) + " = " + number_text(step.level);
    case DriveAction::switch_at:
      return std::string(step.input) + " is pressed " + number_text(step.level) +
             " rev further out";
    case DriveAction::travel:
      return object_text(step) + " moves by " + value + " each ms for " +
             std::to_string(step.cycles) + " ms";
    case DriveAction::lose_cycles:
      return value + " exchanges of process data are lost";
    case DriveAction::double_cycle:
      return "process data are exchanged twice";
    case DriveAction::network:
      return "network state or command " + value;
    case DriveAction::command:
      return tmcl_text(step);
  }
  return "?";
}

std::string scenario_of(Product product, std::span<const DriveStep> steps, std::string_view name) {
  const Bench bench = bench_of(product);
  std::string text = "name = \"" + std::string(name) + "\"\nplot = [\"" +
                     std::string(bench.device) + ".axis0.shaft_speed\", \"" +
                     std::string(bench.device) + ".axis0.shaft_position\"]\n";
  text += bench.rack;
  text += bench.first_steps;
  for (const DriveStep& step : steps) {
    text += scenario_step(product, step, bench.device);
  }
  return text;
}

}  // namespace stator::tests

#include "stator/product/shell/tmcl_monitor.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "stator/tmcl/command.hpp"

namespace stator::product {

namespace {

using base::EventArgument;
using base::EventRule;
using base::Severity;
using tmcl::Command;
using tmcl::Status;

constexpr std::uint16_t kFirstProfileIndex = 0x6000;

constexpr EventRule kReadsOnly{
    "tmcl-reads-only", Severity::refusal,
    "{0}: {1} (TMCL command {2}) refused with status 6: this interface reads values and moves or "
    "changes nothing; use EtherCAT"};
constexpr EventRule kUnknownCommand{
    "tmcl-monitor-unknown-command", Severity::refusal,
    "{0}: TMCL command {1} refused with status 2: this interface knows GAP (6), GGP (10), GIO (15) "
    "and the firmware version (136)"};

/// Commands that exist on modules of this family and would move or change something.
constexpr bool moves_or_changes(Command command) {
  switch (command) {
    case Command::rotate_right:
    case Command::rotate_left:
    case Command::motor_stop:
    case Command::move_to_position:
    case Command::set_axis_parameter:
    case Command::store_axis_parameter:
    case Command::restore_axis_parameter:
    case Command::set_global_parameter:
    case Command::store_global_parameter:
    case Command::restore_global_parameter:
    case Command::reference_search:
    case Command::set_output:
    case Command::set_coordinate:
    case Command::get_coordinate:
    case Command::capture_coordinate:
    case Command::accumulator_to_coordinate:
    case Command::stop_application:
    case Command::run_application:
    case Command::step_application:
    case Command::reset_application:
    case Command::start_download:
    case Command::quit_download:
    case Command::restore_factory_settings:
    case Command::software_reset:
      return true;
    default:
      return false;
  }
}

}  // namespace

TmclMonitor::TmclMonitor(const dictionary::Dictionary& dictionary,
                         std::span<const ReadableParameter> parameters,
                         std::span<const IndexOffsets> axes, const tmcl::ModuleIdentity& identity,
                         const tmcl::BootMemory& memory, base::EventReporter reporter)
    : ModuleInterface(identity, memory, reporter),
      line_(identity.line),
      parameters_(parameters),
      dictionary_(dictionary) {
  for (const IndexOffsets& axis : axes) {
    std::vector<const dictionary::Entry*>& sources = sources_.emplace_back();
    for (const ReadableParameter& parameter : parameters_) {
      const unsigned offset =
          parameter.index < kFirstProfileIndex ? axis.manufacturer : axis.profile;
      const dictionary::Entry* source =
          dictionary.find(static_cast<std::uint16_t>(parameter.index + offset), parameter.subindex);
      if (source == nullptr) {
        throw std::logic_error("TMCL axis parameter " + std::to_string(parameter.number) +
                               " shows an object that does not exist");
      }
      sources.push_back(source);
    }
  }
}

TmclMonitor::Answer TmclMonitor::execute(const tmcl::Request& request, base::SimTime now) {
  const auto command = static_cast<Command>(request.command);
  switch (command) {
    case Command::get_axis_parameter:
      return get_axis_parameter(request);
    case Command::get_global_parameter:
      return get_global_parameter(request, now);
    case Command::get_input:
      return get_input(request);
    default:
      break;
  }
  if (moves_or_changes(command)) {
    reporter().report(now, kReadsOnly,
                      {EventArgument(line_), EventArgument(tmcl::name_of(request.command)),
                       EventArgument(int{request.command})});
    return {Status::command_not_available};
  }
  reporter().report(now, kUnknownCommand,
                    {EventArgument(line_), EventArgument(int{request.command})});
  return {Status::invalid_command};
}

TmclMonitor::Answer TmclMonitor::get_axis_parameter(const tmcl::Request& request) const {
  const auto parameter = std::ranges::find(parameters_, request.type, &ReadableParameter::number);
  if (parameter == parameters_.end()) {
    return {Status::wrong_type};
  }
  if (request.motor >= sources_.size()) {
    return {Status::invalid_value};
  }
  const auto position = static_cast<std::size_t>(parameter - parameters_.begin());
  const dictionary::Entry& source = *sources_[request.motor][position];
  if (!dictionary_.prepare_read(source)) {
    return {Status::wrong_type};
  }
  const std::uint64_t value = source.value() >> parameter->first_bit;
  const std::uint64_t mask = (std::uint64_t{1} << parameter->bits) - 1;
  return {Status::success, static_cast<std::int32_t>(value & mask)};
}

TmclMonitor::Answer TmclMonitor::get_global_parameter(const tmcl::Request& request,
                                                      base::SimTime now) {
  constexpr std::uint8_t kOwnSerialAddress = 66;
  constexpr std::uint8_t kSerialHostAddress = 76;
  constexpr std::uint8_t kTickTimer = 132;
  if (request.motor != 0) {
    return {Status::invalid_value};
  }
  switch (request.type) {
    case kOwnSerialAddress:
      return {Status::success, kModuleAddress};
    case kSerialHostAddress:
      return {Status::success, kHostAddress};
    case kTickTimer:
      return {Status::success, static_cast<std::int32_t>(now.nanoseconds() / 1'000'000)};
    default:
      return {Status::wrong_type};
  }
}

}  // namespace stator::product

// Direct commands to TMCL modules.
#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/product/device/device.hpp"
#include "stator/scenario/comparison.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/tmcl/assembler/direct_line.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"

namespace stator::scenario {

namespace {

struct Command {
  Target on{};
  std::optional<std::string> command{};
  std::uint8_t status = static_cast<std::uint8_t>(tmcl::Status::success);
  Comparison value{};
  base::SimDuration within{};
};
constexpr std::array kCommandRows{
    settings::needed(settings::text<&Command::command>(
                         "command", "As programs write it, e.g. \"MVP ABS, 0, 51200\""),
                     "it is a command as programs write it, e.g. \"GAP 1, 0\""),
    settings::whole<&Command::status>("status", {0, 255},
                                      "Status that the reply must have, 100 is success"),
    settings::keys<kComparisonKeys, &Command::value>(), within_key<&Command::within>()};
constexpr settings::Section<Command> kCommandKeys{kCommandRows};

std::string status_name(tmcl::Status status) {
  return fmt::format("status {} ({})", static_cast<int>(status), status_text(status));
}

ReadStep step_of(const Command& step, const StepReader& reader) {
  return {
      fmt::format("{}: {}", reader.name_of(*step.on.device), *step.command),
      [=](bench::Bench& bench) {
        const rack::DeviceAddress device = *step.on.device;
        const tmcl::Firmware* firmware = bench.rack().device(device).tmcl_firmware();
        if (firmware == nullptr) {
          return fail(fmt::format("{} has no TMCL", bench.rack().name_of(device)));
        }
        const auto instruction = tmcl::parse_direct_line(*step.command, firmware->description());
        if (!instruction) {
          return fail(fmt::format("\"{}\" is no command: {}", *step.command, instruction.error()));
        }
        const auto status = static_cast<tmcl::Status>(step.status);
        std::string seen;
        const bool met = bench.wait_until(
            [&] {
              const auto reply = bench.ask(device, *instruction);
              seen = reply ? fmt::format("{}, value {}", status_name(reply->status), reply->value)
                           : reply.error();
              return reply && reply->status == status &&
                     step.value.met(static_cast<double>(reply->value));
            },
            step.within);
        return met ? pass(seen)
                   : fail(fmt::format(
                         "expected {}{}; {}", status_name(status),
                         step.value.empty() ? "" : " and a value that " + step.value.text(), seen));
      }};
}

}  // namespace

constinit const StepKind kTmcl = step_kind<Command, &StepReader::device, &kCommandKeys>(
    "tmcl", "A direct command is sent to a TMCL module");

}  // namespace stator::scenario

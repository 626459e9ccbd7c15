// Direct commands to TMCL modules.
#include <map>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/scenario/comparison.hpp"
#include "stator/scenario/step_kinds.hpp"
#include "stator/tmcl/assembler/direct_line.hpp"
#include "stator/tmcl/interpreter/firmware.hpp"

namespace stator::scenario {

namespace {

/// What is expected of the reply.
struct Expected {
  tmcl::Status status = tmcl::Status::success;
  Comparison value;

  [[nodiscard]] bool met(const tmcl::Reply& reply) const {
    return reply.status == status && value.met(static_cast<double>(reply.value));
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("status {} ({}){}", static_cast<int>(status), status_text(status),
                       value.empty() ? "" : " and a value that " + value.text());
  }
};

std::string reply_text(const tmcl::Reply& reply) {
  return fmt::format("status {} ({}), value {}", static_cast<int>(reply.status),
                     status_text(reply.status), reply.value);
}

}  // namespace

ReadStep read_tmcl(rack::TableReader& section, StepReader& reader) {
  const rack::DeviceAddress device = reader.device(section);
  const auto command =
      section.text({"command", "As programs write it, e.g. \"MVP ABS, 0, 51200\""});
  Expected expected;
  auto status = static_cast<std::uint8_t>(expected.status);
  section.integer({"status", "Status that the reply must have, 100 is success"}, 0, 255, status);
  expected.status = static_cast<tmcl::Status>(status);
  expected.value = read_comparison(section);
  const base::SimDuration within = StepReader::within(section, base::SimDuration());
  if (!command) {
    section.missing("command", "it is a command as programs write it, e.g. \"GAP 1, 0\"");
  }
  return {fmt::format("{}: {}", reader.name_of(device), *command), [=](bench::Bench& bench) {
            const tmcl::Firmware* firmware = bench.rack().device(device).tmcl_firmware();
            if (firmware == nullptr) {
              return fail(fmt::format("{} has no TMCL", bench.rack().name_of(device)));
            }
            const auto instruction = tmcl::parse_direct_line(*command, firmware->description());
            if (!instruction) {
              return fail(fmt::format("\"{}\" is no command: {}", *command, instruction.error()));
            }
            std::string seen;
            const bool met = bench.wait_until(
                [&] {
                  const auto reply = bench.ask(device, *instruction);
                  seen = reply ? reply_text(*reply) : reply.error();
                  return reply && expected.met(*reply);
                },
                within);
            return met ? pass(seen) : fail(fmt::format("expected {}; {}", expected.text(), seen));
          }};
}

}  // namespace stator::scenario

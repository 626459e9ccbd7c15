// Steps that write objects; those that read one are expectations.
#include <optional>
#include <string>

#include <fmt/format.h>

#include "stator/bench/bench.hpp"
#include "stator/scenario/comparison.hpp"
#include "stator/scenario/object_value.hpp"
#include "stator/scenario/step_kinds.hpp"

namespace stator::scenario {

namespace {

Outcome aborted_outcome(const master::Result<void>& written, std::uint32_t expected) {
  if (written) {
    return fail(fmt::format("expected the abort code {:08X}h; the object was written", expected));
  }
  const master::Error& error = written.error();
  if (error.code == master::ErrorCode::sdo_aborted && error.detail == expected) {
    return pass(error.text);
  }
  return fail(fmt::format("expected the abort code {:08X}h; {}", expected, error.text));
}

}  // namespace

ReadStep read_write(rack::TableReader& section, StepReader& reader) {
  const rack::DeviceAddress device = reader.device(section);
  const auto object = read_object_address(section);
  const auto value = read_object_value(section);
  const auto abort = section.integer(
      {"abort", "The transfer must be aborted with this code, e.g. 0x06090030"}, 1, 0xFFFFFFFF);
  if (!value) {
    section.missing("value", "it is what is written");
  }
  if (!object) {
    rack::TableReader::abandon();
  }
  const std::string shown =
      std::holds_alternative<double>(*value)        ? number_text(std::get<double>(*value))
      : std::holds_alternative<std::string>(*value) ? "\"" + std::get<std::string>(*value) + "\""
                                                    : bytes_text(std::get<2>(*value));
  std::string title = fmt::format("{} {:04X}h:{:02X} = {}", reader.name_of(device), object->index,
                                  object->subindex, shown);
  if (abort) {
    title += fmt::format(", aborted with {:08X}h", *abort);
  }
  return {std::move(title), [=](bench::Bench& bench) {
            const auto data = to_bytes(*value, find_entry(bench, device, *object));
            if (!data) {
              return fail(data.error());
            }
            const auto written = bench.download(device, *object, *data);
            return abort ? aborted_outcome(written, static_cast<std::uint32_t>(*abort))
                         : outcome_of(written);
          }};
}

}  // namespace stator::scenario

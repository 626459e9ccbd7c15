// Steps that write objects; those that read one are expectations.
#include <array>
#include <cstdint>
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

struct Write {
  Target on{};
  std::optional<master::ObjectAddress> object{};
  std::optional<ObjectValue> value{};
  std::optional<std::uint32_t> abort{};  ///< the transfer must be aborted with
};
constexpr std::array kWriteRows{
    settings::keys<kObjectKeys, &Write::object>(),
    settings::keys<kObjectValueKeys, &Write::value>(),
    settings::whole<&Write::abort>("abort", {1, 0xFFFFFFFF},
                                   "The transfer must be aborted with this code, e.g. 0x06090030")};
constexpr std::array kWriteRules{
    settings::Rule<Write>{.key = "value",
                          .holds = [](const Write& step) { return step.value.has_value(); },
                          .sentence = "\"value\" is missing; it is what is written"},
    kNeedsObject<Write>};
constexpr settings::Section<Write> kWriteKeys{kWriteRows, kWriteRules};

std::string text_of(const ObjectValue& value) {
  return std::holds_alternative<double>(value)        ? number_text(std::get<double>(value))
         : std::holds_alternative<std::string>(value) ? "\"" + std::get<std::string>(value) + "\""
                                                      : bytes_text(std::get<2>(value));
}

ReadStep step_of(const Write& step, const StepReader& reader) {
  std::string title = fmt::format("{} {:04X}h:{:02X} = {}", reader.name_of(*step.on.device),
                                  step.object->index, step.object->subindex, text_of(*step.value));
  if (step.abort) {
    title += fmt::format(", aborted with {:08X}h", *step.abort);
  }
  return {std::move(title), [=](bench::Bench& bench) {
            const rack::DeviceAddress device = *step.on.device;
            const auto data = to_bytes(*step.value, find_entry(bench, device, *step.object));
            if (!data) {
              return fail(data.error());
            }
            const auto written = bench.download(device, *step.object, *data);
            return step.abort ? aborted_outcome(written, *step.abort) : outcome_of(written);
          }};
}

}  // namespace

constinit const StepKind kWrite =
    step_kind<Write, &StepReader::device, &kWriteKeys>("write", "An object is written by SDO");

}  // namespace stator::scenario

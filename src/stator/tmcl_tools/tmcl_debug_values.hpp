#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "stator/base/expected.hpp"
#include "stator/tmcl/assembler/expression.hpp"
#include "stator/tmcl_tools/tmcl_bench.hpp"
#include "stator/tmcl_tools/tmcl_source.hpp"

namespace stator::tmcl_tools {

/// What a person at the debugger may call by name, to read and to set:
///
///     $accu $x $pc $depth $time $zero $equal $lower $greater $errors   registers; $time in ms
///     MAX_CURRENT AP_6 VARIABLE_0 GP_66                                parameters and variables
///     COORD_3 IN_4 ANALOG_0 OUT_1                                      also as coord[3]
///     labels (their addresses) and constants of the program
///
/// Values are read as a host reads them, by commands in direct mode: parameters that clear
/// themselves when they are read do so here, too.
class TmclDebugValues final : public tmcl::NameScope {
 public:
  /// Both must outlive the object.
  TmclDebugValues(TmclBench& bench, const TmclSource& source) : bench_(bench), source_(source) {}

  [[nodiscard]] base::Expected<std::int64_t, std::string> value_of(
      std::string_view name) const override;

  /// A sum of products of numbers and names, or a comparison of two with == != < <= > >=, which is
  /// 1 or 0. The error is a sentence.
  [[nodiscard]] base::Expected<std::int64_t, std::string> evaluate(std::string_view text) const;

  /// Sets what has that name, as a host does it. The error is a sentence.
  [[nodiscard]] base::Expected<void, std::string> assign(std::string_view name, std::int32_t value);

 private:
  struct Place;

  [[nodiscard]] std::optional<Place> find(std::string_view name) const;
  [[nodiscard]] std::optional<std::int64_t> register_value(std::string_view name) const;
  [[nodiscard]] base::Expected<std::int64_t, std::string> sum(std::string_view text) const;
  [[nodiscard]] tmcl::HostAnswer direct(tmcl::Command command, std::uint8_t type,
                                        std::uint8_t motor, std::int32_t value) const;

  TmclBench& bench_;
  const TmclSource& source_;
};

}  // namespace stator::tmcl_tools

#pragma once

#include <algorithm>
#include <functional>
#include <ostream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "rack/drive_fault_bench.hpp"
#include "sanitized.hpp"

namespace stator::tests {

/// A fault of motor, load, sensors or supply, what the master of one product sees of it by frames,
/// objects and telegrams, and how all is well again. `Bench` says by start_motion(), is_healthy()
/// and go_on() how the product is brought into motion, that it is, and how after a fault.
template <typename Bench>
struct SurroundingsRow {
  const char* name;
  const char* fault;                       ///< keys as in a rack file, without `device`
  std::vector<Told> told{};                ///< emergencies, in their order
  bool stops = false;                      ///< the drive leaves Operation enabled, a module stops
  std::function<void(Bench&)> see{};       ///< what else the master sees while it lasts
  base::SimDuration lasts{1'000'000'000};  ///< until the master has been told at most
  bool restart = false;                    ///< well again only after a restart of the product

  /// What was heated has to cool down.
  [[nodiscard]] bool takes_a_minute() const { return lasts > base::SimDuration{1'000'000'000}; }
};

template <typename Bench>
void PrintTo(const SurroundingsRow<Bench>& row, std::ostream* out) {
  *out << row.name;
}

/// The rows of a table that are run: all, but every third of those that do not take a minute with a
/// sanitizer, which looks for other mistakes than the tables do.
template <typename Bench>
std::vector<SurroundingsRow<Bench>> rows_to_run(const std::vector<SurroundingsRow<Bench>>& rows) {
  if constexpr (!kSanitized) {
    return rows;
  }
  std::vector<SurroundingsRow<Bench>> some;
  for (std::size_t i = 0; i < rows.size(); i += 3) {
    if (!rows[i].takes_a_minute()) {
      some.push_back(rows[i]);
    }
  }
  return some;
}

/// What a table shows of a kind: the fault, and whether anything is expected of it.
struct CoveredFault {
  std::string product;
  std::string fault;
  bool seen = false;
};

template <typename Bench>
std::vector<CoveredFault> covered_by(std::string_view product,
                                     const std::vector<SurroundingsRow<Bench>>& rows) {
  std::vector<CoveredFault> covered;
  for (const SurroundingsRow<Bench>& row : rows) {
    covered.push_back({std::string(product), row.fault,
                       !row.told.empty() || row.stops || static_cast<bool>(row.see)});
  }
  return covered;
}

// The tables of the products, each in a file of its own.
std::vector<CoveredFault> covered_tmcm_3315();
std::vector<CoveredFault> covered_tmc8670();
std::vector<CoveredFault> covered_tmcc160();
std::vector<CoveredFault> covered_tmcm_142();
std::vector<CoveredFault> covered_tmc8461();

template <typename Bench>
void expect_seen_and_gone(const SurroundingsRow<Bench>& row) {
  using namespace base::literals;
  constexpr base::SimDuration kLook = 20_ms;
  Bench bench;
  bench.start_motion();
  ASSERT_TRUE(bench.is_healthy());
  ASSERT_TRUE(bench.told().empty());

  const std::string device = std::string("\ndevice = '") + Bench::kDevice + "'";
  const std::uint64_t fault = bench.inject(row.fault + device);
  std::vector<Told> told;
  const auto listen = [&] { std::ranges::copy(bench.told(), std::back_inserter(told)); };
  for (base::SimDuration waited{}; waited < row.lasts; waited += kLook) {
    bench.pass(kLook);
    listen();
    if (!row.told.empty() && told.size() >= row.told.size()) {
      break;
    }
  }
  bench.pass(200_ms);
  listen();
  EXPECT_EQ(told, row.told);
  EXPECT_EQ(bench.stopped(), row.stops);
  if (row.see) {
    row.see(bench);
  }

  const bool momentary = bench.state(fault) == rack::FaultState::done;
  if (!momentary) {
    bench.clear(fault);
  }
  EXPECT_EQ(bench.state(fault), rack::FaultState::done);
  bench.pass(row.takes_a_minute() ? 60_s : 1_s);
  if (row.restart) {
    bench.inject("kind = 'power-off'\nfor = '50ms'" + device);
    bench.pass(100_ms);
    bench.start_motion();
  } else {
    bench.go_on();
  }
  static_cast<void>(bench.told());
  bench.pass(1_s);
  EXPECT_TRUE(bench.told().empty());
  EXPECT_TRUE(bench.is_healthy());
}

/// Lowest and highest of what is read 50 times, every 2 ms.
template <typename Bench, typename Read>
auto extremes_of(Bench& bench, Read read) {
  std::pair<decltype(read()), decltype(read())> extremes{read(), read()};
  for (int n = 0; n < 50; ++n) {
    bench.pass(base::SimDuration(2'000'000));
    const auto value = read();
    extremes = {std::min(extremes.first, value), std::max(extremes.second, value)};
  }
  return extremes;
}
/// Peak to peak of that.
template <typename Bench, typename Read>
auto ripple_of(Bench& bench, Read read) {
  const auto [lowest, highest] = extremes_of(bench, read);
  return highest - lowest;
}

/// The name of a row as that of a test.
struct RowName {
  template <typename Info>
  std::string operator()(const Info& info) const {
    return info.param.name;
  }
};

}  // namespace stator::tests

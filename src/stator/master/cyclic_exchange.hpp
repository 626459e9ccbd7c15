#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "stator/master/bus.hpp"
#include "stator/master/cycle_statistics.hpp"
#include "stator/master/process_data.hpp"

namespace stator::master {

/// The process image of a segment and its exchange, once per cycle: LRW datagrams, with the system
/// time of the reference clock in the first frame.
class CyclicExchange {
 public:
  explicit CyclicExchange(Bus& bus) : bus_(bus) {}
  /// Goes on from where `other` has come, on `bus`.
  CyclicExchange(Bus& bus, const CyclicExchange& other);

  /// Forgets image, mapping and reference clock.
  void clear();
  /// Lays out an image for `slaves`, by position; all outputs are 0.
  Result<void> configure(std::vector<SlaveProcessData> slaves);
  [[nodiscard]] bool configured() const { return !slaves_.empty(); }
  /// Writes the slave's sync managers and FMMUs.
  Result<void> write_mapping(const Station& station);
  /// Distributes this slave's system time with each exchange.
  void set_reference_clock(const std::optional<Station>& station) { reference_clock_ = station; }

  /// One exchange, now. On failure the inputs stay as they were.
  Result<void> exchange();
  /// Waits for the next multiple of the cycle time, then exchanges. A few failures in a row
  /// (MasterOptions::tolerated_lost_cycles) are counted only, and so is silence, however many
  /// cycles are lost by it, for as long as MasterOptions::patience lasts.
  Result<void> run_cycle();

  [[nodiscard]] const CycleStatistics& statistics() const { return statistics_; }

  [[nodiscard]] std::span<std::byte> outputs(std::size_t position);
  [[nodiscard]] std::span<const std::byte> inputs(std::size_t position) const;
  [[nodiscard]] std::span<const MappedEntry> output_entries(std::size_t position) const;
  [[nodiscard]] std::span<const MappedEntry> input_entries(std::size_t position) const;

 private:
  void wait_for_cycle();
  Result<void> exchange_frames();
  Result<void> exchange_frame(const ImageLayout::Frame& frame, bool with_clock);

  Bus& bus_;
  std::vector<SlaveProcessData> slaves_;
  ImageLayout layout_;
  std::vector<std::byte> image_;
  std::vector<std::byte> frame_data_;  ///< of the frame that is under way
  std::optional<Station> reference_clock_;
  base::SimTime next_cycle_;
  int failures_in_a_row_ = 0;
  std::optional<base::SimTime> silent_since_;  ///< nothing: the last frame came back
  std::uint64_t lost_in_silence_ = 0;
  std::uint64_t late_before_silence_ = 0;
  CycleStatistics statistics_;
};

}  // namespace stator::master

#pragma once

#include <array>
#include <deque>
#include <set>
#include <vector>

#include "stator/board/lines/pins.hpp"

namespace stator::board {

/// Stands in for the chip: its outputs follow a script, its inputs are looked at.
class ScriptPins final : public Pins {
 public:
  /// The chip drives a line from `time` on; times do not decrease.
  void at(base::SimTime time, Line line, Drive drive) { script_.push_back({time, line, drive}); }
  void at(base::SimTime time, Line line, bool level) { at(time, line, driven(level)); }
  /// The chip changes a line now.
  void put(base::SimTime now, Line line, Drive drive) {
    lines_[line].chip = drive;
    settle(now, line);
  }
  void put_mean(base::SimTime now, Line line, double mean) {
    lines_[line].mean = mean;
    if (lines_[line].averaged) {
      listener_->mean_changed(now, line, mean);
    }
  }
  [[nodiscard]] LineShort short_at(Line line) const { return lines_[line].fault; }

  /// Edges on a line, whoever made them.
  struct Edge {
    base::SimTime time;
    bool level;
  };
  [[nodiscard]] const std::vector<Edge>& edges(Line line) const { return lines_[line].edges; }

  void connect(LineListener& listener) override { listener_ = &listener; }
  void watch_edges(Line /*line*/) override {}
  void watch_mean(Line line) override { lines_[line].averaged = true; }
  [[nodiscard]] bool level(Line line) const override { return lines_[line].level; }
  [[nodiscard]] double mean(Line line) const override { return lines_[line].mean; }
  void drive(base::SimTime now, Line line, Drive drive) override {
    lines_[line].outside = drive;
    settle(now, line);
  }
  void set_short(base::SimTime /*now*/, Line line, LineShort to) override {
    lines_[line].fault = to;
  }
  void attach(const SpiLines& /*lines*/, SpiSlave& /*slave*/) override {}
  void attach(const I2cLines& /*lines*/, mfc::I2cSlave& /*slave*/) override {}
  [[nodiscard]] bool serves(const SpiSlave& /*slave*/) const override { return false; }
  [[nodiscard]] bool serves(const mfc::I2cSlave& /*slave*/) const override { return false; }
  void attach(const StepLines& /*lines*/, StepFollower& /*follower*/) override {}
  [[nodiscard]] std::optional<StepCount> count_steps(const StepFollower& /*follower*/) override {
    return std::nullopt;
  }
  void settle() override {}
  void stop_at_every_event() override {}
  [[nodiscard]] base::SimTime next_event() const override {
    return script_.empty() ? base::SimTime::never() : script_.front().time;
  }
  void advance(base::SimTime now) override {
    while (!script_.empty() && script_.front().time <= now) {
      const Step step = script_.front();
      script_.pop_front();
      put(step.time, step.line, step.drive);
    }
  }

 private:
  struct Step {
    base::SimTime time;
    Line line;
    Drive drive;
  };
  struct LineState {
    Drive chip = Drive::released;
    Drive outside = Drive::released;
    bool level = false;
    double mean = 0.0;
    bool averaged = false;
    LineShort fault = LineShort::none;
    std::vector<Edge> edges;
  };
  void settle(base::SimTime now, Line line) {
    LineState& its = lines_[line];
    const bool level = together(its.chip, its.outside) == Drive::high;
    if (level != its.level) {
      its.level = level;
      its.edges.push_back({now, level});
      listener_->line_changed(now, line, level);
    }
  }

  LineListener* listener_ = nullptr;
  std::array<LineState, kLines> lines_{};
  std::deque<Step> script_;
};

}  // namespace stator::board

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "stator/base/random.hpp"
#include "stator/environment/conditions.hpp"
#include "stator/environment/drives.hpp"
#include "stator/environment/settings.hpp"
#include "stator/environment/task.hpp"

namespace stator::environment {

/// When an axis whose episode is over begins the next one.
enum class Autoreset : std::uint8_t {
  next_step,  ///< with the next action, which is ignored
  same_step,  ///< at once; the last observation is kept apart
  disabled    ///< when reset() is called
};

/// Where a step puts what came of it, one element for each axis; observations with
/// observation_size() numbers each.
struct Outcome {
  std::span<float> observations;
  std::span<double> rewards;
  std::span<bool> terminated;  ///< a limit was passed
  std::span<bool> truncated;   ///< the time is over
  /// The last observations of episodes that are over, for Autoreset::same_step; those of others are
  /// left as they are.
  std::span<float> final_observations{};
};

/// Axes that are to follow targets, for programs that learn to control them: episodes with
/// conditions and targets drawn by chance, observations, rewards and limits. What an axis does
/// depends on its own seeds, conditions and actions only, to the last bit: not on the other axes,
/// nor on how many there are.
class Environments {
 public:
  enum class Step : std::uint8_t {
    done,
    not_a_number,  ///< an action is none; nothing happened
    needs_reset    ///< an axis has not begun or is over and waits for reset(); nothing happened
  };

  /// `axes` of them, at least 1, none of which has begun.
  Environments(const EnvironmentSettings& settings, std::size_t axes, Autoreset autoreset);

  /// Begins an episode with `axis`. With a seed its random numbers begin anew; without one they go
  /// on, from those of seed 0 in the first episode. What is given is not drawn; a target that is
  /// given is held for the whole episode.
  void reset(std::size_t axis, std::optional<std::uint64_t> seed,
             const GivenConditions& given = {});

  /// What the axis sees now.
  void observe(std::size_t axis, std::span<float> observation) const;

  /// Lets each axis do what `actions` say, action_size() numbers each, which are cut to -1..1.
  [[nodiscard]] Step step(std::span<const float> actions, const Outcome& outcome);

  [[nodiscard]] std::size_t size() const { return episodes_.size(); }
  [[nodiscard]] std::size_t action_size() const { return action_size_; }
  [[nodiscard]] std::size_t observation_size() const { return observation_size_; }
  [[nodiscard]] const EnvironmentSettings& settings() const { return settings_; }
  [[nodiscard]] const Scales& scales() const { return scales_; }
  /// Actions until the time of an episode is over.
  [[nodiscard]] int actions_per_episode() const { return actions_per_episode_; }
  /// Of the present episode; its target is the first one.
  [[nodiscard]] const Conditions& conditions(std::size_t axis) const {
    return episodes_[axis].conditions;
  }
  /// What the axis is to follow now: N m, rad/s or revolutions.
  [[nodiscard]] double target(std::size_t axis) const { return episodes_[axis].target; }
  /// In SI units, the position in revolutions.
  [[nodiscard]] Reading reading(std::size_t axis) const { return drives_->read(axis); }

 private:
  struct Episode {
    base::Random random{0};
    Conditions conditions;
    double target = 0.0;
    int actions = 0;        ///< that were done
    int new_target_at = 0;  ///< in actions
    int load_torque_at = 0;
    bool begun = false;
    bool over = true;
  };

  [[nodiscard]] Conditions draw(base::Random& random) const;
  [[nodiscard]] int draw_hold(base::Random& random) const;
  /// Takes over actions, cut to what they may be; false: one is not a number.
  [[nodiscard]] bool take(std::span<const float> actions);
  void set_load_torques();
  void finish(std::size_t axis, const Outcome& outcome);
  [[nodiscard]] std::span<float> row(std::span<float> observations, std::size_t axis) const {
    return observations.subspan(axis * observation_size_, observation_size_);
  }

  EnvironmentSettings settings_;
  Scales scales_;
  Conditions nominal_;
  Judge judge_;
  Autoreset autoreset_;
  std::size_t action_size_;
  std::size_t observation_size_;
  int actions_per_episode_;
  int shortest_hold_;    ///< actions
  int longest_hold_;     ///< actions
  std::size_t waiting_;  ///< axes that need reset()
  std::unique_ptr<Drives> drives_;
  std::vector<Episode> episodes_;
  std::vector<float> actions_;
  std::vector<Reading> readings_;
};

/// The sentence against conditions that are given; empty: they are good.
[[nodiscard]] std::string problem_of(const GivenConditions& given);

}  // namespace stator::environment

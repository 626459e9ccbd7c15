#include "stator/environment/environments.hpp"

#include <algorithm>
#include <cmath>

#include "stator/settings/words.hpp"

namespace stator::environment {

namespace {

/// As many actions of `each` as make up `whole`, at least one.
int actions_in(base::SimDuration whole, base::SimDuration each) {
  const base::SimDuration almost(each.nanoseconds() - 1);
  return static_cast<int>(std::max((whole + almost) / each, std::int64_t{1}));
}

}  // namespace

Environments::Environments(const EnvironmentSettings& settings, std::size_t axes,
                           Autoreset autoreset)
    : settings_(settings),
      scales_(scales_of(settings)),
      nominal_(nominal_conditions(settings)),
      judge_(settings, scales_),
      autoreset_(autoreset),
      action_size_(environment::action_size(settings.plant, settings.action)),
      observation_size_(observation_names(settings.task).size()),
      actions_per_episode_(actions_in(settings.episode, settings.step * settings.steps_per_action)),
      shortest_hold_(actions_in(settings.shortest_hold, settings.step * settings.steps_per_action)),
      longest_hold_(actions_in(settings.longest_hold, settings.step * settings.steps_per_action)),
      waiting_(axes),
      drives_(make_drives(settings, scales_, axes)),
      episodes_(axes),
      actions_(axes * action_size_),
      readings_(axes) {}

Conditions Environments::draw(base::Random& random) const {
  const Randomisation& spans = settings_.randomisation;
  Conditions drawn;
  drawn.inertia = nominal_.inertia * spans.inertia.draw(random);
  drawn.viscous_friction = nominal_.viscous_friction * spans.viscous_friction.draw(random);
  drawn.coulomb_friction = nominal_.coulomb_friction * spans.coulomb_friction.draw(random);
  drawn.resistance = nominal_.resistance * spans.resistance.draw(random);
  drawn.inductance = nominal_.inductance * spans.inductance.draw(random);
  drawn.flux_linkage = nominal_.flux_linkage * spans.flux_linkage.draw(random);
  drawn.supply_voltage = nominal_.supply_voltage * spans.supply_voltage.draw(random);
  drawn.load_torque = scales_.rated_torque * spans.load_torque.draw(random);
  drawn.load_torque_at = settings_.episode.seconds() * random.uniform();
  drawn.initial_position = spans.initial_position.draw(random);
  drawn.initial_speed = scales_.rated_speed * spans.initial_speed.draw(random);
  drawn.target = Span{-scales_.largest_target, scales_.largest_target}.draw(random);
  return drawn;
}

int Environments::draw_hold(base::Random& random) const {
  const int choices = longest_hold_ - shortest_hold_ + 1;
  return shortest_hold_ + static_cast<int>(random.below(static_cast<std::uint64_t>(choices)));
}

void Environments::reset(std::size_t axis, std::optional<std::uint64_t> seed,
                         const GivenConditions& given) {
  Episode& episode = episodes_[axis];
  if (seed) {
    episode.random = base::Random(*seed);
  }
  // All are drawn, so that one that is given leaves the others as they would be.
  episode.conditions = draw(episode.random);
  const int hold = draw_hold(episode.random);
  for (std::size_t n = 0; n < kConditions; ++n) {
    if (given[n]) {
      episode.conditions.*kConditionNames[n].member = *given[n];
    }
  }
  episode.target = episode.conditions.target;
  episode.new_target_at = given[kTargetCondition] ? actions_per_episode_ : hold;
  const double each = (settings_.step * settings_.steps_per_action).seconds();
  // The earliest action that begins at that time or later.
  episode.load_torque_at = static_cast<int>(
      std::ceil(std::min(episode.conditions.load_torque_at / each, 1.0 + actions_per_episode_)));
  episode.actions = 0;
  if (!episode.begun || (episode.over && autoreset_ == Autoreset::disabled)) {
    --waiting_;
  }
  episode.begun = true;
  episode.over = false;
  drives_->restart(axis, episode.conditions);
}

void Environments::observe(std::size_t axis, std::span<float> observation) const {
  judge_.observe(drives_->read(axis), episodes_[axis].target, observation);
}

bool Environments::take(std::span<const float> actions) {
  bool numbers = true;
  for (std::size_t n = 0; n < actions.size(); ++n) {
    const float action = actions[n];
    numbers = numbers && action == action;
    actions_[n] = std::min(std::max(action, -1.0F), 1.0F);
  }
  return numbers;
}

void Environments::set_load_torques() {
  for (std::size_t axis = 0; axis < episodes_.size(); ++axis) {
    const Episode& episode = episodes_[axis];
    if (episode.actions == episode.load_torque_at) {
      drives_->set_load_torque(axis, episode.conditions.load_torque);
    }
  }
}

Environments::Step Environments::step(std::span<const float> actions, const Outcome& outcome) {
  if (waiting_ != 0) {
    return Step::needs_reset;
  }
  if (!take(actions)) {
    return Step::not_a_number;
  }
  set_load_torques();
  drives_->act(actions_);
  drives_->pass();
  drives_->read(readings_);
  for (std::size_t axis = 0; axis < episodes_.size(); ++axis) {
    Episode& episode = episodes_[axis];
    const std::span<float> observation = row(outcome.observations, axis);
    if (episode.over) {
      reset(axis, std::nullopt);
      observe(axis, observation);
      outcome.rewards[axis] = 0.0;
      outcome.terminated[axis] = false;
      outcome.truncated[axis] = false;
      continue;
    }
    const Reading& reading = readings_[axis];
    ++episode.actions;
    outcome.rewards[axis] =
        judge_.reward(reading, episode.target,
                      std::span<const float>(actions_).subspan(axis * action_size_, action_size_));
    outcome.terminated[axis] = judge_.ends(reading);
    outcome.truncated[axis] = !outcome.terminated[axis] && episode.actions >= actions_per_episode_;
    if (episode.actions == episode.new_target_at) {
      episode.target = Span{-scales_.largest_target, scales_.largest_target}.draw(episode.random);
      episode.new_target_at += draw_hold(episode.random);
    }
    judge_.observe(reading, episode.target, observation);
    if (outcome.terminated[axis] || outcome.truncated[axis]) {
      finish(axis, outcome);
    }
  }
  return Step::done;
}

void Environments::finish(std::size_t axis, const Outcome& outcome) {
  episodes_[axis].over = true;
  if (autoreset_ == Autoreset::disabled) {
    ++waiting_;
  }
  if (autoreset_ == Autoreset::same_step) {
    const std::span<float> observation = row(outcome.observations, axis);
    if (!outcome.final_observations.empty()) {
      std::ranges::copy(observation, row(outcome.final_observations, axis).begin());
    }
    reset(axis, std::nullopt);
    observe(axis, observation);
  }
}

std::string problem_of(const GivenConditions& given) {
  for (std::size_t n = 0; n < kConditions; ++n) {
    const ConditionName& condition = kConditionNames[n];
    if (given[n] && !(*given[n] >= condition.minimum && *given[n] <= condition.maximum)) {
      return '"' + std::string(condition.name) + "\" must be from " +
             settings::number_text(condition.minimum, 6) + " to " +
             settings::number_text(condition.maximum, 6) + ", not " +
             settings::number_text(*given[n], 6);
    }
  }
  return {};
}

}  // namespace stator::environment

#!/usr/bin/env python3
"""Learns the gains of a velocity loop: the cross-entropy method on a thousand axes at once.

A velocity loop has two gains, proportional and integral. Candidates are drawn around a mean in the logarithms of the
gains, each controls axes with different loads, motors, supplies and targets for an episode, and the best of them make
the next mean and spread. Equal seeds learn equal gains.

    python learn_a_tuning.py --plot tuning.svg
"""

import argparse
import sys
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from stator.gymnasium import AxisEnv, AxisVectorEnv

Doubles = NDArray[np.float64]

CANDIDATES, ELITE, SCENARIOS = 32, 8, 32
TIMID = np.log([1.0, 0.005])
"""Where learning begins: the logarithms of gains that work, but slowly."""
TESTED = 10_000_000
"""Seeds of the scenarios that judge what was learnt, which learning never sees."""


class VelocityLoop:
    """PI controllers of many axes; an action of 1 is the drive's full current, a speed of 1 its limit."""

    def __init__(self, gains: Doubles) -> None:
        """`gains` has a row for each axis: proportional, and integral per action."""
        self._proportional, self._integral = gains.T
        self._sum = np.zeros(len(gains))

    def act(self, observations: NDArray[np.float32]) -> NDArray[np.float32]:
        error = observations[:, 0].astype(np.float64) - observations[:, 1]
        wanted = self._proportional * error + self._sum
        # The sum stands while the current is at its limit and would grow beyond it.
        grows = (np.abs(wanted) < 1.0) | (np.sign(error) != np.sign(wanted))
        self._sum += np.where(grows, self._integral * error, 0.0)
        actions: NDArray[np.float32] = np.clip(wanted, -1.0, 1.0).astype(np.float32)
        return actions


class Trials:
    """Episodes of all candidates in the same scenarios."""

    def __init__(self, plant: str) -> None:
        self._axes = AxisVectorEnv(CANDIDATES * SCENARIOS, plant=plant, task="velocity", copy=False)
        self._actions = self._axes.actions_per_episode

    def rewards(self, logarithms: Doubles, first_seed: int) -> Doubles:
        """The mean reward per action of each row of gains; an axis that passes a limit earns nothing more."""
        loop = VelocityLoop(np.repeat(np.exp(logarithms), SCENARIOS, axis=0))
        seeds = [first_seed + n for _ in range(CANDIDATES) for n in range(SCENARIOS)]
        observations, _ = self._axes.reset(seed=seeds)
        total: Doubles = np.zeros(CANDIDATES * SCENARIOS)
        running = np.ones(CANDIDATES * SCENARIOS, np.bool_)
        for _ in range(self._actions):
            observations, rewards, terminated, _, _ = self._axes.step(loop.act(observations))
            total += rewards * running
            running &= ~terminated
        means: Doubles = total.reshape(CANDIDATES, SCENARIOS).mean(axis=1) / self._actions
        return means


@dataclass
class Learnt:
    """What came of it."""

    gains: Doubles
    before: float
    """Mean reward of the first gains in scenarios that learning did not see."""
    after: float
    """The same of the learnt ones."""
    history: list[tuple[float, float, float]] = field(default_factory=list)
    """Lowest, mean and highest reward of each generation."""


def learn(plant: str = "servo", generations: int = 12, seed: int = 1) -> Learnt:
    """The cross-entropy method."""
    random = np.random.default_rng(seed)
    trials = Trials(plant)
    mean, spread = TIMID.copy(), np.array([1.0, 1.0])
    history = []
    for generation in range(generations):
        candidates = mean + spread * random.standard_normal((CANDIDATES, 2))
        rewards = trials.rewards(candidates, SCENARIOS * (generation + 1000 * seed))
        best = candidates[np.argsort(rewards)[-ELITE:]]
        # Half of the old spread stays: one lucky generation does not end the search.
        mean, spread = best.mean(axis=0), 0.5 * spread + 0.5 * best.std(axis=0)
        history.append((float(rewards.min()), float(rewards.mean()), float(rewards.max())))
    judged = trials.rewards(np.tile([TIMID, mean], (CANDIDATES // 2, 1)), TESTED)
    return Learnt(np.exp(mean), float(judged[0]), float(judged[1]), history)


def step_response(plant: str, gains: Doubles) -> tuple[Doubles, Doubles, Doubles]:
    """Times (s), target and speed (rad/s) of one axis that starts and meets a load on its way."""
    axis = AxisEnv(plant=plant, task="velocity", randomise=False)
    limits = axis.limits
    target = 0.4 * limits["rated_speed"]
    load = {"load_torque": -0.4 * limits["rated_torque"], "load_torque_at": 0.12}
    observation, _ = axis.reset(seed=0, options={"target": target, **load})
    loop = VelocityLoop(gains[np.newaxis])
    speeds = [0.0]
    truncated = terminated = False
    while not (truncated or terminated):
        observation, _, terminated, truncated, _ = axis.step(loop.act(observation[np.newaxis])[0])
        speeds.append(axis.state()["speed"])
    times: Doubles = limits["seconds_per_action"] * np.arange(len(speeds), dtype=np.float64)
    return times, np.full(len(speeds), target, np.float64), np.array(speeds, np.float64)


def plot(learnt: Learnt, plant: str, file: Path) -> None:
    """Rewards over generations, and how the axis answers before and after."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "stator"  # the same file for the same numbers
    from matplotlib import pyplot

    figure, (left, right) = pyplot.subplots(1, 2, figsize=(11, 4), layout="constrained")
    lowest, mean, highest = np.array(learnt.history).T
    generations = np.arange(1, len(mean) + 1)
    left.fill_between(generations, lowest, highest, alpha=0.25, label="of all candidates")
    left.plot(generations, mean, label="mean")
    left.axhline(learnt.before, color="grey", linestyle=":", label=f"first gains, other scenarios: {learnt.before:.3f}")
    left.axhline(learnt.after, color="black", linestyle="--", label=f"learnt gains, the same: {learnt.after:.3f}")
    left.set(xlabel="generation", ylabel="mean reward per action", title="Learning")
    left.legend()
    for name, gains in (("first gains", np.exp(TIMID)), ("learnt gains", learnt.gains)):
        times, target, speed = step_response(plant, gains)
        right.plot(1e3 * times, speed, label=name)
    right.plot(1e3 * times, target, color="grey", linestyle=":", label="target")
    right.set(xlabel="ms", ylabel="rad/s", title="A start, and a load at 120 ms")
    right.legend()
    figure.savefig(file, metadata={"Date": None} if file.suffix == ".svg" else None)
    pyplot.close(figure)


def main(arguments: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--plant", choices=("servo", "stepper"), default="servo")
    parser.add_argument("--generations", type=int, default=12)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--plot", type=Path, metavar="FILE", help="writes a plot, .svg, .png or .pdf (matplotlib)")
    options = parser.parse_args(arguments)
    learnt = learn(options.plant, options.generations, options.seed)
    proportional, integral = learnt.gains
    print(f"gains: proportional {proportional:.3f}, integral {integral:.4f} per action")
    print(f"mean reward in scenarios it has not seen: {learnt.before:.4f} before, {learnt.after:.4f} after")
    if options.plot:
        plot(learnt, options.plant, options.plot)
    return 0 if learnt.after > learnt.before else 1


if __name__ == "__main__":
    sys.exit(main())

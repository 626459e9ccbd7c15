"""The environments of Gymnasium: one axis, and many side by side."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, SupportsFloat, TypedDict, Unpack, cast

import gymnasium
import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.spaces import Box, Space
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import ArrayLike, NDArray

from stator._native import AxisEnvironments

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Truths = NDArray[np.bool_]
Info = dict[str, Any]

_DURATIONS = ("step", "episode", "shortest_hold", "longest_hold")
_AUTORESET = {
    AutoresetMode.NEXT_STEP: "next-step",
    AutoresetMode.SAME_STEP: "same-step",
    AutoresetMode.DISABLED: "disabled",
}
_WHOLE_SEED = 2**64


class Options(TypedDict, total=False):
    """What environments can be made with; whatever is left out is as usual for plant and task."""

    action: str
    """What the numbers of an action are: "current" (q), "voltage" (d, q) or "duty" (each phase)."""
    precision: str
    """"double" or "single": what the lanes of servo axes are computed with."""
    axis: Mapping[str, object]
    """Motor, load, supply and so on: the keys of an axis in a rack file."""
    step: float | str
    """Of plant and current loop, s or a text with its unit, "1us" to "1ms"."""
    steps_per_action: int
    """Steps of the plant for which an action holds, 1 to 100,000."""
    episode: float | str
    """Time after which an episode is truncated, s or a text with its unit."""
    shortest_hold: float | str
    """A target is held for at least this time, s or a text with its unit."""
    longest_hold: float | str
    """A target is held for at most this time, s or a text with its unit."""
    current_limit: float
    """Current of an action of 1, A (amplitude)."""
    trip_current: float
    """Current beyond which the episode ends, A."""
    speed_limit: float
    """Speed beyond which the episode ends, rad/s."""
    travel_limit: float
    """Distance from 0 beyond which the episode ends where a position is controlled, revolutions."""
    largest_target: float
    """Targets are drawn between this and its negative: N m, rad/s or revolutions."""
    bandwidth: float
    """Of the current loop of a servo drive, rad/s; at most a fifth of 1 / step."""
    effort_weight: float
    """What the mean square of an action takes from the reward."""
    randomise: bool | Mapping[str, tuple[float, float] | Mapping[str, float]]
    """Spans that conditions are drawn from, by name; False: nothing differs between episodes."""


def _table(plant: str, task: str, options: Options) -> dict[str, object]:
    """The options as the native module reads them: durations as texts, spans as tables."""
    table: dict[str, object] = {"plant": plant, "task": task, **options}
    for name in _DURATIONS:
        value = table.get(name)
        if isinstance(value, SupportsFloat) and not isinstance(value, str):
            table[name] = f"{round(float(value) * 1e9)}ns"
    randomise = options.get("randomise")
    if isinstance(randomise, Mapping):
        table["randomise"] = {
            name: span if isinstance(span, Mapping) else {"low": span[0], "high": span[1]}
            for name, span in randomise.items()
        }
    return table


def _box(*shape: int) -> Space[Floats]:
    return cast(Space[Floats], Box(-1.0, 1.0, shape, np.float32))


class AxisEnv(gymnasium.Env[Floats, Floats]):
    """One axis whose torque, velocity or position is to follow a target.

    Actions and observations are arrays of float32 in -1..1; `action_names` and `observation_names` say what their numbers
    are, `limits` what 1 stands for. An episode is terminated by a limit of current, speed or travel and truncated
    when its time is over.
    """

    metadata: dict[str, Any] = {"render_modes": []}

    def __init__(
        self, *, plant: str = "servo", task: str = "velocity", render_mode: None = None, **options: Unpack[Options]
    ) -> None:
        """Makes the axis; `plant` is "servo" or "stepper", `task` "torque", "velocity" or "position".

        Raises ValueError with a sentence for each option that is wrong.
        """
        self.render_mode = render_mode
        self._axis = AxisEnvironments(_table(plant, task, options), 1, "disabled")
        self._step = self._axis.step_one
        self._size = len(self._axis.observation_names)
        self.action_space = _box(len(self._axis.action_names))
        self.observation_space = _box(self._size)
        self._seeded = False

    @property
    def action_names(self) -> list[str]:
        """What the numbers of an action are."""
        return self._axis.action_names

    @property
    def observation_names(self) -> list[str]:
        """What the numbers of an observation are."""
        return self._axis.observation_names

    @property
    def limits(self) -> dict[str, float]:
        """What 1 stands for in actions and observations and where episodes end, SI units and revolutions."""
        return self._axis.limits

    @property
    def actions_per_episode(self) -> int:
        """Actions after which an episode is truncated."""
        return self._axis.actions_per_episode

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Floats, Info]:
        """Begins an episode.

        With `seed` its random numbers begin anew, so that all that follows has the same bits each time. `options` has
        conditions that are not drawn, by name: the same ones that the info returned has, in SI units and
        revolutions. A target that is given is held for the whole episode.
        """
        super().reset(seed=seed)
        observation = np.empty(self._size, np.float32)
        if seed is None and not self._seeded:
            seed = int(self.np_random.integers(2**63))
        seeds = None if seed is None else np.array([seed % _WHOLE_SEED], np.uint64)
        given = {name: np.array([value], np.float64) for name, value in (options or {}).items()}
        self._axis.reset(observation, seeds, None, given)
        self._seeded = True
        conditions = np.empty(len(self._axis.condition_names), np.float64)
        self._axis.read_conditions(conditions)
        return observation, dict(zip(self._axis.condition_names, conditions.tolist(), strict=True))

    def step(self, action: Floats) -> tuple[Floats, float, bool, bool, Info]:
        """Lets the axis do what `action` says for the time of one action.

        Raises ValueError for an action that has another shape or is not a number, ResetNeeded if the episode is over.
        """
        observation = np.empty(self._size, np.float32)
        outcome = self._step(np.asarray(action, np.float32, "C"), observation)
        if outcome is None:
            raise ResetNeeded("the episode is over or has not begun; call reset()")
        reward, terminated, truncated = outcome
        return observation, reward, terminated, truncated, {}

    def state(self) -> dict[str, float]:
        """Target, speed, position, currents and voltage of the supply now, in SI units and revolutions."""
        numbers = np.empty(len(self._axis.state_names), np.float64)
        self._axis.read_states(numbers)
        return dict(zip(self._axis.state_names, numbers.tolist(), strict=True))


class AxisVectorEnv(VectorEnv[Floats, Floats, NDArray[Any]]):
    """Many axes side by side, each as an AxisEnv; those of a servo are computed in the lanes of vectors.

    An axis with the seed s has, action by action, the bits of an AxisEnv with the seed s. The call of step() is
    one call for all axes, in which other threads of the interpreter run.
    """

    def __init__(
        self,
        num_envs: int = 1,
        *,
        plant: str = "servo",
        task: str = "velocity",
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        copy: bool = True,
        **options: Unpack[Options],
    ) -> None:
        """Makes `num_envs` axes; the other arguments are those of AxisEnv.

        `autoreset_mode` is Gymnasium's: when an axis whose episode is over begins the next. With `copy` false each step
        fills the same arrays, so that what a step returned changes with the next one.

        Raises ValueError with a sentence for each option that is wrong.
        """
        mode = autoreset_mode if isinstance(autoreset_mode, AutoresetMode) else AutoresetMode(autoreset_mode)
        self.metadata = {"render_modes": [], "autoreset_mode": mode}
        self.num_envs = num_envs
        self._axes = AxisEnvironments(_table(plant, task, options), num_envs, _AUTORESET[mode])
        self._same_step = mode is AutoresetMode.SAME_STEP
        size = len(self._axes.observation_names)
        actions = len(self._axes.action_names)
        self.single_action_space = _box(actions)
        self.single_observation_space = _box(size)
        self.action_space = _box(num_envs, actions)
        self.observation_space = _box(num_envs, size)
        self._shape = (num_envs, size)
        self._copy = copy
        self._arrays = self._new_arrays()
        self._final = np.zeros(self._shape, np.float32)
        self._seeded = np.zeros(num_envs, np.bool_)

    @property
    def action_names(self) -> list[str]:
        """What the numbers of an action are."""
        return self._axes.action_names

    @property
    def observation_names(self) -> list[str]:
        """What the numbers of an observation are."""
        return self._axes.observation_names

    @property
    def limits(self) -> dict[str, float]:
        """What 1 stands for in actions and observations and where episodes end, SI units and revolutions."""
        return self._axes.limits

    @property
    def actions_per_episode(self) -> int:
        """Actions after which an episode is truncated."""
        return self._axes.actions_per_episode

    def _new_arrays(self) -> tuple[Floats, Doubles, Truths, Truths]:
        count = self.num_envs
        return (
            np.empty(self._shape, np.float32),
            np.empty(count, np.float64),
            np.empty(count, np.bool_),
            np.empty(count, np.bool_),
        )

    def _seeds(self, seed: int | Sequence[int | None] | None, begins: Truths) -> NDArray[np.uint64] | None:
        """The seed of each axis; None: those that begin go on with their random numbers."""
        if seed is None:
            if self._seeded[begins].all():
                return None
            seed = int(self.np_random.integers(2**63))
        if isinstance(seed, (int, np.integer)):
            seed = [int(seed) + n for n in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise ValueError(f"there are {self.num_envs} axes and {len(seed)} seeds")
        numbers = [int(self.np_random.integers(2**63)) if each is None else each % _WHOLE_SEED for each in seed]
        return np.array(numbers, np.uint64)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Floats, Info]:
        """Begins an episode with each axis, or with those that the array `options["reset_mask"]` names.

        A seed s that is a number makes the seeds s, s + 1 and so on. The other options are conditions that are not
        drawn, by name, with a number for all axes or one for each. The info has the conditions of all
        axes.
        """
        super().reset(seed=seed if isinstance(seed, int) else None)
        options = dict(options or {})
        mask = options.pop("reset_mask", None)
        begins = np.ones(self.num_envs, np.bool_) if mask is None else np.ascontiguousarray(mask)
        if begins.dtype != np.bool_ or begins.shape != (self.num_envs,):
            raise ValueError(f"reset_mask is an array of {self.num_envs} truth values")
        given = {name: self._each(value) for name, value in options.items()}
        observations = np.empty(self._shape, np.float32)
        self._axes.reset(observations, self._seeds(seed, begins), begins, given)
        self._seeded |= begins
        info: Info = {}
        for name, values in self.conditions().items():
            info[name] = values
            info[f"_{name}"] = begins.copy()
        return observations, info

    def _each(self, value: ArrayLike) -> Doubles:
        return np.ascontiguousarray(np.broadcast_to(np.asarray(value, np.float64), (self.num_envs,)))

    def step(self, actions: Floats) -> tuple[Floats, Doubles, Truths, Truths, Info]:
        """Lets all axes do what their rows of `actions` say for the time of one action.

        With AutoresetMode.SAME_STEP the info has the last observations of the episodes that are over as `final_obs`.

        Raises ValueError for actions that have another shape or are not numbers, ResetNeeded if an axis waits for
        reset().
        """
        observations, rewards, terminated, truncated = self._new_arrays() if self._copy else self._arrays
        final = self._final if self._same_step else None
        numbers = np.asarray(actions, np.float32, "C")
        if not self._axes.step(numbers, observations, rewards, terminated, truncated, final):
            raise ResetNeeded("an episode is over or has not begun; call reset()")
        return (
            observations,
            rewards,
            terminated,
            truncated,
            self._ended(terminated | truncated) if self._same_step else {},
        )

    def _ended(self, over: Truths) -> Info:
        """The info of axes that began the next episode in the same step."""
        if not over.any():
            return {}
        last = np.full(self.num_envs, None, object)
        for axis in np.flatnonzero(over):
            last[axis] = self._final[axis].copy()
        return {"final_obs": last, "_final_obs": over, "final_info": {}, "_final_info": over.copy()}

    def conditions(self) -> dict[str, Doubles]:
        """The conditions of the episode of each axis by name, in SI units and revolutions."""
        return self._columns(self._axes.condition_names, self._axes.read_conditions)

    def states(self) -> dict[str, Doubles]:
        """Target, speed, position, currents and voltage of the supply of each axis, in SI units and revolutions."""
        return self._columns(self._axes.state_names, self._axes.read_states)

    def _columns(self, names: list[str], read: Callable[[Doubles], None]) -> dict[str, Doubles]:
        numbers = np.empty((self.num_envs, len(names)), np.float64)
        read(numbers)
        return {name: numbers[:, n].copy() for n, name in enumerate(names)}

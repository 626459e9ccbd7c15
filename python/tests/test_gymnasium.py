"""The environments of Gymnasium: its checker, seeds and bits, options, episodes, threads, and a learner."""

import importlib.util
import subprocess
import sys
import threading
import time
import warnings
from pathlib import Path
from types import ModuleType
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium.error import ResetNeeded
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode

import stator.gymnasium
from stator.gymnasium import IDS, AxisEnv, AxisVectorEnv

EXAMPLES = Path(__file__).parent.parent / "examples"
SHORT = {"steps_per_action": 2, "episode": 0.002, "shortest_hold": "200us", "longest_hold": "600us"}
"""Episodes of 50 actions of a servo, 20 of a stepper, in which targets change."""


def one(identity: str, **options: Any) -> AxisEnv:
    axis = gymnasium.make(identity, **options).unwrapped
    assert isinstance(axis, AxisEnv)
    return axis


def many(identity: str, axes: int, **options: Any) -> AxisVectorEnv:
    made = gymnasium.make_vec(identity, num_envs=axes, **options)
    assert isinstance(made, AxisVectorEnv)
    return made


@pytest.mark.parametrize("identity", IDS)
def test_gymnasiums_checker_has_nothing_to_say(identity: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        check_env(one(identity))


def test_the_module_is_imported_where_the_name_says_so() -> None:
    program = "import gymnasium; print(gymnasium.make('stator.gymnasium:stator/ServoTorque-v0').spec.id)"
    told = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert told.stdout == "stator/ServoTorque-v0\n"
    stator.gymnasium.register()  # once more changes nothing, and warns of nothing


@pytest.mark.parametrize("identity", IDS)
def test_arrays_have_the_shapes_and_types_that_the_spaces_say(identity: str) -> None:
    axes = many(identity, 5)
    observations, info = axes.reset(seed=1)
    assert axes.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    assert observations in axes.observation_space
    assert axes.single_observation_space.shape == (len(axes.observation_names),)
    assert axes.single_action_space.shape == (len(axes.action_names),)
    assert info["target"].shape == (5,) and info["_target"].all()
    observations, rewards, terminated, truncated, info = axes.step(axes.action_space.sample())
    assert observations in axes.observation_space
    assert [array.dtype.kind + str(array.dtype.itemsize) for array in (rewards, terminated, truncated)] == [
        "f8",
        "b1",
        "b1",
    ]
    assert rewards.shape == terminated.shape == truncated.shape == (5,)
    assert info == {}


def rollout(axis: AxisEnv, seed: int, actions: Any) -> list[Any]:
    """All that comes of actions, with a reset whenever an episode is over."""
    seen: list[Any] = [axis.reset(seed=seed)[0].tobytes()]
    over = False
    for action in actions:
        if over:
            seen.append((axis.reset()[0].tobytes(), 0.0, False, False))
            over = False
            continue
        observation, reward, terminated, truncated, _ = axis.step(action)
        seen.append((observation.tobytes(), reward, terminated, truncated))
        over = terminated or truncated
    return seen


@pytest.mark.parametrize("identity", IDS)
def test_equal_seeds_have_equal_bits_alone_and_among_others(identity: str) -> None:
    axes = many(identity, 9, **SHORT)
    actions = np.random.default_rng(1).uniform(-1.0, 1.0, (150, *(axes.action_space.shape or ()))).astype(np.float32)
    observations, _ = axes.reset(seed=40)
    lanes: list[list[Any]] = [[observation.tobytes()] for observation in observations]
    for each in actions:
        observations, rewards, terminated, truncated, _ = axes.step(each)
        for n, lane in enumerate(lanes):
            lane.append((observations[n].tobytes(), rewards[n], terminated[n], truncated[n]))
    alone = one(identity, **SHORT)
    for n, lane in enumerate(lanes):
        expected = rollout(alone, 40 + n, actions[:, n])
        assert lane == expected
        assert sum(step[3] for step in expected[1:]) >= 2, "no episode came to its end"
    assert rollout(alone, 40, actions[:, 0]) == lanes[0]
    assert rollout(alone, 41, actions[:, 0]) != lanes[0]


def test_without_a_seed_episodes_differ() -> None:
    first, second = (one("stator/ServoVelocity-v0").reset()[1] for _ in range(2))
    assert first != second
    info = many("stator/ServoVelocity-v0", 64).reset()[1]
    assert len(set(info["inertia"])) == 64


def test_the_conditions_of_an_episode_make_it_again() -> None:
    axis = one("stator/ServoVelocity-v0")
    axis.reset(seed=3)
    conditions = axis.reset()[1]
    actions = np.random.default_rng(2).uniform(-1.0, 1.0, (60, 1)).astype(np.float32)
    first = [axis.step(action)[0].tobytes() for action in actions]
    assert axis.reset(seed=99, options=conditions)[1] == conditions
    assert [axis.step(action)[0].tobytes() for action in actions] == first

    axes = many("stator/ServoVelocity-v0", 3)
    info = axes.reset(seed=1, options={"inertia": 3e-5, "load_torque": [0.0, 0.01, 0.02]})[1]
    assert info["inertia"].tolist() == [3e-5] * 3
    assert info["load_torque"].tolist() == [0.0, 0.01, 0.02]


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"mass": 1.0}, '"mass" is no condition'),
        ({"resistance": 0.0}, '"resistance" must be from 0.001 to 1000, not 0'),
        ({"inertia": float("nan")}, '"inertia" must be from 0 to 10'),
    ],
)
def test_conditions_that_cannot_be_are_refused(options: dict[str, float], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        one("stator/ServoVelocity-v0").reset(options=options)


def test_an_axis_is_described_as_in_a_rack_file() -> None:
    axis = one(
        "stator/ServoVelocity-v0",
        axis={"motor": "EC45-flat-70W", "supply_voltage": 36.0, "load": {"inertia": 5e-5, "constant_torque": -0.01}},
        randomise={"inertia": (1.0, 1.0), "coulomb_friction": {"low": 1.0, "high": 3.0}},
        step=50e-6,
        steps_per_action=4,
        episode="10 ms",
    )
    assert axis.limits["supply_voltage"] == 36.0
    assert axis.limits["seconds_per_action"] == pytest.approx(200e-6)
    assert axis.actions_per_episode == 50
    assert axis.reset(seed=1)[1]["inertia"] == 5e-5
    heavy = one("stator/StepperPosition-v0", axis={"motor": "QSH5718-55-30-098"}, randomise=False)
    assert heavy.reset(seed=1)[1]["load_torque"] == 0.0


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        ({"axis": {"motor": "nothing"}}, '"motor"'),
        ({"frame_skip": 4}, '"frame_skip"'),
        ({"steps_per_action": 0}, '"steps_per_action"'),
        ({"action": "torque"}, '"action"'),
        ({"shortest_hold": 2.0}, '"longest_hold" must not be below "shortest_hold"'),
        ({"randomise": {"gravity": (0.0, 1.0)}}, '"gravity"'),
        ({"step": 1.0}, '"step"'),
    ],
)
def test_options_that_are_wrong_are_refused_with_a_sentence(options: dict[str, Any], sentence: str) -> None:
    with pytest.raises(ValueError, match=sentence):
        AxisEnv(plant="servo", task="velocity", **options)


def test_all_that_is_wrong_is_told_at_once() -> None:
    with pytest.raises(ValueError, match="(?s)steps_per_action.*effort_weight"):
        AxisEnv(steps_per_action=0, effort_weight=-1.0)


def test_actions_that_are_none_are_refused_and_change_nothing() -> None:
    axis = one("stator/ServoTorque-v0")
    axis.reset(seed=1)
    before = axis.state()
    with pytest.raises(ValueError, match="not a number"):
        axis.step(np.array([0.0, np.nan], np.float32))
    with pytest.raises(ValueError, match="action: 2 numbers are expected, 1 are there"):
        axis.step(np.zeros(1, np.float32))
    assert axis.state() == before
    axes = many("stator/ServoTorque-v0", 2)
    axes.reset(seed=1)
    with pytest.raises(ValueError, match="actions: 4 numbers are expected, 2 are there"):
        axes.step(np.zeros((1, 2), np.float32))


def test_doubles_lists_and_arrays_in_other_order_are_actions_too() -> None:
    axes = many("stator/ServoTorque-v0", 3)
    plain = np.linspace(-0.5, 0.5, 6, dtype=np.float32).reshape(3, 2)
    results = []
    for actions in (plain, plain.astype(np.float64), plain.tolist(), np.asfortranarray(plain)):
        axes.reset(seed=1)
        results.append(axes.step(actions)[0].tobytes())  # type: ignore[arg-type]
    assert len(set(results)) == 1


def test_an_episode_that_is_over_needs_a_reset() -> None:
    axis = one("stator/StepperTorque-v0", episode=0.0005)
    nothing = np.zeros(2, np.float32)
    with pytest.raises(ResetNeeded):
        axis.step(nothing)
    axis.reset(seed=1)
    ends = [axis.step(nothing)[3] for _ in range(10)]
    assert ends == [False] * 9 + [True]
    with pytest.raises(ResetNeeded):
        axis.step(nothing)


def test_with_same_step_the_last_observations_are_in_the_info() -> None:
    options = {"steps_per_action": 1, "episode": 0.0002}
    axes = many("stator/ServoTorque-v0", 3, autoreset_mode=AutoresetMode.SAME_STEP, **options)
    alone = one("stator/ServoTorque-v0", **options)
    first, _ = axes.reset(seed=5)
    alone.reset(seed=6)
    actions = np.full((3, 2), 0.1, np.float32)
    for _ in range(9):
        assert axes.step(actions)[4] == {}
        alone.step(actions[1])
    observations, _, _, truncated, info = axes.step(actions)
    last = alone.step(actions[1])[0]
    assert truncated.all() and info["_final_obs"].all()
    assert np.array_equal(info["final_obs"][1], last)
    assert np.array_equal(observations[1], alone.reset()[0])
    assert not np.array_equal(observations, first)


def test_without_autoreset_a_mask_says_which_axes_begin_anew() -> None:
    axes = many("stator/ServoVelocity-v0", 4, autoreset_mode="Disabled", speed_limit=20.0, randomise=False)
    observations = axes.reset(seed=1, options={"target": 0.0})[0]
    actions = np.array([[1.0], [0.0], [0.0], [1.0]], np.float32)
    terminated = np.zeros(4, np.bool_)
    while not terminated.any():
        observations, _, terminated, _, _ = axes.step(actions)
    assert terminated.tolist() == [True, False, False, True]
    with pytest.raises(ResetNeeded):
        axes.step(actions)
    again, info = axes.reset(options={"reset_mask": terminated})
    assert info["_target"].tolist() == terminated.tolist()
    assert np.array_equal(again[1:3], observations[1:3])
    assert again[0, 1] == again[3, 1] == 0.0, "the speed"
    assert not axes.step(actions)[2].any()
    with pytest.raises(ValueError, match="reset_mask is an array of 4 truth values"):
        axes.reset(options={"reset_mask": [True, False]})


def test_arrays_are_new_unless_the_same_ones_are_asked_for() -> None:
    for copy in (True, False):
        axes = many("stator/ServoVelocity-v0", 4, copy=copy)
        axes.reset(seed=1)
        actions = np.full((4, 1), 0.5, np.float32)
        first, second = axes.step(actions), axes.step(actions)
        for before, after in zip(first[:4], second[:4], strict=True):
            assert np.shares_memory(before, after) is not copy


def test_the_state_is_what_observations_show_in_si_units() -> None:
    axis = one("stator/ServoVelocity-v0")
    _, conditions = axis.reset(seed=2)
    observation = np.zeros(0, np.float32)
    for _ in range(10):
        observation = axis.step(np.array([0.4], np.float32))[0]
    named = dict(zip(axis.observation_names, observation.tolist(), strict=True))
    state, limits = axis.state(), axis.limits
    assert state["target"] == conditions["target"]
    assert named["target_speed"] == pytest.approx(state["target"] / limits["speed_limit"], abs=1e-6)
    assert named["speed"] == pytest.approx(state["speed"] / limits["speed_limit"], abs=1e-6)
    assert state["quadrature_current"] == pytest.approx(0.4 * limits["current"], rel=0.1)
    assert named["supply_voltage"] == pytest.approx(state["supply_voltage"] / limits["supply_voltage"] - 1, abs=1e-6)


def test_other_threads_run_while_axes_are_stepped() -> None:
    axes = many("stator/ServoVelocity-v0", 256, steps_per_action=200, episode=1000.0)
    axes.reset(seed=1)
    actions = np.full((256, 1), 0.01, np.float32)
    counted = [0]
    stop = threading.Event()

    def count() -> None:
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0)

    before_interval = sys.getswitchinterval()
    # From now on a thread keeps the interpreter's lock until it lets go by itself.
    sys.setswitchinterval(1000.0)
    thread = threading.Thread(target=count)
    try:
        thread.start()
        for _ in range(1000):
            before = counted[0]
            axes.step(actions)
            if counted[0] != before:
                break
        else:
            pytest.fail("no other thread ran in 1,000 calls")
    finally:
        stop.set()
        sys.setswitchinterval(before_interval)
        thread.join()


def test_wrappers_of_gymnasium_fit() -> None:
    axes = gymnasium.wrappers.vector.RecordEpisodeStatistics(many("stator/ServoVelocity-v0", 2, **SHORT))
    axes.reset(seed=1)
    lengths = []
    for _ in range(60):
        info = axes.step(axes.action_space.sample())[4]
        if "episode" in info:
            lengths += info["episode"]["l"][info["_episode"]].tolist()
    assert 50 in lengths


@pytest.fixture(scope="module")
def learner() -> ModuleType:
    spec = importlib.util.spec_from_file_location("learn_a_tuning", EXAMPLES / "learn_a_tuning.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_a_learner_improves_a_tuning_and_equal_seeds_learn_the_same(learner: ModuleType, tmp_path: Path) -> None:
    first, second = (learner.learn(generations=2, seed=7) for _ in range(2))
    assert first.after > first.before + 0.03
    assert first.gains.tolist() == second.gains.tolist()
    assert first.history == second.history
    learner.plot(first, "servo", tmp_path / "tuning.svg")
    assert (tmp_path / "tuning.svg").read_text().startswith("<?xml")

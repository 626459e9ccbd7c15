#!/usr/bin/env python3
"""Steps per second of Stator's Gymnasium environments beside gym-electric-motor and motulator.

All have the same motor, a QBL4208-61-04-013 at 24 V, and run in one process, taking turns; each gets the best of
its turns, by processor time of the one thread that all of them use. What is compared:

  gym-electric-motor  env.step() of Cont-CC-PMSM-v0, currents by duties, one Euler step of 20 us for each call; and its
                      physical system alone, without reference, reward and limits
  motulator           current vector control with sensor, held voltages: a control period of 125 us, in which the motor is
                      integrated with steps as needed, counts as one step
  stator              env.step() with one plant step of 20 us for each call: voltages (torque) beside gym-electric-motor,
                      current loop and motor (velocity) beside motulator

Needs, beside stator: pip install gym-electric-motor motulator
Exit status 1 if a ratio is below what is demanded: --lanes and --single times the steps of each peer.
"""

import argparse
import sys
import time
import warnings
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np

import stator.gymnasium

STEP = 20e-6
RESISTANCE, INDUCTANCE, FLUX_LINKAGE, POLE_PAIRS = 0.36, 0.6e-3, 5.196e-3, 4
ROTOR_INERTIA, RATED_CURRENT, RATED_SPEED, SUPPLY = 4.8e-6, 3.47, 418.9, 24.0

stator.gymnasium.register()

Run = Callable[[], int]
"""Does some steps and says how many."""


def gym_electric_motor() -> dict[str, Run]:
    import gym_electric_motor as gem

    motor = {
        "motor_parameter": {
            "p": POLE_PAIRS,
            "r_s": RESISTANCE,
            "l_d": INDUCTANCE,
            "l_q": INDUCTANCE,
            "psi_p": FLUX_LINKAGE,
            "j_rotor": ROTOR_INERTIA,
        },
        "limit_values": {"i": 6 * RATED_CURRENT, "omega": 1.5 * RATED_SPEED, "u": SUPPLY},
        "nominal_values": {"i": RATED_CURRENT, "omega": RATED_SPEED, "u": SUPPLY},
    }
    environment = gem.make("Cont-CC-PMSM-v0", tau=STEP, supply={"u_nominal": SUPPLY}, motor=motor)
    environment.reset(seed=1)
    system = environment.unwrapped.physical_system
    action = np.array([0.01, -0.01, 0.0])

    def steps() -> int:
        for _ in range(2000):
            _, _, terminated, truncated, _ = environment.step(action)
            if terminated or truncated:
                environment.reset()
        return 2000

    def physics() -> int:
        system.reset()
        for _ in range(2000):
            system.simulate(action)
        return 2000

    return {"gym-electric-motor, env.step": steps, "gym-electric-motor, physical system alone": physics}


def motulator() -> dict[str, Run]:
    from motulator.drive import model
    from motulator.drive.control import sm
    from motulator.drive.utils import SynchronousMachinePars

    machine = SynchronousMachinePars(n_p=POLE_PAIRS, R_s=RESISTANCE, L_d=INDUCTANCE, L_q=INDUCTANCE, psi_f=FLUX_LINKAGE)
    period, duration = 125e-6, 0.1

    def steps() -> int:
        drive = model.Drive(
            model.VoltageSourceConverter(u_dc=SUPPLY),
            model.SynchronousMachine(machine),
            model.StiffMechanicalSystem(J=2 * ROTOR_INERTIA),
        )
        reference = sm.CurrentReferenceCfg(machine, nom_w_m=POLE_PAIRS * RATED_SPEED, max_i_s=2 * RATED_CURRENT)
        control = sm.CurrentVectorControl(machine, reference, T_s=period, J=2 * ROTOR_INERTIA, sensorless=False)
        control.ref.w_m = lambda t: 0.5 * POLE_PAIRS * RATED_SPEED
        simulation = model.Simulation(drive, control)
        simulation.simulate(t_stop=duration)
        return round(duration / period)

    return {"motulator, control period": steps}


# Limits that are not met, so that episodes end by time alone and rarely.
OPTIONS: Any = {"steps_per_action": 1, "step": STEP, "episode": 100.0, "trip_current": 1000.0, "speed_limit": 1e4}


def single(identity: str) -> Run:
    environment = gymnasium.make(identity, disable_env_checker=True, **OPTIONS)
    environment.reset(seed=1)
    action = np.full(environment.action_space.shape or (), 0.05, np.float32)

    def steps() -> int:
        for _ in range(20_000):
            environment.step(action)
        return 20_000

    return steps


def lanes(identity: str, axes: int) -> Run:
    environments = gymnasium.make_vec(identity, num_envs=axes, **OPTIONS)
    environments.reset(seed=1)
    actions = np.full(environments.action_space.shape or (), 0.05, np.float32)

    def steps() -> int:
        for _ in range(200):
            environments.step(actions)
        return 200 * axes

    return steps


def best_rates(runs: dict[str, Run], turns: int) -> dict[str, float]:
    """Steps per second of processor time; each run has one turn after the other."""
    rates = dict.fromkeys(runs, 0.0)
    for _ in range(turns):
        for name, run in runs.items():
            begin = time.process_time()
            steps = run()
            rates[name] = max(rates[name], steps / (time.process_time() - begin))
    return rates


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--axes", type=int, default=1024, help="side by side (default: %(default)s)")
    parser.add_argument("--turns", type=int, default=5, help="of which the best counts (default: %(default)s)")
    parser.add_argument("--lanes", type=float, default=1000.0, help="ratio demanded of lanes (default: %(default)s)")
    parser.add_argument("--single", type=float, default=8.0, help="ratio demanded of one axis (default: %(default)s)")
    arguments = parser.parse_args()
    warnings.simplefilter("ignore")
    try:
        peers = {"torque": gym_electric_motor(), "velocity": motulator()}
    except ImportError as missing:
        print(f"{missing}; pip install gym-electric-motor motulator", file=sys.stderr)
        return 2

    ours = {}
    for task in ("torque", "velocity"):
        identity = f"stator/Servo{task.capitalize()}-v0"
        ours[f"stator {task}, one axis"] = single(identity)
        ours[f"stator {task}, {arguments.axes} axes"] = lanes(identity, arguments.axes)
    rates = best_rates({**peers["torque"], **peers["velocity"], **ours}, arguments.turns)

    print("| | steps per second |\n|---|---|")
    for name, rate in rates.items():
        print(f"| {name} | {rate:,.0f} |")
    print("\n| beside | one axis: times | lanes: times |\n|---|---|---|")
    good = True
    for task, runs in peers.items():
        for peer in runs:
            one = rates[f"stator {task}, one axis"] / rates[peer]
            many = rates[f"stator {task}, {arguments.axes} axes"] / rates[peer]
            good = good and one >= arguments.single and many >= arguments.lanes
            print(f"| {peer} | {one:,.1f} | {many:,.0f} |")
    if not good:
        print(f"below {arguments.single:g} times or {arguments.lanes:g} times", file=sys.stderr)
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())

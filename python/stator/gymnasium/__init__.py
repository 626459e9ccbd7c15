"""Axes that programs learn to control, as environments of Gymnasium.

Importing this module registers `stator/ServoTorque-v0`, `stator/ServoVelocity-v0`, `stator/ServoPosition-v0` and the same
of `Stepper`. `gymnasium.make` makes one axis, `gymnasium.make_vec` thousands that are computed side by side:

    import gymnasium
    import stator.gymnasium

    one = gymnasium.make("stator/ServoVelocity-v0")
    many = gymnasium.make_vec("stator/ServoVelocity-v0", num_envs=4096, episode=0.5)

Without the import, `gymnasium.make("stator.gymnasium:stator/ServoVelocity-v0")` does the same.
"""

from typing import Any, cast

import gymnasium

from stator.gymnasium.environments import AxisEnv, AxisVectorEnv, Options

__all__ = ["IDS", "AxisEnv", "AxisVectorEnv", "Options", "register"]

IDS = tuple(f"stator/{plant}{task}-v0" for plant in ("Servo", "Stepper") for task in ("Torque", "Velocity", "Position"))
"""The environments that are registered."""


def register() -> None:
    """Registers the environments with Gymnasium, those that are not yet; importing the module does it."""
    for plant in ("Servo", "Stepper"):
        for task in ("Torque", "Velocity", "Position"):
            identity = f"stator/{plant}{task}-v0"
            if identity not in gymnasium.registry:
                cast(Any, gymnasium).register(
                    id=identity,
                    entry_point="stator.gymnasium:AxisEnv",
                    vector_entry_point="stator.gymnasium:AxisVectorEnv",
                    kwargs={"plant": plant.lower(), "task": task.lower()},
                )


register()

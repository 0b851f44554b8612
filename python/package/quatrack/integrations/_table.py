"""The eight at 2.1 m/s in other people's simulators: ours beside the controller that comes with each.

Every plant is the package's own, its state known exactly, all controllers told the same craft; ours is told the drag of the plant's
parameters and the lag of its motors, as the package states them. 2 s of hover, 3 s to come up to speed, then the measured part:
the position error every 10 ms, summed up.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.metadata
import io
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from quatrack import Course, Reference, Scenario
from quatrack.integrations._craft import GRAVITY_M_S2, Array

STEP_S = 0.002
SAMPLE_STEPS = 5


@dataclass(frozen=True)
class Row:
    """One craft of one package. The errors are in m s; none for a craft that was lost."""

    package: str
    craft: str
    ours: float | None
    theirs: float | None
    their_law: str

    def is_won(self) -> bool:
        """Whether ours stays nearer."""
        return self.ours is not None and (self.theirs is None or self.ours < self.theirs)


@dataclass(frozen=True)
class Flown:
    """The eight, from its hover or from where it is up to speed."""

    course: Course
    begins_s: float

    @classmethod
    def eight(cls, measured_s: float, *, up_to_speed: bool = False, speed_m_s: float = 2.1) -> Flown:
        """The law that flies it counts for nothing."""
        keys = {"vehicle": "crazyflie-2.1", "course": "eight", "speed_m_s": speed_m_s, "duration_s": measured_s}
        course = Scenario(keys).course()
        return cls(course, course.measured_from if up_to_speed else 0.0)

    @property
    def steps(self) -> int:
        """How many control steps it takes."""
        return round((self.course.duration - self.begins_s) / STEP_S)

    @property
    def commands(self) -> Reference:
        """The reference at every step and at its end."""
        return self.course.at(self.begins_s + STEP_S * np.arange(self.steps + 1))

    def start(self) -> tuple[Array, Array, Array, Array]:
        """Position, attitude as x y z w, velocity and body rates at its beginning."""
        state = self.course.at(self.begins_s).state
        assert state.body_rates is not None
        return state.position, np.roll(state.attitude, -1), state.velocity, state.body_rates

    def error_m_s(self, positions: Array) -> float | None:
        """The position error, summed up over samples of 10 ms, of positions at every step (steps + 1, 3); none where it was lost."""
        if len(positions) <= self.steps or not np.isfinite(positions).all():
            return None
        first = round((self.course.measured_from - self.begins_s) / STEP_S)
        sampled = np.arange(first, self.steps + 1, SAMPLE_STEPS)
        error = np.linalg.norm(positions[sampled] - self.commands.position[sampled], axis=1)
        return float(error.sum() * STEP_S * SAMPLE_STEPS) if error.max() < 10.0 else None


def rotorpy(flown: Flown, crafts: tuple[str, ...] = ("Crazyflie 2.1", "Brushless")) -> Iterator[Row]:
    """RotorPy's Crazyflies under its SE3Control (Lee), both in its Environment."""
    from rotorpy.controllers.quadrotor_control import SE3Control
    from rotorpy.environments import Environment
    from rotorpy.vehicles.crazyflie_params import quad_params as brushed
    from rotorpy.vehicles.crazyfliebrushless_params import quad_params as brushless
    from rotorpy.vehicles.multirotor import Multirotor

    from quatrack.integrations.rotorpy import QuatrackControl

    class Eight:
        """The course as one of its trajectories."""

        def update(self, t: float) -> dict[str, Any]:
            at = flown.course.at(flown.begins_s + float(t))
            keys = ("x", "x_dot", "x_ddot", "x_dddot", "x_ddddot")
            derivatives = (at.position, at.velocity, at.acceleration, at.jerk, at.snap)
            return dict(zip(keys, derivatives, strict=True)) | {"yaw": 0.0, "yaw_dot": 0.0, "yaw_ddot": 0.0}

    def fly(parameters: Any, controller: Any) -> float | None:
        hover = np.sqrt(0.25 * parameters["mass"] * GRAVITY_M_S2 / parameters["k_eta"])
        start = dict(zip(("x", "q", "v", "w"), flown.start(), strict=True))
        start |= {"wind": np.zeros(3), "rotor_speeds": np.full(4, hover)}
        vehicle = Multirotor(parameters, initial_state=start)
        environment = Environment(vehicle, controller, Eight(), sim_rate=round(1.0 / STEP_S))
        # Half a step more, so that the last one is not lost to rounding.
        ends = STEP_S * (flown.steps - 0.5)
        result = environment.run(t_final=ends, terminate=False, plot=False, animate_bool=False)
        return flown.error_m_s(np.asarray(result["state"]["x"]))

    for craft, parameters in (("Crazyflie 2.1", brushed), ("Brushless", brushless)):
        if craft in crafts:
            ours, theirs = fly(parameters, QuatrackControl(parameters)), fly(parameters, SE3Control(parameters))
            yield Row("rotorpy", craft, ours, theirs, "SE3Control (Lee)")


DRONES = ("cf2x_L250", "cf2x_P250", "cf2x_T350", "cf21B_500")


def drone_models(flown: Flown, drones: tuple[str, ...] = DRONES) -> Iterator[Row]:
    """The models of drone-models under the Mellinger controller of drone-controllers."""
    import drone_models as models
    from drone_controllers import parametrize
    from drone_controllers.mellinger import control as mellinger
    from drone_models.first_principles import dynamics

    from quatrack.integrations.drone_models import RotorControl

    commands = flown.commands

    for drone in drones:
        model = models.parametrize(dynamics, drone)
        ours = RotorControl(drone)

        def fly(rotors: Callable[..., Array], model: Any = model, ours: RotorControl = ours) -> float | None:
            state = list(flown.start())
            speeds = np.full(4, ours.hover_rpm)
            positions = [state[0]]
            for k in range(flown.steps):
                state, speeds = midpoint(model, state, speeds, rotors(k, *state))
                positions.append(state[0])
            return flown.error_m_s(np.array(positions))

        position = parametrize(mellinger.state2attitude, drone)
        attitude = parametrize(mellinger.attitude2force_torque, drone)
        motors = parametrize(mellinger.force_torque2rotor_vel, drone)
        memory: dict[str, Any] = {"asked": None, "sum": None, "turning": None, "before": None}

        def theirs(
            k: int, pos: Array, quat: Array, vel: Array, ang_vel: Array,
            position: Any = position, attitude: Any = attitude, motors: Any = motors, memory: dict[str, Any] = memory,
        ) -> Array:
            if k % SAMPLE_STEPS == 0:
                row = np.concatenate([commands.position[k], commands.velocity[k], commands.acceleration[k], np.zeros(4)])
                errors = None if memory["sum"] is None else (memory["sum"],)
                memory["asked"], memory["sum"] = position(pos, quat, vel, ang_vel, row, ctrl_errors=errors, ctrl_freq=100)
            errors = None if memory["turning"] is None else (memory["turning"],)
            force, torque, memory["turning"] = attitude(
                pos, quat, vel, ang_vel, memory["asked"], prev_ang_vel=memory["before"], ctrl_errors=errors, ctrl_freq=500
            )
            memory["before"] = ang_vel
            return np.asarray(motors(force, torque))

        def own(k: int, pos: Array, quat: Array, vel: Array, ang_vel: Array, ours: RotorControl = ours) -> Array:
            return ours(pos, quat, vel, ang_vel, row_of(commands, k))

        yield Row("drone-models", drone, fly(own), fly(theirs), "drone-controllers (Mellinger)")


def midpoint(model: Any, state: list[Array], speeds: Array, commanded: Array) -> tuple[list[Array], Array]:
    """A step of the midpoint rule of a model with its rotors. The attitude is turned by the body rates: the model's own derivative
    of its quaternion is that of another order of its numbers."""
    from scipy.spatial.transform import Rotation

    pos, quat, vel, ang_vel = state

    def after(by: float, slopes: list[Array]) -> tuple[list[Array], Array]:
        velocity, _, acceleration, turning, rotors = slopes
        rates = ang_vel + 0.5 * by * turning
        turned = (Rotation.from_quat(quat) * Rotation.from_rotvec(by * rates)).as_quat()
        return [pos + by * velocity, turned, vel + by * acceleration, ang_vel + by * turning], speeds + by * rotors

    def slopes(at: list[Array], turning: Array) -> list[Array]:
        return [np.asarray(part) for part in model(*at, commanded, rotor_vel=turning)]

    half, half_speeds = after(0.5 * STEP_S, slopes(state, speeds))
    return after(STEP_S, slopes(half, half_speeds))


def row_of(reference: Reference, k: int) -> Reference:
    """One row of a reference."""
    snap, crackle = reference.snap, reference.crackle
    assert snap is not None and crackle is not None
    return Reference(
        reference.position[k], reference.velocity[k], reference.acceleration[k], reference.jerk[k], snap[k], crackle[k]
    )


def crazyflow(flown: Flown, drones: tuple[str, ...] = DRONES) -> Iterator[Row]:
    """crazyflow's simulation under its own state control (Mellinger), which is told the body rates too."""
    from crazyflow.sim import Sim

    from quatrack.integrations.crazyflow import RotorControl

    commands = flown.commands
    rates = commands.state.body_rates
    assert rates is not None

    for drone in drones:
        ours = RotorControl(drone)

        def fly(kind: str, step: Callable[[Any, int], None], drone: str = drone, ours: RotorControl = ours) -> float | None:
            sim = Sim(drone=drone, control=kind, dynamics="first_principles", freq=500)
            sim.reset()
            states = sim.data.states
            begins = dict(zip(("pos", "quat", "vel", "ang_vel"), flown.start(), strict=True))
            sim.data = sim.data.replace(
                states=states.replace(**{key: getattr(states, key) * 0 + value for key, value in begins.items()})
            )
            ours.start(sim)
            positions = [np.asarray(sim.data.states.pos[0, 0])]
            for k in range(flown.steps):
                step(sim, k)
                positions.append(np.asarray(sim.data.states.pos[0, 0]))
            sim.close()
            return flown.error_m_s(np.array(positions, dtype=float))

        def theirs(sim: Any, k: int) -> None:
            if k % SAMPLE_STEPS == 0:
                quat = [0.0, 0.0, 0.0, 1.0]
                row = [commands.position[k], commands.velocity[k], commands.acceleration[k], quat, rates[k]]
                sim.state_control(np.concatenate(row).astype(np.float32)[np.newaxis, np.newaxis])
            sim.step(1)

        def own(sim: Any, k: int, ours: RotorControl = ours) -> None:
            ours.step(sim, row_of(commands, k))

        yield Row("crazyflow", drone, fly("rotor_vel", own), fly("state", theirs), "state control (Mellinger)")


def gym_pybullet_drones(flown: Flown) -> Iterator[Row]:
    """The Crazyflie of gym-pybullet-drones in its X, with drag, under its DSLPIDControl, which is told velocity and the rates of roll,
    pitch and yaw too, both at 500 Hz. Its rotors turn at once; ours lets them lag by 15 ms."""
    import pybullet
    from gym_pybullet_drones.control.DSLPIDControl import DSLPIDControl
    from gym_pybullet_drones.envs.CtrlAviary import CtrlAviary
    from gym_pybullet_drones.utils.enums import DroneModel, Physics

    from quatrack.integrations.gym_pybullet_drones import RotorControl

    commands = flown.commands
    pos, quat, vel, ang_vel = flown.start()
    angles = np.array([pybullet.getEulerFromQuaternion(np.roll(attitude, -1)) for attitude in commands.state.attitude])
    rates = np.gradient(angles, STEP_S, axis=0)

    def fly(under: Callable[[Any], Callable[[Array, int], Array]]) -> float | None:
        # It prints its parameters, and Gymnasium warns that their bounds are rounded.
        with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            env = CtrlAviary(
                drone_model=DroneModel.CF2X,
                initial_xyzs=pos[np.newaxis],
                initial_rpys=angles[:1],
                physics=Physics.PYB_DRAG,
                pyb_freq=round(2.0 / STEP_S),
                ctrl_freq=round(1.0 / STEP_S),
            )
        obs, _ = env.reset()
        # It sets no velocities; angular ones are of the world frame.
        turning = np.reshape(pybullet.getMatrixFromQuaternion(quat), (3, 3)) @ ang_vel
        pybullet.resetBaseVelocity(env.DRONE_IDS[0], vel, turning, physicsClientId=env.CLIENT)
        obs[0, 10:16] = np.concatenate([vel, turning])
        rotors = under(env)
        positions = [pos]
        for k in range(flown.steps):
            obs, *_ = env.step(rotors(obs, k))
            positions.append(obs[0, :3].copy())
        env.close()
        return flown.error_m_s(np.array(positions))

    def own(env: Any) -> Callable[[Array, int], Array]:
        control = RotorControl(env)
        return lambda obs, k: control(obs, row_of(commands, k))

    def theirs(env: Any) -> Callable[[Array, int], Array]:
        control = DSLPIDControl(DroneModel.CF2X)
        # It takes rates as differences of angles.
        control.last_rpy = angles[0]

        def rotors(obs: Array, k: int) -> Array:
            told = {"target_pos": commands.position[k], "target_vel": commands.velocity[k], "target_rpy_rates": rates[k]}
            speeds, _, _ = control.computeControlFromState(env.CTRL_TIMESTEP, obs[0], **told)
            return np.asarray(speeds)[np.newaxis]

        return rotors

    yield Row("gym-pybullet-drones", "CF2X", fly(own), fly(theirs), "DSLPIDControl")


PACKAGES: dict[str, Callable[..., Iterator[Row]]] = {
    "rotorpy": rotorpy,
    "drone-models": drone_models,
    "crazyflow": crazyflow,
    "gym-pybullet-drones": gym_pybullet_drones,
}

# How to come by a package that no registry has.
HINTS = {
    "gym-pybullet-drones": "pip install --no-deps "
    "git+https://github.com/utiasDSL/gym-pybullet-drones@90b178aba69b09085dd70e7a1e88bb58ca00b4c9",
}


def printed(value: float | None) -> str:
    """An error as the table has it."""
    return "lost" if value is None else f"{value:.4f}"


def main(arguments: list[str] | None = None) -> None:
    """The command."""
    parser = argparse.ArgumentParser(prog="python -m quatrack.compare", description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("packages", nargs="*", help=f"some of {', '.join(PACKAGES)}; all where left out")
    parser.add_argument("--seconds", type=float, default=12.0, help="how long is measured (12)")
    asked = parser.parse_args(arguments)
    # drone-models and crazyflow want it before anybody imports SciPy.
    os.environ["SCIPY_ARRAY_API"] = "1"
    unknown = [name for name in asked.packages if name not in PACKAGES]
    if unknown:
        parser.error(f"{unknown[0]}: there are {', '.join(PACKAGES)}")
    print(f"Eight at 2.1 m/s for {asked.seconds:g} s, in air, without noise: position error summed up, m s\n")
    print(f"{'package':<27}{'craft':<15}{'quatrack':>10}{'its own':>10}  own controller")
    for name in asked.packages or PACKAGES:
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            hint = f" ({HINTS[name]})" if name in HINTS else ""
            print(f"{name:<27}skipped: not installed{hint}")
            continue
        for row in PACKAGES[name](Flown.eight(asked.seconds)):
            label = f"{row.package} {version}"
            print(f"{label:<27}{row.craft:<15}{printed(row.ours):>10}{printed(row.theirs):>10}  {row.their_law}", flush=True)
    sys.stdout.flush()

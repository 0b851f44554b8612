"""Systems of python-control in, gains out, and back.

    system = hover()                                               # control.ss of the linear model at hover
    feedback = lqr(system, Q, R)                                   # quatrack.Feedback, dlqr where the system is sampled
    loop = closed_loop(system, feedback.gain)                      # control.ss
"""

from __future__ import annotations

from typing import Any

import control as ct
import numpy as np
from numpy.typing import ArrayLike

from quatrack import Feedback, GainTable, certify as certify_pair, dlqr, hover_model, lqr as continuous_lqr


def lqr(system: Any, q: ArrayLike, r: ArrayLike, s: ArrayLike | None = None) -> Feedback:
    """The optimal feedback of a state space system, in continuous or in sampled time, as it says itself.

    system: control.StateSpace; its output counts for nothing
    q: (n, n); r: (m, m); s: (n, m), sampled systems only
    """
    a, b = np.asarray(system.A), np.asarray(system.B)
    if system.isdtime(strict=True):
        return dlqr(a, b, q, r, s)
    if s is not None:
        raise ValueError("s: the cross weight is for sampled systems")
    return continuous_lqr(a, b, q, r)


def certify(system: Any, gain: ArrayLike, rate_hz: float, **keywords: Any) -> dict[str, Any]:
    """The certificate of a continuous system's feedback as it is flown; keywords of quatrack.certify."""
    if system.isdtime(strict=True):
        raise ValueError("system: sampled; give the one in continuous time, which is sampled at rate_hz here")
    return certify_pair(np.asarray(system.A), np.asarray(system.B), gain, rate_hz, **keywords)


def closed_loop(system: Any, gain: ArrayLike) -> Any:
    """The system under u = r - K x: control.StateSpace from r to its own output."""
    k = np.asarray(gain, dtype=float)
    a, b, c, d = (np.asarray(part) for part in (system.A, system.B, system.C, system.D))
    return ct.ss(a - b @ k, b, c - d @ k, d, system.dt)


def hover(vehicle: Any = None, lag_s: float | None = None) -> Any:
    """The linear model at hover, quatrack.hover_model, as control.StateSpace whose output is its state."""
    a, b = hover_model(vehicle, lag_s)
    names: dict[str, Any] = {}
    if vehicle is None:
        states = ["x", "y", "z", "q1", "q2", "q3", "vx", "vy", "vz"]
        names = {"states": states, "outputs": states, "inputs": ["T", "p", "q", "r"]}
    return ct.ss(a, b, np.eye(len(a)), np.zeros(b.shape), **names)


def gain_of(table: GainTable) -> Any:
    """The gain of a table as a static system from error to command, u = -K e."""
    gain = np.asarray(table.gain, dtype=float)
    if gain.ndim != 2:
        raise ValueError(f"table {table.name}: its gains change along a trajectory")
    return ct.ss([], [], [], -gain)

"""Figures by matplotlib in the style of those that the command draws.

    figures.use_style()
    fig, ax = plt.subplots()
    figures.path(ax, flight.target, dashed=True, label="course")
    figures.path(ax, flight.state.position, label=flight.law)
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

INK, FRAME, GRID = "#222222", "#606060", "#dddddd"
# Blue, vermilion, bluish green and reddish purple of Okabe and Ito's palette.
FLIGHTS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7")


def use_style() -> None:
    """Makes it the style of all figures that follow."""
    import matplotlib as mpl
    from cycler import cycler

    mpl.rcParams.update(
        {
            "figure.facecolor": "white",
            "figure.constrained_layout.use": True,
            "font.family": ["IBM Plex Sans", "DejaVu Sans"],
            "text.color": INK,
            "axes.labelcolor": INK,
            "axes.edgecolor": FRAME,
            "axes.grid": True,
            "axes.axisbelow": True,
            "axes.titlesize": "medium",
            "axes.prop_cycle": cycler(color=FLIGHTS),
            "axes.spines.top": False,
            "axes.spines.right": False,
            "grid.color": GRID,
            "xtick.color": FRAME,
            "ytick.color": FRAME,
            "lines.linewidth": 1.8,
            "lines.solid_capstyle": "round",
            "legend.frameon": False,
        }
    )
    # A face that is not installed is replaced by the next one; nobody has to read of it.
    import logging

    logging.getLogger("matplotlib.font_manager").setLevel(logging.ERROR)


def path(ax: Any, position: ArrayLike, *, dashed: bool = False, label: str | None = None) -> None:
    """Draws positions (rows, 3), m, from above; a course is black, and dashed beside flights."""
    x, y, _ = np.asarray(position, dtype=float).T
    style: dict[str, Any] = {"color": "black", "linewidth": 1.2, "linestyle": (0, (5, 3))} if dashed else {}
    ax.plot(x, y, label=label, **style)
    ax.set_aspect("equal")
    ax.set_xlabel("x, m")
    ax.set_ylabel("y, m")

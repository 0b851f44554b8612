"""Packages that are not installed are skipped by name; those of another version than the one that was looked at fail."""

import importlib.metadata
import os

import pytest

# drone-models and crazyflow want it before anybody imports SciPy, and crazyflow's JAX a processor.
os.environ["SCIPY_ARRAY_API"] = "1"
os.environ.setdefault("JAX_PLATFORMS", "cpu")

PINNED = {
    "rotorpy": "3.0.0",
    "crazyflow": "0.4.0",
    "drone-models": "0.1.0",
    "drone-controllers": "0.1.0",
    "control": "0.10.2",
    "gymnasium": "1.4.0",
    "gym-pybullet-drones": "2.1.0",
    "pybullet": "3.2.7",
}


def need(*names):
    """Skips where a package is missing."""
    for name in names:
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            pytest.skip(f"{name} is not installed", allow_module_level=True)
        if name in PINNED:
            assert version == PINNED[name], f"{name} {version} is not the {PINNED[name]} that this was tried with"

"""The package as others see it."""

import ast
import inspect
import subprocess
import sys
from pathlib import Path

import quatrack as q
from conftest import ROOT


def test_the_version_is_the_workspaces():
    manifest = (ROOT / "Cargo.toml").read_text().split("[workspace.package]", 1)[1]
    assert f'version = "{q.__version__}"' in manifest.split("\n[", 1)[0]


def test_everything_has_a_description():
    for name in q.__all__:
        if name == "__version__":
            continue
        thing = getattr(q, name)
        assert inspect.getdoc(thing), name
        if inspect.isclass(thing):
            own = [key for key in vars(thing) if not key.startswith("_")]
            untold = [key for key in own if not inspect.getdoc(getattr(thing, key)) and name not in ("State", "Reference")]
            assert not untold, (name, untold)


def test_the_stubs_are_complete():
    stub = ast.parse((Path(q.__file__).parent / "_quatrack.pyi").read_text())
    classes = {node.name: node for node in stub.body if isinstance(node, ast.ClassDef)}
    functions = {node.name for node in stub.body if isinstance(node, ast.FunctionDef)}
    for name in q.__all__:
        thing = getattr(q, name)
        if inspect.isclass(thing) and not issubclass(thing, Exception):
            declared = {node.name for node in classes[name].body if isinstance(node, ast.FunctionDef)}
            there = {key for key in vars(thing) if not key.startswith("_")}
            assert there == {key for key in declared if not key.startswith("_")}, name
        elif callable(thing) and not inspect.isclass(thing):
            assert name in functions, name


def test_importing_needs_numpy_alone():
    script = "import sys, numpy; before = set(sys.modules); import quatrack; print(*sorted(set(sys.modules) - before))"
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    outside = {name.split(".")[0] for name in loaded} - {"quatrack"} - set(sys.stdlib_module_names)
    assert outside <= {"numpy"}, outside

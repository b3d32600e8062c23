"""Packages that load a public name when it is asked for, and not before (PEP 562)."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Mapping
from types import ModuleType


def load_on_demand(package: str, names: Mapping[str, str]) -> None:
    """Make the public names of a package load the module they stand in when they are asked for.

    A plain import of the package then costs nothing, and a command pays for what it uses. To the type checker the
    package declares the same by imports under ``TYPE_CHECKING``; a test holds both lists equal.

    Parameters
    ----------
    package : str
        Name of the package; to be called at the end of its ``__init__``.
    names : mapping
        Module inside the package, or full name of one in another package, to its public names, parted by blanks;
        the package's own name to those of its modules that are public names themselves.
    """
    modules = {
        name: _full_name(package, module) for module, public in names.items() for name in public.split()
    }
    there = sys.modules[package]
    there.__dict__["_modules_of_names"] = modules
    there.__class__ = _OnDemand


def _full_name(package: str, module: str) -> str:
    """Return the full name of a module that is written ``.name`` where it belongs to the package."""
    return package + module if module.startswith(".") else module


class _OnDemand(ModuleType):
    """A package whose public names are loaded when they are asked for."""

    _modules_of_names: Mapping[str, str]

    def __getattr__(self, name: str) -> object:
        """Load a public name, and keep it."""
        module = self.__dict__["_modules_of_names"].get(name)
        if module is None:
            raise AttributeError(f"module {self.__name__!r} has no attribute {name!r}")
        value: object = (
            importlib.import_module(f"{module}.{name}")
            if module == self.__name__
            else getattr(importlib.import_module(module), name)
        )
        self.__dict__[name] = value
        return value

    def __setattr__(self, name: str, value: object) -> None:
        """Keep a module of the name of a public function from taking its place when it is loaded."""
        if isinstance(value, ModuleType) and name in self.__dict__["_modules_of_names"]:
            return
        super().__setattr__(name, value)

    def __dir__(self) -> list[str]:
        """Return the public names, loaded or not."""
        return sorted({*self.__dict__.get("__all__", ()), *self.__dict__["_modules_of_names"]})

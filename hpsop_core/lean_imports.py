"""What a library loads for others is not loaded for us: a third of the time that importing SciPy and numba takes.

SciPy copies numpy's whole name space, which makes numpy load its Fortran translator and its test tools, and takes the
docstrings of some 300 functions apart to write a table of array libraries into them; numba looks for two libraries that
a caller might use with it. Nothing here relies on how they are made inside: where they do otherwise, all is loaded as
ever.
"""

from __future__ import annotations

import contextlib
import importlib.util
import inspect
import sys
from collections.abc import Iterator

_ON_FIRST_USE = ("numpy.f2py", "numpy.testing")
_LOOKED_FOR = ("cffi", "yaml")


@contextlib.contextmanager
def lean_imports() -> Iterator[None]:
    """A context in which SciPy and numba are imported without what this program never uses.

    numpy's two modules are loaded when somebody uses them, also afterwards. Docstrings of SciPy's functions that are
    imported within stay without their text, so this is for programs that nobody asks for help on a function: the
    commands and their workers, not the Python interface. Nothing else in the process may be importing at the time.
    """
    for name in _ON_FIRST_USE:
        _defer(name)
    kept = inspect.getdoc
    hidden = [name for name in _LOOKED_FOR if name not in sys.modules]
    inspect.getdoc = _no_words  # type: ignore[assignment]
    # What Python's manual says of None there: importing it raises ModuleNotFoundError.
    sys.modules.update(dict.fromkeys(hidden))  # type: ignore[arg-type]
    try:
        yield
    finally:
        inspect.getdoc = kept
        for name in hidden:
            del sys.modules[name]


def _no_words(thing: object) -> str | None:
    """In the place of ``inspect.getdoc``: nothing has a docstring."""
    return None


def _defer(name: str) -> None:
    """Let a module load itself when one of its names is first asked for."""
    if name in sys.modules:
        return
    spec = importlib.util.find_spec(name)
    if spec is None or spec.loader is None:
        return
    spec.loader = importlib.util.LazyLoader(spec.loader)
    module = importlib.util.module_from_spec(spec)
    # As an import would: its parent knows it, too.
    sys.modules[name] = module
    spec.loader.exec_module(module)
    parent, _, own = name.rpartition(".")
    setattr(sys.modules[parent], own, module)

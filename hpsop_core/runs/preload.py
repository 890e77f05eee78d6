"""What the workers' fork server imports once, so that no worker has to."""

from __future__ import annotations

import contextlib

from hpsop_core.lean_imports import lean_imports

with lean_imports():
    from hpsop_core.runs import parcels  # noqa: F401 - imported for its effect

    with contextlib.suppress(ImportError):
        # Without the solvers (a partial installation) the first evaluation says what is missing; here nobody would hear
        # it.
        from hpsop_core.evaluation import evaluate as evaluation  # noqa: F401

"""The surfaces that a run learns: each is a function of what had been solved when it was first asked for."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from hpsop_core.case.case import Case
from hpsop_core.runs.ledger import Ledger
from hpsop_core.runs.records import json_text
from hpsop_core.runs.store import RunStore
from hpsop_core.runs.tasks import Physics


class Learning:
    """The surfaces of a run, by number; learnt only where one has yet to answer, the same in a run that goes on.

    Args:
        store: the run file.
        case: what is optimised.
        physics: what learns.
        ledger: what is solved.
    """

    def __init__(self, store: RunStore, case: Case, physics: Physics, ledger: Ledger) -> None:
        self._store = store
        self._case = case
        self._physics = physics
        self._ledger = ledger
        self._solved: dict[int, tuple[int, ...]] = {}
        self._references: dict[int, Any] = {}

    def announce(self, surface: int) -> None:
        """A generation asks for this surface: whatever is solved by now is what it knows."""
        self._solved.setdefault(surface, self._ledger.solved())

    def reference(self, surface: int, plain: Any, fast: Any, keep: Callable[[Callable[[], None]], None]) -> Any:
        """The reference with which designs of a surface are evaluated.

        Args:
            surface: its number.
            plain: the true level's reference.
            fast: level 1's; None in a run without level 1.
            keep: writes to the file, whenever it can be written.
        """
        if surface not in self._references:
            if self._physics.learn is None:
                self._references[surface] = plain
            else:
                documents = self._store.documents(self._solved[surface])
                self._references[surface], errors = self._physics.learn(self._case, plain, documents, fast)
                keep(lambda: self._remember(surface, errors))
        return self._references[surface]

    def _remember(self, surface: int, errors: Mapping[str, float]) -> None:
        known = json.loads(self._store.value("surfaces", "{}"))
        if str(surface) not in known:
            self._store.set_values(surfaces=json_text({**known, str(surface): dict(errors)}))
            self._store.note(told(surface, errors))


def told(surface: int, errors: Mapping[str, float]) -> str:
    """A surface and its error in words."""
    if not errors:
        return f"surface {surface}: too few solved designs to learn from; all are solved"
    back = errors.get("greatest_back_share", 0.0)
    return (
        f"surface {surface}: learnt from {errors['designs']:.0f} solved designs; {errors['answered']:.0f} of them "
        "predicted from the others without doubt: "
        f"resistance {100 * errors['resistance']:.3f} % off (at most {100 * errors['greatest_resistance']:.3f}), "
        f"efficiency {100 * errors['efficiency']:.4f} % (at most {100 * errors['greatest_efficiency']:.4f})"
        + (f", the back's share under vapour pressure at most {100 * back:.1f} % of the back" if back else "")
    )


def surface_words(summary: Mapping[str, Any]) -> str:
    """How much of level 2 was predicted, and how far off that was, from ``RunReader.summary``."""
    level2 = summary["evaluations"].get("2", {"count": 0, "predicted": 0})
    predicted = level2["predicted"]
    words = (
        f"level 2: {level2['count'] - predicted} designs solved, {predicted} answers predicted by the learnt surface"
    )
    found = summary["surface"]
    if not found["solved_after_prediction"]:
        return words
    first, second = (found["greatest_difference"][name] for name in ("f1", "f2"))
    return (
        f"{words}; {found['solved_after_prediction']} predicted designs were solved in the end: "
        f"at most {100 * first:.4f} % off in f1, {100 * second:.4f} % in f2"
    )

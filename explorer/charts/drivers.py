"""Which variables drive which result: Spearman's rank correlation over the archive."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from explorer.state.run_picture import RunPicture
from hpsop_core.markup import escape, symbol_html
from hpsop_core.quantities import OBJECTIVES, all_quantities, free_variables

_RESULTS = ("block_coefficient", "total_resistance_1", "open_water_efficiency_1", "delivered_power_1", "g3")
_LEAST = 10


def ranks(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Ranks from 1, ties sharing their mean."""
    order = np.argsort(values, kind="stable")
    ranked = np.zeros(len(values))
    ranked[order] = np.arange(1, len(values) + 1)
    _, inverse, counts = np.unique(values, return_inverse=True, return_counts=True)
    sums = np.bincount(inverse, weights=ranked)
    return np.asarray(sums[inverse] / counts[inverse])


def rank_correlation(first: NDArray[np.float64], second: NDArray[np.float64]) -> float | None:
    """Spearman's rho of the pairs that are finite; None when one of them does not vary."""
    keep = np.isfinite(first) & np.isfinite(second)
    if keep.sum() < _LEAST:
        return None
    a, b = ranks(first[keep]), ranks(second[keep])
    a, b = a - a.mean(), b - b.mean()
    size = float(np.sqrt((a @ a) * (b @ b)))
    return float(a @ b) / size if size > 0.0 else None


def _signed(rho: float) -> str:
    text = f"{abs(rho):.2f}"
    return text if text == "0.00" else f"{'+' if rho > 0 else '−'}{text}"


def drivers_table(picture: RunPicture) -> str:
    """A table of correlations, coloured by sign and strength; one level at a time."""
    level = picture.current_level
    keep = (picture.level == level) & ~picture.failed
    if keep.sum() < _LEAST:
        return f'<p class="soft">Correlations appear once {_LEAST} designs have been evaluated.</p>'
    everything = {quantity.key: quantity for quantity in all_quantities(picture.case.conditions.froude_numbers)}
    results = [*OBJECTIVES, *(everything[key] for key in _RESULTS if key in everything)]
    free = free_variables(picture.case)
    heads = "".join(f'<th title="{escape(item.label)}">{symbol_html(item.symbol)}</th>' for item in results)
    rows = [f"<tr><th>variable</th>{heads}</tr>"]
    for variable in free:
        first = picture.column(variable.key)
        cells = []
        for item in results:
            second = picture.column(item.key)
            rho = rank_correlation(first[keep], second[keep]) if first is not None and second is not None else None
            if rho is None:
                cells.append("<td>–</td>")
                continue
            colour = "var(--hp-bad)" if rho > 0 else "var(--hp-level1)"
            share = round(70 * abs(rho))
            cells.append(
                f'<td style="background:color-mix(in srgb, {colour} {share}%, transparent)">{_signed(rho)}</td>'
            )
        rows.append(
            f'<tr><td class="name">{escape(variable.label)} <span class="unit">{symbol_html(variable.symbol)}</span>'
            f"</td>{''.join(cells)}</tr>"
        )
    return (
        f'<table class="numbers">{"".join(rows)}</table><p class="soft">Spearman\'s rank correlation over '
        f"{int(keep.sum())} level-{level} designs: + grows with the variable, − falls. A search samples where it is "
        "good, not evenly: read it as a hint.</p>"
    )

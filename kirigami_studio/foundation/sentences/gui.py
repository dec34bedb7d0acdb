"""Sentences of ``gui``, by the code of the problem."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    "designs.none_chosen": mark("Choose a design first, then generate more like it."),
    "designs.none_to_add_to": mark("No designs to add to yet. Press Generate first."),
    "coupon.not_dxf": mark("Coupons are exported as .dxf, not {name}. The command line supports other types."),
    "export.stopped": mark("Export to {folder} stopped; files already written are kept."),
}

"""What held-out experiments refute: an effect that was established on the training experiments alone.

Without repeats nothing tells what repeats from what a sensor adds. A slow error of a sensor then looks like an effect
on the training experiments, but not on others."""

from __future__ import annotations

from tendonlab.diagnosis.answer import heldout
from tendonlab.diagnosis.floor import renewed
from tendonlab.diagnosis.search.select import Search
from tendonlab.diagnosis.search.workshop import Workshop

CONFIRMED = 0.25  # share of the held-out excess that the last effect must remove


def confirmed(search: Search, shop: Workshop) -> Search:
    """Without repeats: the search without the last effects that held-out experiments refute."""
    while search.selected and not search.fitter.floor.repeated and _is_refuted(search):
        search = search.without_last(*renewed(search.fitter, search.path[-2], shop.pool))
    return search


def _is_refuted(search: Search) -> bool:
    """Whether the last effect removes too little of what the model without it leaves of the held-out experiments."""
    case = search.fitter.case
    if not case.test:
        return False
    before, after = (heldout.replay(case, heldout.models(case, m, case.test), case.test) for m in search.path[-2:])
    share = heldout.explained(before, after, search.fitter.floor.reached_by(heldout.rms(after)))
    return share is not None and share < CONFIRMED

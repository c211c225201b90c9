"""Rows of lifts in the model of positions: the top of a pile goes to another one, in its order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smash.planners.layered.network.places import NO_EDGE, Places, free
from smash.planners.milp.arrays import Ints, MilpBuilder
from smash.planners.milp.columns import new_columns, priced_columns


@dataclass(frozen=True, slots=True)
class LiftColumns:
    """Columns of lifts; t layers, b blocks, l locations, h heights, r ranks in the hand; -1: no lift is allowed.

    `lift`: (t, l, l) from one location to another, at its price; `lifted`: (t, b, l, l) it takes the block; `cut`,
    `land`: (t, l, h) the lowest height taken and filled; `rise`, `settle`: (t, b, l, h) the block is taken from there
    and set down there; `rank`: (t, b, r) it is the r-th from the bottom in the hand.
    """

    lift: Ints
    lifted: Ints
    cut: Ints
    land: Ints
    rise: Ints
    settle: Ints
    rank: Ints

    @classmethod
    def of(cls, milp: MilpBuilder, places: Places, layers: int, blocks: int) -> LiftColumns:
        """Add the columns for a number of layers and of blocks, which is the number of heights too."""
        lift = priced_columns(milp, (layers,), places.lift)
        lifted = priced_columns(milp, (layers, blocks), free(places.lift))
        ends = np.full((len(places.locations), blocks), 0 if places.lifted else NO_EDGE, dtype=np.int64)
        cut, land = priced_columns(milp, (layers,), ends), priced_columns(milp, (layers,), ends)
        rise, settle = priced_columns(milp, (layers, blocks), ends), priced_columns(milp, (layers, blocks), ends)
        rank = new_columns(milp, layers, blocks, min(places.lifted, blocks))
        return cls(lift, lifted, cut, land, rise, settle, rank)


def add_lifts(milp: MilpBuilder, places: Places, columns: LiftColumns, at: Ints) -> None:
    """Add the rows: a lift takes the top of a pile, at most the capacity, and there is one a layer.

    Args:
        milp: the model.
        places: its places.
        columns: those of lifts.
        at: (t + 1, b, l, h) the block is there before the first layer and after each.
    """
    if not places.lifted:
        return
    lift, rise = columns.lift, columns.rise
    rows, (layers, n, locations) = milp.add_sums, columns.lifted.shape[:3]
    cells = (layers * n * locations, -1)
    out, into = columns.lifted, np.swapaxes(columns.lifted, 2, 3)
    rows([(rise.reshape(cells), 1), (out.reshape(cells), -1)], lower=0, upper=0)
    rows([(columns.settle.reshape(cells), 1), (into.reshape(cells), -1)], lower=0, upper=0)
    rows([(lift.reshape(layers, -1), 1)], upper=1)
    lifts = np.broadcast_to(lift[:, None], columns.lifted.shape)
    there = columns.lifted.ravel() >= 0
    rows([(columns.lifted.reshape(-1, 1)[there], 1), (lifts.reshape(-1, 1)[there], -1)], upper=0)
    each = (layers * locations, -1)
    starts, ends = lift.reshape(each), np.swapaxes(lift, 1, 2).reshape(each)
    rows([(columns.cut.reshape(each), 1), (starts, -1)], lower=0, upper=0)
    rows([(columns.land.reshape(each), 1), (ends, -1)], lower=0, upper=0)
    risen = np.moveaxis(rise, 1, 2).reshape(each)
    rows([(risen, 1), (starts, -columns.rank.shape[2])], upper=0)
    rows([(risen, 1), (starts, -1)], lower=0)
    by_block = (layers * n, -1)
    rows([(columns.rank.reshape(by_block), 1), (columns.lifted.reshape(by_block), -1)], lower=0, upper=0)
    rows([(np.swapaxes(columns.rank, 1, 2).reshape(-1, n), 1)], upper=1)
    for height in range(n):
        cuts = columns.cut[:, :, : height + 1].reshape(each)
        rows([(np.moveaxis(rise[..., height], 1, 2).reshape(each), 1), (cuts, -1)], upper=0)
        after = np.moveaxis(at[1:, :, :, height], 1, 2).reshape(each)
        rows([(after, 1), (columns.cut[:, :, height].reshape(-1, 1), 1)], upper=1)
    _keep_order(milp, columns)


def _keep_order(milp: MilpBuilder, columns: LiftColumns) -> None:
    """The block of rank i in the hand comes from the cut + i and goes to the landing + i."""
    layers, n, locations, heights = columns.rise.shape
    blocks = (layers, n, locations)

    def each(part: Ints, axis: int) -> Ints:
        return np.broadcast_to(np.expand_dims(part, axis), blocks).reshape(-1, 1)

    for rank in range(columns.rank.shape[2]):
        held = each(columns.rank[..., rank], 2)
        for low in range(heights):
            cut, land = each(columns.cut[..., low], 1), each(columns.land[..., low], 1)
            if low + rank < heights:
                rise, settle = (part[..., low + rank].reshape(-1, 1) for part in (columns.rise, columns.settle))
                milp.add_sums([(rise, 1), (cut, 1), (held, -1)], upper=1)
                milp.add_sums([(held, 1), (land, 1), (settle, -1)], upper=1)
            else:
                milp.add_sums([(held, 1), (land, 1)], upper=1)

"""Rows of carriers, the same in both models with layers: stations, loads, capacities, and what goes along."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from smash.planners.layered.network.places import Places
from smash.planners.milp.arrays import Ints, MilpBuilder


@dataclass(frozen=True, slots=True)
class CarrierColumns:
    """Columns of the decks; t layers (states have one more), b blocks, d decks.

    `on`: (t+1, b, d) the block is on the carrier, which stands there; `stands`: (t+1, d); `carry`: (t, d, d);
    `ride`: (t, b, d, d); `into`, `out`: (t, b, d, k) the moves that load and unload a block.
    """

    on: Ints
    stands: Ints
    carry: Ints
    ride: Ints
    into: Ints
    out: Ints


def add_carriers(milp: MilpBuilder, places: Places, columns: CarrierColumns) -> None:
    """Add the rows: blocks go along with their carrier, and load and unload where it stays."""
    if not places.decks:
        return
    layers, n, decks = columns.ride.shape[:3]

    def each(part: Ints) -> Ints:
        return part.reshape(layers * n * decks, -1)

    def for_each_block(part: Ints) -> Ints:
        return each(np.broadcast_to(part[:, None], (layers, n, *part.shape[1:])))

    came = [(each(columns.into), -1.0), (each(np.swapaxes(columns.ride, 2, 3)), -1.0)]
    went = [(each(columns.out), 1.0), (each(columns.ride), 1.0)]
    now, before = each(columns.on[1:]), each(columns.on[:-1])
    milp.add_sums([(now, 1), (before, -1), *came, *went], lower=0, upper=0)
    leaves, stood = for_each_block(columns.carry), for_each_block(columns.stands[:-1])
    milp.add_sums([(each(columns.into), 1), (each(columns.out), 1), (leaves, 1), (stood, -1)], upper=0)
    milp.add_sums([(now, 1), (for_each_block(columns.stands[1:]), -1)], upper=0)
    # A ride costs a whole carry, however many layers share it out; all that a carry holds share one.
    carries = np.broadcast_to(columns.carry[:, None], columns.ride.shape)
    there = columns.ride.ravel() >= 0
    milp.add_sums([(columns.ride.reshape(-1, 1)[there], 1), (carries.reshape(-1, 1)[there], -1)], upper=0)
    _stations(milp, places, columns)
    _capacities(milp, places, columns)


def _stations(milp: MilpBuilder, places: Places, columns: CarrierColumns) -> None:
    """A carrier moves from where it stands to where no carrier stands."""
    layers, decks = columns.carry.shape[:2]

    def each(part: Ints) -> Ints:
        return part.reshape(layers * decks, -1)

    came, stands = np.swapaxes(columns.carry, 1, 2), columns.stands
    now, before = each(stands[1:]), each(stands[:-1])
    milp.add_sums([(now, 1), (before, -1), (each(came), -1), (each(columns.carry), 1)], lower=0, upper=0)
    for number, deck in enumerate(places.decks):
        same = [other for other, one in enumerate(places.decks) if one.station == deck.station]
        others = [other for other in same if other != number]
        milp.add_sums([(came[:, number], 1), (stands[:-1, others], 1)], upper=1)
        milp.add_sums([(came[:, same].reshape(layers, -1), 1)], upper=1)


def _capacities(milp: MilpBuilder, places: Places, columns: CarrierColumns) -> None:
    """What is on a carrier before a layer and what is loaded in it fit together: no load waits for an unload."""
    for number, deck in enumerate(places.decks):
        room = places.carriers[deck.carrier].capacity
        loads = columns.into[:, :, number].reshape(columns.into.shape[0], -1)
        stood = columns.stands[:-1, number : number + 1]
        milp.add_sums([(columns.on[:-1, :, number], 1), (loads, 1), (stood, -room)], upper=0)

"""The turn graph: who cannot move directly unless another has left, where each block is put aside by itself.

Vertex b leads to c where the removal of b comes before the placement of c in every plan. If both move directly b has
its turn first; so the blocks that move directly have to be free of cycles, and the fewest others are a minimum
*directed feedback vertex set*. Its vertices are the choices, so that rows over them are rows of the hitting set.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from smash.planners.precedence.graph import PrecedenceGraph
from smash.planners.precedence.kernels.order import Vertices

Edges = npt.NDArray[np.int8]

MOST_BLOCKS = 4000
"""With more the matrix of edges takes more memory than it is worth."""


@dataclass(frozen=True, slots=True)
class TurnGraph:
    """The graph over the choices.

    Attributes:
        edges: shape (choices, choices), 1 where one leads to the other.
        forced: choices that lead to themselves or that only a topple removes for nothing: they are taken in any case.
        free: the others.
    """

    edges: Edges
    forced: frozenset[int]
    free: npt.NDArray[np.int64]

    def vertices(self) -> Vertices:
        """Return the edges among the free choices, numbered anew in their order, as arrays."""
        inner = self.edges[np.ix_(self.free, self.free)].astype(bool)
        return Vertices(*_listed(inner), *_listed(inner.T))


def turn_graph(graph: PrecedenceGraph) -> TurnGraph | None:
    """Return the turn graph, or None where a topple frees several blocks at once or there are too many blocks."""
    alone = len(graph.choices) == int(np.count_nonzero(graph.choice_high > graph.choice_low))
    if not alone or len(graph.choices) > MOST_BLOCKS or len(set(graph.costs.tolist())) > 1:
        return None
    size = len(graph.blocks)
    chain_of: dict[int, tuple[npt.NDArray[np.int64], int]] = {}
    for chain in graph.chains:
        chain_of.update((block, (chain, rank)) for rank, block in enumerate(chain.tolist()))
    leads = np.zeros((size, size), dtype=np.int8)
    for first, (_, begin, end) in zip(graph.first, graph.piles, strict=True):
        after = np.zeros(size, dtype=np.int8)
        if first >= 0:
            after[chain_of[first][0]] = 1
        for block in range(end - 1, begin - 1, -1):
            leads[block] = after
            if block in chain_of:
                chain, rank = chain_of[block]
                after[chain[rank:]] = 1
    movers = np.flatnonzero(graph.choice_high > graph.choice_low)
    edges = leads[np.ix_(movers, movers)]
    forced = (edges.diagonal() == 1) | np.isin(movers, graph.must_free)
    return TurnGraph(edges, frozenset(np.flatnonzero(forced).tolist()), np.flatnonzero(~forced))


def _listed(edges: npt.NDArray[np.bool_]) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.int64]]:
    """Return where the neighbours of each vertex begin in a list of them, and the list."""
    first = np.concatenate(([0], np.cumsum(edges.sum(axis=1)))).astype(np.int64)
    return first, np.nonzero(edges)[1].astype(np.int64)

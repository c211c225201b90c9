"""Large-neighbourhood search: a plan that is known is taken apart in places, and planned better there."""

from smash.planners.neighbourhood.search import NeighbourhoodSearch

__all__ = ["NeighbourhoodSearch"]

"""The PDDL domains of `domains/` and which of them says what a problem needs."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from smash.problem.errors import Unsupported
from smash.problem.model import Instance, PlanOptions

DOMAINS = Path(__file__).resolve().parents[1] / "domains"
"""The hand-written domains, in the tree and in an installed package alike."""


@dataclass(frozen=True, slots=True)
class Encoding:
    """One domain of `domains/`: its file without suffix, its PDDL name, and whether topples can be capped in it."""

    file: str
    domain: str
    topple: bool = True
    capped: bool = False

    @property
    def path(self) -> Path:
        """The domain's file."""
        return DOMAINS / f"{self.file}.pddl"

    @property
    def text(self) -> str:
        """The domain's PDDL text."""
        return self.path.read_text(encoding="utf-8")


PICK_AND_PLACE = Encoding("pick-and-place", "smash-pick-and-place", topple=False)
CONDITIONAL = Encoding("topple-conditional", "smash-topple-conditional")
CHAIN = Encoding("topple-chain", "smash-topple-chain")
CHAIN_CAPPED = Encoding("topple-chain-capped", "smash-topple-chain-capped", capped=True)

ENCODINGS = {
    "pick-and-place": PICK_AND_PLACE,
    "conditional": CONDITIONAL,
    "chain": CHAIN,
    "chain-capped": CHAIN_CAPPED,
}
BY_DOMAIN = {encoding.domain: encoding for encoding in ENCODINGS.values()}
TOPPLE_ENCODINGS = ("conditional", "chain")
"""The two ways to say a topple: one action with conditional effects, or a chain of STRIPS actions."""


def cap_of(instance: Instance, options: PlanOptions) -> int | None:
    """Return `max_topple` where it binds: None where no pile can hold more blocks than that."""
    cap = options.max_topple
    return cap if options.topple and cap is not None and cap < len(instance.blocks) else None


def unsupported_reason(instance: Instance, options: PlanOptions, wanted: str) -> str | None:
    """Return why the encoding `wanted` (`conditional` or `chain`) cannot say this problem, or None."""
    cap = cap_of(instance, options)
    if wanted == "conditional" and cap is not None:
        return (
            f"the conditional encoding cannot count the blocks of a topple (max_topple {cap}); use the chain encoding"
        )
    return None


def encoding_for(instance: Instance, options: PlanOptions, wanted: str) -> Encoding:
    """Return the domain for a problem under `options`, topples told in the way `wanted`.

    Without topple both ways are the same pick-and-place domain.

    Raises:
        Unsupported: where `wanted` cannot say it.
    """
    reason = unsupported_reason(instance, options, wanted)
    if reason is not None:
        raise Unsupported(reason)
    if not options.topple:
        return PICK_AND_PLACE
    if wanted == "conditional":
        return CONDITIONAL
    return CHAIN if cap_of(instance, options) is None else CHAIN_CAPPED

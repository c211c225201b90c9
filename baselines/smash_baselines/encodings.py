"""PDDL encodings: the domains of `domains/`, those that others register, and which of them a problem needs.

Topples at cost 1 have hand-written domains. Where an instance has further aggregating actions or costs, its domain is
put together by `smash_baselines.parts`.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

from smash.problem.entry_points import entry_points_of
from smash.problem.errors import SmashError, Unsupported
from smash.problem.model import Instance, PlanOptions
from smash.problem.problem import Problem
from smash_baselines.domains import DOMAINS
from smash_baselines.goal_words import judged_text, told, words_of
from smash_baselines.parts.domain import domain_name, domain_text, text_without_costs
from smash_baselines.parts.part import Part
from smash_baselines.parts.registry import parts_of

GROUP = "smash.encodings"
"""The entry-point group of encodings from outside: a name to an `Encoding`."""


@dataclass(frozen=True, slots=True)
class Encoding:
    """A way to tell topples in PDDL: a domain, and which of the compiler's facts and steps it knows.

    Every domain has the predicates and the pick and place actions of `domains/pick-and-place.pddl`. A topple is the
    action `(topple ?b ?under)` or, at height 1, `(topple-base ?b ?l)`, where `?b` is the lowest block that falls;
    in a `chain` it is `topple-begin`, `topple-drop`, `topple-end`, as in `domains/topple-chain.pddl`.

    Attributes:
        name: how it is called in records.
        domain: the domain's PDDL name.
        text: the domain's PDDL text.
        topple: whether it can topple at all.
        chain: whether `(top ?b ?region)` tells stacks from buffers and `(idle)` holds between topples.
        closure: whether `(above …)` and `(stacked …)` hold at the start, as in `domains/topple-conditional.pddl`.
        capped: whether it counts the blocks of a topple, from `(cap ?k)` down.
        with_cap: the encoding that takes its place where `max_topple` binds; None: it cannot say that.
        parts: of a domain of `smash_baselines.parts`, what it is put together from; they say facts and steps.
        judged: whether it can say the words of a goal that hold in several ways (`smash_baselines.goal_words`).
        costs: whether actions have costs, and a problem minimises them.
    """

    name: str
    domain: str
    text: str
    topple: bool = True
    chain: bool = False
    closure: bool = False
    capped: bool = False
    with_cap: Encoding | None = None
    parts: tuple[Part, ...] = ()
    judged: bool = False
    costs: bool = True

    def with_words(self) -> Encoding:
        """Return this encoding with the words of goals that hold in several ways."""
        text = judged_text(self.text, self.domain, regions=self.chain or bool(self.parts))
        text = text if self.costs else text_without_costs(text)
        return replace(self, name=f"{self.name}-words", domain=f"{self.domain}-words", text=text, judged=True)

    def without_costs(self) -> Encoding:
        """Return this encoding for planners that know no costs: plans are as short as they are cheap."""
        name, domain = f"{self.name}-no-costs", f"{self.domain}-no-costs"
        text = text_without_costs(self.text).replace(f"(domain {self.domain})", f"(domain {domain})", 1)
        return replace(self, name=name, domain=domain, text=text, costs=False)

    @property
    def conditional_effects(self) -> bool:
        """Whether it needs a planner that takes conditional effects (or axioms)."""
        return re.search(r"\(\s*(when|:derived)\b", re.sub(r";.*", "", self.text)) is not None


class UnknownEncoding(SmashError):
    """A name that no encoding has; the message lists the valid ones."""

    def __init__(self, name: str, known: list[str]) -> None:
        self.name = name
        self.known = known
        super().__init__(f"no encoding is called {name!r}; known: {', '.join(known)}")


def action_names(domain_text: str) -> frozenset[str]:
    """Return the names of a domain's actions."""
    return frozenset(re.findall(r"\(\s*:action\s+([^\s()]+)", domain_text.lower()))


def _filed(file: str) -> str:
    return (DOMAINS / f"{file}.pddl").read_text(encoding="utf-8")


PICK_AND_PLACE = Encoding("pick-and-place", "smash-pick-and-place", _filed("pick-and-place"), topple=False)
PICK_AND_PLACE_NO_COSTS = PICK_AND_PLACE.without_costs()
CONDITIONAL = Encoding("topple-conditional", "smash-topple-conditional", _filed("topple-conditional"), closure=True)
CHAIN_CAPPED = Encoding(
    "topple-chain-capped", "smash-topple-chain-capped", _filed("topple-chain-capped"), chain=True, capped=True
)
CHAIN = Encoding("topple-chain", "smash-topple-chain", _filed("topple-chain"), chain=True, with_cap=CHAIN_CAPPED)

ENCODINGS = {
    "pick-and-place": PICK_AND_PLACE,
    "conditional": CONDITIONAL,
    "chain": CHAIN,
    "chain-capped": CHAIN_CAPPED,
}
BY_DOMAIN = {
    encoding.domain: encoding
    for plain in (*ENCODINGS.values(), PICK_AND_PLACE_NO_COSTS)
    for encoding in (plain, plain.with_words())
}
"""Every domain that is read back, by its PDDL name."""
TOPPLE_ENCODINGS = ("conditional", "chain")
"""The two ways of this package to tell a topple: one action with conditional effects, or a chain of STRIPS actions."""
NO_COSTS = "pick-and-place"
"""The way for planners that know neither costs nor a topple; the engines of this package have no use for it."""
COMPOSED = "chain"
"""The way in which further aggregating actions and costs can be told."""


def encoding_names() -> list[str]:
    """Return how topples can be told: the ways of this package, then those that others registered."""
    return [*TOPPLE_ENCODINGS, *sorted(set(entry_points_of(GROUP).names) - set(TOPPLE_ENCODINGS))]


def get_encoding(name: str) -> Encoding:
    """Return the way to tell topples that is called `name`, or the one that tells none.

    Raises:
        UnknownEncoding: where none is called so.
        Unsupported: where its module cannot be loaded, or holds no `Encoding`.
    """
    if name == NO_COSTS:
        return PICK_AND_PLACE_NO_COSTS
    if name in TOPPLE_ENCODINGS:
        return ENCODINGS[name]
    entries = entry_points_of(GROUP).select(name=name)
    if not entries:
        raise UnknownEncoding(name, [*encoding_names(), NO_COSTS])
    try:
        encoding = next(iter(entries)).load()
    except (ImportError, AttributeError) as error:
        raise Unsupported(f"encoding {name!r} is not installed: {error}") from None
    if not isinstance(encoding, Encoding):
        raise Unsupported(f"encoding {name!r} is no smash_baselines.encodings.Encoding")
    return encoding


def cap_of(instance: Instance, options: PlanOptions) -> int | None:
    """Return `max_topple` where it binds: None where no pile can hold more blocks than that."""
    cap = options.max_topple
    return cap if options.topple and cap is not None and cap < len(instance.blocks) else None


def family_encoding(instance: Instance, options: PlanOptions) -> Encoding:
    """Return the encoding that knows exactly the actions and the costs of an instance."""
    parts = parts_of(instance, options)
    texts = {part.file(instance, options): part.text(instance, options) for part in parts}
    name = domain_name(list(texts))
    return Encoding(name.removeprefix("smash-"), name, domain_text(texts), parts=parts)


def unsupported_reason(problem: Problem, wanted: str) -> str | None:
    """Return why the encoding `wanted` (`conditional`, `chain`, …) cannot say this problem, or None.

    Raises:
        UnknownEncoding: where none is called so.
    """
    cap = cap_of(problem.instance, problem.options)
    if wanted == NO_COSTS and problem.plain and problem.options.topple:
        return f"the {wanted} encoding has no topple (`--no-topple` leaves that out)"
    if not problem.plain:
        get_encoding(wanted)
        return (
            None
            if wanted == COMPOSED
            else f"the {wanted} encoding knows topple alone, at cost 1; use the chain encoding"
        )
    if cap is not None and get_encoding(wanted).with_cap is None:
        return f"the {wanted} encoding cannot count the blocks of a topple (max_topple {cap}); use the chain encoding"
    return None


def encoding_for(problem: Problem, wanted: str) -> Encoding:
    """Return the encoding of a problem, topples told in the way `wanted`.

    Without topple all ways are the same pick-and-place domain. A goal that `ontable` or `clear`
    leaves open adds its words.

    Raises:
        UnknownEncoding: where none is called so.
        Unsupported: where `wanted` cannot say it.
    """
    instance, options = problem.instance, problem.options
    reason = unsupported_reason(problem, wanted)
    if reason is not None:
        raise Unsupported(reason)
    encoding = get_encoding(wanted)
    if not problem.plain:
        encoding = family_encoding(instance, options)
    elif wanted == NO_COSTS:
        encoding = PICK_AND_PLACE_NO_COSTS
    elif not options.topple:
        encoding = PICK_AND_PLACE
    elif cap_of(instance, options) is not None:
        encoding = encoding.with_cap or encoding
    return encoding.with_words() if words_of(told(problem).goal) else encoding

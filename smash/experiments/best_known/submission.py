"""Judge a submitted plan against the list of best known costs, and put it on the list."""

from __future__ import annotations

from dataclasses import dataclass

from smash.experiments.best_known.standing import (
    BestKnown,
    Entry,
    Found,
    open_instances,
    options_of,
    variant_name,
)
from smash.problem.certificate import Certificate, proven_bound
from smash.problem.errors import MalformedFile, SmashError
from smash.problem.plan import Plan, check_plan
from smash.problem.rules import Law


class RefusedSubmission(SmashError):
    """A plan that the law refuses."""

    exit_code = 3


@dataclass(frozen=True, slots=True)
class Judgement:
    """What a submission is worth: whether it improves on the list, and why, in one line."""

    improves: bool
    words: str


def checked_bound(known: BestKnown, plan: Plan, certificate: Certificate | None) -> int | None:
    """Check a submission as far as it can be refused; return the lower bound that its certificate proves.

    Raises:
        MalformedFile: where its instance or its variant is not on the list.
        RefusedSubmission: where the law refuses the plan.
        RefusedCertificate: where the certificate does not prove what it says.
    """
    instance = open_instances().get(plan.instance)
    listed = known.variants(plan.instance)
    if instance is None or not listed:
        names = sorted({name for name, _ in known.entries})
        which = f"{names[0]} … {names[-1]}" if names else "it is empty"
        raise MalformedFile(plan.instance, f"no instance of the list ({which})")
    verdict = check_plan(instance, plan)
    if not verdict.accepted:
        raise RefusedSubmission(f"refused: {plan.instance} {variant_name(plan.options)}: {verdict}")
    return None if certificate is None else proven_bound(instance, plan.options, certificate)


def judge(known: BestKnown, plan: Plan, certificate: Certificate | None = None) -> Judgement:
    """Say whether a plan, or the lower bound of its certificate, improves on the list.

    A plan counts in every variant that allows it: one whose topples drop at most 2 blocks is one under `topple` too.

    Raises:
        SmashError: as `checked_bound`.
    """
    bound = checked_bound(known, plan, certificate)
    assert plan.actions is not None
    entries = [known.entries[plan.instance, variant] for variant in known.variants(plan.instance)]
    open_to = [entry for entry in entries if _allowed(entry, plan)]
    if not open_to:
        listed = ", ".join(entry.variant for entry in entries)
        raise MalformedFile(plan.instance, f"no variant of the list allows this plan; it has {listed}")
    better = [entry for entry in open_to if entry.cost is None or len(plan.actions) < entry.cost]
    tighter = [entry for entry in entries if _tightens(entry, plan, bound)]
    own = variant_name(plan.options)
    shown = min(better or open_to, key=lambda entry: (entry.variant != own, entry.cost or 0))
    words = [_cost_words(shown, plan)]
    words += [f"improves {entry.variant} too" for entry in better if entry is not shown]
    words += [f"raises the lower bound of {entry.variant} from {entry.lower_bound} to {bound}" for entry in tighter]
    words += _claim_words(shown, plan, bound)
    return Judgement(bool(better or tighter), "; ".join(words))


def accept(known: BestKnown, plan: Plan, found: Found, certificate: Certificate | None = None) -> list[Entry]:
    """Put a submission on the list; return the entries that it improves, as they were.

    Raises:
        SmashError: as `checked_bound`.
    """
    bound = checked_bound(known, plan, certificate)
    assert plan.actions is not None
    improved = known.offer_plan(plan.instance, plan.actions, found)
    return improved + (known.offer_bound(plan.instance, plan.options, bound, found) if bound is not None else [])


def _allowed(entry: Entry, plan: Plan) -> bool:
    law = Law(open_instances()[entry.instance], options_of(entry.variant))
    return plan.actions is not None and law.check(plan.actions).accepted


def _tightens(entry: Entry, plan: Plan, bound: int | None) -> bool:
    return bound is not None and plan.options.includes(options_of(entry.variant)) and bound > (entry.lower_bound or -1)


def _cost_words(entry: Entry, plan: Plan) -> str:
    assert plan.actions is not None
    cost, best = len(plan.actions), entry.cost
    verdict = "improves" if best is None or cost < best else "equals" if cost == best else "is worse"
    held = "no plan was known" if entry.found is None else f"best known {best} by {entry.found.by}"
    if entry.lower_bound is not None:
        held += ", proven optimal" if entry.proven else f", lower bound {entry.lower_bound}"
    return f"{verdict}: {entry.instance} {entry.variant}: {cost} actions, {held}"


def _claim_words(entry: Entry, plan: Plan, bound: int | None) -> list[str]:
    assert plan.actions is not None
    words = []
    if entry.lower_bound is not None and len(plan.actions) < entry.lower_bound:
        words.append("it is legal and below a bound called proven: the list is wrong, please report it")
    if bound is None and plan.lower_bound is not None and plan.lower_bound > (entry.lower_bound or -1):
        words.append(f"its lower bound {plan.lower_bound} is not believed without --certificate")
    return words

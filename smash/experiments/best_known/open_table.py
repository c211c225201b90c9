"""What is still open, as a Markdown table made from the list of best known costs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from smash.experiments.best_known.files import goal_kind
from smash.experiments.best_known.standing import BestKnown, Entry, Found, open_instances
from smash.problem.errors import MalformedFile
from smash.problem.sets.open_instances import GENERATIONS

BEGIN = "<!-- made by `smash best-known table`: begin -->\n"
END = "<!-- made by `smash best-known table`: end -->\n"
SOURCE = "<!-- from: make best-known -> results/best-known/best-known.csv -->"


def open_table(known: BestKnown) -> str:
    """Return how much of each generation, family and variant is proven, and a row for everything that is not."""
    entries = known.sorted()
    rows = [_row(entry) for entry in entries if not entry.proven]
    variants = list(dict.fromkeys(entry.variant for entry in entries))
    families = dict.fromkeys(_family(entry) for entry in entries)
    counts = [[family, *(_count(entries, family, variant) for variant in variants)] for family in families]
    head = ("instance", "blocks", "stacks", "buffers", "goal", "variant", "best", "bound", "gap", "best by", "bound by")
    return "\n".join(
        [
            _standing(entries),
            SOURCE,
            "",
            *_markdown(["proven, of all", *variants], counts),
            SOURCE,
            "",
            f"Still open: {len(rows)}.",
            "",
            *_markdown(head, rows),
            SOURCE,
            "",
        ]
    )


def put_between(page: str, text: str, where: str) -> str:
    """Return a page with `text` between its marks.

    Raises:
        MalformedFile: where it has not both marks.
    """
    before, begun, rest = page.partition(BEGIN)
    _, ended, after = rest.partition(END)
    if not begun or not ended:
        raise MalformedFile(where, f"no line {BEGIN.strip()} with {END.strip()} after it")
    return before + BEGIN + text + END + after


def _family(entry: Entry) -> str:
    return entry.instance.rpartition("-")[0]


def _standing(entries: Sequence[Entry]) -> str:
    """Return how many are proven, of all and of each generation, so that the earlier counts go on as they were."""
    shares = [f"Proven optimal: {_share(entries)}"]
    for generation, families in GENERATIONS.items():
        mine = [entry for entry in entries if _family(entry) in families]
        shares += [f"of the {generation} sets {_share(mine)}"] if mine else []
    return f"{'; '.join(shares)}."


def _share(entries: Sequence[Entry]) -> str:
    return f"{sum(entry.proven for entry in entries)} of {len(entries)}"


def _count(entries: Sequence[Entry], family: str, variant: str) -> str:
    mine = [entry for entry in entries if _family(entry) == family and entry.variant == variant]
    return _share(mine) if mine else "–"


def _row(entry: Entry) -> list[str]:
    instance = open_instances()[entry.instance]
    sizes = (len(instance.blocks), len(instance.stacks), len(instance.buffers))
    gap = "–" if entry.gap is None or not entry.cost else f"{entry.gap} ({100 * entry.gap / entry.cost:.0f} %)"
    known = ["–" if value is None else str(value) for value in (entry.cost, entry.lower_bound)]
    whom = [_who(entry.found), _who(entry.bound)]
    return [entry.instance, *map(str, sizes), goal_kind(instance), entry.variant, *known, gap, *whom]


def _who(found: Found | None) -> str:
    if found is None:
        return "–"
    return found.by if found.origin in ("", found.by) else f"{found.by} ({found.origin})"


def _markdown(head: Sequence[str], rows: Iterable[Sequence[str]]) -> list[str]:
    lines = [head, ["---"] * len(head), *rows]
    return [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines]

"""`python -m smash_analysis.readme`: the README's figures and tables, drawn from the records in `results/`.

Each figure that is drawn carries a hash of the data that it shows in its PNG metadata, so that whether it is current
does not hang on fonts or on the version of what draws it. In a page, a table between `<!-- FILE -->` and
`<!-- end -->` is the content of `results/FILE`.
"""

from __future__ import annotations

import argparse
import hashlib
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from smash.problem.errors import MalformedFile, SmashError
from smash.records.reading import NoRecords
from smash_analysis.charts.heatmaps import planner_figure
from smash_analysis.command import fail
from smash_analysis.scaling import scaling_chart
from smash_analysis.tables.believed import runs_of
from smash_analysis.tables.cells import matched_cells, variant_cells
from smash_analysis.tables.readings import readings

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ROOT = Path(__file__).parents[2]
DATA = "Data SHA-256"
"""The PNG's text field that holds the hash of what it shows."""
PAGES = ("README.md", "docs/results.md", "docs/pddl.md", "docs/layered.md")
BLOCK = re.compile(r"(<!-- ([a-z][\w./-]+\.md) -->\n)(.*?)(<!-- end -->)", re.DOTALL)

Drawing = tuple[str, Callable[[], "Figure"]]
"""The hash of the data, and what draws them."""


def ablation(folder: str, label: str) -> Callable[[Path], Drawing]:
    """Return what draws the heatmaps of a label on the paper's multi-goal set, from the records of a folder."""
    suite = "multi-9"

    def drawing(results: Path) -> Drawing:
        read = readings([r for r in runs_of(results / folder) if (r.label, r.suite) == (label, suite)])
        cells, matched = variant_cells(read), matched_cells(read)
        return data_hash(cells, matched), lambda: planner_figure(label, suite, cells, matched)

    return drawing


def scaling(results: Path) -> Drawing:
    """Return the curves of time to a proven optimum over blocks."""
    file = results / "scaling" / "scaling.csv"
    if not file.is_file():
        raise NoRecords(str(file), "is not there")
    cells = pd.read_csv(file, dtype={"room": str})
    return data_hash(cells), scaling_chart(cells, "proof_seconds").figure


DRAWN = {
    "docs/figures/ablation-flow.png": ablation("ablation-full", "smash-flow cold (CP-SAT)"),
    "docs/figures/ablation-layered-cold.png": ablation("ablation", "smash-layered cold"),
    "docs/figures/scaling-proofs.png": scaling,
}
COPIED = {"docs/topple-map.png": "topple-map/map.png"}
"""Pictures that a stage has drawn itself."""


def data_hash(*tables: pd.DataFrame) -> str:
    """Return a hash of what tables show: their values to nine digits."""
    text = "\n".join(table.to_csv(index=False, float_format="%.9g") for table in tables)
    return hashlib.sha256(text.encode()).hexdigest()


def update(results: Path, root: Path) -> Iterator[tuple[str, str]]:
    """Bring the figures and tables below `root` up to date; yield (file, what became of it).

    What comes of it: `current`, `made`, or why it was left as it is.
    """
    for name, source in DRAWN.items():
        yield name, _draw(source, results, root / name)
    for name, picture in COPIED.items():
        yield name, _copy(results / picture, root / name)
    for name in PAGES:
        if (root / name).is_file():
            yield from _fill(root / name, name, results)


def _draw(source: Callable[[Path], Drawing], results: Path, target: Path) -> str:
    try:
        known, draw = source(results)
    except MalformedFile as error:
        return f"left: {error}"
    if target.is_file() and shown_hash(target) == known:
        return "current"
    target.parent.mkdir(parents=True, exist_ok=True)
    draw().savefig(target, dpi=200, metadata={DATA: known})
    return "made"


def shown_hash(picture: Path) -> str | None:
    """Return the hash of the data that a PNG shows, as it was written into it; None where it says none."""
    from PIL import Image

    with Image.open(picture) as image:
        found = image.info.get(DATA)
    return None if found is None else str(found)


def _copy(source: Path, target: Path) -> str:
    if not source.is_file():
        return f"left: {source} is not there"
    content = source.read_bytes()
    if target.is_file() and target.read_bytes() == content:
        return "current"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(content)
    return "made"


def _fill(page: Path, name: str, results: Path) -> Iterator[tuple[str, str]]:
    text = page.read_text(encoding="utf-8")
    for found in BLOCK.finditer(text):
        source = results / found[2]
        if not source.is_file():
            yield f"{name}, table {found[2]}", f"left: {source} is not there"
            continue
        table = source.read_text(encoding="utf-8")
        yield f"{name}, table {found[2]}", "current" if table == found[3] else "made"
        text = text.replace(found[0], found[1] + table + found[4])
    if text != page.read_text(encoding="utf-8"):
        page.write_text(text, encoding="utf-8")


def main() -> None:
    """Bring the figures and tables up to date and say what was done."""
    parser = argparse.ArgumentParser(prog="python -m smash_analysis.readme", description=__doc__)
    parser.add_argument("--results", type=Path, default=ROOT / "results", help="default: the repository's")
    parser.add_argument("--root", type=Path, default=ROOT, help="of README.md and docs/ (default: the repository)")
    arguments = parser.parse_args()
    if arguments.root == ROOT and not (ROOT / "README.md").is_file():
        fail(SmashError("no README.md here: run it in a checkout of the repository, or give --root and --results"))
    try:
        for name, what in update(arguments.results, arguments.root):
            print(f"{name}: {what}")
    except OSError as error:
        fail(MalformedFile(str(error.filename), str(error.strerror)))


if __name__ == "__main__":
    main()

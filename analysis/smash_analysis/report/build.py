"""From sources to sections: what each kind of record has to say, in one order."""

from __future__ import annotations

from smash_analysis.report.appendix import appendix
from smash_analysis.report.blocks import Block, Section, Words
from smash_analysis.report.execution import execution_blocks, execution_headlines
from smash_analysis.report.growth import growth_blocks, growth_headlines
from smash_analysis.report.landings import landing_blocks, landing_headlines
from smash_analysis.report.planning import Planning
from smash_analysis.report.sources import Source
from smash_analysis.report.stores import episode_store, run_store, trial_store


def section(source: Source) -> Section:
    """Return all that the report shows of one source."""
    headlines: list[str] = []
    figures: list[tuple[str, str]] = []
    blocks: list[Block] = []
    stores = {}
    if source.runs:
        planning = Planning(source)
        figures += planning.figures()
        headlines += planning.headlines()
        blocks += planning.blocks()
        stores["runs"] = run_store(source.runs)
    if source.scaling is not None:
        headlines += growth_headlines(source.scaling)
        blocks += growth_blocks(source.scaling)
        figures.append((f"{int(source.scaling['runs'].sum())}", "runs, records not kept"))
    if source.episodes:
        figures.append((f"{len(source.episodes)}", "episodes carried out"))
        headlines += execution_headlines(source.episodes)
        # Plans that were carried out are of most interest as such: before the planners' figures.
        blocks = execution_blocks(source.episodes) + blocks
        stores["episodes"] = episode_store(source.episodes)
    if source.trials:
        figures.append((f"{len(source.trials)}", "topples tried"))
        headlines += landing_headlines(source.trials)
        blocks += landing_blocks(source.trials)
        stores["trials"] = trial_store(source.trials)
    if source.notes:
        blocks.insert(0, Words("left-out", "What does not count", source.notes))
    if source.contradictions:
        blocks.insert(0, Words("contradictions", "Contradictions between planners", source.contradictions))
    if source.problems:
        blocks.insert(0, Words("unread", "What could not be read", [str(problem) for problem in source.problems]))
    return Section(source.title, source.title, _lead(source), headlines, figures, blocks, appendix(source), stores)


def _lead(source: Source) -> str:
    """Return what the experiment file says of itself: the comment at its head; empty where there is none."""
    lines = []
    for line in source.experiment.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("# ").rstrip())
    return " ".join(lines)

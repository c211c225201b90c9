"""Folders of PDDL problems: which files there are, how their instances are called, which domain is whose."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from smash.problem.blocksworld.domain import read_domain
from smash.problem.blocksworld.problem import BlocksProblem, blocks_problem
from smash.problem.blocksworld.roles import Recognizer
from smash.problem.blocksworld.sections import ProblemText, read_problem
from smash.problem.blocksworld.text import read_text
from smash.problem.errors import MalformedFile, SmashError

DOMAIN_FILE = "domain.pddl"
_GAP = r"(?:\s|;[^\r\n]*)*+"
_DOMAIN = re.compile(rf"{_GAP}\({_GAP}define{_GAP}\({_GAP}domain{_GAP}([^\s();]+)", re.IGNORECASE)


@dataclass(frozen=True)
class Found:
    """A PDDL file that was asked for.

    Attributes:
        path: the file.
        root: the folder that it was found under; its own, where the file itself was named.
        name: what its instance is called: its path from the root, with hyphens.
    """

    path: Path
    root: Path
    name: str


def found_files(given: Iterable[Path]) -> list[Found]:
    """Return the PDDL files of folders, their sub-folders included, and the files that are named themselves.

    Names that would stand twice get the folder's name, then a number.

    Raises:
        MalformedFile: where a path is neither a file nor a folder with a PDDL file.
    """
    found: dict[Path, Found] = {}
    for path in given:
        if not path.is_dir():
            found.setdefault(path, Found(path, path.parent, path.stem))
            continue
        # A link to nowhere is named where it is read.
        files = sorted(
            file
            for file in path.rglob("*")
            if file.suffix.lower() == ".pddl" and (file.is_file() or (file.is_symlink() and not file.exists()))
        )
        if not files:
            raise MalformedFile(str(path), "the folder holds no PDDL file (*.pddl)")
        for file in files:
            name = "-".join(file.relative_to(path).with_suffix("").parts)
            found.setdefault(file, Found(file, path, name))
    return _named_apart(list(found.values()))


def _named_apart(found: Sequence[Found]) -> list[Found]:
    for rename in (_with_folder, _with_number):
        count = Counter(one.name.casefold() for one in found)
        seen: Counter[str] = Counter()
        renamed = []
        for one in found:
            key = one.name.casefold()
            seen[key] += 1
            renamed.append(one if count[key] == 1 else Found(one.path, one.root, rename(one, seen[key])))
        found = renamed
    return list(found)


def _with_folder(one: Found, _: int) -> str:
    return f"{one.root.resolve().name}-{one.name}"


def _with_number(one: Found, number: int) -> str:
    return one.name if number == 1 else f"{one.name}-{number}"


@dataclass
class Importer:
    """Reads problems with the domain that is given, or with the one that lies beside them.

    Attributes:
        domain: the domain file of all problems; None: the one that lies beside each.
        beside: whether to look for domains beside the problems.
    """

    domain: Path | None = None
    beside: bool = True
    _recognizers: dict[Path, Recognizer | SmashError] = field(default_factory=dict)
    _domains_in: dict[Path, dict[str, list[Path]]] = field(default_factory=dict)

    def is_domain(self, path: Path) -> bool:
        """Return whether a file is a domain."""
        return self.domain == path or _domain_name(path) is not None

    def problem(self, found: Found) -> BlocksProblem:
        """Read a problem.

        Raises:
            SmashError: with one line that says what is wrong.
        """
        text = read_problem(found.path)
        paths: list[Path | None] = [self.domain] if self.domain is not None else self._domains_of(text, found)
        refused: SmashError | None = None
        for path in paths or [None]:
            try:
                return blocks_problem(text, None if path is None else self.recognizer(path))
            except SmashError as error:
                refused = refused or error
        assert refused is not None
        raise refused

    def recognizer(self, path: Path) -> Recognizer:
        """Return the recognizer of a domain file; it is read once.

        Raises:
            SmashError: where it is no domain that can be read.
        """
        if path not in self._recognizers:
            try:
                self._recognizers[path] = Recognizer(read_domain(path))
            except SmashError as error:
                self._recognizers[path] = error
        recognizer = self._recognizers[path]
        if isinstance(recognizer, SmashError):
            raise recognizer
        return recognizer

    def _domains_of(self, text: ProblemText, found: Found) -> list[Path | None]:
        """Return what may be the domain of a problem, the likeliest first: in its folder, or above it up to the root.

        It is the one that the problem names, or the one called `domain.pddl`, or else none (None). Several of one name
        are tried, first those that are called like the problem's folder.
        """
        folder = found.path.parent
        while self.beside:
            domains = self._domains(folder)
            named = domains.get(text.domain or "", [])
            own = [path for paths in domains.values() for path in paths if path.name.lower() == DOMAIN_FILE]
            alike = [len(path.stem) * found.path.parent.name.startswith(path.stem) for path in named]
            if named:
                return [path for _, path in sorted(zip(alike, named, strict=True), key=lambda pair: -pair[0])]
            if own or folder in (found.root, folder.parent):
                return [*own, None]
            folder = folder.parent
        return []

    def _domains(self, folder: Path) -> dict[str, list[Path]]:
        """Return the domain files of a folder by the names of their domains."""
        if folder not in self._domains_in:
            by_name: dict[str, list[Path]] = {}
            for path in sorted(folder.iterdir()):
                name = _domain_name(path) if path.suffix.lower() == ".pddl" and path.is_file() else None
                if name is not None:
                    by_name.setdefault(name, []).append(path)
            self._domains_in[folder] = by_name
        return self._domains_in[folder]


def _domain_name(path: Path) -> str | None:
    """Return the name of the domain that a file begins to define; None where it defines none."""
    try:
        begun = _DOMAIN.match(read_text(path))
    except SmashError:
        return None
    return None if begun is None else begun[1].lower()

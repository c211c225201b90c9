"""Recognising a blocks world by what its actions do: which predicate says what, and which action is which step.

No name is trusted. For each changing predicate the things that it may say of a state are tried, one predicate after
the other; an assignment is dropped as soon as some step of the blocks world can no longer be an action. One that is
whole is taken if the actions, tried on every arrangement of a few blocks, do all steps and nothing else (`trial`).
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from smash.problem.blocksworld.cast import Cast, CastMaker, Objects, Place, Sorts
from smash.problem.blocksworld.domain import Domain
from smash.problem.blocksworld.formula import Atom
from smash.problem.blocksworld.reading import Reading, Template, usual_relation
from smash.problem.blocksworld.stand_in import stand_in, without_names
from smash.problem.blocksworld.trial import Grounded, Meanings, Misfit, Trial, samples, step_words
from smash.problem.blocksworld.world import RELATIONS, Meaning, Step
from smash.problem.errors import Infeasible, SmashError, Unsupported

Options = tuple[tuple[int, ...], dict[int, str]] | None
MOST_EFFECTS = 40
"""The most effects of one action; two steps of a blocks world at once have some ten."""
MOST_TRIED = 300
"""The most assignments, whole ones and parts: what fits is found among the first hundred."""
FEW, SOME = 3, 4
"""How many blocks the search looks at, and the check of what it found."""


class Recognizer:
    """Recognises the problems of one domain; problems that its actions cannot tell apart are recognised once."""

    def __init__(self, domain: Domain) -> None:
        self.domain = domain
        self.sorts = Sorts(domain)
        self._known: dict[tuple[Place, Cast], Reading | Misfit] = {}
        self._tried = 0

    def reading(self, objects: Objects, facts: Sequence[Atom], where: str) -> Reading:
        """Return how the domain tells a blocks world with the objects and the start of a problem.

        Args:
            objects: the problem's objects and their types; the domain's constants are added.
            facts: the facts of its start.
            where: the problem's file, for errors.

        Raises:
            Unsupported: where it is no blocks world, with what does not fit.
            Infeasible: where there is no object for an argument that every action has.
        """
        for action in self.domain.actions:
            if len(action.effects) > MOST_EFFECTS:
                words = f"{action.name!r} has {len(action.effects)} effects"
                raise Unsupported(f"{self.domain.where}: the domain {self.domain.name!r} is no blocks world: {words}")
        everything = dict(self.domain.constants) | dict(objects)
        maker = CastMaker(self.domain, self.sorts, everything, facts)
        misfits = [Misfit("no predicate that actions change says what lies on what", -1)]
        for sort in self.sorts.of_blocks:
            if not self.sorts.members(sort, everything, facts) and facts:
                raise Infeasible(f"{where}: no object is what the actions of {self.domain.name!r} act on: none applies")
            for table in maker.tables(sort):
                cast = maker.cast(sort, table)
                found = self._known.get((sort, cast))
                if found is None:
                    found = self._known[sort, cast] = self._search(cast, where)
                if isinstance(found, Reading):
                    return found
                misfits.append(found)
        best = max(misfits, key=lambda misfit: misfit.assigned)
        raise Unsupported(f"{self.domain.where}: the domain {self.domain.name!r} is no blocks world: {best.words}")

    def reading_of_blocks(self, blocks: Sequence[str]) -> Reading:
        """Return how the domain tells a blocks world of some blocks, where there is no problem file.

        There is one hand, if any, and what never changes holds of all blocks, or else of none.

        Raises:
            Unsupported: where that is no blocks world.
        """
        refused: SmashError | None = None
        single = [name for name, arity in self.domain.fluents.items() if arity == 1]
        for whole, of_table in itertools.product((True, False), (None, *single)):
            for sort in self.sorts.of_blocks:
                objects, facts = stand_in(self.domain, self.sorts, sort, blocks, whole=whole, of_table=of_table)
                try:
                    return without_names(self.reading(objects, facts, self.domain.where), frozenset(objects))
                except SmashError as error:
                    refused = refused or error
        hint = "; with --problem more is known"
        raise Unsupported(f"{refused or self.domain.where + ': no blocks world'}{hint}")

    def _search(self, cast: Cast, where: str) -> Reading | Misfit:
        """Look for the meanings of all predicates, with a hand, then without."""
        if not cast.kinds:
            return Misfit("no object is a block", -1)
        options = {name: self._places(name, cast, where) for name in self.domain.fluents}
        misfits: list[Misfit] = []
        for hand in (True, False):
            self._tried = 0
            trial = Trial(self.domain, self.sorts, cast, samples(len(cast.kinds), FEW)[0], hand)
            for meanings in self._assign(trial, self._order(options), {}, options, misfits):
                found = self._checked(trial, meanings)
                if isinstance(found, Reading):
                    return found
                misfits.append(found)
        return max(misfits, key=lambda misfit: misfit.assigned)

    def _places(self, predicate: str, cast: Cast, where: str) -> Options:
        """Return which arguments of a predicate are blocks, and the one object of each other argument.

        None: an argument has several objects or none, and the blocks do not depend on the predicate.
        """
        places: list[int] = []
        fixed: dict[int, str] = {}
        for number in range(self.domain.fluents[predicate]):
            sort = self.sorts.find((predicate, number))
            if sort == cast.sort:
                places.append(number)
                continue
            there = dict(cast.rest)[sort]
            if len(there) == 1:
                fixed[number] = there[0]
            elif predicate not in self._needed(cast.sort):
                return None
            elif there:
                several = "hands or tables" if places else "hands"
                raise Unsupported(f"{where}: several {several} ({', '.join(there[:4])}); one is supported")
            else:
                raise Infeasible(f"{where}: there is no object for ({predicate} …): no action of the domain applies")
        return tuple(places), fixed

    def _needed(self, sort: Place) -> frozenset[str]:
        """Return the changing predicates that the moves of blocks depend on."""
        fluents = self.domain.fluents
        needed = {name for name, arity in fluents.items() if arity == 2 and self.sorts.find((name, 0)) == sort}
        before: set[str] = set()
        while needed != before:
            before = set(needed)
            for action in self.domain.actions:
                if not needed.isdisjoint(action.writes):
                    needed |= action.reads
            for predicate in needed & set(self.domain.rule_reads):
                needed |= self.domain.rule_reads[predicate]
        return frozenset(needed & set(fluents))

    def _order(self, options: Mapping[str, Options]) -> list[str]:
        """Return the predicates with those first of which there is least to choose from."""
        choices = {2: 0, 0: 1, 1: 2}
        return sorted(options, key=lambda name: choices.get(len((options[name] or ((), {}))[0]), 3))

    def _assign(
        self,
        trial: Trial,
        names: Sequence[str],
        meanings: dict[str, Meaning | None],
        options: Mapping[str, Options],
        misfits: list[Misfit],
    ) -> Iterator[dict[str, Meaning | None]]:
        """Yield the assignments under which every step of the blocks world may be an action.

        Args:
            trial: the blocks to try it on.
            names: the predicates that have no meaning yet.
            meanings: what the others say.
            options: what each may be about.
            misfits: gets what was missing.
        """
        if not names:
            yield dict(meanings)
            return
        name, *rest = names
        for meaning in self._choices(name, options[name], trial):
            tried = {**meanings, name: meaning}
            self._tried += 1
            if self._tried > MOST_TRIED:
                return
            step = None if meaning is None else trial.missing(tried)
            if step is None:
                yield from self._assign(trial, rest, tried, options, misfits)
            else:
                misfits.append(Misfit(f"no action {step_words(step)}", len(tried) + len(names) * self._usual(tried)))

    def _usual(self, meanings: Meanings) -> bool:
        """Whether every predicate says what its name usually says: what is missing then is worth telling first."""
        said = [(name, meaning) for name, meaning in meanings.items() if meaning is not None]
        return all(usual_relation(name) == (meaning.relation, meaning.positive) for name, meaning in said)

    def _choices(self, name: str, option: Options, trial: Trial) -> Iterator[Meaning | None]:
        """Yield what a predicate may say, what its name usually says first."""
        if option is not None:
            places, fixed = option
            hint = usual_relation(name)
            orders = (places, places[::-1]) if len(places) > 1 else (places,)
            choices = [
                Meaning(relation.name, order, positive, tuple(fixed.items()))
                for relation in RELATIONS.values()
                if relation.arity == len(places) and (trial.hand or not relation.only_hand)
                for positive in (True, False)
                for order in orders
            ]
            yield from sorted(choices, key=lambda meaning: (meaning.relation, meaning.positive) != hint)
        if name not in self._needed(trial.cast.sort):
            yield None

    def _checked(self, trial: Trial, meanings: Meanings) -> Reading | Misfit:
        """Return the reading that meanings make, if the actions then do what a blocks world does and nothing else."""
        cast = trial.cast
        seen: list[tuple[Trial, Grounded, Step]] = []
        for kinds in samples(len(cast.kinds), SOME):
            wider = Trial(self.domain, self.sorts, cast, kinds, trial.hand)
            step = wider.missing(meanings)
            if step is not None:
                return Misfit(f"no action {step_words(step)}, whatever the blocks", len(meanings))
            done = wider.transitions(meanings)
            if isinstance(done, Misfit):
                return replace(done, assigned=len(meanings) + 1)
            seen += [(wider, one, step) for one, step in done]
        return Reading(
            hand=trial.hand,
            meanings={name: meaning for name, meaning in meanings.items() if meaning is not None},
            table=cast.table,
            others=frozenset(name for name, _ in cast.others),
            templates=tuple(_templates(seen, cast.table)),
            by_name=False,
            derived=self._derived(seen[0][0], meanings) if seen else {},
        )

    def _derived(self, trial: Trial, meanings: Meanings) -> dict[str, Meaning]:
        """Return what those derived predicates say that are about blocks alone and are some relation of theirs."""
        found = {}
        for name, (parameters, _) in self.domain.rules.items():
            places = tuple(range(len(parameters)))
            if any(self.sorts.find((name, place)) != trial.cast.sort for place in places):
                continue
            options: Options = (places, {})
            fitting = (
                m for m in self._choices(name, options, trial) if m is not None and trial.says(name, m, meanings)
            )
            meaning = next(fitting, None)
            if meaning is not None:
                found[name] = meaning
        return found


def _templates(seen: Sequence[tuple[Trial, Grounded, Step]], table: str | None) -> Iterator[Template]:
    """Yield how each action's arguments tell the steps that it was seen to do."""
    for name, kind in dict.fromkeys((one.action.name, step.kind) for _, one, step in seen):
        mine = [(one.arguments, step) for _, one, step in seen if (one.action.name, step.kind) == (name, kind)]
        columns = list(zip(*(arguments for arguments, _ in mine), strict=True))
        told = {
            "block": [step.block for _, step in mine],
            "source": [table if step.source is None else step.source for _, step in mine],
            "target": [table if step.target is None else step.target for _, step in mine],
        }
        roles = tuple(
            next((role for role, things in told.items() if list(column) == things), None) for column in columns
        )
        targets = {step.target is None for _, step in mine}
        sources = {step.source is None for _, step in mine}
        yield Template(
            action=name,
            kind=kind,
            roles=roles,
            fixed=tuple((at, column[0]) for at, column in enumerate(columns) if len(set(column)) == 1),
            from_table=sources.pop() if len(sources) == 1 else None,
            to_table=targets.pop() if len(targets) == 1 else None,
        )

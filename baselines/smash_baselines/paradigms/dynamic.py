"""`didp`: domain-independent dynamic programming; no time index, so that a search that ends is a proof.

A state says what each block stands on, on which blocks nothing stands, and how many floors of each kind are free: those
that the goal treats alike are one kind. A topple is a chain of transitions: the top block falls at cost 1, those under
it follow at cost 0, one after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, ClassVar

from smash.planners.protocol import Settings, SolveLog, left
from smash_baselines.paradigms.growing import ParadigmPlanner
from smash_baselines.paradigms.task import Fall, Move, Step, Task

MOST_TRANSITIONS = 100_000
"""Transitions beyond which a model is not built."""


class DidpPlanner(ParadigmPlanner):
    """A dynamic program, searched by cyclic best-first search, which is anytime and ends with a proof."""

    summary: ClassVar[str] = "domain-independent dynamic programming (didppy): what stands on what, no time index"
    name: ClassVar[str] = "didp"
    module: ClassVar[str] = "didppy"
    cells_per_second: ClassVar[int] = 3_000

    def prepare(self) -> None:
        """Load didppy."""
        import didppy  # noqa: F401

    def search(self, task: Task, settings: Settings, log: SolveLog, until: float) -> None:
        """Search until `until`."""
        import didppy

        log.prove(task.least_cost(0), "moves")
        reason = self.why_too_large(task.blocks * (task.table + 3), MOST_TRANSITIONS, left(until))
        if reason is not None:
            log.details["stopped"] = reason
            return
        model = Model(didppy, task)
        solver = didppy.CBFS(model.program, time_limit=max(0.01, left(until)), quiet=True)
        self._follow(solver, model, log, until)

    def _follow(self, solver: Any, model: Model, log: SolveLog, until: float) -> None:
        """Take the plans and the bound of a search until it ends, the best plan is proven, or `until`."""
        ended = False
        while not ended and not log.settled and left(until) > 0:
            solution, ended = solver.search_next()
            if solution.cost is not None:
                self.offer(model.task, log, model.steps([transition.name for transition in solution.transitions]))
            if log.refusals:
                return
            if solution.is_infeasible:
                log.refute(self.name)
            elif solution.is_optimal and log.cost is not None:
                log.prove(log.cost, self.name)
            elif solution.best_bound is not None:
                log.prove(int(solution.best_bound), self.name)


class Model:
    """The dynamic program of a task."""

    def __init__(self, dp: Any, task: Task) -> None:
        self.dp, self.task, self.program = dp, task, dp.Model()
        self.kind = [self._kind(index) for index in range(len(task.places))]
        self.count, self.kinds = task.blocks, max(self.kind) + 1
        self.table = self.count + self.kinds
        self.buffer = self.kind[task.stacks] + self.count if task.buffers else None
        self.wanted = [None if w is None else frozenset(map(self.thing, w)) for w in task.wanted]
        self._variables()
        for block in range(self.count):
            if block not in task.fixed:
                self._moves(block)
                if task.cap:
                    self._falls(block)
        if task.cap:
            self._add("rest", 0, [self.falling != self.table], [(self.falling, self.table), (self.fallen, 0)])
        self._ends()

    def thing(self, thing: int) -> int:
        """Return the number that a thing of the task has here."""
        if thing == self.task.table:
            return self.table
        return thing if thing < self.task.blocks else self.task.blocks + self.kind[thing - self.task.blocks]

    def steps(self, names: Sequence[str]) -> list[Step]:
        """Return the steps of a solution's transitions; of alike floors the first free one is taken."""
        below, steps = list(self.task.below), list[Step]()
        for name in names:
            what, *numbers = name.split()
            if what == "move":
                block, onto = map(int, numbers)
                if onto >= self.count:
                    alike = (floor for floor in self.task.floors if self.thing(floor) == onto)
                    onto = next(floor for floor in alike if floor not in below)
                steps.append(Move(block, onto))
                below[block] = onto
            elif what != "rest":
                block = int(numbers[0])
                if what == "follow":
                    steps.pop()
                steps.append(Fall(block))
                below[block] = self.task.table
        return steps

    def _kind(self, place: int) -> int:
        """Return the kind of a place's floor: buffers are alike, and stacks too where the goal names none."""
        stacks = self.task.stacks if self.task.located else 1
        return min(place, stacks - 1) if place < self.task.stacks else stacks

    def _variables(self) -> None:
        task, program = self.task, self.program
        thing = program.add_object_type(number=self.table + 1)
        below = [self.thing(under) for under in task.below]
        self.on = [program.add_element_var(object_type=thing, target=under) for under in below]
        bare = [block for block in range(self.count) if block not in below]
        self.bare = program.add_set_var(object_type=thing, target=bare)
        self.home = program.add_set_var(object_type=thing, target=sorted(task.fixed))
        room = [self.kind.count(kind) - below.count(self.count + kind) for kind in range(self.kinds)]
        self.room = [program.add_int_var(target=free) for free in room]
        if task.cap:
            self.falling = program.add_element_var(object_type=thing, target=self.table)
            self.fallen = program.add_int_var(target=0)
            self.inside = program.add_set_var(object_type=thing, target=sorted(self._in_buffers()))

    def _in_buffers(self) -> set[int]:
        found = set(self.task.buffers)
        for _ in range(self.count):
            found |= {block for block, under in enumerate(self.task.below) if under in found}
        return found - set(self.task.buffers)

    def _add(self, name: str, cost: int, when: list[Any], effects: list[Any], *, forced: bool = False) -> None:
        total = cost + self.dp.IntExpr.state_cost()
        transition = self.dp.Transition(name=name, cost=total, preconditions=when, effects=effects)
        self.program.add_transition(transition, forced=forced)

    def _leaves(self, block: int, onto: int) -> list[Any]:
        """Return the effects on bare blocks and free floors of a block that comes to stand on another thing."""
        at = self.on[block]
        uncovered = (at < self.count).if_then_else(self.bare.add(at), self.bare)
        effects = [(self.bare, uncovered.remove(onto) if onto < self.count else uncovered), (at, onto)]
        for kind, room in enumerate(self.room):
            freed = (at == self.count + kind).if_then_else(room + 1, room)
            effects.append((room, freed - 1 if onto == self.count + kind else freed))
        return effects

    def _moves(self, block: int) -> None:
        """Transfers: to its place over what is home at once, for it need not wait; elsewhere where there is room."""
        idle = [self.falling == self.table] if self.task.cap else []
        able = [*idle, self.bare.contains(block), ~self.home.contains(block)]
        for onto in range(self.table):
            if onto == block:
                continue
            effects = self._leaves(block, onto)
            if self.task.cap:
                effects.append((self.inside, self._inside(block, onto)))
            if onto < self.count:
                when = [*able, self.bare.contains(onto), self.on[onto] != self.table]
            else:
                when = [*able, self.room[onto - self.count] > 0]
            when.append(self.on[block] != onto)
            if self.task.located and self.wanted[block] == frozenset((onto,)):
                ready = [] if onto >= self.count else [self.home.contains(onto)]
                home = [*effects, (self.home, self.home.add(block))]
                self._add(f"move {block} {onto}", 2, [*when, *ready], home, forced=True)
                when = [*when, ~self.home.contains(onto)] if onto < self.count else []
            if when:
                self._add(f"move {block} {onto}", 2, when, effects)

    def _inside(self, block: int, onto: int) -> Any:
        """Return the blocks that stand in buffers after a transfer."""
        if onto == self.buffer:
            return self.inside.add(block)
        if onto >= self.count:
            return self.inside.remove(block)
        return self.inside.contains(onto).if_then_else(self.inside.add(block), self.inside.remove(block))

    def _falls(self, block: int) -> None:
        """A topple begins at the top of a pile of a stack and goes on downwards."""
        at = self.on[block]
        follows = (at < self.count).if_then_else(at, self.table)
        fallen = (at < self.count).if_then_else(self.fallen + 1, 0)
        effects = [*self._leaves(block, self.table), (self.falling, follows), (self.fallen, fallen)]
        stays = ~self.home.contains(block)
        top = [self.falling == self.table, self.bare.contains(block), at != self.table, stays]
        self._add(f"topple {block}", 1, [*top, ~self.inside.contains(block)], effects)
        self._add(f"follow {block}", 0, [self.falling == block, stays, self.fallen < self.task.cap], effects)

    def _ends(self) -> None:
        """The goal, and what each block that is not where it belongs still costs."""
        named = [block for block, places in enumerate(self.wanted) if places is not None]
        idle = [self.falling == self.table] if self.task.cap else []
        if self.task.located:
            there = {block: self.home.contains(block) for block in named}
        else:
            there = {block: self._stands(block) for block in named}
        bare = [self.bare.contains(block) for block in sorted(self.task.bare)]
        self.program.add_base_case([*there.values(), *bare, *idle])
        still = [there[b] for b in named if self.table not in (self.wanted[b] or ())]
        if still:
            bound = still[0].if_then_else(0, 2)
            for holds in still[1:]:
                bound = bound + holds.if_then_else(0, 2)
            self.program.add_dual_bound(bound)

    def _stands(self, block: int) -> Any:
        conditions = [self.on[block] == thing for thing in sorted(self.wanted[block] or ())]
        holds = conditions[0]
        for condition in conditions[1:]:
            holds = holds | condition
        return holds

"""`cp-sat`: constraint programming on what stands on what, with CP-SAT.

A binary says at each time whether a block stands on a thing. In a step one block is transferred or a set of blocks
falls: what stands on a falling block falls too, and all of them stand in one pile, over the lowest.
"""

from __future__ import annotations

from time import perf_counter
from typing import Any, ClassVar

from smash.planners.milp.solvers.ortools_library import load_cp_model
from smash_baselines.paradigms.growing import Ended, Found, GrowingPlanner, Horizon
from smash_baselines.paradigms.task import Fall, Move, Step


class CpSatPlanner(GrowingPlanner):
    """A time-indexed constraint model of growing horizon."""

    summary: ClassVar[str] = "constraint programming (CP-SAT): what stands on what, step by step"
    name: ClassVar[str] = "cp-sat"
    module: ClassVar[str] = "ortools"
    cells_per_second: ClassVar[int] = 15_000

    def prepare(self) -> None:
        """Load CP-SAT."""
        load_cp_model()

    def solve_horizon(self, horizon: Horizon, found: Found) -> Ended:
        """Build the model of a horizon and solve it."""
        cp_model = load_cp_model()
        began = perf_counter()
        model = Model(cp_model, horizon)
        solver = cp_model.CpSolver()
        solver.parameters.num_workers = horizon.settings.threads
        solver.parameters.random_seed = horizon.settings.seed
        solver.parameters.max_time_in_seconds = max(0.0, horizon.seconds - (perf_counter() - began))

        class Improved(cp_model.CpSolverSolutionCallback):  # type: ignore[misc,name-defined]
            def on_solution_callback(self) -> None:
                if not found(model.steps(lambda literal: bool(self.boolean_value(literal)))):
                    self.stop_search()

        ended = solver.solve(model.program, Improved())
        return "exhausted" if ended in (cp_model.OPTIMAL, cp_model.INFEASIBLE) else "stopped"


class Model:
    """The model of a horizon: literals by time, block and thing."""

    def __init__(self, cp_model: Any, horizon: Horizon) -> None:
        task = self.task = horizon.task
        self.program = cp_model.CpModel()
        self.horizon = horizon.steps
        new, blocks, things = self.program.new_bool_var, range(task.blocks), range(task.table + 1)
        self.on = [[[new("") for _ in things] for _ in blocks] for _ in range(self.horizon + 1)]
        self.pick = [[new("") for _ in blocks] for _ in range(self.horizon)]
        self.put = [[new("") for _ in range(task.table)] for _ in range(self.horizon)]
        self.fall = [[new("") for _ in blocks] for _ in range(self.horizon)] if task.cap else []
        self.lowest = [[new("") for _ in blocks] for _ in range(self.horizon)] if task.cap else []
        self.in_buffer = [[new("") for _ in blocks] for _ in range(self.horizon)] if task.cap and task.buffers else []
        for time in range(self.horizon + 1):
            self._arrangement(time)
        for step in range(self.horizon):
            self._transfer(step)
            if task.cap:
                self._topple(step)
            self._rest_stays(step)
            if task.located:
                self._home_stays(step)
        self._ends()
        cost = sum(2 * sum(picks) for picks in self.pick) + sum(sum(low) for low in self.lowest)
        self.program.minimize(cost)
        if horizon.below is not None:
            self.program.add(cost <= horizon.below - 1)
        for block in task.placed:
            self.program.add_at_least_one(picks[block] for picks in self.pick)

    def steps(self, holds: Any) -> list[Step]:
        """Read the steps off a solution."""
        steps: list[Step] = []
        for time, picks in enumerate(self.pick):
            picked = next((block for block, literal in enumerate(picks) if holds(literal)), None)
            if picked is not None:
                steps.append(Move(picked, next(y for y, literal in enumerate(self.put[time]) if holds(literal))))
            elif self.lowest:
                steps += [Fall(block) for block, literal in enumerate(self.lowest[time]) if holds(literal)]
        return steps

    def _arrangement(self, time: int) -> None:
        """Each block stands on one thing, and each thing but the table carries one block at the most."""
        on, program = self.on[time], self.program
        for block in range(self.task.blocks):
            program.add_exactly_one(on[block])
            program.add(on[block][block] == 0)
        for thing in range(self.task.table):
            program.add_at_most_one(on[block][thing] for block in range(self.task.blocks))

    def _transfer(self, step: int) -> None:
        """One block that carries nothing is put on another thing that carries nothing."""
        on, pick, put, program, task = self.on[step], self.pick[step], self.put[step], self.program, self.task
        lowest = self.lowest[step] if task.cap else []
        program.add_at_most_one([*pick, *lowest])
        program.add(sum(put) == sum(pick))
        program.add_at_most_one(put)
        for block, picked in enumerate(pick):
            if block in task.fixed:
                program.add(picked == 0)
            program.add_implication(put[block], ~on[block][task.table])
            program.add_implication(picked, ~put[block])
            program.add_implication(picked, ~self.on[step + 1][block][task.table])
            for other in range(task.blocks):
                program.add_implication(picked, ~on[other][block])
            for thing in range(task.table):
                program.add_bool_or(~picked, ~put[thing], self.on[step + 1][block][thing])
                program.add_bool_or(~picked, ~put[thing], ~on[block][thing])
        for thing in range(task.table):
            for other in range(task.blocks):
                program.add_implication(put[thing], ~on[other][thing])
        for buffer in task.buffers[1:]:  # they are alike: the first empty one is used
            program.add_bool_or(~put[buffer], *(on[block][buffer - 1] for block in range(task.blocks)))
        if step:
            before = [*self.pick[step - 1], *(self.lowest[step - 1] if task.cap else [])]
            program.add(sum(before) >= sum([*pick, *lowest]))

    def _topple(self, step: int) -> None:
        """The falling blocks stand in one pile of a stack, over the lowest, with all that stands on them."""
        on, fall, lowest, program, task = self.on[step], self.fall[step], self.lowest[step], self.program, self.task
        program.add(sum(fall) <= task.cap * sum(lowest))
        for block, falls in enumerate(fall):
            if block in task.fixed:
                program.add(falls == 0)
            program.add_implication(falls, ~self.pick[step][block])
            program.add_implication(lowest[block], falls)
            program.add_implication(falls, self.on[step + 1][block][task.table])
            program.add_implication(falls, ~on[block][task.table])
            for other in range(task.blocks):
                program.add_bool_or(~falls, ~on[other][block], fall[other])
                program.add_bool_or(~falls, lowest[block], ~on[block][other], fall[other])
            for floor in task.floors:
                program.add_bool_or(~falls, lowest[block], ~on[block][floor])
        if task.buffers:
            self._buffers_do_not_fall(step)

    def _buffers_do_not_fall(self, step: int) -> None:
        on, inside, program = self.on[step], self.in_buffer[step], self.program
        for block, here in enumerate(inside):
            program.add_implication(self.fall[step][block], ~here)
            for buffer in self.task.buffers:
                program.add_implication(on[block][buffer], here)
            for other in range(self.task.blocks):
                program.add_bool_or(~on[block][other], ~inside[other], here)

    def _rest_stays(self, step: int) -> None:
        for block in range(self.task.blocks):
            moved = [self.pick[step][block], *([self.fall[step][block]] if self.task.cap else [])]
            for thing in range(self.task.table + 1):
                self.program.add_bool_or(~self.on[step][block][thing], self.on[step + 1][block][thing], *moved)

    def _home_stays(self, step: int) -> None:
        """What has come home over what is home stays there."""
        home = [self.program.new_bool_var("") for _ in range(self.task.blocks)]
        for block, places in enumerate(self.task.wanted):
            for thing in places or ():
                there = [] if thing >= self.task.blocks else [~home[thing]]
                self.program.add_bool_or(~self.on[step][block][thing], *there, home[block])
            self.program.add_implication(home[block], ~self.pick[step][block])
            if self.task.cap:
                self.program.add_implication(home[block], ~self.fall[step][block])

    def _ends(self) -> None:
        task, program = self.task, self.program
        for block, under in enumerate(task.below):
            program.add(self.on[0][block][under] == 1)
            places = task.wanted[block]
            if places is not None:
                program.add_bool_or(*(self.on[-1][block][thing] for thing in sorted(places)))
        for block in task.bare:
            for other in range(task.blocks):
                program.add(self.on[-1][other][block] == 0)

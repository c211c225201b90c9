# `make help` lists what there is. A target sets up `.venv` first, with the packages that it needs: `.ci/environment`
# keeps what is there and fits. CPython 3.11, 3.13 or 3.12 is looked for, in this order; `make PYTHON=... TARGET` names one.
VENV := .venv
BIN := $(VENV)/bin

SCENES := friction-0.10 friction-0.30 friction-0.40 friction-0.50

.DEFAULT_GOAL := help
.NOTPARALLEL:
.PHONY: $(shell sed -nE 's/^([a-z][a-z-]*):.*/\1/p' $(firstword $(MAKEFILE_LIST)))

help: ## list the targets
	@grep -hE '^[a-z][a-z-]*:.*## ' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 22

needs-%: # .venv with these extras, as in needs-analysis-pddl; the packages for planning are always there
	@.ci/environment $(VENV) $(subst cp sat,cp-sat,$(subst -, ,$(filter-out planning,$*)))

physics: needs-execution
	@$(BIN)/python -c 'import pybullet' 2>/dev/null || $(BIN)/python -c 'import mujoco' 2>/dev/null || { echo 'smash: no physics engine is installed in $(VENV): PyBullet or MuJoCo' >&2; exit 6; }

pybullet: needs-execution
	@$(BIN)/python -c 'import pybullet' 2>/dev/null || { echo 'smash: PyBullet has no wheels for the Python of $(VENV); make PYTHON=python3.11 $(MAKECMDGOALS)' >&2; exit 6; }

install: needs-planning ## set up .venv for planning
	@echo 'smash: ready. $(BIN)/smash plan examples/figure1.json (or first: source $(BIN)/activate)'

install-all: needs-all-dev ## set up .venv with all that its Python can have, and the tools of developers
	@$(BIN)/python -c 'import pybullet' 2>/dev/null || echo 'smash: episodes are simulated by MuJoCo: PyBullet has no wheels for this Python (3.11 has them)'
	@echo 'smash: ready. $(BIN)/smash plan examples/figure1.json (or first: source $(BIN)/activate)'

docs: needs-analysis-docs ## build the documentation as a site that is read offline: site/index.html (half a minute)
	NO_MKDOCS_2_WARNING=1 $(BIN)/python -m mkdocs build --strict
	@echo 'smash: open site/index.html'

lock: ## make requirements.lock again, after a change of pyproject.toml (LOCK=--upgrade takes the newest versions)
	.ci/lock $(LOCK)

licences: needs-all-dev lock-tool ## make the table of docs/licences.md again, after `make lock`
	$(BIN)/python .ci/licences.py

lock-tool:
	@.ci/lock --tool

clean: ## remove what was set up, compiled and built; runs/ stays
	rm -rf $(VENV) .venvs build dist site .mypy_cache .ruff_cache .pytest_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +

test: needs-all-dev ## run the tests (minutes); slow ones with `make test-slow`
	$(BIN)/python -m pytest

test-slow: needs-all-dev ## run the slow tests too
	$(BIN)/python -m pytest -m 'not timing and not nightly' --timeout=900

test-nightly: needs-all-dev ## no planner that says optimal is contradicted on 2,000 random problems (hours)
	$(BIN)/python -m pytest -m nightly

test-timing: needs-all-dev ## run the tests of budgets and of times; nothing else should run beside them
	$(BIN)/python -m pytest -m timing --timeout=900

lint: needs-all-dev ## ruff and mypy, both strict, and dead code
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/vulture

ci: ## lint, and the tests and the wheel on every Python of 3.11, 3.12 and 3.13 that is installed (minutes)
	.ci/run

suites: needs-planning ## make the committed instance sets again, byte for byte
	$(BIN)/python -m smash.problem.sets.make_suites

ablation: needs-analysis-cp-sat-pddl ## the paper's budget x buffer heatmaps on a stated subset (about 12 minutes on 2 cores)
	$(BIN)/python -m smash sweep experiments/ablation.toml --out runs/ablation
	$(BIN)/python -m smash_analysis.ablation runs/ablation

ablation-full: needs-analysis-cp-sat-pddl ## the paper's whole grid: 9 blocks, 20 instances, buffers 0 to 12, budgets to 30 s (hours)
	$(BIN)/python -m smash sweep experiments/ablation-full.toml --out runs/ablation-full --dry-run
	$(BIN)/python -m smash sweep experiments/ablation-full.toml --out runs/ablation-full
	$(BIN)/python -m smash_analysis.ablation runs/ablation-full

tables: needs-analysis-execution-pddl physics ## the paper's Tables I and II in simulation, a stated subset (at most 30 minutes on 2 cores)
	$(BIN)/python -m smash sweep experiments/tables-subset.toml --out runs/tables-subset
	$(BIN)/python -m smash episodes runs/tables-subset --policy replan --policy open --jobs 2
	$(BIN)/python -m smash_analysis.execution_tables runs/tables-subset

tables-full: needs-analysis-execution-pddl physics ## both tables whole: 20 instances a setting, up to 3 physics seeds (hours, said first; it can be resumed)
	$(BIN)/python -m smash sweep experiments/tables-full.toml --out runs/tables-full --dry-run
	$(BIN)/python -m smash sweep experiments/tables-full.toml --out runs/tables-full
	$(BIN)/python -m smash episodes runs/tables-full --label smash --label 'smash, seconds' --policy replan --policy open --jobs 2
	$(BIN)/python -m smash episodes runs/tables-full --label fd-lama --policy replan --jobs 2
	$(BIN)/python -m smash episodes runs/tables-full --label smash --label 'smash, seconds' --policy replan --seeds 3 --jobs 2
	$(BIN)/python -m smash_analysis.execution_tables runs/tables-full
	$(BIN)/python -m smash_analysis.forecasts runs/tables-full

seconds: needs-analysis-execution physics ## plans for seconds beside those of fewest actions: what topple saves, expected against measured (about an hour; it can be resumed)
	$(BIN)/python -m smash sweep experiments/seconds.toml --out runs/seconds
	$(BIN)/python -m smash episodes runs/seconds --jobs 2
	$(BIN)/python -m smash_analysis.forecasts runs/seconds

scoop: needs-analysis-execution-pddl physics ## the paper's scoop: pick and place alone, with topple, scoop, lift; table and 3D replays (about 10 minutes)
	$(BIN)/python -m smash sweep experiments/scoop.toml --out runs/scoop
	$(BIN)/python -m smash episodes runs/scoop --label smash --seeds 3 --scene examples/scoop-scene.toml --replays --jobs 2
	$(BIN)/python -m smash_analysis.scoop runs/scoop

friction: needs-analysis-execution physics ## the same plans under other friction, and topples by size (about 25 minutes on 2 cores)
	$(BIN)/python -m smash sweep experiments/friction.toml --out runs/friction
	$(BIN)/python -m smash episodes runs/friction --policy replan --policy open --jobs 2
	$(BIN)/python -m smash topple-map --highest-cut 3 --most 6 --jobs 2 --out runs/friction/default
	for scene in $(SCENES); do \
	  $(BIN)/python -m smash episodes runs/friction --policy replan --policy open --jobs 2 --scene experiments/scenes/$$scene.toml && \
	  $(BIN)/python -m smash topple-map --highest-cut 3 --most 6 --jobs 2 --scene experiments/scenes/$$scene.toml --out runs/friction/$$scene \
	    || exit 1; done
	$(BIN)/python -m smash_analysis.execution_sweeps runs/friction $(addprefix runs/friction/,default $(SCENES))

NOISES := pose=1mm pose=3mm pose=5mm yaw=3deg yaw=6deg camera=2mm camera=4mm placement=2mm placement=4mm friction=10% friction=25% mass=25% mass=50% size=0.5mm size=1mm
MORE_NOISES := pose=8mm pose=12mm yaw=10deg camera=6mm placement=6mm friction=40% size=2mm

robustness: needs-analysis-execution physics ## the same plans under noise of each kind: success and time, table and curves (about 10 minutes on 2 quiet cores; it can be resumed)
	$(BIN)/python -m smash sweep experiments/robustness.toml --out runs/robustness
	$(BIN)/python -m smash episodes runs/robustness --jobs 2
	$(BIN)/python -m smash episodes runs/robustness --jobs 2 $(addprefix --noise ,$(NOISES))
	$(BIN)/python -m smash_analysis.robustness runs/robustness

robustness-full: needs-analysis-execution physics ## the same on 20 instances of 9 blocks, with topple and without, three seeds, more amounts (hours, said first; it can be resumed)
	$(BIN)/python -m smash sweep experiments/robustness-full.toml --out runs/robustness-full
	$(BIN)/python -m smash episodes runs/robustness-full --seeds 3 --jobs 2 $(addprefix --noise ,$(NOISES) $(MORE_NOISES)) --dry-run
	$(BIN)/python -m smash episodes runs/robustness-full --seeds 3 --jobs 2
	$(BIN)/python -m smash episodes runs/robustness-full --seeds 3 --jobs 2 $(addprefix --noise ,$(NOISES) $(MORE_NOISES))
	$(BIN)/python -m smash_analysis.robustness runs/robustness-full

paces: needs-analysis-execution physics ## what topple saves at 0.1 and 0.25 of the arm's limits, as MoveIt moves it, beside ours (about 10 minutes on 2 quiet cores; it can be resumed)
	$(BIN)/python -m smash sweep experiments/paces.toml --out runs/paces
	$(BIN)/python -m smash episodes runs/paces --jobs 2
	$(BIN)/python -m smash episodes runs/paces --jobs 2 --pace 0.1 --pace 0.25
	$(BIN)/python -m smash_analysis.paces runs/paces

paces-full: needs-analysis-execution physics ## the same on 20 instances a setting (hours, said first; it can be resumed)
	$(BIN)/python -m smash sweep experiments/paces-full.toml --out runs/paces-full
	$(BIN)/python -m smash episodes runs/paces-full --jobs 2 --pace 0.1 --pace 0.25 --dry-run
	$(BIN)/python -m smash episodes runs/paces-full --jobs 2
	$(BIN)/python -m smash episodes runs/paces-full --jobs 2 --pace 0.1 --pace 0.25
	$(BIN)/python -m smash_analysis.paces runs/paces-full

engines: needs-analysis-execution-mujoco pybullet ## the same plans and topples in both engines: success, failures, time, landings, disagreements (about 12 minutes on 2 quiet cores; it can be resumed)
	$(BIN)/python -m smash sweep experiments/engines.toml --out runs/engines
	for engine in pybullet mujoco; do \
	  $(BIN)/python -m smash episodes runs/engines --policy open --engine $$engine --jobs 2 && \
	  $(BIN)/python -m smash topple-map --highest-cut 3 --most 6 --engine $$engine --jobs 2 --out runs/engines/landings/$$engine \
	    || exit 1; done
	$(BIN)/python -m smash_analysis.engines runs/engines

engines-full: needs-analysis-execution-mujoco pybullet ## the same on a third of the committed sets, 7 instances of 20, open pipeline and replanning, ten topples of each size (hours, said first; it can be resumed)
	$(BIN)/python -m smash sweep experiments/engines-full.toml --out runs/engines-full
	for engine in pybullet mujoco; do \
	  $(BIN)/python -m smash episodes runs/engines-full --policy open --policy replan --engine $$engine --jobs 2 --dry-run || exit 1; done
	for engine in pybullet mujoco; do \
	  $(BIN)/python -m smash episodes runs/engines-full --policy open --policy replan --engine $$engine --jobs 2 && \
	  $(BIN)/python -m smash topple-map --seeds 10 --engine $$engine --jobs 2 --out runs/engines-full/landings/$$engine \
	    || exit 1; done
	$(BIN)/python -m smash_analysis.engines runs/engines-full

LAID := multi-20x5-000 multi-16x8-000

layouts: needs-analysis-execution-mujoco pybullet ## 20 blocks on five stacks and 16 on eight: planned, laid out, drawn, carried out in both engines (about 15 minutes of one core)
	$(BIN)/python -m smash generate multi --blocks 20 --stacks 5 --buffers 6 --seed 1 --out runs/layouts
	$(BIN)/python -m smash generate multi --blocks 16 --stacks 8 --buffers 4 --seed 1 --out runs/layouts
	for name in $(LAID); do for kind in topple plain; do \
	  at=runs/layouts/$$name.$$kind; less=$$(test $$kind = topple || echo --no-topple); \
	  $(BIN)/python -m smash plan runs/layouts/$$name.json $$less --budget 8 --out $$at.plan.json && \
	  $(BIN)/python -m smash layout runs/layouts/$$name.json $$at.plan.json --out $$at.toml && \
	  $(BIN)/python -m smash draw-scene $$at.toml --out $$at.png || exit 1; \
	  for engine in mujoco pybullet; do for seed in 0 1; do \
	    $(BIN)/python -m smash execute runs/layouts/$$name.json $$at.plan.json --scene $$at.toml --engine $$engine --seed $$seed \
	      --out $$at.$$engine-$$seed.json >/dev/null || test $$? = 5 || exit 1; \
	  done; done; done; done

boxes: needs-analysis-execution-mujoco pybullet ## nine unlike boxes: plans, episodes by both policies and topples, in both engines (10 minutes; it can be resumed)
	$(BIN)/python -m smash sweep experiments/boxes.toml --out runs/boxes
	for engine in pybullet mujoco; do \
	  $(BIN)/python -m smash episodes runs/boxes --policy open --policy replan --engine $$engine --scene examples/boxes-scene.toml --jobs 2 && \
	  $(BIN)/python -m smash topple-map --seeds 2 --engine $$engine --scene examples/boxes-scene.toml --jobs 2 --out runs/boxes/landings/$$engine \
	    || exit 1; done
	$(BIN)/python -m smash_analysis.engines runs/boxes

ARMS := panda ur5 xarm7

arms: needs-analysis-execution-mujoco ## the same plans carried out by every robot: success, failures, time, what topple saves (about 15 minutes on 2 quiet cores; it can be resumed)
	$(BIN)/python -m smash sweep experiments/arms.toml --out runs/arms
	for robot in $(ARMS); do \
	  $(BIN)/python -m smash episodes runs/arms --policy open --engine mujoco --robot $$robot --jobs 2 || exit 1; done
	$(BIN)/python -m smash_analysis.arms runs/arms

topple-map: needs-analysis-execution physics ## where toppled blocks land, per cut height and number (minutes)
	$(BIN)/python -m smash topple-map --jobs 2 --out runs/topple-map

bench: needs-gurobi ## first plans, proofs, HiGHS against Gurobi, hundreds of blocks: the README's tables (3 minutes)
	$(BIN)/python -m smash.experiments.studies.benchmark

proofs: needs-analysis ## the 3,120 problems of the committed sets (13 buffer counts, with and without topple), each proven (a minute)
	for set in single-4 single-6 single-9 multi-4 multi-6 multi-9; do $(BIN)/smash frontier $$set --out runs/proofs/$$set || exit; done

beside-greedy: needs-planning ## smash beside greedy alone on sixty stated problems of 50 to 2,000 blocks, at 1 and 10 s (20 minutes)
	$(BIN)/python -m smash.experiments.studies.beside_greedy --out runs/beside-greedy.md

bench-records: needs-parquet ## what checking, exporting and reporting 45,000 runs takes (minutes)
	$(BIN)/python -m smash.experiments.studies.records_at_scale

scaling: needs-analysis ## time over 4 to 10,000 blocks, per planner: curves and exponents (hours; it can be resumed)
	$(BIN)/smash scaling --out runs/scaling
	$(BIN)/python -m smash_analysis.scaling runs/scaling

best-known: needs-pddl ## best known costs and bounds of the open instances, and what is still open (40 minutes)
	$(BIN)/python -m smash sweep experiments/open.toml --out runs/open $(if $(DASK),--dask $(DASK))
	$(BIN)/python -m smash sweep experiments/open-2.toml --out runs/open-2 $(if $(DASK),--dask $(DASK))
	$(BIN)/python -m smash best-known update runs/open runs/open-2
	$(BIN)/python -m smash best-known table --into docs/open-instances.md

dataset: needs-planning ## the instance sets with proven optima, best plans, certificates and Croissant metadata: results/dataset (a minute)
	$(BIN)/python -m smash dataset --out results/dataset

compare: needs-analysis-clingo-cp-sat-didp-pddl ## all planners, of every paradigm, on a stated subset of the committed sets (at most 30 minutes on 2 cores)
	$(BIN)/python -m smash sweep experiments/compare.toml --out runs/compare
	$(BIN)/python -m smash_analysis.comparison runs/compare

compare-full: needs-analysis-clingo-cp-sat-didp-pddl ## all planners on all of the committed sets (a day or more; says how many hours first)
	$(BIN)/python -m smash sweep experiments/compare-full.toml --out runs/compare-full --dry-run
	$(BIN)/python -m smash sweep experiments/compare-full.toml --out runs/compare-full
	$(BIN)/python -m smash_analysis.comparison runs/compare-full

reproduce: needs-all physics ## every table and figure, the paper's and ours, on stated small grids (about an hour; it can be resumed)
	$(BIN)/python -m smash reproduce

reproduce-full: needs-all physics ## the same on the whole grids (days; says how many hours first; it can be resumed)
	$(BIN)/python -m smash reproduce --full

results: reproduce ## keep the products of `make reproduce` in results/, and draw the README's figures from them
	$(BIN)/python -m smash reproduce --copy-to results
	$(BIN)/python -m smash_analysis.readme

"""The outcome model as a file, what is expected of a plan, and plans that are chosen for it."""

import json
from itertools import pairwise
from time import monotonic

import msgspec
import pytest
from click.testing import CliRunner

import smash as door
from smash.cli import smash
from smash.forecast.durations import Point, TimedMove, features, fit, in_order, seconds
from smash.forecast.expected import Forecaster
from smash.forecast.model import FEATURES, default_model, model_from_document, read_model, write_model
from smash.forecast.robust import least_risk
from smash.forecast.search import faster
from smash.problem.actions.topple import Topple
from smash.problem.errors import MalformedFile, Unsupported
from smash.problem.files.plans import plan_from_document
from smash.problem.model import OnGoal, Pick, Place, PlanOptions, State
from smash.problem.problem import Problem

FIGURE = "examples/figure1.json"


@pytest.fixture(scope="module")
def nine():
    return door.suite("multi-9")[0]


@pytest.fixture
def forecast_alone(monkeypatch):
    """No motion is rehearsed: `tests/execution` does that."""
    monkeypatch.setattr("smash.experiments.weighing.weighed.ready", lambda question, model: None)


def forecaster(instance, **options):
    return Forecaster(Problem(instance, PlanOptions(**options)), default_model())


def test_a_model_is_read_back_as_written(tmp_path):
    write_model(default_model(), tmp_path / "model.json")
    assert read_model(tmp_path / "model.json") == default_model()


@pytest.mark.parametrize("change", [{"side": 0}, {"topples": [{}]}, {"moves": None}, {"colour": 1}, {"format": "x"}])
def test_a_malformed_model_is_refused_in_one_line(tmp_path, change):
    write_model(default_model(), tmp_path / "model.json")
    with pytest.raises(MalformedFile) as refusal:
        model_from_document(json.loads((tmp_path / "model.json").read_text()) | change)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize(("name", "said"), [("colour", "no such feature"), ("pick", "is missing")])
def test_weights_that_are_unknown_or_missing_are_refused(tmp_path, name, said):
    write_model(default_model(), tmp_path / "model.json")
    document = json.loads((tmp_path / "model.json").read_text())
    weights = document["moves"]["weights"]
    weights.pop(name) if name in weights else weights.update({name: 1.0})
    with pytest.raises(MalformedFile, match=rf"moves\.weights.*{name}.*{said}"):
        model_from_document(document)


def test_the_model_holds_topples_of_up_to_nine_blocks():
    assert {trial.falling for trial in default_model().topples} == set(range(1, 10))
    assert all(len(trial.landed) == trial.falling for trial in default_model().topples)


def test_a_cut_that_was_never_tried_stands_for_the_nearest():
    assert {trial.falling for trial in default_model().trials(8, 2)} == {2}
    assert {trial.height for trial in default_model().trials(8, 2)} == {4}


def test_times_that_follow_the_model_are_found_again():
    weights = dict.fromkeys(FEATURES, 0.0) | {"pick": 2.0, "place": 3.0, "swing x swing": 0.5}
    points = [Point(0.4 + 0.02 * (i % 7), 0.3 * i - 2, 0.02 * (i * i % 5)) for i in range(60)]
    moves = [
        TimedMove(kind, one, other, False, False, seconds(in_order(weights), features(kind, one, other, False, False)))
        for i, (one, other) in enumerate(zip(points, points[7:] + points[:7], strict=True))
        for kind in (("pick", "place")[i % 2],)
    ]
    found = fit(moves)
    assert found.explained > 0.999
    assert found.spread < 0.01


def test_a_plan_takes_as_long_as_its_actions(nine):
    plan = door.plan(nine, budget=5)
    forecast = forecaster(nine)
    whole, parts = forecast.of(plan.actions), list(forecast.steps(plan.actions))
    assert whole.seconds == pytest.approx(sum(part.seconds for part in parts))
    assert 0.5 < whole.seconds / (3.4 * len(plan.actions)) < 2


def test_toppled_blocks_are_expected_along_the_push(nine):
    forecast = forecaster(nine)
    near, far = (lying.at for lying in forecast.fall("s2", 1, 4).landed[::3])
    assert abs(far.bearing - forecast.spots["s2"].bearing) > abs(near.bearing - forecast.spots["s2"].bearing) > 0.1


def test_a_topple_among_blocks_that_fell_there_before_is_a_risk():
    instance = door.make_instance(start={"s1": ["a", "b", "c", "d"]}, goal={"s1": ["d", "c", "b", "a"]})
    forecast = forecaster(instance)
    again, apart = (
        [step.risk for step in forecast.steps(actions)]
        for actions in ([Topple("s1", 3), Topple("s1", 1)], [Topple("s1", 1)])
    )
    assert again == [0.0, 1.0]
    assert apart == [0.0]


def test_annealing_finds_no_slower_plan_than_it_began_with(nine):
    forecast = forecaster(nine)
    starts = [door.plan(nine, budget=5, topple=topple).actions for topple in (True, False)]
    best = faster(forecast, starts, steps=300)[0]
    assert forecast.law.check(best.actions).accepted
    assert best.expected.seconds <= min(forecast.of(start).seconds for start in starts) + 1e-9
    assert best.expected.seconds == pytest.approx(forecast.of(best.actions).seconds)
    assert faster(forecast, starts, steps=300)[0].actions == best.actions


def test_annealing_may_not_topple_where_the_options_forbid_it(nine):
    start = door.plan(nine, budget=5, topple=False).actions
    for found in faster(forecaster(nine, topple=False), [start], steps=300):
        assert forecaster(nine, topple=False).law.check(found.actions).accepted


def test_the_least_risk_costs_no_action():
    instance = door.make_instance(
        blocks=["a", "b", "c", "d"],
        stacks=["s1", "s2"],
        buffers=["u1"],
        start={"s1": ["a", "b", "c", "d"]},
        goal={"s2": ["d", "a", "c", "b"]},
    )
    plan = door.plan(instance, budget=5)
    found = least_risk(forecaster(instance), plan.actions, monotonic() + 30)
    assert found.exact
    assert len(found.actions) == plan.cost
    assert forecaster(instance).law.check(found.actions).accepted
    assert found.risk <= forecaster(instance).of(plan.actions).risk


def test_what_the_model_does_not_know_is_unsupported():
    with pytest.raises(Unsupported, match="knows 4"):
        forecaster(
            door.make_instance(
                start={f"s{n}": [f"b{n}"] for n in range(6)}, goal={"s1": [*map("b{}".format, range(6))]}
            )
        )


@pytest.mark.usefixtures("forecast_alone")
def test_a_plan_for_seconds_says_what_it_expects(tmp_path):
    out = tmp_path / "plan.json"
    ended = CliRunner().invoke(smash, ["plan", FIGURE, "--objective", "seconds", "--budget", "0.5", "--out", str(out)])
    assert ended.exit_code == 0, ended.output
    document = json.loads(out.read_text())
    assert document["expected_seconds"] > 0
    assert document["status"] == ("optimal" if document["cost"] == document["lower_bound"] else "feasible")
    assert CliRunner().invoke(smash, ["validate", FIGURE, str(out)]).exit_code == 0


def test_a_model_that_nothing_asks_for_is_a_usage_error(tmp_path):
    ended = CliRunner().invoke(smash, ["plan", FIGURE, "--model", str(tmp_path / "model.json")])
    assert (ended.exit_code, "--objective seconds and --robust" in ended.output) == (2, True)


@pytest.mark.usefixtures("forecast_alone")
def test_plans_for_seconds_are_robust_in_any_case():
    plain, robust = (door.plan(FIGURE, objective="seconds", robust=robust, budget=0.3) for robust in (False, True))
    assert robust.expected_seconds > 0
    assert robust.details["risk"] == plain.details["risk"]


@pytest.mark.parametrize(
    "change", [{"expected_seconds": -1}, {"expected_seconds": "long"}, {"actions": None, "cost": None}]
)
def test_seconds_of_a_plan_file_are_seconds_of_a_plan(change):
    document = {"format": "smash-plan/1", "instance": "x", "cost": 0, "actions": [], "expected_seconds": 2.5}
    assert plan_from_document(document).expected_seconds == 2.5
    with pytest.raises(MalformedFile):
        plan_from_document(document | {"status": "unknown" if "cost" in change else "feasible"} | change)


@pytest.mark.usefixtures("forecast_alone")
def test_the_door_takes_the_objective():
    assert door.plan(FIGURE, objective="seconds", budget=0.3).expected_seconds > 0
    assert door.plan(FIGURE, robust=True, budget=1).expected_seconds is None
    with pytest.raises(door.SmashError, match="actions or seconds"):
        door.plan(FIGURE, objective="speed")


def test_seconds_of_carriers_are_unsupported_before_anything_is_planned():
    ended = CliRunner().invoke(smash, ["plan", "examples/scoop-seconds.json", "--objective", "seconds"])
    assert isinstance(ended.exception, Unsupported)


def narrow(stacks=None, buffers=None, **scene):
    """The default scene's model whose stacks and buffers are made otherwise, and trouble costs nothing."""
    model = msgspec.structs.replace(default_model(), trouble=0.0, **scene)
    for group, change in (("stacks", stacks or {}), ("buffers", buffers or {})):
        spots = tuple(msgspec.structs.replace(spot, **change) for spot in getattr(model, group))
        model = msgspec.structs.replace(model, **{group: spots})
    return model


def carried_out(forecast, actions):
    """Every action of a plan with the state that it is done in."""
    state = State.start_of(forecast.problem.instance)
    for action in actions:
        yield action, state
        forecast.law.carry_out(state, action)


@pytest.mark.parametrize(
    ("model", "fits"),
    [
        (narrow({"headings": ()}), lambda action, _: not isinstance(action, Topple)),
        (
            narrow({"falling": 2}),
            lambda action, state: (
                not isinstance(action, Topple) or len(state.piles[action.location]) - action.height < 2
            ),
        ),
        (
            narrow(buffers={"highest": 1}),
            lambda action, state: (
                not isinstance(action, Place) or action.target[0] != "u" or not state.piles[action.target]
            ),
        ),
    ],
    ids=["no strip", "short strips", "low buffers"],
)
def test_annealing_asks_nothing_that_the_scene_has_no_room_for(nine, model, fits):
    forecast = Forecaster(Problem(nine, PlanOptions()), model)
    starts = [door.plan(nine, budget=5, topple=topple).actions for topple in (True, False)]
    assert any(forecast.misfit(start) is not None for start in starts)
    found = faster(forecast, starts, steps=100)
    assert len(found) > 1
    for candidate in found:
        assert forecast.misfit(candidate.actions) is None
        assert all(fits(action, state) for action, state in carried_out(forecast, candidate.actions))


def test_of_equal_plans_one_is_taken_that_the_scene_has_room_for():
    instance = door.make_instance(
        blocks=["a", "b", "c"],
        stacks=["s1", "s2"],
        buffers=["u1", "u2"],
        start={"s1": ["a", "b", "c"]},
        goal={"s2": ["a", "b", "c"]},
    )
    toppled = (Topple("s1", 1), *(step for block in "abc" for step in (Pick(block, "table"), Place(block, "s2"))))
    without = (Topple("s1", 2), Pick("a", "s1"), Place("a", "s2"), *toppled[3:])
    forecast = Forecaster(Problem(instance, PlanOptions()), narrow({"falling": 2}))
    assert forecast.misfit(toppled) == "a topple of 3 blocks at 's1'; scene 'default' has a strip for 2 there"
    assert forecast.misfit(without) is None
    assert forecast.misfit(least_risk(forecast, toppled, monotonic() + 30).actions) is None


@pytest.mark.usefixtures("forecast_alone")
@pytest.mark.parametrize(
    ("buffers", "said"), [(["u1"], ""), ([], "no plan was found that fits; one has a topple at 's1'; scene")]
)
def test_a_plan_for_seconds_topples_no_stack_without_a_strip(tmp_path, buffers, said):
    pile = ["a", "b", "c"]
    instance = door.make_instance(
        blocks=pile, stacks=["s1", "s2"], buffers=buffers, start={"s1": pile}, goal={"s2": pile}
    )
    files = [tmp_path / name for name in ("instance.json", "model.json", "plan.json")]
    door.write_instance(instance, files[0])
    write_model(narrow({"headings": ()}), files[1])
    seconds = [
        "--objective",
        "seconds",
        "--planner",
        "precedence",
        "--budget",
        "60",
        "--model",
        str(files[1]),
        "--out",
        str(files[2]),
    ]
    ended = CliRunner().invoke(smash, ["plan", str(files[0]), *seconds])
    assert isinstance(ended.exception, Unsupported) == (not files[2].exists()) == bool(said)
    assert said in str(ended.exception)


def test_a_goal_higher_than_any_pile_of_the_scene_is_unsupported_before_anything_is_planned():
    blocks = [f"b{number}" for number in range(13)]
    made = {"blocks": blocks, "stacks": ["s1", "s2"], "buffers": [], "start": {"s1": blocks[:6], "s2": blocks[6:]}}
    for goal in ({"s1": blocks}, OnGoal(dict(pairwise(blocks)))):
        with pytest.raises(Unsupported, match=r"13 blocks in a pile; .* knows 12"):
            forecaster(door.make_instance(**made, goal=goal))

"""`smash execute INSTANCE PLAN`: carry a plan out in simulation."""

from __future__ import annotations

from pathlib import Path

import click

from smash.cli import fail
from smash.cli.choices import (
    budget_option,
    engine_option,
    noise_option,
    pace_option,
    robot_option,
    say_engine,
    say_strangers,
)
from smash.cli.signals import ended_by_signals
from smash.experiments.episodes.executors import executor_of
from smash.problem.extras import EXECUTION, require, require_engine
from smash.problem.files.documents import require_writable, write_text
from smash.problem.files.instances import read_instance
from smash.problem.files.plans import read_plan


@click.command("execute")
@click.argument("instance", type=click.Path(path_type=Path))
@click.argument("plan", type=click.Path(path_type=Path))
@click.option(
    "--seed", type=click.IntRange(0, 2**31 - 1), default=0, show_default=True, help="Of the blocks' start poses."
)
@click.option("--scene", type=click.Path(path_type=Path), help="Scene file (default: the built-in scene).")
@noise_option
@pace_option
@engine_option
@robot_option
@click.option("--no-replan", is_flag=True, help="The paper's open pipeline: the first failure ends the episode.")
@click.option("--replanner", metavar="NAME", help="Planner to replan with (default: the plan's own, else greedy).")
@budget_option("of each replanning")
@click.option("--replay", type=click.Path(path_type=Path, dir_okay=False), help="Write a 3D replay as one HTML page.")
@click.option("--video", type=click.Path(path_type=Path, dir_okay=False), help="Write a film (.mp4 or .gif).")
@click.option("--video-size", metavar="WxH", help="Of the film [pixels], multiples of 16 (default: 480x368).")
@click.option("--video-speed", metavar="N", help="It runs N times as fast as simulated time (default: 4).")
@click.option("--video-camera", metavar="YAW,PITCH,DISTANCE", help="In degrees and metres (default: 28,-40,1.45).")
@click.option("--stills", type=click.Path(path_type=Path, dir_okay=False), help="Draw start, topple and end (.png).")
@click.option(
    "--trajectory",
    type=click.Path(path_type=Path, dir_okay=False),
    help="Write joint positions (.csv), or ROS 2 messages for Foxglove and rosbag2 (.mcap).",
)
@click.option(
    "--observer", type=click.Path(path_type=Path), help="File of recorded poses to see the blocks by (smash-poses/1)."
)
@click.option(
    "--looks", type=click.Path(path_type=Path, dir_okay=False), help="Write what was seen, as --observer reads it."
)
@click.option("--gui", is_flag=True, help="Show PyBullet's window; MuJoCo has none.")
@click.option("--out", type=click.Path(path_type=Path, dir_okay=False), help="Also write the episode here.")
def command(
    instance: Path,
    plan: Path,
    seed: int,
    scene: Path | None,
    noise: str | None,
    pace: float | None,
    engine: str | None,
    robot: str | None,
    no_replan: bool,
    replanner: str | None,
    budget: float,
    replay: Path | None,
    video: Path | None,
    video_size: str | None,
    video_speed: str | None,
    video_camera: str | None,
    stills: Path | None,
    trajectory: Path | None,
    observer: Path | None,
    looks: Path | None,
    gui: bool,
    out: Path | None,
) -> None:
    """Carry PLAN out in simulation and print the episode as JSON; exit 5 where the execution failed.

    \b
    Examples:
      smash execute examples/figure1.json plan.json --replay episode.html
      smash execute examples/figure1.json plan.json --seed 3 --no-replan
      smash execute examples/figure1.json plan.json --video film.mp4 --video-size 960x640 --video-speed 2
      smash execute examples/figure1.json plan.json --noise pose=3mm,yaw=2deg,friction=10% --pace 0.25
      smash execute examples/figure1.json plan.json --engine mujoco
      smash execute examples/figure1.json plan.json --robot panda
      smash execute examples/figure1.json plan.json --trajectory episode.mcap
      smash execute examples/figure1.json plan.json --looks poses.jsonl
      smash execute examples/figure1.json plan.json --observer poses.jsonl
    """
    require("smash execute", *EXECUTION)
    if engine is not None:
        require_engine(engine)
    if video is not None:
        require("smash execute --video", "imageio")
    elif any(option is not None for option in (video_size, video_speed, video_camera)):
        raise click.UsageError("--video-size, --video-speed and --video-camera go with --video")
    if stills is not None:
        require("smash execute --stills", "matplotlib")
    require_writable(replay, video, stills, trajectory, looks, out)
    if replanner is not None:
        _require_planner(replanner, no_replan)
    problem, filed = read_instance(instance), read_plan(plan)
    from smash.execution.scene.scene_file import scene_of
    from smash.execution.viewing.capture import Capture
    from smash.execution.viewing.film import film_of
    from smash.records.episodes import Performed, episode_text

    film = film_of(video_size, video_speed, video_camera)
    capture = Capture(replay=replay, video=video, stills=stills, trajectory=trajectory, looks=looks, film=film)
    tabletop = scene_of(scene)
    say_strangers(tabletop, problem)
    from rich.console import Console
    from rich.markup import escape

    status = Console(stderr=True).status("planning motions")
    planned = len(filed.actions or ())

    def shown(row: Performed) -> None:
        status.update(
            f"step {row.step} of {planned if row.origin == 'plan' else '?'}: {' '.join(map(str, row.action))}"
        )

    executor = executor_of(
        problem,
        filed,
        seed=seed,
        replan=not no_replan,
        scene=tabletop,
        noise=noise,
        pace=pace,
        replanner=replanner,
        budget=budget,
        engine=engine,
        robot=robot,
        observer=observer,
        looks=capture.seen,
        gui=gui,
        on_frame=capture.frame,
        on_step=shown,
    )
    with ended_by_signals():
        with status:
            episode = executor.run()
        if episode.failure is None:
            say_engine(executor.engine, tabletop, engine)
        text = episode_text(episode)
        click.echo(text, nl=False)
        if out is not None:
            write_text(out, text)
        with Console(stderr=True).status(escape(f"writing {', '.join(map(str, capture.files))}")):
            capture.finish(executor, episode)
    if episode.failure is not None:
        failure = episode.failure
        done = "nothing" if failure.action is None else " ".join(map(str, failure.action))
        where = f"step {failure.step} ({done}), engine {executor.engine}"
        fail(f"{instance}: execution failed at {where}: {failure.name}: {failure.reason}", 5)


def _require_planner(name: str, no_replan: bool) -> None:
    """Refuse a planner to replan with that is not there, before anything moves."""
    if no_replan:
        raise click.UsageError("--replanner goes without --no-replan")
    from smash.planners.registry import get_planner

    get_planner(name)

"""`smash robot`, and `--robot` where it is taken: what is said, and one line for what is wrong."""

import xml.etree.ElementTree as ET

import pytest

pytest.importorskip("pinocchio")

from click.testing import CliRunner

import smash as door
from smash.cli import main
from smash.cli import smash as command
from smash.motion import fit_spheres
from tests.execution.episodes import swapped_pair, swapped_plan
from tests.six_joints import written


def said(*arguments):
    ended = CliRunner().invoke(command, list(map(str, arguments)))
    assert ended.exit_code == 0, ended.output
    return ended.output


def refused(capfd, monkeypatch, *arguments):
    """Exit code and the one line of a command that fails."""
    monkeypatch.setattr("sys.argv", ["smash", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    (line,) = capfd.readouterr().err.splitlines()
    return ended.value.code, line


def test_the_robots_are_listed():
    assert "panda: 7 joints, hand panda_hand, piles to 0.54 m\n" in said("robot")


def test_a_robot_file_is_checked_and_described(tmp_path):
    text = said("robot", written(tmp_path))
    assert text.startswith("six: 6 joints, hand panda_hand")
    assert "  elbow: -6.283 to 6.283 rad, 3 rad/s, 150 N m\n" in text


def test_spheres_are_fitted_and_written(tmp_path, monkeypatch):
    for name, count in (("CANDIDATES", 300), ("SURFACE_SAMPLES", 200), ("INSIDE_SAMPLES", 50)):
        monkeypatch.setattr(fit_spheres, name, count)
    path = written(tmp_path)
    (tmp_path / "six.csv").unlink()
    assert "spheres in" in said("robot", path, "--fit")
    assert (tmp_path / "six.csv").read_text().startswith("link,x,y,z,radius\nground,")


def test_the_table_of_a_robot_that_is_shipped_is_left_alone(capfd, monkeypatch):
    code, line = refused(capfd, monkeypatch, "robot", "panda", "--fit")
    assert (code, "'panda' is shipped with its table" in line) == (2, True)


def test_one_urdf_is_written(tmp_path):
    said("robot", "panda", "--urdf", tmp_path / "p.urdf")
    assert ET.parse(tmp_path / "p.urdf").getroot().get("name") == "panda"


@pytest.fixture
def filed(tmp_path):
    door.write_instance(swapped_pair(), tmp_path / "i.json")
    door.write_plan(swapped_plan(), tmp_path / "p.json")
    return tmp_path


def test_what_is_wrong_with_a_robot_is_one_line_before_anything_moves(filed, capfd, monkeypatch):
    execute = ["execute", filed / "i.json", filed / "p.json", "--robot"]
    assert refused(capfd, monkeypatch, *execute, "r2d2") == (
        2,
        "smash: robot: there is none called 'r2d2'; panda, ur5, xarm7, or the path of a robot file (.toml)",
    )
    code, line = refused(capfd, monkeypatch, *execute, filed / "none.toml")
    assert (code, "none.toml: cannot be read" in line) == (2, True)
    short = written(filed, ("heights = [[0.20, 12], [0.50, 12], [0.70, 6]]", "heights = [[0.20, 5], [0.40, 5]]"))
    code, line = refused(capfd, monkeypatch, *execute, short)
    assert (code, "robot 'six' does not reach 2 blocks at 's2'" in line) == (2, True)
    code, line = refused(capfd, monkeypatch, "robot", written(filed, ("[reach]", "[rich]")))
    assert (code, "rich" in line) == (2, True)

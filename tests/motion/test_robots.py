"""Robots as data: files in, one URDF, kinematics and checks of an arm that is nobody's."""

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from smash.motion import fit_spheres, kernel
from smash.motion.collision import CollisionChecker, arm_model
from smash.motion.hulls import HullChecker, link_vertices
from smash.motion.kinematics import along_line, inverse
from smash.motion.level import Gentleness, level_way
from smash.motion.obstacles import HandState, Scene
from smash.motion.planner import MotionPlanner
from smash.motion.poses import top_down
from smash.motion.reach import measured_reach
from smash.motion.robots import load_robot, robot_names
from smash.motion.robots.meshes import drawn_parts, is_closed
from smash.motion.timing import Pace, time_path
from smash.problem.errors import ExecutionFailure, MalformedFile, SmashError
from tests.robots import PANDA, READY
from tests.six_joints import six_joints, written

TABLE = Scene.of_boxes([], np.empty((0, 3)), 0.0).with_table()


@pytest.fixture(scope="module")
def six(tmp_path_factory):
    return six_joints(tmp_path_factory.mktemp("six"))


def configurations(robot, count, seed):
    lower, upper = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    return np.random.default_rng(seed).uniform(lower, upper, (count, robot.count))


def test_the_panda_is_shipped_and_the_default():
    assert "panda" in robot_names()
    assert load_robot() is load_robot("panda") is PANDA


@pytest.mark.parametrize("change", ["six.toml", "panda-hand.toml", "six.urdf", "six.csv", ".obj", "hand.urdf"])
def test_a_robot_of_which_any_file_changed_is_another_one(tmp_path, change):
    path = written(tmp_path)
    before = load_robot(path)
    assert load_robot(path) is before
    changed = next(file for file in before.files if file.name.endswith(change))
    with changed.open("ab") as file:
        file.write(b"\n")
    after = load_robot(path)
    assert after is not before
    assert after.label != before.label
    assert load_robot(path) is after


def test_a_robot_without_its_spheres_is_read_again_once_they_are_there(tmp_path):
    path = written(tmp_path)
    spheres = (tmp_path / "six.csv").read_text()
    (tmp_path / "six.csv").unlink()
    assert load_robot(path).spheres is not None
    before = load_robot(path)
    (tmp_path / "six.csv").write_text(spheres)
    assert load_robot(path) is not before


def test_one_urdf_has_the_arm_and_the_hand_in_the_order_of_their_files():
    urdf = ET.fromstring(PANDA.urdf)
    links = [link.get("name") for link in urdf.findall("link")]
    arm = [f"panda_link{number}" for number in range(9)]
    assert links == [*arm, "panda_hand", "panda_leftfinger", "panda_rightfinger", "smash_tool"]
    assert not list(urdf.iter("visual"))


def test_the_corners_of_a_hand_are_those_of_its_meshes_where_its_file_has_none(tmp_path):
    path = written(tmp_path, hand=[("[boxes]\n", ""), ("palm =", "# palm ="), ("finger = [[", "# finger = [[")])
    hand = load_robot(path).hand
    assert hand.palm == pytest.approx(PANDA.hand.palm, abs=1e-3)
    assert hand.finger == pytest.approx(PANDA.hand.finger, abs=1e-3)


def test_a_hand_is_as_thick_as_on_the_side_where_it_stands_out_most(tmp_path):
    path = written(tmp_path, hand=[("palm = [[-0.0317", "palm = [[-0.0500"), ("[0.0106, 0.0265", "[0.0206, 0.0265")])
    assert (PANDA.hand.palm_thickness, PANDA.hand.finger_thickness) == (0.0317, 0.0106)
    assert (load_robot(path).hand.palm_thickness, load_robot(path).hand.finger_thickness) == (0.05, 0.0206)


def test_an_arm_of_six_joints_with_any_axes_has_one_kinematics(six):
    assert six.count == 6
    assert six.upright
    for joints in configurations(six, 20, 0):
        frames = kernel.link_frames(arm_model(six).chain, joints)
        pose = six.forward(joints)
        assert np.allclose(frames[-1, :, 3], pose.position)
        assert np.allclose(frames[-1, :, :3], pose.rotation)


def test_the_spheres_of_an_arm_lie_where_its_links_are(six):
    for joints in configurations(six, 5, 1):
        body = kernel.posture(arm_model(six), CollisionChecker(six, TABLE)._setting[1], joints)
        six.forward(joints)
        for link in ("lift_link", "wrist2_link"):
            number, placement = six.in_body(link)
            middle = link_vertices(six, link).mean(axis=0)
            here = body.frames[number] @ np.append(placement[:3, :3] @ middle + placement[:3, 3], 1.0)
            own = body.spheres[arm_model(six).first[number] : arm_model(six).first[number + 1]]
            assert np.linalg.norm(own[:, :3] - here, axis=1).min() < 0.12


@pytest.mark.parametrize("yaw", [0.0, 1.3, -2.2])
def test_an_arm_of_six_joints_reaches_what_lies_around_it(six, yaw):
    for angle in (-2.5, 0.4, 3.0):
        pose = top_down([0.45 * np.cos(angle), 0.45 * np.sin(angle), 0.2], yaw)
        found = inverse(six, pose, six.ready, count=4)
        assert found
        for joints in found:
            assert six.within_limits(joints)
            assert six.forward(joints).position == pytest.approx(pose.position, abs=1e-4)
            assert np.abs(joints - six.ready)[six.winding].max() <= np.pi + 1e-6


def test_a_line_is_followed_and_timed_within_the_limits_of_the_arm(six):
    start = inverse(six, top_down([0.4, 0.1, 0.3], 0.2))[0]
    assert along_line(six, start, [np.array([0.0, 0.0, -0.01 * step]) for step in range(1, 10)]) is not None
    path = MotionPlanner(six).plan(six.ready, start, TABLE)
    trajectory = time_path(six, path, Pace(1.0, 1.0))
    step = 1e-3
    sampled = trajectory.sample(step)
    assert np.all(np.abs(np.diff(sampled, axis=0)) / step <= six.velocity * 1.01)
    assert np.all(np.abs(np.diff(sampled, n=2, axis=0)) / step**2 <= six.acceleration * 1.1)


def test_a_lower_limit_of_jerk_makes_for_softer_motions(tmp_path):
    soft = six_joints(tmp_path, ("jerk = [1000.0, ", "jerk = [100.0, "))
    path = MotionPlanner(soft).plan(soft.ready, soft.ready + 0.6 * soft.first_joint, TABLE)
    moved = np.concatenate([[soft.ready[0]] * 3, time_path(soft, path, Pace(1.0, 1.0)).sample(1e-3)[:, 0]])
    assert np.abs(np.diff(moved, n=3)).max() / 1e-9 <= 100.0 * 1.02


def test_checkers_know_the_arm_s_own_parts(six):
    assert CollisionChecker(six, TABLE.none()).free(six.ready)
    assert HullChecker(six, TABLE.none()).contact(six.ready) is None
    checker, hulls = CollisionChecker(six, TABLE.none()), HullChecker(six, TABLE.none())
    near_base, touching = {"ground", "pan_link", "lift_link"}, []
    for joints in configurations(six, 300, 2):
        contact = hulls.contact(joints)
        pair = set() if contact is None else {contact.part, contact.other}
        if near_base & pair and pair != {"ground", "lift_link"}:  # whose covers touch: the hulls alone are asked
            touching.append(checker.blockers(joints))
    assert touching
    assert set(touching) == {("the robot itself",)}


def test_a_joint_that_turns_more_than_once_goes_to_the_nearest_revolution(six):
    far = six.ready + np.array([2 * np.pi - 0.1, 0.0, 0.0, 0.0, 0.0, 0.0])
    assert six.nearest(far, six.ready) == pytest.approx(six.ready - 0.1 * six.first_joint)
    assert six.within_limits(six.nearest(six.ready, far))
    assert PANDA.nearest(READY, READY + 7.0) is READY


def test_what_is_carried_needs_an_arm_that_turns_about_the_vertical(tmp_path):
    path = written(tmp_path, arm=[('<origin xyz="0 0 0.15" rpy="0 0 0"/>', '<origin xyz="0 0 0.15" rpy="0.3 0 0"/>')])
    tilted = load_robot(path)
    assert not tilted.upright
    planner, goal = MotionPlanner(tilted), tilted.forward(tilted.ready)
    with pytest.raises(ExecutionFailure, match="does not turn it about the vertical"):
        level_way(planner, tilted.ready, goal, TABLE, HandState(), frozenset(), Gentleness(1.0))


def test_how_high_a_pile_may_be_lies_between_what_was_measured(six):
    assert six.highest(0.50) == pytest.approx(12 * 0.045)
    assert six.highest(0.60) == six.highest(0.70) == pytest.approx(6 * 0.045)
    assert six.highest(0.19) == six.highest(0.71) == 0.0
    assert six.full_reach == (0.20, 0.50)


def test_the_panda_s_reach_is_what_is_measured():
    found = dict(measured_reach(PANDA, (0.25, 0.75)))
    assert found == {0.25: 3, 0.75: 8}
    assert PANDA.highest(0.75) == pytest.approx(8 * 0.045)


def test_every_part_is_drawn(six):
    parts = drawn_parts(six)
    assert len(parts) == 10
    assert all(len(part) and part.shape[1] == 9 for part in parts)


def test_spheres_are_fitted_to_any_arm(tmp_path, monkeypatch):
    for name, count in (("CANDIDATES", 300), ("SURFACE_SAMPLES", 200), ("INSIDE_SAMPLES", 50)):
        monkeypatch.setattr(fit_spheres, name, count)
    robot = six_joints(tmp_path)
    robot.spheres.write_text(fit_spheres.fitted(robot))
    model = arm_model(robot)
    assert all(np.diff(model.first) > 0)


REFUSED = (
    ("format = ", "format = 'x' #", None, None, r"`format`"),
    ("[reach]", "pedestal = 1\n[reach]", None, None, r"pedestal"),
    ("force = [150.0, ", "force = [", None, None, r"`arm.force`: 5 numbers; 6 are needed"),
    ("acceleration = [10.0, ", "acceleration = [-1.0, ", None, None, r"arm.acceleration"),
    (
        '"wrist2", "wrist3"]',
        '"wrist3", "wrist2"]',
        None,
        None,
        r"`arm.joints`: .* the URDF has pan, lift",
    ),
    ('name = "six"', 'name = "panda"', None, None, r"`name`: 'panda' is the name of a robot that is shipped"),
    ('flange = "flange"', 'flange = "tip"', None, None, r"`arm.flange`: .* has no link 'tip'"),
    ('base = "ground"\nflange = "flange"', 'base = "flange"\nflange = "ground"', None, None, r"does not hang on"),
    ("ready = [0.0, ", "ready = [7.0, ", None, None, r"`arm.ready`: 7 at 'pan'"),
    ('["ground", "lift_link"]', '["ground", "x"]', None, None, r"`arm.touching`: 'x' is no link"),
    ("heights = [[0.20, 12], ", "heights = [[0.60, 12], ", None, None, r"`reach.heights`"),
    ('hand = "panda-hand.toml"', 'hand = "none.toml"', None, None, r"none\.toml: cannot be read"),
    ('urdf = "six.urdf"', 'urdf = "panda-hand.toml"', None, None, r"not XML"),
    ('joint = "elbow"', 'joint = "knee"', None, None, r"`arm.elbow.joint`: 'knee' is none of `arm.joints`"),
    (None, None, ("<robot name", "<model name"), None, r"not XML|not a URDF"),
    (
        None,
        None,
        ('<box size="0.08 0.08 0.42"/>', '<mesh filename="x.stl"/>'),
        None,
        r"the mesh 'x.stl' of link",
    ),
    (None, None, ('type="revolute"', 'type="prismatic"'), None, r"joint 'pan' is prismatic"),
    (None, None, ("wrist2_link", "panda_hand"), None, r"arm and hand both have a link 'panda_hand'"),
    (None, None, ('<mass value="2"/>', '<mass value="0"/>'), None, r"'pan_link' moves and has no `inertial`"),
    (None, None, ('<mass value="2"/>', '<mass value="heavy"/>'), None, r"'pan_link' moves and has no `inertial`"),
    (None, None, ('<axis xyz="0 0 1"/>', '<axis xyz="0 1"/>'), None, r"Malformed axis element for joint \[pan\]"),
    (None, None, ('size="0.08 0.08 0.42"', 'size="0.08 z 0.42"'), None, r"the box of link 'elbow_link': `size`"),
    (None, None, ('<geometry><box size="0.08 0.08 0.42"/></geometry>', "<geometry/>"), None, r"box, cylinder, sphere"),
    ("force = [150.0, ", "force = [inf, ", None, None, r"`arm.force`: finite numbers"),
    ("side = 1", "side = -1", None, None, r"`arm.elbow`: 'elbow' is bent to the other side"),
    (None, None, None, ("opening = 0.04", "opening = 0.06"), r"does not open to 0.06 m"),
    (
        None,
        None,
        None,
        ('"panda_finger_joint1", "panda_finger_joint2"', '"panda_finger_joint2", "panda_finger_joint1"'),
        r"does not open along the tool's y",
    ),
    (
        None,
        None,
        None,
        ('"panda_finger_joint1", ', '"thumb", '),
        r"`fingers`: what moves in the URDF is panda_",
    ),
    (None, None, None, ("speed = 0.2", "grip = 1"), r"grip|speed"),
    (None, None, None, ("speed = 0.2", "speed = inf"), r"`speed`: finite numbers"),
    (None, None, None, ("palm = [[-0.0317", "palm = [[-inf"), r"`boxes.palm`: finite numbers"),
    ('name = "six"', 'name = "six\\n"', None, None, r"`name`"),
    ("[reach]", "[mount]\nrpy = [nan, 0, 0]\n[reach]", None, None, r"`mount.rpy`: finite numbers"),
    ("[0.70, 6]", "[inf, 6]", None, None, r"`reach.heights`: finite numbers"),
    ("[0.70, 6]", "[0.70, 1000]", None, None, r"<= 100 - at `reach.heights"),
    ('spheres = "six.csv"', 'spheres = "six.toml"', None, None, r"`arm.spheres`: .* ends in \.csv"),
    ('base = "ground"', 'base = "flange"', None, None, r"the URDF has none"),
    (None, None, ('size="0.08 0.08 0.42"', 'size="inf 0.08 0.42"'), None, r"component \[inf\]"),
    (None, None, ('ixx="0.1"', 'ixx="thick"'), None, r"inertia element ixx is not a valid double"),
)


@pytest.mark.parametrize(("before", "after", "arm", "hand", "words"), REFUSED)
def test_what_is_no_robot_is_refused_in_one_line(tmp_path, capfd, before, after, arm, hand, words):
    changes = [] if before is None else [(before, after)]
    path = written(tmp_path, *changes, arm=arm and [arm], hand=hand and [hand])
    with pytest.raises(MalformedFile, match=words) as refused:
        load_robot(path)
    assert "\n" not in str(refused.value)
    assert str(tmp_path) in str(refused.value)
    assert capfd.readouterr().err == ""


def test_a_urdf_without_shapes_is_refused(tmp_path):
    path = written(tmp_path)
    urdf = ET.parse(tmp_path / "six.urdf")
    for link in urdf.getroot().findall("link"):
        for shape in link.findall("collision"):
            link.remove(shape)
    urdf.write(tmp_path / "six.urdf")
    with pytest.raises(MalformedFile, match="link 'pan_link' has no `collision`"):
        load_robot(path)


def test_a_mesh_that_is_none_is_refused(tmp_path):
    path = written(tmp_path, arm=[('<box size="0.08 0.08 0.42"/>', '<mesh filename="x.stl"/>')])
    (tmp_path / "x.stl").write_text("solid nothing")
    with pytest.raises(MalformedFile, match="a mesh cannot be read: Could not load resource"):
        HullChecker(load_robot(path), TABLE)


def test_a_joint_of_the_arm_has_a_motor_of_its_own_whatever_its_urdf_says(tmp_path):
    path = written(tmp_path, arm=[('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><mimic joint="lift"/>')])
    assert '<mimic joint="lift"' not in load_robot(path).urdf


def test_a_mesh_of_another_kind_is_refused(tmp_path):
    (tmp_path / "x.dae").write_text("")
    path = written(tmp_path, arm=[('<box size="0.08 0.08 0.42"/>', '<mesh filename="x.dae"/>')])
    with pytest.raises(MalformedFile, match=r"\.obj and \.stl are allowed"):
        load_robot(path)


def test_a_table_of_spheres_that_is_missing_or_of_other_links_is_refused(tmp_path):
    robot = six_joints(tmp_path)
    (tmp_path / "six.csv").write_text("link,x,y,z,radius\nstranger,0,0,0,0.1\n")
    with pytest.raises(MalformedFile, match="line 2: 'stranger' is no link of the arm"):
        arm_model(robot)
    (tmp_path / "six.csv").write_text("link,x,y,z,radius\npan_link,0,0,0,-0.1\n")
    with pytest.raises(MalformedFile, match="line 2: a link, a centre and a radius are allowed"):
        arm_model(robot)
    (tmp_path / "six.csv").unlink()
    with pytest.raises(MalformedFile, match=r"`arm.spheres`.*smash robot .* --fit"):
        arm_model(robot)


def test_an_unknown_name_is_refused_with_those_that_there_are():
    with pytest.raises(SmashError, match="there is none called 'r2d2'; panda"):
        load_robot("r2d2")


def test_a_robot_of_one_s_own_is_told_from_another_version_of_it(tmp_path):
    for folder in ("one", "two", "elsewhere"):
        (tmp_path / folder).mkdir()
    one, elsewhere = six_joints(tmp_path / "one"), six_joints(tmp_path / "elsewhere")
    two = six_joints(tmp_path / "two", ("velocity = [3.0, ", "velocity = [2.0, "))
    assert PANDA.label == "panda"
    assert one.label.startswith("six-")
    assert one.label == elsewhere.label
    assert one.label != two.label


def test_a_mesh_with_a_hole_is_told_from_a_closed_one():
    """The former is drawn by its hull: the Panda's sixth link, of all that is shipped."""
    corner, x, y, z = np.zeros(3), *np.eye(3)
    faces = [(corner, y, x), (corner, x, z), (corner, z, y), (x, y, z)]
    pyramid = np.array([np.concatenate(face) for face in faces])
    assert is_closed(pyramid)
    assert not is_closed(pyramid[:3])
    assert not is_closed(np.vstack([pyramid[:3], np.concatenate([x, z, y])]))  # one face looks inward

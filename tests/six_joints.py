"""An arm of six joints made of boxes and rods, with the Panda's hand: a robot of nobody's, written into a folder."""

import shutil
from math import pi
from pathlib import Path

import numpy as np

import smash.motion.robots
from smash.motion.robots import load_robot

SHIPPED = Path(smash.motion.robots.__file__).parent
JOINTS = (
    ("pan", "0 0 0.15", "0 0 0", "0 0 1", "0.12 0.12 0.12", "0 0 0"),
    ("lift", "0 0.136 0", "0 1.5707963267948966 0", "0 1 0", "0.10 0.10 0.46", "0 0 0.21"),
    ("elbow", "0 -0.12 0.425", "0 0 0", "0 1 0", "0.08 0.08 0.42", "0 0 0.20"),
    ("wrist1", "0 0 0.392", "0 1.5707963267948966 0", "0 1 0", "0.07 0.10 0.07", "0 0.07 0"),
    ("wrist2", "0 0.093 0", "0 0 0", "0 0 1", "0.07 0.07 0.09", "0 0 0.07"),
    ("wrist3", "0 0 0.095", "0 0 0", "0 1 0", "0.06 0.05 0.06", "0 0.05 0"),
)
"""Name, place and turn in the link before, axis, size and place of the box."""
READY = [0.0, -pi / 2, pi / 2, -pi / 2, -pi / 2, 0.0]

ROBOT = """
format = "smash-robot/1"
name = "six"
hand = "panda-hand.toml"
[arm]
urdf = "six.urdf"
base = "ground"
flange = "flange"
joints = ["pan", "lift", "elbow", "wrist1", "wrist2", "wrist3"]
ready = [0.0, -1.5707963267948966, 1.5707963267948966, -1.5707963267948966, -1.5707963267948966, 0.0]
velocity = [3.0, 3.0, 3.0, 3.0, 3.0, 3.0]
acceleration = [10.0, 10.0, 10.0, 10.0, 10.0, 10.0]
jerk = [1000.0, 1000.0, 1000.0, 1000.0, 1000.0, 1000.0]
force = [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]
elbow = { joint = "elbow", side = 1 }
spheres = "six.csv"
forearm = "elbow_link"
touching = [["ground", "lift_link"], ["hand", "wrist1_link"]]
apart = [["wrist1_link", "wrist3_link"], ["elbow_link", "wrist2_link"]]
[reach]
heights = [[0.20, 12], [0.50, 12], [0.70, 6]]
"""


def box(size, place):
    return f'<collision><origin xyz="{place}"/><geometry><box size="{size}"/></geometry></collision>'


def urdf():
    """The arm's URDF; the last link turns without end."""
    inertia = '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>'
    parts = [f'<robot name="six"><link name="ground">{box("0.15 0.15 0.02", "0 0 0.01")}</link>']
    before = "ground"
    for name, xyz, rpy, axis, size, place in JOINTS:
        inertial = f'<inertial><mass value="2"/>{inertia}</inertial>'
        parts.append(f'<link name="{name}_link">{inertial}{box(size, place)}</link>')
        kind = "continuous" if name == "wrist3" else "revolute"
        limit = "" if name == "wrist3" else '<limit lower="-6.283" upper="6.283" effort="100" velocity="3"/>'
        parts.append(
            f'<joint name="{name}" type="{kind}"><parent link="{before}"/><child link="{name}_link"/>'
            f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>{limit}</joint>'
        )
        before = f"{name}_link"
    parts.append(
        f'<link name="flange"/><joint name="end" type="fixed"><parent link="{before}"/><child link="flange"/>'
        '<origin xyz="0 0.082 0" rpy="-1.5707963267948966 0 0"/></joint></robot>'
    )
    return "".join(parts)


def spheres():
    """Spheres around the cells of each box."""
    rows = ["link,x,y,z,radius", "ground,0,0,0.01,0.11"]
    for name, _, _, _, size, place in JOINTS:
        sides, middle = (np.array([float(part) for part in text.split()]) for text in (size, place))
        cells = np.maximum(1, np.round(sides / 0.04)).astype(int)
        for cell in np.ndindex(*cells):
            x, y, z = middle + sides * ((np.array(cell) + 0.5) / cells - 0.5)
            rows.append(f"{name}_link,{x:.4f},{y:.4f},{z:.4f},{np.linalg.norm(sides / cells) / 2:.4f}")
    return "\n".join(rows) + "\n"


def written(folder, *changes, arm=None, hand=None):
    """Write the robot's files into a folder and return the path of the robot file.

    Args:
        folder: Where to.
        changes: Pairs of a piece of the robot file and what takes its place.
        arm: The same of its URDF.
        hand: The same of the hand file.
    """
    shutil.copytree(SHIPPED / "panda-hand", folder / "panda-hand", dirs_exist_ok=True)
    for name, text, pairs in (
        ("six.toml", ROBOT, changes),
        ("six.urdf", urdf(), arm or ()),
        ("six.csv", spheres(), ()),
        ("panda-hand.toml", (SHIPPED / "panda-hand.toml").read_text(), hand or ()),
    ):
        for before, after in pairs:
            assert before in text, before
            text = text.replace(before, after)
        (folder / name).write_text(text)
    return folder / "six.toml"


def six_joints(folder, *changes):
    """The robot."""
    return load_robot(written(folder, *changes))

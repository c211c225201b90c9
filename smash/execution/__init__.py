"""One executor: Franka Panda in PyBullet, OMPL motions, partially grounded execution.

The motion half, bottom up (lengths in m, angles in rad, times in s; the robot's base is the world's origin, z = 0 the
table top; configurations have shape (7,)):

- `poses`: `ToolPose`, `top_down(position, yaw)`: the point between the fingertips, gripper down.
- `robot`: `panda()` (forward kinematics, Jacobian), limits, `READY`.
- `scene`: `Scene` (boxes as arrays), `HandState` (finger opening, `Attached` block).
- `kinematics`: `inverse(pose, reference, count=)`, `along_line`.
- `collision`: `CollisionChecker(scene, hand, margin)`: microseconds, on the safe side; `hulls`: `HullChecker`, exact.
- `motion`: `MotionPlanner`: `plan` (to configurations), `line` (tool on a straight line).
- `timing`: `time_path(path, pace)` gives a `Trajectory`; a `Pace` limits joints and tool.
- `steps`, `pushes`: the motions of a pick, a place, a topple, from where the arm is.
- `errors`: `NoIk` and `NoMotion`, with the failure's name and exit code 5.

The executor's half: `tabletop` and `scene_file` (the layout), `world` (physics), `grounding` (what is planned when),
`performing` and `recovery` (one action, and what is done where it fails), `executor` (an episode), `readback` (the
law's state from settled poses).
"""

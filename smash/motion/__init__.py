"""The arm without blocks: from a pose of the hand to a timed motion that touches nothing.

Lengths in m, angles in rad, times in s; the robot's base is the world's origin, z = 0 the table top; configurations
have shape (n,), n the number of the arm's joints. Whatever plans or checks is handed the robot. Bottom up:

- `poses`: `ToolPose`, `top_down(position, yaw)`: the point between the fingertips, gripper down.
- `robots`: `load_robot(name or file)`: robots as data, arm and hand put together.
- `robot`: `Robot` and its `Hand`: limits, forward kinematics, Jacobian, ready pose.
- `kinematics`: `inverse(robot, pose, reference, count=)`, `along_line`.
- `obstacles`: `Scene` (boxes as arrays), `HandState` (finger opening and what is `Attached`).
- `collision`: `CollisionChecker(robot, scene, hand, margin)`: microseconds, on the safe side, by the kernels of
  `kernel` and the spheres that `fit_spheres` has made and `covers` reads; `hulls`: `HullChecker`, exact, asked about
  what is not apart by `nearness`.
- `paths`: `Path`, rounded corners; `rrtconnect`: tree search.
- `planner`: `MotionPlanner(robot)`: `plan` (to configurations), `line` (the tool on a straight line).
- `timing`: `time_path(robot, path, pace)` gives a `Trajectory`; a `Pace` limits joints and tool;
  `parameterization`: the passes of TOPP-RA.
- `move`: `Move`, a timed motion; `level`: `level_way`, motions that do not tilt what the hand carries.
- `errors`: `NoIk` and `NoMotion`, with the failure's name and exit code 5.
"""

"""One executor: Franka Panda in PyBullet, OMPL motions, partially grounded execution.

The motion half, bottom up (lengths in m, angles in rad, times in s; the robot's base is the world's origin, z = 0 the
table top; configurations have shape (7,)):

- `poses`: `ToolPose`, `top_down(position, yaw)`: the point between the fingertips, gripper down.
- `robot`: `panda()` (forward kinematics, Jacobian), limits, `READY`.
- `scene`: `Scene` (boxes as arrays), `HandState` (finger opening, `Attached` block).
- `kinematics`: `inverse(pose, reference, count=)`, `solve`, `along_line`.
- `collision`: `CollisionChecker(scene, hand, margin)`: microseconds, on the safe side; `hulls`: `HullChecker`, exact.
- `motion`: `MotionPlanner`: `plan` (to configurations), `line` (tool on a straight line), `reach` (free motion and a
  line to the first of several tool poses that allows it).
- `timing`: `time_path(path, pace)` gives a `Trajectory`; `topple_pace(blocks)` limits the tool's speed.
- `errors`: `NoIk` and `NoMotion`, with the failure's name and exit code 5.

A pick: `planner.reach(q, grasps, scene, hand=open, contact_scene=scene.without([block]))`, close, then
`planner.line(q, (0, 0, 0.1), scene.without([block]), hand=HandState(opening, Attached.cube(side)))`. A place is
the same with the block in the hand. A topple: `reach` to the pose before the run-up with closed fingers (a `back` of 0
where the hand is free anyway), then `line` along the push with `scene.without(toppled)`, timed with `topple_pace`.
"""

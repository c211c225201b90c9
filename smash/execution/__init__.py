"""One executor: a robot in a simulated world, OMPL motions, partially grounded execution.

The rooms; each imports those before it in this list, none those after it:

- `smash.motion`: the arm without blocks.
- `scene`: the table (`tabletop`, `tray`), its file (`scene_file`), where things are (`block_pose`, `geometry`) and
  where they begin (`start`).
- `actions`: how the arm carries out each action: `arm_motions` (free motions), `pick_and_place`, and by the interface
  of `kind` topple, carry and lift, with the list of them in `registry`.
- `physics`: the simulated world of one episode. `layout`: scenes judged and drawn.
- here: `observer` (who is asked where the blocks are), `sight` and `recorded_poses` (the simulator and a file as that),
  `readback` (the law's state from settled poses), `grounding` (what is planned when), `performing` and
  `recovery` (one action, and what is done where it fails), `executor` (an episode), `policy`
  (what is done about failures), `errors` (their names).
- `trials` (measurements), `viewing` (replays, films, trajectories).

What an action does to the state is the law's to say (`smash.problem.rules`); here is how it comes about on the table.
"""

from smash.execution.scene_file import default_scene
from smash.execution.topple_map import Landing, Trial, draw, estimates, run_trial, suggested_cap


def trial(height, falling, good, seed=0):
    landings = tuple(Landing(height + n, 0.1 * (n + 1), 0.0, good) for n in range(falling))
    return Trial(scene="s", stack=0, height=height, falling=falling, seed=seed, stands=True, landings=landings)


def test_a_small_topple_succeeds_and_lands_along_the_push():
    done = run_trial(default_scene(), 1, height=2, falling=2, seed=0)
    assert done.success
    assert done.moved < 0.01
    assert all(landing.along > 0.05 and abs(landing.aside) < 0.05 for landing in done.landings)


def test_estimates_count_by_cut_and_size():
    assert estimates([trial(1, 2, True), trial(1, 2, False, 1), trial(2, 1, True)]) == {1: {2: (1, 2)}, 2: {1: (1, 1)}}


def test_the_suggested_cap_stops_at_the_first_size_that_fails():
    trials = [trial(1, 1, True), trial(2, 1, True), trial(1, 2, True), trial(2, 2, False), trial(1, 3, True)]
    assert suggested_cap(trials) == 1


def test_no_size_is_suggested_where_the_smallest_fails():
    assert suggested_cap([trial(1, 1, False)]) == 0


def test_a_map_is_drawn(tmp_path):
    draw([trial(1, 1, True), trial(2, 3, False)], tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")

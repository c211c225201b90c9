"""The study of the fewest blocks put aside: a row an instance, and what was proven."""

from smash.experiments.studies.fewest_aside import rows


def test_small_instances_are_proven():
    table = list(rows(12, 3, range(2), False, 20.0))
    assert [line.split(" | ")[0] for line in table[1:]] == ["| aside-12-3-0", "| aside-12-3-1", "| median"]
    assert all(" | optimal | " in line for line in table[1:3])
    assert "2 of 2 proven" in table[3]


def test_with_topple_too():
    assert "1 of 1 proven" in list(rows(12, 3, range(1), True, 20.0))[-1]

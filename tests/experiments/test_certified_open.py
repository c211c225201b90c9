"""The study of certificates: every row says what the list holds and what the checker believes."""

from smash.experiments.best_known.files import LIST, read_best_known
from smash.experiments.studies.certified_open import rows


def test_a_certificate_of_places_is_counted_apart():
    entries = [entry for entry in read_best_known(LIST).sorted() if entry.instance == "open-on-01"]
    head, *table, counts = rows(entries, 30.0)
    assert head.startswith("| instance | variant |")
    assert len(table) == len(entries) == 4
    assert sum(" | cycles | " in row for row in table) == 1
    assert counts == "\n3 of 4 bounds certified whole, 1 of them by cycles alone; 3 and 1 of those that are optima"

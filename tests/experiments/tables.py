"""The tables of a comparison but for what is measured, which is what two sweeps of the same runs must agree on."""

from smash_analysis.comparison import compared, comparison_table, outcome_table

from smash.records.believing import believed_runs

MEASURED = ["first plan [s]", "best plan [s]", "CPU [s]", "memory [MiB]"]


def tables(results):
    """Every planner's coverage, proofs, costs, gaps and outcomes as text."""
    runs = compared(sorted(believed_runs(results).records, key=lambda record: record.key))
    return comparison_table(runs).drop(columns=MEASURED).to_csv(), outcome_table(runs).to_csv()

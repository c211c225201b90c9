"""A sweep beyond one machine: Dask's scheduler hands the runs out; on Slurm, a script starts scheduler and workers."""

from __future__ import annotations

import logging
import math
import shlex
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from smash.experiments.isolation.job import grace
from smash.experiments.sweeps.experiment import Run
from smash.problem.errors import SmashError
from smash.problem.extras import require
from smash.problem.words import one_line

WORKERS_OWN_MEMORY = 1024
"""What a worker needs beside the run that it supervises [MiB]."""
WORKERS_OWN_SECONDS = 60.0
"""What a worker may take beside a run: loading the package, judging plans, clearing away."""
SECONDS_TO_START = 3.0
"""Of a run: the interpreter, imports, what a planner compiles."""


@contextmanager
def connected(where: str) -> Iterator[Any]:
    """Connect to the Dask scheduler at an address, or to the one that has written the file `where`.

    Raises:
        MissingExtra: where Dask is not installed.
        SmashError: where no scheduler answers.
    """
    require("--dask", "distributed")
    from distributed import Client

    for name in [name for name in logging.root.manager.loggerDict if name.startswith("distributed")]:
        logging.getLogger(name).setLevel(logging.CRITICAL)  # what matters is said by the sweep
    place = {"scheduler_file": where} if Path(where).is_file() else {"address": where}
    try:
        client = Client(**place, timeout=15)
    except (OSError, ValueError, TypeError, RuntimeError) as error:  # the last two: certificates are wanted, or not
        raise SmashError(one_line(f"--dask {where}: no scheduler answers there ({error})")) from None
    try:
        yield client
    finally:
        with suppress(TimeoutError):  # the scheduler stands still
            client.close(timeout=5)


def slurm_script(runs: Sequence[Run], experiment: Path, out: Path, workers: int) -> str:
    """Return a batch script for Slurm: a scheduler, `workers` workers of one run at a time, and the sweep.

    Memory and cores are those of the most demanding run, the time is what the runs need at most. A job that was cut
    off is submitted again and goes on.

    Args:
        runs: the runs of the experiment.
        experiment: its file.
        out: where the records go, on a disk that all nodes see.
        workers: runs at a time.
    """
    seconds = sum(run.job.budget + grace(run.job.budget) + SECONDS_TO_START for run in runs) / max(1, workers)
    longest = max((run.job.budget for run in runs), default=0.0)
    hours = math.ceil((seconds + longest + 600) / 3600)
    memory = max((run.job.memory for run in runs), default=0) + WORKERS_OWN_MEMORY
    cores = max((run.job.settings.threads for run in runs), default=1)
    name = runs[0].experiment if runs else experiment.stem
    where, file, directory = (shlex.quote(str(path)) for path in (Path.cwd(), experiment.resolve(), out.resolve()))
    python = shlex.quote(sys.executable)
    return f"""#!/bin/bash
# {len(runs)} runs of {experiment.name}, {workers} at a time. Cut off, submit it again: it does what is left.
#SBATCH --job-name=smash-{name}
#SBATCH --ntasks={workers}
#SBATCH --cpus-per-task={cores}
#SBATCH --mem-per-cpu={math.ceil(memory / cores)}M
#SBATCH --time={hours}:00:00
#SBATCH --output={shlex.quote(str(out.resolve() / "slurm-%j.log"))}
set -euo pipefail
cd {where}
out={directory}
mkdir -p "$out"
scheduler="$out/scheduler-${{SLURM_JOB_ID:-here}}.json"
rm -f "$scheduler"
# Whoever reaches a scheduler can run anything as you: only who has this job's certificate may (TLS, both ways).
secret="$(mktemp -d "$out/tls-XXXXXX")"
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$scheduler" "$secret"' EXIT
openssl req -x509 -newkey rsa:2048 -nodes -days 365 -subj /CN=smash \\
  -keyout "$secret/key" -out "$secret/cert" 2>/dev/null
export DASK_DISTRIBUTED__COMM__DEFAULT_SCHEME=tls DASK_DISTRIBUTED__COMM__REQUIRE_ENCRYPTION=true
export DASK_DISTRIBUTED__COMM__TLS__CA_FILE="$secret/cert"
for role in SCHEDULER WORKER CLIENT; do
  export "DASK_DISTRIBUTED__COMM__TLS__${{role}}__CERT=$secret/cert"
  export "DASK_DISTRIBUTED__COMM__TLS__${{role}}__KEY=$secret/key"
done

{python} -m distributed.cli.dask_scheduler --port 0 --protocol tls --no-dashboard --scheduler-file "$scheduler" &
until [ -s "$scheduler" ]; do sleep 1; done
# A worker that dies (its node fails, its memory is exceeded) is started anew; its run is done again elsewhere.
srun --ntasks={workers} --kill-on-bad-exit=0 {python} -m distributed.cli.dask_worker \\
  --scheduler-file "$scheduler" --nthreads 1 --no-dashboard --memory-limit 0 --death-timeout 120 \\
  --local-directory "${{TMPDIR:-/tmp}}" &
{python} -m smash sweep {file} --out "$out" --dask "$scheduler"
"""

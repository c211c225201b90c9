"""Certificates beside records: what each proves is a claim like any other, and is held against every plan."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

from smash.problem.certificate import CERTIFICATE_FORMAT, Certificate, proven_bound, read_certificate
from smash.problem.errors import SmashError
from smash.problem.files.documents import read_bytes
from smash.problem.problem import Problem
from smash.records.claims import Claim, Posed

FOLDER = "certificates"


def certified(results: Path, problems: Iterable[Problem]) -> tuple[list[Claim], list[str]]:
    """Return what the certificates in RESULTS and RESULTS/certificates prove of problems, and those that prove nothing.

    Args:
        results: the directory.
        problems: that certificates may be of: by the instance's name and the options.
    """
    files = [*sorted(results.glob("*.json")), *sorted((results / FOLDER).glob("*.json"))]
    if not files:
        return [], []
    distinct = {(problem.instance, problem.options): problem for problem in problems}.values()
    claims, refused = [], []
    for file in files:
        try:
            certificate = _certificate(file)
            if certificate is None:
                continue
            options = certificate.topple, certificate.max_topple
            for problem in distinct:
                its = problem.options.topple, problem.options.max_topple
                if problem.instance.name == certificate.instance and its == options:
                    bound = proven_bound(problem.instance, problem.options, certificate)
                    posed = Posed.of(problem.instance, problem.options)
                    claims.append(Claim(problem, posed, bound, f"the certificate {file.name}", problem.instance.name))
        except SmashError as error:
            refused.append(f"certificate: {file}: {error}")
    return claims, refused


def _certificate(file: Path) -> Certificate | None:
    """Return the certificate of a file; None where it is another document, or none at all."""
    try:
        document = json.loads(read_bytes(file))
    except (ValueError, RecursionError):
        return None
    is_one = isinstance(document, dict) and document.get("format") == CERTIFICATE_FORMAT
    return read_certificate(file) if is_one else None

"""Croissant metadata (MLCommons, version 1.0) of a data set: which files there are, and what their columns mean."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from hashlib import sha256
from importlib.metadata import version
from typing import Any

CONTEXT: dict[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "rai": "http://mlcommons.org/croissant/RAI/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "equivalentProperty": "cr:equivalentProperty",
    "extract": "cr:extract",
    "field": "cr:field",
    "fileProperty": "cr:fileProperty",
    "fileObject": "cr:fileObject",
    "fileSet": "cr:fileSet",
    "format": "cr:format",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "samplingRate": "cr:samplingRate",
    "sc": "https://schema.org/",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}
FIELDS: dict[str, dict[str, tuple[str, str]]] = {
    "problems.csv": {
        "problem": ("Text", "name of the problem: instance, number of buffers, variant"),
        "set": ("Text", "committed set of the instance"),
        "instance": ("Text", "name of the instance"),
        "blocks": ("Integer", "number of blocks"),
        "stacks": ("Integer", "number of stack locations"),
        "buffers": ("Integer", "number of auxiliary stack locations"),
        "goal": ("Text", "kind of the goal: stacks, positions or on"),
        "variant": ("Text", "what plans may use: topple, no-topple, or max-topple-M (at most M blocks in one topple)"),
        "status": ("Text", "optimal: the cost is proven; open: it is not"),
        "cost": ("Integer", "actions of the best plan known; empty where none is"),
        "lower_bound": ("Integer", "no plan has fewer actions; empty where nothing is proven"),
        "bound_origin": ("Text", "what proved the lower bound"),
        "found_by": ("Text", "what found the plan"),
        "certificate": ("Text", "name of the certificate that proves the cost without a solver; empty where none does"),
    },
    "instances.jsonl": {
        "name": ("Text", "name of the instance"),
        "set": ("Text", "committed set of the instance"),
        "document": ("Text", "the instance, smash-instance/1 as JSON: piles from the bottom to the top, and the goal"),
    },
    "plans.jsonl": {
        "problem": ("Text", "name of the problem"),
        "actions": ("Text", "the best plan known: a JSON list of the actions of smash-plan/1"),
    },
    "certificates.jsonl": {
        "name": ("Text", "name of the certificate: instance and variant"),
        "instance": ("Text", "name of the instance"),
        "variant": ("Text", "what plans may use"),
        "bound": ("Integer", "actions that every plan has at least, whatever the number of buffers"),
        "certificate": ("Text", "the proof, smash-certificate/1 as JSON"),
    },
}
"""File -> column -> its type and meaning; what is nested is JSON in a text, as Croissant has no other form for it."""
FORMATS = {"csv": "text/csv", "jsonl": "application/jsonlines"}
PAPER = "Virtues of Ordered Chaos: Planning with Topple Actions in Tabletop Stack Rearrangement"


def metadata(files: Mapping[str, str], published: date) -> dict[str, Any]:
    """Return the metadata of a data set.

    Args:
        files: its files by name, with what they hold.
        published: when it was made.
    """
    return {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "name": "smash-stack-rearrangement",
        "description": (
            "Instances of stack rearrangement with and without topple actions, from 4 to 500 blocks, with the proven "
            "optimum of each number of buffers and variant, or the best plan and bound known, plans and certificates."
        ),
        "license": "https://spdx.org/licenses/MIT.html",
        "datePublished": published.isoformat(),
        "version": version("smash-testbed"),
        "creator": {"@type": "sc:Organization", "name": "The smash developers"},
        "citeAs": f"H. Lu and R. Shome: {PAPER}; and the smash testbed (CITATION.cff).",
        "keywords": ["task planning", "rearrangement", "blocks world", "topple", "benchmark"],
        "distribution": [_file(name, text) for name, text in files.items()],
        "recordSet": [_records(name) for name in files],
    }


def _file(name: str, text: str) -> dict[str, Any]:
    return {
        "@type": "cr:FileObject",
        "@id": name,
        "name": name,
        "contentUrl": name,
        "contentSize": f"{len(text.encode())} B",
        "encodingFormat": FORMATS[name.rpartition(".")[2]],
        "sha256": sha256(text.encode()).hexdigest(),
    }


def _records(name: str) -> dict[str, Any]:
    records = name.partition(".")[0]
    first = next(iter(FIELDS[name]))
    return {
        "@type": "cr:RecordSet",
        "@id": records,
        "name": records,
        "key": {"@id": f"{records}/{first}"},
        "field": [
            {
                "@type": "cr:Field",
                "@id": f"{records}/{column}",
                "name": column,
                "description": meaning,
                "dataType": f"sc:{kind}",
                "source": {"fileObject": {"@id": name}, "extract": {"column": column}},
            }
            for column, (kind, meaning) in FIELDS[name].items()
        ],
    }

"""The documented fields are those of the types, in their order, with their JSON types and nulls."""

import re
from pathlib import Path

import msgspec
import pytest

from smash.records.episodes import EpisodeRecord
from smash.records.runs import RunRecord
from smash.records.trials import Trial

PAGE = (Path(__file__).parents[2] / "docs" / "records.md").read_text()
TABLES = dict(re.findall(r"^## [^\n]*`(smash-[a-z-]+/1)`\n(.*?)(?=^## )", PAGE, re.MULTILINE | re.DOTALL))


def json_type(kind):
    """The JSON type of a field's type, as the page says it."""
    match msgspec.inspect.type_info(kind):
        case msgspec.inspect.UnionType(types=parts):
            words = [json_type_of(part) for part in parts if not isinstance(part, msgspec.inspect.NoneType)]
            return " or ".join([*words, "null"])
        case part:
            return json_type_of(part)


def json_type_of(part):
    names = {
        **{"StrType": "string", "BoolType": "boolean", "IntType": "integer", "FloatType": "number"},
        **{"ListType": "array", "TupleType": "array", "VarTupleType": "array", "DictType": "object"},
        **{"StructType": "object", "LiteralType": "string"},
    }
    return names[type(part).__name__]


@pytest.mark.parametrize(
    ("name", "record"),
    [("smash-run/1", RunRecord), ("smash-episode-run/1", EpisodeRecord), ("smash-topple-trial/1", Trial)],
)
def test_every_field_is_documented_with_its_type(name, record):
    documented = dict(re.findall(r"^\| `(\w+)` \| ([a-z ]+) \|", TABLES[name], re.MULTILINE))
    assert documented == {field.name: json_type(field.type) for field in msgspec.structs.fields(record)}
    assert list(documented) == [field.name for field in msgspec.structs.fields(record)]

"""`smash.problem.documents` of 0.1: `smash.problem.files.documents`."""

from smash.problem.files.documents import (
    check_format,
    convert,
    one_key_a_line,
    parse_json,
    parse_toml,
    read_bytes,
    replacing,
    require_writable,
    write_text,
)

__all__ = [
    "check_format",
    "convert",
    "one_key_a_line",
    "parse_json",
    "parse_toml",
    "read_bytes",
    "replacing",
    "require_writable",
    "write_text",
]

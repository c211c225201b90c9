"""Seeded damage to a file: its bytes, its words, its values, or what the file itself is."""

import json
import os
import re

ODD = [
    *(None, True, False, 0, -1, 0.5, -0.0, 2**31, 2**53 + 1, 2**63, 10**30, 10**400, -(10**18), 1e300, 5e-324),
    *([], {}, [[]], [[[]]], {"": ""}, [None], ["pick"], [0, 0], [1e308, 1e308], "", " ", "table", "topple", "0"),
    *("=cmd|' /C calc'!A0", "\x1b[31mred", "\ud800", "a\nb|c", "</script><b>", "$x_{$", "%s\\input{x}", "\u202egnp"),
    *(
        "-2+3",
        "../../../../../../tmp/escaped",
        "/tmp/escaped",
        "x" * 5000,
        "\0",
        "b1",
        "s1",
        "NaN",
        "1_0",
        "é",
        "e\u0301",
    ),
]
"""Values of JSON that are seldom thought of."""
TOML = [
    *(
        "1979-05-27",
        "07:32:00",
        "1979-05-27T07:32:00Z",
        "nan",
        "inf",
        "-inf",
        "1e400",
        "0xffffffffffffffffffff",
        "true",
    ),
    *(
        "[]",
        "{}",
        '""',
        '"\\u0000"',
        "'''\n'''",
        "[[1]]",
        "{ a = 1 }",
        "9223372036854775808",
        "-1",
        "0",
        "0.1",
        '["x"]',
    ),
    *('"../../../../tmp/escaped"', '"/tmp/escaped"', '"{out}/x"', "[" * 3000 + "]" * 3000, "9" * 5000, '"topple"'),
]
"""Values of TOML, as they stand in a file."""
WORDS = [
    *(
        "",
        "(",
        ")",
        "()",
        "((",
        "))",
        "((((((((",
        ":init",
        ":goal",
        "and",
        "not",
        "or",
        "forall",
        "exists",
        "when",
        "-",
    ),
    *("either", "?x", "object", "=", "1e999", "nan", "99999999999999999999", "9" * 5000, "-1", ";", "(:init)", "on"),
    *(
        "clear",
        "(on a a)",
        "holding",
        "\0",
        "é",
        "\ud800",
        "table",
        '"',
        ",",
        "\n",
        "\t",
        "|",
        "{",
        "}",
        "[",
        "]",
        "x" * 3000,
    ),
]
"""Words of PDDL, plans of planners and tables."""
BYTES = [
    *(
        b"NaN",
        b"Infinity",
        b"1e999",
        b"-",
        b"[" * 9000 + b"]" * 9000,
        b'{"a":' * 2000,
        b"(" * 5000,
        b"\xff",
        b"\x00",
        b"",
    ),
    *(
        b"\xef\xbb\xbf",
        b"\xed\xa0\x80",
        b"\xc0\xaf",
        b"\x1b[31m",
        b"\r",
        b"\n",
        b"\n\n",
        b"9" * 5000,
        b"\\ud800",
        b"\\u0000",
    ),
]
"""Bytes to put anywhere."""


def places(part, path=()):
    """Every place in a document, as a path of keys and indices."""
    yield path
    inner = part.items() if isinstance(part, dict) else enumerate(part) if isinstance(part, list) else ()
    for key, value in inner:
        yield from places(value, (*path, key))


def changed(document, draw):
    """A document with one part replaced, left out, doubled, or called otherwise."""
    document = json.loads(json.dumps(document))
    paths = [path for path in places(document) if path]
    if not paths or draw.random() < 0.02:
        return draw.choice(ODD)
    *way, last = draw.choice(paths)
    at = document
    for key in way:
        at = at[key]
    kind = draw.random()
    if kind < 0.15:
        del at[last]
    elif kind < 0.25 and isinstance(at, dict):
        at[draw.choice(["", "x", last + "s", last.upper(), "\ud800", "format", "\0", "x" * 3000])] = at.pop(last)
    elif kind < 0.35 and isinstance(at, list):
        at.insert(draw.randrange(len(at) + 1), at[last])
    elif kind < 0.45:
        *way, other = draw.choice(paths)
        part = document
        try:
            for key in (*way, other):
                part = part[key]
        except (LookupError, TypeError):
            part = None
        at[last] = json.loads(json.dumps(part))
    else:
        at[last] = draw.choice(ODD)
    return document


def _json(content, draw):
    document = json.loads(content)
    for _ in range(draw.choice([1, 1, 1, 2, 5])):
        document = changed(document, draw)
    return json.dumps(document, ensure_ascii=draw.random() < 0.9).encode(errors="surrogatepass")


def _lines(content, draw):
    lines = content.splitlines()
    at = draw.randrange(len(lines))
    lines[at] = _json(lines[at], draw)
    if draw.random() < 0.1:
        lines.insert(draw.randrange(len(lines)), draw.choice(lines))
    return b"\n".join(lines) + b"\n" * (draw.random() < 0.9)


def _toml(content, draw):
    lines = content.decode().splitlines()
    settings = [at for at, line in enumerate(lines) if "=" in line and not line.startswith("#")]
    for _ in range(draw.choice([1, 1, 2])):
        at, kind = draw.choice(settings), draw.random()
        name, _, _ = lines[at].partition("=")
        if kind < 0.7:
            lines[at] = f"{name}= {draw.choice(TOML)}"
        elif kind < 0.8:
            lines[at] = ""
        elif kind < 0.9:
            lines.insert(at, lines[draw.randrange(len(lines))])
        else:
            lines[at] = "x" + lines[at]
    return ("\n".join(lines) + "\n").encode()


def _words(content, draw):
    words = re.split(r"(\s+|[(),])", content.decode())
    for _ in range(draw.choice([1, 1, 2, 4])):
        at, kind = draw.randrange(len(words)), draw.random()
        if kind < 0.5:
            words[at] = draw.choice(WORDS)
        elif kind < 0.7:
            words[at] = draw.choice(words)
        elif kind < 0.85:
            words[at] = ""
        else:
            words.insert(at, draw.choice(words))
    return "".join(words).encode(errors="surrogatepass")


SORTS = {"json": _json, "jsonl": _lines, "toml": _toml, "words": _words}


def spoiled(content, draw):
    """Content with some of its bytes changed, whatever they mean."""
    at = draw.randrange(len(content) + 1)
    end = min(len(content), at + draw.choice([0, 1, 2, 3, 10, 100]))
    match draw.randrange(9):
        case 0:
            return content[:at]
        case 1:
            return content[at:]
        case 2:
            return content + content
        case 3:
            return draw.choice([b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"]) + content
        case 4:
            return content.decode(errors="replace").encode(draw.choice(["utf-16", "utf-32", "utf-7"]))
        case 5 if content:
            at = draw.randrange(len(content))
            return content[:at] + bytes([content[at] ^ 1 << draw.randrange(8)]) + content[at + 1 :]
        case 6:
            return draw.choice([b"", b"\n", b"\0", b"{}", b"[]", b"null", b"0", b'""', b"{", b"()", *BYTES])
    return content[:at] + draw.choice(BYTES) + content[end:]


def damage(file, content, sort, draw):
    """Put damaged content in a file's place, or something that is no file; return what was put there."""
    if file.is_dir() and not file.is_symlink():
        file.rmdir()
    file.unlink(missing_ok=True)
    kind = draw.random()
    if kind < 0.005:
        file.mkdir()
        return "a directory"
    if kind < 0.015:
        target = draw.choice([file, file.with_name("nothing"), "/proc/self/mem", "/dev/null"])
        os.symlink(target, file)
        return f"a link to {target}"
    made = spoiled(content, draw) if kind < 0.25 else SORTS[sort](content, draw)
    file.write_bytes(made)
    return made

"""Tables in LaTeX: they compile with booktabs alone, at 7 pt, within one column and within two."""

import re
import shutil
import subprocess

import pandas as pd
import pytest
from smash_analysis.tables.latex import SIZE, latex, tex, write_latex

WIDE = pd.DataFrame(
    {
        "suite": ["multi-9"] * 3,
        "planner": ["smash-flow cold (CP-SAT)", "fd-lama:conditional", "a_b\\c{d}$e^f~g#h&i%j <k> |l|"],
        "coverage [95 %]": ["100 % [68, 100]", "0 % [0, 32]", "–"],
        **{
            f"first plan [s] (median [IQR]), {n}": ["0.03 [0.03, 0.04]", "1.5 ± 0.2 (1.4)", "≤ 4 × 3"] for n in range(8)
        },
        "example": ["multi-9-003 seed 2: " + "nothing was found within the time that there was " * 4, "中 é ✓", "[1]"],
    }
)
LONG = pd.DataFrame({"instance": [f"multi-{n}" for n in range(150)], "cost": range(150), "n": [1] * 150})
TOGETHER = pd.DataFrame({"averyveryverylongnamewithoutanyblankinit": ["x" * 70], "b": ["y"]})


def floats(table, wide):
    return latex(table, "Table II: 50 % of “all” & more", "tab:x", wide=wide)


@pytest.mark.parametrize("wide", [True, False])
def test_a_caption_has_no_number_of_its_own_and_nothing_is_scaled(wide):
    text = floats(WIDE, wide)
    assert r"\caption{50 \% of ``all'' \& more}" in text
    assert not re.search(r"resizebox|longtable|tiny|checkmark|multirow|makecell", text)
    sizes = re.findall(r"\\fontsize{([\d.]+)}", text)
    assert sizes
    assert all(float(size) >= 7 for size in sizes)
    assert SIZE >= 7


@pytest.mark.parametrize(
    ("text", "shown"),
    [("-25 (-25 to -.5)", "$-$25 ($-$25 to $-$.5)"), ("multi-9-000", "multi-9-000"), ("[3]-1, 2 - 1", "[3]-1, 2 - 1")],
)
def test_a_number_below_zero_has_a_minus_and_no_hyphen(text, shown):
    assert tex(text) == shown


def test_a_long_table_goes_to_further_floats_and_loses_no_row():
    text = floats(LONG, False)
    assert text.count(r"\begin{table}") == text.count(r"\caption") > 1
    assert all(f"multi-{n} &" in text or f"{n} & multi" in text for n in range(150))
    assert len(set(re.findall(r"\\label{(.*?)}", text))) == text.count(r"\label")


def test_what_is_too_wide_stands_in_panels_that_name_their_rows():
    text = floats(WIDE, False)
    bodies = re.findall(r"\\toprule\n(.*?)\\bottomrule", text, re.DOTALL)
    assert len(bodies) > 1
    assert all(body.startswith(("row", "suite")) for body in bodies)


def test_both_forms_are_written(tmp_path):
    assert [file.name for file in write_latex(LONG, "Long", "tab:l", tmp_path / "l")] == ["l.tex", "l-column.tex"]


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="TeX is not installed")
def test_they_compile_with_booktabs_alone_and_stay_within_their_columns(tmp_path):
    shape = r"\usepackage[a4paper,textwidth=496pt,hmargin=50pt,columnsep=14pt]{geometry}"
    bodies = [floats(table, wide) + r"\clearpage" for table in (WIDE, LONG, TOGETHER) for wide in (True, False)]
    lines = [r"\documentclass[10pt,twocolumn]{article}", shape, r"\usepackage{booktabs}", r"\begin{document}", *bodies]
    (tmp_path / "all.tex").write_text("\n".join([*lines, r"\end{document}"]), encoding="utf-8")
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "all.tex"]
    made = subprocess.run(command, cwd=tmp_path, capture_output=True, timeout=100)
    log = (tmp_path / "all.log").read_text(encoding="latin-1")
    assert made.returncode == 0, log[-2000:]
    assert not re.findall(r"^(?:Overfull|.*Float too large).*", log, re.MULTILINE)

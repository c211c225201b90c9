"""Blocks worlds in many dresses: the same problem told by domains of other kinds, with other names."""

import itertools
from dataclasses import dataclass, field

USUAL = (
    "on",
    "ontable",
    "clear",
    "holding",
    "handempty",
    "pick-up",
    "put-down",
    "stack",
    "unstack",
    "shift",
    "drop",
    "lift",
)
OTHERS = {
    "usual": {},
    "crates": {
        "on": "rests", "ontable": "grounded", "clear": "free", "holding": "dangling", "handempty": "crane-idle",
        "pick-up": "hoist", "put-down": "lower", "stack": "pile", "unstack": "unpile",
        "shift": "swing", "drop": "ground", "lift": "raise",
    },
    # the words mean what they should not
    "mystery": {
        "on": "holding", "ontable": "clear", "clear": "on", "holding": "ontable", "handempty": "harmony",
        "pick-up": "put-down", "put-down": "pick-up", "stack": "feast", "unstack": "stack", "shift": "attack",
        "drop": "overcome", "lift": "succumb",
    },
    "underscores": {"handempty": "arm_empty", "ontable": "on_table", "pick-up": "pick_up", "put-down": "put_down"},
    "random": {
        "on": "q7x", "ontable": "zz_9", "clear": "v-1", "holding": "k0k", "handempty": "w8", "pick-up": "a1",
        "put-down": "a2", "stack": "a3", "unstack": "a4", "shift": "a5", "drop": "a6", "lift": "a7",
    },
}  # fmt: skip
"""How the predicates and actions are called."""

FOUR = """
 (:action pick-up :parameters (?x {B}) :precondition (and (clear ?x) (ontable ?x) (handempty{H}) {S})
  :effect (and (not (ontable ?x)) (not (clear ?x)) (not (handempty{H})) {full} (holding ?x)))
 (:action put-down :parameters (?x {B}) :precondition (and (holding ?x) {S})
  :effect (and (not (holding ?x)) (clear ?x) (handempty{H}) {empty} (ontable ?x)))
 (:action stack :parameters (?x {B} ?y {B}) :precondition (and (holding ?x) (clear ?y) {S})
  :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty{H}) {empty} (on {XY})))
 (:action unstack :parameters (?x {B} ?y {B}) :precondition (and (on {XY}) (clear ?x) (handempty{H}) {S})
  :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty{H})) {full} (not (on {XY}))))"""
THREE = """
 (:action shift :parameters (?x {B} ?z {B} ?y {B})
  :precondition (and (clear ?x) (clear ?y) (on ?x ?z) {S} {differ})
  :effect (and (on ?x ?y) (clear ?z) (not (on ?x ?z)) (not (clear ?y))))
 (:action drop :parameters (?x {B} ?z {B}) :precondition (and (clear ?x) (on ?x ?z) {S})
  :effect (and (ontable ?x) (clear ?z) (not (on ?x ?z))))
 (:action lift :parameters (?x {B} ?y {B}) :precondition (and (clear ?x) (clear ?y) (ontable ?x) {S} {differ})
  :effect (and (on ?x ?y) (not (ontable ?x)) (not (clear ?y))))"""
KINDS = {
    "four": FOUR,
    "four-reversed": FOUR.replace("{XY}", "?y ?x"),
    "three": THREE,
    "three-table": """
 (:action shift :parameters (?x ?z ?y) :precondition (and (not (= ?x slab)) (not (= ?y slab)) (not (= ?x ?y)) (clear ?x)
   (clear ?y) (on ?x ?z) {S})
  :effect (and (on ?x ?y) (clear ?z) (not (on ?x ?z)) (not (clear ?y))))
 (:action drop :parameters (?x ?z) :precondition (and (not (= ?z slab)) (not (= ?x slab)) (clear ?x) (on ?x ?z) {S})
  :effect (and (on ?x slab) (clear ?z) (not (on ?x ?z))))""",
    "one-move": """
 (:action shift :parameters (?x ?z ?y) :precondition (and (not (= ?x slab)) (not (= ?x ?y)) (not (= ?y ?z)) (clear ?x)
   (clear ?y) (on ?x ?z) {S})
  :effect (and (on ?x ?y) (not (on ?x ?z)) (clear ?z) (when (not (= ?y slab)) (not (clear ?y)))))""",
    "hand-table": """
 (:action unstack :parameters (?x ?y) :precondition (and (on ?x ?y) (clear ?x) (handempty) (not (= ?x slab)) {S})
  :effect (and (holding ?x) (clear ?y) (not (on ?x ?y)) (not (clear ?x)) (not (handempty))))
 (:action stack :parameters (?x ?y) :precondition (and (holding ?x) (clear ?y) (not (= ?x ?y)) {S})
  :effect (and (on ?x ?y) (clear ?x) (handempty) (not (holding ?x)) (when (not (= ?y slab)) (not (clear ?y)))))""",
    "quantified": """
 (:action pick-up :parameters (?x {B}) :precondition (and (ontable ?x) (forall (?o {B}) (not (on ?o ?x)))
   (not (exists (?o {B}) (holding ?o))) {S}) :effect (and (not (ontable ?x)) (holding ?x)))
 (:action put-down :parameters (?x {B}) :precondition (and (holding ?x) {S})
  :effect (and (not (holding ?x)) (ontable ?x)))
 (:action stack :parameters (?x {B} ?y {B}) :precondition (and (holding ?x) (not (= ?x ?y))
   (forall (?o {B}) (not (on ?o ?y))) {S}) :effect (and (not (holding ?x)) (on ?x ?y)))
 (:action unstack :parameters (?x {B} ?y {B}) :precondition (and (on ?x ?y) (forall (?o {B}) (not (on ?o ?x)))
   (not (exists (?o {B}) (holding ?o))) {S}) :effect (and (holding ?x) (not (on ?x ?y))))""",
    "no-ontable": """
 (:action pick-up :parameters (?x {B}) :precondition (and (clear ?x) (forall (?o {B}) (not (on ?x ?o))) (handempty) {S})
  :effect (and (not (clear ?x)) (not (handempty)) (holding ?x)))
 (:action put-down :parameters (?x {B}) :precondition (and (holding ?x) {S})
  :effect (and (not (holding ?x)) (clear ?x) (handempty)))
 (:action stack :parameters (?x {B} ?y {B}) :precondition (and (holding ?x) (clear ?y) {S})
  :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))
 (:action unstack :parameters (?x {B} ?y {B}) :precondition (and (on ?x ?y) (clear ?x) (handempty) {S})
  :effect (and (holding ?x) (clear ?y) (not (clear ?x)) (not (handempty)) (not (on ?x ?y))))""",
    "derived": """
 (:derived (clear ?x {B}) (and (not (holding ?x)) (forall (?o {B}) (not (on ?o ?x)))))
 (:action pick-up :parameters (?x {B}) :precondition (and (clear ?x) (ontable ?x) (handempty) {S})
  :effect (and (not (ontable ?x)) (not (handempty)) (holding ?x)))
 (:action put-down :parameters (?x {B}) :precondition (and (holding ?x) {S})
  :effect (and (not (holding ?x)) (handempty) (ontable ?x)))
 (:action stack :parameters (?x {B} ?y {B}) :precondition (and (holding ?x) (clear ?y) {S})
  :effect (and (not (holding ?x)) (handempty) (on ?x ?y)))
 (:action unstack :parameters (?x {B} ?y {B}) :precondition (and (on ?x ?y) (clear ?x) (handempty) {S})
  :effect (and (holding ?x) (not (handempty)) (not (on ?x ?y))))""",
    "merged": """
 (:action pick-up :parameters (?x {B}) :precondition (and (clear ?x) (handempty) {S})
  :effect (and (holding ?x) (not (clear ?x)) (not (handempty)) (not (ontable ?x))
   (forall (?o {B}) (when (on ?x ?o) (and (not (on ?x ?o)) (clear ?o))))))
 (:action put-down :parameters (?x {B}) :precondition (and (holding ?x) {S})
  :effect (and (not (holding ?x)) (clear ?x) (handempty) (ontable ?x)))
 (:action stack :parameters (?x {B} ?y {B}) :precondition (and (holding ?x) (clear ?y) {S})
  :effect (and (not (holding ?x)) (not (clear ?y)) (clear ?x) (handempty) (on ?x ?y)))""",
    "painted": FOUR + """
 (:action paint :parameters (?x {B}) :precondition (and (clear ?x) (dry ?x)) :effect (and (wet ?x) (not (dry ?x))))""",
}  # fmt: skip
"""Kind -> the actions of its domain."""
TABLES = ("three-table", "one-move", "hand-table")
NO_HAND = ("three", "three-table", "one-move")


@dataclass(frozen=True)
class Dress:
    """How a domain and a problem are written.

    Attributes:
        kind: one of `KINDS`.
        names: one of `OTHERS`.
        typed: whether blocks have a type (kinds without a table as an object).
        extras: of `constants`, `static`, `static-negative`, `either`, `hand-object`, `full`, `costs`, `upper-case`.
    """

    kind: str
    names: str = "usual"
    typed: bool = False
    extras: frozenset[str] = field(default_factory=frozenset)

    def __str__(self):
        return "-".join([self.kind, self.names, *(["typed"] if self.typed else []), *sorted(self.extras)])

    @property
    def hand(self):
        return self.kind not in NO_HAND

    def domain(self):
        extras = self.extras
        holder = "?h" if "hand-object" in extras else ""
        condition = "(movable ?x)" if "static" in extras else ""
        condition += "(not (glued ?x))" if "static-negative" in extras else ""
        condition += "(gripper ?h)" if holder and not self.typed else ""
        actions = KINDS[self.kind]
        block = "- block" if self.typed else ""
        if holder:
            actions = actions.replace(") :precondition", f" ?h {'- arm' if self.typed else ''}) :precondition")
        for word, text in {
            "B": block,
            "H": f" {holder}" if holder else "",
            "S": condition,
            "XY": "?x ?y",
            "full": f"(busy {holder})" if "full" in extras else "",
            "empty": f"(not (busy {holder}))" if "full" in extras else "",
            "differ": "(not (= ?x ?y))" if "static" in extras else "",
        }.items():
            actions = actions.replace("{" + word + "}", text)
        if "costs" in extras:
            actions = actions.replace(":effect (and", ":effect (and (increase (total-cost) 1)")
        types = "(:types block arm - object brick cube - block)" if self.typed else ""
        constants = [*(["slab"] if self.kind in TABLES else []), *(["a"] if "constants" in extras else [])]
        listed = f"(:constants {' '.join(constants)} {block})" if constants else ""
        return self._called(f"(define (domain dressed) (:requirements :adl)\n {types} {listed}{actions})")

    def problem(self, towers, goal, held=None, more=""):
        """The problem with these towers (bottom first); `goal` in the usual names."""
        extras = self.extras
        blocks = [block for tower in towers for block in tower] + ([held] if held else [])
        facts = [] if held or not self.hand else ["(handempty robby)" if "hand-object" in extras else "(handempty)"]
        if held:
            facts += [f"(holding {held})"] + ["(busy robby)" if "hand-object" in extras else "(busy)"] * (
                "full" in extras
            )
        for tower in towers:
            if self.kind in TABLES:
                facts.append(f"(on {tower[0]} slab)")
            elif self.kind != "no-ontable":
                facts.append(f"(ontable {tower[0]})")
            pairs = itertools.pairwise(tower)
            facts += [
                f"(on {under} {upper})" if "reversed" in self.kind else f"(on {upper} {under})"
                for under, upper in pairs
            ]
            facts += [f"(clear {tower[-1]})"] if self.kind not in ("quantified", "derived") else []
        if self.kind in TABLES and self.kind != "three-table":
            facts.append("(clear slab)")
        if self.kind == "painted":
            facts += [f"(dry {block})" for block in blocks[:1]]
        if "hand-object" in extras and not self.typed:
            facts.append("(gripper robby)")
        if "static" in extras:
            facts += [f"(movable {block})" for block in blocks] + [
                f"(heavier {blocks[0]} {blocks[-1]})",
                "(= (size b) 3)",
            ]
        facts += ["(= (total-cost) 0)"] if "costs" in extras else []
        kind = "- (either brick cube)" if "either" in extras else "- brick"
        listed = [block for block in blocks if block != "a" or "constants" not in extras]
        objects = " ".join(sorted(listed)) + (f" {kind}" if self.typed else "")
        objects += (" robby" + (" - arm" if self.typed else "")) if "hand-object" in extras else ""
        start = f"(:objects {objects})\n (:init {' '.join(facts)})"
        return self._called(f"(define (problem told) (:domain dressed)\n {start}\n (:goal {goal}){more})")

    def goal(self, on=(), ontable=(), clear=()):
        """A goal of pairs (upper, under), blocks on the table and clear blocks."""
        facts = [f"(on {b} {a})" if "reversed" in self.kind else f"(on {a} {b})" for a, b in on]
        facts += [f"(on {a} slab)" if self.kind in TABLES else f"(ontable {a})" for a in ontable]
        facts += [f"(clear {a})" for a in clear]
        return f"(and {' '.join(facts)})"

    def _called(self, text):
        names = OTHERS[self.names]
        for word in USUAL:
            text = text.replace(f"({word} ", f"(@{word} ").replace(f"({word})", f"(@{word})")
            text = text.replace(f":action {word} ", f":action @{word} ")
        for word in sorted(USUAL, key=len, reverse=True):
            text = text.replace(f"@{word}", names.get(word, word))
        return text.upper() if "upper-case" in self.extras else text


def dresses():
    """Every kind in every spelling, and each further trait once with each kind that can wear it."""
    for kind in KINDS:
        for names in OTHERS:
            yield Dress(kind, names)
        if kind not in TABLES:
            yield Dress(kind, "crates", typed=True)
            yield Dress(kind, "mystery", typed=True, extras=frozenset({"either"}))
        for extra in ("constants", "static", "static-negative", "costs", "upper-case"):
            yield Dress(kind, "random", extras=frozenset({extra}))
    for typed in (False, True):
        for extras in ({"hand-object"}, {"full"}, {"hand-object", "full"}, {"full", "static", "constants"}):
            for names in ("usual", "random"):
                yield Dress("four", names, typed, frozenset(extras))

"""A PDDL encoding: what stands over a block is not kept up to date by every action but derived from `on` (axioms).

Pick and place stay as in the domain without topple, which makes the text short. `smash plan INSTANCE --planner
fd-lama:axioms` plans in it; planners that take no axioms say `unsupported`.
"""

from smash_baselines.encodings import PICK_AND_PLACE, Encoding

PREDICATES = """
    (over ?z ?b - block)              ; ?z stands somewhere above ?b in one pile
    (at-stack ?b - block)             ; ?b's pile stands at a stack location, where it can be toppled
    (hand-empty)
"""

FALL = """
                 (forall (?z - block) (when (over ?z ?b) (and (on-table ?z) (not (top ?z)))))
                 (forall (?z ?y - block) (when (over ?z ?b) (not (on ?z ?y))))
"""

TOPPLE = f"""
  (:derived (over ?z ?b - block)
    (or (on ?z ?b) (exists (?y - block) (and (on ?z ?y) (over ?y ?b)))))

  (:derived (at-stack ?b - block)
    (or (exists (?l - location) (base ?b ?l)) (exists (?y - block) (and (on ?b ?y) (at-stack ?y)))))

  (:action topple
    :parameters (?b ?under - block)
    :precondition (and (hand-empty) (on ?b ?under) (at-stack ?b))
    :effect (and (on-table ?b) (not (on ?b ?under)) (not (top ?b)) (top ?under) {FALL}
                 (increase (total-cost) 1)))

  (:action topple-base
    :parameters (?b - block ?l - location)
    :precondition (and (hand-empty) (base ?b ?l))
    :effect (and (on-table ?b) (not (base ?b ?l)) (not (bottom ?b)) (not (top ?b)) (empty ?l) {FALL}
                 (increase (total-cost) 1)))
)
"""

TEXT = (
    PICK_AND_PLACE.text.replace("smash-pick-and-place", "smash-topple-axioms")
    .replace(":action-costs", ":conditional-effects :derived-predicates :action-costs")
    .replace("\n    (hand-empty)\n", PREDICATES, 1)
    .rstrip()
    .removesuffix(")")
    + TOPPLE
)

AXIOMS = Encoding("topple-axioms", "smash-topple-axioms", TEXT)

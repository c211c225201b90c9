; Topple as a chain (see topple-chain.pddl): `topple-begin` pays, further blocks fall by `topple-drop`, `topple-end`
; says which block stays.

(:predicates
  (topples ?r - region)             ; piles of region ?r can be toppled: those of stack locations
  (edge ?b - block ?r - region)     ; a topple is under way in region ?r and has come down to ?b
)

(:functions (topple-cost) - number)

; --- topple: the top block falls first, and pays for all that fall with it.

(:action topple-begin
  :parameters (?b ?under - block ?r - region)
  :precondition (and (hand-empty) (idle) (topples ?r) (top ?b ?r) (on ?b ?under))
  :effect (and (edge ?under ?r) (not (idle)) (not (top ?b ?r)) (not (on ?b ?under)) (on-table ?b)
               (increase (total-cost) (topple-cost))))

(:action topple-begin-base          ; a stack of one block: nothing is left to fall, the topple is over
  :parameters (?b - block ?l - location ?r - region)
  :precondition (and (hand-empty) (idle) (topples ?r) (top ?b ?r) (in ?l ?r) (base ?b ?l))
  :effect (and (not (top ?b ?r)) (not (base ?b ?l)) (not (bottom ?b)) (on-table ?b) (empty ?l)
               (increase (total-cost) (topple-cost))))

(:action topple-drop                ; the next block falls
  :parameters (?b ?under - block ?r - region)
  :precondition (and (edge ?b ?r) (on ?b ?under))
  :effect (and (edge ?under ?r) (not (edge ?b ?r)) (not (on ?b ?under)) (on-table ?b)
               (increase (total-cost) 0)))

(:action topple-drop-base           ; the lowest block falls: the location is empty, the topple is over
  :parameters (?b - block ?l - location ?r - region)
  :precondition (and (edge ?b ?r) (in ?l ?r) (base ?b ?l))
  :effect (and (idle) (not (edge ?b ?r)) (not (base ?b ?l)) (not (bottom ?b)) (on-table ?b) (empty ?l)
               (increase (total-cost) 0)))

(:action topple-end                 ; ?b stays: it is the new top
  :parameters (?b - block ?r - region)
  :precondition (edge ?b ?r)
  :effect (and (idle) (not (edge ?b ?r)) (top ?b ?r)
               (increase (total-cost) 0)))

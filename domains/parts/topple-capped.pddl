; The chain of topple.pddl with a cap: (cap ?k) says how many blocks may fall after the first (max_topple - 1);
; (may-fall ?k) counts them down while a topple is under way.

(:predicates
  (topples ?r - region)             ; piles of region ?r can be toppled: those of stack locations
  (edge ?b - block ?r - region)     ; a topple is under way in region ?r and has come down to ?b
  (cap ?k - count)                  ; ?k blocks may fall after the first one of a topple
  (may-fall ?k - count)             ; ?k more blocks may fall in the topple under way
)

(:functions (topple-cost) - number)

; --- topple: the top block falls first, and pays for all that fall with it.

(:action topple-begin
  :parameters (?b ?under - block ?r - region ?k - count)
  :precondition (and (hand-empty) (idle) (topples ?r) (top ?b ?r) (on ?b ?under) (cap ?k))
  :effect (and (edge ?under ?r) (may-fall ?k) (not (idle)) (not (top ?b ?r)) (not (on ?b ?under)) (on-table ?b)
               (increase (total-cost) (topple-cost))))

(:action topple-begin-base          ; a stack of one block: nothing is left to fall, the topple is over
  :parameters (?b - block ?l - location ?r - region)
  :precondition (and (hand-empty) (idle) (topples ?r) (top ?b ?r) (in ?l ?r) (base ?b ?l))
  :effect (and (not (top ?b ?r)) (not (base ?b ?l)) (not (bottom ?b)) (on-table ?b) (empty ?l)
               (increase (total-cost) (topple-cost))))

(:action topple-drop                ; the next block falls
  :parameters (?b ?under - block ?r - region ?k ?left - count)
  :precondition (and (edge ?b ?r) (on ?b ?under) (may-fall ?k) (next ?left ?k))
  :effect (and (edge ?under ?r) (not (edge ?b ?r)) (not (may-fall ?k)) (may-fall ?left)
               (not (on ?b ?under)) (on-table ?b)
               (increase (total-cost) 0)))

(:action topple-drop-base           ; the lowest block falls: the location is empty, the topple is over
  :parameters (?b - block ?l - location ?r - region ?k ?left - count)
  :precondition (and (edge ?b ?r) (in ?l ?r) (base ?b ?l) (may-fall ?k) (next ?left ?k))
  :effect (and (idle) (not (edge ?b ?r)) (not (may-fall ?k)) (not (base ?b ?l)) (not (bottom ?b)) (on-table ?b)
               (empty ?l)
               (increase (total-cost) 0)))

(:action topple-end                 ; ?b stays: it is the new top
  :parameters (?b - block ?r - region ?k - count)
  :precondition (and (edge ?b ?r) (may-fall ?k))
  :effect (and (idle) (not (edge ?b ?r)) (not (may-fall ?k)) (top ?b ?r)
               (increase (total-cost) 0)))

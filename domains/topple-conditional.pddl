; Topple as what it is: one action that moves many blocks (`forall` and `when` over `above`).
;
; Pick and place are those of pick-and-place.pddl; what is new is `above`, the transitive closure of `on`:
; (above ?z ?b) says that ?z stands somewhere above ?b in the same pile, and (above ?z stacks) that ?z's pile stands
; at a stack location, where it can be toppled. (Buffers have no topple region beside them.) It is kept up to
; date by conditional effects: what goes on top of a block goes above everything that this block is above.
; (stacked ?b) follows from the rest; it stands in the conditions so that a planner's invariant synthesis sees that
; a block is stacked, in the hand or in the table region, and never two of these.
;
; No cap on the blocks of one topple can be said here; the chain encoding says it.
(define (domain smash-topple-conditional)
  (:requirements :strips :typing :conditional-effects :action-costs)

  (:types support location count - object
          block region - support)

  (:constants stacks - region)        ; the stack locations, as opposed to the buffers

  (:predicates
    (on ?b ?under - block)            ; ?b lies directly on ?under
    (above ?b - block ?x - support)   ; ?b is above block ?x in one pile; for `stacks`: its pile can be toppled
    (base ?b - block ?l - location)   ; ?b is at height 1 of stack location ?l
    (on-buffer ?b - block)            ; ?b is at height 1 of some buffer
    (bottom ?b - block)               ; ?b is at height 1 of some location: what `on` goals ask for
    (on-table ?b - block)             ; ?b lies in the table region (the paper's T_a)
    (stacked ?b - block)              ; ?b stands in some pile: the opposite of held or in the table region
    (top ?b - block)                  ; ?b is the uppermost block of its pile
    (empty ?l - location)             ; nothing stands at stack location ?l
    (free-buffers ?k - count)         ; ?k buffers are empty
    (next ?k ?more - count)           ; ?more = ?k + 1
    (hand-empty)
    (holding ?b - block))

  (:functions (total-cost) - number)

  ; --- pick. Cost 1.

  (:action pick
    :parameters (?b ?under - block)
    :precondition (and (hand-empty) (stacked ?b) (top ?b) (on ?b ?under))
    :effect (and (holding ?b) (not (stacked ?b)) (not (hand-empty)) (not (top ?b)) (not (on ?b ?under)) (top ?under)
                 (forall (?x - support) (not (above ?b ?x)))
                 (increase (total-cost) 1)))

  (:action pick-base
    :parameters (?b - block ?l - location)
    :precondition (and (hand-empty) (stacked ?b) (top ?b) (base ?b ?l))
    :effect (and (holding ?b) (not (stacked ?b)) (not (hand-empty)) (not (top ?b)) (not (base ?b ?l)) (not (bottom ?b))
                 (empty ?l)
                 (not (above ?b stacks))
                 (increase (total-cost) 1)))

  (:action pick-from-buffer
    :parameters (?b - block ?free ?freed - count)
    :precondition (and (hand-empty) (stacked ?b) (top ?b) (on-buffer ?b) (free-buffers ?free) (next ?free ?freed))
    :effect (and (holding ?b) (not (stacked ?b)) (not (hand-empty)) (not (top ?b)) (not (on-buffer ?b))
                 (not (bottom ?b)) (not (free-buffers ?free)) (free-buffers ?freed)
                 (increase (total-cost) 1)))

  (:action pick-from-table
    :parameters (?b - block)
    :precondition (and (hand-empty) (on-table ?b))
    :effect (and (holding ?b) (not (hand-empty)) (not (on-table ?b))
                 (increase (total-cost) 1)))

  ; --- place. Cost 1.

  (:action place
    :parameters (?b ?under - block)
    :precondition (and (holding ?b) (top ?under))
    :effect (and (hand-empty) (stacked ?b) (not (holding ?b)) (not (top ?under)) (on ?b ?under) (top ?b)
                 (above ?b ?under)
                 (forall (?x - support) (when (above ?under ?x) (above ?b ?x)))
                 (increase (total-cost) 1)))

  (:action place-base
    :parameters (?b - block ?l - location)
    :precondition (and (holding ?b) (empty ?l))
    :effect (and (hand-empty) (stacked ?b) (not (holding ?b)) (not (empty ?l)) (base ?b ?l) (bottom ?b) (top ?b)
                 (above ?b stacks)
                 (increase (total-cost) 1)))

  (:action place-on-buffer
    :parameters (?b - block ?free ?left - count)
    :precondition (and (holding ?b) (free-buffers ?free) (next ?left ?free))
    :effect (and (hand-empty) (stacked ?b) (not (holding ?b)) (not (free-buffers ?free)) (free-buffers ?left)
                 (on-buffer ?b) (bottom ?b) (top ?b)
                 (increase (total-cost) 1)))

  ; --- topple (location, height): ?b is the block at that height, the lowest that falls. It and every block above
  ;     it move to the table region, in one action of cost 1. The block under the cut becomes the top.

  (:action topple
    :parameters (?b ?under - block)
    :precondition (and (hand-empty) (stacked ?b) (on ?b ?under) (above ?b stacks))
    :effect (and (on-table ?b) (not (stacked ?b)) (not (on ?b ?under)) (not (top ?b)) (top ?under)
                 (forall (?x - support) (not (above ?b ?x)))
                 (forall (?z - block)
                   (when (and (above ?z ?b) (stacked ?z))
                         (and (on-table ?z) (not (stacked ?z)) (not (top ?z)))))
                 (forall (?z ?y - block)
                   (when (above ?z ?b) (not (on ?z ?y))))
                 (forall (?z - block ?x - support)
                   (when (above ?z ?b) (not (above ?z ?x))))
                 (increase (total-cost) 1)))

  ; The same with the cut at height 1: the whole stack falls and its location is empty.

  (:action topple-base
    :parameters (?b - block ?l - location)
    :precondition (and (hand-empty) (stacked ?b) (base ?b ?l))
    :effect (and (on-table ?b) (not (stacked ?b)) (not (base ?b ?l)) (not (bottom ?b)) (not (top ?b)) (empty ?l)
                 (not (above ?b stacks))
                 (forall (?z - block)
                   (when (and (above ?z ?b) (stacked ?z))
                         (and (on-table ?z) (not (stacked ?z)) (not (top ?z)))))
                 (forall (?z ?y - block)
                   (when (above ?z ?b) (not (on ?z ?y))))
                 (forall (?z - block ?x - support)
                   (when (above ?z ?b) (not (above ?z ?x))))
                 (increase (total-cost) 1)))
)

; The chain of topple-chain.pddl with a cap: at most `max_topple` blocks fall in one topple.
;
; (cap ?k) says how many blocks may fall after the first (max_topple - 1); (may-fall ?k) counts them down while a
; topple is under way. Everything else is topple-chain.pddl.
(define (domain smash-topple-chain-capped)
  (:requirements :strips :typing :action-costs)

  (:types block location region count - object)

  (:constants stacks buffers - region)

  (:predicates
    (on ?b ?under - block)            ; ?b lies directly on ?under
    (base ?b - block ?l - location)   ; ?b is at height 1 of stack location ?l
    (on-buffer ?b - block)            ; ?b is at height 1 of some buffer
    (bottom ?b - block)               ; ?b is at height 1 of some location: what `on` goals ask for
    (on-table ?b - block)             ; ?b lies in the table region (the paper's T_a)
    (top ?b - block ?r - region)      ; ?b is the uppermost block of its pile, which stands in region ?r
    (empty ?l - location)             ; nothing stands at stack location ?l
    (free-buffers ?k - count)         ; ?k buffers are empty
    (next ?k ?more - count)           ; ?more = ?k + 1
    (hand-empty)
    (idle)                            ; no topple is under way
    (holding ?b - block)
    (edge ?b - block)                 ; a topple is under way and has come down to ?b
    (cap ?k - count)                  ; ?k blocks may fall after the first one of a topple
    (may-fall ?k - count))            ; ?k more blocks may fall in the topple under way

  (:functions (total-cost) - number)

  ; --- pick. Cost 1.

  (:action pick
    :parameters (?b ?under - block ?r - region)
    :precondition (and (hand-empty) (idle) (top ?b ?r) (on ?b ?under))
    :effect (and (holding ?b) (not (hand-empty)) (not (top ?b ?r)) (not (on ?b ?under)) (top ?under ?r)
                 (increase (total-cost) 1)))

  (:action pick-base
    :parameters (?b - block ?l - location)
    :precondition (and (hand-empty) (idle) (top ?b stacks) (base ?b ?l))
    :effect (and (holding ?b) (not (hand-empty)) (not (top ?b stacks)) (not (base ?b ?l)) (not (bottom ?b))
                 (empty ?l)
                 (increase (total-cost) 1)))

  (:action pick-from-buffer
    :parameters (?b - block ?free ?freed - count)
    :precondition (and (hand-empty) (idle) (top ?b buffers) (on-buffer ?b) (free-buffers ?free) (next ?free ?freed))
    :effect (and (holding ?b) (not (hand-empty)) (not (top ?b buffers)) (not (on-buffer ?b)) (not (bottom ?b))
                 (not (free-buffers ?free)) (free-buffers ?freed)
                 (increase (total-cost) 1)))

  (:action pick-from-table
    :parameters (?b - block)
    :precondition (and (hand-empty) (idle) (on-table ?b))
    :effect (and (holding ?b) (not (hand-empty)) (not (on-table ?b))
                 (increase (total-cost) 1)))

  ; --- place. Cost 1.

  (:action place
    :parameters (?b ?under - block ?r - region)
    :precondition (and (holding ?b) (top ?under ?r))
    :effect (and (hand-empty) (not (holding ?b)) (not (top ?under ?r)) (on ?b ?under) (top ?b ?r)
                 (increase (total-cost) 1)))

  (:action place-base
    :parameters (?b - block ?l - location)
    :precondition (and (holding ?b) (empty ?l))
    :effect (and (hand-empty) (not (holding ?b)) (not (empty ?l)) (base ?b ?l) (bottom ?b) (top ?b stacks)
                 (increase (total-cost) 1)))

  (:action place-on-buffer
    :parameters (?b - block ?free ?left - count)
    :precondition (and (holding ?b) (free-buffers ?free) (next ?left ?free))
    :effect (and (hand-empty) (not (holding ?b)) (not (free-buffers ?free)) (free-buffers ?left)
                 (on-buffer ?b) (bottom ?b) (top ?b buffers)
                 (increase (total-cost) 1)))

  ; --- topple: the top block falls first, and pays for all that fall with it. Cost 1.

  (:action topple-begin
    :parameters (?b ?under - block ?k - count)
    :precondition (and (hand-empty) (idle) (top ?b stacks) (on ?b ?under) (cap ?k))
    :effect (and (edge ?under) (may-fall ?k) (not (idle)) (not (top ?b stacks)) (not (on ?b ?under)) (on-table ?b)
                 (increase (total-cost) 1)))

  (:action topple-begin-base          ; a stack of one block: nothing is left to fall, the topple is over
    :parameters (?b - block ?l - location)
    :precondition (and (hand-empty) (idle) (top ?b stacks) (base ?b ?l))
    :effect (and (not (top ?b stacks)) (not (base ?b ?l)) (not (bottom ?b)) (on-table ?b) (empty ?l)
                 (increase (total-cost) 1)))

  (:action topple-drop                ; the next block falls
    :parameters (?b ?under - block ?k ?left - count)
    :precondition (and (edge ?b) (on ?b ?under) (may-fall ?k) (next ?left ?k))
    :effect (and (edge ?under) (not (edge ?b)) (not (may-fall ?k)) (may-fall ?left) (not (on ?b ?under)) (on-table ?b)
                 (increase (total-cost) 0)))

  (:action topple-drop-base           ; the lowest block falls: the location is empty, the topple is over
    :parameters (?b - block ?l - location ?k ?left - count)
    :precondition (and (edge ?b) (base ?b ?l) (may-fall ?k) (next ?left ?k))
    :effect (and (idle) (not (edge ?b)) (not (may-fall ?k)) (not (base ?b ?l)) (not (bottom ?b)) (on-table ?b)
                 (empty ?l)
                 (increase (total-cost) 0)))

  (:action topple-end                 ; ?b stays: it is the new top
    :parameters (?b - block ?k - count)
    :precondition (and (edge ?b) (may-fall ?k))
    :effect (and (idle) (not (edge ?b)) (not (may-fall ?k)) (top ?b stacks)
                 (increase (total-cost) 0)))
)

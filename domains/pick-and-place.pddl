; Pick and place only: the symbolic law without topple (paper, Definition "Pick and place gadget").
;
; A state is a set of piles. A pile is told from the top: each block is `on` a block, or it is the `base` of a
; stack location, or it stands on a buffer; the uppermost block of a pile is `top`. No action needs to know in
; which location a buried block is, so none has a location as third parameter: 9 blocks and 12 buffers ground to
; some hundred actions.
;
; Buffers are interchangeable and no goal names one, so they are counted, not named: (free-buffers k) says that k
; of them are empty. Which buffer a pile stands on changes no plan's cost: every renaming of the buffers maps
; legal plans to legal plans. (An exact reduction by symmetry, no bound and no preference.)
;
; Blocks reach the table region by a topple only; some may lie there at the start, and can be picked up.
(define (domain smash-pick-and-place)
  (:requirements :strips :typing :action-costs)

  (:types block location count - object)

  (:predicates
    (on ?b ?under - block)            ; ?b lies directly on ?under
    (base ?b - block ?l - location)   ; ?b is at height 1 of stack location ?l
    (on-buffer ?b - block)            ; ?b is at height 1 of some buffer
    (bottom ?b - block)               ; ?b is at height 1 of some location: what `on` goals ask for
    (on-table ?b - block)             ; ?b lies in the table region (the paper's T_a)
    (top ?b - block)                  ; ?b is the uppermost block of its pile
    (empty ?l - location)             ; nothing stands at stack location ?l
    (free-buffers ?k - count)         ; ?k buffers are empty
    (next ?k ?more - count)           ; ?more = ?k + 1
    (hand-empty)
    (holding ?b - block))

  (:functions (total-cost) - number)

  ; --- pick: the hand is empty; the block is the top of its pile, or lies in the table region. Cost 1.

  (:action pick
    :parameters (?b ?under - block)
    :precondition (and (hand-empty) (top ?b) (on ?b ?under))
    :effect (and (holding ?b) (not (hand-empty)) (not (top ?b)) (not (on ?b ?under)) (top ?under)
                 (increase (total-cost) 1)))

  (:action pick-base
    :parameters (?b - block ?l - location)
    :precondition (and (hand-empty) (top ?b) (base ?b ?l))
    :effect (and (holding ?b) (not (hand-empty)) (not (top ?b)) (not (base ?b ?l)) (not (bottom ?b)) (empty ?l)
                 (increase (total-cost) 1)))

  (:action pick-from-buffer
    :parameters (?b - block ?free ?freed - count)
    :precondition (and (hand-empty) (top ?b) (on-buffer ?b) (free-buffers ?free) (next ?free ?freed))
    :effect (and (holding ?b) (not (hand-empty)) (not (top ?b)) (not (on-buffer ?b)) (not (bottom ?b))
                 (not (free-buffers ?free)) (free-buffers ?freed)
                 (increase (total-cost) 1)))

  (:action pick-from-table
    :parameters (?b - block)
    :precondition (and (hand-empty) (on-table ?b))
    :effect (and (holding ?b) (not (hand-empty)) (not (on-table ?b))
                 (increase (total-cost) 1)))

  ; --- place: on the top of a pile, or at height 1 of an empty location; never in the table region. Cost 1.

  (:action place
    :parameters (?b ?under - block)
    :precondition (and (holding ?b) (top ?under))
    :effect (and (hand-empty) (not (holding ?b)) (not (top ?under)) (on ?b ?under) (top ?b)
                 (increase (total-cost) 1)))

  (:action place-base
    :parameters (?b - block ?l - location)
    :precondition (and (holding ?b) (empty ?l))
    :effect (and (hand-empty) (not (holding ?b)) (not (empty ?l)) (base ?b ?l) (bottom ?b) (top ?b)
                 (increase (total-cost) 1)))

  (:action place-on-buffer
    :parameters (?b - block ?free ?left - count)
    :precondition (and (holding ?b) (free-buffers ?free) (next ?left ?free))
    :effect (and (hand-empty) (not (holding ?b)) (not (free-buffers ?free)) (free-buffers ?left)
                 (on-buffer ?b) (bottom ?b) (top ?b)
                 (increase (total-cost) 1)))
)

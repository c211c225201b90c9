; Pick and place, topple and lift, where actions and ways cost: the domain of an instance with a capacity for lifts.
;
; A lift moves the upper part of a pile whole. Only its lowest block changes what it lies on; what is above comes along,
; because it is said by `on` alone. It is a chain: the grip goes down from the top, at most as far as the capacity
; (`lift-down`), the part leaves its pile (`lift-off`), lands on another (`lift-onto`, which pays for the lift and its
; way), and its uppermost block is the top there (`lift-end`).
;
; Spots, regions and the topple are those of scoop.pddl. The file is the sum of parts/pick-and-place.pddl,
; parts/topple.pddl and parts/lift.pddl, which a test holds it to.
(define (domain smash-costs-topple-lift)
  (:requirements :strips :typing :action-costs)

  (:types
    block location region spot count - object
  )

  (:predicates
    (on ?b ?under - block)            ; ?b lies directly on ?under
    (base ?b - block ?l - location)   ; ?b is at height 1 of stack location ?l
    (on-buffer ?b - block ?r - region) ; ?b is at height 1 of some buffer of region ?r
    (bottom ?b - block)               ; ?b is at height 1 of some location: what `on` goals ask for
    (on-table ?b - block)             ; ?b lies in the table region (the paper's T_a)
    (top ?b - block ?r - region)      ; ?b is the uppermost block of its pile, which stands in region ?r
    (empty ?l - location)             ; nothing stands at stack location ?l
    (free ?r - region ?k - count)     ; ?k buffers of region ?r are empty
    (in ?l - location ?r - region)    ; where stack location ?l is
    (stands ?r - region ?p - spot)    ; where region ?r is
    (table-at ?p - spot)              ; where the table region is
    (wanted ?b - block)               ; ?b may be picked from the table region (all, or those that the goal names)
    (next ?k ?more - count)           ; ?more = ?k + 1
    (hand-empty)
    (idle)                            ; no action that is told in several steps is under way
    (holding ?b - block ?from - spot) ; ?b is in the hand, taken at ?from
    (topples ?r - region)             ; piles of region ?r can be toppled: those of stack locations
    (edge ?b - block ?r - region)     ; a topple is under way in region ?r and has come down to ?b
    (grip ?k - count)                 ; ?k blocks may be lifted beside the top one
    (seam ?b - block ?r - region)     ; a lift is under way in region ?r and has come down to ?b
    (may-lift ?k - count)             ; it may come down ?k blocks further
    (lifted ?b - block ?from - spot)  ; ?b is in the air, the lowest of what is lifted, taken at ?from
    (crown ?b - block)                ; ?b is the uppermost of what is lifted
    (landed ?r - region)              ; the lifted blocks stand in region ?r
  )

  (:functions
    (total-cost) - number
    (pick-cost) - number
    (place-cost ?from ?to - spot) - number ; the way included
    (topple-cost) - number
    (lift-cost ?from ?to - spot) - number
  )

  ; --- pick.

  (:action pick
    :parameters (?b ?under - block ?r - region ?p - spot)
    :precondition (and (hand-empty) (idle) (top ?b ?r) (stands ?r ?p) (on ?b ?under))
    :effect (and (holding ?b ?p) (not (hand-empty)) (not (top ?b ?r)) (not (on ?b ?under)) (top ?under ?r)
                 (increase (total-cost) (pick-cost))))

  (:action pick-base
    :parameters (?b - block ?l - location ?r - region ?p - spot)
    :precondition (and (hand-empty) (idle) (top ?b ?r) (in ?l ?r) (stands ?r ?p) (base ?b ?l))
    :effect (and (holding ?b ?p) (not (hand-empty)) (not (top ?b ?r)) (not (base ?b ?l)) (not (bottom ?b)) (empty ?l)
                 (increase (total-cost) (pick-cost))))

  (:action pick-from-buffer
    :parameters (?b - block ?r - region ?p - spot ?free ?freed - count)
    :precondition (and (hand-empty) (idle) (top ?b ?r) (stands ?r ?p) (on-buffer ?b ?r)
                       (free ?r ?free) (next ?free ?freed))
    :effect (and (holding ?b ?p) (not (hand-empty)) (not (top ?b ?r)) (not (on-buffer ?b ?r)) (not (bottom ?b))
                 (not (free ?r ?free)) (free ?r ?freed)
                 (increase (total-cost) (pick-cost))))

  (:action pick-from-table
    :parameters (?b - block ?p - spot)
    :precondition (and (hand-empty) (idle) (on-table ?b) (wanted ?b) (table-at ?p))
    :effect (and (holding ?b ?p) (not (hand-empty)) (not (on-table ?b))
                 (increase (total-cost) (pick-cost))))

  ; --- place.

  (:action place
    :parameters (?b ?under - block ?r - region ?from ?to - spot)
    :precondition (and (holding ?b ?from) (top ?under ?r) (stands ?r ?to))
    :effect (and (hand-empty) (not (holding ?b ?from)) (not (top ?under ?r)) (on ?b ?under) (top ?b ?r)
                 (increase (total-cost) (place-cost ?from ?to))))

  (:action place-base
    :parameters (?b - block ?l - location ?r - region ?from ?to - spot)
    :precondition (and (holding ?b ?from) (empty ?l) (in ?l ?r) (stands ?r ?to))
    :effect (and (hand-empty) (not (holding ?b ?from)) (not (empty ?l)) (base ?b ?l) (bottom ?b) (top ?b ?r)
                 (increase (total-cost) (place-cost ?from ?to))))

  (:action place-on-buffer
    :parameters (?b - block ?r - region ?from ?to - spot ?free ?left - count)
    :precondition (and (holding ?b ?from) (stands ?r ?to) (free ?r ?free) (next ?left ?free))
    :effect (and (hand-empty) (not (holding ?b ?from)) (not (free ?r ?free)) (free ?r ?left)
                 (on-buffer ?b ?r) (bottom ?b) (top ?b ?r)
                 (increase (total-cost) (place-cost ?from ?to))))

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

  ; --- lift.

  (:action lift-begin
    :parameters (?b - block ?r - region ?k - count)
    :precondition (and (hand-empty) (idle) (top ?b ?r) (grip ?k))
    :effect (and (seam ?b ?r) (crown ?b) (may-lift ?k) (not (idle)) (not (top ?b ?r))
                 (increase (total-cost) 0)))

  (:action lift-down
    :parameters (?b ?under - block ?r - region ?k ?left - count)
    :precondition (and (seam ?b ?r) (on ?b ?under) (may-lift ?k) (next ?left ?k))
    :effect (and (seam ?under ?r) (not (seam ?b ?r)) (not (may-lift ?k)) (may-lift ?left)
                 (increase (total-cost) 0)))

  (:action lift-off
    :parameters (?b ?under - block ?r - region ?p - spot ?k - count)
    :precondition (and (seam ?b ?r) (stands ?r ?p) (on ?b ?under) (may-lift ?k))
    :effect (and (lifted ?b ?p) (not (seam ?b ?r)) (not (may-lift ?k)) (not (on ?b ?under)) (top ?under ?r)
                 (increase (total-cost) 0)))

  (:action lift-off-base
    :parameters (?b - block ?l - location ?r - region ?p - spot ?k - count)
    :precondition (and (seam ?b ?r) (in ?l ?r) (stands ?r ?p) (base ?b ?l) (may-lift ?k))
    :effect (and (lifted ?b ?p) (not (seam ?b ?r)) (not (may-lift ?k)) (not (base ?b ?l)) (not (bottom ?b)) (empty ?l)
                 (increase (total-cost) 0)))

  (:action lift-off-buffer
    :parameters (?b - block ?r - region ?p - spot ?k ?free ?freed - count)
    :precondition (and (seam ?b ?r) (stands ?r ?p) (on-buffer ?b ?r) (may-lift ?k) (free ?r ?free) (next ?free ?freed))
    :effect (and (lifted ?b ?p) (not (seam ?b ?r)) (not (may-lift ?k)) (not (on-buffer ?b ?r)) (not (bottom ?b))
                 (not (free ?r ?free)) (free ?r ?freed)
                 (increase (total-cost) 0)))

  (:action lift-onto
    :parameters (?b ?under - block ?r - region ?from ?to - spot)
    :precondition (and (lifted ?b ?from) (top ?under ?r) (stands ?r ?to))
    :effect (and (landed ?r) (not (lifted ?b ?from)) (not (top ?under ?r)) (on ?b ?under)
                 (increase (total-cost) (lift-cost ?from ?to))))

  (:action lift-onto-base
    :parameters (?b - block ?l - location ?r - region ?from ?to - spot)
    :precondition (and (lifted ?b ?from) (empty ?l) (in ?l ?r) (stands ?r ?to))
    :effect (and (landed ?r) (not (lifted ?b ?from)) (not (empty ?l)) (base ?b ?l) (bottom ?b)
                 (increase (total-cost) (lift-cost ?from ?to))))

  (:action lift-onto-buffer
    :parameters (?b - block ?r - region ?from ?to - spot ?free ?left - count)
    :precondition (and (lifted ?b ?from) (stands ?r ?to) (free ?r ?free) (next ?left ?free))
    :effect (and (landed ?r) (not (lifted ?b ?from)) (not (free ?r ?free)) (free ?r ?left) (on-buffer ?b ?r) (bottom ?b)
                 (increase (total-cost) (lift-cost ?from ?to))))

  (:action lift-end
    :parameters (?b - block ?r - region)
    :precondition (and (crown ?b) (landed ?r))
    :effect (and (idle) (not (crown ?b)) (not (landed ?r)) (top ?b ?r)
                 (increase (total-cost) 0)))
)

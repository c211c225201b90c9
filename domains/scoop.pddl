; Pick and place, topple and the paper's scoop, where actions and ways cost: the domain of an instance with carriers.
;
; A carrier holds blocks side by side. They are put on it and taken from it by picks and places; `carry` moves the
; carrier alone, and what is on it comes along, because nothing is said about where those blocks are.
;
; A `spot` is a point between which ways are paid (the cost functions have the way in them); where travel costs nothing
; there is one for everything. A `region` is all stack locations of one spot, or all buffers of one spot: buffers of one
; region are interchangeable, hence counted and not named. The held block remembers the spot that it was taken from.
;
; A topple is a chain, as in topple-chain.pddl. The file is the sum of parts/pick-and-place.pddl, parts/topple.pddl and
; parts/carry.pddl, which a test holds it to.
(define (domain smash-costs-topple-carry)
  (:requirements :strips :typing :action-costs)

  (:types
    block location region spot count - object
    carrier station - object
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
    (on-carrier ?b - block ?c - carrier)
    (room ?c - carrier ?k - count)    ; ?k more blocks fit on ?c
    (parked ?c - carrier ?t - station)
    (vacant ?t - station)             ; no carrier is parked at ?t
    (reaches ?c - carrier ?t - station) ; ?t is one of its stations; none where carry is not allowed
    (loads ?c - carrier)              ; blocks may be placed on it; not so where carry is not allowed
    (station-at ?t - station ?p - spot)
  )

  (:functions
    (total-cost) - number
    (pick-cost) - number
    (place-cost ?from ?to - spot) - number ; the way included
    (topple-cost) - number
    (carry-cost ?from ?to - spot) - number
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

  ; --- carry: the carrier and all that is on it.

  (:action carry
    :parameters (?c - carrier ?t ?target - station ?from ?to - spot)
    :precondition (and (hand-empty) (idle) (parked ?c ?t) (vacant ?target) (reaches ?c ?target)
                       (station-at ?t ?from) (station-at ?target ?to))
    :effect (and (not (parked ?c ?t)) (vacant ?t) (parked ?c ?target) (not (vacant ?target))
                 (increase (total-cost) (carry-cost ?from ?to))))

  (:action pick-from-carrier
    :parameters (?b - block ?c - carrier ?t - station ?p - spot ?room ?more - count)
    :precondition (and (hand-empty) (idle) (on-carrier ?b ?c) (parked ?c ?t) (station-at ?t ?p)
                       (room ?c ?room) (next ?room ?more))
    :effect (and (holding ?b ?p) (not (hand-empty)) (not (on-carrier ?b ?c)) (not (room ?c ?room)) (room ?c ?more)
                 (increase (total-cost) (pick-cost))))

  (:action place-on-carrier
    :parameters (?b - block ?c - carrier ?t - station ?from ?to - spot ?room ?left - count)
    :precondition (and (holding ?b ?from) (loads ?c) (parked ?c ?t) (station-at ?t ?to)
                       (room ?c ?room) (next ?left ?room))
    :effect (and (hand-empty) (not (holding ?b ?from)) (on-carrier ?b ?c) (not (room ?c ?room)) (room ?c ?left)
                 (increase (total-cost) (place-cost ?from ?to))))
)

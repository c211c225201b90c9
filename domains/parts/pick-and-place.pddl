; Pick and place where costs count: the common ground of every domain of the family. The parts beside this file add
; one aggregating action each; `baselines/family` puts together those that an instance has. scoop.pddl and
; lift.pddl are two results, to be read whole.
;
; A `spot` is a point between which ways are paid; where travel costs nothing there is one for everything. A `region`
; is all stack locations of one spot, or all buffers of one spot: buffers of one region are interchangeable, hence
; counted and not named. The held block remembers the spot that it was taken from, because the place pays for the way.

(:types block location region spot count - object)

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
)

(:functions
  (total-cost) - number
  (pick-cost) - number
  (place-cost ?from ?to - spot) - number ; the way included
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

; Lift: the upper part of a pile moves whole to another location. Only its lowest block changes what it lies on, and
; what is above comes along, because it is said by `on` alone. Told as a chain: the grip goes down from the top at most
; as far as the capacity (`lift-down`), the part leaves its pile (`lift-off`), lands on another (`lift-onto`, which pays
; the lift and its way) and its uppermost block is the top there (`lift-end`).

(:predicates
  (grip ?k - count)                 ; ?k blocks may be lifted beside the top one
  (seam ?b - block ?r - region)     ; a lift is under way in region ?r and has come down to ?b
  (may-lift ?k - count)             ; it may come down ?k blocks further
  (lifted ?b - block ?from - spot)  ; ?b is in the air, the lowest of what is lifted, taken at ?from
  (crown ?b - block)                ; ?b is the uppermost of what is lifted
  (landed ?r - region)              ; the lifted blocks stand in region ?r
)

(:functions (lift-cost ?from ?to - spot) - number)

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

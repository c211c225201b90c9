; Carry (the paper's scoop): a carrier holds blocks side by side and takes them along. Blocks are said to be on the
; carrier and not at its station, so that one action that moves the carrier alone moves all of them. Loading and
; unloading are picks and places.

(:types carrier station - object)

(:predicates
  (on-carrier ?b - block ?c - carrier)
  (room ?c - carrier ?k - count)    ; ?k more blocks fit on ?c
  (parked ?c - carrier ?t - station)
  (vacant ?t - station)             ; no carrier is parked at ?t
  (reaches ?c - carrier ?t - station) ; ?t is one of its stations; none where carry is not allowed
  (loads ?c - carrier)              ; blocks may be placed on it; not so where carry is not allowed
  (station-at ?t - station ?p - spot))

(:functions (carry-cost ?from ?to - spot) - number)

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

; What an `on` goal may say beside (on …) and (bottom …): words about a block that hold in several ways. A word `rests`
; holds at the bottom of a location and in the table region, a word `lies-clear` on top of a pile and in the table region.
;
; They are judged when all is done. `finish` takes the empty hand away, so that nothing moves any more; then each word is
; met by the way in which it holds, one after the other, all at cost 0. Every plan says as many of these steps, so where
; costs are left out the cheapest plans stay the same. No action of a domain has to know of it, and the domains of the
; other problems stay as they are.

(:types word - object)

(:predicates
  (rests ?w - word ?b - block)      ; the word: ?b at the bottom of a location or in the table region
  (lies-clear ?w - word ?b - block) ; the word: nothing on ?b
  (opens ?w - word)                 ; no word: it is met by `finish`
  (before ?w ?v - word)             ; ?v is judged after ?w: one order is enough
  (met ?w - word)
)

; --- the words of the goal.

(:action finish
  :parameters (?w - word)
  :precondition (and (hand-empty) (opens ?w))
  :effect (and (met ?w) (not (hand-empty))
               (increase (total-cost) 0)))

(:action rests-at-bottom
  :parameters (?b - block ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (rests ?v ?b) (bottom ?b))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

(:action rests-in-region
  :parameters (?b - block ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (rests ?v ?b) (on-table ?b))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

(:action clear-on-top
  :parameters (?b - block ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (lies-clear ?v ?b) (top ?b))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

(:action clear-in-region
  :parameters (?b - block ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (lies-clear ?v ?b) (on-table ?b))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

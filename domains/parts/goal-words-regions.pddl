; The words of goal-words.pddl, for domains whose `top` says in which region the pile stands, and whose arm is `idle`
; when no action of several steps is under way.

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
  :precondition (and (hand-empty) (idle) (opens ?w))
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
  :parameters (?b - block ?r - region ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (lies-clear ?v ?b) (top ?b ?r))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

(:action clear-in-region
  :parameters (?b - block ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (lies-clear ?v ?b) (on-table ?b))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

; Where there are carriers: nothing lies on the blocks that they hold, side by side (goal-words-regions.pddl has the rest).

; --- the words of the goal, on carriers.

(:action clear-on-carrier
  :parameters (?b - block ?c - carrier ?w ?v - word)
  :precondition (and (met ?w) (before ?w ?v) (lies-clear ?v ?b) (on-carrier ?b ?c))
  :effect (and (met ?v)
               (increase (total-cost) 0)))

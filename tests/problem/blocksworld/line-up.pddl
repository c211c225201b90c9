; four blocks on the table, to be one tower: six actions
(DEFINE (PROBLEM Line-Up) (:DOMAIN BLOCKS)
  (:OBJECTS W X Y Z)
  (:INIT (CLEAR W) (CLEAR X) (CLEAR Y) (CLEAR Z)
         (ONTABLE W) (ONTABLE X) (ONTABLE Y) (ONTABLE Z) (HANDEMPTY))
  (:GOAL (AND (ON W X) (ON X Y) (ON Y Z))))

;; the Sussman anomaly, typed, with the hand and the table named otherwise
(define (problem sussman)
  (:domain blocks4)
  (:requirements :strips :typing)
  (:objects a b - block   c - block)
  (:init (on-table a) (on-table b) (on c a) (clear b) (clear c) (arm-empty))
  (:goal (and (on a b) (on b c) (on-table c) (clear a) (arm-empty))))

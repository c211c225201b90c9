"""Forecasts: what a plan will take in seconds and at what risk, before it is carried out; and plans chosen by that.

The outcome model of a scene is data (`model`): how long motions take, where blocks land that are toppled. It is made
by `smash topple-map --model`; nothing here loads a simulator or plans a motion.
"""

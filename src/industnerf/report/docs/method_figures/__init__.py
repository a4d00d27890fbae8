"""The paper's figure 2 with what really happens to one part: the figures of docs/reference/method.md.

`making` runs the method and keeps what it passes through, `profile` looks along one ray; a file
each for the figures of what goes in (3.1), refinement (3.2), rendering (3.3) and confidence
(3.4).
"""

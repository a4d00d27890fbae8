"""The paper's figure 2 with what really happens to one part: the plates of docs/reference/method.md.

`making` runs the method and keeps what it passes through, `profile` looks along one ray; a file
each for the plates of what goes in (3.1), the refining (3.2), the seeing (3.3) and the judging
(3.4).
"""

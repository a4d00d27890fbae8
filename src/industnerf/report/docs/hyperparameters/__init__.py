"""docs/reference/hyperparameters.md: the list that section 4.2 of the paper promises and does not give.

It is made of params.yaml, whose comments are the only descriptions, and of dvc.yaml.
"""

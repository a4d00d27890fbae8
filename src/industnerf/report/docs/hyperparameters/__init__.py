"""docs/reference/hyperparameters.md, from params.yaml, whose comments are the only descriptions."""

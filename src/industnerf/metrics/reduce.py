import numpy as np, fpsample
def farthest_points(x, n):
    if len(x)<=n: return x
    return x[fpsample.bucket_fps_kdline_sampling(x, n, 5, start_idx=0)]
def random_points(x, n, rng):
    return x if len(x)<=n else x[rng.choice(len(x), n, replace=False)]

"""The paper's own numbers (its Tables 1 and 2), to stand beside ours."""

METHOD = "industnerf"  # its own method, whose name here this is

EMD = {
    "industnerf": 0.0121665,
    "r2n2": 0.0482132,
    "atlasnet": 0.0759724,
    "occupancy": 0.0618715,
}

TABLE2 = {  # of its own method; what the MSEs average over, and in which unit, is not said
    "emd": EMD[METHOD],
    "rgb_mse": 0.0986291,
    "depth_mse": 0.0117503,
}

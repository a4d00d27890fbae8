"""The numbers of the paper's Tables 1 and 2."""

METHOD = "industnerf"  # our name of the paper's method

MODELS = {  # as Table 1 calls them
    "industnerf": "Ours",
    "r2n2": "3D-R2N2",
    "atlasnet": "AtlasNet",
    "occupancy": "Occupancy Networks",
}

EMD = {
    "industnerf": 0.0121665,
    "r2n2": 0.0482132,
    "atlasnet": 0.0759724,
    "occupancy": 0.0618715,
}

TABLE2 = {  # of METHOD; the paper does not say what the MSEs average over, nor their units
    "emd": EMD[METHOD],
    "rgb_mse": 0.0986291,
    "depth_mse": 0.0117503,
}

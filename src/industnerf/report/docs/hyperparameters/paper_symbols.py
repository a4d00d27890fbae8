"""What the paper calls each setting: symbol and place, where it has one."""

NERF_SYMBOLS = {
    "readings.position_encoding": "PosE, (1)-(3)",
    "readings.encoding_frame": "PosE(P), (4)",
    "readings.view_pooling": "pi(F, P, X), (4)",
    "readings.density_activation": "sigma > 0, 3.3",
    "readings.sample_position": "ITS, 3.2",
    "readings.sampling_density": "PDF, (5)",
    "readings.interpolation": "W, (11)",
    "readings.color_scale": "L, (12)",
    "readings.transmittance": "T, (11)",
    "readings.target_views": "I - O, (12)",
    "readings.extraction": "t, (13)",
    "readings.encoder": "E, 3.1",
    "readings.opacity": "t, (13)",
    "readings.sample_reduction": "t, (13)",
    "grid_res": "r, 3.1",
    "levels[1].points": "points of 3.2",
    "refine": "ITS, 3.2",
    "network.enabled": "E and N, (4)",
    "network.feature_channels": "channels of F, 3.1",
    "network.encoder_width": "E, 3.1",
    "network.encoding_channels": "C, (2)-(3)",
    "network.encoding_alpha": "alpha, (2)-(3)",
    "network.encoding_beta": "beta, (2)-(3)",
    "network.hidden_dim": "N, (4)",
    "network.hidden_layers": "N, (4)",
    "max_raw_density": "sigma",
    "step_size": "delta, (10)",
    "fine_step_size": "delta, (10)",
    "neighbor_radius": "r, 3.3",
    "neighbors": "k, 3.3",
    "early_stop_transmittance": "T, (10)",
    "min_confidence": "t, (13)",
}
NERF_METHODS = ("industnerf", "industnerf_plus", "industnerf_depth", "industnerf_shared", "nerf")
PAPER_SYMBOLS = {
    "parts.source": "the dataset, 4.1",
    "views.count": "views (I, P), 3.1",
    "views.resolution": "512 x 512, 4.1",
    "views.sensor.noise": "noise, 5.1",
    "methods": "rows of Table 1",
    "evaluate.points": "points of P and Q, (14)",
} | {
    f"method.{name}.{key}": symbol
    for name in NERF_METHODS
    for key, symbol in NERF_SYMBOLS.items()
    if (name, key) != ("industnerf_plus", "levels[1].points")  # it has one level
}

"""industnerf_plus."""

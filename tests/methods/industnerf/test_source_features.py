"""What is told of the points: against every view encoded anew, and gradients."""

import pytest
import torch

from industnerf.methods.industnerf.pooling import pool, pooling_weights
from industnerf.methods.industnerf.position_encoding import encode_positions, encoding_coordinates
from industnerf.methods.industnerf.projection import is_in_view, project, sample_features
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.methods.industnerf.source_features import SourceFeatures
from tests.methods.industnerf.synthetic_scenes import ball, make_test_scene, settings

VIEWS = 5


def some_points(count: int = 40) -> torch.Tensor:
    """Some of them out of some views."""
    return torch.randn(count, 3, generator=torch.Generator().manual_seed(0)) * 0.7


def five_views() -> NerfScene:
    return make_test_scene(ball(18.0), VIEWS, 24)


def make_source_features(network: dict | None = None, **readings: str) -> SourceFeatures:
    torch.manual_seed(0)
    source_features = SourceFeatures(
        five_views(), settings("industnerf", readings=readings, network=network)
    )
    source_features.set_points(some_points())
    return source_features


def pool_from_scratch(
    source_features: SourceFeatures,
    points: torch.Tensor,
    views: str = "confidence_weighted",
    view_weights: torch.Tensor | None = None,
) -> torch.Tensor:
    """The pooled columns from nothing: every view encoded now, and `pool`."""
    scene_views = five_views()
    features, valid = [], []
    for image, background, K, c2w in zip(
        scene_views.images,
        scene_views.background,
        scene_views.cameras.K,
        scene_views.cameras.c2w,
        strict=True,
    ):
        uv, depth = project(points, K, c2w)
        inside = is_in_view(uv, depth, 24, 24)
        pixels = image.permute(2, 0, 1)[None].float() / 255
        texels = source_features.encoder(pixels, background[:, None, None])[0]
        features.append(sample_features(texels, uv.where(inside[:, None], 0.0), 24, 24))
        valid.append(inside)
    is_valid = torch.stack(valid)
    return pool(
        torch.stack(features), is_valid, pooling_weights(is_valid, view_weights, views), views
    )


def pooled(source_features: SourceFeatures) -> torch.Tensor:
    """What follows the 24 columns of PosE."""
    return source_features()[:, 24:]


def test_images_are_as_coarse_as_the_points_that_are_told_of():
    # spacing 2/3: 3 points across the frame, so 3 texels, so 12 px of the 24
    full, scene_views = make_source_features(), five_views()
    full.set_points(some_points(), 2 / 3)
    quarters = scene_views.images.float().reshape(VIEWS, 12, 2, 12, 2, 3).mean(dim=(2, 4)) / 255
    is_valid = torch.ones(VIEWS, 40, dtype=torch.bool)
    features = []
    for view, (small, background) in enumerate(zip(quarters, scene_views.background, strict=True)):
        uv, depth = project(
            some_points(), scene_views.cameras.K[view], scene_views.cameras.c2w[view]
        )
        is_valid[view] = is_in_view(uv, depth, 24, 24)
        texels = full.encoder(small.permute(2, 0, 1)[None], background[:, None, None])[0]
        assert texels.shape[1:] == (3, 3)
        uv = uv.where(is_valid[view][:, None], 0.0)
        features.append(sample_features(texels, uv, 24, 24))
    weights = pooling_weights(is_valid, None, "confidence_weighted")
    expected = pool(torch.stack(features), is_valid, weights, "confidence_weighted")
    torch.testing.assert_close(pooled(full), expected, **CLOSE)


def test_images_are_never_enlarged():
    coarse, fine = make_source_features(), make_source_features()
    coarse.set_points(some_points(), 1e-3)
    torch.testing.assert_close(pooled(coarse), pooled(fine), rtol=0, atol=0)


def change_encoder(source_features: SourceFeatures, seed: int = 1) -> None:
    generator = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        for weights in source_features.encoder.parameters():
            weights += 0.1 * torch.randn(weights.shape, generator=generator)


# features of order 1 in float32; the variance is a difference of their squares
CLOSE = {"rtol": 0, "atol": 1e-5}


@pytest.mark.parametrize("views", ["confidence_weighted", "all", "mean_variance", "mean", "max"])
@pytest.mark.parametrize("encoder", ["per_part", "frozen"])
def test_placed_points_are_told_of_by_all_views(views, encoder):
    source_features = make_source_features(view_pooling=views, encoder=encoder)
    inputs = source_features()
    assert inputs.shape == (40, source_features.out_channels)
    torch.testing.assert_close(
        inputs[:, 24:], pool_from_scratch(source_features, some_points(), views), **CLOSE
    )
    config, readings = source_features._network_settings, source_features._readings
    coordinates = encoding_coordinates(
        some_points(), five_views().cameras.c2w[0], readings.encoding_frame
    )
    pose = encode_positions(
        coordinates,
        config.encoding_channels,
        config.encoding_alpha,
        config.encoding_beta,
        readings.position_encoding,
    )
    assert torch.equal(inputs[:, :24], pose)


def test_refreshed_views_replace_themselves():
    source_features = make_source_features()
    stale = pooled(source_features)
    change_encoder(source_features)
    source_features.refresh_views(torch.tensor([3, 1]))
    assert (pooled(source_features) - stale).abs().max() > 0.01
    assert (
        pooled(source_features) - pool_from_scratch(source_features, some_points())
    ).abs().max() > 0.01  # 0, 2, 4 are stale
    source_features.refresh_views(torch.tensor([0, 4, 2]))
    torch.testing.assert_close(
        pooled(source_features), pool_from_scratch(source_features, some_points()), **CLOSE
    )


def test_refreshing_again_and_again_does_not_drift():
    source_features = make_source_features()
    for turn in range(60):
        change_encoder(source_features, turn)
        source_features.refresh_views(torch.tensor([turn % VIEWS, (turn + 2) % VIEWS]))
    source_features.refresh_views(torch.arange(VIEWS))
    now = pool_from_scratch(source_features, some_points()).detach()
    # 60 random steps took the weights, and with them the features, to another order
    close = {"rtol": 1e-5, "atol": 1e-6 * now.abs().max().item()}
    torch.testing.assert_close(pooled(source_features).detach(), now, **close)


def test_gradients_reach_the_encoder_through_refreshed_views_once():
    source_features = make_source_features()
    assert not source_features().requires_grad  # of views that were placed, E is no longer asked
    source_features.refresh_views(torch.tensor([2]))
    source_features().square().sum().backward()
    grads = [weights.grad for weights in source_features.encoder.parameters()]
    assert all((grad != 0).any() for grad in grads)
    assert not source_features().requires_grad


def test_views_count_as_much_as_they_were_sure():
    view_weights = torch.rand(VIEWS, 40, generator=torch.Generator().manual_seed(4))
    source_features = make_source_features()
    unweighted = pooled(source_features)
    source_features.set_view_weights(view_weights)
    expected = pool_from_scratch(source_features, some_points(), view_weights=view_weights)
    assert (expected - unweighted).abs().max() > 0.01
    torch.testing.assert_close(pooled(source_features), expected, **CLOSE)
    source_features.select_points(torch.tensor([3, 9]))
    torch.testing.assert_close(pooled(source_features), expected[[3, 9]], **CLOSE)


@pytest.mark.parametrize("views", ["confidence_weighted", "max"])
def test_keeping_is_placing_those_that_are_kept(views):
    indices = torch.tensor([31, 2, 17, 5])  # in an order of their own
    kept, placed = (
        make_source_features(view_pooling=views),
        make_source_features(view_pooling=views),
    )
    kept.select_points(indices)
    placed.set_points(some_points()[indices])
    # products with K are rounded otherwise where the matrix has more rows
    torch.testing.assert_close(kept(), placed(), **CLOSE)
    for source_features in (kept, placed):
        change_encoder(source_features)
        source_features.refresh_views(torch.tensor([0, 3]))
    torch.testing.assert_close(kept(), placed(), **CLOSE)


def test_blind_sources_tell_only_where_points_are():
    source_features = make_source_features(encoder="none")
    assert source_features().shape == (40, 24) == (40, source_features.out_channels)
    assert not any(weights.requires_grad for weights in source_features.parameters())
    source_features.select_points(torch.tensor([7, 3]))
    again = make_source_features(encoder="none")
    assert torch.equal(source_features(), again()[[7, 3]])


@pytest.mark.parametrize(
    ("readings", "is_trainable"),
    [({}, True), ({"encoder": "frozen"}, False), ({"encoder": "none"}, False)],
)
def test_only_an_encoder_of_this_part_learns(readings, is_trainable):
    source_features = make_source_features(**readings)
    assert source_features.is_trainable == is_trainable
    assert all(
        weights.requires_grad == is_trainable for weights in source_features.encoder.parameters()
    )


def test_the_images_own_colors_come_along_if_asked_for():
    with_rgb, without = make_source_features(), make_source_features({"rgb_skip": False})
    assert (
        with_rgb.out_channels == without.out_channels + 4 * 4
    )  # statistics of colors and contrast


def test_e_learns_from_noisier_images_only_where_asked():
    source_features, generator = make_source_features(), torch.Generator().manual_seed(0)
    before = pooled(source_features)
    source_features.refresh_views(torch.arange(VIEWS), generator)
    torch.testing.assert_close(pooled(source_features).detach(), before, **CLOSE)
    source_features._image_noise = 0.2
    source_features.refresh_views(torch.arange(VIEWS), generator)
    assert (pooled(source_features).detach() - before).abs().max() > 0.05
    source_features.recompute_features()
    torch.testing.assert_close(pooled(source_features), before, **CLOSE)

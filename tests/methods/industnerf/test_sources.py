"""What is told of the points: against every view encoded anew, and gradients."""

import pytest
import torch

from industnerf.methods.industnerf.encoding import encode, encoding_frame
from industnerf.methods.industnerf.pooling import pool, weights_of
from industnerf.methods.industnerf.projection import in_view, project, sample_features
from industnerf.methods.industnerf.scene import Scene
from industnerf.methods.industnerf.sources import Sources
from tests.methods.industnerf.scenes import ball, scene, settings

VIEWS = 5


def some_points(count: int = 40) -> torch.Tensor:
    """Some of them out of some views."""
    return torch.randn(count, 3, generator=torch.Generator().manual_seed(0)) * 0.7


def a_scene() -> Scene:
    return scene(ball(18.0), VIEWS, 24)


def sources_of(network: dict | None = None, **readings: str) -> Sources:
    torch.manual_seed(0)
    made = Sources(a_scene(), settings("industnerf", readings=readings, network=network))
    made.place(some_points())
    return made


def anew(
    sources: Sources,
    points: torch.Tensor,
    views: str = "confident",
    trust: torch.Tensor | None = None,
) -> torch.Tensor:
    """The pooled columns from nothing: every view encoded now, and `pool`."""
    seen = a_scene()
    features, valid = [], []
    for image, behind, K, c2w in zip(
        seen.images, seen.background, seen.eyes.K, seen.eyes.c2w, strict=True
    ):
        uv, depth = project(points, K, c2w)
        inside = in_view(uv, depth, 24, 24)
        whole = image.permute(2, 0, 1)[None].float() / 255
        texels = sources.encoder(whole, behind[:, None, None])[0]
        features.append(sample_features(texels, uv.where(inside[:, None], 0.0), 24, 24))
        valid.append(inside)
    seen_by = torch.stack(valid)
    return pool(torch.stack(features), seen_by, weights_of(seen_by, trust, views), views)


def pooled(sources: Sources) -> torch.Tensor:
    """What follows the 24 columns of PosE."""
    return sources()[:, 24:]


def test_images_are_as_coarse_as_the_points_that_are_told_of():
    # spacing 2/3: 3 points across the frame, so 3 texels, so 12 px of the 24
    full, seen = sources_of(), a_scene()
    full.place(some_points(), 2 / 3)
    quarters = seen.images.float().reshape(VIEWS, 12, 2, 12, 2, 3).mean(dim=(2, 4)) / 255
    seen_by = torch.ones(VIEWS, 40, dtype=torch.bool)
    features = []
    for view, (small, behind) in enumerate(zip(quarters, seen.background, strict=True)):
        uv, depth = project(some_points(), seen.eyes.K[view], seen.eyes.c2w[view])
        seen_by[view] = in_view(uv, depth, 24, 24)
        texels = full.encoder(small.permute(2, 0, 1)[None], behind[:, None, None])[0]
        assert texels.shape[1:] == (3, 3)
        uv = uv.where(seen_by[view][:, None], 0.0)
        features.append(sample_features(texels, uv, 24, 24))
    weights = weights_of(seen_by, None, "confident")
    expected = pool(torch.stack(features), seen_by, weights, "confident")
    torch.testing.assert_close(pooled(full), expected, **CLOSE)


def test_images_are_never_enlarged():
    coarse, fine = sources_of(), sources_of()
    coarse.place(some_points(), 1e-3)
    torch.testing.assert_close(pooled(coarse), pooled(fine), rtol=0, atol=0)


def change_encoder(sources: Sources, seed: int = 1) -> None:
    generator = torch.Generator().manual_seed(seed)
    with torch.no_grad():
        for weights in sources.encoder.parameters():
            weights += 0.1 * torch.randn(weights.shape, generator=generator)


# features of order 1 in float32; the variance is a difference of their squares
CLOSE = {"rtol": 0, "atol": 1e-5}


@pytest.mark.parametrize("views", ["confident", "all", "mean_variance", "mean", "max"])
@pytest.mark.parametrize("encoder", ["per_part", "frozen"])
def test_placed_points_are_told_of_by_all_views(views, encoder):
    sources = sources_of(views=views, encoder=encoder)
    told = sources()
    assert told.shape == (40, sources.columns)
    torch.testing.assert_close(told[:, 24:], anew(sources, some_points(), views), **CLOSE)
    ways, readings = sources._ways, sources._readings
    frame = encoding_frame(some_points(), a_scene().eyes.c2w[0], readings.frame)
    pose = encode(frame, ways.channels, ways.magnitude, ways.base, readings.pose)
    assert torch.equal(told[:, :24], pose)


def test_refreshed_views_replace_themselves():
    sources = sources_of()
    stale = pooled(sources)
    change_encoder(sources)
    sources.refresh(torch.tensor([3, 1]))
    assert (pooled(sources) - stale).abs().max() > 0.01
    assert (pooled(sources) - anew(sources, some_points())).abs().max() > 0.01  # 0, 2, 4 are stale
    sources.refresh(torch.tensor([0, 4, 2]))
    torch.testing.assert_close(pooled(sources), anew(sources, some_points()), **CLOSE)


def test_refreshing_again_and_again_does_not_drift():
    sources = sources_of()
    for turn in range(60):
        change_encoder(sources, turn)
        sources.refresh(torch.tensor([turn % VIEWS, (turn + 2) % VIEWS]))
    sources.refresh(torch.arange(VIEWS))
    now = anew(sources, some_points()).detach()
    # 60 random steps took the weights, and with them the features, to another order
    close = {"rtol": 1e-5, "atol": 1e-6 * now.abs().max().item()}
    torch.testing.assert_close(pooled(sources).detach(), now, **close)


def test_gradients_reach_the_encoder_through_refreshed_views_once():
    sources = sources_of()
    assert not sources().requires_grad  # of views that were placed, E is no longer asked
    sources.refresh(torch.tensor([2]))
    sources().square().sum().backward()
    grads = [weights.grad for weights in sources.encoder.parameters()]
    assert all((grad != 0).any() for grad in grads)
    assert not sources().requires_grad


def test_views_count_as_much_as_they_were_sure():
    trust = torch.rand(VIEWS, 40, generator=torch.Generator().manual_seed(4))
    sources = sources_of()
    alike = pooled(sources)
    sources.heed(trust)
    expected = anew(sources, some_points(), trust=trust)
    assert (expected - alike).abs().max() > 0.01
    torch.testing.assert_close(pooled(sources), expected, **CLOSE)
    sources.keep(torch.tensor([3, 9]))
    torch.testing.assert_close(pooled(sources), expected[[3, 9]], **CLOSE)


@pytest.mark.parametrize("views", ["confident", "max"])
def test_keeping_is_placing_those_that_are_kept(views):
    which = torch.tensor([31, 2, 17, 5])  # in an order of their own
    kept, placed = sources_of(views=views), sources_of(views=views)
    kept.keep(which)
    placed.place(some_points()[which])
    # products with K are rounded otherwise where the matrix has more rows
    torch.testing.assert_close(kept(), placed(), **CLOSE)
    for sources in (kept, placed):
        change_encoder(sources)
        sources.refresh(torch.tensor([0, 3]))
    torch.testing.assert_close(kept(), placed(), **CLOSE)


def test_blind_sources_tell_only_where_points_are():
    sources = sources_of(encoder="none")
    assert sources().shape == (40, 24) == (40, sources.columns)
    assert not any(weights.requires_grad for weights in sources.parameters())
    sources.keep(torch.tensor([7, 3]))
    again = sources_of(encoder="none")
    assert torch.equal(sources(), again()[[7, 3]])


@pytest.mark.parametrize(
    ("readings", "learns"),
    [({}, True), ({"encoder": "frozen"}, False), ({"encoder": "none"}, False)],
)
def test_only_an_encoder_of_this_part_learns(readings, learns):
    sources = sources_of(**readings)
    assert sources.learns == learns
    assert all(weights.requires_grad == learns for weights in sources.encoder.parameters())


def test_the_images_own_colours_come_along_if_asked_for():
    with_rgb, without = sources_of(), sources_of({"rgb_skip": False})
    assert with_rgb.columns == without.columns + 4 * 4  # statistics of colours and contrast


def test_e_learns_from_noisier_images_only_where_asked():
    sources, generator = sources_of(), torch.Generator().manual_seed(0)
    before = pooled(sources)
    sources.refresh(torch.arange(VIEWS), generator)
    torch.testing.assert_close(pooled(sources).detach(), before, **CLOSE)
    sources._noise = 0.2
    sources.refresh(torch.arange(VIEWS), generator)
    assert (pooled(sources).detach() - before).abs().max() > 0.05
    sources.encode_anew()
    torch.testing.assert_close(pooled(sources), before, **CLOSE)

"""The nets against the published ones, layer by layer."""

import pytest
import torch
from torch import nn

from industnerf.geometry.sphere import fibonacci_sphere
from industnerf.methods.atlasnet.network import START_RADIUS, Decoder, build_network
from tests.methods.test_conformance import merged


@pytest.fixture(scope="module")
def full():
    """The settings with the published sizes."""
    return merged("params.yaml", "conf/experiment/gpu.yaml").method.atlasnet


def count(net):
    return sum(weights.numel() for weights in net.parameters())


def test_full_is_as_published(full):
    """github.com/ThibaultGROUEIX/AtlasNet, auxiliary/argument_parser.py."""
    assert full.size == "full"
    assert (full.image_px, full.encoder_width, full.latent_dim, full.hidden_dim) == (
        224,
        64,
        1024,
        512,
    )
    assert (full.patches, full.patches * full.patch_points) == (25, 2500)
    assert (full.pretraining.batch_size, full.pretraining.lr) == (32, 1e-3)


def test_the_decoder_has_the_published_layers(full):
    """Each patch: 2-1024-512-512-512-3; the published batch norms are left out."""
    layers = 2 * 1024 + 1024, 1024 * 512 + 512, 512 * 512 + 512, 512 * 512 + 512, 512 * 3 + 3
    norms = 2 * (1024 + 512 + 512 + 512)
    assert sum(layers) + norms == 1_059_843
    with torch.device("meta"):
        assert count(build_network(full).decoder) == 25 * (1_059_843 - norms)


def test_the_image_encoder_has_the_published_layers(full):
    """ResNet-18, whose last layer gives the latent instead of 1000 classes."""
    stem = 3 * 64 * 49 + 2 * 64
    stages = 4 * (64 * 64 * 9 + 2 * 64)
    for before, after in ((64, 128), (128, 256), (256, 512)):
        stages += before * after * 9 + 3 * after * after * 9 + before * after + 5 * 2 * after
    assert stem + stages + 513_000 == 11_689_512  # as torchvision counts ResNet-18
    with torch.device("meta"):
        encoder = build_network(full).encoder
        assert count(encoder) == stem + stages + 512 * 1024 + 1024
        x = torch.zeros(2, 3, full.image_px, full.image_px)
        assert nn.Sequential(*list(encoder)[:-3])(x).shape == (2, 512, 7, 7)  # what is pooled
        assert encoder(x).shape == (2, 1024)


def test_full_gives_2500_points(full):
    with torch.device("meta"):
        uv = torch.zeros(25, 2, 2, 100)
        assert build_network(full).decoder(torch.zeros(2, 1024), uv).shape == (2, 2500, 3)


def layer(linear, patch):
    """The same layer as the authors have it, of one patch alone."""
    _, after, before = linear.weight.shape
    conv = nn.Conv1d(before, after, 1)
    conv.weight.data = linear.weight[patch][:, :, None]
    conv.bias.data = linear.bias.view(-1, after)[patch]
    return conv


def one_patch(decoder, patch, latent, uv):
    """The authors' Mapping2Dto3D, without batch norm, with the weights of one patch."""
    x = layer(decoder.first, patch)(2 * uv[patch].permute(1, 0, 2) - 1) + latent[:, :, None]
    for hidden in decoder.hidden:
        x = layer(hidden, patch)(x.relu())
    return layer(decoder.last, patch)(x.relu()).transpose(1, 2)


def test_patches_are_nets_of_their_own():
    """All at once as one after the other."""
    torch.manual_seed(0)
    decoder = Decoder(3, 8, 6)
    for weights in decoder.parameters():
        nn.init.uniform_(weights, -1, 1)  # or all biases would be alike
    latent, uv = torch.randn(4, 8), torch.rand(3, 2, 4, 5)
    points = decoder(latent, uv).view(4, 3, 5, 3)
    for patch in range(3):
        expected = one_patch(decoder, patch, latent, uv)
        # sums of 8 float32 terms of order 1 through five layers
        torch.testing.assert_close(points[:, patch], expected, rtol=1e-4, atol=1e-5)


def test_patches_start_apart():
    """Most are nearer to their own place on a sphere than to any other's; by chance 1 of 25 is."""
    torch.manual_seed(0)
    points = Decoder(25, 64, 64)(torch.zeros(1, 64), torch.rand(25, 2, 1, 50)).view(25, 50, 3)
    places = torch.tensor(START_RADIUS * fibonacci_sphere(25), dtype=torch.float32)
    nearest = torch.cdist(points.mean(dim=1), places).argmin(dim=1)
    assert (nearest == torch.arange(25)).float().mean() > 0.5


def test_layers_start_for_rectifiers():
    torch.manual_seed(0)
    weights = Decoder(25, 64, 16).hidden[0].weight
    # of 25 600 uniform draws the deviation is known to 0.5 %: 4 of its standard errors are 2 %
    assert weights.std().item() == pytest.approx((2 / 64) ** 0.5, rel=0.02)


def test_it_is_told_the_axes_of_the_picture():
    """The latent is that of the image and that of the axes."""
    torch.manual_seed(0)
    small = merged("params.yaml", "conf/experiment/smoke.yaml").method.atlasnet
    net, contrasts = build_network(small).eval(), torch.rand(2, 3, small.image_px, small.image_px)
    frames, uv = torch.randn(2, 3, 3), torch.rand(small.patches, 2, 2, 5)
    with torch.no_grad():
        latent = net.encoder(2 * contrasts) + net.frame_encoder(frames)
        torch.testing.assert_close(net(contrasts, frames, uv), net.decoder(latent, uv))
        other = net(contrasts, frames.flip(0), uv)
    assert (other - net(contrasts, frames, uv)).abs().amax(dim=(1, 2)).min() > 1e-4

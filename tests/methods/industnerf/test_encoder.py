"""The feature map lies on the image: neither shifted nor turned, at any size."""

import pytest
import torch

from industnerf.methods.industnerf.encoder import STRIDE, Encoder

# A texel of the last layer sees 20 px, so up to 8 px beyond its own 4: two texels on each side
# of the map depend on what is repeated beyond the border.
INSIDE = slice(3, -3)
WHITE = torch.ones(3, 1, 1, dtype=torch.float64)


def encoder(rgb_skip: bool = False) -> Encoder:
    torch.manual_seed(0)
    return Encoder(5, 7, rgb_skip).double()


def images(height: int = 48, width: int = 64) -> torch.Tensor:
    generator = torch.Generator().manual_seed(1)
    return torch.rand(2, 3, height, width, dtype=torch.float64, generator=generator)


def test_an_image_shifted_by_a_stride_shifts_its_features_by_one():
    taken = images()
    shifted = torch.roll(taken, (STRIDE, 2 * STRIDE), dims=(2, 3))
    net = encoder(rgb_skip=True)
    expected = torch.roll(net(taken, WHITE), (1, 2), dims=(2, 3))
    inside = (..., slice(4, -3), slice(5, -3))  # and away from the seam of the roll
    torch.testing.assert_close(net(shifted, WHITE)[inside], expected[inside], rtol=0, atol=1e-12)


def test_views_are_encoded_at_once_as_one_by_one():
    """As a GPU does; each with its own background."""
    backgrounds, net = torch.rand(2, 3, 1, 1, dtype=torch.float64), encoder(rgb_skip=True)
    each = [net(image[None], color) for image, color in zip(images(), backgrounds, strict=True)]
    torch.testing.assert_close(net(images(), backgrounds), torch.cat(each), rtol=0, atol=1e-12)


@pytest.mark.parametrize("axis", [2, 3])
def test_symmetric_kernels_mirror_features_with_the_image(axis):
    """Only if each texel's kernels are centered on the pixels that it stands for."""
    net = encoder(rgb_skip=True)
    with torch.no_grad():
        for layer in (net.conv1, net.conv2, net.conv3):
            layer.weight += layer.weight.flip(axis)
    taken = images()
    torch.testing.assert_close(
        net(taken.flip(axis), WHITE), net(taken, WHITE).flip(axis), rtol=0, atol=1e-12
    )


def test_a_texel_sees_no_further_than_stated():
    taken = images().requires_grad_()
    encoder()(taken, WHITE)[0, :, 5, 7].sum().backward()
    seen = taken.grad[0].abs().sum(dim=0).nonzero()
    assert seen.amin(dim=0).tolist() == [5 * STRIDE - 8, 7 * STRIDE - 8]
    assert seen.amax(dim=0).tolist() == [6 * STRIDE + 7, 8 * STRIDE + 7]


def test_the_skip_is_the_mean_color_and_contrast_of_each_texel():
    taken = images()
    actual = encoder(rgb_skip=True)(taken, WHITE)
    assert actual.shape[1] == encoder(rgb_skip=True).out_channels == encoder().out_channels + 4
    mean = taken[0, :, 8:12, 20:24].mean(dim=(1, 2))
    torch.testing.assert_close(actual[0, 5:8, 2, 5], mean, rtol=0, atol=1e-14)
    darkest = taken[0, :, 8:12, 20:24].amin(dim=0)  # the channel that is farthest from white
    torch.testing.assert_close(actual[0, 8, 2, 5], (1 - darkest).mean(), rtol=0, atol=1e-14)
    torch.testing.assert_close(actual[:, :5], encoder()(taken, WHITE), rtol=0, atol=0)


@pytest.mark.parametrize(("height", "width"), [(48, 64), (45, 63), (46, 61), (5, 4)])
def test_texels_cover_the_image_whatever_its_size(height, width):
    """A linear image keeps its slope and its place, but for a border's half pixel."""
    u = (torch.arange(width, dtype=torch.float64) + 0.5) / width
    ramp = u.expand(1, 3, height, width)
    color = encoder(rgb_skip=True)(ramp, WHITE)[0, 5]
    texels = color.shape[1]
    assert color.shape == (-(-height // STRIDE), -(-width // STRIDE))
    expected = (torch.arange(texels, dtype=torch.float64) + 0.5) / texels
    # Where the image is stretched, its border is repeated over less than half a pixel's width.
    atol = 1e-12 if width % STRIDE == 0 else 0.5 / width / STRIDE
    torch.testing.assert_close(color[0], expected, rtol=0, atol=atol)
    torch.testing.assert_close(color[0, 1:-1], expected[1:-1], rtol=0, atol=1e-12)


def test_before_its_background_an_image_is_told_by_how_it_differs():
    """Another background and an image as much brighter: the same features but for the colors."""
    net, taken = encoder(rgb_skip=True), images() / 2
    on_first, on_second = net(taken, WHITE / 2), net(taken + 0.25, WHITE / 2 + 0.25)
    torch.testing.assert_close(on_first[:, :5], on_second[:, :5], rtol=0, atol=1e-12)
    torch.testing.assert_close(on_first[:, 8], on_second[:, 8], rtol=0, atol=1e-12)
    assert not net(WHITE.expand(1, 3, 48, 64), WHITE)[:, 8].any()


def test_gradients_reach_every_weight():
    net = encoder()
    net(images(), WHITE).square().sum().backward()
    assert all((weight.grad != 0).any() for weight in net.parameters())


def test_gradients_of_weights_and_images():
    """The contrast's largest channel and rectifiers have kinks; random inputs are off them."""
    net, taken = encoder(rgb_skip=True), images(8, 12).requires_grad_()
    assert torch.autograd.gradcheck(lambda seen: net(seen, WHITE), taken)
    learned = dict(net.named_parameters())

    def features(*values):
        named = dict(zip(learned, values, strict=True))
        return torch.func.functional_call(net, named, (taken.detach(), WHITE))

    # some hundred weights: along random directions
    assert torch.autograd.gradcheck(features, tuple(learned.values()), fast_mode=True)

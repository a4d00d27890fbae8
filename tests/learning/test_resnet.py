"""ResNet-18 against table 1 of its paper, and against what its building block is said to do."""

import pytest
import torch
from torch import nn
from torch.nn import functional as F

from industnerf.learning.resnet import ResidualBlock, ResNet18


def num_parameters(net: nn.Module) -> int:
    return sum(p.numel() for p in net.parameters())


def test_it_has_as_many_numbers_as_published():
    assert num_parameters(ResNet18(1000)) == 11_689_512
    assert num_parameters(ResNet18(1000)) - (512 * 1000 + 1000) == 11_176_512


def test_its_stages_have_the_published_shapes():
    x, shapes = torch.rand(1, 3, 224, 224), []
    net = ResNet18(256).eval()
    with torch.no_grad():
        for layer in net:
            x = layer(x)
            shapes.append(tuple(x.shape[1:]))
    assert [s for i, s in enumerate(shapes) if i == 0 or s != shapes[i - 1]] == [
        (64, 112, 112),
        (64, 56, 56),
        (128, 28, 28),
        (256, 14, 14),
        (512, 7, 7),
        (512, 1, 1),
        (512,),
        (256,),
    ]
    assert sum(isinstance(layer, ResidualBlock) for layer in net) == 8


@pytest.mark.parametrize("width", [1, 8])
def test_width_scales_every_stage(width):
    last = [layer for layer in ResNet18(5, width) if isinstance(layer, ResidualBlock)][-1]
    assert last.conv2.weight.shape == (8 * width, 8 * width, 3, 3)


def test_a_block_whose_convolutions_are_silent_lets_its_input_through():
    x = torch.randn(2, 4, 6, 6)
    same, wider = ResidualBlock(4, 4, 1), ResidualBlock(4, 8, 2)
    for block in (same, wider):
        nn.init.zeros_(block.bn2.weight)
    torch.testing.assert_close(same(x), F.relu(x))
    # a new batch norm has weight 1 and bias 0: every second pixel, mixed by a 1x1 convolution
    mixed = torch.einsum("dc,bchw->bdhw", wider.shortcut[0].weight[..., 0, 0], x[..., ::2, ::2])
    centered = mixed - mixed.mean(dim=(0, 2, 3), keepdim=True)
    normed = centered / (mixed.var(dim=(0, 2, 3), correction=0, keepdim=True) + 1e-5).sqrt()
    # float32: 1e-7 of values of about 1, summed over 4 channels, with a reserve of 10
    torch.testing.assert_close(wider(x), F.relu(normed), rtol=0, atol=1e-5)


def test_what_it_says_of_an_image_does_not_depend_on_the_others_of_a_batch():
    torch.manual_seed(0)
    net, images = ResNet18(16, 8), torch.rand(6, 3, 64, 64)
    for _ in range(3):
        net(images)  # batch norm has seen something
    net.eval()
    with torch.no_grad():
        together, alone = net(images), torch.cat([net(one[None]) for one in images])
    # float32, sums in another order
    torch.testing.assert_close(together, alone, rtol=1e-4, atol=1e-5)
    with torch.no_grad():
        assert (net.train()(images)[:3] - net(images[:3])).abs().max() > 1e-3

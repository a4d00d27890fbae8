"""The net against the published one: sizes, shapes at every stage, and each layer's closed form."""

import math

import pytest
import torch
from torch import nn
from torch.nn import functional as F

from industnerf.methods.r2n2.decoder import OutputBlock, UpsampleBlock, conv3, conv_unpooled, unpool
from industnerf.methods.r2n2.encoder import ConvBlock, pooled_size
from industnerf.methods.r2n2.gru import GridGRU
from industnerf.methods.r2n2.network import R2N2, new_net
from tests.methods.test_conformance import merged


@pytest.fixture(scope="module")
def full():
    """The settings with the published sizes."""
    return merged("params.yaml", "conf/experiment/gpu.yaml").method.r2n2


@pytest.fixture(scope="module")
def published(full):
    """The net at its full width, without numbers: shapes alone."""
    with torch.device("meta"):
        return R2N2(full.image_px, full.channel_divisor)


def test_full_is_as_published(full):
    """github.com/chrischoy/3D-R2N2, lib/config.py: the residual GRU net for several views."""
    assert full.size == "full"
    assert (full.image_px, full.channel_divisor, full.max_views) == (127, 1, 5)
    learned = full.pretraining
    assert (learned.max_steps, learned.batch_size, learned.lr) == (60_000, 36, 1e-4)


def conv(kernel, dims, before, after):
    return kernel**dims * before * after + after


def test_as_many_parameters_as_published(published):
    encoder = (
        conv(7, 2, 3, 96) + conv(3, 2, 96, 96),  # 97 248
        conv(3, 2, 96, 128) + conv(3, 2, 128, 128) + conv(1, 2, 96, 128),  # 270 720
        conv(3, 2, 128, 256) + conv(3, 2, 256, 256) + conv(1, 2, 128, 256),  # 918 272
        conv(3, 2, 256, 256) + conv(3, 2, 256, 256),  # 1 180 160
        conv(3, 2, 256, 256) + conv(3, 2, 256, 256) + conv(1, 2, 256, 256),  # 1 245 952
        conv(3, 2, 256, 256) + conv(3, 2, 256, 256),  # 1 180 160
        256 * 3 * 3 * 1024 + 1024,  # 2 360 320
    )
    gate = 3**3 * 128 * 128 + 1024 * 128 * 4**3 + 128  # 8 831 104
    decoder = (
        conv(3, 3, 128, 128) + conv(3, 3, 128, 128),  # 884 992
        conv(3, 3, 128, 128) + conv(3, 3, 128, 128),  # 884 992
        conv(3, 3, 128, 64) + conv(3, 3, 64, 64) + conv(1, 3, 128, 64),  # 340 160
        conv(3, 3, 64, 32) + conv(3, 3, 32, 32) + conv(3, 3, 32, 32),  # 110 688
        conv(3, 3, 32, 2),  # 1 730
    )
    assert sum(encoder) == 7_252_832
    assert sum(decoder) == 2_222_562
    total = sum(p.numel() for p in published.parameters())
    assert total == sum(encoder) + 3 * gate + sum(decoder) == 35_968_706


def test_shapes_at_every_stage_are_the_published_ones(published):
    shapes = []
    for layer in (*published.encoder, published.gru, *published.decoder):
        layer.register_forward_hook(lambda _, __, out: shapes.append(tuple(out.shape)))
    published(torch.empty(2, 5, 3, 127, 127, device="meta"))
    images = [(96, 64), (128, 33), (256, 17), (256, 9), (256, 5), (256, 3)]
    assert shapes[:6] == [(10, c, n, n) for c, n in images]
    assert shapes[6:9] == [(10, 256 * 3 * 3), (10, 1024), (10, 1024)]
    cells = [(128, 4), (128, 8), (128, 16), (64, 32), (32, 32), (2, 32)]
    assert shapes[9:] == [(2, c, n, n, n) for c, n in cells]


@pytest.mark.parametrize("px", [16, 32, 63, 64, 127])
def test_the_linear_layer_follows_from_the_pictures(px):
    net = new_net(px, 32, 0)
    n = pooled_size(px)
    assert net.encoder[7].weight.shape == (32, 8 * n * n)
    assert net.occupancy_probability(torch.zeros(1, 1, 3, px, px)).shape == (1, 32, 32, 32)


def test_pools_leave_the_published_sizes():
    assert [pooled_size(127, times) for times in range(7)] == [127, 64, 33, 17, 9, 5, 3]


def zeroed(layer, bias):
    """A layer that says `bias`, whatever it hears."""
    nn.init.zeros_(layer.weight)
    nn.init.constant_(layer.bias, bias)


def identity_layer(layer, factor):
    """A convolution that multiplies each place by `factor`."""
    nn.init.zeros_(layer.weight)
    nn.init.zeros_(layer.bias)
    middle = tuple(size // 2 for size in layer.weight.shape[2:])
    for channel in range(len(layer.weight)):
        layer.weight.data[(channel, channel, *middle)] = factor


@torch.no_grad()
def test_a_stage_adds_its_shortcut_behind_the_rectifier():
    stage = ConvBlock(2, 2, 3, nn.Identity())
    identity_layer(stage.conv_a, 1.0)
    identity_layer(stage.conv_b, -1.0)
    x = torch.full((1, 2, 7, 7), 0.5)
    # leaky(-0.5) + 0.5; in front of the rectifier it would be 0.  So at the border too: a pool
    # pads with nothing, not with zeros.
    expected = torch.full((1, 2, 4, 4), -0.005 + 0.5)
    torch.testing.assert_close(stage(x), expected)
    torch.testing.assert_close(stage(-x), torch.full((1, 2, 4, 4), 0.5 * 0.01 - 0.5))


@torch.no_grad()
def test_unpooling_fills_even_corners():
    x = torch.randn(2, 3, 4, 4, 4)
    wide = unpool(x)
    assert wide.shape == (2, 3, 8, 8, 8)
    assert (wide[:, :, ::2, ::2, ::2] == x).all()
    assert wide.count_nonzero() == x.count_nonzero()


@torch.no_grad()
def test_the_convolution_of_what_is_unpooled_skips_zeros_alone():
    layer, x = conv3(5, 7).double(), torch.randn(2, 5, 4, 4, 4).double()
    torch.testing.assert_close(conv_unpooled(layer, x), layer(unpool(x)))


@torch.no_grad()
def test_a_step_up_is_its_convolutions_and_the_unpooled_input():
    up, x = UpsampleBlock(3, 3, nn.Identity()), torch.randn(2, 3, 4, 4, 4)
    y = F.leaky_relu(up.conv_b(F.leaky_relu(up.conv_a(unpool(x)), 0.01)), 0.01) + unpool(x)
    torch.testing.assert_close(up(x), y, rtol=0, atol=1e-5)  # float32 sums of 81 terms of order 1


@torch.no_grad()
def test_the_last_shortcut_leads_round_the_second_convolution_alone():
    last = OutputBlock(2, 2)
    zeroed(last.conv_a, 2.0)
    zeroed(last.conv_b, 3.0)
    identity_layer(last.shortcut, 5.0)
    # 3 + 5 * 2; a shortcut round both would give 3 + 5 * 7, behind both 3 + 5 * 3
    expected = torch.full((1, 2, 4, 4, 4), 13.0)
    torch.testing.assert_close(last(torch.full((1, 2, 4, 4, 4), 7.0)), expected)


@pytest.fixture
def gru_unit():
    """A unit that hears no picture and no memory: its gates are their biases."""
    unit = GridGRU(6, 32)
    for gate, bias in ((unit.update, 0.7), (unit.reset, -0.3), (unit.candidate, 1.1)):
        zeroed(gate.hidden_conv, bias)
        nn.init.zeros_(gate.input_linear.weight)
    return unit


@torch.no_grad()
@pytest.mark.parametrize("views", [1, 2, 5])
def test_the_memory_in_closed_form(gru_unit, views):
    # h_n = u h_(n-1) + (1 - u) c from h_0 = 0 is (1 - u^n) c
    u, c = 1 / (1 + math.exp(-0.7)), math.tanh(1.1)
    expected = torch.full((2, 4, 4, 4, 4), (1 - u**views) * c)
    torch.testing.assert_close(gru_unit(torch.randn(2, views, 6)), expected)


@torch.no_grad()
def test_what_is_reset_is_not_heard(gru_unit):
    identity_layer(gru_unit.candidate.hidden_conv, 1.0)
    nn.init.constant_(gru_unit.candidate.hidden_conv.bias, 1.1)
    u, r, images = 1 / (1 + math.exp(-0.7)), 1 / (1 + math.exp(0.3)), torch.zeros(1, 2, 6)
    first = (1 - u) * math.tanh(1.1)
    second = u * first + (1 - u) * math.tanh(r * first + 1.1)
    torch.testing.assert_close(gru_unit(images), torch.full((1, 4, 4, 4, 4), second))


@torch.no_grad()
def test_a_gate_gives_every_cell_of_the_grid_a_number_of_its_own(gru_unit):
    image, weight = torch.eye(6)[:1], gru_unit.candidate.input_linear.weight
    weight[:, 0] = torch.arange(256.0) / 256
    u = 1 / (1 + math.exp(-0.7))
    expected = (1 - u) * torch.tanh(weight[:, 0].view(1, 4, 4, 4, 4) + 1.1)
    torch.testing.assert_close(gru_unit(image[None]), expected)


def test_weights_start_as_published():
    net = new_net(127, 4, 0)
    linear = net.encoder[7].weight  # 576 to 256
    spread = math.sqrt(2 / ((576 + 256) / 2))
    # The spread of 147 456 draws is off by 1 / sqrt(2 * 147 456) = 0.2 %: five of those.
    assert linear.std().item() == pytest.approx(spread, rel=0.01)
    assert all((p == 0.1).all() for name, p in net.named_parameters() if name.endswith("bias"))


def test_weights_depend_on_the_seed_alone():
    before = torch.random.get_rng_state()
    one, other = new_net(16, 32, 3), new_net(16, 32, 3)
    assert all(map(torch.equal, one.state_dict().values(), other.state_dict().values()))
    assert not torch.equal(one.encoder[7].weight, new_net(16, 32, 4).encoder[7].weight)
    assert torch.equal(torch.random.get_rng_state(), before)


@torch.no_grad()
def test_chances_of_a_voxel_to_be_empty_and_full_sum_to_1():
    net, images = new_net(16, 32, 0), torch.rand(2, 3, 3, 16, 16)
    scores = net(images)
    expected = torch.sigmoid(scores[:, 1] - scores[:, 0])
    torch.testing.assert_close(net.occupancy_probability(images), expected)

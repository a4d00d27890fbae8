"""The net against the published sizes, and its norm against its formula."""

from dataclasses import replace

import numpy as np
import pytest
import torch
from torch import nn

from industnerf.methods.occupancy.network import Block, ConditionalNorm, Decoder, OccupancyNet
from industnerf.schema import OccupancySettings
from tests.methods.test_conformance import merged


def num_parameters(net: nn.Module) -> int:
    return sum(p.numel() for p in net.parameters())


@pytest.fixture(scope="module")
def published() -> OccupancySettings:
    return merged("params.yaml", "conf/experiment/gpu.yaml").method.occupancy


@pytest.fixture(scope="module")
def full(published) -> OccupancyNet:
    return OccupancyNet(published).eval()


def test_it_has_as_many_numbers_as_published(full, published):
    layer = 256 * 256 + 256
    norm = 2 * layer  # a scale and a shift from the code
    block = 2 * norm + 2 * layer
    decoder = (3 * 256 + 256) + 5 * block + norm + (256 + 1)
    assert num_parameters(full.decoder) == decoder == 2_106_625
    assert num_parameters(full.encoder) == 11_176_512 + (512 * 256 + 256) == 11_307_840
    assert num_parameters(full) == 13_414_465
    assert published.size == "full"


def test_its_shapes_are_as_published(full, published):
    images = torch.rand(2, 3, published.image_px, published.image_px)
    with torch.no_grad():
        code = full.encode(images)
        logits = full.decoder(torch.rand(2, 7, 3), code)
    assert (published.image_px, published.points_subsample) == (224, 2048)
    assert code.shape == (2, 256)
    assert logits.shape == (2, 7)
    assert [m.weight.shape for m in full.decoder.blocks[0].children() if hasattr(m, "weight")] == [
        (256, 256),
        (256, 256),
    ]


def test_the_norm_is_over_all_points_of_all_images_and_the_code_scales_and_shifts():
    torch.manual_seed(0)
    norm = ConditionalNorm(4, 5)
    for linear in (norm.scale, norm.shift):
        nn.init.normal_(linear.weight)
    x, code = torch.randn(3, 50, 5), torch.randn(3, 4)
    result = norm(x, code).detach().numpy()
    for channel in range(5):
        values = x[..., channel].numpy().astype(float)
        normed = (values - values.mean()) / np.sqrt(values.var() + 1e-5)
        for image in range(3):
            scale = float(norm.scale.weight.detach()[channel].double() @ code[image].double()) + 1
            shift = float(norm.shift.weight.detach()[channel].double() @ code[image].double())
            # float32 sums of 150 values of about 1
            np.testing.assert_allclose(
                result[image, :, channel], scale * normed[image] + shift, rtol=0, atol=2e-5
            )


def test_a_new_block_is_the_identity_but_for_a_bias():
    block = Block(4, 8)
    nn.init.zeros_(block.layer2.bias)
    x = torch.randn(2, 6, 8)
    torch.testing.assert_close(block(x, torch.randn(2, 4)), x, rtol=0, atol=0)


def test_a_new_decoder_does_not_know_the_code_and_a_trained_one_does():
    torch.manual_seed(0)
    decoder, points = Decoder(4, 8, 2).eval(), torch.rand(1, 9, 3)
    codes = torch.randn(2, 1, 4)
    torch.testing.assert_close(decoder(points, codes[0]), decoder(points, codes[1]))
    nn.init.normal_(decoder.norm.scale.weight)
    assert (decoder(points, codes[0]) - decoder(points, codes[1])).abs().max() > 1e-2


def test_each_image_and_each_point_is_answered_for_itself():
    torch.manual_seed(0)
    small = merged("params.yaml", "conf/experiment/smoke.yaml").method.occupancy
    net, images, points = OccupancyNet(small), torch.rand(4, 3, 32, 32), torch.rand(4, 20, 6)
    for _ in range(3):
        net(images, points)
    for linear in (net.decoder.norm.scale, net.decoder.norm.shift):
        nn.init.normal_(linear.weight)
    net.eval()
    with torch.no_grad():
        together = net(images, points)
        alone = net(images[2:3], points[2:3].flip(1)).flip(1)
        other = net(images[1:2], points[2:3])
    # float32, sums in another order
    torch.testing.assert_close(together[2:3], alone, rtol=1e-4, atol=1e-5)
    assert (other - alone).abs().max() > 1e-3


def test_a_gray_part_before_white_looks_as_bright_as_imagenet_does(full):
    seen = []
    hook = full.encoder.register_forward_pre_hook(lambda net, inputs: seen.append(inputs[0]))
    with torch.no_grad():
        full.encode(torch.tensor([0.0, 0.5]).view(2, 1, 1, 1).expand(2, 3, 32, 32))
    hook.remove()
    assert not seen[0][0].any()  # the background
    torch.testing.assert_close(seen[0][1], torch.ones(3, 32, 32))


@pytest.mark.parametrize(("axes", "dims"), [("part", 3), ("picture", 3), ("both", 6)])
def test_its_first_layer_takes_a_point_in_the_axes_that_it_knows(axes, dims):
    small = merged("params.yaml", "conf/experiment/smoke.yaml").method.occupancy
    assert OccupancyNet(replace(small, query_axes=axes)).decoder.first.in_features == dims

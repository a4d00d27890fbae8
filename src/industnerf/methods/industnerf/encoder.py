"""Section 3.1, F = E(I): a small convolutional network from a view to its feature map.

Kernels of stride 2 have even sides.  Odd ones would be centered on the first of two pixels, and
two of them would shift the features by 1.5 px against the image.
"""

from typing import final

from jaxtyping import Float
from torch import Tensor, cat, nn
from torch.nn.functional import avg_pool2d, interpolate, relu

STRIDE = 4  # px of the image on each side of a texel


@final
class Encoder(nn.Module):
    """Two convolutions of stride 2 with `width` channels, then one to `feature_channels`.

    The input is the difference of the image from its background, and there are no biases, so
    features of background are 0.  With `rgb_skip`, four more channels follow: the image averaged
    over each texel, and its largest difference from the background.  The initial weights come
    from torch's global generator.
    """

    def __init__(self, feature_channels: int, width: int, rgb_skip: bool) -> None:
        super().__init__()
        # photographs do not end in black: the border is repeated, not zero
        conv_options = {"padding_mode": "replicate", "bias": False}
        self.conv1 = nn.Conv2d(3, width, 6, stride=2, padding=2, **conv_options)
        self.conv2 = nn.Conv2d(width, width, 4, stride=2, padding=1, **conv_options)
        self.conv3 = nn.Conv2d(width, feature_channels, 3, padding=1, **conv_options)
        self.rgb_skip = rgb_skip
        self.out_channels = feature_channels + 4 * rgb_skip

    def forward(
        self, images: Float[Tensor, "v 3 h w"], background: Float[Tensor, "*one_or_v 3 1 1"]
    ) -> Float[Tensor, "v c th tw"]:
        """Feature maps of images in [0, 1], a texel for every 4 x 4 px.

        A side that is no multiple of 4 px is first stretched to the next one, so the texels cover
        the image exactly, as `sample_features` assumes.
        """
        images = resize_to_stride(images)
        difference = images - background
        features = self.conv3(relu(self.conv2(relu(self.conv1(difference)))))
        if not self.rgb_skip:
            return features
        contrast = difference.abs().amax(dim=1, keepdim=True)
        return cat([features, avg_pool2d(cat([images, contrast], dim=1), STRIDE)], dim=1)


def resize_to_stride(images: Float[Tensor, "v 3 h w"]) -> Float[Tensor, "v 3 sh sw"]:
    """The images with their sides stretched to the next multiple of STRIDE px."""
    size = images.shape[-2:]
    target_size = tuple(-(-side // STRIDE) * STRIDE for side in size)
    return images if target_size == size else interpolate(images, target_size, mode="bilinear")

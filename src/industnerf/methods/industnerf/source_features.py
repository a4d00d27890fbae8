"""Section 3.1, the inputs of N in eq. (4): pi(F, P, X), pooled over the source views, and PosE.

Readings R1 to R3 and R14.
"""

from collections.abc import Iterator
from typing import assert_never

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor, nn

from industnerf.geometry.cameras import reduced_size
from industnerf.methods.industnerf.encoder import STRIDE, Encoder
from industnerf.methods.industnerf.pooling import (
    attach_gradient,
    pool,
    pooled_channels,
    pooling_weights,
)
from industnerf.methods.industnerf.position_encoding import (
    encode_positions,
    encoding_channels,
    encoding_coordinates,
)
from industnerf.methods.industnerf.projection import is_in_view, project, sample_features
from industnerf.methods.industnerf.ray_sampler import add_noise, downsample_images
from industnerf.methods.industnerf.scene import NerfScene
from industnerf.schema import IndustnerfSettings
from industnerf.schema.readings import EncoderReading

GRAY = 0.5


def is_encoder_trained(reading: EncoderReading) -> bool | None:
    """Reading R14: whether E is trained on the part's own images; None: there is no E.

    pretrained: E has learned from other parts, and is kept.  frozen: E keeps its initial weights.
    """
    match reading:
        case "per_part":
            return True
        case "pretrained" | "frozen":
            return False
        case "none":
            return None
        case _:
            assert_never(reading)


class SourceFeatures(nn.Module):
    """E, the source views, and the inputs of N at the points that were set last.

    Encoding all images at every step is expensive.  Each step encodes a few of them anew, and E
    learns through these; the features of the others are those that were computed last.
    """

    def __init__(self, scene: NerfScene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._scene = scene
        self._network_settings, self._readings = settings.network, settings.readings
        is_trained = is_encoder_trained(settings.readings.encoder)
        self._position_only, self._image_noise = is_trained is None, settings.image_noise
        self.num_changes = 0  # how often what a call returns has changed, or lost its gradient
        self.is_trainable = bool(is_trained)
        network = settings.network
        self.encoder = Encoder(network.feature_channels, network.encoder_width, network.rgb_skip)
        self.encoder.requires_grad_(self.is_trainable)
        encoding_width = encoding_channels(
            network.encoding_channels, self._readings.position_encoding
        )
        pooled_width = pooled_channels(self.encoder.out_channels, self._readings.view_pooling)
        self.out_channels = encoding_width + (0 if self._position_only else pooled_width)

    def __len__(self) -> int:
        """Number of source views."""
        return len(self._scene)

    def set_points(self, points: Float32[Tensor, "m 3"], spacing: float = 0.0) -> None:
        """Compute the inputs at these points from now on; all views have equal weights.

        Images are scaled down to the points' `spacing`; 0: they are used at full resolution.
        """
        self._points, self._images = points, self._resized_images(spacing)
        coordinates = encoding_coordinates(
            points, self._scene.cameras.c2w[0], self._readings.encoding_frame
        )
        network_settings = self._network_settings
        self._encoding = encode_positions(
            coordinates,
            network_settings.encoding_channels,
            network_settings.encoding_alpha,
            network_settings.encoding_beta,
            self._readings.position_encoding,
        )
        self.num_changes += 1
        if self._position_only:
            return
        self._features, self._valid = self._sample_all_views()
        self._pool_weighted(None)

    def _resized_images(self, spacing: float) -> Float32[Tensor, "v 3 h w"]:
        """The images in [0, 1], at the size where a texel of E is about `spacing` wide.

        The unit ball is about as wide as the frame.  So E sees the same share of the spacing at
        every level.
        """
        cameras = self._scene.cameras
        image_px = round(STRIDE * 2 / spacing) if spacing else max(cameras.width, cameras.height)
        width, height = reduced_size(cameras.width, cameras.height, image_px)
        return downsample_images(self._scene, height, width).permute(0, 3, 1, 2)

    def recompute_features(self) -> None:
        """Encode every view with E as it is now."""
        if not self._position_only:
            self._features, _ = self._sample_all_views()
            self._pool()

    @torch.no_grad()
    def _sample_all_views(self) -> tuple[Float32[Tensor, "v m c"], Bool[Tensor, "v m"]]:
        return self._sample_views(torch.arange(len(self._scene)))

    def set_view_weights(self, view_weights: Float32[Tensor, "v m"]) -> None:
        """Weight each view by its confidence (13) in the points; reading R3."""
        if not self._position_only:
            self._pool_weighted(view_weights)

    def _pool_weighted(self, view_weights: Float32[Tensor, "v m"] | None) -> None:
        self._weights = pooling_weights(self._valid, view_weights, self._readings.view_pooling)
        self._pool()

    def _pool(self) -> None:
        reading = self._readings.view_pooling
        self._pooled = pool(self._features, self._valid, self._weights, reading)
        self.num_changes += 1

    def select_points(self, indices: Int64[Tensor, "k"]) -> None:
        """Keep only these of the points, in this order."""
        self._points, self._encoding = self._points[indices], self._encoding[indices]
        self.num_changes += 1
        if not self._position_only:
            self._features, self._valid = self._features[:, indices], self._valid[:, indices]
            self._weights = self._weights[:, indices]
            self._pool()

    def refresh_views(
        self, views: Int64[Tensor, "v"], generator: torch.Generator | None = None
    ) -> None:
        """Encode these views anew; the next `forward` has a gradient in E."""
        fresh, valid = self._sample_views(views, generator)
        self._features[views] = fresh.detach()
        self._pool()
        weights, reading = self._weights[views], self._readings.view_pooling
        self._pooled = attach_gradient(self._pooled, fresh, valid, weights, reading)

    def forward(self) -> Float32[Tensor, "m c"]:
        """Inputs of N in eq. (4); after a call, those of refreshed views lose their gradient."""
        pooled = [] if self._position_only else [self._pooled]
        inputs = torch.cat([self._encoding, *pooled], dim=1)
        if inputs.requires_grad:
            self._pooled = self._pooled.detach()
            self.num_changes += 1
        return inputs

    @torch.no_grad()
    def pooled_colors(self) -> Float32[Tensor, "m 3"]:
        """Colors of the views at the points, pooled as features are; gray where N has none.

        N's colors start from them.  From gray, a thin dark fog before a white background fits the
        images sooner than an opaque surface of the right color.
        """
        if self._position_only or not self._network_settings.rgb_skip:
            return torch.full_like(self._points, GRAY)
        first = self._network_settings.feature_channels
        return self._pooled[:, first : first + 3]

    def _sample_views(
        self, views: Int64[Tensor, "v"], generator: torch.Generator | None = None
    ) -> tuple[Float32[Tensor, "v m c"], Bool[Tensor, "v m"]]:
        """pi(F, P, X) of these views, and whether each point is in view.

        With a generator, `image_noise` is added to the images.
        """
        cameras, sampled, valid = self._scene.cameras, [], []
        for view, features in zip(views.tolist(), self.encode_views(views, generator), strict=True):
            uv, depth = project(self._points, cameras.K[view], cameras.c2w[view])
            inside = is_in_view(uv, depth, cameras.width, cameras.height)
            uv = uv.masked_fill(~inside[:, None], 0.0)
            sampled.append(sample_features(features, uv, cameras.width, cameras.height))
            valid.append(inside)
        return torch.stack(sampled), torch.stack(valid)

    def encode_views(
        self, views: Int64[Tensor, "v"], generator: torch.Generator | None = None
    ) -> Iterator[Float32[Tensor, "c th tw"]]:
        """F = E(I), view by view: in one batch on a GPU, one at a time on a CPU."""
        images = [self._images[view][None] for view in views.tolist()]
        if generator is not None:
            images = [add_noise(image, self._image_noise, generator) for image in images]
        backgrounds = self._scene.background[views][..., None, None].unbind(0)
        if self._images.is_cuda:
            images, backgrounds = [torch.cat(images)], [torch.stack(backgrounds)]
        for encoded_batch in map(self.encoder, images, backgrounds):
            yield from (encoded_batch[index] for index in range(len(encoded_batch)))

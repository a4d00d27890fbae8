"""What N is told of a point: pooled features of the source views (R3) and PosE (R1, R2)."""

from collections.abc import Iterator

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor, nn

from industnerf.geometry.cameras import reduced_size
from industnerf.methods.industnerf.encoder import STRIDE, Encoder
from industnerf.methods.industnerf.encoding import encode, encoded_channels, encoding_frame
from industnerf.methods.industnerf.pixels import averaged, noisier
from industnerf.methods.industnerf.pooling import felt, pool, pooled_channels, weights_of
from industnerf.methods.industnerf.projection import in_view, project, sample_features
from industnerf.methods.industnerf.roles import encoder_role
from industnerf.methods.industnerf.scene import Scene
from industnerf.schema import IndustnerfSettings

GREY = 0.5


class Sources(nn.Module):
    """E, the source views, and what they say of the points that were placed last.

    A step need not encode every image anew: E learns through the few views that are refreshed,
    and the features of the others stay as they were last computed.
    """

    def __init__(self, scene: Scene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._scene, self._ways, self._readings = scene, settings.network, settings.readings
        role = encoder_role(settings.readings.encoder)
        self._blind, self._noise = not role.heard, settings.noise
        self.learns = role.learns  # whether E is trained at all
        self.encoder = Encoder(self._ways.features, self._ways.width, self._ways.rgb_skip)
        self.encoder.requires_grad_(role.learns)
        posed = encoded_channels(self._ways.channels, self._readings.pose)
        pooled = pooled_channels(self.encoder.channels, self._readings.views)
        self.columns = posed + (0 if self._blind else pooled)

    def __len__(self) -> int:
        """How many views speak."""
        return len(self._scene)

    def place(self, points: Float32[Tensor, "m 3"], spacing: float = 0.0) -> None:
        """From now on speak of these points; all views count alike.

        They are `spacing` apart; 0: they are to be told all that the images show.
        """
        self._points, self._images = points, self._scaled(spacing)
        frame = encoding_frame(points, self._scene.eyes.c2w[0], self._readings.frame)
        ways = self._ways
        self._encoding = encode(
            frame, ways.channels, ways.magnitude, ways.base, self._readings.pose
        )
        if self._blind:
            return
        self._features, self._valid = self._look_all()
        self._weigh(None)

    def _scaled(self, spacing: float) -> Float32[Tensor, "v 3 h w"]:
        """The images in [0, 1], so large that a texel of E stands for about `spacing`.

        The unit ball is about as wide as the frame.  Between points there is nothing to be told,
        and E would see in an image four times too large what it can not in those of later levels.
        """
        eyes = self._scene.eyes
        longest = round(STRIDE * 2 / spacing) if spacing else max(eyes.width, eyes.height)
        width, height = reduced_size(eyes.width, eyes.height, longest)
        return averaged(self._scene, height, width).permute(0, 3, 1, 2)

    def encode_anew(self) -> None:
        """Have every view told by E as it is now."""
        if not self._blind:
            self._features, _ = self._look_all()
            self._pool()

    @torch.no_grad()
    def _look_all(self) -> tuple[Float32[Tensor, "v m c"], Bool[Tensor, "v m"]]:
        return self._look(torch.arange(len(self._scene)))

    def heed(self, trust: Float32[Tensor, "v m"]) -> None:
        """From now on trust each view as far as it was sure of the points; reading R3."""
        if not self._blind:
            self._weigh(trust)

    def _weigh(self, trust: Float32[Tensor, "v m"] | None) -> None:
        self._weights = weights_of(self._valid, trust, self._readings.views)
        self._pool()

    def _pool(self) -> None:
        reading = self._readings.views
        self._pooled = pool(self._features, self._valid, self._weights, reading)

    def keep(self, which: Int64[Tensor, "k"]) -> None:
        """From now on speak of these of the points, in this order."""
        self._points, self._encoding = self._points[which], self._encoding[which]
        if not self._blind:
            self._features, self._valid = self._features[:, which], self._valid[:, which]
            self._weights = self._weights[:, which]
            self._pool()

    def refresh(self, views: Int64[Tensor, "v"], generator: torch.Generator | None = None) -> None:
        """Encode these views anew; the next `forward` can be differentiated in E."""
        fresh, valid = self._look(views, generator)
        self._features[views] = fresh.detach()
        self._pool()
        weights, reading = self._weights[views], self._readings.views
        self._pooled = felt(self._pooled, fresh, valid, weights, reading)

    def forward(self) -> Float32[Tensor, "m c"]:
        """The inputs of N in eq. (4); the graph of a refreshed view is there for one step only."""
        pooled = [] if self._blind else [self._pooled]
        inputs = torch.cat([self._encoding, *pooled], dim=1)
        if pooled:
            self._pooled = self._pooled.detach()
        return inputs

    @torch.no_grad()
    def colours(self) -> Float32[Tensor, "m 3"]:
        """That the views see where the points are: pooled as features are; grey if N is not told.

        N's colours start there.  From grey, a thin black veil before white is learned sooner
        than an opaque surface of the right colour.
        """
        if self._blind or not self._ways.rgb_skip:
            return torch.full_like(self._points, GREY)
        return self._pooled[:, self._ways.features : self._ways.features + 3]

    def _look(
        self, views: Int64[Tensor, "v"], generator: torch.Generator | None = None
    ) -> tuple[Float32[Tensor, "v m c"], Bool[Tensor, "v m"]]:
        """pi(F, P, X) of these views, and whether a point is in the view at all.

        With a generator the images are noisier than they are, if E is to learn from noisier ones.
        """
        eyes, rows, valid = self._scene.eyes, [], []
        for view, features in zip(views.tolist(), self.encoded(views, generator), strict=True):
            uv, depth = project(self._points, eyes.K[view], eyes.c2w[view])
            seen = in_view(uv, depth, eyes.width, eyes.height)
            uv = uv.masked_fill(~seen[:, None], 0.0)
            rows.append(sample_features(features, uv, eyes.width, eyes.height))
            valid.append(seen)
        return torch.stack(rows), torch.stack(valid)

    def encoded(
        self, views: Int64[Tensor, "v"], generator: torch.Generator | None = None
    ) -> Iterator[Float32[Tensor, "c th tw"]]:
        """F = E(I), view by view, of images as coarse as the points.

        On a GPU of all at once; else one has to fit into a cache.
        """
        images = [self._images[view][None] for view in views.tolist()]
        if generator is not None:
            images = [noisier(image, self._noise, generator) for image in images]
        behind = self._scene.background[views][..., None, None].unbind(0)
        if self._images.is_cuda:
            images, behind = [torch.cat(images)], [torch.stack(behind)]
        for some in map(self.encoder, images, behind):
            yield from (some[which] for which in range(len(some)))

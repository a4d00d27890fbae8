"""What N is told of a point: pooled features of the source views (R3) and PosE (R1, R2)."""

import torch
from jaxtyping import Bool, Float32, Int64
from torch import Tensor, nn

from industnerf.methods.industnerf.encoder import Encoder
from industnerf.methods.industnerf.encoding import encode, encoded_channels, encoding_frame
from industnerf.methods.industnerf.pooling import PooledSums, pool, pooled_channels
from industnerf.methods.industnerf.projection import in_view, project, sample_features
from industnerf.methods.industnerf.scene import Scene
from industnerf.schema import IndustnerfSettings


class Sources(nn.Module):
    """E, the source views, and what they say of the points that were placed last.

    A step need not encode every image anew: E learns through the few views that are refreshed,
    and the features of the others stay as they were last computed.
    """

    def __init__(self, scene: Scene, settings: IndustnerfSettings) -> None:
        super().__init__()
        self._scene, self._ways, self._readings = scene, settings.network, settings.readings
        self._blind = settings.readings.encoder == "none"
        self.encoder = Encoder(self._ways.features, self._ways.width, self._ways.rgb_skip)
        self.encoder.requires_grad_(settings.readings.encoder == "per_part")
        posed = encoded_channels(self._ways.channels, self._readings.pose)
        pooled = pooled_channels(self.encoder.channels, self._readings.views)
        self.columns = posed + (0 if self._blind else pooled)
        self.place(torch.zeros(0, 3, device=scene.images.device))

    def __len__(self) -> int:
        """How many views speak."""
        return len(self._scene)

    @property
    def learns(self) -> bool:
        """Whether E is trained at all, which can only be while features are pooled as sums."""
        return self._readings.encoder == "per_part" and self._readings.views == "mean_variance"

    def place(self, points: Float32[Tensor, "m 3"]) -> None:
        """From now on speak of these points."""
        self._points = points
        frame = encoding_frame(points, self._scene.eyes.c2w[0], self._readings.frame)
        ways = self._ways
        self._encoding = encode(
            frame, ways.channels, ways.magnitude, ways.base, self._readings.pose
        )
        if self._blind:
            return
        with torch.no_grad():
            looks = [self._look(torch.tensor([view])) for view in range(len(self._scene))]
        self._features = torch.cat([features for features, _ in looks])
        self._valid = torch.cat([valid for _, valid in looks])
        self._pool()

    def _pool(self) -> None:
        if self._readings.views != "mean_variance":
            self._pooled = pool(self._features, self._valid, self._readings.views)
            return
        columns = self._features.shape[2]
        device = self._features.device
        self._sums = PooledSums(len(self._points), columns, torch.float32, device)
        for view in range(len(self._scene)):  # one by one: sums are kept in float64
            self._sums.add(self._features[view : view + 1], self._valid[view : view + 1])
        self._pooled = self._sums.pooled()

    def keep(self, which: Int64[Tensor, "k"]) -> None:
        """From now on speak of these of the points, in this order."""
        self._points, self._encoding = self._points[which], self._encoding[which]
        if not self._blind:
            self._features, self._valid = self._features[:, which], self._valid[:, which]
            self._pool()

    def refresh(self, views: Int64[Tensor, "v"]) -> None:
        """Encode these views anew; the next `forward` can be differentiated in E."""
        self._sums.remove(self._features[views], self._valid[views])
        fresh, valid = self._look(views)
        self._sums.add(fresh, valid)
        self._features[views] = fresh.detach()
        self._pooled = self._sums.pooled()

    def forward(self) -> Float32[Tensor, "m c"]:
        """The inputs of N; the graph of a refreshed view is there for one step only."""
        pooled = [] if self._blind else [self._pooled]
        inputs = torch.cat([self._encoding, *pooled], dim=1)
        if pooled:
            self._pooled = self._pooled.detach()
        return inputs

    def _look(
        self, views: Int64[Tensor, "v"]
    ) -> tuple[Float32[Tensor, "v m c"], Bool[Tensor, "v m"]]:
        """pi(F, P, X) of these views, and whether a point is in the view at all."""
        eyes, rows, valid = self._scene.eyes, [], []
        for view in views.tolist():
            image = self._scene.images[view].permute(2, 0, 1)[None].float() / 255
            uv, depth = project(self._points, eyes.K[view], eyes.c2w[view])
            seen = in_view(uv, depth, eyes.width, eyes.height)
            uv = uv.masked_fill(~seen[:, None], 0.0)
            rows.append(sample_features(self.encoder(image)[0], uv, eyes.width, eyes.height))
            valid.append(seen)
        return torch.stack(rows), torch.stack(valid)

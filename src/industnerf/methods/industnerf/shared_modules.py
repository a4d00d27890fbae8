"""E and N by themselves: what one part may learn and another may start from, reading R14."""

from torch import nn

from industnerf.methods.industnerf.field import Field


class SharedModules(nn.Module):
    """The encoder and the network of a field."""

    def __init__(self, field: Field) -> None:
        super().__init__()
        self.encoder, self.network = field.source_features.encoder, field.network

    def share_with(self, field: Field) -> None:
        """Have `field` use these two, and train them, in place of its own."""
        field.source_features.encoder, field.network = self.encoder, self.network

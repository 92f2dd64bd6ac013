"""What splats have for a method when its training begins."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from reconstruction.splats.harmonic_colour import display_colours, light_of_display
from reconstruction.splats.splats import Splats, logit
from reconstruction.training.methods.attributes import Attribute


def with_colours(name: str, attributes: Sequence[Attribute], splats: Splats, seed: int = 0) -> dict[str, Tensor]:
    """All as they begin, but for one of colours, of values 0 to 1, which are those of the splats.

    Parameters
    ----------
    seed
        Of noise.
    """
    generator = torch.Generator().manual_seed(seed)
    found = {each.parameter: each.learned(len(splats), generator) for each in attributes}
    with torch.no_grad():
        means = splats.means
        seen = light_of_display(display_colours(means, splats.sh, torch.zeros(3).to(means), 0))
    return found | {f"{name}_logits": logit(seen)}
